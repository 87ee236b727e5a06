#include "radiosity/lamp_surfaces.h"

namespace twopass {

std::vector<LampSurface> lamp_surfaces(const Scene& scene) {
  std::vector<LampSurface> lamps;
  for (std::uint32_t s = 0; s < scene.shapes().size(); ++s) {
    const Shape& shape = scene.shapes()[s];
    for (const Side side : {front, back})
      if (!is_black(shape.radiance[side]))
        for (std::uint32_t i = 0; i < piece_count(shape.geometry); ++i)
          lamps.push_back({piece_patch(shape.geometry, i, side), shape.radiance[side], s,
                           side == front && shape.radiance_texture});
  }
  return lamps;
}

DiscreteDistribution choice_by_power(std::span<const LampSurface> lamps) {
  std::vector<double> power;
  for (const LampSurface& lamp : lamps) power.push_back(lamp.patch.area * mean_component(lamp.radiance));
  return DiscreteDistribution(power);
}

C3f radiance_at(const Scene& scene, const LampSurface& lamp, const ElementPoint& point, std::uint64_t& rays) {
  if (!lamp.varies) return lamp.radiance;
  const Ray down{point.ray_position(), V3f(-point.normal)};
  const Hit hit = scene.caster().intersect(down);
  ++rays;
  return hit.escaped() ? C3f(0.0f) : scene.emitted_radiance(scene.surface_point(down, hit));
}

}  // namespace twopass
