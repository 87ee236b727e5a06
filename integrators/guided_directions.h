// Drawing the next direction of a path from a guide and a scattering model together.
#pragma once

#include "radiosity/guide.h"

namespace twopass {

/// With the probability `share` from a guide, else from the scattering model: one sample, weighed by the
/// density of both together (I11), so that its weight stays bounded where the guide is wrong.
class GuidedDirections {
 public:
  /// REQUIRES: model, shading frame and guide outlive this; the guide is not empty; share in (0, 1].
  GuidedDirections(const Bsdf& bsdf, const V3f& wo, const Frame& shading, const Guide::Lobe& guide, float share)
      : bsdf_(bsdf), wo_(wo), shading_(shading), guide_(guide), share_(share) {}

  /// `row`: that of u.y in the guide.
  [[nodiscard]] std::optional<BsdfSample> sample(V2f u, int row) const {
    if (share_ == 1.0f || choose(u.x, share_)) {
      const Guide::Lobe::Direction drawn = guide_.sample(u, row);
      // On the horizon, where rounding lets the model still see it.
      if (!(drawn.pdf_w > 0.0f)) return std::nullopt;
      const V3f wi = shading_.to_local(drawn.direction);
      const C3f scattered = eval(bsdf_, wo_, wi);
      if (is_black(scattered)) return std::nullopt;
      const float pdf = mixed(drawn.pdf_w, wi);
      return BsdfSample{wi, scattered * (1.0f / pdf), pdf, 1.0f, false};
    }
    std::optional<BsdfSample> drawn = twopass::sample(bsdf_, wo_, u);
    if (!drawn) return std::nullopt;
    if (drawn->is_specular) {
      drawn->weight *= 1.0f / (1.0f - share_);
      return drawn;
    }
    const float own = drawn->pdf_w;
    drawn->pdf_w = share_ * guide_.pdf_w(shading_.to_world(drawn->wi)) + (1.0f - share_) * own;
    drawn->weight *= own / drawn->pdf_w;
    return drawn;
  }

 private:
  [[nodiscard]] float mixed(float of_guide, const V3f& wi) const {
    return share_ == 1.0f ? of_guide : share_ * of_guide + (1.0f - share_) * twopass::pdf_w(bsdf_, wo_, wi);
  }

  const Bsdf& bsdf_;
  V3f wo_;
  const Frame& shading_;
  const Guide::Lobe& guide_;
  float share_;
};

}  // namespace twopass
