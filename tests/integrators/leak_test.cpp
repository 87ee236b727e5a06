// Closed rooms are dark inside, however bright it is outside: no ray slips through between two triangles.
#include <array>
#include <random>

#include <gtest/gtest.h>

#include "integrators/path.h"
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

// A prism from y = 0 to 1 over a triangle in xz, seen from inside. `apex`: its third corner, above (0, 0) and
// (1, 0).
Mesh prism(const V2f& apex) {
  Mesh mesh;
  for (const float y : {0.0f, 1.0f})
    for (const V2f& q : {V2f(0, 0), V2f(1, 0), apex}) mesh.positions.emplace_back(q.x, y, q.y);
  mesh.triangles = {{0, 1, 2}, {3, 5, 4}, {0, 3, 4}, {0, 4, 1}, {1, 4, 5}, {1, 5, 2}, {2, 5, 3}, {2, 3, 0}};
  for (V3u& c : mesh.triangles) std::swap(c.y, c.z);
  return mesh;
}

struct Room {
  const char* name;
  Mesh mesh;      // none: the unit cube of six quads
  V3f low, high;  // a box inside of it
};

const Room rooms[] = {{"cube", {}, V3f(0.3f), V3f(0.7f)},
                      {"ball", ball_of_triangles(3), V3f(0.3f), V3f(0.7f)},
                      {"wedge60", prism(V2f(0.5f, 0.866f)), V3f(0.4f, 0.3f, 0.2f), V3f(0.6f, 0.7f, 0.4f)},
                      {"wedge20", prism(V2f(1.0f, 0.364f)), V3f(0.6f, 0.3f, 0.05f), V3f(0.9f, 0.7f, 0.15f)}};

SceneDescription closed_room(const Room& room) {
  SceneDescription scene;
  if (room.mesh.triangles.empty())
    scene = test::unit_room(C3f(0.95f), C3f(0.0f), C3f(0.95f));
  else
    test::add_diffuse(scene, room.name, room.mesh, C3f(0.95f));
  scene.environment = Environment(C3f(1e6f));
  return scene;
}

class LeakTest : public testing::TestWithParam<Room> {
 protected:
  LeakTest() : scene_(closed_room(GetParam())) {}

  float random() { return static_cast<float>(generator_() >> 8) * 0x1p-24f; }
  V3f inside() {
    return GetParam().low + V3f(random(), random(), random()) * (GetParam().high - GetParam().low);
  }
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

// Paths sample the sky at each vertex. A vertex within rounding errors of an edge must not lie behind the
// neighbouring wall.
TEST_P(LeakTest, PathsSeeNothing) {
  const PathTracer path(scene_, {.max_depth = 20, .rr_depth = 20});
  for (const float from_edge : {0.0f, 1e-6f, 1e-4f, 1.0f}) {
    std::size_t lit = 0;
    RayCounts counts;
    for (std::uint32_t i = 0; i < 10000; ++i) {
      Sampler sampler(1, i, 0);
      const V3f origin = inside(), anywhere = inside();
      const V3f on = on_edge(false), target = on + (anywhere - on) * (from_edge * random());
      const V3f direction = target - origin;
      if (!(direction.length() > 0.0f)) continue;
      lit += !is_black(path.radiance({origin, direction.normalized()}, sampler, counts).radiance);
    }
    EXPECT_LE(lit, 0u) << from_edge << ": " << counts.rays << " rays, " << counts.escaped_rays << " escaped, "
                       << counts.shadow_rays << " shadow rays";
  }
}

INSTANTIATE_TEST_SUITE_P(Rooms, LeakTest, testing::ValuesIn(rooms),
                         [](const testing::TestParamInfo<Room>& room) { return room.param.name; });

}  // namespace
}  // namespace twopass
