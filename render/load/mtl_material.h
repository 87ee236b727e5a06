// Wavefront MTL materials to ours.
//
// MTL was written for highlights and ray casting without units, so this is an interpretation:
//   diffuse    everything not named below: Lambertian with Kd, the same on both sides
//   glossy     Ks with illum 2 or none: Ward's lobe on the diffuse base. The specification's highlight is
//              (n.h)^Ns in the half vector, and exp(-tan^2 / alpha^2) with alpha^2 = 2 / (Ns + 2) falls off in
//              the same way (M14). Kd + Ks above 1 are reduced together. map_Ns: Phong's lobe around the mirror
//              direction instead, which is as wide with a quarter of the exponent.
//   mirror     illum 3, 5 or 8 with Ks at least as bright as Kd: reflects Ks at every angle, on both sides
//   glass      illum 4, 6, 7 or 9: a Fresnel interface of index Ni (its front, by winding and normals, is the
//              outside). Ks scales the reflection where it is not black. Tf is what passes through the whole
//              object, so each of the two interfaces lets sqrt(Tf) through; without Tf, 1 - d stands in for it
//              where d < 1.
//   principled where a statement of the PBR extension is given: base colour Kd, roughness Pr, or else that of
//              Ns, metallic Pm, sheen Ps, clear coat Pc with roughness Pcr, aniso, index Ni; glass by illum.
//   mask       d < 1 or map_d without glass: so much of the surface is there
// Textures multiply their colours and numbers, as specified; colours that are black or absent count as white,
// and maps of the PBR extension replace their numbers, which is what exporters mean. Colours are sRGB where
// stored as integers, all else is raw. Texture coordinates run upwards: the first row of an image is at v = 1.
// Ke is radiance, W/(m2 sr), on the front side alone: emitting on both would double the power of lamps that are
// thin sheets, and files in circulation wind their lamps towards the room. What is left out is named in notes.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "materials/material.h"
#include "render/load/mtl_file.h"
#include "render/load/texture_files.h"

namespace twopass {

struct MtlMaterial {
  Material material;
  C3f radiance{0.0f};  ///< emitted by the front
  std::shared_ptr<const Texture>
      radiance_texture{};  ///< what it emits where that varies; then radiance is its mean
};

using MtlLibrary = std::map<std::string, MtlMaterial>;

/// The materials of a file whose names are `wanted`; nobody wants notes about others. Throws Error with
/// file:line for what is malformed and for textures that cannot be read.
MtlLibrary read_mtl(const std::filesystem::path& path, const std::set<std::string>& wanted,
                    TextureFiles& textures, Notes& notes);

/// The materials of records read from `path`, beside which their textures lie. Reads textures in parallel.
MtlLibrary materials_of(const std::map<std::string, MtlRecord>& records, const std::filesystem::path& path,
                        TextureFiles& textures, Notes& notes);

}  // namespace twopass
