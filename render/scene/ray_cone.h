// How wide a beam one sample stands for: textures are looked at through it.
#pragma once

#include <algorithm>
#include <cmath>

#include "render/scene/camera.h"

namespace twopass {

/// A cone around a ray (M31): each sample of a pixel, and of a lobe that scatters it, stands for a share of it.
struct RayCone {
  float width = 0.0f;   ///< at the ray's origin
  float spread = 0.0f;  ///< growth of the width by distance
  float share = 0.0f;   ///< of a lobe's width that a sample stands for; 0: look-ups are not filtered at all

  [[nodiscard]] bool is_open() const { return share > 0.0f; }
  [[nodiscard]] float width_at(float distance) const { return width + spread * distance; }
  /// After `distance`, scattered into a direction that was drawn with density `pdf_w`; mirrors and glass
  /// (Dirac) leave the spread as it is.
  [[nodiscard]] RayCone scattered(float distance, float pdf_w, bool is_specular) const {
    // A quarter of what the samples leave between them: a blurred bounce is a bias that stays.
    const float lobe = is_specular ? 0.0f : std::min(0.25f * share / std::sqrt(pdf_w), 1.0f);
    return {width_at(distance), std::max(spread, lobe), share};
  }
};

/// The cone of a sample of a picture's narrowest pixel. `samples`: a pixel's; 0: not known, as many as count.
RayCone sample_cone(const Camera& camera, int width, int height, int samples);

}  // namespace twopass
