#include "radiosity/pieces.h"

#include <gtest/gtest.h>

#include "radiosity/form_factor_table.h"
#include "radiosity/solution.h"
#include "radiosity/subdivision.h"
#include "render/core/sampler.h"
#include "render/core/warp.h"
#include "render/scene/geometry.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

const std::array<V3f, 3> mirrored_axes{V3f(0, 1, 0), V3f(1, 0, 0), V3f(0, 0, 1)};

std::vector<Geometry> surfaces() {
  const Frame frame(V3f(2, -1, 2) / 3.0f);
  const std::array<V3f, 3> skew{frame.s, frame.t, frame.n};
  return {Sphere{V3f(1, 2, 3), 1.5f, false, skew},
          Sphere{V3f(1, 2, 3), 1.5f, true, skew},
          Disk{V3f(1, -2, 3), frame.s * 2.0f, frame.t, false},
          Disk{V3f(1, -2, 3), frame.s * 2.0f, frame.t + frame.s * 0.3f, true},
          Cylinder{V3f(3, 1, -1), 0.5f, 2.0f, false, skew},
          Cylinder{V3f(3, 1, -1), 0.5f, 0.1f, true, skew},
          Cylinder{V3f(3, 1, -1), 0.1f, 9.0f, false, mirrored_axes}};
}

double exact_area(const Geometry& geometry) {
  if (const auto* sphere = std::get_if<Sphere>(&geometry)) return 4.0 * pi * sphere->radius * sphere->radius;
  if (const auto* disk = std::get_if<Disk>(&geometry)) return area_of(*disk);
  return area_of(std::get<Cylinder>(geometry));
}

// The unit normal of the front at a point of the surface.
V3d front_normal(const Geometry& geometry, const V3d& at) {
  if (const auto* sphere = std::get_if<Sphere>(&geometry))
    return (at - V3d(sphere->center)).normalized() * (sphere->inward ? -1.0 : 1.0);
  if (const auto* disk = std::get_if<Disk>(&geometry)) return V3d(unit_normal(*disk));
  const auto& cylinder = std::get<Cylinder>(geometry);
  float along;
  const V3f outward = outward_at(cylinder, V3f(at), along);
  return V3d(cylinder.inward ? -outward : outward);
}

TEST(Pieces, CoverTheSurfaceOnce) {
  for (const Geometry& geometry : surfaces()) {
    for (const Side side : {front, back}) {
      double area = 0.0;
      for (std::uint32_t p = 0; p < piece_count(geometry); ++p) area += piece_patch(geometry, p, side).area;
      EXPECT_NEAR(area / exact_area(geometry), 1.0, 1e-6);
    }
  }
}

TEST(Pieces, CellsOfDisksAndCylindersAreOfEqualArea) {
  for (const Geometry& geometry : surfaces()) {
    if (std::holds_alternative<Sphere>(geometry)) continue;
    constexpr std::uint32_t n = 5;
    for (std::uint32_t p = 0; p < piece_count(geometry); ++p) {
      const double whole = piece_patch(geometry, p, front).area;
      EXPECT_NEAR(cell_patch(geometry, p, {V2i(1, 2), V2i(2, 2), V2i(1, 3)}, n, front).area, whole / 25,
                  1e-9 * whole);
      EXPECT_NEAR(cell_patch(geometry, p, {V2i(1, 1), V2i(0, 1), V2i(1, 0)}, n, front).area, whole / 25,
                  1e-9 * whole);
    }
  }
}

// Corners run around the normal of the side, and samples lie on the surface with that normal, in their piece.
TEST(Pieces, SamplesLieWhereTheyAreFound) {
  for (const Geometry& geometry : surfaces()) {
    for (std::uint32_t p = 0; p < piece_count(geometry); ++p)
      for (const Side side : {front, back}) {
        const Patch patch = piece_patch(geometry, p, side);
        for (std::uint32_t k = 0; k < 16; ++k) {
          ElementPoint point = patch.sample(Sampler(1, p, k).next_2d());
          const double sign = side == front ? 1.0 : -1.0;
          EXPECT_GT(point.normal.dot(front_normal(geometry, point.position)) * sign, 1.0 - 1e-6);
          EXPECT_GT(point.normal.dot(patch.normal), 0.5);
          // A little towards the middle: borders belong to either side.
          point.position += (patch.centroid().position - point.position) * 1e-3;
          const PieceLocation found = locate_piece(geometry, V3f(point.position));
          ASSERT_EQ(found.piece, p);
          EXPECT_GE(std::min({found.u, found.v, 1.0f - found.u - found.v}), -1e-4f);
        }
      }
  }
}

// The barycentric coordinates that a point is found at are those of the grid.
TEST(Pieces, LocationsAreThoseOfTheGrid) {
  for (const Geometry& geometry : surfaces())
    for (std::uint32_t p = 0; p < piece_count(geometry); ++p)
      for (const V2i& at : {V2i(1, 1), V2i(5, 2), V2i(2, 6)}) {
        const PieceLocation found = locate_piece(geometry, V3f(piece_grid_point(geometry, p, at, 9)));
        EXPECT_EQ(found.piece, p);
        EXPECT_NEAR(found.u, static_cast<float>(at.x) / 9.0f, 2e-5f);
        EXPECT_NEAR(found.v, static_cast<float>(at.y) / 9.0f, 2e-5f);
      }
}

// Corners with equal keys are equal bit for bit, all around a cylinder too, and others are not.
TEST(Pieces, NeighboursMeetBitForBit) {
  for (const Geometry& geometry : surfaces()) {
    std::vector<std::pair<V3f, V3d>> corners;
    for (std::uint32_t p = 0; p < piece_count(geometry); ++p)
      for (int k = 0; k < 3; ++k)
        corners.emplace_back(piece_corner_key(geometry, p, k),
                             piece_grid_point(geometry, p, V2i(k == 1 ? 1 : 0, k == 2 ? 1 : 0), 1));
    for (const auto& a : corners)
      for (const auto& b : corners) {
        if (a.first == b.first)
          EXPECT_EQ(a.second, b.second);
        else
          EXPECT_GT((a.second - b.second).length(), 1e-3);
      }
  }
}

// Uniform in area: as many samples in each of four parts of a quarter of a disk, and of a cylinder's piece.
TEST(Pieces, SamplesAreUniformInArea) {
  for (const Geometry& geometry : surfaces()) {
    if (std::holds_alternative<Sphere>(geometry)) continue;
    const Patch patch = piece_patch(geometry, 1, front);
    std::array<int, 4> count{};
    constexpr int samples = 16384;
    for (std::uint32_t k = 0; k < samples; ++k) {
      const ElementPoint point = patch.sample(Sampler(2, k, 0).next_2d());
      const PieceLocation at = locate_piece(geometry, V3f(point.position));
      ++count[at.u > 0.5f ? 1 : at.v > 0.5f ? 2 : at.u + at.v < 0.5f ? 0 : 3];
    }
    for (const int c : count) EXPECT_NEAR(c, samples / 4, 5 * std::sqrt(samples * 3.0 / 16.0));
  }
}

TEST(Pieces, ElementsAreFoundFromWhatRaysMeet) {
  SceneDescription description;
  description.materials = {two_sided("both", Diffuse{C3f(0.8f)}, Diffuse{C3f(0.2f)})};
  for (const Geometry& geometry : surfaces())
    description.shapes.push_back({"it", geometry, 0, {C3f(0.0f), C3f(0.0f)}});
  for (const Shape& shape : description.shapes) {
    SceneDescription one;
    one.materials = description.materials;
    one.shapes = {shape};
    const Scene scene(one);
    const ElementMesh mesh = divide_surfaces(scene, 3000);
    ASSERT_GT(mesh.count(), 500u);
    for (std::uint32_t i = 0; i < mesh.count(); ++i) {
      if (mesh.is_cluster(i)) continue;
      const ElementPoint point = mesh.patch(i).centroid();
      const Ray ray{V3f(point.position + point.normal * 0.01), V3f(-point.normal)};
      const Hit hit = scene.caster().intersect(ray);
      ASSERT_FALSE(hit.escaped());
      EXPECT_EQ(mesh.find(scene.surface_point(ray, hit)), i);
    }
  }
}

Disk facing_up(float z, float radius) { return {V3f(0, 0, z), V3f(radius, 0, 0), V3f(0, radius, 0), false}; }
Disk facing_down(float z, float radius) { return {V3f(0, 0, z), V3f(radius, 0, 0), V3f(0, radius, 0), true}; }

// radiosity.md has these with 30 digits: (3 - sqrt 5) / 2 and others.
TEST(Pieces, FormFactorsOfCoaxialDisks) {
  struct Case {
    float r1, r2, h;
    double exact;
  };
  for (const Case& c : {Case{1, 1, 1, 0.38196601125010515}, Case{1, 2, 1, 0.76393202250021031},
                        Case{1, 0.5f, 2, 0.048058983988962156}}) {
    SceneDescription description;
    test::add_diffuse(description, "below", facing_up(0, c.r1), C3f(0.5f));
    test::add_diffuse(description, "above", facing_down(c.h, c.r2), C3f(0.5f));
    test::add_diffuse(description, "away", facing_up(2 * c.h, c.r2), C3f(0.5f));
    const FormFactorTable table = form_factor_table(Scene(std::move(description)), {.rays = 1 << 14});
    EXPECT_NEAR(table.F[0][1], c.exact, 1e-7);
    EXPECT_NEAR(table.F[1][0], c.exact * c.r1 * c.r1 / (c.r2 * c.r2), 1e-7);
    EXPECT_EQ(table.F[0][0], 0.0);
    EXPECT_EQ(table.F[0][2], 0.0);
    EXPECT_EQ(table.method, FormFactorMethod::rays);
  }
}

// A can: two disks and the inside of a cylinder. All factors are known by closure, and only those between the
// ends and the wall are counted by rays.
SceneDescription can(const C3f& reflectance, float radiance) {
  SceneDescription description;
  test::add_diffuse(description, "bottom", facing_up(0, 1), reflectance, C3f(radiance));
  test::add_diffuse(description, "wall",
                    Cylinder{V3f(0.0f), 1.0f, 2.0f, true, {V3f(1, 0, 0), V3f(0, 1, 0), V3f(0, 0, 1)}},
                    reflectance, C3f(radiance));
  test::add_diffuse(description, "top", facing_down(2, 1), reflectance, C3f(radiance));
  return description;
}

TEST(Pieces, FormFactorsOfACan) {
  const FormFactorTable table = form_factor_table(Scene(can(C3f(0.5f), 0.0f)), {.rays = 1 << 18});
  const double own = 2.0 - std::sqrt(2.0), ends = 3.0 - 2.0 * std::sqrt(2.0);
  EXPECT_TRUE(table.closed);
  EXPECT_LT(table.closure_error, 1e-10);
  EXPECT_LT(table.closure_error_before, 5e-3);
  EXPECT_NEAR(table.F[1][1], own, 2e-3);
  EXPECT_NEAR(table.F[0][2], ends, 2e-3);
  EXPECT_NEAR(table.F[0][1], 1.0 - ends, 2e-3);
  EXPECT_NEAR(table.F[1][0], (1.0 - own) / 2.0, 2e-3);
}

// In a can of uniform exitance E and albedo rho everything receives E / (1 - rho), by every solver.
TEST(Pieces, FurnaceInACan) {
  const Scene scene(can(C3f(0.5f), 0.5f / pi_f));
  for (const Solver solver : {Solver::cg, Solver::hierarchical, Solver::stochastic}) {
    RadiosityOptions options;
    options.solver = solver;
    options.max_elements = 800;
    options.relative_error = 0.02;
    const Solution solution = solve_radiosity(scene, options);
    double sum = 0.0, area = 0.0;
    for (std::uint32_t i = 0; i < solution.mesh().count(); ++i) {
      EXPECT_NEAR(solution.irradiances()[i].total().x, 1.0f, 0.5f);
      sum += solution.mesh().area(i) * solution.irradiances()[i].total().x;
      area += solution.mesh().area(i);
    }
    EXPECT_NEAR(area, 6.0 * pi, 0.01);
    EXPECT_NEAR(sum / area, 1.0, 0.01);
  }
}

// The irradiance of a disk from a lamp that is one, through the elements: A_1 F_12 = A_2 F_21.
TEST(Pieces, DiskLampLightsADisk) {
  SceneDescription description;
  test::add_diffuse(description, "lamp", facing_down(1, 1), C3f(0.0f), C3f(1.0f / pi_f));
  test::add_diffuse(description, "table", facing_up(0, 1), C3f(0.5f));
  const Scene scene(std::move(description));
  RadiosityOptions options;
  options.max_elements = 1000;
  const Solution solution = solve_radiosity(scene, options);
  double power = 0.0;
  for (std::uint32_t i = 0; i < solution.mesh().count(); ++i)
    power += solution.mesh().area(i) * solution.irradiances()[i].total().x;
  EXPECT_NEAR(power / pi, 0.38196601125010515, 4e-3);
}

}  // namespace
}  // namespace twopass
