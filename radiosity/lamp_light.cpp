#include "radiosity/lamp_light.h"

#include <algorithm>

#include "radiosity/lambert.h"
#include "radiosity/pieces.h"

namespace twopass {

namespace {

constexpr std::size_t most_lamps = 64, most_polygons = 2048;

void add_faces(const Imath::Box3d& box, std::vector<Polygon>& faces) {
  const auto corner = [&](int i) {
    return V3d((i & 1) ? box.max.x : box.min.x, (i & 2) ? box.max.y : box.min.y,
               (i & 4) ? box.max.z : box.min.z);
  };
  constexpr int face[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                              {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& f : face)
    faces.push_back(make_polygon(corner(f[0]), corner(f[1]), corner(f[2]), corner(f[3])));
}

Polygon turned(Polygon polygon) {
  std::reverse(polygon.v.begin(), polygon.v.begin() + polygon.n);
  return polygon;
}

// The flat polygons that a mesh consists of.
std::vector<Polygon> polygons_of(const Geometry& geometry) {
  std::vector<Polygon> triangles;
  for (std::uint32_t i = 0; i < piece_count(geometry); ++i) {
    const Patch patch = piece_patch(geometry, i, front);
    if (patch.area > 0.0) triangles.push_back(patch.polygon());
  }
  return join_triangles(triangles);
}

Imath::Box3d box_around(const Shape& shape) {
  const Box3f bounds = bounds_of({&shape, 1});
  return {V3d(bounds.min), V3d(bounds.max)};
}

}  // namespace

LampLight::LampLight(const Scene& scene) {
  if (scene.has_see_through() || !scene.environment().is_black() || !scene.punctual_lights().empty()) return;
  std::vector<Polygon> surfaces, surroundings;
  for (std::uint32_t s = 0; s < scene.shapes().size(); ++s)
    if (!add_shape(scene, s, surfaces, surroundings)) {
      lamps_.clear();
      return;
    }
  surroundings.insert(surroundings.end(), surfaces.begin(), surfaces.end());
  polygons_ = surroundings.size();
  surfaces_.emplace(std::move(surfaces));
  obstacles_.emplace(std::move(surroundings));
}

// False: it is more than can be known.
bool LampLight::add_shape(const Scene& scene, std::uint32_t number, std::vector<Polygon>& surfaces,
                          std::vector<Polygon>& surroundings) {
  const Shape& shape = scene.shapes()[number];
  if (is_analytic(shape.geometry)) {
    if (is_emitter(shape)) return false;
    solids_.push_back(box_around(shape));
    add_faces(solids_.back(), surroundings);
    return true;
  }
  if (surfaces.size() + piece_count(shape.geometry) > most_polygons) return false;
  const std::vector<Polygon> polygons = polygons_of(shape.geometry);
  surfaces.insert(surfaces.end(), polygons.begin(), polygons.end());
  if (!is_emitter(shape)) return true;
  if (shape.radiance_texture) return false;
  for (const Side side : {front, back}) {
    if (is_black(shape.radiance[side])) continue;
    for (const Polygon& polygon : polygons)
      lamps_.push_back({side == front ? polygon : turned(polygon), C3d(shape.radiance[side]) * pi, number});
  }
  return lamps_.size() <= most_lamps;
}

bool LampLight::stands_in_solid(const Polygon& polygon) const {
  const Imath::Box3d bounds = bounds_of(polygon);
  return std::any_of(solids_.begin(), solids_.end(),
                     [&](const Imath::Box3d& solid) { return solid.intersects(bounds); });
}

std::optional<LampLight::Lamps> LampLight::seen_from(const Polygon& polygon) const {
  const V3d normal = polygon_area_vector(polygon);
  Lamps seen = 0;
  for (std::size_t k = 0; k < lamps_.size(); ++k) {
    const Polygon& lamp = lamps_[k].polygon;
    if (is_wholly_behind(lamp, polygon.v[0], normal) ||
        is_wholly_behind(polygon, lamp.v[0], polygon_area_vector(lamp)) || surfaces_->one_hides(polygon, lamp))
      continue;
    if (stands_in_solid(polygon) || stands_in_solid(lamp) || !obstacles_->none_between(polygon, lamp))
      return std::nullopt;
    seen |= Lamps{1} << k;
  }
  return seen;
}

C3d LampLight::irradiance(const V3d& point, const V3d& normal, Lamps lamps) const {
  C3d sum(0.0);
  for (std::size_t k = 0; k < lamps_.size(); ++k)
    if (lamps >> k & 1) sum += irradiance_of(static_cast<int>(k), point, normal);
  return sum;
}

bool LampLight::are_above(Lamps lamps, const V3d& point, const V3d& normal) const {
  for (std::size_t k = 0; k < lamps_.size(); ++k) {
    if (!(lamps >> k & 1)) continue;
    const Polygon& lamp = lamps_[k].polygon;
    if (!std::all_of(lamp.v.begin(), lamp.v.begin() + lamp.n,
                     [&](const V3d& v) { return normal.dot(v - point) > 0.0; }))
      return false;
  }
  return true;
}

C3d LampLight::irradiance_of(int k, const V3d& point, const V3d& normal) const {
  const Lamp& lamp = lamps_[static_cast<std::size_t>(k)];
  return lamp.exitance * point_form_factor(point, normal, lamp.polygon);
}

}  // namespace twopass
