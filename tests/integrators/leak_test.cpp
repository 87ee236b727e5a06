// Closed rooms are dark inside, however bright it is outside: no ray slips through between two triangles.
#include <array>
#include <random>

#include <gtest/gtest.h>

#include "integrators/make_integrator.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

// A ball of 20 * 4^levels triangles seen from inside; its triangles share their corners.
Mesh ball_of_triangles(int levels) {
  const float g = 1.618034f;
  std::vector<V3f> p = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                        {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  std::vector<V3u> t = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                        {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                        {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (V3f& corner : p) corner.normalize();
  for (int level = 0; level < levels; ++level) {
    std::vector<V3u> finer;
    std::vector<std::array<std::uint32_t, 3>> known;  // (smaller corner, larger corner, corner between)
    const auto between = [&](std::uint32_t a, std::uint32_t b) {
      for (const auto& edge : known)
        if (edge[0] == std::min(a, b) && edge[1] == std::max(a, b)) return edge[2];
      p.push_back((p[a] + p[b]).normalized());
      known.push_back({std::min(a, b), std::max(a, b), static_cast<std::uint32_t>(p.size() - 1)});
      return known.back()[2];
    };
    for (const V3u& c : t) {
      const std::uint32_t ab = between(c.x, c.y), bc = between(c.y, c.z), ca = between(c.z, c.x);
      finer.insert(finer.end(), {V3u(c.x, ab, ca), V3u(c.y, bc, ab), V3u(c.z, ca, bc), V3u(ab, bc, ca)});
    }
    t = finer;
  }
  // Off the origin and turned inside out.
  Mesh mesh;
  for (const V3f& corner : p) mesh.positions.push_back(corner * 0.7f + V3f(0.5f, 0.4f, 0.3f));
  for (const V3u& c : t) mesh.triangles.emplace_back(c.x, c.z, c.y);
  return mesh;
}

SceneDescription closed_room(bool ball) {
  SceneDescription scene;
  if (ball)
    test::add_diffuse(scene, "ball", ball_of_triangles(3), C3f(0.95f));
  else
    scene = test::unit_room(C3f(0.95f), C3f(0.0f), C3f(0.95f));
  scene.environment = Environment(C3f(1e6f));
  return scene;
}

class LeakTest : public testing::TestWithParam<bool> {
 protected:
  LeakTest() : scene_(closed_room(GetParam())) {}

  float random() { return static_cast<float>(generator_() >> 8) * 0x1p-24f; }
  V3f inside() { return V3f(0.3f) + V3f(random(), random(), random()) * 0.4f; }
  // A point of an edge, or one of the corners.
  V3f on_edge(bool corner) {
    const Shape& shape = scene_.shapes()[generator_() % scene_.shapes().size()];
    const Mesh& mesh = std::get<Mesh>(shape.geometry);
    const auto p = corners(mesh, static_cast<std::uint32_t>(generator_() % mesh.triangles.size()));
    const std::size_t i = generator_() % 3;
    return corner ? p[i] : p[i] + (p[(i + 1) % 3] - p[i]) * random();
  }
  // How many of the rays that `next_ray` makes leave the room.
  template <class NextRay>
  std::size_t escapes(std::size_t rays, Rays kind, const NextRay& next_ray) {
    std::vector<Ray> bundle(bundle_size);
    std::vector<Hit> hits(bundle_size);
    std::size_t count = 0;
    for (std::size_t i = 0; i < rays; i += bundle_size) {
      for (Ray& ray : bundle) ray = next_ray();
      scene_.caster().intersect(bundle, hits, kind);
      for (const Hit& hit : hits) count += hit.escaped();
    }
    return count;
  }

  // Of 250000 rays. Embree's robust mode is tight along edges; where many triangles share a corner, a ray
  // through it within a rounding error can miss them all (measured: 1 in 4000 so aimed).
  static std::size_t leaks_allowed(bool corner) { return corner ? 250 : 2; }

  Scene scene_;
  std::mt19937 generator_{3};
};

TEST_P(LeakTest, NoRayLeavesARoom) {
  for (const Rays kind : {Rays::coherent, Rays::scattered}) {
    const auto anywhere = [&] {
      const float z = 2.0f * random() - 1.0f, phi = 2 * pi_f * random(), r = std::sqrt(1.0f - z * z);
      return Ray{inside(), V3f(r * std::cos(phi), r * std::sin(phi), z)};
    };
    EXPECT_EQ(escapes(250000, kind, anywhere), 0u);
    for (const bool corner : {false, true}) {
      const auto at_edge = [&] {
        const V3f origin = inside();
        return Ray{origin, (on_edge(corner) - origin).normalized()};
      };
      EXPECT_LE(escapes(250000, kind, at_edge), leaks_allowed(corner)) << "at corners: " << corner;
    }
  }
}

// Shadow rays from inside, aimed through edges and corners at what is far outside.
TEST_P(LeakTest, NoShadowRayLeavesARoom) {
  std::vector<Segment> segments(bundle_size);
  const auto blocked = std::make_unique<bool[]>(bundle_size);
  for (const bool corner : {false, true}) {
    std::size_t leaks = 0;
    for (std::size_t i = 0; i < 250000; i += bundle_size) {
      for (Segment& segment : segments) {
        const V3f origin = inside();
        segment = {origin, origin + (on_edge(corner) - origin) * 50.0f};
      }
      scene_.caster().occluded(segments, {blocked.get(), bundle_size});
      for (std::size_t k = 0; k < bundle_size; ++k) leaks += !blocked[k];
    }
    EXPECT_LE(leaks, leaks_allowed(corner)) << "at corners: " << corner;
  }
}

// Paths sample the sky at each vertex. A vertex within rounding errors of an edge may lie behind the
// neighbouring wall (of paths aimed exactly at an edge of the cube 1 in 11 gets out), so that near edges a path
// in a thousand is forgiven; elsewhere none.
TEST_P(LeakTest, PathsSeeNothing) {
  const auto path = make_integrator(IntegratorKind::path, scene_, nullptr, {20, 20, false});
  for (const bool at_edge : {false, true}) {
    std::size_t lit = 0;
    RayCounts counts;
    for (std::uint32_t i = 0; i < 10000; ++i) {
      Sampler sampler(1, i, 0);
      const V3f origin = inside(), anywhere = inside();
      const V3f target = at_edge ? on_edge(false) + (anywhere - V3f(0.5f)) * (2e-4f * random()) : anywhere;
      const V3f direction = target - origin;
      if (!(direction.length() > 0.0f)) continue;
      lit += !is_black(path->radiance({origin, direction.normalized()}, sampler, counts).radiance);
    }
    EXPECT_LE(lit, at_edge ? 10u : 0u)
        << "of " << counts.rays << " rays, " << counts.shadow_rays << " shadow rays";
  }
}

INSTANTIATE_TEST_SUITE_P(Rooms, LeakTest, testing::Bool(), [](const testing::TestParamInfo<bool>& model) {
  return model.param ? "ball" : "cube";
});

}  // namespace
}  // namespace twopass
