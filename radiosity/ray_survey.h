// What each element sees, found by cosine-distributed rays: the ground of the method `rays`, and what every
// method needs to know of sky, absorbing and specular surfaces.
#pragma once

#include "radiosity/balance.h"
#include "radiosity/elements.h"
#include "render/scene/scene.h"

namespace twopass {

struct RaySurvey {
  /// What a ray meets first when it is not an element.
  enum Landing : std::uint32_t {
    on_lamp = 0xfffffffb,   ///< an emitting side without elements
    on_black = 0xfffffffc,  ///< another side without elements
    on_specular = 0xfffffffd,
    in_the_sky = 0xfffffffe,
    buried = 0xffffffff,  ///< the ray started under another surface, where no light comes: it does not count
  };

  /// Fractions of an element's rays from exposed points, by what they met first.
  struct Shares {
    float on_elements = 0.0f, on_specular = 0.0f, in_the_sky = 0.0f;
  };

  std::uint32_t rays_per_element = 0;
  /// `rays_per_element` entries an element, ascending: the elements that its rays met first, then the others.
  /// Only with Keep::landings.
  std::vector<std::uint32_t> landings;
  SpecularLinks specular;      ///< not with Keep::totals
  std::vector<float> exposed;  ///< by element: the fraction of its surface that is not buried; 0 below 1/16
  std::vector<Shares> shares;  ///< by element
  std::vector<C3f> sky;        ///< irradiance from the sky by element, direct and over specular surfaces
  std::uint64_t met_lamp = 0, met_black = 0, met_specular = 0, met_sky = 0;
  bool met_gloss = false;  ///< elements that are glossy, too
  std::uint64_t rays = 0;  ///< all rays cast

  [[nodiscard]] std::span<const std::uint32_t> landings_of(std::uint32_t element) const {
    return std::span(landings).subspan(std::size_t{element} * rays_per_element, rays_per_element);
  }
  /// No ray left the scene, up to the few that slip through an edge, and there is nothing specular.
  [[nodiscard]] bool is_closed() const {
    return met_specular == 0 && met_sky * 100000 <= exposed.size() * rays_per_element;
  }
  /// All that an element sees are elements.
  [[nodiscard]] bool sees_only_elements() const { return is_closed() && met_black == 0 && met_lamp == 0; }
};

/// What a survey is for.
enum class Keep {
  totals,    ///< 28 bytes an element: exposed parts, shares, sky
  links,     ///< that, and links over specular surfaces
  landings,  ///< that, and every landing, 4 bytes a ray: for `exchange_from_landings`
};

/// Rays stratified over each element and its hemisphere. The same result on any number of threads.
RaySurvey survey_with_rays(const Scene& scene, const ElementMesh& mesh, std::uint32_t rays_per_element,
                           std::uint32_t seed, Keep keep = Keep::landings);

/// The estimate of the exchange from the landings of both elements (R13). Symmetric; the sums of its rows are
/// off by the statistics. Where points are weighted (ElementMesh::weigh), from those of the element of the row
/// alone: not symmetric, and the sums are right. REQUIRES: a survey that kept its landings.
ExchangeMatrix exchange_from_landings(const RaySurvey& survey, const ElementMesh& mesh);

}  // namespace twopass
