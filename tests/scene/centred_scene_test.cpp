#include "render/scene/centred_scene.h"

#include <gtest/gtest.h>

#include "tests/support/scenes.h"

namespace twopass {
namespace {

SceneDescription white_cube() { return test::unit_room(C3f(0.5f), C3f(1.0f), C3f(0.5f)); }

SceneDescription moved(SceneDescription scene, const V3f& offset, float scale) {
  for (Shape& shape : scene.shapes) {
    if (auto* mesh = std::get_if<Mesh>(&shape.geometry)) {
      for (V3f& p : mesh->positions) p = p * scale + offset;
    } else {
      Sphere& sphere = std::get<Sphere>(shape.geometry);
      sphere.center = sphere.center * scale + offset;
      sphere.radius *= scale;
    }
  }
  return scene;
}

void expect_same(const SceneDescription& a, const SceneDescription& b) {
  for (std::size_t s = 0; s < a.shapes.size(); ++s)
    EXPECT_EQ(std::get<Mesh>(a.shapes[s].geometry).positions, std::get<Mesh>(b.shapes[s].geometry).positions);
}

TEST(CentredScene, ComesBackFromFarAwayAndFromAnySize) {
  for (const float scale : {0x1p-90f, 0x1p-20f, 1.0f, 0x1p20f}) {
    const SceneDescription far = moved(white_cube(), V3f(8192, -4096, 16384) * scale, scale);
    const SceneDescription back = centred(far);
    EXPECT_EQ(back.frame.unit, static_cast<double>(scale));
    // The negative coordinate leaves the cube on the other side of its plane of symmetry.
    expect_same(moved(back, V3f(0, 1, 0), 1.0f), white_cube());
    for (std::size_t s = 0; s < far.shapes.size(); ++s)
      for (std::size_t k = 0; k < 4; ++k)
        EXPECT_EQ(back.frame.to_world(std::get<Mesh>(back.shapes[s].geometry).positions[k]),
                  std::get<Mesh>(far.shapes[s].geometry).positions[k]);
    expect_same(centred(back), back);
  }
}

TEST(CentredScene, LeavesAloneWhatWouldLoseDigits) {
  const SceneDescription around_origin = moved(white_cube(), V3f(-0.25f, 0.0f, 0.75f), 1.0f);
  expect_same(centred(around_origin), around_origin);
  EXPECT_TRUE(centred({}).shapes.empty());
}

TEST(CentredScene, MovesSpheresToo) {
  SceneDescription scene;
  test::add_diffuse(scene, "inner", Sphere{V3f(4096.0f), 0.5f, false}, C3f(0.5f));
  test::add_diffuse(scene, "outer", Sphere{V3f(4096.0f), 1.0f, true}, C3f(0.5f));
  const SceneDescription back = centred(scene);
  const Sphere& inner = std::get<Sphere>(back.shapes[0].geometry);
  EXPECT_EQ(static_cast<double>(inner.radius) * back.frame.unit, 0.5);
  EXPECT_EQ(inner.center, std::get<Sphere>(back.shapes[1].geometry).center);
  EXPECT_LE(max_abs_component(inner.center), 2.0f);
}

// What a light sends to a point, and how brightly, does not depend on the unit of length.
TEST(CentredScene, TakesLightsAlong) {
  SceneDescription scene = moved(white_cube(), V3f(4096, 0, 0), 1.0f);
  for (Shape& shape : scene.shapes)
    for (V3f& p : std::get<Mesh>(shape.geometry).positions) p *= 0x1p-30f;
  const V3f above = V3f(4096.5f, 0.5f, 0.75f) * 0x1p-30f;
  const auto texture = std::make_shared<const Texture>(C3f(0.5f));
  LightFrame frame;
  frame.position = V3f(4096.5f, 0.5f, 0.0f) * 0x1p-30f;
  scene.punctual_lights = {PointLight{above, C3f(0x1p-50f)}, SpotLight{frame, C3f(0x1p-40f)},
                           Projector{frame, texture, 0x1p-55f}, DirectionalLight{{0, 0, -1}, C3f(3.0f)}};
  const SceneDescription back = centred(scene);
  const V3f receiver(0.375f, 0.5f, 0.5f), in_world = back.frame.to_world(receiver);
  for (std::size_t k = 0; k < scene.punctual_lights.size(); ++k) {
    const Illumination before = illumination(scene.punctual_lights[k], in_world),
                       after = illumination(back.punctual_lights[k], receiver);
    EXPECT_NEAR((before.direction - after.direction).length(), 0.0f, 1e-6f) << k;
    EXPECT_NEAR(before.irradiance.x / after.irradiance.x, 1.0f, 1e-5f) << k;
    EXPECT_GT(after.irradiance.x, 0.0f) << k;
  }
}

// Pixels show the same points of the world.
TEST(CentredScene, TakesTheCameraAlong) {
  SceneDescription scene = moved(white_cube(), V3f(4096, 0, 0), 1.0f);
  for (Shape& shape : scene.shapes)
    for (V3f& p : std::get<Mesh>(shape.geometry).positions) p *= 0x1p10f;
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    CameraDescription camera;
    camera.to_world = look_at(V3d(4096.5, 0.25, 0.5) * 1024.0, V3d(4097, 0.75, 0.25) * 1024.0, {0, 0, 1}, "");
    camera.projection = projection;
    camera.near_clip = 0.5;
    camera.far_clip = 2000.0;
    camera.aperture_radius = 16.0;
    camera.focus_distance = 512.0;
    scene.camera = camera;
    const SceneDescription back = centred(scene);
    const Camera before(camera, 7, 5), after(*back.camera, 7, 5);
    for (const V2f& pixel : {V2f(0, 0), V2f(3, 2), V2f(7, 1)}) {
      const CameraRay a = before.ray(pixel, {0.3f, 0.6f}), b = after.ray(pixel, {0.3f, 0.6f});
      EXPECT_NEAR((a.ray.origin - back.frame.to_world(b.ray.origin)).length(), 0.0f, 1.0f);
      EXPECT_NEAR((a.ray.direction - b.ray.direction).length(), 0.0f, 1e-5f);
      EXPECT_NEAR(a.reach, b.reach * static_cast<float>(back.frame.unit), 0.1f);
    }
    const CameraDescription again = back.frame.to_world(*back.camera);
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column)
        EXPECT_EQ(again.to_world[row][column], camera.to_world[row][column]);
    EXPECT_EQ(again.focus_distance, camera.focus_distance);
  }
}

// A bump map has heights; in other units they are other numbers.
TEST(CentredScene, TakesBumpMapsAlong) {
  SceneDescription scene = moved(white_cube(), V3f(0.0f), 0x1p20f);
  const auto plain = MaterialSide(Diffuse{C3f(0.5f)}).node();
  const auto bumpy =
      std::make_shared<const MaterialNode>(MaterialNode{BumpMap{Texture(C3f(0.5f)), 3.0f, {}, plain}});
  const auto mixed =
      std::make_shared<const MaterialNode>(MaterialNode{Mixture{Texture(C3f(0.5f)), bumpy, plain}});
  scene.materials[0] = two_sided("bumpy", MaterialSide(mixed), MaterialSide(Diffuse{}));
  const SceneDescription back = centred(scene);
  const auto& mixture = std::get<Mixture>(back.materials[0].side[front].node()->kind);
  EXPECT_EQ(std::get<BumpMap>(mixture.first->kind).scale, 3.0f * 0x1p-20f);
  EXPECT_EQ(std::get<BumpMap>(bumpy->kind).scale, 3.0f);
}

// Meshes that instances share are brought to unit size as well; every copy stays where it was.
TEST(CentredScene, KeepsInstancesInPlace) {
  const auto mesh =
      std::make_shared<const Mesh>(test::quad(V3f(0.0f), V3f(0x1p-40f, 0, 0), V3f(0, 0x1p-40f, 0)));
  SceneDescription scene;
  for (const float x : {0.0f, 0x1p-38f})
    test::add_diffuse(scene, "copy", MeshInstance{mesh, {{2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {x, 0, 0}}},
                      C3f(0.5f));
  const SceneDescription back = centred(scene);
  const auto& first = std::get<MeshInstance>(back.shapes[0].geometry);
  const auto& second = std::get<MeshInstance>(back.shapes[1].geometry);
  EXPECT_EQ(first.mesh, second.mesh);
  EXPECT_EQ(max_abs_component(first.mesh->positions[2]), 1.0f);
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_EQ(back.frame.to_world(second.to_world.point(second.mesh->positions[k])),
              std::get<MeshInstance>(scene.shapes[1].geometry).to_world.point(mesh->positions[k]));
}

}  // namespace
}  // namespace twopass
