#include "render/scene/polygon_view.h"

#include "render/core/warp.h"

namespace twopass {

namespace {

// What the receiver gets from a unit of the light's area at `to_light`, but for factors common to all points.
// `per_scale2` is one over any squared length of the size of the distances, against overflow.
float integrand(const V3f& to_light, const Receiver& receiver, float per_scale2) {
  const float d2 = to_light.dot(to_light) * per_scale2;
  if (!receiver.is_diffuse) return 1.0f / (d2 * std::sqrt(d2));
  return std::max(0.0f, to_light.dot(receiver.normal)) / (d2 * d2);
}

// The integrand at the corners and in the middle, in units of its value there.
struct Integrand {
  std::array<float, 4> corner;
  float least, largest, mean, middle;
  float reach2;  // squared distance of the farthest corner from the middle, over that of the receiver
};

Integrand integrand_over(const LightPolygon& polygon, const Receiver& receiver) {
  V3f to_middle(0.0f);
  std::array<V3f, 4> to_corner;
  for (int i = 0; i < polygon.corners; ++i) {
    to_corner[i] = polygon.corner[i] - receiver.position;
    to_middle += to_corner[i];
  }
  const float share = polygon.corners == 4 ? 0.25f : 1.0f / 3.0f;
  to_middle *= share;
  const float per_scale2 = 1.0f / to_middle.dot(to_middle);
  const float middle = integrand(to_middle, receiver, per_scale2);
  Integrand f{{}, middle, middle, 0.0f, middle, 0.0f};
  for (int i = 0; i < polygon.corners; ++i) {
    const float value = f.corner[i] = integrand(to_corner[i], receiver, per_scale2);
    f.least = std::min(f.least, value);
    f.largest = std::max(f.largest, value);
    f.mean += value * share;
    const V3f across = to_corner[i] - to_middle;
    f.reach2 = std::max(f.reach2, across.dot(across) * per_scale2);
  }
  return f;
}

// The solid angle, projected or not, below which directions have too few digits for the techniques that draw
// them: then points are drawn after all.
constexpr double least_solid_angle = 1e-9;

PolygonTechnique choose(const LightPolygon& polygon, const Receiver& receiver, const Integrand& f) {
  // Relative errors of taking the integrand for constant and for bilinear: beyond, the noise costs more than
  // drawing directions does, among all the other noise that a path has. Comparisons fail for what is not a
  // number, next to a corner.
  constexpr float most_uneven = 0.2f, most_bent = 0.5f;
  if (f.largest <= 0.0f) return PolygonTechnique::area;  // below the horizon: whatever is cheap
  // Within the polygon's reach the integrand may peak between the places where it was looked at.
  const bool is_away = f.reach2 < 0.7f;
  if (is_away && f.least > 0.0f && f.largest - f.least <= most_uneven * f.mean) return PolygonTechnique::area;
  if (is_away && f.least > 0.0f && polygon.is_parallelogram &&
      std::abs(f.middle - f.mean) <= most_bent * f.mean)
    return PolygonTechnique::bilinear;
  return receiver.is_diffuse ? PolygonTechnique::projected : PolygonTechnique::solid_angle;
}

}  // namespace

PolygonTechnique choose_technique(const LightPolygon& polygon, const Receiver& receiver) {
  if (is_far(polygon, receiver)) return PolygonTechnique::area;
  return choose(polygon, receiver, integrand_over(polygon, receiver));
}

void PolygonView::prepare() {
  const Integrand f = integrand_over(polygon_, receiver_);
  prepare(choose(polygon_, receiver_, f), f.corner);
}

PolygonView::PolygonView(const LightPolygon& polygon, const Receiver& receiver, PolygonTechnique technique)
    : polygon_(polygon), receiver_(receiver), height_(height_over(polygon, receiver)) {
  prepare(technique, integrand_over(polygon, receiver).corner);
}

void PolygonView::prepare(PolygonTechnique technique, const Bilinear& weights) {
  switch (technique) {
    case PolygonTechnique::area:
      break;
    case PolygonTechnique::bilinear:
      way_ = weights;
      break;
    case PolygonTechnique::solid_angle:
      if (const SolidAngle view = solid_angle(); view.part[0] + view.part[1] > least_solid_angle) way_ = view;
      break;
    case PolygonTechnique::projected:
      if (const Projected view = projected(); view.polygon.area() > least_solid_angle) way_ = view;
      break;
  }
}

PolygonView::SolidAngle PolygonView::solid_angle() const {
  SolidAngle view;
  for (int i = 0; i < polygon_.corners; ++i) {
    view.corner[i] = to_corner(i);
    view.corner[i] /= view.corner[i].length();
  }
  for (int i = 0; i < polygon_.corners - 2; ++i)
    view.part[i] = spherical_triangle_solid_angle(view.corner[0], view.corner[i + 1], view.corner[i + 2]);
  return view;
}

PolygonView::Projected PolygonView::projected() const {
  const Frame frame(receiver_.normal);
  const V3d s(frame.s), t(frame.t), n(frame.n);
  std::array<V3d, 4> local;
  for (int i = 0; i < polygon_.corners; ++i) {
    // Counter-clockwise from the front is clockwise for one who looks from the front's side.
    const V3d v = to_corner(side() == front ? polygon_.corners - 1 - i : i);
    local[i] = V3d(v.dot(s), v.dot(t), v.dot(n));
  }
  return {frame, ProjectedPolygon({local.data(), static_cast<std::size_t>(polygon_.corners)})};
}

PolygonView::Point PolygonView::towards(const V3d& direction, double pdf_w) const {
  const double distance = -height_ / direction.dot(polygon_.normal);
  return {V3f(V3d(receiver_.position) + direction * distance), V3f(direction), static_cast<float>(pdf_w)};
}

PolygonView::Point PolygonView::sample_near(const V2f& u) const {
  const auto& c = polygon_.corner;
  if (const auto* weight = std::get_if<Bilinear>(&way_)) {
    const V2f p = square_to_bilinear(u, *weight);
    return at(c[0] + (c[1] - c[0]) * p.x + (c[3] - c[0]) * p.y, bilinear_pdf_a(p, *weight) * polygon_.pdf_a);
  }
  if (const auto* view = std::get_if<Projected>(&way_)) {
    const V3d w = view->polygon.sample(u);
    return towards(V3d(view->frame.s) * w.x + V3d(view->frame.t) * w.y + V3d(view->frame.n) * w.z,
                   w.z / view->polygon.area());
  }
  const auto& view = std::get<SolidAngle>(way_);
  const double total = view.part[0] + view.part[1], wanted = u.x * total;
  const int k = wanted < view.part[0] ? 0 : 1;
  const double x = std::min(1.0, (wanted - (k == 0 ? 0.0 : view.part[0])) / view.part[k]);
  return towards(square_to_spherical_triangle(x, u.y, view.corner[0], view.corner[k + 1], view.corner[k + 2]),
                 1.0 / total);
}

float PolygonView::pdf_w(const V3f& direction, float distance) const {
  if (height_ == 0.0) return 0.0f;
  if (const auto* weight = std::get_if<Bilinear>(&way_)) {
    const V3f p = receiver_.position + direction * distance - polygon_.corner[0];
    const V2f s(std::clamp(p.dot(polygon_.dual1), 0.0f, 1.0f), std::clamp(p.dot(polygon_.dual2), 0.0f, 1.0f));
    return pdf_w_of_area(bilinear_pdf_a(s, *weight) * polygon_.pdf_a, distance);
  }
  if (const auto* view = std::get_if<Projected>(&way_)) {
    const double cosine = direction.dot(receiver_.normal), area = view->polygon.area();
    return cosine > 0.0 ? static_cast<float>(cosine / area) : 0.0f;
  }
  if (const auto* view = std::get_if<SolidAngle>(&way_)) {
    return static_cast<float>(1.0 / (view->part[0] + view->part[1]));
  }
  return pdf_w_of_area(polygon_.pdf_a, distance);
}

}  // namespace twopass
