// Compressed streams and checksums: the home of zlib.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace twopass {

/// Reads a zlib stream (RFC 1950) from memory, a piece at a time.
class Inflater {
 public:
  /// The most bytes that a byte of compressed data can become.
  static constexpr std::size_t largest_ratio = 1032;

  /// REQUIRES: the data outlives this; what follows the stream is not looked at.
  explicit Inflater(std::span<const std::byte> compressed);
  ~Inflater();
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  /// Fills `to`. False: the stream ended before, or is damaged.
  [[nodiscard]] bool read(std::span<std::byte> to);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// CRC-32 (ISO 3309) of all bytes.
std::uint32_t crc32_of(std::span<const std::byte> bytes);

}  // namespace twopass
