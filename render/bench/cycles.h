// Blender Cycles as a peer: the same triangles, materials, lights and camera, rendered by the `blender` of the
// system.
#pragma once

#include <string>

#include "render/bench/series.h"

namespace twopass {

/// Whether there is a program called blender on the PATH.
bool has_blender();

/// Why Cycles cannot render this scene as it is; empty: it can. It can where all shapes are faceted meshes of
/// uniform diffuse surfaces, ideal mirrors and clear glass, all light comes from surfaces and a constant sky,
/// and the camera is a pinhole.
std::string unfit_for_cycles(const BenchSubject& subject);

/// As measure_series, by `blender -b` in a folder of its own below `folder`, which is removed. Denoising,
/// adaptive sampling, clamps and thresholds are off; a box filter; as many bounces as the scene has. Times are
/// those of the render calls inside of Blender, without its start; each number of samples is a render of its
/// own. Throws Error with the last of what Blender said when it fails. REQUIRES: unfit_for_cycles() is empty.
BenchSeries measure_cycles(const BenchSubject& subject, const BenchReference& reference,
                           const SeriesBudget& budget, int threads, const std::filesystem::path& folder,
                           const std::function<void(double)>& report);

}  // namespace twopass
