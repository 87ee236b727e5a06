#include "materials/principled_lobes.h"

#include "materials/fresnel.h"
#include "render/core/warp.h"
#include "render/image/image.h"

namespace twopass {

namespace {

constexpr float least_width = 0.001f;  // Burley 2012, section 5.4

float square(float x) { return x * x; }
float mix(float a, float b, float t) { return a + (b - a) * t; }

}  // namespace

GgxFacets GgxFacets::from_roughness(float roughness, float anisotropic) {
  const float alpha = roughness * roughness;
  const float aspect = std::sqrt(1.0f - 0.9f * std::clamp(anisotropic, 0.0f, 1.0f));
  return {std::max(least_width, alpha / aspect), std::max(least_width, alpha * aspect)};
}

float GgxFacets::distribution(const V3f& h) const {
  const float r = square(h.x / ax) + square(h.y / ay) + square(h.z);
  return 1.0f / (pi_f * ax * ay * r * r);
}

float GgxFacets::visible(const V3f& w, const V3f& h) const {
  if (w.dot(h) * w.z <= 0.0f) return 0.0f;
  const float tan2 = (square(ax * w.x) + square(ay * w.y)) / square(w.z);
  return 2.0f / (1.0f + std::sqrt(1.0f + tan2));
}

V3f GgxFacets::sample(const V3f& wo, const V2f& u) const {
  // Dupuy and Benyoub 2023: in the space where the facets are a hemisphere, reflections off it fill a cap of
  // the sphere evenly.
  const V3f o = unit(V3f(ax * wo.x, ay * wo.y, wo.z));
  const float z = (1.0f - u.x) * (1.0f + o.z) - o.z;
  const V2f around = circle(u.y) * std::sqrt(std::max(0.0f, 1.0f - z * z));
  const V3f h(around.x + o.x, around.y + o.y, z + o.z);
  return unit(V3f(ax * h.x, ay * h.y, std::max(0.0f, h.z)));
}

Gtr1Facets Gtr1Facets::from_gloss(float gloss) {
  return {mix(0.1f, least_width, std::clamp(gloss, 0.0f, 1.0f))};
}

float Gtr1Facets::distribution(const V3f& h) const {
  const float a2 = alpha * alpha;
  // 1 + (a^2 - 1) cos^2 without its cancellation near the normal.
  const float r = h.x * h.x + h.y * h.y + a2 * h.z * h.z;
  return (a2 - 1.0f) / (pi_f * std::log(a2) * r);
}

V3f Gtr1Facets::sample(const V2f& u) const {
  const float a2 = alpha * alpha;
  // The inverse of Burley 2012, equation (5), for the sine: no cancellation near the normal.
  const float sin2 = std::min(1.0f, a2 * std::expm1(-u.x * std::log(a2)) / (1.0f - a2));
  const V2f around = circle(u.y) * std::sqrt(sin2);
  return {around.x, around.y, std::sqrt(1.0f - sin2)};
}

float facet_fresnel(float cos_h, float eta) {
  if (eta == 1.0f) return 0.0f;
  float cos_t;
  return fresnel_dielectric(cos_h, eta, cos_t);
}

float schlick_weight(float c) {
  const float m = std::clamp(1.0f - c, 0.0f, 1.0f);
  return square(square(m)) * m;
}

C3f schlick(const C3f& f0, float cos_h, float eta) {
  const float cos_t2 = 1.0f - (1.0f - cos_h * cos_h) / (eta * eta);
  const float weight = schlick_weight(eta > 1.0f ? cos_h : std::sqrt(std::max(0.0f, cos_t2)));
  return f0 + (C3f(1.0f) - f0) * weight;
}

C3f tint(const C3f& base_color, float amount) {
  const float y = luminance(base_color);
  if (!(y > 0.0f)) return C3f(1.0f);
  return C3f(1.0f - amount) + base_color * (amount / y);
}

float burley_diffuse(float cos_o, float cos_i, float cos_d, float roughness, float flatness) {
  const float o = schlick_weight(cos_o), i = schlick_weight(cos_i);
  const float retro = 2.0f * roughness * cos_d * cos_d;
  const float diffuse = (1.0f - 0.5f * o) * (1.0f - 0.5f * i) + retro * (o + i + o * i * (retro - 1.0f));
  if (flatness == 0.0f) return diffuse;
  // Never a division by zero: directions of no height have no weight either.
  const float heights = std::max(cos_o + cos_i, std::numeric_limits<float>::min());
  const float grazing = 0.5f * retro;
  const float flat = 1.25f * (mix(1.0f, grazing, o) * mix(1.0f, grazing, i) * (1.0f / heights - 0.5f) + 0.5f);
  return mix(diffuse, flat, flatness);
}

float burley_diffuse_albedo(float roughness, float flatness) {
  // Both are polynomials in the roughness; the coefficients are integrals over both directions (M23).
  const float diffuse = 0.952948f + roughness * (0.108702f + roughness * 0.00351946f);
  const float flat = 0.939110f + roughness * (0.0436839f + roughness * 0.00213501f);
  return mix(diffuse, flat, flatness);
}

}  // namespace twopass
