// Textures of glTF materials.
#pragma once

#include <map>

#include "materials/texture.h"
#include "render/load/gltf_document.h"
#include "render/load/notes.h"
#include "render/load/texture_files.h"

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

/// What is taken of a texture.
enum class GltfTexels {
  color,   ///< sRGB
  normal,  ///< as they are stored; so are the rest
  red,
  green,
  blue,
  alpha
};

/// The textures of a file; images are decoded once for each use of their channels.
class GltfTextures {
 public:
  /// REQUIRES: the arguments outlive this.
  GltfTextures(const GltfDocument& document, const TextureOptions& options, Notes& notes)
      : document_(document), files_(options), notes_(notes) {}

  /// The texture of a use, each value made of its texel as `scale` says. `owner` is for errors. Where there is
  /// no image, what a white one would give, with a note. Throws Error when an image cannot be read.
  Texture load(const GltfTextureUse& use, GltfTexels texels, const TexelScale& scale, const std::string& owner);
  /// Adds what was noticed.
  void report() { files_.report(notes_); }
  /// Those that are read while rendering.
  [[nodiscard]] std::vector<TiledTexture> tiled() const { return files_.tiled(); }

 private:
  Texture load_image(int index, GltfTexels texels, const std::string& owner);

  const GltfDocument& document_;
  TextureFiles files_;
  Notes& notes_;
  std::map<std::pair<int, GltfTexels>, Texture> images_;
};

}  // namespace twopass
