// Disks and cylinders: where rays meet them, what is found there, and what they are as lamps.
#include <gtest/gtest.h>

#include "render/core/sampler.h"
#include "render/core/warp.h"
#include "render/scene/parametrization.h"
#include "render/scene/scene.h"
#include "tests/support/scenes.h"
#include "tests/support/statistics.h"

namespace twopass {
namespace {

// Skew in space; the axes of the ellipse are 2 and 1.
Disk skew_disk() {
  const Frame frame(V3f(1, 2, 2) / 3.0f);
  return {V3f(1, -2, 3), frame.s * 2.0f, frame.t, false};
}
Cylinder skew_cylinder(bool inward = false) {
  const Frame frame(V3f(2, -1, 2) / 3.0f);
  return {V3f(3, 1, -1), 0.5f, 2.0f, inward, {frame.s, frame.t, frame.n}};
}

Scene scene_of(const Geometry& geometry, float radiance = 0.0f) {
  SceneDescription description;
  test::add_diffuse(description, "it", geometry, C3f(0.5f), C3f(radiance));
  return Scene(std::move(description));
}

TEST(AnalyticShapes, RaysMeetADiskInsideItsRimAlone) {
  const Disk disk = skew_disk();
  const Scene scene = scene_of(disk);
  int hits = 0;
  for (std::uint32_t i = 0; i < 4000; ++i) {
    Sampler sampler(1, i, 0);
    const V2f at = (sampler.next_2d() - V2f(0.5f, 0.5f)) * 2.4f;
    const float radius = at.length();
    if (std::abs(radius - 1.0f) < 1e-4f) continue;
    const V3f target = disk.center + disk.x * at.x + disk.y * at.y;
    const V3f w = square_to_sphere(sampler.next_2d());
    if (std::abs(w.dot(unit_normal(disk))) < 0.01f) continue;
    const Ray ray{target - w * 5.0f, w};
    const Hit hit = scene.caster().intersect(ray);
    ASSERT_EQ(hit.escaped(), radius > 1.0f) << radius;
    EXPECT_EQ(scene.caster().occluded(ray.origin, target + w), radius <= 1.0f);
    EXPECT_FALSE(scene.caster().occluded(ray.origin, target - w * 1e-4f));
    if (hit.escaped()) continue;
    ++hits;
    EXPECT_NEAR(hit.t, 5.0f, 1e-4f);
    const SurfacePoint point = scene.surface_point(ray, hit);
    EXPECT_LE((point.position - target).length(), 1e-4f);
    EXPECT_EQ(point.side, w.dot(unit_normal(disk)) < 0.0f ? front : back);
    // Off the plane by no more than a new ray starts above it.
    EXPECT_LE(std::abs((V3d(point.position) - V3d(disk.center)).dot(V3d(unit_normal(disk)))), point.offset / 4);
  }
  EXPECT_GT(hits, 1500);
}

TEST(AnalyticShapes, RaysMeetTheWallOfACylinderAndNotItsEnds) {
  const Cylinder cylinder = skew_cylinder();
  const Scene scene = scene_of(cylinder);
  const V3f middle = cylinder.base + cylinder.axes[2] * 1.0f;
  int escaped = 0;
  for (std::uint32_t i = 0; i < 4000; ++i) {
    const V3f w = square_to_sphere(Sampler(2, i, 0).next_2d());
    // From the middle of the axis: the wall is at r / sine, unless the end comes first.
    const float cosine = w.dot(cylinder.axes[2]), sine = std::sqrt(1.0f - cosine * cosine), t = 0.5f / sine;
    if (std::abs(t * std::abs(cosine) - 1.0f) < 1e-4f) continue;
    const Ray ray{middle, w};
    const Hit hit = scene.caster().intersect(ray);
    ASSERT_EQ(hit.escaped(), t * std::abs(cosine) > 1.0f);
    escaped += hit.escaped();
    if (hit.escaped()) continue;
    EXPECT_NEAR(hit.t, t, 1e-5f * t);
    const SurfacePoint point = scene.surface_point(ray, hit);
    EXPECT_EQ(point.side, back);
    EXPECT_NEAR(point.geometric_normal.dot(w), -sine, 1e-5f);
    // From outside, the same point is the nearest, and its front is seen.
    const Ray inwards{middle + w * (t + 3.0f), -w};
    const Hit outside = scene.caster().intersect(inwards);
    EXPECT_NEAR(outside.t, 3.0f, 1e-5f);
    EXPECT_EQ(scene.surface_point(inwards, outside).side, front);
  }
  EXPECT_GT(escaped, 300);
  EXPECT_TRUE(scene.caster().intersect({middle, cylinder.axes[2]}).escaped());  // parallel to the wall
}

// Nothing in the formulas is absolute.
TEST(AnalyticShapes, AreTheSameInAllUnits) {
  for (const float scale : {1.0f, 1e-6f, 1e6f}) {
    Disk disk = skew_disk();
    disk.center *= scale, disk.x *= scale, disk.y *= scale;
    Cylinder cylinder = skew_cylinder();
    cylinder.base *= scale, cylinder.radius *= scale, cylinder.length *= scale;
    SceneDescription description;
    test::add_diffuse(description, "disk", disk, C3f(0.5f));
    test::add_diffuse(description, "cylinder", cylinder, C3f(0.5f));
    const Scene scene(std::move(description));
    int hits[2] = {0, 0}, again = 0;
    for (std::uint32_t i = 0; i < 4000; ++i) {
      Sampler sampler(3, i, 0);
      const V3f from = (square_to_sphere(sampler.next_2d()) * 6.0f + V3f(2, 0, 1)) * scale;
      const V3f to =
          ((i % 2 == 0 ? V3f(1, -2, 3) : V3f(3.7f, 0.7f, -0.3f)) + square_to_sphere(sampler.next_2d()) * 0.7f) *
          scale;
      const Ray ray{from, unit(to - from)};
      const Hit hit = scene.caster().intersect(ray);
      if (hit.escaped()) continue;
      ++hits[hit.shape];
      const SurfacePoint point = scene.surface_point(ray, hit);
      const V3f w = Frame(point.geometric_normal).to_world(square_to_cosine_hemisphere(sampler.next_2d()));
      const Hit next = scene.caster().intersect({spawn_position(point, w), w});
      // A disk is not met again from itself, nor a cylinder from its outside.
      again += next.shape == point.shape && !(point.shape == 1 && point.side == back);
    }
    EXPECT_GT(hits[0], 500);
    EXPECT_GT(hits[1], 500);
    EXPECT_EQ(again, 0) << scale;
  }
}

TEST(AnalyticShapes, SmallOnesFarAwayAreHitWhereTheyAre) {
  const Scene disk = scene_of(Disk{V3f(1000, 0, 0), V3f(0, 0.01f, 0), V3f(0, 0, 0.01f), false});
  EXPECT_FALSE(disk.caster().intersect({V3f(0, 0.0099f, 0), V3f(1, 0, 0)}).escaped());
  EXPECT_TRUE(disk.caster().intersect({V3f(0, 0.0101f, 0), V3f(1, 0, 0)}).escaped());
  const Scene wire =
      scene_of(Cylinder{V3f(1000, 0, -1), 0.01f, 2.0f, false, {V3f(1, 0, 0), V3f(0, 1, 0), V3f(0, 0, 1)}});
  EXPECT_FALSE(wire.caster().intersect({V3f(0, 0.0099f, 0), V3f(1, 0, 0)}).escaped());
  EXPECT_TRUE(wire.caster().intersect({V3f(0, 0.0101f, 0), V3f(1, 0, 0)}).escaped());
}

// Radius and turns; turns and height: as in Mitsuba. Derivatives against differences.
TEST(AnalyticShapes, TextureCoordinatesAndTheirDerivatives) {
  const Disk disk = skew_disk();
  const Cylinder cylinder = skew_cylinder();
  EXPECT_NEAR(parametrization(disk, disk.center + disk.x * 0.5f).uv.x, 0.5f, 1e-6f);
  EXPECT_NEAR(parametrization(disk, disk.center + disk.y * 0.25f).uv.y, 0.25f, 1e-6f);
  EXPECT_NEAR(parametrization(disk, disk.center - disk.y * 0.25f).uv.y, 0.75f, 1e-6f);
  const auto on_wall = [&](float turns, float v) {
    return cylinder.base + cylinder.axes[2] * (v * cylinder.length) +
           (cylinder.axes[0] * std::cos(2 * pi_f * turns) + cylinder.axes[1] * std::sin(2 * pi_f * turns)) *
               cylinder.radius;
  };
  for (const float turns : {0.1f, 0.4f, 0.9f}) {
    const Parametrization p = parametrization(cylinder, on_wall(turns, 0.3f));
    EXPECT_NEAR(p.uv.x, turns, 1e-6f);
    EXPECT_NEAR(p.uv.y, 0.3f, 1e-6f);
    constexpr float step = 1e-3f;
    EXPECT_LE((p.dp_du - (on_wall(turns + step, 0.3f) - on_wall(turns - step, 0.3f)) / (2 * step)).length(),
              2e-3f * p.dp_du.length());
    EXPECT_LE((p.dp_dv - (on_wall(turns, 0.3f + step) - on_wall(turns, 0.3f - step)) / (2 * step)).length(),
              2e-3f * p.dp_dv.length());
    const auto on_disk = [&](float radius, float t) {
      return disk.center + disk.x * (radius * std::cos(2 * pi_f * t)) +
             disk.y * (radius * std::sin(2 * pi_f * t));
    };
    const Parametrization d = parametrization(disk, on_disk(0.6f, turns));
    EXPECT_LE((d.dp_du - (on_disk(0.6f + step, turns) - on_disk(0.6f - step, turns)) / (2 * step)).length(),
              2e-3f * d.dp_du.length());
    EXPECT_LE((d.dp_dv - (on_disk(0.6f, turns + step) - on_disk(0.6f, turns - step)) / (2 * step)).length(),
              2e-3f * d.dp_dv.length());
  }
}

test::Estimate irradiance_from(const Lights& lights, const V3f& p, const V3f& n, int samples) {
  test::Estimate e;
  for (int i = 0; i < samples; ++i) {
    const LightSample s = lights.sample({p, n, true}, Sampler(5, static_cast<std::uint32_t>(i), 0).next_2d());
    e.add(s.pdf_w > 0.0f ? s.radiance.x * std::max(0.0f, s.direction.dot(n)) / s.pdf_w : 0.0);
  }
  return e;
}

// A disk on the axis of a facing element fills r^2 / (r^2 + h^2) of its hemisphere.
TEST(AnalyticShapes, DiskLampGivesItsExactIrradiance) {
  for (const float h : {0.3f, 1.0f, 4.0f}) {
    const Scene scene = scene_of(Disk{V3f(0, 0, h), V3f(2, 0, 0), V3f(0, -2, 0), false}, 3.0f);
    const test::Estimate e = irradiance_from(scene.lights(), V3f(0.0f), V3f(0, 0, 1), 100000);
    EXPECT_NEAR(e.mean(), 3.0 * pi * 4.0 / (4.0 + h * h), 5 * e.standard_error()) << h;
    EXPECT_EQ(irradiance_from(scene.lights(), V3f(0, 0, 2 * h), V3f(0, 0, -1), 100).mean(),
              0.0);  // its dark back
  }
}

// Facing the axis of a cylinder of radius 1 and length 1.5, level with its end, at the distance 2 from it
// (Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-31).
TEST(AnalyticShapes, CylinderLampGivesItsExactIrradiance) {
  Cylinder cylinder{V3f(0.0f), 1.0f, 1.5f, false, {V3f(1, 0, 0), V3f(0, 1, 0), V3f(0, 0, 1)}};
  const Scene outside = scene_of(cylinder, 3.0f);
  const test::Estimate e = irradiance_from(outside.lights(), V3f(2, 0, 0), V3f(-1, 0, 0), 100000);
  EXPECT_NEAR(e.mean(), 3.0 * pi * 0.22363731610152487, 5 * e.standard_error());
  EXPECT_LT(std::sqrt(e.variance()) / e.mean(), 1.2);  // only what is in view is sampled: else 1.8
  // In the middle of the axis and facing along it: all but the opening, r^2 / (r^2 + (l/2)^2).
  cylinder.inward = true;
  const Scene inside = scene_of(cylinder, 3.0f);
  const test::Estimate within = irradiance_from(inside.lights(), V3f(0, 0, 0.75f), V3f(0, 0, 1), 100000);
  EXPECT_NEAR(within.mean(), 3.0 * pi * (1.0 - 1.0 / (1.0 + 0.75 * 0.75)), 5 * within.standard_error());
}

// The density that sample() reports is that of pdf_w() for what the ray meets; the mean of its inverse is the
// solid angle of the lamp.
TEST(AnalyticShapes, DensitiesOfLampsAreExact) {
  for (const Geometry& geometry :
       {Geometry(skew_disk()), Geometry(skew_cylinder()), Geometry(skew_cylinder(true))}) {
    const bool is_inward = std::holds_alternative<Cylinder>(geometry) && std::get<Cylinder>(geometry).inward;
    const Scene scene = scene_of(geometry, 1.0f);
    const V3f p = is_inward ? skew_cylinder().base + skew_cylinder().axes[2] : V3f(2.5f, 1.0f, 4.0f);
    const Receiver receiver{p, V3f(0, 0, 1), false};
    int compared = 0;
    for (std::uint32_t i = 0; i < 2000; ++i) {
      const LightSample s = scene.lights().sample(receiver, Sampler(6, i, 0).next_2d());
      if (!(s.pdf_w > 0.0f) || is_black(s.radiance)) continue;
      const Ray ray{p, s.direction};
      const Hit hit = scene.caster().intersect(ray);
      if (hit.escaped()) continue;  // the rim
      const SurfacePoint point = scene.surface_point(ray, hit);
      EXPECT_FALSE(scene.caster().occluded(p, s.position));
      if (std::abs(point.geometric_normal.dot(s.direction)) < 0.02f) continue;
      EXPECT_NEAR(scene.lights().pdf_w(receiver, s.direction, hit.t, point), s.pdf_w, 2e-3f * s.pdf_w);
      ++compared;
    }
    EXPECT_GT(compared, 1500);
    test::Estimate seen, drawn;
    for (std::uint32_t i = 0; i < 100000; ++i) {
      const Ray ray{p, square_to_sphere(Sampler(7, i, 0).next_2d())};
      seen.add(scene.caster().intersect(ray).escaped() ? 0.0 : 4.0 * pi);
      const LightSample s = scene.lights().sample(receiver, Sampler(8, i, 0).next_2d());
      drawn.add(s.pdf_w > 0.0f && !is_black(s.radiance) ? 1.0 / s.pdf_w : 0.0);
    }
    EXPECT_NEAR(seen.mean(), drawn.mean(), 5 * std::hypot(seen.standard_error(), drawn.standard_error()));
    EXPECT_GT(drawn.mean(), 0.08);  // the least is the cylinder, 4.5 away: 2 r l sin(63 degrees) / d^2 = 0.088
  }
}

// Directions drawn towards each lamp fall into the cells of a grid over the sphere as often as points that are
// uniform on what is seen of it do: those of a fine grid in polar coordinates.
TEST(AnalyticShapes, PointsOfLampsAreUniformInArea) {
  for (const Geometry& geometry : {Geometry(skew_disk()), Geometry(skew_cylinder())}) {
    const Scene scene = scene_of(geometry, 1.0f);
    const V3f p(2.5f, 1.0f, 4.0f);
    const Receiver receiver{p, V3f(0, 0, 1), false};
    constexpr std::size_t rows = 40, columns = 80;
    const auto cell_of = [&](const V3f& w) {
      const auto row = std::min(rows - 1, static_cast<std::size_t>((w.z * 0.5f + 0.5f) * rows));
      const float turns = std::atan2(w.y, w.x) / (2.0f * pi_f) + 0.5f;
      return row * columns + std::min(columns - 1, static_cast<std::size_t>(turns * columns));
    };
    std::vector<double> observed(rows * columns), expected(rows * columns);
    double seen = 0.0;
    constexpr int steps = 1000;
    for (int i = 0; i < steps; ++i)
      for (int j = 0; j < steps; ++j) {
        const float a = 2.0f * pi_f * (static_cast<float>(i) + 0.5f) / steps,
                    b = (static_cast<float>(j) + 0.5f) / steps;
        V3f at;
        if (const auto* disk = std::get_if<Disk>(&geometry)) {
          at = disk->center + (disk->x * std::cos(a) + disk->y * std::sin(a)) * std::sqrt(b);
        } else {
          const Cylinder cylinder = skew_cylinder();
          const V3f outward = cylinder.axes[0] * std::cos(a) + cylinder.axes[1] * std::sin(a);
          at = cylinder.base + cylinder.axes[2] * (b * cylinder.length) + outward * cylinder.radius;
          if (outward.dot(p - at) <= 0.0f) continue;
        }
        ++expected[cell_of(unit(at - p))];
        ++seen;
      }
    constexpr std::uint32_t drawn = 40000;
    for (std::uint32_t i = 0; i < drawn; ++i) {
      // Independent numbers: stratified ones fit better than chance.
      const auto number = [&](std::uint64_t k) {
        return static_cast<float>(hash_words(i, static_cast<std::uint32_t>(k)) >> 40) * 0x1p-24f;
      };
      const LightSample s = scene.lights().sample(receiver, {number(1), number(2)});
      if (s.pdf_w > 0.0f) ++observed[cell_of(s.direction)];
    }
    for (double& count : expected) count *= drawn / seen;
    EXPECT_GT(test::chi2_test(observed, expected), 1e-4);
  }
}

}  // namespace
}  // namespace twopass
