// Polygons to test form factors with: rectangles, random shapes, rotations, and references computed in long
// double.
#pragma once

#include <numbers>
#include <random>

#include "radiosity/gauss_rules.h"
#include "radiosity/polygon.h"

namespace twopass::test {

/// The parallelogram from `corner` along u, then v: its front is on the side of u x v.
inline Polygon parallelogram(const V3d& corner, const V3d& u, const V3d& v) {
  return make_polygon(corner, corner + u, corner + u + v, corner + v);
}

inline Polygon reversed(const Polygon& polygon) {
  Polygon result = polygon;
  for (int i = 0; i < polygon.n; ++i) result.v[i] = polygon.v[polygon.n - 1 - i];
  return result;
}

inline Polygon scaled(const Polygon& polygon, double factor) {
  Polygon result = polygon;
  for (int i = 0; i < polygon.n; ++i) result.v[i] *= factor;
  return result;
}

inline Polygon translated(const Polygon& polygon, const V3d& offset) {
  Polygon result = polygon;
  for (int i = 0; i < polygon.n; ++i) result.v[i] += offset;
  return result;
}

struct Rotation {
  V3d x, y, z;
  V3d operator()(const V3d& p) const { return x * p.x + y * p.y + z * p.z; }
  Polygon operator()(const Polygon& polygon) const {
    Polygon result = polygon;
    for (int i = 0; i < polygon.n; ++i) result.v[i] = (*this)(polygon.v[i]);
    return result;
  }
};

class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}

  /// Uniform in [low, high).
  double in(double low, double high) {
    return low + (high - low) * 0x1p-53 * static_cast<double>(generator_() >> 11);
  }
  V3d in_cube(double half) { return {in(-half, half), in(-half, half), in(-half, half)}; }
  V3d direction() {
    for (;;) {
      const V3d v = in_cube(1.0);
      if (v.length2() < 1.0 && v.length2() > 0.01) return v.normalized();
    }
  }
  Rotation rotation() {
    const V3d z = direction(), x = z.cross(direction()).normalized();
    return {x, z.cross(x), z};
  }
  /// A triangle (3 corners) or convex quadrilateral (4) inscribed in a circle of this radius, any orientation.
  Polygon inscribed(const V3d& centre, double radius, int corners) {
    const Rotation rotation_to = rotation();
    const double turn = 2.0 * pi / corners, start = in(0.0, 2.0 * pi);
    Polygon polygon;
    for (polygon.n = 0; polygon.n < corners; ++polygon.n) {
      const double angle = start + turn * (polygon.n + in(-0.3, 0.3));
      polygon.v[polygon.n] = centre + rotation_to(V3d(std::cos(angle), std::sin(angle), 0.0)) * radius;
    }
    return polygon;
  }

 private:
  std::mt19937_64 generator_;
};

/// A_a F_ab of the rectangles [x0, x1] x [y0, y1] at height 0 and [u0, u1] x [v0, v1] at height z > 0, facing
/// each other: 16 terms in closed form, in long double.
inline double parallel_rectangles(const double (&x)[2], const double (&y)[2], const double (&u)[2],
                                  const double (&v)[2], double height) {
  using Real = long double;
  const Real z = height;
  const auto g = [z](Real s, Real t) {
    const Real a = std::sqrt(s * s + z * z), b = std::sqrt(t * t + z * z);
    return (t * a * std::atan(t / a) + s * b * std::atan(s / b) - z * z / 2 * std::log(s * s + t * t + z * z)) /
           (2 * std::numbers::pi_v<Real>);
  };
  Real sum = 0;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      for (int k = 0; k < 2; ++k)
        for (int l = 0; l < 2; ++l)
          sum += ((i + j + k + l) % 2 == 0 ? 1 : -1) * g(Real(x[i]) - Real(u[k]), Real(y[j]) - Real(v[l]));
  return static_cast<double>(sum);
}

/// A_a F_ab of the rectangle [x0, x1] x [y0, y1] in the plane z = 0 and [v0, v1] x [z0, z1] in the plane x = 0
/// (y runs along both; x, z >= 0): 16 terms in closed form, in long double.
inline double perpendicular_rectangles(const double (&x)[2], const double (&y)[2], const double (&v)[2],
                                       const double (&z)[2]) {
  using Real = long double;
  const auto g = [](Real s, Real d, Real t) {
    const Real r2 = s * s + t * t, r = std::sqrt(r2), sum2 = r2 + d * d;
    const Real angle = r > 0 ? d * r * std::atan(d / r) : Real(0);
    return (angle - (sum2 > 0 ? (r2 - d * d) / 4 * std::log(sum2) : Real(0))) / (2 * std::numbers::pi_v<Real>);
  };
  Real sum = 0;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      for (int k = 0; k < 2; ++k)
        for (int l = 0; l < 2; ++l)
          sum += ((i + j + k + l) % 2 == 0 ? 1 : -1) * g(x[i], Real(y[j]) - Real(v[k]), z[l]);
  return static_cast<double>(sum);
}

/// A_a F_ab of two parallelograms, or of two triangles given as such (v[3] unused), at a distance of several
/// radii: the double area integral by 16^4 points in long double, good to 1e-15 from about 4 radii on.
/// REQUIRES: fronts in full view.
inline double far_reference(const Polygon& a, const Polygon& b) {
  using Real = long double;
  struct Point {
    Real x, y, z, w;
  };
  constexpr int n = GaussRule::max_points;
  const auto points_on = [](const Polygon& p) {
    std::array<Point, n * n> points;
    const V3d u = p.v[1] - p.v[0], v = p.v[p.n - 1] - p.v[0];
    const double area = (p.n == 3 ? 2.0 : 1.0) * polygon_area(p);
    const GaussRule& along = gauss_legendre(n);
    const GaussRule& across = p.n == 3 ? gauss_jacobi(n) : gauss_legendre(n);
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const Real t = across.x[j], s = along.x[i] * (p.n == 3 ? 1 - t : Real(1));
        points[j * n + i] = {p.v[0].x + s * u.x + t * v.x, p.v[0].y + s * u.y + t * v.y,
                             p.v[0].z + s * u.z + t * v.z, Real(area) * along.w[i] * across.w[j]};
      }
    return points;
  };
  const V3d na = polygon_area_vector(a).normalized(), nb = polygon_area_vector(b).normalized();
  const auto on_a = points_on(a), on_b = points_on(b);
  Real sum = 0;
  for (const Point& p : on_a)
    for (const Point& q : on_b) {
      const Real x = q.x - p.x, y = q.y - p.y, z = q.z - p.z, r2 = x * x + y * y + z * z;
      sum -= p.w * q.w * (na.x * x + na.y * y + na.z * z) * (nb.x * x + nb.y * y + nb.z * z) / (r2 * r2);
    }
  return static_cast<double>(sum / std::numbers::pi_v<Real>);
}

}  // namespace twopass::test

/// Expects value / reference - 1 to be at most `tolerance` in size.
#define EXPECT_RELATIVE(value, reference, tolerance) \
  EXPECT_NEAR((value) / (reference), 1.0, tolerance) << "value " << (value) << ", reference " << (reference)
