// A polygonal light as one receiver sees it: how points of it are drawn, and how densely.
#pragma once

#include <variant>

#include "render/core/frame.h"
#include "render/core/warp.h"
#include "render/scene/light_polygon.h"
#include "render/scene/projected_polygon.h"
#include "render/scene/receiver.h"

namespace twopass {

/// The ways to draw a point of a polygon.
enum class PolygonTechnique : std::uint8_t {
  area,         ///< uniform in area
  bilinear,     ///< parallelograms only: in area, with the integrand at the corners, bilinear in between (L4)
  solid_angle,  ///< uniform in solid angle, from both hemispheres
  projected     ///< uniform in projected solid angle of the receiver's hemisphere (L5)
};

/// The technique that has the least variance for its time (L3).
PolygonTechnique choose_technique(const LightPolygon& polygon, const Receiver& receiver);

/// How far the receiver is in front of the polygon's plane; negative behind.
inline double height_over(const LightPolygon& polygon, const Receiver& receiver) {
  return polygon.normal.dot(V3d(receiver.position) - V3d(polygon.corner[0]));
}
/// The side of the polygon that the receiver is on.
inline Side side_of(const LightPolygon& polygon, const Receiver& receiver) {
  return height_over(polygon, receiver) >= 0.0 ? front : back;
}

/// From afar the integrand is even enough not to be looked at: what noise remains is less than what shadows and
/// the rest of the path have (measured in pictures, render/scene/README.md).
inline bool is_far(const LightPolygon& polygon, const Receiver& receiver) {
  constexpr float far_reach2 = 0.1f;  // distances of more than three times the reach
  const V3f to_middle = polygon.middle - receiver.position;
  return polygon.reach2 < far_reach2 * to_middle.dot(to_middle);
}

/// A uniform point of the polygon.
inline V3f uniform_point(const LightPolygon& polygon, const V2f& u) {
  const auto& c = polygon.corner;
  if (polygon.is_parallelogram) return c[0] + (c[1] - c[0]) * u.x + (c[3] - c[0]) * u.y;
  // One of the at most two triangles on the diagonal from the first corner.
  const float share = polygon.first_share;
  const bool is_first = u.x < share;
  const float x = is_first ? u.x / share : (u.x - share) / (1.0f - share);
  const V2f b = square_to_triangle({std::min(x, 1.0f), u.y});
  const V3f &p = c[is_first ? 1 : 2], &q = c[is_first ? 2 : 3];
  return c[0] + (p - c[0]) * b.x + (q - c[0]) * b.y;
}

/// Const once built; everything is decided by the constructor, from the polygon and the receiver alone.
/// REQUIRES: polygon and receiver outlive the view; bilinear is for parallelograms, projected for diffuse
/// receivers. Inline where points are drawn by area: that is what most paths do.
class PolygonView {
 public:
  PolygonView(const LightPolygon& polygon, const Receiver& receiver)
      : polygon_(polygon), receiver_(receiver), height_(height_over(polygon, receiver)) {
    if (!is_far(polygon, receiver)) prepare();
  }
  PolygonView(const LightPolygon& polygon, const Receiver& receiver, PolygonTechnique technique);

  /// The side of the polygon that the receiver is on.
  [[nodiscard]] Side side() const { return height_ >= 0.0 ? front : back; }

  struct Point {
    V3f position;  ///< on the polygon
    V3f direction;
    float pdf_w;  ///< 0: nothing to be had
  };
  [[nodiscard]] Point sample(const V2f& u) const {
    if (height_ == 0.0) return {polygon_.corner[0], V3f(0.0f, 0.0f, 1.0f), 0.0f};
    if (!std::holds_alternative<Area>(way_)) return sample_near(u);
    return at(uniform_point(polygon_, u), polygon_.pdf_a);
  }
  /// The density of sample() at the polygon's point in `direction`, at `distance`.
  [[nodiscard]] float pdf_w(const V3f& direction, float distance) const;

 private:
  struct Area {};
  using Bilinear = std::array<float, 4>;  // weights of the corners
  struct SolidAngle {
    std::array<V3d, 4> corner;     // directions to them
    std::array<double, 2> part{};  // solid angles of the two spherical triangles
  };
  struct Projected {
    Frame frame;
    ProjectedPolygon polygon;
  };
  [[nodiscard]] V3d to_corner(int i) const { return V3d(polygon_.corner[i]) - V3d(receiver_.position); }
  // Chooses by the integrand.
  void prepare();
  void prepare(PolygonTechnique technique, const Bilinear& weights);
  [[nodiscard]] SolidAngle solid_angle() const;
  [[nodiscard]] Projected projected() const;
  [[nodiscard]] Point sample_near(const V2f& u) const;
  [[nodiscard]] Point at(const V3f& position, float pdf_a) const {
    const V3f to_light = position - receiver_.position;
    const float distance = std::sqrt(to_light.dot(to_light));
    if (!(distance > 0.0f)) return {position, V3f(0.0f, 0.0f, 1.0f), 0.0f};
    return {position, to_light * (1.0f / distance), pdf_w_of_area(pdf_a, distance)};
  }
  [[nodiscard]] Point towards(const V3d& direction, double pdf_w) const;
  [[nodiscard]] float pdf_w_of_area(float pdf_a, double distance) const {
    return static_cast<float>(pdf_a * distance * distance * distance / std::abs(height_));
  }

  const LightPolygon& polygon_;
  const Receiver& receiver_;
  double height_;  // of the receiver over the polygon's plane
  std::variant<Area, Bilinear, SolidAngle, Projected> way_;
};

}  // namespace twopass
