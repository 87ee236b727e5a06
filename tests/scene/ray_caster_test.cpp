#include "render/scene/ray_caster.h"

#include <array>
#include <limits>

#include <gtest/gtest.h>

#include "render/core/sampler.h"
#include "render/core/warp.h"
#include "render/scene/lights.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

TEST(RayCaster, FindsTheNearestTriangleWithItsBarycentrics) {
  const SceneDescription scene = test::unit_room(C3f(0.5f), C3f(1.0f), C3f(0.5f));
  const RayCaster caster(scene.shapes);
  const Hit hit = caster.intersect({V3f(0.25f, 0.125f, 0.5f), V3f(0, 0, -1)});
  ASSERT_FALSE(hit.escaped());
  EXPECT_EQ(scene.shapes[hit.shape].name, "floor");
  EXPECT_NEAR(hit.t, 0.5f, 1e-6f);
  // Triangle 0 is (0,0) (1,0) (1,1): x = u + v, y = v.
  EXPECT_EQ(hit.primitive, 0u);
  EXPECT_NEAR(hit.u + hit.v, 0.25f, 1e-6f);
  EXPECT_NEAR(hit.v, 0.125f, 1e-6f);
}

TEST(RayCaster, EmptySceneHitsNothing) {
  const RayCaster caster(std::span<const Shape>{});
  EXPECT_TRUE(caster.intersect({V3f(0.0f), V3f(0, 0, 1)}).escaped());
  EXPECT_FALSE(caster.occluded(V3f(0.0f), V3f(1.0f)));
}

// Embree of Debian 12 aborts the process on such rays.
TEST(RayCaster, RaysThatAreNotFiniteHitNothing) {
  const SceneDescription scene = test::unit_room(C3f(0.5f), C3f(1.0f), C3f(0.5f));
  const RayCaster caster(scene.shapes);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float bad : {nan, infinity_f, -infinity_f, 1e30f}) {
    EXPECT_TRUE(caster.intersect({V3f(0.5f, bad, 0.5f), V3f(0, 0, 1)}).escaped());
    EXPECT_TRUE(caster.intersect({V3f(0.5f), V3f(0, bad, 1)}).escaped());
    EXPECT_TRUE(caster.occluded(V3f(0.5f), V3f(bad, 0, 0)));
    EXPECT_TRUE(caster.occluded(V3f(0.5f, 0, bad), V3f(0.0f)));
  }
}

TEST(RayCaster, OcclusionIsOfTheOpenSegment) {
  const SceneDescription scene = test::unit_room(C3f(0.5f), C3f(1.0f), C3f(0.5f));
  const RayCaster caster(scene.shapes);
  EXPECT_FALSE(caster.occluded(V3f(0.5f, 0.5f, 0.1f), V3f(0.5f, 0.5f, 0.9f)));
  EXPECT_TRUE(caster.occluded(V3f(0.5f, 0.5f, 0.1f), V3f(0.5f, 0.5f, 1.1f)));
}

// Directions from the middle of a closed room, some of them exactly at edges and corners: none may leak.
TEST(RayCaster, ClosedRoomLeaksNothing) {
  const SceneDescription scene = test::unit_room(C3f(0.5f), C3f(1.0f), C3f(0.5f));
  const RayCaster caster(scene.shapes);
  int leaks = 0;
  for (std::uint32_t i = 0; i < 200000; ++i) {
    Sampler sampler(1, i, 0);
    leaks += caster.intersect({V3f(0.5f), square_to_sphere(sampler.next_2d())}).escaped();
  }
  EXPECT_EQ(leaks, 0);
}

TEST(RayCaster, SpheresAreAnalyticInsideAndOut) {
  std::vector<Shape> shapes(1);
  shapes[0].geometry = Sphere{V3f(1, 2, 3), 0.5f, false};
  const RayCaster caster(shapes);
  for (std::uint32_t i = 0; i < 1000; ++i) {
    Sampler sampler(1, i, 0);
    const V3f w = square_to_sphere(sampler.next_2d());
    EXPECT_NEAR(caster.intersect({V3f(1, 2, 3), w}).t, 0.5f, 1e-6f);
    EXPECT_NEAR(caster.intersect({V3f(1, 2, 3) - w * 2.0f, w}).t, 1.5f, 2e-6f);
    EXPECT_TRUE(caster.occluded(V3f(1, 2, 3) - w * 2.0f, V3f(1, 2, 3) + w * 2.0f));
    EXPECT_FALSE(caster.occluded(V3f(1, 2, 3) - w * 0.4f, V3f(1, 2, 3) + w * 0.4f));
  }
}

// A shadow ray to a tiny lamp far away must not be stopped by the lamp itself.
TEST(RayCaster, SegmentsEndBeforeWhatTheyEndOn) {
  SceneDescription scene;
  test::add_diffuse(scene, "lamp", Sphere{V3f(0.0f), 1e-4f, false}, C3f(0.0f), C3f(1.0f));
  test::add_diffuse(scene, "panel", test::quad(V3f(5, 5, 0), V3f(1e-4f, 0, 0), V3f(0, 1e-4f, 0)), C3f(0.0f),
                    C3f(1.0f));
  const RayCaster caster(scene.shapes);
  const Lights lights(scene.shapes);
  int blocked = 0;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    Sampler sampler(4, i, 0);
    V3f p = square_to_sphere(sampler.next_2d()) * 10.0f;
    p.z = std::abs(p.z);
    blocked += caster.occluded(p, lights.sample({p, V3f(0, 0, 1), false}, sampler.next_2d()).position);
  }
  EXPECT_EQ(blocked, 0);
}

// From far away the discriminant of the textbook formula has no digits left.
TEST(RayCaster, SmallSphereFarAwayIsHitWhereItIs) {
  std::vector<Shape> shapes(1);
  shapes[0].geometry = Sphere{V3f(1000.0f, 0, 0), 0.01f, false};
  const RayCaster caster(shapes);
  EXPECT_FALSE(caster.intersect({V3f(0, 0.0099f, 0), V3f(1, 0, 0)}).escaped());
  EXPECT_TRUE(caster.intersect({V3f(0, 0.0101f, 0), V3f(1, 0, 0)}).escaped());
}

// A crowd of triangles and spheres, and rays in all directions among them, some of them not finite.
struct Crowd {
  Crowd() {
    SceneDescription scene = test::unit_room(C3f(0.5f), C3f(1.0f), C3f(0.5f));
    for (std::uint32_t i = 0; i < 60; ++i) {
      Sampler sampler(5, i, 0);
      const auto point = [&] {
        const V2f a = sampler.next_2d();
        return V3f(a.x, a.y, sampler.next_1d());
      };
      if (i % 3 == 0) {
        test::add_diffuse(scene, "ball", Sphere{point(), 0.02f + 0.1f * sampler.next_1d(), false}, C3f(0.5f));
      } else {
        const V3f corner = point();
        test::add_diffuse(scene, "sheet",
                          test::quad(corner, (point() - corner) * 0.3f, (point() - corner) * 0.3f), C3f(0.5f));
      }
    }
    shapes = scene.shapes;
    const float bad[] = {std::numeric_limits<float>::quiet_NaN(), infinity_f, -infinity_f, 1e30f};
    for (std::uint32_t i = 0; i < 40000; ++i) {
      Sampler sampler(6, i, 0);
      const V2f a = sampler.next_2d(), b = sampler.next_2d();
      Ray ray{V3f(a.x, a.y, b.x), square_to_sphere(sampler.next_2d())};
      V3f end = ray.origin + ray.direction * b.y;
      if (i % 7 == 3) ray.origin.y = end.z = bad[i % 4];
      if (i % 11 == 5) ray.direction.x = bad[i % 4];
      rays.push_back(ray);
      segments.push_back({ray.origin, end});
    }
  }
  std::vector<Shape> shapes;
  std::vector<Ray> rays;
  std::vector<Segment> segments;
};

// To the bit, in packets of all fillings: whether rays are cast in packets must not show in any picture.
TEST(RayCaster, PacketsFindWhatSingleRaysFind) {
  const Crowd crowd;
  const RayCaster caster(crowd.shapes);
  for (const Rays kind : {Rays::coherent, Rays::scattered}) {
    std::size_t found = 0, size = 1;
    for (std::size_t first = 0; first < crowd.rays.size(); first += size, size = size % 70 + 1) {
      const auto rays = std::span(crowd.rays).subspan(first, std::min(size, crowd.rays.size() - first));
      std::array<Hit, 70> hits;
      caster.intersect(rays, hits, kind);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const Hit single = caster.intersect(rays[i]);
        ASSERT_EQ(hits[i].shape, single.shape) << first + i;
        ASSERT_EQ(hits[i].primitive, single.primitive) << first + i;
        ASSERT_EQ(hits[i].t, single.t) << first + i;
        ASSERT_EQ(hits[i].u, single.u) << first + i;
        ASSERT_EQ(hits[i].v, single.v) << first + i;
        found += !single.escaped() && std::holds_alternative<Sphere>(crowd.shapes[single.shape].geometry);
      }
    }
    EXPECT_GT(found, 3000u) << "spheres must be hit at all";
  }
}

TEST(RayCaster, PacketsAreOccludedAsSingleSegmentsAre) {
  const Crowd crowd;
  const RayCaster caster(crowd.shapes);
  std::size_t blocked = 0, size = 1;
  for (std::size_t first = 0; first < crowd.segments.size(); first += size, size = size % 70 + 1) {
    const auto segments =
        std::span(crowd.segments).subspan(first, std::min(size, crowd.segments.size() - first));
    std::array<bool, 70> occluded;
    caster.occluded(segments, occluded);
    for (std::size_t i = 0; i < segments.size(); ++i) {
      ASSERT_EQ(occluded[i], caster.occluded(segments[i].from, segments[i].to)) << first + i;
      blocked += occluded[i];
    }
  }
  EXPECT_GT(blocked, crowd.segments.size() / 4);
  EXPECT_LT(blocked, crowd.segments.size() * 3 / 4);
}

}  // namespace
}  // namespace twopass
