#include "render/image/picture.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <string>
#include <string_view>

#include "render/core/error.h"
#include "render/core/names.h"
#include "render/core/parallel.h"
#include "render/image/atomic_file.h"
#include "render/image/raster_file.h"
#include "render/image/srgb.h"

namespace twopass {
namespace {

namespace fs = std::filesystem;

enum class Format { exr, raster };

constexpr std::array<Named<Format>, 6> formats{{{".exr", Format::exr},
                                                {".png", Format::raster},
                                                {".jpg", Format::raster},
                                                {".jpeg", Format::raster},
                                                {".tif", Format::raster},
                                                {".tiff", Format::raster}}};

std::string extension_of(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

Format format_of(const fs::path& path) {
  return value_of_name<Format>(formats, extension_of(path), path.string(), "extension");
}

Image seen_through(const Image& scene_linear, const DisplayTransform& display, std::string_view where) {
  Image image(scene_linear.width, scene_linear.height, {"R", "G", "B"});
  const std::array<int, 3> from = scene_linear.rgb_channels(where);
  const auto width = static_cast<std::size_t>(image.width);
  parallel_for(static_cast<std::size_t>(image.height), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin * width; i < end * width; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        image.pixels[3 * i + c] =
            scene_linear.pixels[i * scene_linear.channels.size() + static_cast<std::size_t>(from[c])];
    display.apply(std::span(image.pixels).subspan(3 * begin * width, 3 * (end - begin) * width));
  });
  return image;
}

// Multiplies the colours of the unnamed layer by alpha, as OpenEXR has them.
void premultiply(Image& image) {
  const int alpha = image.channel("A");
  if (alpha < 0) return;
  for (const char* name : {"R", "G", "B", "Y"}) {
    const int color = image.channel(name);
    if (color < 0) continue;
    for (std::size_t i = 0; i < image.pixels.size(); i += image.channels.size())
      image.pixels[i + static_cast<std::size_t>(color)] *= image.pixels[i + static_cast<std::size_t>(alpha)];
  }
}

// Layers that are colours: not Cryptomatte's, whose channels are called like those.
bool is_of_colors(const std::string& layer, const ExrMetadata& metadata) {
  return std::none_of(metadata.begin(), metadata.end(), [&](const auto& entry) {
    const auto* name = std::get_if<std::string>(&entry.second);
    return name && entry.first.starts_with("cryptomatte/") && entry.first.ends_with("/name") &&
           layer.starts_with(*name);
  });
}

Image read_in_rec709(const fs::path& path, ExrMetadata* metadata) {
  ExrMetadata own;
  std::optional<Primaries> primaries;
  Image image = read_exr(path, &own, &primaries);
  const Primaries& rec709 = *find_interop_space(rec709_id);
  if (primaries && *primaries != rec709) {
    const ColorMatrix to_rec709 = conversion(*primaries, rec709);
    for (std::size_t c = 0; c < image.channels.size(); ++c) {
      const std::string& name = image.channels[c];
      const std::string layer = name == "R" ? "" : name.ends_with(".R") ? name.substr(0, name.size() - 1) : "-";
      const int green = image.channel(layer + "G"), blue = image.channel(layer + "B");
      if (layer == "-" || green < 0 || blue < 0 || !is_of_colors(layer, own)) continue;
      // Variances are not linear in the colours: those of Rec.709 cannot be told from them.
      if (layer == "variance.") {
        for (const int channel : {static_cast<int>(c), green, blue})
          image.channels[static_cast<std::size_t>(channel)].insert(0, "other_");
        continue;
      }
      for (std::size_t i = 0; i < image.pixels.size(); i += image.channels.size()) {
        float *r = &image.pixels[i + c], *g = &image.pixels[i + static_cast<std::size_t>(green)],
              *b = &image.pixels[i + static_cast<std::size_t>(blue)];
        const C3f color = linear_image(to_rec709, {*r, *g, *b});
        *r = color.x;
        *g = color.y;
        *b = color.z;
      }
    }
  }
  if (metadata != nullptr) *metadata = std::move(own);
  return image;
}

void decode_srgb(Image& image) {
  const int alpha = image.channel("A");
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    if (static_cast<int>(i % image.channels.size()) != alpha) image.pixels[i] = srgb_decode(image.pixels[i]);
}

}  // namespace

void check_picture_path(const fs::path& path) {
  (void)format_of(path);
  check_writable(path);
}

bool is_display_referred(const fs::path& path) { return format_of(path) == Format::raster; }

void write_picture(const fs::path& path, const Image& scene_linear, const DisplayTransform* display,
                   const ExrOptions& options) {
  if (format_of(path) == Format::exr) return write_exr(path, scene_linear, options);
  std::optional<DisplayTransform> usual;
  if (display == nullptr) display = &usual.emplace();
  write_raster(path, seen_through(scene_linear, *display, path.string()), options.data_offset);
}

Image read_picture(const fs::path& path, ExrMetadata* metadata) {
  if (extension_of(path) == ".exr") return read_in_rec709(path, metadata);
  RasterImage raster = read_raster(path);
  if (raster.display_referred) decode_srgb(raster.image);
  premultiply(raster.image);
  return std::move(raster.image);
}

}  // namespace twopass
