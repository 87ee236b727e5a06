#include "render/load/gltf_textures.h"

#include "render/core/error.h"

namespace twopass {
namespace {

double number_at(const tinygltf::Value& value, const char* member, int i, double otherwise) {
  const tinygltf::Value& array = value.Get(member);
  if (!array.IsArray() || static_cast<std::size_t>(i) >= array.ArrayLen()) return otherwise;
  return array.Get(i).GetNumberAsDouble();
}

/// Scaled, then turned, then moved. Turned so that the picture turns clockwise as seen with v pointing down,
/// which is what the extension's text and its test model say (its shader reads the other way round).
UvTransform transform_of(const tinygltf::Value& extension, const std::string& owner,
                         const GltfDocument& document) {
  const tinygltf::Value& rotation = extension.Get("rotation");
  const double angle = rotation.IsNumber() ? rotation.GetNumberAsDouble() : 0.0;
  const double c = std::cos(angle), s = std::sin(angle);
  const double su = number_at(extension, "scale", 0, 1.0), sv = number_at(extension, "scale", 1, 1.0);
  const double u = number_at(extension, "offset", 0, 0.0), v = number_at(extension, "offset", 1, 0.0);
  for (const double value : {angle, su, sv, u, v})
    if (!(std::abs(value) <= 1e9))
      throw Error(document.file, owner + " has a KHR_texture_transform with numbers beyond 1e9",
                  "correct the file");
  return {static_cast<float>(c * su),  static_cast<float>(s * sv), static_cast<float>(u),
          static_cast<float>(-s * su), static_cast<float>(c * sv), static_cast<float>(v)};
}

void apply_transform(const tinygltf::Value& extension, GltfTextureUse& use, const std::string& owner,
                     const GltfDocument& document) {
  use.to_uv = transform_of(extension, owner, document);
  if (const tinygltf::Value& set = extension.Get("texCoord"); set.IsNumber()) use.uv_set = set.GetNumberAsInt();
}

}  // namespace

GltfTextureUse texture_use(int index, int uv_set, const tinygltf::ExtensionMap& extensions,
                           const std::string& owner, const GltfDocument& document) {
  GltfTextureUse use{index, uv_set, {}};
  const auto transform = extensions.find("KHR_texture_transform");
  if (transform != extensions.end()) apply_transform(transform->second, use, owner, document);
  return use;
}

GltfTextureUse texture_use(const tinygltf::Value& extension, const char* member, const std::string& owner,
                           const GltfDocument& document) {
  GltfTextureUse use;
  const tinygltf::Value& info = extension.Get(member);
  if (!info.IsObject()) return use;
  if (const tinygltf::Value& index = info.Get("index"); index.IsNumber()) use.index = index.GetNumberAsInt();
  if (const tinygltf::Value& set = info.Get("texCoord"); set.IsNumber()) use.uv_set = set.GetNumberAsInt();
  const tinygltf::Value& extensions = info.Get("extensions");
  if (extensions.IsObject() && extensions.Has("KHR_texture_transform"))
    apply_transform(extensions.Get("KHR_texture_transform"), use, owner, document);
  return use;
}

}  // namespace twopass
