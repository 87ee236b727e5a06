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

  std::uint32_t rays_per_element = 0;
  /// `rays_per_element` entries an element, ascending: the elements that its rays met first, then the others.
  std::vector<std::uint32_t> landings;
  SpecularLinks specular;
  std::vector<double> exposed;  ///< by element: the fraction of its surface that is not buried; 0 below 1/16
  std::vector<C3d> sky;         ///< irradiance from the sky by element, direct and over specular surfaces
  std::uint64_t met_lamp = 0, met_black = 0, met_specular = 0, met_sky = 0;
  std::uint64_t rays = 0;  ///< all rays cast

  [[nodiscard]] std::span<const std::uint32_t> landings_of(std::uint32_t element) const {
    return std::span(landings).subspan(std::size_t{element} * rays_per_element, rays_per_element);
  }
  /// The fraction of an element's rays from exposed points that landed on other elements directly.
  [[nodiscard]] double share_on_elements(std::uint32_t element) const;
  /// The fraction of an element's rays from exposed points that met a specular surface first.
  [[nodiscard]] double share_on_specular(std::uint32_t element) const;
  /// The fraction of an element's rays from exposed points that left the scene.
  [[nodiscard]] double share_in_sky(std::uint32_t element) const;
  /// No ray left the scene, up to the few that slip through an edge, and there is nothing specular.
  [[nodiscard]] bool is_closed() const { return met_specular == 0 && met_sky * 100000 <= landings.size(); }
};

/// Whether what a ray from an element of the given normal and size (ElementMesh::size) has met lies right on
/// top of it: parallel and much closer than the element is large, like a lamp on a ceiling, a carpet.
bool is_covered(const Ray& ray, const Hit& hit, const SurfacePoint& point, const V3f& normal, float size);

/// Rays stratified over each element and its hemisphere. The same result on any number of threads.
RaySurvey survey_with_rays(const Scene& scene, const ElementMesh& mesh, std::uint32_t rays_per_element,
                           std::uint32_t seed);

/// The estimate of the exchange from the landings of both elements (R13). Symmetric; the sums of its rows are
/// off by the statistics.
ExchangeMatrix exchange_from_landings(const RaySurvey& survey, const ElementMesh& mesh);

}  // namespace twopass
