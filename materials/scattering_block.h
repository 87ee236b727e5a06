// Scattering at many points at once: rough plastics with GGX's facets in vector lanes (M33).
#pragma once

#include "materials/bsdf.h"
#include "render/core/lanes.h"

namespace twopass {

/// Up to block_size points, each with its model and seen from one direction. Of those whose model has lanes it
/// says, to the bit, what the model says of each alone.
class ScatteringBlock {
 public:
  /// Starts over with models at points `k` of `points`, in any order: `bsdf(k)`, seen from `wo(k)`. The latter
  /// is asked for only where the model has lanes.
  template <class Points, class BsdfAt, class WoAt>
  void reset(const Points& points, const BsdfAt& bsdf, const WoAt& wo) {
    count_ = 0;
    for (const std::size_t k : points) {
      const auto* plastic = std::get_if<RoughPlastic>(&bsdf(k));
      const bool has_lanes = plastic && plastic->distribution == Microfacet::ggx;
      lane_[k] = has_lanes ? count_++ : none;
      if (has_lanes) put(lane_[k], *plastic, wo(k));
    }
    if (!empty()) prepare();
  }
  [[nodiscard]] bool has(std::size_t k) const { return lane_[k] != none; }
  [[nodiscard]] bool empty() const { return count_ == 0; }

  /// Sets the other direction, for evaluate(), or the random numbers, for sample(). Without effect where
  /// !has(k).
  void set_wi(std::size_t k, const V3f& wi) {
    const std::size_t i = lane_[k];
    wi_x_[i] = wi.x, wi_y_[i] = wi.y, wi_z_[i] = wi.z;
  }
  void set_u(std::size_t k, const V2f& u) {
    const std::size_t i = lane_[k];
    u_x_[i] = u.x, u_y_[i] = u.y;
  }

  /// Finds value() of all points.
  void evaluate();
  /// Draws the other directions, drawn() of all points; sets value() as well.
  void sample();

  /// REQUIRES: has(k).
  [[nodiscard]] BsdfValue value(std::size_t k) const {
    const std::size_t i = lane_[k];
    return {C3f(value_r_[i], value_g_[i], value_b_[i]), pdf_w_[i]};
  }
  /// REQUIRES: has(k).
  [[nodiscard]] std::optional<BsdfSample> drawn(std::size_t k) const {
    const std::size_t i = lane_[k];
    return RoughPlastic::drawn({wi_x_[i], wi_y_[i], wi_z_[i]}, value(k));
  }

 private:
  using Lane = std::uint8_t;
  static constexpr Lane none = block_size;

  void put(std::size_t i, const RoughPlastic& plastic, const V3f& wo) {
    coat_[i] = plastic.coat;
    wo_x_[i] = wo.x, wo_y_[i] = wo.y, wo_z_[i] = wo.z;
    alpha_[i] = plastic.alpha;
    eta_[i] = plastic.eta;
    const C3f &specular = plastic.specular_reflectance, &base = plastic.base_reflectance;
    specular_r_[i] = specular.x, specular_g_[i] = specular.y, specular_b_[i] = specular.z;
    base_r_[i] = base.x, base_g_[i] = base.y, base_b_[i] = base.z;
    nonlinear_[i] = plastic.nonlinear ? 1.0f : 0.0f;
    escape_[i] = plastic.coat->escape;
    through_[i] = plastic.coat->transmittance_at(wo.z);
  }
  [[nodiscard]] RoughPlasticView view(std::size_t i) const {
    return {V3f(wo_x_[i], wo_y_[i], wo_z_[i]),
            MicrofacetDistribution(Microfacet::ggx, alpha_[i], alpha_[i]),
            eta_[i],
            C3f(specular_r_[i], specular_g_[i], specular_b_[i]),
            C3f(base_r_[i], base_g_[i], base_b_[i]),
            through_[i],
            coat_probability_[i]};
  }
  void prepare();

  Lane count_ = 0;
  std::array<Lane, block_size> lane_;              // by point
  std::array<const CoatTable*, block_size> coat_;  // this and all that follows by lane
  Lanes wo_x_, wo_y_, wo_z_, alpha_, eta_, specular_r_, specular_g_, specular_b_, nonlinear_, escape_, through_,
      coat_probability_;
  Lanes base_r_, base_g_, base_b_;  // its reflectance; from prepare() on, what it shows after bounces
  Lanes wi_x_, wi_y_, wi_z_, through_in_, u_x_, u_y_, value_r_, value_g_, value_b_, pdf_w_;
};

}  // namespace twopass
