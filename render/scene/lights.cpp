#include "render/scene/lights.h"

#include "render/core/warp.h"
#include "render/scene/geometry.h"

namespace twopass {

namespace {

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

}  // namespace

Lights::Lights(std::span<const Shape> shapes) : shapes_(shapes), first_entry_(shapes.size(), no_index) {
  std::vector<double> power;
  for (std::uint32_t s = 0; s < shapes.size(); ++s) {
    const Shape& shape = shapes[s];
    if (!is_emitter(shape)) continue;
    const double exitance = pi * (mean_component(shape.radiance[front]) + mean_component(shape.radiance[back]));
    first_entry_[s] = static_cast<std::uint32_t>(entries_.size());
    const auto add = [&](Entry entry, double area) {
      entry.pdf_a = static_cast<float>(1.0 / area);
      entries_.push_back(entry);
      power.push_back(exitance * area);
    };
    if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
      add({s, 0.0f, rounding_offset(*sphere), {}, {}, {}, {}}, 4.0 * pi * sphere->radius * sphere->radius);
      continue;
    }
    const Mesh& mesh = std::get<Mesh>(shape.geometry);
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const auto p = corners(mesh, i);
      const V3f e1 = p[1] - p[0], e2 = p[2] - p[0];
      add({s, 0.0f, rounding_offset(p), p[0], e1, e2, unit(e1.cross(e2))},
          0.5 * V3d(e1).cross(V3d(e2)).length());
    }
  }
  choice_ = DiscreteDistribution(power);
  if (choice_.empty()) return;
  for (std::uint32_t i = 0; i < entries_.size(); ++i) entries_[i].pdf_a *= choice_.probability(i);
}

LightSample Lights::sample(const V3f& receiver, const V2f& u) const {
  const DiscreteDistribution::Choice choice = choice_.sample(u.x);
  const Entry& entry = entries_[choice.index];
  const Shape& shape = shapes_[entry.shape];
  const V2f v(choice.remapped, u.y);

  V3f position, normal = entry.normal;  // the normal of the front
  if (std::holds_alternative<Mesh>(shape.geometry)) {
    const V2f b = square_to_triangle(v);
    position = entry.corner + entry.edge1 * b.x + entry.edge2 * b.y;
  } else {
    const Sphere& sphere = std::get<Sphere>(shape.geometry);
    const V3f to_center = sphere.center - receiver;
    const float d2 = to_center.dot(to_center);
    const float sign = sphere.inward ? -1.0f : 1.0f;
    if (sees_cone(sphere.radius, d2)) {
      const float spread = one_minus_cos_max(sphere.radius, d2);
      const V3f direction = Frame(to_center * (1.0f / std::sqrt(d2))).to_world(square_to_cone(v, spread));
      double near, far;
      // Rounding can make a grazing direction miss: the nearest point of the line is then on the sphere to
      // rounding.
      if (!intersect_sphere(sphere, receiver, direction, near, far)) near = to_center.dot(direction);
      const V3f outward = (V3f(V3d(receiver) + V3d(direction) * near) - sphere.center).normalized();
      position = sphere.center + outward * (sphere.radius + entry.offset);
      return {position, direction, shape.radiance[outside(sphere)], choice.probability * cone_pdf_w(spread)};
    }
    const V3f outward = square_to_sphere(v);
    position = sphere.center + outward * sphere.radius;
    normal = outward * sign;
  }

  const V3f to_light = position - receiver;
  const float d2 = to_light.dot(to_light);
  if (!(d2 > 0.0f)) return {position, V3f(0.0f, 0.0f, 1.0f), C3f(0.0f), 0.0f};
  const V3f direction = to_light * (1.0f / std::sqrt(d2));
  const float cosine = -direction.dot(normal);
  const Side side = cosine >= 0.0f ? front : back;
  const V3f toward_receiver = side == front ? normal : -normal;
  if (cosine == 0.0f) return {position, direction, C3f(0.0f), 0.0f};
  return {position + toward_receiver * entry.offset, direction, shape.radiance[side],
          entry.pdf_a * d2 / std::abs(cosine)};
}

float Lights::pdf_w(const V3f& receiver, const V3f& direction, float distance,
                    const SurfacePoint& point) const {
  const std::uint32_t first = first_entry_[point.shape];
  if (first == no_index) return 0.0f;
  const Shape& shape = shapes_[point.shape];
  if (is_black(shape.radiance[point.side])) return 0.0f;
  const std::uint32_t entry = first + point.primitive;
  if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
    const V3f to_center = sphere->center - receiver;
    const float d2 = to_center.dot(to_center);
    if (sees_cone(sphere->radius, d2))
      return choice_.probability(entry) * cone_pdf_w(one_minus_cos_max(sphere->radius, d2));
  }
  const float cosine = std::abs(direction.dot(point.geometric_normal));
  if (cosine == 0.0f) return 0.0f;
  return entries_[entry].pdf_a * distance * distance / cosine;
}

}  // namespace twopass
