#include "radiosity/view_parts.h"

#include "radiosity/specular_path.h"

namespace twopass {

std::vector<SurfacePoint> seen_points(const Scene& scene, std::span<const Ray> view, std::uint32_t seed,
                                      std::uint64_t& rays) {
  std::vector<Hit> hits(view.size());
  scene.caster().intersect(view, hits, Rays::coherent);
  rays += view.size();
  std::vector<SurfacePoint> points;
  for (std::size_t k = 0; k < hits.size(); ++k) {
    if (hits[k].escaped()) continue;
    const SurfacePoint point = scene.surface_point(view[k], hits[k]);
    if (!scene.side(point).scatters_without_diffusing()) {
      points.push_back(point);
      continue;
    }
    Sampler sampler(seed, 0, static_cast<std::uint32_t>(k));
    const SpecularPathEnd end = follow_specular(scene, view[k], point, Carried::radiance, sampler);
    rays += end.rays;
    if (!end.escaped && !is_black(end.weight)) points.push_back(end.point);
  }
  return points;
}

std::vector<double> parts_of(const ElementMesh& mesh, std::span<const SurfacePoint> points) {
  std::vector<double> parts;
  if (points.empty()) return parts;
  parts.resize(mesh.count(), 0.0);
  for (const SurfacePoint& point : points)
    if (const std::uint32_t element = mesh.find(point); element != no_index)
      parts[element] += 1.0 / static_cast<double>(points.size());
  return parts;
}

}  // namespace twopass
