#include "radiosity/view_parts.h"

#include "materials/lobes.h"
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

ViewParts parts_seen(const Scene& scene, const ElementMesh& mesh, std::span<const Ray> view, std::uint32_t seed,
                     std::uint64_t& rays) {
  if (view.empty()) return {};
  std::vector<Hit> hits(view.size());
  scene.caster().intersect(view, hits, Rays::coherent);
  rays += view.size();
  ViewParts parts{std::vector<double>(mesh.count(), 0.0), std::vector<double>(mesh.count(), 0.0)};
  const auto add = [&](std::vector<double>& part, const SurfacePoint& point, double weight) {
    if (const std::uint32_t element = mesh.find(point); element != no_index)
      part[element] += weight / static_cast<double>(view.size());
  };
  for (std::size_t k = 0; k < hits.size(); ++k) {
    if (hits[k].escaped()) continue;
    const SurfacePoint point = scene.surface_point(view[k], hits[k]);
    const MaterialSide& side = scene.side(point);
    const bool is_specular = side.scatters_without_diffusing();
    if (!is_specular) add(parts.first, point, 1.0);
    if (!is_more_than_diffuse(side)) continue;
    Sampler sampler(seed, 0, static_cast<std::uint32_t>(k));
    SpecularPath path(scene, view[k], point, Carried::radiance, sampler);
    const SpecularPathEnd& end = path.end();
    if (is_specular && path.next() && !end.escaped && !is_black(end.weight)) add(parts.first, end.point, 1.0);
    if (path.next() && !end.escaped)
      add(parts.over_coats, end.point, static_cast<double>(max_component(end.weight)));
    rays += end.rays;
  }
  return parts;
}

}  // namespace twopass
