#include "render/image/raster_file.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <string>
#include <system_error>

#include "render/core/error.h"
#include "render/core/sampler.h"
#include "render/image/atomic_file.h"
#include "render/image/oiio_loader.h"
#include "render/image/regular_file.h"

namespace twopass {
namespace {

namespace fs = std::filesystem;

// What the module hands over, whether it encodes or decodes.
struct Exchange {
  std::vector<std::byte> bytes;
  RasterImage picture;
  std::string problem;

  static void take_bytes(void* self, const void* data, std::size_t size) {
    const auto* first = static_cast<const std::byte*>(data);
    static_cast<Exchange*>(self)->bytes.assign(first, first + size);
  }
  static void take_problem(void* self, const void* text, std::size_t size) {
    std::string& problem = static_cast<Exchange*>(self)->problem;
    problem.assign(static_cast<const char*>(text), size);
    std::replace(problem.begin(), problem.end(), '\n', ',');  // an error is one line
  }
  static float* allocate(void* self, const TwopassPicture* picture) {
    constexpr std::int64_t most_values = std::int64_t{1} << 30;
    if (picture->width < 1 || picture->height < 1 ||
        picture->width > most_values / picture->height / picture->channel_count)
      return nullptr;
    std::vector<std::string> names;
    for (std::string_view rest = picture->channels; !rest.empty();) {
      const std::size_t end = std::min(rest.find('\n'), rest.size());
      names.emplace_back(rest.substr(0, end));
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    RasterImage& result = static_cast<Exchange*>(self)->picture;
    result.image = Image(picture->width, picture->height, std::move(names));
    result.display_referred = picture->is_integer != 0;
    return result.image.pixels.data();
  }
};

// What is added before digits are cut off: in [0, 1), independent between pixels and channels of a frame.
struct Dither {
  V2i corner;
  [[nodiscard]] double operator()(int x, int y, int channel) const {
    const std::uint64_t place =
        hash_words(static_cast<std::uint32_t>(x + corner.x), static_cast<std::uint32_t>(y + corner.y));
    return 0x1p-32 * static_cast<double>(hash_word(place + static_cast<std::uint64_t>(channel)) >> 32);
  }
};
struct Nearest {
  double operator()(int, int, int) const { return 0.5; }
};

template <class Integer, class Rounding>
std::vector<Integer> quantized(const Image& image, std::string_view where, const Rounding& rounding) {
  constexpr double white = std::numeric_limits<Integer>::max();
  std::vector<Integer> samples;
  samples.reserve(3 * image.pixel_count());
  const std::vector<C3f> pixels = rgb_pixels(image, where);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const C3f& c = pixels[samples.size() / 3];
      for (int i = 0; i < 3; ++i) {
        const float value = std::isfinite(c[i]) ? std::clamp(c[i], 0.0f, 1.0f) : 0.0f;
        samples.push_back(static_cast<Integer>(std::min(std::floor(value * white + rounding(x, y, i)), white)));
      }
    }
  return samples;
}

std::string format_of(const fs::path& path) {
  std::string extension = path.extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

template <class Rounding>
std::vector<std::byte> encoded(const Image& image, const std::string& format, std::string_view where,
                               const Rounding& rounding) {
  const bool deep = format.starts_with("tif");
  const std::vector<std::uint16_t> samples16 =
      deep ? quantized<std::uint16_t>(image, where, rounding) : std::vector<std::uint16_t>();
  const std::vector<std::uint8_t> samples8 =
      deep ? std::vector<std::uint8_t>() : quantized<std::uint8_t>(image, where, rounding);
  const TwopassRaster raster{format.c_str(), image.width, image.height, deep ? 16 : 8,
                             deep ? static_cast<const void*>(samples16.data()) : samples8.data()};
  Exchange exchange;
  if (oiio_module().encode(&raster, Exchange::take_bytes, Exchange::take_problem, &exchange) == 0)
    throw Error(where, "it cannot be encoded: " + exchange.problem, "use .png or .exr");
  return std::move(exchange.bytes);
}

}  // namespace

void write_raster(const fs::path& path, const Image& image, const V2i& corner) {
  write_atomically(path, encoded(image, format_of(path), path.string(), Dither{corner}));
}

std::vector<std::byte> encode_png(const Image& image) { return encoded(image, "png", "picture", Nearest{}); }

RasterImage read_raster(const fs::path& path) {
  check_regular_file(path);
  Exchange exchange;
  if (oiio_module().decode(path.c_str(), Exchange::allocate, Exchange::take_problem, &exchange) == 0)
    throw Error(path.string(), "it cannot be read: " + exchange.problem, "convert it to .png or .exr");
  return std::move(exchange.picture);
}

}  // namespace twopass
