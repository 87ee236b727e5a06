#include "render/image/tiled_levels.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "render/core/error.h"
#include "render/core/sampler.h"
#include "render/image/half_value.h"
#include "render/image/oiio_loader.h"

namespace twopass {

namespace {

// The tiles that a thread looked at last, so that a look-up seldom asks the cache, which takes 0.3 us.
class RecentTiles {
 public:
  RecentTiles() = default;
  RecentTiles(const RecentTiles&) = delete;
  RecentTiles& operator=(const RecentTiles&) = delete;
  ~RecentTiles() {
    for (Slot& slot : slots_) release(slot);
  }

  // The pixels of a tile, or null when it cannot be read.
  const void* find(std::uint64_t key, const TwopassTiledPicture& picture, int level, int x, int y) {
    Slot& slot = slots_[hash_word(key) % slots_.size()];
    if (slot.key == key) return slot.tile.pixels;
    release(slot);
    if (oiio_module().tile(picture.image, level, x, y, &slot.tile) == 0) return nullptr;
    slot.key = key;
    return slot.tile.pixels;
  }

 private:
  static constexpr std::uint64_t no_key = ~std::uint64_t{0};
  struct Slot {
    std::uint64_t key = no_key;
    TwopassTile tile{};
  };
  static void release(Slot& slot) {
    if (slot.key != no_key) oiio_module().release_tile(slot.tile.tile);
    slot.key = no_key;
  }
  std::array<Slot, 128> slots_;
};

thread_local RecentTiles recent_tiles;

struct Problem {
  std::string text;
  static void report(void* self, const void* text, std::size_t size) {
    std::string& problem = static_cast<Problem*>(self)->text;
    problem.assign(static_cast<const char*>(text), size);
    std::ranges::replace(problem, '\n', ',');  // an error is one line
  }
};

std::uint64_t hash_of_file(const std::filesystem::path& path) {
  std::error_code ignored;
  std::uint64_t hash = hash_word(std::filesystem::file_size(path, ignored));
  hash = hash_word(hash ^ static_cast<std::uint64_t>(
                              std::filesystem::last_write_time(path, ignored).time_since_epoch().count()));
  for (const char c : std::filesystem::weakly_canonical(path, ignored).string())
    hash = hash_word(hash ^ static_cast<unsigned char>(c));
  return hash;
}

}  // namespace

struct TiledLevels::Reader {
  TexelDecoder decoder;
  std::atomic<std::uint64_t> not_finite{0};
  TwopassTexelConverter converter{};

  static void convert(void* self, const float* pixels, std::size_t count, float* values) {
    auto& reader = *static_cast<Reader*>(self);
    if (const std::size_t bad = reader.decoder.decode(pixels, count, values); bad > 0) reader.not_finite += bad;
    if (!reader.converter.as_half) return;
    // A half float has no room for more.
    const std::size_t size = count * static_cast<std::size_t>(reader.converter.channels);
    for (std::size_t i = 0; i < size; ++i) values[i] = std::clamp(values[i], -65504.0f, 65504.0f);
  }
};

void limit_tile_memory(double megabytes) { oiio_module().tile_cache_limit(megabytes); }

TiledLevels::TiledLevels(const std::filesystem::path& path, const TexelDecoder& decoder, bool as_half)
    : reader_(new Reader{decoder}), as_half_(as_half), content_hash_(hash_of_file(path)) {
  static std::atomic<std::uint32_t> count{0};
  number_ = count++;
  reader_->converter = {reader_, Reader::convert, decoder.channels(), as_half ? 1 : 0};
  Problem problem;
  if (oiio_module().open_tiles(path.c_str(), &reader_->converter, &picture_, Problem::report, &problem) == 0)
    throw Error(path.string(), "it cannot be read: " + problem.text, "convert it to .png or .exr");
  for (int i = 0; i < picture_.level_count; ++i) sizes_.emplace_back(picture_.widths[i], picture_.heights[i]);
}

std::uint64_t TiledLevels::not_finite() const { return reader_->not_finite; }

const void* TiledLevels::pixel(int level, int x, int y) const {
  const int tile_width = picture_.tile_widths[level], tile_height = picture_.tile_heights[level];
  const int column = x / tile_width, row = y / tile_height;
  const std::uint64_t key = std::uint64_t{number_} << 44 | std::uint64_t(level) << 39 |
                            std::uint64_t(row) << 20 | std::uint64_t(column);
  const auto* pixels = static_cast<const std::byte*>(recent_tiles.find(key, picture_, level, x, y));
  if (!pixels) {
    ++unreadable_;
    return nullptr;
  }
  const int at = (y - row * tile_height) * tile_width + (x - column * tile_width);
  return pixels + static_cast<std::size_t>(at * reader_->converter.channels) * (as_half_ ? 2 : 4);
}

C3f TiledLevels::texel(int level, int x, int y) const {
  const void* at = pixel(level, x, y);
  float values[3] = {0.0f, 0.0f, 0.0f};
  const int channels = reader_->converter.channels;
  if (!at) return C3f(0.0f);
  if (as_half_) {
    std::uint16_t bits[3];
    std::memcpy(bits, at, sizeof(bits[0]) * static_cast<std::size_t>(channels));
    for (int c = 0; c < channels; ++c) values[c] = value_of_half(bits[c]);
  } else {
    std::memcpy(values, at, sizeof(float) * static_cast<std::size_t>(channels));
  }
  return channels == 1 ? C3f(values[0]) : C3f(values[0], values[1], values[2]);
}

TexelPatch TiledLevels::patch(int level, const V2i& x, const V2i& y) const {
  return {texel(level, x.x, y.x), texel(level, x.y, y.x), texel(level, x.x, y.y), texel(level, x.y, y.y)};
}

}  // namespace twopass
