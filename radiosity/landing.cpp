#include "radiosity/landing.h"

#include "materials/lobes.h"
#include "render/core/warp.h"

namespace twopass {

bool is_covered(const Scene& scene, const Ray& ray, const Hit& hit, const SurfacePoint& point,
                const V3f& normal, float size) {
  const bool is_on_top =
      point.geometric_normal.dot(normal) < -0.9f && hit.t * ray.direction.dot(normal) < 0.25f * size;
  // Glass that stands on a table does not keep the light from it.
  return is_on_top && !scene.side(point).traits().transmits;
}

Landing ElementRays::cast(const Ray& ray, const V3f& normal, float size, Sampler& sampler,
                          std::uint64_t& rays) const {
  const Hit hit = scene_.caster().intersect(ray);
  ++rays;
  if (hit.escaped()) return {Landing::in_the_sky, no_index, {}};
  const SurfacePoint point = scene_.surface_point(ray, hit);
  if (is_covered(scene_, ray, hit, point, normal, size)) return {Landing::buried, no_index, {}, hit.t};
  const std::uint32_t element = mesh_.find(point);
  if (element != no_index) {
    if (is_more_than_diffuse(scene_.side(point))) return {Landing::on_element, element, point, hit.t, true};
    return {Landing::on_element, element, {}, hit.t};
  }
  if (shows_inside(point))
    return {
        is_inside_solid(ray, normal, sampler, rays) ? Landing::buried : Landing::on_black, no_index, {}, hit.t};
  if (scene_.side(point).scatters_without_diffusing())
    return {Landing::on_specular, no_index, point, hit.t, true};
  const bool shines = !is_black(scene_.emitted_radiance(point));
  return {shines ? Landing::on_lamp : Landing::on_black, no_index, {}, hit.t};
}

// The black back of a one-sided surface: most likely the inside of something solid.
bool ElementRays::shows_inside(const SurfacePoint& point) const {
  return point.side == back && mesh_.has_elements(point.shape, front) &&
         is_black(scene_.emitted_radiance(point)) && !scene_.side(point).scatters_without_diffusing();
}

// Whether two more rays from the same place see the inside of something solid, too: then it surrounds them.
bool ElementRays::is_inside_solid(const Ray& ray, const V3f& normal, Sampler& sampler,
                                  std::uint64_t& rays) const {
  for (int probe = 0; probe < 2; ++probe) {
    const Ray other{ray.origin, Frame(normal).to_world(square_to_cosine_hemisphere(sampler.next_2d()))};
    const Hit hit = scene_.caster().intersect(other);
    ++rays;
    if (hit.escaped() || !shows_inside(scene_.surface_point(other, hit))) return false;
  }
  return true;
}

}  // namespace twopass
