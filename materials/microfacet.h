// Rough surfaces as many small smooth facets: how their normals are distributed, how they hide each other, and
// how to draw those that are seen (M4, M5, M6).
#pragma once

#include "render/core/names.h"
#include "render/core/types.h"

namespace twopass {

enum class Microfacet : std::uint8_t { beckmann, ggx };
inline constexpr Named<Microfacet> microfacet_names[] = {{"beckmann", Microfacet::beckmann},
                                                         {"ggx", Microfacet::ggx}};

/// The roughness of the Beckmann distribution that looks like a Phong distribution of this exponent:
/// sqrt(2 / (exponent + 2)) (Walter et al., EGSR 2007, section 5.2). REQUIRES: exponent >= 0.
inline float beckmann_alpha_of_phong(float exponent) { return std::sqrt(2.0f / (exponent + 2.0f)); }

/// Facets of one type and roughness, in the local frame of the surface; `wo.z > 0`, facet normals have m.z > 0.
class MicrofacetDistribution {
 public:
  /// `alpha_u`, `alpha_v`: roughness along x and y; for Beckmann and equal values, the root mean square slope.
  /// Less than 1e-4 counts as 1e-4, as in Mitsuba: floats do not resolve less.
  MicrofacetDistribution(Microfacet type, float alpha_u, float alpha_v)
      : type_(type), alpha_u_(std::max(alpha_u, 1e-4f)), alpha_v_(std::max(alpha_v, 1e-4f)) {}

  /// D(m): area of facets facing m per area of surface and solid angle, 1/sr (M4).
  [[nodiscard]] float density(const V3f& m) const;
  /// G1(v, m): the fraction of the facets facing m that v sees; 0 from behind, of facet or surface (M5).
  [[nodiscard]] float masking(const V3f& v, const V3f& m) const;
  /// A facet normal as often as its projected area is seen from `wo` (M6).
  [[nodiscard]] V3f sample(const V3f& wo, const V2f& u) const;
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
  [[nodiscard]] float seen_per_area(const V3f& wo) const;

  Microfacet type_;
  float alpha_u_, alpha_v_;
};

/// `wo` reflected at a facet of unit normal `m`.
inline V3f reflect(const V3f& wo, const V3f& m) { return m * (2.0f * wo.dot(m)) - wo; }

}  // namespace twopass
