#include "render/image/texture_image.h"

#include <cassert>
#include <cstring>

#include <Imath/half.h>

#include "render/core/parallel.h"
#include "render/core/sampler.h"
#include "render/image/half_value.h"
#include "render/image/tiled_levels.h"

namespace twopass {

namespace {

// Four numbers side by side: the channels of a texel.
using Floats [[gnu::vector_size(16)]] = float;
using Words [[gnu::vector_size(16)]] = std::uint32_t;
using Halfs [[gnu::vector_size(8)]] = std::uint16_t;

std::size_t size_of(TexelFormat format) {
  return format == TexelFormat::byte ? 1 : format == TexelFormat::half ? 2 : 4;
}

// The values of one level, by number of the sample.
template <TexelFormat format>
struct Samples {
  const std::byte* bytes;
  const float* values_of_codes;
  float operator[](std::size_t i) const {
    if constexpr (format == TexelFormat::byte) return values_of_codes[std::to_integer<std::size_t>(bytes[i])];
    if constexpr (format == TexelFormat::half) {
      std::uint16_t bits;
      std::memcpy(&bits, bytes + 2 * i, 2);
      return value_of_half(bits);
    }
    float value;
    std::memcpy(&value, bytes + 4 * i, 4);
    return value;
  }
  // Three of them; the fourth number is any.
  [[nodiscard]] Floats three(std::size_t i) const {
    if constexpr (format == TexelFormat::half) {
      std::uint32_t first;
      std::uint16_t last;
      std::memcpy(&first, bytes + 2 * i, 4);
      std::memcpy(&last, bytes + 2 * i + 4, 2);
      const auto bits = std::bit_cast<Halfs>(std::uint64_t{last} << 32 | first);
      return value_of_half<Floats>(__builtin_convertvector(bits, Words));
    }
    return Floats{(*this)[i], (*this)[i + 1], (*this)[i + 2], 0.0f};
  }
};

// Calls visit(samples) with the samples in their format.
template <class Visit>
auto with_samples(const TexelLevel& level, const std::vector<float>& values_of_codes, const Visit& visit) {
  switch (level.format) {
    case TexelFormat::byte:
      return visit(Samples<TexelFormat::byte>{level.bytes.data(), values_of_codes.data()});
    case TexelFormat::half:
      return visit(Samples<TexelFormat::half>{level.bytes.data(), nullptr});
    default:
      return visit(Samples<TexelFormat::single>{level.bytes.data(), nullptr});
  }
}

template <class Values>
Floats texel_at(const Values& values, std::size_t texel, int channels) {
  return channels == 1 ? Floats{} + values[texel] : values.three(3 * texel);
}
C3f color_of(const Floats& texel) { return {texel[0], texel[1], texel[2]}; }

// The share of each source texel in a texel of the next level along one axis: two, or three where the size is
// odd.
struct Taps {
  int first, count;
  float weights[3];
};
std::vector<Taps> taps_of(int from, int to) {
  std::vector<Taps> result;
  const double step = static_cast<double>(from) / to;
  for (int i = 0; i < to; ++i) {
    const double begin = i * step, end = (i + 1) * step;
    Taps taps{static_cast<int>(begin), 0, {}};
    for (int j = taps.first; j < from && j < end && taps.count < 3; ++j)
      taps.weights[taps.count++] =
          static_cast<float>((std::min(end, j + 1.0) - std::max(begin, double(j))) / step);
    result.push_back(taps);
  }
  return result;
}

void store(TexelLevel& level, std::size_t i, float value) {
  if (level.format == TexelFormat::single) {
    std::memcpy(&level.bytes[4 * i], &value, 4);
    return;
  }
  const std::uint16_t bits = Imath::half(value).bits();
  std::memcpy(&level.bytes[2 * i], &bits, 2);
}

TexelLevel next_level(const TexelLevel& from, int channels, const std::vector<float>& values_of_codes) {
  TexelLevel level{std::max(1, from.width / 2),
                   std::max(1, from.height / 2),
                   from.format == TexelFormat::single ? TexelFormat::single : TexelFormat::half,
                   {}};
  const auto row_size = static_cast<std::size_t>(level.width * channels);
  level.bytes.resize(row_size * static_cast<std::size_t>(level.height) * size_of(level.format));
  const std::vector<Taps> columns = taps_of(from.width, level.width), rows = taps_of(from.height, level.height);
  const auto from_row_size = static_cast<std::size_t>(from.width * channels);
  with_samples(from, values_of_codes, [&](const auto& samples) {
    parallel_for(static_cast<std::size_t>(level.height), 16, [&](std::size_t begin, std::size_t end) {
      std::vector<float> sums(from_row_size);
      for (std::size_t y = begin; y < end; ++y) {
        std::ranges::fill(sums, 0.0f);
        for (int j = 0; j < rows[y].count; ++j) {
          const std::size_t row = static_cast<std::size_t>(rows[y].first + j) * from_row_size;
          for (std::size_t i = 0; i < from_row_size; ++i) sums[i] += rows[y].weights[j] * samples[row + i];
        }
        for (int x = 0; x < level.width; ++x)
          for (int c = 0; c < channels; ++c) {
            const Taps& taps = columns[static_cast<std::size_t>(x)];
            float sum = 0.0f;
            for (int i = 0; i < taps.count; ++i)
              sum += taps.weights[i] * sums[static_cast<std::size_t>((taps.first + i) * channels + c)];
            store(level, y * row_size + static_cast<std::size_t>(x * channels + c), sum);
          }
      }
    });
  });
  return level;
}

C3f mean_of(const TexelLevel& level, int channels, const std::vector<float>& values_of_codes) {
  const auto count = static_cast<std::size_t>(level.width) * static_cast<std::size_t>(level.height);
  C3d sum(0.0);
  with_samples(level, values_of_codes, [&](const auto& samples) {
    for (std::size_t i = 0; i < count; ++i) sum += C3d(color_of(texel_at(samples, i, channels)));
  });
  return C3f(sum / static_cast<double>(count));
}

std::uint64_t hash_of(std::span<const std::byte> bytes, std::uint64_t seed) {
  std::uint64_t hash = hash_word(seed + bytes.size());
  for (; bytes.size() >= 8; bytes = bytes.subspan(8)) {
    std::uint64_t word;
    std::memcpy(&word, bytes.data(), 8);
    hash = (hash ^ word) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 29;
  }
  std::uint64_t rest = 0;
  if (!bytes.empty()) std::memcpy(&rest, bytes.data(), bytes.size());
  return hash_word(hash ^ rest);
}

}  // namespace

TextureImage::TextureImage(const Image& image) {
  const std::vector<C3f> pixels = rgb_pixels(image);
  assert(!pixels.empty());
  TexelLevel level{image.width, image.height, TexelFormat::single, {}};
  level.bytes.resize(pixels.size() * sizeof(C3f));
  std::memcpy(level.bytes.data(), pixels.data(), level.bytes.size());
  levels_.push_back(std::move(level));
  finish();
}

TextureImage::TextureImage(TexelLevel finest, int channels, std::vector<float> values_of_codes)
    : channels_(channels), values_of_codes_(std::move(values_of_codes)) {
  assert(finest.width > 0 && finest.height > 0);
  levels_.push_back(std::move(finest));
  finish();
}

TextureImage::TextureImage(std::unique_ptr<const TiledLevels> tiles) : tiles_(std::move(tiles)) {
  for (const V2i& size : tiles_->sizes()) levels_.push_back({size.x, size.y, TexelFormat::single, {}});
  mean_ = tiles_->texel(level_count() - 1, 0, 0);
  content_hash_ = tiles_->content_hash();
}

TextureImage::~TextureImage() = default;

void TextureImage::finish() {
  while (levels_.back().width > 1 || levels_.back().height > 1)
    levels_.push_back(next_level(levels_.back(), channels_, values_of_codes_));
  mean_ = mean_of(levels_.front(), channels_, values_of_codes_);
  const std::uint64_t shape = std::uint64_t(width()) << 34 | std::uint64_t(height()) << 4 |
                              std::uint64_t(levels_.front().format) << 2 | std::uint64_t(channels_);
  content_hash_ = hash_of(levels_.front().bytes, hash_of(std::as_bytes(std::span(values_of_codes_)), shape));
}

C3f TextureImage::texel(int level, int x, int y) const {
  if (tiles_) return tiles_->texel(level, x, y);
  const TexelLevel& l = levels_[static_cast<std::size_t>(level)];
  const std::size_t index =
      static_cast<std::size_t>(y) * static_cast<std::size_t>(l.width) + static_cast<std::size_t>(x);
  return with_samples(l, values_of_codes_,
                      [&](const auto& samples) { return color_of(texel_at(samples, index, channels_)); });
}

template <class Visit>
auto TextureImage::with_patch(int level, const V2i& x, const V2i& y, const Visit& visit) const {
  const TexelLevel& l = levels_[static_cast<std::size_t>(level)];
  const std::size_t width = static_cast<std::size_t>(l.width), left = static_cast<std::size_t>(x.x),
                    right = static_cast<std::size_t>(x.y), upper = static_cast<std::size_t>(y.x) * width,
                    lower = static_cast<std::size_t>(y.y) * width;
  return with_samples(l, values_of_codes_, [&](const auto& samples) {
    return visit(texel_at(samples, upper + left, channels_), texel_at(samples, upper + right, channels_),
                 texel_at(samples, lower + left, channels_), texel_at(samples, lower + right, channels_));
  });
}

TexelPatch TextureImage::patch(int level, const V2i& x, const V2i& y) const {
  if (tiles_) return tiles_->patch(level, x, y);
  return with_patch(level, x, y,
                    [](const Floats& c00, const Floats& c10, const Floats& c01, const Floats& c11) {
                      return TexelPatch{color_of(c00), color_of(c10), color_of(c01), color_of(c11)};
                    });
}

C3f TextureImage::mix(int level, const V2i& x, const V2i& y, const V2f& at) const {
  const auto mixed = [&at](const auto& c00, const auto& c10, const auto& c01, const auto& c11) {
    const auto upper = c00 * (1.0f - at.x) + c10 * at.x, lower = c01 * (1.0f - at.x) + c11 * at.x;
    return upper * (1.0f - at.y) + lower * at.y;
  };
  if (tiles_) {
    const TexelPatch p = tiles_->patch(level, x, y);
    return mixed(p.c00, p.c10, p.c01, p.c11);
  }
  return color_of(with_patch(level, x, y, mixed));
}

std::size_t TextureImage::memory() const {
  std::size_t sum = sizeof(*this);
  for (const TexelLevel& level : levels_) sum += level.bytes.size();
  return sum;
}

std::uint64_t TextureImage::unreadable_tiles() const { return tiles_ ? tiles_->unreadable() : 0; }

std::uint64_t TextureImage::not_finite() const { return tiles_ ? tiles_->not_finite() : 0; }

bool TextureImage::has_same_texels(const TextureImage& other) const {
  if (tiles_ || other.tiles_) return this == &other;
  return content_hash_ == other.content_hash_ && channels_ == other.channels_ && width() == other.width() &&
         height() == other.height() && values_of_codes_ == other.values_of_codes_ &&
         levels_.front().format == other.levels_.front().format &&
         levels_.front().bytes == other.levels_.front().bytes;
}

}  // namespace twopass
