// Power in whole units, which rays carry and a ledger accounts for to the last unit (R28).
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>

#include "radiosity/stochastic.h"

namespace twopass {

/// What one ray carries, units of each channel.
struct Parcel {
  PowerUnits power;

  [[nodiscard]] bool is_empty() const { return power[0] == 0 && power[1] == 0 && power[2] == 0; }
};

/// The float next to the whole number x that is not above `most` >= x: itself a whole number. Rounding down
/// always would lose 4e-8 at each of a thousand reflections.
inline float whole_float(std::int64_t x, std::int64_t most) {
  const auto nearest = static_cast<float>(x);
  return static_cast<std::int64_t>(nearest) > most ? std::nextafter(nearest, 0.0f) : nearest;
}

/// x times a factor in [0, 1], rounded down.
inline std::int64_t portion(std::int64_t x, double factor) {
  return std::min(x, static_cast<std::int64_t>(static_cast<double>(x) * factor));
}

/// Ray k of n gets the n-th part of a power, the first ones a unit more.
inline Parcel share_of(const Parcel& all, std::uint32_t k, std::uint32_t n) {
  Parcel share;
  for (int c = 0; c < 3; ++c) share.power[c] = all.power[c] / n + (std::int64_t{k} < all.power[c] % n ? 1 : 0);
  return share;
}

/// What became of the rays of a piece of work.
struct Fate {
  PowerUnits absorbed{}, escaped{};
  std::uint64_t rays = 0;
};

/// The same of all of them. Sums of integers, so the order of threads does not matter.
struct Ledger {
  std::array<std::atomic<std::int64_t>, 3> absorbed{}, escaped{};
  std::atomic<std::uint64_t> rays{0};

  void add(const Fate& fate) {
    for (int c = 0; c < 3; ++c) {
      absorbed[c].fetch_add(fate.absorbed[c], std::memory_order_relaxed);
      escaped[c].fetch_add(fate.escaped[c], std::memory_order_relaxed);
    }
    rays.fetch_add(fate.rays, std::memory_order_relaxed);
  }
};

}  // namespace twopass
