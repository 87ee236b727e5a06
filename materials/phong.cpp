#include "materials/phong.h"

#include "materials/lobe_choice.h"
#include "render/core/frame.h"
#include "render/core/warp.h"

namespace twopass {

namespace {

/// Probability of sampling the lobe. NaN for a black surface.
float lobe_probability(const Phong& phong) {
  const float lobe = mean_component(phong.specular_reflectance), base = mean_component(phong.base_reflectance);
  return lobe / (lobe + base);
}

/// cos^exponent of the angle to the mirror direction.
float lobe_power(const V3f& wo, const V3f& wi, float exponent) {
  const float cosine = wi.z * wo.z - wi.x * wo.x - wi.y * wo.y;
  return cosine > 0.0f ? std::pow(std::min(cosine, 1.0f), exponent) : 0.0f;
}

}  // namespace

C3f Phong::eval(const V3f& wo, const V3f& wi) const {
  if (!(wi.z > 0.0f)) return C3f(0.0f);
  const float lobe = (exponent + 2.0f) * 0.5f * lobe_power(wo, wi, exponent);
  return (specular_reflectance * lobe + base_reflectance) * cosine_hemisphere_pdf_w(wi.z);
}

C3f Phong::eval_diffuse(const V3f&, const V3f& wi) const {
  return base_reflectance * cosine_hemisphere_pdf_w(wi.z);
}

float Phong::pdf_w(const V3f& wo, const V3f& wi) const {
  const float p = lobe_probability(*this);
  if (!(wi.z > 0.0f && p >= 0.0f)) return 0.0f;
  const float lobe = (exponent + 1.0f) * (0.5f / pi_f) * lobe_power(wo, wi, exponent);
  return p * lobe + (1.0f - p) * cosine_hemisphere_pdf_w(wi.z);
}

std::optional<BsdfSample> Phong::sample(const V3f& wo, const V2f& u) const {
  const float p = lobe_probability(*this);
  if (!(p >= 0.0f)) return std::nullopt;
  V2f rest = u;
  V3f wi;
  if (choose(rest.x, p)) {
    // 1 - cos^2 from the logarithm, without cancellation in narrow lobes.
    const float log_cosine = std::log(1.0f - rest.x) / (exponent + 1.0f);
    const V2f around = circle(rest.y) * std::sqrt(-std::expm1(2.0f * log_cosine));
    wi = unit(Frame(V3f(-wo.x, -wo.y, wo.z)).to_world(V3f(around.x, around.y, std::exp(log_cosine))));
  } else {
    wi = square_to_cosine_hemisphere(rest);
  }
  const float pdf = pdf_w(wo, wi);
  if (!(pdf > 0.0f)) return std::nullopt;
  return BsdfSample{wi, eval(wo, wi) * (1.0f / pdf), pdf, 1.0f, false};
}

}  // namespace twopass
