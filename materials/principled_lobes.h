// The lobes that the principled models are mixed from: GGX and GTR1 facets, Burley's diffuse reflection, tints.
//
// Directions are in the local frame of materials/bsdf_sample.h. Facet normals h have h.z >= 0.
#pragma once

#include "render/core/types.h"

namespace twopass {

/// Anisotropic GGX facets of the widths `ax` along x and `ay` along y, with Smith's masking of each direction
/// by itself (M21). Widths are at least 0.001, as everywhere in the principled models.
struct GgxFacets {
  float ax, ay;

  /// Burley 2012, section 5.4: alpha = roughness^2, stretched to an aspect of sqrt(1 - 0.9 anisotropic).
  static GgxFacets from_roughness(float roughness, float anisotropic);

  /// Density of facet normals: area of facets of normal h per solid angle and area of surface.
  [[nodiscard]] float distribution(const V3f& h) const;
  /// Fraction of the facets of normal h that `w` sees, in [0, 1]; 0 when it is on their back, or when a facet
  /// faces `w` and the surface does not.
  [[nodiscard]] float visible(const V3f& w, const V3f& h) const;
  /// Normal drawn from the facets that `wo` sees; density visible(wo, h) distribution(h) wo.h / wo.z.
  /// REQUIRES: wo.z > 0.
  [[nodiscard]] V3f sample(const V3f& wo, const V2f& u) const;
};

/// Isotropic facets of Burley's GTR distribution with exponent 1, of width `alpha` < 1: the clear coat (M22).
struct Gtr1Facets {
  float alpha;

  /// Burley 2012, section 5.6, with Mitsuba's widths: 0.1 (gloss 0) to 0.001 (gloss 1).
  static Gtr1Facets from_gloss(float gloss);

  [[nodiscard]] float distribution(const V3f& h) const;
  /// Normal of density distribution(h) h.z.
  [[nodiscard]] V3f sample(const V2f& u) const;
};

/// Reflectance in [0, 1] of a facet whose far side has the index `eta` over the near one; nothing where both
/// are equal. `cos_h` in [0, 1] between direction and facet normal.
float facet_fresnel(float cos_h, float eta);

/// Schlick's weight (1 - c)^5 of grazing incidence, c clamped to [0, 1].
float schlick_weight(float c);
/// Schlick's reflectance from `f0` at normal incidence to 1; from inside (eta < 1) the refracted cosine counts
/// (Burley 2015, section 4.3).
C3f schlick(const C3f& f0, float cos_h, float eta);

/// 1 blended by `amount` to `base_color` at luminance 1; black has no tint.
C3f tint(const C3f& base_color, float amount);

/// pi f / base colour of Burley's diffuse reflection blended by `flatness` into his flat subsurface (M23).
/// `cos_d` between either direction and the half vector; all three in [0, 1].
float burley_diffuse(float cos_o, float cos_i, float cos_d, float roughness, float flatness);
/// Albedo of burley_diffuse for base colour 1 under and averaged over even radiance: in [0.93, 1.07].
float burley_diffuse_albedo(float roughness, float flatness);
/// The same average for the sheen lobe f = (1 - cos_d)^5.
inline constexpr float sheen_albedo = 0.0115754f;

/// Draws one of a few lobes with probabilities in proportion to weights, and makes the random number that
/// decided whole again.
class LobeChoice {
 public:
  /// `u` in [0, 1); `total` is the sum of all weights that will be asked for, > 0.
  LobeChoice(float u, float total) : rest_(u * total) {}
  /// Whether the next lobe, of this weight, is the one. Ask in a fixed order.
  bool is(float weight) {
    if (rest_ < weight) {
      u_ = std::min(rest_ / weight, 0x1.fffffep-1f);
      return true;
    }
    rest_ -= weight;
    return false;
  }
  /// The number in [0, 1) that is left after a lobe was chosen.
  [[nodiscard]] float u() const { return u_; }
  /// The last lobe takes what rounding left of the others.
  void take_last(float weight) { u_ = std::min(rest_ / weight, 0x1.fffffep-1f); }

 private:
  float rest_, u_ = 0.0f;
};

}  // namespace twopass
