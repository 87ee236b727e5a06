#include "render/scene/lights.h"

#include "render/core/warp.h"
#include "render/scene/geometry.h"
#include "render/scene/parametrization.h"
#include "render/scene/polygon_view.h"

namespace twopass {

namespace {

const LightSample nothing{V3f(0.0f), V3f(0.0f, 0.0f, 1.0f), C3f(0.0f), 0.0f, false};

// 1 - cos of the half angle of the cone that a sphere fills, seen from outside at squared distance d2. No
// cancellation.
float one_minus_cos_max(float radius, float d2) {
  const float sin2 = radius * radius / d2;
  return sin2 / (1.0f + std::sqrt(std::max(0.0f, 1.0f - sin2)));
}

// Whether the receiver is far enough outside of the sphere for its cone to have digits. On the surface itself,
// where rounding would toss a coin, it is not.
bool sees_cone(float radius, float d2) { return d2 > 1.001f * radius * radius; }

// The side of a sphere that faces the outside.
Side outside(const Sphere& sphere) { return sphere.inward ? back : front; }

// How much one side of a polygon or sphere matters, by its power.
float power_of(const Shape& shape, double area) {
  const double exitance = pi * (mean_component(shape.radiance[front]) + mean_component(shape.radiance[back]));
  return static_cast<float>(exitance * area);
}

LightBounds bounds_of(const LightPolygon& polygon, const Shape& shape) {
  LightBounds bounds;
  for (int i = 0; i < polygon.corners; ++i) bounds.box.extendBy(polygon.corner[i]);
  const bool front_is_dark = is_black(shape.radiance[front]);
  bounds.axis = V3f(front_is_dark ? -polygon.normal : polygon.normal);
  bounds.cos_cone = 1.0f;
  bounds.is_two_sided = !front_is_dark && !is_black(shape.radiance[back]);
  bounds.power = power_of(shape, polygon.area);
  return bounds;
}

LightBounds bounds_of(const Sphere& sphere, const Shape& shape) {
  LightBounds bounds;
  bounds.box = box_of(sphere);
  bounds.power = power_of(shape, 4.0 * pi * sphere.radius * sphere.radius);
  return bounds;
}
LightBounds bounds_of(const Disk& disk, const Shape& shape) {
  LightBounds bounds;
  const bool front_is_dark = is_black(shape.radiance[front]);
  bounds.box = box_of(disk);
  bounds.axis = front_is_dark ? -unit_normal(disk) : unit_normal(disk);
  bounds.cos_cone = 1.0f;
  bounds.is_two_sided = !front_is_dark && !is_black(shape.radiance[back]);
  bounds.power = power_of(shape, area_of(disk));
  return bounds;
}
LightBounds bounds_of(const Cylinder& cylinder, const Shape& shape) {
  LightBounds bounds;
  bounds.box = box_of(cylinder);
  bounds.power = power_of(shape, area_of(cylinder));
  return bounds;
}

// The part of a cylinder that is sampled for a receiver, in radians around its axis: the half of which the
// receiver sees the outside, where only that shines.
struct VisibleArc {
  float middle = 0.0f, half = pi_f;
};
VisibleArc visible_arc(const Cylinder& cylinder, const Shape& shape, const V3f& receiver) {
  const Side outer = cylinder.inward ? back : front;
  if (is_black(shape.radiance[outer]) || !is_black(shape.radiance[outer == front ? back : front])) return {};
  const V3f from = receiver - cylinder.base;
  const float x = from.dot(cylinder.axes[0]), y = from.dot(cylinder.axes[1]), distance = std::hypot(x, y);
  if (!(distance > cylinder.radius)) return {};
  return {std::atan2(y, x), std::acos(cylinder.radius / distance)};
}

// The density in solid angle of a point that is drawn with `pdf_a` on a surface of that normal.
float pdf_w_of_area(float pdf_a, float distance2, float cosine) {
  return cosine == 0.0f ? 0.0f : pdf_a * distance2 / std::abs(cosine);
}

// The place of a punctual light; nothing if it is infinitely far away.
std::optional<V3f> place_of(const PunctualLight& light) {
  return std::visit(
      [](const auto& kind) -> std::optional<V3f> {
        if constexpr (requires { kind.position; })
          return kind.position;
        else if constexpr (requires { kind.frame.position; })
          return kind.frame.position;
        else
          return std::nullopt;
      },
      light);
}

}  // namespace

const Environment& Lights::no_environment() {
  static const Environment black;
  return black;
}

Lights::Lights(std::span<const Shape> shapes, std::span<const PunctualLight> punctual,
               const Environment& environment, const Box3f& bounds)
    : shapes_(shapes), punctual_(punctual), environment_(&environment), first_(shapes.size(), no_index) {
  if (!bounds.isEmpty()) {
    center_ = bounds.min + (bounds.max - bounds.min) * 0.5f;
    radius_ = 0.5f * (bounds.max - bounds.min).length();
  }
  std::vector<LightBounds> light_bounds;
  for (std::uint32_t s = 0; s < shapes.size(); ++s)
    if (is_emitter(shapes[s])) add_shape(s, light_bounds);
  std::vector<double> weights;  // of the distant lights
  for (std::uint32_t i = 0; i < punctual.size(); ++i) add_punctual(i, light_bounds, weights);
  if (!environment.is_black()) {
    const double area = pi * radius_ * radius_;
    weights.push_back(pi * mean_component(environment.mean_radiance()) * (area > 0.0 ? area : 1.0));
    distant_.push_back(no_index);
  }
  tree_ = LightTree(light_bounds);
  if (distant_.empty()) return;
  distant_choice_ = DiscreteDistribution(weights);
  if (distant_.back() == no_index)
    environment_probability_ = distant_choice_.probability(static_cast<std::uint32_t>(distant_.size() - 1));
  distant_share_ = entries_.empty() ? 1.0f : 0.5f;
}

template <class Kind>
void Lights::add_surface(std::uint32_t s, Kind kind, const LightBounds& surface,
                         std::vector<LightBounds>& bounds) {
  const bool shines = surface.power > 0.0f;
  entry_of_.push_back(shines ? static_cast<std::uint32_t>(entries_.size()) : no_index);
  if (!shines) return;
  entries_.push_back({s, s, kind});
  bounds.push_back(surface);
}

void Lights::add_shape(std::uint32_t s, std::vector<LightBounds>& bounds) {
  const Shape& shape = shapes_[s];
  first_[s] = static_cast<std::uint32_t>(entry_of_.size());
  if (const auto* sphere = std::get_if<Sphere>(&shape.geometry))
    return add_surface(s, SphereLight{}, bounds_of(*sphere, shape), bounds);
  if (const auto* disk = std::get_if<Disk>(&shape.geometry))
    return add_surface(s, DiskLight{}, bounds_of(*disk, shape), bounds);
  if (const auto* cylinder = std::get_if<Cylinder>(&shape.geometry))
    return add_surface(s, CylinderLight{}, bounds_of(*cylinder, shape), bounds);
  const Mesh* mesh = mesh_of(shape.geometry);
  Mesh placed;  // of an instance: where it stands
  if (const auto* instance = std::get_if<MeshInstance>(&shape.geometry)) {
    placed.triangles = mesh->triangles;
    for (const V3f& p : mesh->positions) placed.positions.push_back(instance->to_world.point(p));
    mesh = &placed;
  }
  entry_of_.resize(entry_of_.size() + mesh->triangles.size(), no_index);
  for (const LightPolygon& polygon : light_polygons(*mesh)) {
    const LightBounds polygon_bounds = bounds_of(polygon, shape);
    if (!(polygon_bounds.power > 0.0f)) continue;
    for (int i = 0; i + 2 < polygon.corners; ++i)
      entry_of_[first_[s] + polygon.triangles[i]] = static_cast<std::uint32_t>(entries_.size());
    entries_.push_back({s, s, polygon});
    bounds.push_back(polygon_bounds);
  }
}

void Lights::add_punctual(std::uint32_t index, std::vector<LightBounds>& bounds, std::vector<double>& weights) {
  const double emitted = power(punctual_[index], radius_ > 0.0f ? radius_ : 1.0);
  if (!(emitted > 0.0)) return;
  if (const std::optional<V3f> place = place_of(punctual_[index])) {
    LightBounds all_around;
    all_around.box = Box3f(*place);
    all_around.power = static_cast<float>(emitted);
    entries_.push_back({no_index, punctual_number(index), Punctual{index}});
    bounds.push_back(all_around);
  } else {
    distant_.push_back(index);
    weights.push_back(emitted);
  }
}

C3f Lights::radiance(const Entry& entry, Side side, const V3f& position) const {
  const Shape& shape = shapes_[entry.shape];
  if (!shape.radiance_texture || side == back) return shape.radiance[side];
  return textured_radiance(entry, position);
}

C3f Lights::textured_radiance(const Entry& entry, const V3f& position) const {
  const Shape& shape = shapes_[entry.shape];
  V2f uv;
  MeshPlace place;
  if (const auto* polygon = std::get_if<LightPolygon>(&entry.kind)) {
    std::uint32_t triangle = polygon->triangles[0];
    V2f at = barycentric_at(corners(shape.geometry, triangle), position);
    if (polygon->corners == 4 && std::min({at.x, at.y, 1.0f - at.x - at.y}) < 0.0f) {
      triangle = polygon->triangles[1];
      at = barycentric_at(corners(shape.geometry, triangle), position);
    }
    uv = parametrization(*mesh_of(shape.geometry), triangle, at, V3f(polygon->normal)).uv;
    place = {triangle, at};
  } else if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
    const V3f outward = unit(position - sphere->center);
    uv = parametrization(*sphere, sphere->inward ? -outward : outward).uv;
  } else if (const auto* disk = std::get_if<Disk>(&shape.geometry)) {
    uv = parametrization(*disk, position).uv;
  } else {
    uv = parametrization(std::get<Cylinder>(shape.geometry), position).uv;
  }
  return color_at(*shape.radiance_texture, {uv, V2f(0.0f, 0.0f), place});
}

LightSample Lights::sample(const Receiver& receiver, const V2f& u) const {
  V2f v = u;
  if (distant_share_ > 0.0f) {
    if (v.x < distant_share_) return sample_distant(receiver, {v.x / distant_share_, v.y});
    v.x = (v.x - distant_share_) / (1.0f - distant_share_);
  }
  LightTree::Choice choice{0, 1.0f, v.x};
  if (entries_.size() > 1) choice = tree_.sample(receiver, v);
  if (!(choice.probability > 0.0f)) return nothing;
  v.x = choice.remapped;
  const Entry& entry = entries_[choice.light];
  const auto draw = [&](const auto& kind) {
    LightSample drawn = sample_of(entry, kind, receiver, v);
    drawn.pdf_w *= choice.probability * (1.0f - distant_share_);
    drawn.light = entry.number;
    return drawn;
  };
  // Most lights are polygons: no jump through a table for them.
  if (const auto* polygon = std::get_if<LightPolygon>(&entry.kind)) return draw(*polygon);
  return std::visit(draw, entry.kind);
}

LightSample Lights::sample_of(const Entry& entry, const LightPolygon& polygon, const Receiver& receiver,
                              const V2f& u) const {
  const Side side = side_of(polygon, receiver);
  if (is_black(shapes_[entry.shape].radiance[side])) return nothing;
  const PolygonView::Point point = PolygonView(polygon, receiver).sample(u);
  const auto clear = static_cast<float>(side == front ? polygon.offset : -polygon.offset);
  return {point.position + V3f(polygon.normal) * clear, point.direction, radiance(entry, side, point.position),
          point.pdf_w, false};
}

LightSample Lights::sample_of(const Entry& entry, SphereLight, const Receiver& receiver, const V2f& u) const {
  const Sphere& sphere = std::get<Sphere>(shapes_[entry.shape].geometry);
  const V3f to_center = sphere.center - receiver.position;
  const float d2 = to_center.dot(to_center), offset = rounding_offset(sphere);
  if (sees_cone(sphere.radius, d2)) {
    const float spread = one_minus_cos_max(sphere.radius, d2);
    const V3f direction = Frame(to_center * (1.0f / std::sqrt(d2))).to_world(square_to_cone(u, spread));
    double near, far;
    // Rounding can make a grazing direction miss: the nearest point of the line is then on the sphere to
    // rounding.
    if (!intersect_sphere(sphere, receiver.position, direction, near, far)) near = to_center.dot(direction);
    const V3f outward = (V3f(V3d(receiver.position) + V3d(direction) * near) - sphere.center).normalized();
    return {sphere.center + outward * (sphere.radius + offset), direction,
            radiance(entry, outside(sphere), sphere.center + outward * sphere.radius), cone_pdf_w(spread),
            false};
  }
  const V3f outward = square_to_sphere(u);
  const V3f position = sphere.center + outward * sphere.radius, to_light = position - receiver.position;
  const float length2 = to_light.dot(to_light), cosine_times_length = to_light.dot(outward);
  if (!(length2 > 0.0f) || cosine_times_length == 0.0f) return nothing;
  const float length = std::sqrt(length2), pdf_a = 1.0f / (4.0f * pi_f * sphere.radius * sphere.radius);
  const bool from_inside = cosine_times_length > 0.0f;
  const Side side = from_inside == sphere.inward ? front : back;
  return {position + outward * (from_inside ? -offset : offset), to_light * (1.0f / length),
          radiance(entry, side, position), pdf_a * length2 * length / std::abs(cosine_times_length), false};
}

LightSample Lights::sample_of(const Entry& entry, DiskLight, const Receiver& receiver, const V2f& u) const {
  const Disk& disk = std::get<Disk>(shapes_[entry.shape].geometry);
  const V2f at = square_to_disk(u);
  const V3f position = disk.center + disk.x * at.x + disk.y * at.y, normal = unit_normal(disk);
  const V3f to_light = position - receiver.position;
  const float length2 = to_light.dot(to_light);
  if (!(length2 > 0.0f)) return nothing;
  const V3f direction = to_light * (1.0f / std::sqrt(length2));
  const float cosine = direction.dot(normal);
  const Side side = cosine < 0.0f ? front : back;
  const float clear = side == front ? rounding_offset(disk) : -rounding_offset(disk);
  const auto pdf_a = static_cast<float>(1.0 / area_of(disk));
  return {position + normal * clear, direction, radiance(entry, side, position),
          pdf_w_of_area(pdf_a, length2, cosine), false};
}

LightSample Lights::sample_of(const Entry& entry, CylinderLight, const Receiver& receiver, const V2f& u) const {
  const Shape& shape = shapes_[entry.shape];
  const Cylinder& cylinder = std::get<Cylinder>(shape.geometry);
  const VisibleArc arc = visible_arc(cylinder, shape, receiver.position);
  const float angle = arc.middle + (2.0f * u.x - 1.0f) * arc.half;
  const V3f outward = cylinder.axes[0] * std::cos(angle) + cylinder.axes[1] * std::sin(angle);
  const V3f position = cylinder.base + cylinder.axes[2] * (u.y * cylinder.length) + outward * cylinder.radius;
  const V3f to_light = position - receiver.position;
  const float length2 = to_light.dot(to_light), area = 2.0f * arc.half * cylinder.radius * cylinder.length;
  if (!(length2 > 0.0f) || !(area > 0.0f)) return nothing;
  const V3f direction = to_light * (1.0f / std::sqrt(length2));
  const float cosine = direction.dot(outward), offset = rounding_offset(cylinder);
  const bool from_inside = cosine > 0.0f;
  const Side side = from_inside == cylinder.inward ? front : back;
  return {position + outward * (from_inside ? -offset : offset), direction, radiance(entry, side, position),
          pdf_w_of_area(1.0f / area, length2, cosine), false};
}

LightSample Lights::sample_of(const Entry&, Punctual punctual, const Receiver& receiver, const V2f&) const {
  return sample_punctual(punctual.index, receiver);
}

LightSample Lights::sample_punctual(std::uint32_t index, const Receiver& receiver) const {
  const Illumination light = illumination(punctual_[index], receiver.position);
  if (is_black(light.irradiance)) return nothing;
  const V3f position = std::isfinite(light.distance) ? receiver.position + light.direction * light.distance
                                                     : far_away(receiver, light.direction);
  return {position, light.direction, light.irradiance, 1.0f, true};
}

LightSample Lights::sample_distant(const Receiver& receiver, const V2f& u) const {
  const DiscreteDistribution::Choice choice = distant_choice_.sample(std::min(u.x, 0x1.fffffep-1f));
  if (distant_[choice.index] != no_index) {
    LightSample drawn = sample_punctual(distant_[choice.index], receiver);
    drawn.pdf_w *= choice.probability * distant_share_;
    drawn.light = punctual_number(distant_[choice.index]);
    return drawn;
  }
  const EnvironmentSample drawn = environment_->sample({choice.remapped, u.y});
  return {far_away(receiver, drawn.direction),
          drawn.direction,
          drawn.radiance,
          drawn.pdf_w * choice.probability * distant_share_,
          false,
          environment_number()};
}

// A point outside of everything, not further than need be.
V3f Lights::far_away(const Receiver& receiver, const V3f& direction) const {
  const float reach = (receiver.position - center_).length() + 2.0f * radius_;
  return receiver.position + direction * (reach > 0.0f ? reach : 1.0f);
}

float Lights::pdf_w(const Receiver& receiver, const V3f& direction, float distance,
                    const SurfacePoint& point) const {
  const std::uint32_t first = first_[point.shape];
  if (first == no_index) return 0.0f;
  const std::uint32_t index = entry_of_[first + point.primitive];
  const Shape& shape = shapes_[point.shape];
  if (index == no_index || is_black(shape.radiance[point.side])) return 0.0f;
  float probability = 1.0f - distant_share_;
  if (entries_.size() > 1) probability *= tree_.probability(receiver, index);
  if (const auto* polygon = std::get_if<LightPolygon>(&entries_[index].kind))
    return probability * PolygonView(*polygon, receiver).pdf_w(direction, distance);
  const float cosine = direction.dot(point.geometric_normal), distance2 = distance * distance;
  if (const auto* disk = std::get_if<Disk>(&shape.geometry))
    return probability * pdf_w_of_area(static_cast<float>(1.0 / area_of(*disk)), distance2, cosine);
  if (const auto* cylinder = std::get_if<Cylinder>(&shape.geometry)) {
    const float arc = 2.0f * visible_arc(*cylinder, shape, receiver.position).half;
    const float area = arc * cylinder->radius * cylinder->length;
    return area > 0.0f ? probability * pdf_w_of_area(1.0f / area, distance2, cosine) : 0.0f;
  }
  const Sphere& sphere = std::get<Sphere>(shape.geometry);
  const V3f to_center = sphere.center - receiver.position;
  const float d2 = to_center.dot(to_center);
  if (sees_cone(sphere.radius, d2)) return probability * cone_pdf_w(one_minus_cos_max(sphere.radius, d2));
  return probability * pdf_w_of_area(1.0f / (4.0f * pi_f * sphere.radius * sphere.radius), distance2, cosine);
}

float Lights::escaped_pdf_w(const Receiver&, const V3f& direction) const {
  if (environment_probability_ == 0.0f) return 0.0f;
  return environment_->pdf_w(direction) * environment_probability_ * distant_share_;
}

}  // namespace twopass
