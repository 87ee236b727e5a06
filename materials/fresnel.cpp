#include "materials/fresnel.h"

namespace twopass {

namespace {
// From where on the fit of light from inside gives way to reciprocity: (1 - R_int) eta^2 = 1 - R_ext.
constexpr float most_of_fit = 2.0f;
}  // namespace

float fresnel_diffuse_escape(float eta) {
  if (eta <= most_of_fit) return 1.0f - fresnel_diffuse_reflectance(1.0f / eta);
  return (1.0f - fresnel_diffuse_reflectance(eta)) / (eta * eta);
}

float fresnel_diffuse_reflectance(float eta) {
  const float x = 1.0f / eta;
  if (x > most_of_fit) return 1.0f - fresnel_diffuse_escape(x);
  if (eta < 1.0f) return 0.6681f + 0.7099f * eta - 1.4399f * eta * eta + 0.0636f * x;
  return 0.919317f + x * (-3.4793f + x * (6.75335f + x * (-7.80989f + x * (4.98554f + x * -1.36881f))));
}

namespace {

float fresnel_conductor(float cos_i, float eta, float k) {
  const float cos2 = cos_i * cos_i, sin2 = 1.0f - cos2;
  const float t0 = eta * eta - k * k - sin2;
  const float a2_plus_b2 = std::sqrt(t0 * t0 + 4.0f * eta * eta * k * k);
  const float a = std::sqrt(std::max(0.0f, 0.5f * (a2_plus_b2 + t0)));
  const float s_sum = a2_plus_b2 + cos2, s_cross = 2.0f * a * cos_i;
  const float s = (s_sum - s_cross) / (s_sum + s_cross);
  const float p_sum = cos2 * a2_plus_b2 + sin2 * sin2, p_cross = s_cross * sin2;
  // At grazing incidence on an index-free mirror both sums meet: the ratio is 1 there.
  const float p = p_sum + p_cross > 0.0f ? s * (p_sum - p_cross) / (p_sum + p_cross) : s;
  return 0.5f * (s + p);
}

}  // namespace

C3f fresnel_conductor(float cos_i, const C3f& eta, const C3f& k) {
  return {fresnel_conductor(cos_i, eta.x, k.x), fresnel_conductor(cos_i, eta.y, k.y),
          fresnel_conductor(cos_i, eta.z, k.z)};
}

}  // namespace twopass
