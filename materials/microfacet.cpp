#include "materials/microfacet.h"

#include "render/core/warp.h"

namespace twopass {

namespace {

constexpr float inverse_sqrt_pi = 0.5641895835f;

/// The largest float below 1: an error function there has the slope 3.8, beyond which lie 1e-7 of all facets.
constexpr float almost_one = 1.0f - 0x1p-24f;

/// The inverse of erf to 3e-7 of itself (Giles, "Approximating the erfinv function", GPU Computing Gems 2,
/// 2010, the single precision polynomials). Arguments beyond +-almost_one count as that.
float erf_inverse(float x) {
  constexpr float centre[] = {2.81022636e-08f,  3.43273939e-07f, -3.5233877e-06f,
                              -4.39150654e-06f, 0.00021858087f,  -0.00125372503f,
                              -0.00417768164f,  0.246640727f,    1.50140941f};
  constexpr float tail[] = {-0.000200214257f, 0.000100950558f, 0.00134934322f, -0.00367342844f, 0.00573950773f,
                            -0.0076224613f,   0.00943887047f,  1.00167406f,    2.83297682f};
  x = std::clamp(x, -almost_one, almost_one);
  float w = -std::log((1.0f - x) * (1.0f + x));
  const float* const coefficients = w < 5.0f ? centre : tail;
  w = w < 5.0f ? w - 2.5f : std::sqrt(w) - 3.0f;
  float p = coefficients[0];
  for (int i = 1; i < 9; ++i) p = p * w + coefficients[i];
  return p * x;
}

/// The slope towards the viewer of a visible facet of a Beckmann surface of roughness 1, seen at the polar
/// angle with this cosine and sine (M6). In t = erf(slope) the cumulative distribution is concave, so that
/// Newton's steps from below never overshoot. The first guess is the exact inverse for grazing views, stretched
/// (Jakob, "An improved visible normal sampling routine for the Beckmann distribution", 2014).
float sample_beckmann_slope(float cosine, float sine, float u) {
  if (sine == 0.0f) return erf_inverse(2.0f * u - 1.0f);
  const float steepest = cosine / sine;  // steeper facets turn away
  const float t_max = std::erf(steepest);
  const float area = cosine * (1.0f + t_max) + inverse_sqrt_pi * sine * std::exp(-steepest * steepest);
  const float target = std::max(u, 0x1p-25f) * area;
  float t = t_max - (1.0f + t_max) * std::erf(std::sqrt(-std::log(std::max(u, 0x1p-25f))));
  float slope = erf_inverse(t);
  for (int step = 0; step < 4; ++step) {  // three suffice for 2e-6 of the probability, two mostly
    const float derivative = cosine - sine * slope;
    const float value = cosine * (1.0f + t) + inverse_sqrt_pi * sine * std::exp(-slope * slope) - target;
    if (!(derivative > 0.0f) || std::abs(value) <= 1e-6f * area) break;
    t = std::clamp(t - value / derivative, -almost_one, t_max);
    slope = erf_inverse(t);
  }
  return slope;
}

}  // namespace

float beckmann::density(float x, float y, float z2, float area) {
  return std::exp(-(x * x + y * y) / z2) / (area * z2 * z2);
}

float beckmann::masking(float tan2) {
  if (tan2 <= 1.0f / (1.6f * 1.6f)) return 1.0f;
  // Within 0.35 % of the exact value (Walter et al. 2007, section 5.2); kept because others render with it.
  const float a = 1.0f / std::sqrt(tan2);
  return a * (3.535f + 2.181f * a) / (1.0f + a * (2.276f + 2.577f * a));
}

float beckmann::seen(float tan2) {
  const float a = 1.0f / std::sqrt(tan2);
  if (!(a < 4.0f)) return 1.0f;  // the rest is below 1e-9
  return 2.0f * a / (a * (1.0f + std::erf(a)) + inverse_sqrt_pi * std::exp(-a * a));
}

V3f beckmann::sample(const V3f& stretched, const V2f& u) {
  const float sine = std::sqrt(stretched.x * stretched.x + stretched.y * stretched.y);
  const float x = sample_beckmann_slope(stretched.z, sine, u.x), y = erf_inverse(2.0f * u.y - 1.0f);
  const float c = sine > 0.0f ? stretched.x / sine : 1.0f, s = sine > 0.0f ? stretched.y / sine : 0.0f;
  return {s * y - c * x, -s * x - c * y, 1.0f};
}

}  // namespace twopass
