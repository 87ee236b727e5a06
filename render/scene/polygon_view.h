// A polygonal light as one receiver sees it: how points of it are drawn, and how densely.
#pragma once

#include <variant>

#include "render/core/frame.h"
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

/// Const once built; everything is decided by the constructor, from the polygon and the receiver alone.
/// REQUIRES: polygon and receiver outlive the view; bilinear is for parallelograms, projected for diffuse
/// receivers.
class PolygonView {
 public:
  PolygonView(const LightPolygon& polygon, const Receiver& receiver);
  PolygonView(const LightPolygon& polygon, const Receiver& receiver, PolygonTechnique technique);

  /// The side of the polygon that the receiver is on.
  [[nodiscard]] Side side() const { return height_ >= 0.0 ? front : back; }

  struct Point {
    V3f position;  ///< on the polygon
    V3f direction;
    float pdf_w;  ///< 0: nothing to be had
  };
  [[nodiscard]] Point sample(const V2f& u) const;
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
  void prepare(PolygonTechnique technique, const Bilinear& weights);
  [[nodiscard]] SolidAngle solid_angle() const;
  [[nodiscard]] Projected projected() const;
  [[nodiscard]] Point at(const V3f& position, float pdf_a) const;
  [[nodiscard]] Point towards(const V3d& direction, double pdf_w) const;
  [[nodiscard]] float pdf_w_of_area(float pdf_a, double distance) const;

  const LightPolygon& polygon_;
  const Receiver& receiver_;
  double height_;  // of the receiver over the polygon's plane
  std::variant<Area, Bilinear, SolidAngle, Projected> way_;
};

}  // namespace twopass
