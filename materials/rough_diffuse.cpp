#include "materials/rough_diffuse.h"

#include "render/core/warp.h"

namespace twopass {

namespace {

/// The factors of Oren and Nayar (SIGGRAPH 1994, equations 27 to 30) that depend on the roughness only. Their
/// sigma, an angle, is alpha / sqrt(2): a fit of Mitsuba's.
struct Factors {
  float constant, shaded, lit_between, interreflected;

  Factors(float alpha, bool fast) {
    const float s2 = 0.5f * alpha * alpha;
    constant = 1.0f - 0.5f * s2 / (s2 + 0.33f);
    shaded = 0.45f * s2 / (s2 + 0.09f);
    lit_between = fast ? 0.0f : 0.125f * s2 / (s2 + 0.09f);
    interreflected = fast ? 0.0f : 0.17f * s2 / (s2 + 0.13f);
  }
};

float sine(const V3f& w) { return std::sqrt(w.x * w.x + w.y * w.y); }

/// Cosine of the difference in azimuth; 0 when a direction has none.
float cos_azimuth(const V3f& a, const V3f& b) {
  const float length = sine(a) * sine(b);
  return length > 0.0f ? std::clamp((a.x * b.x + a.y * b.y) / length, -1.0f, 1.0f) : 0.0f;
}

}  // namespace

C3f RoughDiffuse::eval(const V3f& wo, const V3f& wi) const {
  if (!(wi.z > 0.0f)) return C3f(0.0f);
  const Factors factors(alpha, use_fast_approx);
  const V3f &low = wo.z < wi.z ? wo : wi, &high = wo.z < wi.z ? wi : wo;  // by height over the surface
  const float sin_low = sine(low), sin_high = sine(high), tan_high = sin_high / high.z;
  const float cos_phi = cos_azimuth(wo, wi), lambert = cosine_hemisphere_pdf_w(wi.z);
  if (use_fast_approx)
    return reflectance *
           (lambert * (factors.constant + factors.shaded * std::max(cos_phi, 0.0f) * sin_low * tan_high));

  const float theta_low = std::atan2(sin_low, low.z), theta_high = std::atan2(sin_high, high.z);
  const float turned = 2.0f / pi_f * theta_high, both = turned * (2.0f / pi_f) * theta_low;
  const float shaded = sin_low - (cos_phi < 0.0f ? turned * turned * turned : 0.0f);
  const float tan_half = (sin_low + sin_high) / (low.z + high.z);
  const float once = factors.constant + factors.shaded * cos_phi * shaded * tan_high +
                     factors.lit_between * (1.0f - std::abs(cos_phi)) * both * both * tan_half;
  const float twice = factors.interreflected * (1.0f - cos_phi * turned * turned);
  return (reflectance * once + reflectance * reflectance * twice) * lambert;
}

float RoughDiffuse::pdf_w(const V3f&, const V3f& wi) const { return cosine_hemisphere_pdf_w(wi.z); }

std::optional<BsdfSample> RoughDiffuse::sample(const V3f& wo, const V2f& u) const {
  const V3f wi = square_to_cosine_hemisphere(u);
  const float pdf = pdf_w(wo, wi);
  if (!(pdf > 0.0f) || is_black(reflectance)) return std::nullopt;
  return BsdfSample{wi, eval(wo, wi) * (1.0f / pdf), pdf, 1.0f, false};
}

C3f RoughDiffuse::diffuse_reflectance() const {
  // The means of the terms over cosine-distributed pairs of directions are numbers (quadrature; equation M12).
  const Factors factors(alpha, use_fast_approx);
  if (use_fast_approx) return reflectance * (factors.constant + 0.213959273f * factors.shaded);
  return reflectance * (factors.constant + 0.043502278f * factors.shaded + 0.065506088f * factors.lit_between) +
         reflectance * reflectance * factors.interreflected;
}

}  // namespace twopass
