// Cryptomatte 1.2: which share of a pixel belongs to which named thing, in ranked pairs of id and coverage
// (specification: Psyop, "Cryptomatte specification 1.2.0"). Knows no scene.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/image/image.h"

namespace twopass {

/// Appleby's MurmurHash3, the 32-bit variant, of the bytes with seed 0.
std::uint32_t murmur3_32(std::string_view text);
/// The hash of a UTF-8 name as the specification has it: bit 23 is flipped where the bits would be those of a
/// float that is zero, denormal, infinite or NaN, which files and programs would change.
std::uint32_t cryptomatte_hash(std::string_view name);
/// The float of the same bits: what is written into files.
float cryptomatte_id(std::uint32_t hash);
/// The name of a layer as its key in metadata: the first seven hexadecimal digits of the hash of its name.
std::string cryptomatte_key(std::string_view layer);
/// {"name":"hash as 8 hexadecimal digits",...}, sorted by name.
std::string cryptomatte_manifest(const std::map<std::string, std::uint32_t>& names);

/// Pairs that a layer keeps by default: 6 levels, in 3 layers of R, G, B, A.
inline constexpr int cryptomatte_levels = 6;

/// What a pixel has seen of one thing.
struct CryptoShare {
  std::uint32_t hash = 0;
  std::uint32_t count = 0;  ///< samples
  double weight = 0.0;      ///< sum of their filter weights
};

/// The pixels of one Cryptomatte layer: for each the things that its samples saw, in no more than `most_shares`
/// entries, those of least weight being dropped first. One thread owns a pixel, hence no locks.
class CryptoFilm {
 public:
  static constexpr std::size_t most_shares = 64;

  explicit CryptoFilm(std::size_t pixels) : pixels_(pixels) {}
  /// Adds a sample that saw a thing; those that saw nothing are not added.
  void add(std::size_t pixel, std::uint32_t hash, float weight) { add(pixel, {hash, 1, weight}); }
  /// Adds what another film, or a file, holds of a pixel.
  void add(std::size_t pixel, const CryptoShare& share);
  [[nodiscard]] std::span<const CryptoShare> shares(std::size_t pixel) const { return pixels_[pixel]; }
  [[nodiscard]] std::size_t pixel_count() const { return pixels_.size(); }

  /// The ranks of a pixel: pairs of id and coverage in [0, 1], largest coverage first, equal ones by hash;
  /// zeros behind the last one. `weight` and `samples` are those of all of the pixel's samples, by which
  /// coverage is filtered like the picture. REQUIRES: room for an even number of values.
  void resolve(std::size_t pixel, double weight, std::uint64_t samples, std::span<float> pairs) const;

 private:
  std::vector<std::vector<CryptoShare>> pixels_;
};

}  // namespace twopass
