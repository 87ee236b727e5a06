// Form factors between polygons against published closed forms, through the interface that the solvers use.
#include <gtest/gtest.h>

#include "radiosity/form_factor_pair.h"
#include "radiosity/lambert.h"
#include "tests/radiosity/polygon_samples.h"

namespace twopass {
namespace {

using test::parallelogram;
using test::translated;

const V3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);

struct Case {
  const char* name;
  Polygon a, b;
  double exact;  // F_ab, evaluated with 30 digits
};

Polygon leaning(double degrees) {
  const double angle = degrees * pi / 180;
  return parallelogram(V3d(0.0), y, V3d(std::cos(angle), 0, std::sin(angle)));
}

std::vector<Case> unit_squares() {
  const Polygon ground = parallelogram(V3d(0.0), x, y), wall = parallelogram(V3d(0.0), y, z);
  const auto ceiling = [](double height) { return parallelogram(z * height, y, x); };
  return {{"parallel, distance 0.01", ground, ceiling(0.01), 0.98041660292597327},
          {"parallel, distance 0.1", ground, ceiling(0.1), 0.82699452239725658},
          {"parallel, distance 0.5", ground, ceiling(0.5), 0.41525328357714674},
          {"parallel, distance 1", ground, ceiling(1), 0.19982489569838738304},
          {"parallel, distance 2", ground, ceiling(2), 0.068589588818552448},
          {"parallel, distance 5", ground, ceiling(5), 0.012403977313245102},
          {"parallel, distance 10", ground, ceiling(10), 0.0031620568387576016},
          {"parallel, distance 100", ground, ceiling(100), 3.1828866732829196e-05},
          {"parallel, distance 1, offset 1", ground, translated(ceiling(1), x), 0.086050489152327335},
          {"perpendicular, common edge", ground, wall, 0.20004377607540315424},
          {"perpendicular, gap 1", translated(ground, x), wall, 0.032808826719958734},
          {"perpendicular, common vertex", ground, translated(wall, y), 0.040592230101558543},
          {"dihedral angle 10", ground, leaning(10), 0.849606124962847171},
          {"dihedral angle 30", ground, leaning(30), 0.619028323090803253},
          {"dihedral angle 60", ground, leaning(60), 0.370905321150051436}};
}

// A square as it is, and as two triangles along either diagonal.
std::vector<std::vector<Polygon>> dissections(const Polygon& square) {
  const auto& v = square.v;
  return {{square},
          {make_polygon(v[0], v[1], v[2]), make_polygon(v[0], v[2], v[3])},
          {make_polygon(v[1], v[2], v[3]), make_polygon(v[1], v[3], v[0])}};
}

TEST(FormFactorTruth, UnitSquaresAsQuadrilateralsAndTriangles) {
  for (const Case& c : unit_squares())
    for (const auto& a : dissections(c.a))
      for (const auto& b : dissections(c.b))
        for (const auto& [accuracy, tolerance] : {std::pair{1e-4, 1e-4}, {1e-9, 1e-9}, {1e-12, 1e-12}}) {
          double sum = 0.0;
          for (const Polygon& p : a)
            for (const Polygon& q : b) sum += exchange_exact(p, q, accuracy);
          EXPECT_RELATIVE(sum, c.exact, tolerance) << c.name << ", accuracy " << accuracy;
        }
}

TEST(FormFactorTruth, TouchingSquaresToTheLastDigits) {
  for (const Case& c : unit_squares()) {
    if (c.exact < 0.04) continue;
    EXPECT_RELATIVE(exchange_exact(c.a, c.b, 1e-13), c.exact, 1e-14) << c.name;
  }
}

// The faces of a convex solid, seen from inside: every row sums to one.
void expect_closed(const std::vector<Polygon>& faces, double tolerance) {
  for (const Polygon& from : faces) {
    double sum = 0.0;
    for (const Polygon& to : faces)
      if (&to != &from) sum += exchange_exact(from, to, 1e-12);
    EXPECT_RELATIVE(sum / polygon_area(from), 1.0, tolerance);
  }
}

std::vector<Polygon> box(double width, double depth, double height) {
  const V3d u = x * width, v = y * depth, w = z * height;
  return {parallelogram(V3d(0.0), u, v), parallelogram(w, v, u),        parallelogram(V3d(0.0), v, w),
          parallelogram(u, w, v),        parallelogram(V3d(0.0), w, u), parallelogram(v, u, w)};
}

TEST(FormFactorTruth, CubeAndBoxesAreClosed) {
  expect_closed(box(1, 1, 1), 2e-15);
  expect_closed(box(1, 3, 10), 1e-14);
  expect_closed(box(1, 1, 1000), 1e-12);
  expect_closed(box(1, 1, 0.001), 1e-12);
}

TEST(FormFactorTruth, CubeOfElementsIsClosed) {
  // Every face 4 x 4 squares, each as two triangles: edges and vertices shared in every way.
  std::vector<Polygon> elements;
  for (const Polygon& face : box(1, 1, 1)) {
    const V3d u = (face.v[1] - face.v[0]) / 4.0, v = (face.v[3] - face.v[0]) / 4.0;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        const auto choices = dissections(parallelogram(face.v[0] + u * i + v * j, u, v));
        const std::vector<Polygon>& triangles = choices[1 + (i + j) % 2];
        elements.insert(elements.end(), triangles.begin(), triangles.end());
      }
  }
  ASSERT_EQ(elements.size(), 192u);
  for (std::size_t from = 0; from < elements.size(); from += 5) {
    double sum = 0.0, fast = 0.0;
    for (const Polygon& to : elements) {
      sum += exchange_exact(elements[from], to, 1e-9);
      fast += exchange_exact(elements[from], to);
    }
    EXPECT_RELATIVE(sum / polygon_area(elements[from]), 1.0, 1e-9);
    EXPECT_RELATIVE(fast / polygon_area(elements[from]), 1.0, 3e-5);
  }
}

TEST(FormFactorTruth, RegularTetrahedronIsOneThird) {
  const V3d a(1, 1, 1), b(1, -1, -1), c(-1, 1, -1), d(-1, -1, 1);
  const Polygon faces[] = {make_polygon(a, c, b), make_polygon(a, b, d), make_polygon(a, d, c),
                           make_polygon(b, c, d)};
  for (const Polygon& from : faces)
    for (const Polygon& to : faces)
      EXPECT_NEAR(exchange_exact(from, to, 1e-12) / polygon_area(from), &from == &to ? 0.0 : 1.0 / 3.0, 2e-15);
}

TEST(FormFactorTruth, IcosahedronIsClosed) {
  // Vertices (0, +-1, +-phi) and their rotations; the faces are the triples at distance 2 from each other.
  const double phi = (1 + std::sqrt(5.0)) / 2;
  std::vector<V3d> v;
  for (double s : {-1.0, 1.0})
    for (double t : {-phi, phi}) v.insert(v.end(), {V3d(0, s, t), V3d(s, t, 0), V3d(t, 0, s)});
  const auto adjacent = [&](int i, int j) { return std::abs((v[i] - v[j]).length() - 2) < 0.1; };
  std::vector<Polygon> faces;
  for (int i = 0; i < 12; ++i)
    for (int j = i + 1; j < 12; ++j)
      for (int k = j + 1; k < 12; ++k) {
        if (!adjacent(i, j) || !adjacent(j, k) || !adjacent(i, k)) continue;
        const bool outward = (v[j] - v[i]).cross(v[k] - v[i]).dot(v[i]) > 0;
        faces.push_back(outward ? make_polygon(v[i], v[k], v[j]) : make_polygon(v[i], v[j], v[k]));
      }
  ASSERT_EQ(faces.size(), 20u);
  expect_closed(faces, 1e-12);
}

TEST(FormFactorTruth, PointToSquare) {
  const Polygon ceiling = parallelogram(z, y, x), wall = parallelogram(V3d(0.0), y, z);
  EXPECT_RELATIVE(point_form_factor(V3d(0.0), z, ceiling), 0.13853160599489300, 1e-15);
  EXPECT_RELATIVE(point_form_factor(V3d(0.5, 0.5, 0), z, ceiling), 0.23945647046077354, 1e-15);
  EXPECT_RELATIVE(point_form_factor(V3d(0.5, 0.5, 0), z, wall), 0.19013588238480662, 1e-15);
  EXPECT_RELATIVE(point_form_factor(V3d(1, 0, 0), z, wall), 0.055734197002553502, 1e-15);
}

TEST(FormFactorTruth, SphereOfTrianglesTendsToAreaOverSphere) {
  // Any two elements of a sphere's inside: F_ij = A_j / (4 pi R^2), wherever they are. Small triangles
  // inscribed in the sphere stand askew by less than their size.
  const auto element = [](double azimuth, double polar, double size) {
    const auto at = [](double f, double t) {
      return V3d(std::sin(t) * std::cos(f), std::sin(t) * std::sin(f), std::cos(t));
    };
    return make_polygon(at(azimuth, polar), at(azimuth + size, polar), at(azimuth, polar + size));
  };
  for (double size : {1e-1, 1e-2, 1e-3, 1e-4})
    for (const auto& [azimuth, polar] : {std::pair{0.1, 2.5}, {3.0, 1.5}, {1.0, 1.0}}) {
      const Polygon a = element(0.1, 1.0, size), b = element(azimuth, polar, size);
      EXPECT_RELATIVE(exchange_exact(a, b, 1e-9), polygon_area(a) * polygon_area(b) / (4 * pi), 0.5 * size);
    }
}

// CIE 171:2006, the geometry of its room of 4 x 4 x 3 m and points A to F up the wall, G to N along the floor.
// The values are those of the closed form (R2) evaluated elsewhere; the standard prints 46.74 for A of 5.9's
// wide opening, which is wrong.
struct CiePoint {
  V3d position, normal;
  double expected;
};

std::vector<CiePoint> cie_points(std::initializer_list<double> wall, std::initializer_list<double> floor) {
  std::vector<CiePoint> points;
  double height = 2.75, distance = 0.25;
  for (const double expected : wall) {
    points.push_back({V3d(2, 0, height), V3d(0, 1, 0), expected});
    height -= 0.5;
  }
  for (const double expected : floor) {
    points.push_back({V3d(2, distance, 0), V3d(0, 0, 1), expected});
    distance += 0.5;
  }
  return points;
}

// A square of the given edge in the middle of the ceiling, facing down.
Polygon ceiling_square(double edge) {
  const double low = 2.0 - 0.5 * edge;
  return parallelogram(V3d(low, low, 3), V3d(0, edge, 0), V3d(edge, 0, 0));
}

TEST(FormFactorTruth, CieAreaSource) {
  // 5.3: 1000 cd straight down from 1 m2: an exitance of 1000 pi lm/m2.
  for (const auto& [position, normal, expected] : cie_points(
           {32.6769, 75.1939, 81.3232, 69.0606, 53.4035, 40.0019}, {61.4241, 79.2552, 95.6673, 105.7782}))
    EXPECT_NEAR(1000.0 * pi * point_form_factor(position, normal, ceiling_square(1.0)), expected, 6e-5);
}

TEST(FormFactorTruth, CieRoofOpeningsUnderAUniformSky) {
  // 5.9: the sky component in per cent.
  for (const auto& [position, normal, expected] :
       cie_points({1.0401, 2.3935, 2.5886, 2.1983, 1.6999, 1.2733}, {1.9552, 2.5228, 3.0452, 3.3670}))
    EXPECT_NEAR(100.0 * point_form_factor(position, normal, ceiling_square(1.0)), expected, 6e-5);
  for (const auto& [position, normal, expected] :
       cie_points({45.1226, 35.9005, 27.9916, 21.6385, 16.7163, 12.9674}, {26.7952, 30.9387, 33.9757, 35.5666}))
    EXPECT_NEAR(100.0 * point_form_factor(position, normal, ceiling_square(4.0)), expected, 6e-5);
}

TEST(FormFactorTruth, CieReflectorOnTheFloor) {
  // 5.6, second scenario: of a floor that is lit evenly, 100 E / (E_hz rho); the room upside down.
  const Polygon floor = parallelogram(V3d(0.0), V3d(4, 0, 0), V3d(0, 4, 0));
  double height = 0.75;
  for (const double expected : {35.9005, 27.9916, 21.6385, 16.7163, 12.9674}) {
    EXPECT_NEAR(100.0 * point_form_factor(V3d(2, 0, height), V3d(0, 1, 0), floor), expected, 6e-5);
    height += 0.5;
  }
  double distance = 0.25;
  for (const double expected : {26.7952, 30.9387, 33.9757, 35.5666}) {
    EXPECT_NEAR(100.0 * point_form_factor(V3d(2, distance, 3), V3d(0, 0, -1), floor), expected, 6e-5);
    distance += 0.5;
  }
}

}  // namespace
}  // namespace twopass
