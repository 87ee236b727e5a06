// Textures of glTF materials.
#pragma once

#include <optional>

#include "materials/texture.h"
#include "render/load/gltf_document.h"
#include "render/load/notes.h"

namespace twopass {

/// How a material refers to a texture (textureInfo in the specification).
struct GltfTextureUse {
  int index = -1;       ///< -1: no texture
  int uv_set = 0;       ///< TEXCOORD_n
  UvTransform to_uv{};  ///< KHR_texture_transform
};

/// Reads the members of textureInfo, normal and occlusion textures alike. `owner` is for errors.
GltfTextureUse texture_use(int index, int uv_set, const tinygltf::ExtensionMap& extensions,
                           const std::string& owner, const GltfDocument& document);
/// The same of a texture that an extension holds; no texture where it has none.
GltfTextureUse texture_use(const tinygltf::Value& extension, const char* member, const std::string& owner,
                           const GltfDocument& document);

/// What a texture holds.
enum class GltfTexels { color, normal, red, green, blue, alpha };

/// INTERIM until texture files can be read from memory.
struct TexelScale {
  C3f factor{1.0f}, offset{0.0f};
  float lowest = -infinity_f, highest = infinity_f;
};
class GltfTextures {
 public:
  GltfTextures(const GltfDocument&, Notes& notes) : notes_(notes) {}
  Texture load(const GltfTextureUse&, GltfTexels texels, const TexelScale& scale, const std::string&) {
    notes_.add("textures are not read yet");
    return texels == GltfTexels::normal  ? C3f(0.5f, 0.5f, 1.0f)
           : texels == GltfTexels::alpha ? C3f(1.0f)
                                         : scale.factor;
  }

 private:
  Notes& notes_;
};

}  // namespace twopass
