// A number that tells scenes apart, so that a stored solution is not taken for another scene's.
#pragma once

#include <cstdint>

#include "render/scene/scene.h"

namespace twopass {

/// A hash of everything that a radiosity solution depends on: geometry, shading normals, scattering models,
/// emission, punctual lights, environment. Names, texture coordinates and the camera do not count, nor does the
/// order of the materials; that of the shapes and their triangles does. The same on every machine.
std::uint64_t scene_fingerprint(const Scene& scene);

}  // namespace twopass
