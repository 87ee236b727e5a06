// An orthonormal basis around a normal; directions in and out of it.
#pragma once

#include "render/core/types.h"

namespace twopass {

/// Right-handed orthonormal basis (s, t, n). n is unit length.
struct Frame {
  V3f s, t, n;

  Frame() = default;
  /// Branch-free construction from a unit normal, accurate for every direction (Duff et al., JCGT 6(1), 2017).
  explicit Frame(const V3f& normal) : n(normal) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    s = V3f(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
    t = V3f(b, sign + n.y * n.y * a, -n.y);
  }

  [[nodiscard]] V3f to_local(const V3f& w) const { return {w.dot(s), w.dot(t), w.dot(n)}; }
  [[nodiscard]] V3f to_world(const V3f& w) const { return s * w.x + t * w.y + n * w.z; }
};

}  // namespace twopass
