#include "render/scene/polygon_view.h"

#include <gtest/gtest.h>

#include "render/core/sampler.h"
#include "render/core/warp.h"
#include "tests/support/scenes.h"
#include "tests/support/statistics.h"

namespace twopass {
namespace {

LightPolygon polygon_of(const Mesh& mesh) { return light_polygons(mesh).at(0); }

Mesh triangle(const V3f& a, const V3f& b, const V3f& c) {
  Mesh mesh;
  mesh.positions = {a, b, c};
  mesh.triangles = {V3u(0, 1, 2)};
  return mesh;
}

struct Case {
  const char* name;
  Mesh mesh;
  Receiver receiver;
};

// Above, beside, straddling the horizon, grazing, touching, large, tiny and far, a trapezium and triangles.
std::vector<Case> cases(bool is_diffuse) {
  const V3f o(0.0f), up(0, 0, 1);
  const V3f tilted = V3f(0.6f, 0.0f, 0.8f), sideways(1, 0, 0);
  Mesh trapezium;
  trapezium.positions = {V3f(-1, 1, 1), V3f(1, 1, 1), V3f(0.3f, -1, 1), V3f(-0.5f, -1, 1)};
  trapezium.triangles = {V3u(0, 1, 2), V3u(2, 3, 0)};
  const Mesh above = test::quad(V3f(-0.5f, 0.5f, 1), V3f(1, 0, 0), V3f(0, -1, 0));
  return {
      {"above", above, {o, up, is_diffuse}},
      {"above, tilted", above, {o, tilted, is_diffuse}},
      {"straddling", above, {o, sideways, is_diffuse}},
      {"from behind", above, {V3f(0.1f, 0.2f, 1.7f), V3f(0.6f, 0, -0.8f), is_diffuse}},
      {"beside", test::quad(V3f(1, 0.5f, 1), V3f(1, 0, 0), V3f(0, -1, 0)), {o, up, is_diffuse}},
      {"wall", test::quad(V3f(0.3f, -1, -0.4f), V3f(0, 2, 0), V3f(0, 0, 1)), {o, up, is_diffuse}},
      {"edge on the horizon", test::quad(V3f(0.3f, -1, 0), V3f(0, 2, 0), V3f(0, 0, 1)), {o, up, is_diffuse}},
      {"grazing", test::quad(V3f(-2, -1, 0.1f), V3f(4, 0, 0), V3f(0, 2, 0)), {o, tilted, is_diffuse}},
      {"near its plane", test::quad(V3f(1, -1, 0.01f), V3f(2, 0, 0), V3f(0, 2, 0)), {o, up, is_diffuse}},
      {"zenith on a corner", test::quad(V3f(0, 0, 1), V3f(1, 0, 0), V3f(0, 1, 0)), {o, up, is_diffuse}},
      {"zenith on an edge", test::quad(V3f(-0.5f, 0, 1), V3f(1, 0, 0), V3f(0, 1, 0)), {o, up, is_diffuse}},
      {"far", test::quad(V3f(20, 5, 40), V3f(1, 0, 0), V3f(0, -1, 0)), {o, up, is_diffuse}},
      {"trapezium", trapezium, {V3f(0.2f, 0, 0), up, is_diffuse}},
      {"triangle", triangle(V3f(0, 0, 1), V3f(2, 1, 0.5f), V3f(0, 1, 1)), {o, up, is_diffuse}},
      {"straddling triangle", triangle(V3f(1, 0, 1), V3f(1, 1, -1), V3f(0.5f, 2, 0.5f)), {o, up, is_diffuse}},
      {"sliver", triangle(V3f(1, 0, 1), V3f(1, 1e-4f, 1), V3f(-1, 2, 1)), {o, up, is_diffuse}}};
}

std::vector<PolygonTechnique> techniques_for(const Case& c) {
  std::vector<PolygonTechnique> all{PolygonTechnique::area, PolygonTechnique::solid_angle};
  const LightPolygon polygon = polygon_of(c.mesh);
  if (c.receiver.is_diffuse) all.push_back(PolygonTechnique::projected);
  const bool all_above = [&] {
    for (int i = 0; i < polygon.corners; ++i)
      if (!((polygon.corner[i] - c.receiver.position).dot(c.receiver.normal) > 0.0f)) return false;
    return true;
  }();
  if (polygon.is_parallelogram && (!c.receiver.is_diffuse || all_above))
    all.push_back(PolygonTechnique::bilinear);
  return all;
}

// Lambert's sum over the edges of the part above the horizon, clipped here again: an independent computation of
// the form factor times pi.
double projected_solid_angle(const LightPolygon& polygon, const Receiver& receiver) {
  const V3d n(receiver.normal);
  std::vector<V3d> above;
  for (int i = 0; i < polygon.corners; ++i) {
    const V3d a = V3d(polygon.corner[i]) - V3d(receiver.position);
    const V3d b = V3d(polygon.corner[(i + 1) % polygon.corners]) - V3d(receiver.position);
    const double za = a.dot(n), zb = b.dot(n);
    if (za >= 0.0) above.push_back(a);
    if (za * zb < 0.0) above.push_back(a + (b - a) * (za / (za - zb)));
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < above.size(); ++i) {
    const V3d &a = above[i], &b = above[(i + 1) % above.size()];
    const V3d cross = a.cross(b);
    if (cross.length() > 0.0) sum += n.dot(cross) / cross.length() * std::atan2(cross.length(), a.dot(b));
  }
  return 0.5 * std::abs(sum);
}

double solid_angle(const LightPolygon& polygon, const Receiver& receiver) {
  std::array<V3d, 4> w;
  for (int i = 0; i < polygon.corners; ++i)
    w[i] = (V3d(polygon.corner[i]) - V3d(receiver.position)).normalized();
  double sum = 0.0;
  for (int i = 0; i + 2 < polygon.corners; ++i) sum += spherical_triangle_solid_angle(w[0], w[i + 1], w[i + 2]);
  return sum;
}

// Every technique finds the exact projected solid angle and solid angle, the fitting one without noise.
TEST(PolygonView, EveryTechniqueGivesTheExactIrradiance) {
  for (const bool is_diffuse : {true, false}) {
    for (const Case& c : cases(is_diffuse)) {
      const LightPolygon polygon = polygon_of(c.mesh);
      const double exact =
          is_diffuse ? projected_solid_angle(polygon, c.receiver) : solid_angle(polygon, c.receiver);
      for (const PolygonTechnique technique : techniques_for(c)) {
        const PolygonView view(polygon, c.receiver, technique);
        test::Estimate e;
        for (std::uint32_t i = 0; i < 10000; ++i) {
          const PolygonView::Point p = view.sample(Sampler(3, i, 0).next_2d());
          const float cosine = is_diffuse ? std::max(0.0f, p.direction.dot(c.receiver.normal)) : 1.0f;
          e.add(p.pdf_w > 0.0f ? cosine / p.pdf_w : 0.0);
        }
        const bool is_exact =
            technique == (is_diffuse ? PolygonTechnique::projected : PolygonTechnique::solid_angle);
        const auto what = testing::Message() << c.name << ", technique " << static_cast<int>(technique);
        if (is_exact) {
          EXPECT_NEAR(e.mean(), exact, 1e-5 * exact) << what;
          EXPECT_LT(std::sqrt(e.variance()), 1e-4 * exact) << what;
        } else {
          // 95 such comparisons; Sidak at 1e-4 asks for 4.9 standard errors. Area sampling of what is grazed
          // has heavier tails than the normal distribution.
          EXPECT_NEAR(e.mean(), exact, 6 * e.standard_error() + 1e-5 * exact) << what;
        }
      }
    }
  }
}

// Where the samples land against the density, over a grid on the polygon's bounding square of directions: the
// expected counts come from points that are uniform in area.
TEST(PolygonView, SamplesHaveTheStatedDensity) {
  constexpr int side = 8, samples = 20000, fine = 300;
  std::size_t tests = 0;
  double least_p = 1.0;
  for (const bool is_diffuse : {true, false}) {
    for (const Case& c : cases(is_diffuse)) {
      const LightPolygon polygon = polygon_of(c.mesh);
      for (const PolygonTechnique technique : techniques_for(c)) {
        const PolygonView view(polygon, c.receiver, technique);
        Box3f box;
        for (int i = 0; i < polygon.corners; ++i) box.extendBy(polygon.corner[i]);
        // Wider on one side, so that no outline follows the cells' corners.
        box.max += (box.max - box.min) * 0.13f;
        // Two axes across which the polygon has extent.
        const V3f n(polygon.normal);
        const int drop = std::abs(n.x) > 0.7f ? 0 : std::abs(n.y) > 0.7f ? 1 : 2;
        const int a = drop == 0 ? 1 : 0, b = drop == 2 ? 1 : 2;
        const auto cell = [&](const V3f& p) {
          const auto index = [&](int axis) {
            const float x = (p[axis] - box.min[axis]) / (box.max[axis] - box.min[axis]);
            return std::clamp(static_cast<int>(x * side), 0, side - 1);
          };
          return static_cast<std::size_t>(index(a) * side + index(b));
        };
        std::vector<double> observed(side * side), expected(side * side);
        for (std::uint32_t i = 0; i < samples; ++i) {
          const PolygonView::Point p = view.sample(Sampler(8, i, 0).next_2d());
          if (p.pdf_w > 0.0f) observed[cell(p.position)] += 1.0;
        }
        const Receiver& r = c.receiver;
        const PolygonView uniform(polygon, r, PolygonTechnique::area);
        double total = 0.0;
        for (int i = 0; i < fine * fine; ++i) {
          const V2f u((static_cast<float>(i % fine) + 0.5f) / fine,
                      (static_cast<float>(i / fine) + 0.5f) / fine);
          const PolygonView::Point p = uniform.sample(u);
          const float distance = (p.position - r.position).length();
          const double share = view.pdf_w(p.direction, distance) / p.pdf_w / (fine * fine);
          expected[cell(p.position)] += share * samples;
          total += share;
        }
        EXPECT_NEAR(total, 1.0, 0.02) << c.name << ", technique " << static_cast<int>(technique);
        double drawn = 0.0;
        for (const double o : observed) drawn += o;
        for (double& x : expected) x *= drawn / (total * samples);
        const double p = test::chi2_test(observed, expected);
        ++tests;
        EXPECT_GT(p, 1e-6) << c.name << ", technique " << static_cast<int>(technique);
        least_p = std::min(least_p, p);
      }
    }
  }
  EXPECT_GT(least_p, test::sidak(1e-4, tests));
}

TEST(PolygonView, DensityOfASampleIsThatOfItsDirection) {
  for (const bool is_diffuse : {true, false}) {
    for (const Case& c : cases(is_diffuse)) {
      const LightPolygon polygon = polygon_of(c.mesh);
      for (const PolygonTechnique technique : techniques_for(c)) {
        const PolygonView view(polygon, c.receiver, technique);
        for (std::uint32_t i = 0; i < 200; ++i) {
          const PolygonView::Point p = view.sample(Sampler(3, i, 0).next_2d());
          if (!(p.pdf_w > 0.0f)) continue;
          const float distance = (p.position - c.receiver.position).length();
          // A direction on the horizon has few digits of its cosine.
          const float again = view.pdf_w(p.direction, distance);
          const float cosine = std::abs(p.direction.dot(c.receiver.normal));
          EXPECT_NEAR(again, p.pdf_w, (1e-4f + 1e-6f / (cosine + 1e-6f)) * p.pdf_w)
              << c.name << ", technique " << static_cast<int>(technique);
        }
      }
    }
  }
}

// What the shadow ray needs: the chosen technique's points lie on the polygon in the stated direction.
TEST(PolygonView, PointsLieOnThePolygon) {
  for (const bool is_diffuse : {true, false}) {
    for (const Case& c : cases(is_diffuse)) {
      const LightPolygon polygon = polygon_of(c.mesh);
      const PolygonView view(polygon, c.receiver);
      for (std::uint32_t i = 0; i < 500; ++i) {
        const PolygonView::Point p = view.sample(Sampler(5, i, 0).next_2d());
        for (int k = 0; k < polygon.corners; ++k) {
          const V3d a(polygon.corner[k]), b(polygon.corner[(k + 1) % polygon.corners]);
          EXPECT_GT((b - a).cross(V3d(p.position) - a).dot(polygon.normal), -1e-5 * (b - a).length()) << c.name;
        }
        const V3f to_point = (p.position - c.receiver.position).normalized();
        EXPECT_LT((to_point - p.direction).length(), 1e-5f) << c.name;
      }
    }
  }
}

// Sizes and distances from 1e-6 to 1e6 of each other, and receivers next to the polygon, in its plane, on it:
// finite, and right where there is something to be right about.
TEST(PolygonView, IsFiniteAtEveryScale) {
  for (const bool is_diffuse : {true, false}) {
    for (const float size : {1e-6f, 1e-3f, 1.0f, 1e3f, 1e6f}) {
      for (const float height : {-1e6f, -1.0f, -1e-6f, 0.0f, 1e-7f, 1e-6f, 1e-3f, 1.0f, 1e3f, 1e6f}) {
        const Mesh mesh = test::quad(V3f(-0.3f * size, -0.4f * size, 0), V3f(size, 0, 0), V3f(0, size, 0));
        const LightPolygon polygon = polygon_of(mesh);
        for (const float beside : {0.0f, 0.7f, 1.0f}) {
          const V3f normal = V3f(0.1f, 0.2f, height > 0 ? -1.0f : 1.0f).normalized();
          const Receiver receiver{V3f(beside * size, 0, height), normal, is_diffuse};
          const PolygonView view(polygon, receiver);
          const double exact =
              is_diffuse ? projected_solid_angle(polygon, receiver) : solid_angle(polygon, receiver);
          test::Estimate e;
          for (std::uint32_t i = 0; i < 64; ++i) {
            const PolygonView::Point p = view.sample(Sampler(5, 0, i).next_2d());
            EXPECT_TRUE(is_finite(p.position) && is_finite(p.direction) && std::isfinite(p.pdf_w));
            const float cosine = is_diffuse ? std::max(0.0f, p.direction.dot(normal)) : 1.0f;
            e.add(p.pdf_w > 0.0f ? cosine / p.pdf_w : 0.0);
          }
          EXPECT_TRUE(std::isfinite(e.mean()));
          if (height != 0.0f && (exact > 1e-5 || (exact > 0.0 && beside == 0.0f && std::abs(height) > size))) {
            EXPECT_NEAR(e.mean(), exact, 5 * e.standard_error() + 1e-3 * exact)
                << size << ' ' << height << ' ' << beside;
          }
        }
      }
    }
  }
}

TEST(LightPolygons, TwoTrianglesOfAQuadAreOne) {
  const auto polygons = light_polygons(test::quad(V3f(-0.5f, 0.5f, 1), V3f(1, 0, 0), V3f(0, -1, 0)));
  ASSERT_EQ(polygons.size(), 1u);
  EXPECT_EQ(polygons[0].corners, 4);
  EXPECT_TRUE(polygons[0].is_parallelogram);
  EXPECT_DOUBLE_EQ(polygons[0].area, 1.0);
  EXPECT_EQ(polygons[0].normal, V3d(0, 0, -1));
}

TEST(LightPolygons, RepeatedPositionsJoinTooBentConcaveAndDegenerateOnesDoNot) {
  Mesh mesh = test::quad(V3f(0, 0, 0), V3f(1, 0, 0), V3f(0, 1, 0));
  mesh.positions.push_back(mesh.positions[0]);
  mesh.positions.push_back(mesh.positions[2]);
  mesh.triangles = {V3u(0, 1, 2), V3u(4, 5, 3)};
  EXPECT_EQ(light_polygons(mesh).size(), 1u);
  mesh.positions[3].z = 0.01f;
  EXPECT_EQ(light_polygons(mesh).size(), 2u) << "bent";
  mesh.positions[3] = V3f(0.6f, 0.5f, 0);
  EXPECT_NE(light_polygons(mesh)[0].corners, 4) << "folded over";
  mesh.positions[3] = V3f(0.4f, 0.9f, 0);
  EXPECT_EQ(light_polygons(mesh).size(), 1u);
  mesh.positions[3] = V3f(-1.0f, -0.5f, 0);
  EXPECT_EQ(light_polygons(mesh).size(), 2u) << "not convex";
  mesh.triangles[1] = V3u(4, 5, 5);
  EXPECT_EQ(light_polygons(mesh).size(), 1u) << "degenerate";
}

// Every triangle is in exactly one polygon and no area is lost.
TEST(LightPolygons, CoverTheMesh) {
  Mesh mesh;
  constexpr std::uint32_t n = 7;
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t j = 0; j <= n; ++j)
      mesh.positions.emplace_back(static_cast<float>(i), static_cast<float>(j),
                                  i < 4 ? 0.0f : static_cast<float>(i) - 4.0f);
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = i * (n + 1) + j;
      mesh.triangles.emplace_back(a, a + n + 1, a + 1);
      mesh.triangles.emplace_back(a + 1, a + n + 1, a + n + 2);
    }
  const auto polygons = light_polygons(mesh);
  EXPECT_EQ(polygons.size(), n * n);
  std::vector<int> times(mesh.triangles.size());
  double area = 0.0;
  for (const LightPolygon& p : polygons) {
    for (int i = 0; i + 2 < p.corners; ++i) ++times[p.triangles[static_cast<std::size_t>(i)]];
    area += p.area;
  }
  for (const int t : times) EXPECT_EQ(t, 1);
  EXPECT_NEAR(area, 4 * n + 3 * n * std::sqrt(2.0), 1e-5);
}

}  // namespace
}  // namespace twopass
