// The JSON of a glTF file, checked before anybody relies on it.
#pragma once

#include <string_view>

#include <nlohmann/json.hpp>

namespace twopass {

/// The extensions that the loader understands.
inline constexpr std::string_view gltf_extensions[] = {
    "KHR_lights_punctual", "KHR_materials_clearcoat", "KHR_materials_emissive_strength",
    "KHR_materials_ior",   "KHR_materials_specular",  "KHR_materials_transmission",
    "KHR_materials_unlit", "KHR_mesh_quantization",   "KHR_texture_transform",
};
bool is_supported_gltf_extension(std::string_view name);

/// The document: an object in which every known member has the type that glTF gives it, whole numbers are at
/// least 0 and below 2^31 (byte offsets and lengths: 2^53), and nothing is nested deeper than 64 levels.
/// Without what no picture shows: "extras", animations, skins, and extensions that are not supported. Throws
/// Error at `file`, naming the member as in "accessors[3].count".
nlohmann::json parse_gltf_json(std::string_view text, std::string_view file);

}  // namespace twopass
