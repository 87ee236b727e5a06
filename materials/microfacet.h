// Rough surfaces as many small smooth facets: how their normals are distributed, how they hide each other, and
// how to draw those that are seen (M4, M5, M6).
#pragma once

#include "render/core/names.h"
#include "render/core/types.h"
#include "render/core/warp.h"

namespace twopass {

enum class Microfacet : std::uint8_t { beckmann, ggx };
inline constexpr Named<Microfacet> microfacet_names[] = {{"beckmann", Microfacet::beckmann},
                                                         {"ggx", Microfacet::ggx}};

/// The roughness of the Beckmann distribution that looks like a Phong distribution of this exponent:
/// sqrt(2 / (exponent + 2)) (Walter et al., EGSR 2007, section 5.2). REQUIRES: exponent >= 0.
inline float beckmann_alpha_of_phong(float exponent) { return std::sqrt(2.0f / (exponent + 2.0f)); }

/// Formulas of the two types, in coordinates in which the surface is stretched to roughness 1; `tan2`: square
/// of the tangent of a direction's polar angle there. Those of GGX are inline and free of branches: loops over
/// many points become vector instructions (M33).
namespace ggx {
/// D(m) where m is (x, y) / alpha stretched, z2 = m.z^2 and `area` = pi alpha_u alpha_v.
inline float density(float x, float y, float z2, float area) {
  const float length2 = x * x + y * y + z2;
  return 1.0f / (area * length2 * length2);
}
inline float masking(float tan2) { return 2.0f / (1.0f + std::sqrt(1.0f + tan2)); }
/// The exact G1, which normalises the density of visible normals.
inline float seen(float tan2) { return masking(tan2); }
/// The facets of a half ball that a parallel beam meets are its mirror images in a uniform spherical cap.
inline V3f sample(const V3f& stretched, const V2f& u) {
  const float above = (1.0f - u.x) * (1.0f + stretched.z);  // z of the cap's point plus that of the beam
  const float z = above - stretched.z;
  const V2f around = circle(u.y) * std::sqrt(std::max(0.0f, 1.0f - z * z));
  return {around.x + stretched.x, around.y + stretched.y, above};
}
}  // namespace ggx
namespace beckmann {
float density(float x, float y, float z2, float area);
float masking(float tan2);
float seen(float tan2);
V3f sample(const V3f& stretched, const V2f& u);
}  // namespace beckmann

/// v / |v| where neither |v| nor its inverse is anywhere near the ends of the range of floats.
inline V3f unit_of_moderate(const V3f& v) { return v * (1.0f / std::sqrt(v.dot(v))); }
/// The normal of the facets that mirror `wo` into `wi`. Zero where these are opposite, to rounding.
inline V3f half_vector(const V3f& wo, const V3f& wi) {
  const V3f sum = wo + wi;
  return sum * (1.0f / std::sqrt(std::max(sum.dot(sum), 1e-30f)));
}

/// Facets of one type and roughness, in the local frame of the surface; `wo.z > 0`, facet normals have m.z > 0.
class MicrofacetDistribution {
 public:
  /// `alpha_u`, `alpha_v`: roughness along x and y; for Beckmann and equal values, the root mean square slope.
  /// Less than 1e-4 counts as 1e-4, as in Mitsuba: floats do not resolve less.
  MicrofacetDistribution(Microfacet type, float alpha_u, float alpha_v)
      : type_(type), alpha_u_(std::max(alpha_u, 1e-4f)), alpha_v_(std::max(alpha_v, 1e-4f)) {}

  /// D(m): area of facets facing m per area of surface and solid angle, 1/sr (M4).
  [[nodiscard]] float density(const V3f& m) const {
    const float x = m.x / alpha_u_, y = m.y / alpha_v_, z2 = m.z * m.z, area = pi_f * alpha_u_ * alpha_v_;
    const float d = type_ == Microfacet::ggx ? ggx::density(x, y, z2, area) : beckmann::density(x, y, z2, area);
    // Below, products of it would lose their digits.
    return d * m.z > 1e-20f ? d : 0.0f;
  }
  /// G1(v, m): the fraction of the facets facing m that v sees; 0 from behind, of facet or surface (M5).
  [[nodiscard]] float masking(const V3f& v, const V3f& m) const {
    const float tan2 = stretched_tan2(v);
    const float seen = type_ == Microfacet::ggx ? ggx::masking(tan2) : beckmann::masking(tan2);
    return v.dot(m) * v.z > 0.0f ? seen : 0.0f;
  }
  /// A facet normal as often as its projected area is seen from `wo` (M6).
  [[nodiscard]] V3f sample(const V3f& wo, const V2f& u) const {
    const V3f stretched = unit_of_moderate(V3f(alpha_u_ * wo.x, alpha_v_ * wo.y, wo.z));
    const V3f facet = type_ == Microfacet::ggx ? ggx::sample(stretched, u) : beckmann::sample(stretched, u);
    return unit_of_moderate(V3f(alpha_u_ * facet.x, alpha_v_ * facet.y, facet.z));
  }
  /// Density of sample() in solid angle of m.
  [[nodiscard]] float pdf_w(const V3f& wo, const V3f& m) const {
    return density(m) * seen_per_area(wo) * std::max(wo.dot(m), 0.0f);
  }

  /// D G1(wo) G1(wi) / (4 wo.z): reflection by facets facing m = unit(wo + wi) that reflect all.
  [[nodiscard]] float reflection(const V3f& wo, const V3f& wi, const V3f& m) const {
    return density(m) * masking(wo, m) * masking(wi, m) / (4.0f * wo.z);
  }
  /// Density in solid angle of wi, the mirror image of `wo` in a normal from sample().
  [[nodiscard]] float reflection_pdf_w(const V3f& wo, const V3f& m) const {
    return wo.dot(m) > 0.0f ? density(m) * 0.25f * seen_per_area(wo) : 0.0f;
  }
  /// Both of them, for the price of one.
  struct Reflection {
    float value, pdf_w;
  };
  [[nodiscard]] Reflection reflection_and_pdf_w(const V3f& wo, const V3f& wi, const V3f& m) const {
    const float facing = density(m);
    return {facing * masking(wo, m) * masking(wi, m) / (4.0f * wo.z),
            wo.dot(m) > 0.0f ? facing * 0.25f * seen_per_area(wo) : 0.0f};
  }
  /// Shadowing and masking over the part of it that sample() accounts for: the weight of a sampled facet that
  /// sends all light from `wi` to `wo`. Between 0 and 1.004.
  [[nodiscard]] float sample_weight(const V3f& wo, const V3f& wi, const V3f& m) const {
    const float seen = seen_per_area(wo) * wo.z;
    return masking(wo, m) * masking(wi, m) / seen;
  }

 private:
  // tan^2 of the polar angle of v after stretching the surface to roughness 1.
  [[nodiscard]] float stretched_tan2(const V3f& v) const {
    const float x = alpha_u_ * v.x, y = alpha_v_ * v.y;
    return (x * x + y * y) / (v.z * v.z);
  }
  // The exact G1(wo) / wo.z, which normalises the density of visible normals.
  [[nodiscard]] float seen_per_area(const V3f& wo) const {
    const float tan2 = stretched_tan2(wo);
    return (type_ == Microfacet::ggx ? ggx::seen(tan2) : beckmann::seen(tan2)) / wo.z;
  }

  Microfacet type_;
  float alpha_u_, alpha_v_;
};

/// `wo` reflected at a facet of unit normal `m`.
inline V3f reflect(const V3f& wo, const V3f& m) { return m * (2.0f * wo.dot(m)) - wo; }

}  // namespace twopass
