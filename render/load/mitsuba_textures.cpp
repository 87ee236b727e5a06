#include "render/load/mitsuba_textures.h"

#include "render/core/error.h"

namespace twopass {
namespace {

constexpr Named<TextureFilter> texture_filter_names[] = {
    {"bilinear", TextureFilter::bilinear},
    {"nearest", TextureFilter::nearest},
    // Of version 0.x. Those look at more texels where many share a pixel, as many samples a pixel do, too.
    {"trilinear", TextureFilter::bilinear},
    {"ewa", TextureFilter::bilinear},
};
constexpr Named<TextureWrap> texture_wrap_names[] = {
    {"repeat", TextureWrap::repeat},
    {"mirror", TextureWrap::mirror},
    {"clamp", TextureWrap::clamp},
};

template <class T>
T named_property(Properties& p, std::string_view name, std::span<const Named<T>> names, T otherwise) {
  const std::optional<std::string> text = p.text(name);
  return text ? value_of_name<T>(names, *text, p.where(name), std::string(name)) : otherwise;
}

UvTransform read_to_uv(Properties& p) {
  const M44d m = p.transform("to_uv");
  UvTransform result{static_cast<float>(m[0][0]), static_cast<float>(m[1][0]), static_cast<float>(m[3][0]),
                     static_cast<float>(m[0][1]), static_cast<float>(m[1][1]), static_cast<float>(m[3][1])};
  // Of version 0.x.
  const auto scale_u = static_cast<float>(p.number("uscale").value_or(1.0)),
             scale_v = static_cast<float>(p.number("vscale").value_or(1.0));
  result = {result.a * scale_u, result.b * scale_v, result.c, result.d * scale_u, result.e * scale_v, result.f};
  result.c += static_cast<float>(p.number("uoffset").value_or(0.0));
  result.f += static_cast<float>(p.number("voffset").value_or(0.0));
  return result;
}

// The version 0.x picture channels; the colour where none is asked for.
constexpr Named<TextureChannel> texture_channel_names[] = {
    {"all", TextureChannel::color}, {"r", TextureChannel::red},   {"g", TextureChannel::green},
    {"b", TextureChannel::blue},    {"a", TextureChannel::alpha},
};

TexelRange range_of(ColorUse use) {
  return use == ColorUse::reflectance ? TexelRange::unit : TexelRange::nonnegative;
}

TextureEncoding read_encoding(Properties& p) {
  using Kind = TextureEncoding::Kind;
  TextureEncoding encoding;
  if (p.boolean("raw", false)) encoding.kind = Kind::raw;
  if (const auto gamma = p.number("gamma")) {
    // Of version 0.x; -1 stands for sRGB.
    if (!(*gamma == -1.0 || (*gamma > 0.0 && *gamma <= 10.0)))
      throw Error(p.where("gamma"), "a texture's gamma lies above 0 and at most at 10, or is -1 (sRGB)",
                  "correct it");
    encoding.kind = *gamma == -1.0 ? Kind::srgb : *gamma == 1.0 ? Kind::raw : Kind::gamma;
    if (encoding.kind == Kind::gamma) encoding.gamma = static_cast<float>(*gamma);
  }
  if (const auto srgb = p.has("srgb") ? std::optional(p.boolean("srgb", true)) : std::nullopt)
    encoding.kind = *srgb ? Kind::srgb : Kind::raw;
  if (const auto name = p.text("color_space")) {
    encoding.kind = Kind::color_space;
    encoding.color_space = *name;
  }
  return encoding;
}

}  // namespace

Texture MitsubaTextures::read_bitmap(Properties& p, ColorUse use) {
  const std::optional<std::string> name = p.text("filename");
  if (!name)
    throw Error(p.where(), "texture 'bitmap' has no filename", "add <string name=\"filename\" value=\"...\"/>");
  const XmlNode& filename = *p.element("filename", {"string"});
  TextureRequest request{
      .name = *name, .folders = {filename.file->parent_path()}, .where = p.where("filename")};
  request.folders.insert(request.folders.end(), tree_.folders.begin(), tree_.folders.end());
  request.texels.encoding = read_encoding(p);
  request.texels.channel =
      named_property<TextureChannel>(p, "channel", texture_channel_names, TextureChannel::color);
  request.texels.range = range_of(use);
  Bitmap& look = request.look;
  look.filter = named_property<TextureFilter>(p, "filter_type", texture_filter_names, TextureFilter::bilinear);
  look.wrap_u = look.wrap_v =
      named_property<TextureWrap>(p, "wrap_mode", texture_wrap_names, TextureWrap::repeat);
  // Of version 0.x, where each axis may have its own.
  look.wrap_u = named_property<TextureWrap>(p, "wrap_mode_u", texture_wrap_names, look.wrap_u);
  look.wrap_v = named_property<TextureWrap>(p, "wrap_mode_v", texture_wrap_names, look.wrap_v);
  look.to_uv = read_to_uv(p);
  p.ignore({"format", "accel", "cache", "max_anisotropy"});
  return files_.load(request);
}

/// Of version 0.x: another texture times a factor.
Texture MitsubaTextures::read_scale(Properties& p, ColorUse use) {
  const XmlNode* nested = p.object_of("texture");
  if (!nested) throw Error(p.where(), "texture 'scale' holds no texture", "add the one that it scales");
  const Texture texture = of(*nested, ColorUse::emission);
  TexelScale scale{.lowest = 0.0f, .highest = use == ColorUse::reflectance ? 1.0f : infinity_f};
  const XmlNode* factor = p.element("scale", {"float", "rgb", "srgb", "spectrum"});
  if (factor && factor->tag == "float")
    scale.factor = C3f(static_cast<float>(*p.number("scale")));
  else if (factor)
    scale.factor = *p.color("scale", ColorUse::emission);
  return scaled(texture, scale);
}

Texture MitsubaTextures::read_checkerboard(Properties& p, ColorUse use) {
  Checkerboard board;
  board.color0 = p.color("color0", use).value_or(board.color0);
  board.color1 = p.color("color1", use).value_or(board.color1);
  board.to_uv = read_to_uv(p);
  return board;
}

/// Unbound: the mesh is known where a shape uses it (mesh_colors.h).
Texture MitsubaTextures::read_mesh_attribute(Properties& p, ColorUse use) {
  const std::optional<std::string> name = p.text("name");
  if (!name || !(name->starts_with("vertex_") || name->starts_with("face_")))
    throw Error(
        p.where("name"), "texture 'mesh_attribute' needs the name of an attribute",
        "give a name that starts with vertex_ or face_, as in <string name=\"name\" value=\"vertex_color\"/>");
  const auto factor = static_cast<float>(p.number("scale").value_or(1.0));
  return MeshColors{
      *name, nullptr,
      TexelScale{
          .factor = C3f(factor), .lowest = 0.0f, .highest = use == ColorUse::reflectance ? 1.0f : infinity_f}};
}

Texture MitsubaTextures::of(const XmlNode& texture, ColorUse use) {
  using Reader = Texture (MitsubaTextures::*)(Properties&, ColorUse);
  constexpr Named<Reader> readers[] = {
      {"bitmap", &MitsubaTextures::read_bitmap},
      {"checkerboard", &MitsubaTextures::read_checkerboard},
      {"mesh_attribute", &MitsubaTextures::read_mesh_attribute},
      {"scale", &MitsubaTextures::read_scale},
  };
  const Reader reader = plugin_of_type<Reader>(readers, texture);
  Properties properties(texture, tree_);
  Texture result = (this->*reader)(properties, use);
  properties.finish();
  return result;
}

std::optional<Texture> MitsubaTextures::property(Properties& p, std::string_view name, ColorUse use) {
  if (!p.has(name)) {
    p.element(name, {});  // so that errors list it
    return std::nullopt;
  }
  const XmlNode* node = p.element(name, {});
  if (node->tag == "texture") return of(*node, use);
  return *p.color(name, use);
}

}  // namespace twopass
