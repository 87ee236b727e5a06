// Meshes that stand in several places.
#include <gtest/gtest.h>

#include "render/core/sampler.h"
#include "render/core/warp.h"
#include "render/scene/scene.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

// Turned, stretched differently along its axes, sheared a little, and moved.
Placement stretched(const V3f& origin) {
  const Frame frame(V3f(1, 2, 2) / 3.0f);
  return {frame.s * 2.0f, frame.t * 0.25f + frame.s * 0.1f, frame.n * 1.5f, origin};
}

// A sphere-like mesh with smooth normals and texture coordinates.
Mesh ball(int n) {
  Mesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= 2 * n; ++i) {
      const float a = pi_f * static_cast<float>(i) / static_cast<float>(n),
                  b = pi_f * static_cast<float>(j) / static_cast<float>(n);
      mesh.positions.emplace_back(std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), std::cos(b));
      mesh.normals.push_back(mesh.positions.back());
      mesh.uvs.emplace_back(static_cast<float>(i) / static_cast<float>(2 * n),
                            static_cast<float>(j) / static_cast<float>(n));
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < 2 * n; ++i) {
      const auto at = [&](int x, int y) { return static_cast<std::uint32_t>(y * (2 * n + 1) + x); };
      if (j > 0) mesh.triangles.emplace_back(at(i, j), at(i, j + 1), at(i + 1, j));
      if (j + 1 < n) mesh.triangles.emplace_back(at(i + 1, j), at(i, j + 1), at(i + 1, j + 1));
    }
  return mesh;
}

// The same as one mesh in the world.
Mesh in_world(const Mesh& mesh, const Placement& to_world) {
  Mesh result = mesh;
  for (V3f& p : result.positions) p = to_world.point(p);
  for (V3f& n : result.normals) n = unit(to_world.normal(n));
  return result;
}

Material textured() {
  Checkerboard board;
  const Diffuse grey{C3f(0.5f)};
  return one_sided("board", MaterialSide(std::make_shared<const MaterialNode>(
                                MaterialNode{TexturedModel{grey, {{0, Texture(board)}}}})));
}

// The same with tangents that matter.
Material bumpy() {
  Material material = textured();
  for (MaterialSide& side : material.side)
    side = MaterialSide(std::make_shared<const MaterialNode>(
        MaterialNode{BumpMap{.height = Texture(Checkerboard{}), .nested = side.node()}}));
  return material;
}

void expect_the_same(const Material& material) {
  const auto mesh = std::make_shared<const Mesh>(ball(12));
  const std::vector<Placement> places{stretched(V3f(3, 1, 2)),
                                      stretched(V3f(-3, 0, 1)),
                                      {V3f(1, 0, 0), V3f(0, 1, 0), V3f(0, 0, 1), V3f(0, 5, 0)}};
  SceneDescription shared, copied;
  shared.materials = copied.materials = {material};
  for (const Placement& place : places) {
    shared.shapes.push_back({"copy", MeshInstance{mesh, place}, 0, {C3f(0.0f), C3f(0.0f)}});
    copied.shapes.push_back({"copy", in_world(*mesh, place), 0, {C3f(0.0f), C3f(0.0f)}});
  }
  EXPECT_LE((bounds_of(shared.shapes).max - bounds_of(copied.shapes).max).length(), 2.0f);
  const Scene a(std::move(shared)), b(std::move(copied));
  std::array<int, 3> hits{};
  int differ = 0;
  for (std::uint32_t i = 0; i < 20000; ++i) {
    Sampler sampler(1, i, 0);
    const V3f target = places[i % 3].point(square_to_sphere(sampler.next_2d()) * 0.9f);
    const V3f from = target + square_to_sphere(sampler.next_2d()) * 8.0f;
    const Ray ray{from, unit(target - from)};
    const Hit ha = a.caster().intersect(ray), hb = b.caster().intersect(ray);
    if (ha.shape != hb.shape || ha.primitive != hb.primitive) {
      ++differ;  // at an edge either triangle may win
      continue;
    }
    if (ha.escaped()) continue;
    ++hits[ha.shape];
    EXPECT_EQ(a.caster().occluded(from, target), b.caster().occluded(from, target));
    const SurfacePoint pa = a.surface_point(ray, ha), pb = b.surface_point(ray, hb);
    EXPECT_LE((pa.position - pb.position).length(), 4e-5f);
    EXPECT_EQ(pa.side, pb.side);
    EXPECT_GT(pa.geometric_normal.dot(pb.geometric_normal), 1.0f - 1e-5f);
    // Normals are interpolated in the mesh's coordinates, as in Mitsuba, and then carried into the world.
    const V3u& t = mesh->triangles[ha.primitive];
    const V3f n = unit(places[ha.shape].normal(mesh->normals[t.x] * (1 - ha.u - ha.v) +
                                               mesh->normals[t.y] * ha.u + mesh->normals[t.z] * ha.v));
    if (n.dot(ray.direction) < -1e-3f) {
      EXPECT_GT(pa.shading.n.dot(n), 1.0f - 1e-5f);
      EXPECT_GT(pa.shading.n.dot(pb.shading.n), 0.9f);
    }
    EXPECT_LE((pa.uv - pb.uv).length(), 1e-4f);
    EXPECT_LE((pa.uv_rate - pb.uv_rate).length(), 1e-3f * pb.uv_rate.length());
    if (!material.side[front].traits().needs_tangents) continue;
    EXPECT_LE((pa.dp_du - pb.dp_du).length(), 1e-3f * pb.dp_du.length());
    EXPECT_LE((pa.dp_dv - pb.dp_dv).length(), 1e-3f * pb.dp_dv.length());
    EXPECT_NEAR(pb.uv_rate.x * pb.dp_du.length(), 1.0f, 1e-5f);
    EXPECT_NEAR(pb.uv_rate.y * pb.dp_dv.length(), 1.0f, 1e-5f);
  }
  EXPECT_LT(differ, 40);
  for (const int count : hits) EXPECT_GT(count, 1000);
}

TEST(MeshInstance, IsSeenAsTheMeshInTheWorldWouldBe) { expect_the_same(textured()); }
TEST(MeshInstance, HasTheTangentsOfTheMeshInTheWorld) { expect_the_same(bumpy()); }

// Packets answer as single rays do.
TEST(MeshInstance, PacketsFindTheSame) {
  const auto mesh = std::make_shared<const Mesh>(ball(8));
  SceneDescription scene;
  test::add_diffuse(scene, "floor", test::quad(V3f(-9, -9, -3), V3f(18, 0, 0), V3f(0, 18, 0)), C3f(0.5f));
  for (int k = 0; k < 5; ++k)
    test::add_diffuse(scene, "copy", MeshInstance{mesh, stretched(V3f(static_cast<float>(3 * k) - 6, 0, 0))},
                      C3f(0.5f));
  const RayCaster caster(scene.shapes);
  std::vector<Ray> rays;
  for (std::uint32_t i = 0; i < 256; ++i)
    rays.push_back({V3f(0.5f, 0.2f, 4.0f), square_to_sphere(Sampler(2, i, 0).next_2d())});
  std::vector<Hit> hits(rays.size());
  for (const Rays kind : {Rays::coherent, Rays::scattered}) {
    caster.intersect(rays, hits, kind);
    int instances = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      EXPECT_EQ(hits[i].shape, caster.intersect(rays[i]).shape);
      instances += !hits[i].escaped() && hits[i].shape > 0;
    }
    EXPECT_GT(instances, 20);
  }
}

// Rays that leave the inside of a closed box, far from the origin and stretched by a thousand, stay in it.
TEST(MeshInstance, RaysStartClearOfTheSurface) {
  SceneDescription room = test::unit_room(C3f(0.5f), C3f(0.0f), C3f(0.5f));
  SceneDescription description;
  description.materials = {one_sided("grey", Diffuse{})};
  const Frame frame(V3f(2, 3, 6) / 7.0f);
  for (const Placement& place : {Placement{frame.s, frame.t, frame.n, V3f(100, -70, 30)},
                                 Placement{frame.s * 1000.0f, frame.t, frame.n * 30.0f, V3f(5, 6, 7)}}) {
    description.shapes.clear();
    for (const Shape& wall : room.shapes)
      description.shapes.push_back(
          {wall.name,
           MeshInstance{std::make_shared<const Mesh>(std::get<Mesh>(wall.geometry)), place},
           0,
           {C3f(0.0f), C3f(0.0f)}});
    const Scene scene(description);
    int escaped = 0, behind = 0;
    for (std::uint32_t i = 0; i < 400; ++i) {
      Sampler sampler(3, i, 0);
      Ray ray{place.point(V3f(0.4f, 0.6f, 0.5f)), square_to_sphere(sampler.next_2d())};
      for (int bounce = 0; bounce < 50; ++bounce) {
        const Hit hit = scene.caster().intersect(ray);
        if (hit.escaped()) {
          ++escaped;
          break;
        }
        const SurfacePoint point = scene.surface_point(ray, hit);
        behind += point.side == back;
        const V3f w = Frame(point.geometric_normal).to_world(square_to_cosine_hemisphere(sampler.next_2d()));
        ray = {spawn_position(point, w), w};
      }
    }
    EXPECT_EQ(behind, 0);
    EXPECT_LE(escaped, 1);  // an edge of two walls, now and then
  }
}

// A thousand copies of 20 thousand triangles cost little more than one.
TEST(MeshInstance, CopiesShareMemory) {
  const auto mesh = std::make_shared<const Mesh>(ball(100));
  ASSERT_GT(mesh->triangles.size(), 39000u);
  const auto bytes = [&](int copies) {
    std::vector<Shape> shapes;
    for (int k = 0; k < copies; ++k) {
      Placement place;
      place.origin = V3f(static_cast<float>(3 * (k % 10)), static_cast<float>(3 * (k / 10 % 10)),
                         static_cast<float>(3 * (k / 100)));
      shapes.push_back({"copy", MeshInstance{mesh, place}, 0, {C3f(0.0f), C3f(0.0f)}});
    }
    return RayCaster(shapes).memory_bytes();
  };
  const std::size_t one = bytes(1), thousand = bytes(1000);
  EXPECT_GT(one, 39000u * 40u);
  EXPECT_LT(thousand, one + 1000u * 2000u);
}

// As a lamp it is the mesh where it stands.
TEST(MeshInstance, ShinesFromWhereItStands) {
  SceneDescription description;
  description.materials = {one_sided("black", Diffuse{C3f(0.0f)})};
  const auto mesh = std::make_shared<const Mesh>(test::quad(V3f(-0.5f, 0.5f, 0), V3f(1, 0, 0), V3f(0, -1, 0)));
  description.shapes.push_back({"lamp",
                                MeshInstance{mesh, {V3f(2, 0, 0), V3f(0, 2, 0), V3f(0, 0, 1), V3f(0, 0, 2)}},
                                0,
                                {C3f(3.0f), C3f(0.0f)}});
  const Scene scene(description);
  double sum = 0.0;
  constexpr int samples = 20000;
  const Receiver receiver{V3f(0.0f), V3f(0, 0, 1), true};
  for (std::uint32_t i = 0; i < samples; ++i) {
    const LightSample s = scene.lights().sample(receiver, Sampler(5, i, 0).next_2d());
    sum += s.pdf_w > 0.0f ? s.radiance.x * s.direction.z / s.pdf_w : 0.0;
    const Ray ray{receiver.position, s.direction};
    const Hit hit = scene.caster().intersect(ray);
    if (hit.escaped()) continue;
    EXPECT_NEAR(scene.lights().pdf_w(receiver, s.direction, hit.t, scene.surface_point(ray, hit)), s.pdf_w,
                2e-3f * s.pdf_w);
  }
  EXPECT_NEAR(sum / samples, 3.0 * pi * 0.23945647046077354, 0.02);
}

}  // namespace
}  // namespace twopass
