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
  write_raster(path, seen_through(scene_linear, *display, path.string()));
}

Image read_picture(const fs::path& path, ExrMetadata* metadata) {
  if (extension_of(path) == ".exr") return read_exr(path, metadata);
  RasterImage raster = read_raster(path);
  if (raster.display_referred) decode_srgb(raster.image);
  premultiply(raster.image);
  return std::move(raster.image);
}

}  // namespace twopass
