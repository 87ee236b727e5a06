// Wavefront MTL materials to ours. The only place that parses MTL with tinyobjloader.
//
// MTL was written for highlights and ray casting without units, so this is an interpretation:
//   diffuse    everything not named below: Lambertian with Kd, the same on both sides
//   mirror     illum 3, 5 or 8 with Ks at least as bright as Kd: reflects Ks at every angle, on both sides
//   glass      illum 4, 6, 7 or 9, or d < 1: a Fresnel interface of index Ni (its front, by winding and
//   normals, is
//              the outside). Ks scales the reflection where it is not black. Tf is what passes through the
//              whole object, so each of the two interfaces lets sqrt(Tf) through; without Tf, 1 - d stands in
//              for it where d < 1.
// Ke is radiance, W/(m2 sr), on the front side alone: emitting on both would double the power of lamps that are
// thin sheets, and files in circulation wind their lamps towards the room. Highlights (Ks, Ns), textures and
// the PBR extension are left out; notes say so by name.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "materials/material.h"
#include "render/load/notes.h"

namespace twopass {

struct MtlMaterial {
  Material material;
  C3f radiance{0.0f};  ///< emitted by the front
};

using MtlLibrary = std::map<std::string, MtlMaterial>;

/// The materials of a file whose names are `wanted`; nobody wants notes about others. Throws Error with
/// file:line for malformed or negative numbers and for spectral colours.
MtlLibrary read_mtl(const std::filesystem::path& path, const std::set<std::string>& wanted, Notes& notes);

/// Reads MTL text; `file` is its name in errors and notes.
MtlLibrary parse_mtl(std::string_view text, std::string_view file, const std::set<std::string>& wanted,
                     Notes& notes);

}  // namespace twopass
