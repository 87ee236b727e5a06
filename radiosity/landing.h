// Where a ray that leaves an element ends, as far as the balance is concerned: one judgement for everything
// that casts rays from elements.
#pragma once

#include "radiosity/elements.h"
#include "render/core/sampler.h"
#include "render/scene/scene.h"

namespace twopass {

/// Whether what a ray from an element of the given normal and size (ElementMesh::size) has met lies right on
/// top of it: parallel and much closer than the element is large, like a lamp on a ceiling, a carpet; but not
/// glass.
bool is_covered(const Scene& scene, const Ray& ray, const Hit& hit, const SurfacePoint& point,
                const V3f& normal, float size);

/// What a ray from an element met first.
struct Landing {
  enum Kind : std::uint8_t {
    on_element,
    on_lamp,      ///< an emitting side without elements
    on_black,     ///< another side without elements: it absorbs
    on_specular,  ///< not an end but a continuation: see `SpecularPath`
    in_the_sky,
    buried,  ///< the ray started under another surface, where no light comes: it does not count
  };
  Kind kind;
  std::uint32_t element = no_index;  ///< only on_element
  SurfacePoint point;                ///< only where the light goes on
  float distance = infinity_f;       ///< from the start; infinite in the sky
  /// Light goes on from there otherwise than diffusely: on_specular, and on elements that are glossy, too.
  bool goes_on = false;
};

/// Casts rays from elements. Const and thread-safe. REQUIRES: scene and mesh outlive it.
class ElementRays {
 public:
  ElementRays(const Scene& scene, const ElementMesh& mesh) : scene_(scene), mesh_(mesh) {}

  /// Casts a ray that leaves an element of the given normal and size (square root of the area of all of it,
  /// buried parts included). `sampler` is drawn from when more rays are needed to judge; `rays` is increased by
  /// the number of rays cast.
  [[nodiscard]] Landing cast(const Ray& ray, const V3f& normal, float size, Sampler& sampler,
                             std::uint64_t& rays) const;

 private:
  [[nodiscard]] bool shows_inside(const SurfacePoint& point) const;
  [[nodiscard]] bool is_inside_solid(const Ray& ray, const V3f& normal, Sampler& sampler,
                                     std::uint64_t& rays) const;

  const Scene& scene_;
  const ElementMesh& mesh_;
};

}  // namespace twopass
