#include "render/load/mitsuba_textures.h"

#include "render/core/error.h"
#include "render/image/exr.h"
#include "render/image/raster_file.h"
#include "render/image/srgb.h"
#include "render/load/text_file.h"

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

float allowed(float x, ColorUse use) {
  if (!std::isfinite(x)) return 0.0f;
  return use == ColorUse::reflectance ? std::clamp(x, 0.0f, 1.0f) : std::max(x, 0.0f);
}

}  // namespace

std::shared_ptr<const Image> MitsubaTextures::image(const std::filesystem::path& path, const std::string& where,
                                                    bool raw, ColorUse use) {
  std::shared_ptr<const Image>& known = images_[{path, raw, use}];
  if (known) return known;
  RasterImage read;
  try {
    if (lower_case(path.extension().string()) == ".exr")
      read.image = read_exr(path);
    else
      read = read_raster(path);
  } catch (const Error& error) {
    throw Error(where, std::string("the texture cannot be read: ") + error.what(),
                "correct the file or its name");
  }
  const std::vector<C3f> pixels = rgb_pixels(read.image, path.string());
  auto result =
      std::make_shared<Image>(read.image.width, read.image.height, std::vector<std::string>{"R", "G", "B"});
  for (std::size_t i = 0; i < pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      float value = pixels[i][c];
      if (read.display_referred && !raw) value = srgb_decode(std::max(value, 0.0f));
      result->pixels[3 * i + static_cast<std::size_t>(c)] = allowed(value, use);
    }
  return known = result;
}

Texture MitsubaTextures::read_bitmap(Properties& p, ColorUse use) {
  const std::optional<std::string> name = p.text("filename");
  if (!name)
    throw Error(p.where(), "texture 'bitmap' has no filename", "add <string name=\"filename\" value=\"...\"/>");
  Bitmap bitmap;
  bitmap.filter = named_property<TextureFilter>(p, "filter_type", texture_filter_names, TextureFilter::bilinear);
  bitmap.wrap = named_property<TextureWrap>(p, "wrap_mode", texture_wrap_names, TextureWrap::repeat);
  bool raw = p.boolean("raw", false);
  if (const auto gamma = p.number("gamma")) {
    // Of version 0.x; -1 stands for sRGB.
    if (*gamma != 1.0 && *gamma != -1.0 && std::abs(*gamma - 2.2) > 1e-6)
      throw Error(p.where("gamma"), "a texture's gamma is 1, 2.2 or -1 (sRGB)", "convert the image");
    raw = raw || *gamma == 1.0;
  }
  bitmap.to_uv = read_to_uv(p);
  p.ignore({"format", "accel", "cache", "max_anisotropy", "channel"});
  const XmlNode& filename = *p.element("filename", {"string"});
  bitmap.image = image(find_file(tree_, filename, *name), p.where("filename"), raw, use);
  return bitmap;
}

Texture MitsubaTextures::read_checkerboard(Properties& p, ColorUse use) {
  Checkerboard board;
  board.color0 = p.color("color0", use).value_or(board.color0);
  board.color1 = p.color("color1", use).value_or(board.color1);
  board.to_uv = read_to_uv(p);
  return board;
}

Texture MitsubaTextures::of(const XmlNode& texture, ColorUse use) {
  using Reader = Texture (MitsubaTextures::*)(Properties&, ColorUse);
  constexpr Named<Reader> readers[] = {
      {"bitmap", &MitsubaTextures::read_bitmap},
      {"checkerboard", &MitsubaTextures::read_checkerboard},
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
