// A running hash of numbers, bit by bit: tells scenes and lights apart. The same on every machine.
#pragma once

#include <bit>

#include "render/core/sampler.h"

namespace twopass {

/// Order matters; so does where one list ends and the next begins: hash the sizes, too.
class DataHash {
 public:
  void add(std::uint64_t word) { state_ = hash_word(state_ * 0x9e3779b97f4a7c15u + word + 1); }
  void add(float x) { add(std::uint64_t{std::bit_cast<std::uint32_t>(x)}); }
  void add(const V3f& v) {
    add(std::uint64_t{std::bit_cast<std::uint32_t>(v.x)} << 32 | std::bit_cast<std::uint32_t>(v.y));
    add(v.z);
  }
  void add(const V3u& v) {
    add(std::uint64_t{v.x} << 32 | v.y);
    add(std::uint64_t{v.z});
  }
  [[nodiscard]] std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0;
};

}  // namespace twopass
