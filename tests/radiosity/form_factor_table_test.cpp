#include "radiosity/form_factor_table.h"

#include <gtest/gtest.h>

#include "render/core/error.h"
#include "render/core/parallel.h"
#include "tests/radiosity/polygon_samples.h"
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

constexpr FormFactorMethod methods[] = {FormFactorMethod::exact, FormFactorMethod::point,
                                        FormFactorMethod::hemicube, FormFactorMethod::rays};

TEST(FormFactorTable, ByEveryMethod) {
  for (const FormFactorMethod method : methods) {
    const FormFactorTable table = table_of(test::lit_cube(0.5f), {.method = method, .rays = 4096});
    // A few points close to large triangles tell little.
    const bool crude = method == FormFactorMethod::point || method == FormFactorMethod::hemicube;
    EXPECT_NEAR(table.F[0][1], parallel, crude ? 0.03 : 1e-9);
    EXPECT_NEAR(table.F[2][5], perpendicular, crude ? 0.03 : 1e-9);
    EXPECT_EQ(table.method, method);
    EXPECT_TRUE(table.closed);
    EXPECT_LT(table.closure_error, 1e-10);
    if (!crude) {
      EXPECT_LT(table.closure_error_before, 1e-9);
    }
    expect_reciprocal(table, 1e-12);
  }
}

// Where the surfaces are small against their distance the classical estimates are good.
TEST(FormFactorTable, EstimatesFromCentroidsConvergeWithTheDistance) {
  const double truth = 0.0031620568387576016;
  for (const FormFactorMethod method : {FormFactorMethod::point, FormFactorMethod::hemicube}) {
    const FormFactorTable table =
        table_of(test::plates(10.0f, 0.5f), {.method = method, .hemicube_resolution = 256});
    EXPECT_NEAR(table.F[0][1] / truth, 1.0, method == FormFactorMethod::point ? 3e-3 : 5e-2);
    EXPECT_FALSE(table.closed);
  }
}

// A shape of the closed forms' list, in coordinates that floats hold exactly.
struct ClosedForm {
  Mesh from, to;
  double F;
};

TEST(FormFactorTable, ClosedForms) {
  const V3f x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), o(0.0f);
  const Mesh ground = test::quad(o, x, y), wall = test::quad(o, y, z);
  const auto above = [&](float size, float height, float offset = 0.0f) {
    return test::quad(V3f(offset, 0, height), y * size, x * size);
  };
  const ClosedForm cases[] = {
      {test::quad(o, x * 100.0f, y * 100.0f), above(100, 1), 0.98041660292597327},
      {test::quad(o, x * 10.0f, y * 10.0f), above(10, 1), 0.82699452239725658},
      {ground, above(1, 0.5f), 0.41525328357714674},
      {ground, above(1, 1), parallel},
      {ground, above(1, 2), 0.068589588818552448},
      {ground, above(1, 5), 0.012403977313245102},
      {ground, above(1, 10), 0.0031620568387576016},
      {ground, above(1, 100), 3.1828866732829196e-05},
      {ground, above(1, 1, 1), 0.086050489152327335},
      {ground, wall, perpendicular},
      {test::quad(x, x, y), wall, 0.032808826719958734},
      {ground, test::quad(y, y, z), 0.040592230101558543},
  };
  for (const ClosedForm& c : cases)
    for (const FormFactorMethod method : {FormFactorMethod::exact, FormFactorMethod::rays}) {
      SceneDescription scene;
      test::add_diffuse(scene, "from", c.from, C3f(0.5f));
      test::add_diffuse(scene, "to", c.to, C3f(0.5f));
      const FormFactorTable table = table_of(std::move(scene), {.method = method, .rays = 64});
      EXPECT_NEAR(table.F[0][1] / c.F, 1.0, 1e-9);
      EXPECT_NEAR(table.F[1][0] / c.F, 1.0, 1e-9);
      EXPECT_EQ(table.F[0][0], 0.0);
    }
}

SceneDescription room_with_a_box() {
  SceneDescription scene = test::lit_cube(0.5f);
  test::add_standing_box(scene, V3f(0.2f, 0.55f, 0.0f), V3f(0.45f, 0.8f, 0.6f), 0.5f);
  return scene;
}

SceneDescription transformed(SceneDescription scene, const V3f& offset, float scale) {
  for (Shape& shape : scene.shapes)
    for (V3f& p : std::get<Mesh>(shape.geometry).positions) p = p * scale + offset;
  return scene;
}

// Powers of two and whole numbers leave the coordinates' digits alone: the same bits come out, by every method.
TEST(FormFactorTable, NeitherTheUnitNorTheOriginMatters) {
  const SceneDescription room = room_with_a_box();
  for (const FormFactorMethod method : methods) {
    const FormFactorOptions options{.method = method, .rays = 256, .hemicube_resolution = 16};
    const FormFactorTable original = table_of(room, options);
    for (const float scale : {0x1p-20f, 0x1p20f}) {
      const FormFactorTable scaled = table_of(transformed(room, V3f(0, 0, 0), scale), options);
      EXPECT_EQ(scaled.F, original.F);
      EXPECT_EQ(scaled.areas[0], original.areas[0] * double(scale) * double(scale));
    }
    // A room of 10 bits: moved by about ten thousand of its sizes, floats still hold it.
    const auto snapped = [&](const V3f& offset) {
      SceneDescription coarse = room;
      for (Shape& shape : coarse.shapes)
        for (V3f& p : std::get<Mesh>(shape.geometry).positions)
          for (int axis = 0; axis < 3; ++axis)
            p[axis] = std::round(p[axis] * 0x1p10f) * 0x1p-10f + offset[axis];
      return coarse;
    };
    EXPECT_EQ(table_of(snapped(V3f(8192, 4096, 16000)), options).F, table_of(snapped(V3f(0.0f)), options).F);
  }
}

TEST(FormFactorTable, AtAnyScaleAndTenThousandSizesAway) {
  const SceneDescription room = test::lit_cube(0.5f);
  for (const FormFactorMethod method : {FormFactorMethod::exact, FormFactorMethod::rays}) {
    const FormFactorOptions options{.method = method, .rays = 1024};
    for (const auto& [offset, scale] :
         {std::pair{0.0f, 1e-6f}, {0.0f, 1e6f}, {0.0f, 1e-12f}, {10000.0f, 1.0f}, {-3e-2f, 3e-6f}}) {
      const FormFactorTable table =
          table_of(transformed(room, V3f(offset, 2 * offset, offset), scale), options);
      // The far one has the digits of its coordinates: sizes are rounded to 1e-3 of themselves.
      EXPECT_NEAR(table.F[0][1], parallel, offset < 0.0f ? 3e-3 : 1e-6) << offset << " " << scale;
      EXPECT_TRUE(table.closed);
      EXPECT_LT(table.closure_error, 1e-6);
    }
  }
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
  EXPECT_NEAR(table_of(scene).F[0][1], 0.5 * parallel, 3e-5);
  EXPECT_NEAR(table_of(scene, {.method = FormFactorMethod::rays, .rays = 1 << 16}).F[0][1], 0.5 * parallel,
              3e-3);
  EXPECT_NEAR(table_of(scene, {.occlusion = false}).F[0][1], parallel, 1e-9);
}

// A cube of a third of the size inside another: what leaves it arrives outside, and the rest is subtraction.
TEST(FormFactorTable, OfACubeInACube) {
  SceneDescription scene = test::lit_cube(0.5f);
  for (Shape& shape : scene.shapes)
    for (V3f& p : std::get<Mesh>(shape.geometry).positions) p = p * 3.0f - V3f(1.0f);
  test::add_box(scene, "inner", V3f(0.0f), V3f(1.0f), one_sided("grey", Diffuse{C3f(0.5f)}));
  for (const FormFactorMethod method : methods) {
    const FormFactorTable table = table_of(scene, {.method = method, .rays = 1 << 14});
    const bool crude = method == FormFactorMethod::point || method == FormFactorMethod::hemicube;
    ASSERT_TRUE(table.closed);
    EXPECT_LT(table.closure_error, 1e-10);
    EXPECT_LT(table.closure_error_before, method == FormFactorMethod::exact  ? 3e-4
                                          : method == FormFactorMethod::rays ? 2e-2
                                                                             : 0.2);
    EXPECT_EQ(table.F[6][6], 0.0);
    for (std::size_t face = 0; face < 6; ++face) {
      EXPECT_NEAR(table.F[6][face], 1.0 / 6.0, crude ? 1e-2 : 1e-3);
      EXPECT_NEAR(table.F[face][6], 1.0 / 9.0, crude ? 7e-3 : 1e-3);
    }
    expect_reciprocal(table, 1e-12);
  }
}

// The rows of the walls see only fronts, the boxes and the lamp hide parts of everything, and nothing is
// scaled: the lamp's back and the floor under the boxes leave the scene open.
TEST(FormFactorTable, RowsOfAFurnishedRoomAddUp) {
  const FormFactorTable table = table_of(test::lit_room());
  EXPECT_EQ(table.method, FormFactorMethod::exact);
  EXPECT_FALSE(table.closed);
  for (const std::size_t shape : {6u, 7u, 10u, 11u, 15u, 16u}) {  // the boxes' sides and the lamp
    double sum = 0.0;
    for (const double f : table.F[shape]) sum += f;
    EXPECT_NEAR(sum, 1.0, 1e-3) << table.names[shape];
    EXPECT_LE(sum, 1.0 + 1e-12);
  }
}

// With the counts as a control only what is partly hidden has noise, and less than plain counts have.
TEST(FormFactorTable, RaysHaveNoBiasAndLittleNoise) {
  SceneDescription description = test::plates(1.0f, 0.5f);
  test::add_diffuse(description, "screen", test::quad(V3f(-9, -9, 0.5f), V3f(9.5f, 0, 0), V3f(0, 19, 0)),
                    C3f(0.0f));
  const Scene scene(std::move(description));
  struct Moments {
    double bias, deviation;
  };
  const auto moments = [&](std::uint32_t rays) {
    constexpr std::uint32_t runs = 400;
    double sum = 0.0, squares = 0.0;
    for (std::uint32_t seed = 0; seed < runs; ++seed) {
      const double f =
          form_factor_table(scene, {.method = FormFactorMethod::rays, .rays = rays, .seed = seed}).F[0][1];
      sum += f;
      squares += f * f;
    }
    const double mean = sum / runs;
    return Moments{mean - 0.5 * parallel, std::sqrt(squares / runs - mean * mean)};
  };
  const Moments few = moments(4), many = moments(64);
  // Nothing met: believed to be visible. With 4 rays from each side this happens to 0.8^8 of the estimates.
  EXPECT_GT(few.bias, 3e-3);
  EXPECT_LT(few.bias, 3e-2);
  EXPECT_LT(std::abs(many.bias), 5.0 * many.deviation / 20.0);
  // Bernoulli: of 128 rays 0.2 count, each 0 or 1; plain counts vary by sqrt(0.1 / 128).
  EXPECT_LT(many.deviation, 1.05 * parallel * 0.5 / std::sqrt(128 * parallel));
}

// A few rays for the factors do not decide whether a room with a small window is closed.
TEST(FormFactorTable, SmallOpeningsAreNoticed) {
  SceneDescription scene = test::lit_cube(0.5f);
  for (V3f& p : std::get<Mesh>(scene.shapes[1].geometry).positions) p.y *= 0.99f;
  for (const FormFactorMethod method : methods) {
    const FormFactorTable table = table_of(scene, {.method = method, .rays = 2, .hemicube_resolution = 16});
    EXPECT_FALSE(table.closed);
    EXPECT_GT(table.closure_error, 1e-4);
  }
}

TEST(FormFactorTable, WithoutOcclusionRaysGoThroughEverything) {
  SceneDescription scene = test::plates(1.0f, 0.5f);
  test::add_diffuse(scene, "screen", test::quad(V3f(-9, -9, 0.5f), V3f(19, 0, 0), V3f(0, 19, 0)), C3f(0.0f));
  for (const FormFactorMethod method : methods) {
    const FormFactorTable open = table_of(scene, {.method = method, .rays = 1024, .occlusion = false});
    const bool crude = method == FormFactorMethod::point || method == FormFactorMethod::hemicube;
    EXPECT_NEAR(open.F[0][1], parallel, crude ? 0.03 : 1e-9);
    EXPECT_NEAR(table_of(scene, {.method = method, .rays = 1024}).F[0][1], 0.0, 1e-12);
  }
}

TEST(FormFactorTable, SpecialCases) {
  const V3f x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), o(0.0f);
  SceneDescription scene;
  test::add_diffuse(scene, "same name", test::quad(o, x, y), C3f(0.5f));
  test::add_diffuse(scene, "same name", test::quad(x, x, y), C3f(0.5f));                  // in one plane
  test::add_diffuse(scene, "away", test::quad(o, x, -z), C3f(0.5f));                      // shows its back
  test::add_diffuse(scene, "sliver", test::quad(V3f(0, 0, 1), y, x * 1e-5f), C3f(0.5f));  // faces down
  Mesh nothing = test::quad(o, x, y);
  nothing.triangles.assign(1, V3u(0, 1, 1));
  test::add_diffuse(scene, "nothing", nothing, C3f(0.5f));
  test::add_diffuse(scene, "piercing", test::quad(V3f(0.5f, 0, -0.5f), y, z), C3f(0.5f));  // through the first
  for (const FormFactorMethod method : methods) {
    const FormFactorTable table = table_of(scene, {.method = method, .rays = 1024});
    EXPECT_EQ(table.names[0], table.names[1]);
    EXPECT_EQ(table.degenerate_triangles, 1u);
    EXPECT_EQ(table.notes.size(), 1u);
    EXPECT_EQ(table.F[0][1], 0.0);
    EXPECT_EQ(table.F[0][2], 0.0);
    EXPECT_EQ(table.F[4], std::vector<double>(6, 0.0));
    EXPECT_FALSE(table.closed);
    expect_reciprocal(table, 1e-12);
    for (const auto& row : table.F) {
      double sum = 0.0;
      for (const double f : row) {
        EXPECT_TRUE(std::isfinite(f));
        EXPECT_GE(f, 0.0);
        sum += f;
      }
      EXPECT_LE(sum, 1.0 + 1e-12);
    }
    if (method != FormFactorMethod::exact) continue;
    // The wall hides the far half of the ground from the sliver, just so.
    const double width[2] = {0.0, double(1e-5f)}, half[2] = {0.0, 0.5}, whole[2] = {0.0, 1.0};
    EXPECT_NEAR(table.F[3][0] * width[1], test::parallel_rectangles(width, whole, half, whole, 1.0),
                1e-4 * width[1]);
    // The half of the ground in front of the wall and half of the wall: half a unit wide, 1 long, half high.
    EXPECT_NEAR(table.F[5][0], test::perpendicular_rectangles(half, whole, whole, half), 1e-9);
  }
}

TEST(FormFactorTable, IsTheSameOnAnyNumberOfThreads) {
  for (const FormFactorMethod method : methods) {
    const auto factors = [&](int threads) {
      const ThreadLimit limit(threads);
      return table_of(room_with_a_box(), {.method = method, .rays = 5000, .hemicube_resolution = 16}).F;
    };
    EXPECT_EQ(factors(1), factors(2));
  }
}

TEST(FormFactorTable, OfConcentricSpheres) {
  const FormFactorTable table = table_of(test::concentric_spheres(0.5f), {.rays = 1 << 16});
  EXPECT_EQ(table.method, FormFactorMethod::rays);
  EXPECT_TRUE(table.closed);
  EXPECT_LT(table.closure_error, 1e-10);
  EXPECT_LT(table.closure_error_before, 1e-2);
  EXPECT_NEAR(table.F[0][1], 1.0, 1e-9);
  EXPECT_NEAR(table.F[1][0], 0.25, 1e-9);
  EXPECT_NEAR(table.F[1][1], 0.75, 1e-9);
}

TEST(FormFactorTable, SaysWhatItCannotDo) {
  EXPECT_THROW(table_of(test::concentric_spheres(0.5f), {.method = FormFactorMethod::exact}), Error);
  EXPECT_THROW(table_of(test::concentric_spheres(0.5f), {.method = FormFactorMethod::hemicube}), Error);
  for (const int resolution : {-2, 0, 7, 8192})
    EXPECT_THROW(table_of(test::lit_cube(0.5f),
                          {.method = FormFactorMethod::hemicube, .hemicube_resolution = resolution}),
                 Error);
  EXPECT_TRUE(table_of({}).F.empty());
}

}  // namespace
}  // namespace twopass
