#include "materials/diffuse_response.h"

#include <numeric>

#include "materials/lobes.h"
#include "render/core/warp.h"

namespace twopass {

namespace {

// The directional albedo of the diffuse part, mean of the channels: what light from there leaves in all
// directions, and, by reciprocity, what evenly distributed light leaves in that one.
double diffuse_albedo_at(const Bsdf& bsdf, double cosine) {
  constexpr int rings = 16, sectors = 16;
  const auto z = static_cast<float>(std::max(cosine, 1e-3));
  const V3f wo(std::sqrt(std::max(0.0f, 1.0f - z * z)), 0.0f, z);
  double sum = 0.0;
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < sectors; ++j) {
      const V3f wi = square_to_cosine_hemisphere(
          {(static_cast<float>(i) + 0.5f) / rings, (static_cast<float>(j) + 0.5f) / sectors});
      sum += static_cast<double>(mean_component(eval_diffuse(bsdf, wo, wi)) / cosine_hemisphere_pdf_w(wi.z));
    }
  return sum / (rings * sectors);
}

}  // namespace

DiffuseResponse::DiffuseResponse(const MaterialSide& side) {
  at_.fill(1.0);
  if (is_black(side.traits().mean_diffuse_reflectance) || !is_more_than_diffuse(side)) return;
  std::array<double, steps + 1> albedo{};
  constexpr int choices = 4;
  for (int c = 0; c < choices; ++c) {
    ShadingGeometry anywhere;
    Bsdf bsdf =
        side.is_uniform() ? side.uniform() : side.resolve(anywhere, (static_cast<float>(c) + 0.5f) / choices);
    for (std::size_t k = 0; k <= steps; ++k)
      albedo[k] += diffuse_albedo_at(bsdf, static_cast<double>(k) / steps);
    if (side.is_uniform()) break;
  }
  // The mean over evenly distributed light, 2 times the integral of a(c) c dc, exact for what is linear
  // between.
  double mean = 0.0;
  for (std::size_t k = 0; k < steps; ++k) {
    const double a = albedo[k], slope = albedo[k + 1] - a, c0 = static_cast<double>(k) / steps, h = 1.0 / steps;
    mean += 2.0 * h * (a * c0 + (a * h + slope * c0) / 2.0 + slope * h / 3.0);
  }
  if (!(mean > 0.0)) return;
  is_even_ = false;
  for (std::size_t k = 0; k <= steps; ++k) at_[k] = albedo[k] / mean;
}

}  // namespace twopass
