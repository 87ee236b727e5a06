#include "render/load/gltf_textures.h"

#include <span>

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

TexelOptions options_of(GltfTexels texels) {
  TexelOptions options;
  options.range = texels == GltfTexels::normal ? TexelRange::any : TexelRange::unit;
  options.encoding.kind =
      texels == GltfTexels::color ? TextureEncoding::Kind::srgb : TextureEncoding::Kind::raw;
  switch (texels) {
    case GltfTexels::red:
      options.channel = TextureChannel::red;
      break;
    case GltfTexels::green:
      options.channel = TextureChannel::green;
      break;
    case GltfTexels::blue:
      options.channel = TextureChannel::blue;
      break;
    case GltfTexels::alpha:
      options.channel = TextureChannel::alpha;
      break;
    case GltfTexels::color:
    case GltfTexels::normal:
      break;
  }
  return options;
}

TextureWrap wrap_of(int value, const GltfDocument& document) {
  switch (value) {
    case TINYGLTF_TEXTURE_WRAP_REPEAT:
      return TextureWrap::repeat;
    case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
      return TextureWrap::mirror;
    case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
      return TextureWrap::clamp;
    default:
      throw Error(document.file, "a sampler has the wrap mode " + std::to_string(value),
                  "use 10497 (repeat), 33648 (mirrored) or 33071 (clamp)");
  }
}

/// Filters for shrinking are ours to choose: we look at the area that a ray sees.
void apply_sampler(const tinygltf::Sampler& sampler, Bitmap& bitmap, const GltfDocument& document) {
  bitmap.wrap_u = wrap_of(sampler.wrapS, document);
  bitmap.wrap_v = wrap_of(sampler.wrapT, document);
  if (sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST) bitmap.filter = TextureFilter::nearest;
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

Texture GltfTextures::load_image(int index, GltfTexels texels, const std::string& owner) {
  const auto known = images_.find({index, texels});
  if (known != images_.end()) return known->second;
  const GltfImage& image = element_of(document_.images, index, "image", owner, document_);
  TextureRequest request;
  request.where = document_.file + ": " + owner;
  if (image.path.empty()) {
    request.name = image.name;
    request.encoded = std::as_bytes(std::span(image.bytes.view));
    if (request.encoded.empty()) throw Error(request.where, image.name + " has no bytes", "correct the file");
  } else {
    request.name = image.path.string();
    request.folders = {""};
  }
  request.texels = options_of(texels);
  return images_[{index, texels}] = files_.load(request);
}

Texture GltfTextures::load(const GltfTextureUse& use, GltfTexels texels, const TexelScale& scale,
                           const std::string& owner) {
  const tinygltf::Texture& texture =
      element_of(document_.model.textures, use.index, "texture", owner, document_);
  const C3f neutral = texels == GltfTexels::normal ? C3f(0.5f, 0.5f, 1.0f) : C3f(1.0f);
  Texture loaded = neutral;
  if (texture.source >= 0)
    loaded = load_image(texture.source, texels, owner);
  else
    notes_.add(document_.file + ": texture " + std::to_string(use.index) + " has no image: left out");
  // A missing file may be replaced by a colour that is meant to be seen.
  if (is_constant(loaded) && texels != GltfTexels::color) loaded = neutral;
  if (auto* bitmap = std::get_if<Bitmap>(&loaded)) {
    bitmap->to_uv = use.to_uv;
    if (texture.sampler >= 0)
      apply_sampler(element_of(document_.model.samplers, texture.sampler, "sampler",
                               "texture " + std::to_string(use.index), document_),
                    *bitmap, document_);
  }
  return scaled(loaded, scale);
}

}  // namespace twopass
