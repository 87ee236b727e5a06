#include "radiosity/form_factor_table.h"

#include <gtest/gtest.h>

#include "render/core/error.h"
#include "tests/radiosity/test_scenes.h"

namespace twopass {
namespace {

constexpr double parallel = 0.19982489569838738, perpendicular = 0.20004377607540315;

FormFactorTable table_of(SceneDescription scene, const FormFactorOptions& options = {}) {
  return form_factor_table(Scene(std::move(scene)), options);
}

void expect_reciprocal(const FormFactorTable& table, double tolerance) {
  for (std::size_t i = 0; i < table.F.size(); ++i)
    for (std::size_t j = 0; j < table.F.size(); ++j)
      EXPECT_NEAR(table.areas[i] * table.F[i][j], table.areas[j] * table.F[j][i], tolerance);
}

TEST(FormFactorTable, OfTheUnitCube) {
  const FormFactorTable table = table_of(test::lit_cube(0.5f));
  EXPECT_EQ(table.method, FormFactorMethod::exact);
  EXPECT_EQ(table.names[0], "floor");
  EXPECT_LT(table.closure_error, 1e-9);
  expect_reciprocal(table, 1e-12);
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j) {
      const bool opposite = i / 2 == j / 2;
      EXPECT_NEAR(table.F[i][j], i == j ? 0.0 : opposite ? parallel : perpendicular, 1e-9);
    }
}

TEST(FormFactorTable, ByEveryMethod) {
  const FormFactorTable point = table_of(test::lit_cube(0.5f), {.method = FormFactorMethod::point});
  EXPECT_NEAR(point.F[0][1], parallel, 0.03);  // a few points close to large triangles
  expect_reciprocal(point, 1e-12);
  const FormFactorTable rays =
      table_of(test::lit_cube(0.5f), {.method = FormFactorMethod::rays, .rays = 1 << 16});
  // Five standard deviations of the two pooled counts.
  EXPECT_NEAR(rays.F[0][1], parallel, 5.0 * std::sqrt(parallel / (2 << 16)));
  EXPECT_LT(rays.closure_error, 1e-5);
  expect_reciprocal(rays, 1e-6);
}

TEST(FormFactorTable, OfARegularTetrahedron) {
  const V3f a(1, 1, 1), b(-1, -1, 1), c(-1, 1, -1), d(1, -1, -1);
  SceneDescription scene;
  for (const auto& [p, q, r] :
       {std::array{a, b, c}, std::array{a, d, b}, std::array{a, c, d}, std::array{b, d, c}}) {
    Mesh face;
    face.positions = {p, r, q};  // seen from inside
    face.triangles = {{0, 1, 2}};
    const V3f inward = -(p + q + r), normal = (r - p).cross(q - p);
    if (normal.dot(inward) < 0.0f) face.triangles = {{0, 2, 1}};
    test::add_diffuse(scene, "face", face, C3f(0.5f));
  }
  const FormFactorTable table = table_of(std::move(scene));
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j) EXPECT_NEAR(table.F[i][j], i == j ? 0.0 : 1.0 / 3.0, 1e-10);
}

TEST(FormFactorTable, AConcaveShapeSeesItself) {
  // Floor and one wall as one shape: two unit squares that share an edge.
  SceneDescription scene;
  Mesh corner = test::quad(V3f(0.0f), V3f(1, 0, 0), V3f(0, 1, 0));
  const Mesh wall = test::quad(V3f(0.0f), V3f(0, 1, 0), V3f(0, 0, 1));
  for (const V3f& p : wall.positions) corner.positions.push_back(p);
  corner.triangles.emplace_back(4, 5, 6);
  corner.triangles.emplace_back(4, 6, 7);
  test::add_diffuse(scene, "corner", corner, C3f(0.5f));
  const FormFactorTable table = table_of(std::move(scene));
  EXPECT_NEAR(table.areas[0], 2.0, 1e-12);
  EXPECT_NEAR(table.F[0][0], perpendicular, 1e-9);
}

// The screen hides exactly half of what two plates exchange, by symmetry.
TEST(FormFactorTable, HiddenPartsAreSubtracted) {
  SceneDescription scene = test::plates(1.0f, 0.5f);
  test::add_diffuse(scene, "screen", test::quad(V3f(-9, -9, 0.5f), V3f(9.5f, 0, 0), V3f(0, 19, 0)), C3f(0.0f));
  EXPECT_NEAR(table_of(scene).F[0][1], 0.5 * parallel, 5e-4);
  EXPECT_NEAR(table_of(scene, {.method = FormFactorMethod::rays, .rays = 1 << 16}).F[0][1], 0.5 * parallel,
              3e-3);
  EXPECT_NEAR(table_of(scene, {.occlusion = false}).F[0][1], parallel, 1e-9);
}

TEST(FormFactorTable, OfConcentricSpheres) {
  const FormFactorTable table = table_of(test::concentric_spheres(0.5f));
  EXPECT_EQ(table.method, FormFactorMethod::rays);
  EXPECT_NEAR(table.F[0][1], 1.0, 1e-5);
  EXPECT_NEAR(table.F[1][0], 0.25, 1e-3);
  EXPECT_NEAR(table.F[1][1], 0.75, 1e-3);
}

TEST(FormFactorTable, SaysWhatItCannotDo) {
  EXPECT_THROW(table_of(test::concentric_spheres(0.5f), {.method = FormFactorMethod::exact}), Error);
  EXPECT_THROW(table_of(test::lit_cube(0.5f), {.method = FormFactorMethod::rays, .occlusion = false}), Error);
  EXPECT_THROW(table_of(test::lit_cube(0.5f), {.method = FormFactorMethod::hemicube}), Error);
  EXPECT_TRUE(table_of({}).F.empty());
}

}  // namespace
}  // namespace twopass
