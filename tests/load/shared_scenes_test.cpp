// The scenes in scenes/, and published ones where they lie beside the checkout (they are not part of it).
#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

const std::filesystem::path scenes = std::filesystem::path(TWOPASS_SOURCE_DIR) / "scenes";
const std::filesystem::path shared = std::filesystem::path(TWOPASS_SOURCE_DIR) / ".." / "shared" / "scenes";

const Shape& shape_called(const LoadedScene& loaded, std::string_view name) {
  for (const Shape& shape : loaded.scene.shapes)
    if (shape.name == name) return shape;
  throw std::runtime_error("no shape " + std::string(name));
}

/// Number of front sides that a ray from `origin` meets minus back sides; the nearest hit's side is what a
/// camera or a bounce would see. Moller and Trumbore's test in double.
bool nearest_is_front(const LoadedScene& loaded, const V3d& origin, const V3d& direction, double& distance) {
  distance = infinity_f;
  bool is_front = false;
  for (const Shape& shape : loaded.scene.shapes) {
    const Mesh* mesh = std::get_if<Mesh>(&shape.geometry);
    if (!mesh) continue;
    for (const V3u& t : mesh->triangles) {
      const V3d a(mesh->positions[t.x]), ab = V3d(mesh->positions[t.y]) - a, ac = V3d(mesh->positions[t.z]) - a;
      const V3d p = direction.cross(ac);
      const double det = ab.dot(p);
      const V3d s = origin - a, q = s.cross(ab);
      const double u = s.dot(p) / det, v = direction.dot(q) / det, hit = ac.dot(q) / det;
      if (!(u >= 0.0 && v >= 0.0 && u + v <= 1.0 && hit > 1e-9 && hit < distance)) continue;
      distance = hit;
      is_front = det > 0.0;  // positive where the ray runs against the normal
    }
  }
  return is_front;
}

/// From points inside a room every direction must meet a front side, or leave through an opening.
void expect_fronts(const LoadedScene& loaded, const std::vector<V3d>& origins, bool is_closed) {
  for (const V3d& origin : origins)
    for (int i = 0; i < 500; ++i) {
      // Directions on a spiral around the sphere, clear of symmetries.
      const double z = 1.0 - (2.0 * i + 1.0) / 500.0, phi = 2.399963 * i + 0.1234, r = std::sqrt(1.0 - z * z);
      double distance;
      const bool is_front =
          nearest_is_front(loaded, origin, {r * std::cos(phi), r * std::sin(phi), z}, distance);
      if (is_closed) {
        EXPECT_LT(distance, infinity_f) << "a leak at " << origin;
      }
      if (distance < infinity_f) {
        EXPECT_TRUE(is_front) << "a back side seen from " << origin << ", direction " << i;
      }
    }
}

TEST(SharedScenes, OurCornellBox) {
  const LoadedScene loaded = load_scene(scenes / "cornell-box" / "scene.xml", {});
  EXPECT_TRUE(loaded.notes.empty());
  EXPECT_EQ(loaded.scene.shapes.size(), 8u);
  EXPECT_EQ(loaded.settings.width, 512);
  EXPECT_EQ(loaded.settings.filter.kind, FilterKind::box);
  EXPECT_EQ(loaded.settings.integrator, "twopass");
  const Shape& lamp = shape_called(loaded, "lamp");
  EXPECT_EQ(lamp.radiance[front], C3f(17, 12, 4));
  expect_near(normal_of(std::get<Mesh>(lamp.geometry), 0), {0, -1, 0});
  EXPECT_NEAR(area_of(std::get<Mesh>(lamp.geometry)), 130.0 * 105.0, 1e-2);
  // The lamp fills the hole.
  EXPECT_NEAR(area_of(std::get<Mesh>(shape_called(loaded, "ceiling").geometry)), 556.0 * 559.2 - 130.0 * 105.0,
              0.1);
  for (const Shape& shape : loaded.scene.shapes)
    EXPECT_TRUE(std::get<Mesh>(shape.geometry).normals.empty()) << shape.name;
  expect_fronts(loaded, {{278, 273, 100}, {100, 500, 300}, {30, 30, 30}, {500, 20, 500}, {278, 400, 227}},
                false);
  // From behind the camera, the room is open.
  double distance;
  nearest_is_front(loaded, {200, 500, -800}, {0, 0, 1}, distance);
  EXPECT_NEAR(distance, 800 + 559.2, 1e-3);
}

TEST(SharedScenes, OurSpecularCornellBox) {
  const LoadedScene loaded = load_scene(scenes / "cornell-box-specular" / "scene.xml", {});
  EXPECT_TRUE(loaded.notes.empty());
  const Shape& glass = shape_called(loaded, "glass_sphere");
  EXPECT_TRUE(std::holds_alternative<Dielectric>(loaded.scene.materials[glass.material].side[front].uniform()));
  const Shape& mirror = shape_called(loaded, "tall_block");
  EXPECT_TRUE(std::holds_alternative<Conductor>(loaded.scene.materials[mirror.material].side[front].uniform()));
}

TEST(SharedScenes, OurThreeRooms) {
  const std::vector<V3d> corners = {
      {0.5, 0.01, 0.5}, {0.1, 0.1, 0.05}, {0.9, 0.9, 0.95}, {0.05, 0.9, 0.5}, {0.9, 0.3, 0.84}};
  for (const char* name : {"direct", "cove", "hidden"}) {
    SCOPED_TRACE(name);
    const LoadedScene loaded = load_scene(scenes / name / "scene.xml", {});
    EXPECT_TRUE(loaded.notes.empty());
    expect_fronts(loaded, corners, true);
    const Shape& light = shape_called(loaded, "light");
    expect_near(normal_of(std::get<Mesh>(light.geometry), 0), {0, 0, -1});
    EXPECT_NEAR(area_of(std::get<Mesh>(light.geometry)), 0.0625, 1e-7);
    EXPECT_NEAR(light.radiance[front].x * pi, 16.0, 1e-5);
    double room = 0.0;
    for (const char* wall : {"floor", "back_wall", "front_wall", "left_wall", "right_wall", "ceiling", "light"})
      room += area_of(std::get<Mesh>(shape_called(loaded, wall).geometry));
    EXPECT_NEAR(room, 6.0, 1e-5);
  }
}

TEST(SharedScenes, TheSlabsHideTheLight) {
  double distance;
  const LoadedScene cove = load_scene(scenes / "cove" / "scene.xml", {});
  nearest_is_front(cove, {0.5, 0.5, 0.999}, {0.001, 0.002, -1.0}, distance);
  EXPECT_NEAR(distance, 0.119, 1e-6);
  const LoadedScene hidden = load_scene(scenes / "hidden" / "scene.xml", {});
  nearest_is_front(hidden, {0.5, 0.5, 0.999}, {0.001, 0.002, -1.0}, distance);
  EXPECT_NEAR(distance, 0.079, 1e-6);
  nearest_is_front(hidden, {0.3, 0.1, 0.5}, {0.0, 1.0, 0.0}, distance);
  EXPECT_NEAR(distance, 0.38, 1e-6);
}

/// Skips the rest of the test where the published scenes are not there.
#define REQUIRE_SHARED(path) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << (path) << " is not here"

TEST(SharedScenes, TheBoxesOfMcGuire) {
  const std::filesystem::path folder = shared / "mcguire-cornell-box";
  REQUIRE_SHARED(folder);
  for (const char* name : {"Empty-CO", "Empty-RG", "Empty-Squashed", "Empty-White", "Glossy-Floor", "Glossy",
                           "Mirror", "Original", "Sphere", "Water"}) {
    SCOPED_TRACE(name);
    const LoadedScene loaded = load_scene(folder / ("CornellBox-" + std::string(name) + ".obj"), {});
    EXPECT_FALSE(loaded.scene.camera);
    const Shape& lamp = shape_called(loaded, "light");
    const Mesh& mesh = std::get<Mesh>(lamp.geometry);
    // Every lamp shines down, into the room; the file of the glossy box has forgotten that its lamp is one.
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) expect_near(normal_of(mesh, t), {0, -1, 0});
    if (std::string_view(name) == "Glossy")
      EXPECT_TRUE(has_note(loaded, "material 'light' is not defined"));
    else
      EXPECT_FALSE(is_black(lamp.radiance[front]));
  }
}

TEST(SharedScenes, TheCornellBoxOfBitterli) {
  REQUIRE_SHARED(shared / "cornell-box");
  const LoadedScene loaded = load_scene(shared / "cornell-box" / "scene.xml", {});
  EXPECT_EQ(loaded.scene.shapes.size(), 8u);
  EXPECT_EQ(loaded.settings.width, 1024);
  EXPECT_EQ(loaded.settings.filter.kind, FilterKind::tent);
  EXPECT_EQ(loaded.settings.max_depth, 30);
  EXPECT_FALSE(loaded.settings.integrator);
  EXPECT_EQ(loaded.notes.size(), 1u);
  expect_near(normal_of(std::get<Mesh>(shape_called(loaded, "Light").geometry), 0), {0, -1, 0});
  expect_near(normal_of(std::get<Mesh>(shape_called(loaded, "Floor").geometry), 0), {0, 1, 0});
}

TEST(SharedScenes, LargeObjFiles) {
  REQUIRE_SHARED(shared / "conference");
  const LoadedScene conference = load_scene(shared / "conference" / "conference.obj", {});
  EXPECT_GE(conference.scene.shapes.size(), 30u);
  const LoadedScene holodeck = load_scene(shared / "holodeck" / "holodeck.obj", {});
  std::size_t emitters = 0;
  for (const Shape& shape : holodeck.scene.shapes) emitters += is_emitter(shape);
  EXPECT_GT(emitters, 0u);
}

TEST(SharedScenes, VeachsPlatesAreRoughMetal) {
  REQUIRE_SHARED(shared / "veach-mis");
  const LoadedScene loaded = load_scene(shared / "veach-mis" / "scene.xml", {});
  std::set<float> roughness;
  for (const Material& material : loaded.scene.materials)
    if (const auto* metal = std::get_if<RoughConductor>(&material.side[front].uniform()))
      roughness.insert(metal->alpha_u);
  EXPECT_EQ(roughness, (std::set<float>{0.01f, 0.05f, 0.1f, 0.25f}));
}

TEST(SharedScenes, StaircaseIsTexturedPlastic) {
  REQUIRE_SHARED(shared / "staircase");
  const LoadedScene loaded = load_scene(shared / "staircase" / "scene.xml", {});
  EXPECT_GT(loaded.scene.shapes.size(), 700u);
  const auto textured = std::ranges::count_if(
      loaded.scene.materials, [](const Material& material) { return !material.side[front].is_uniform(); });
  EXPECT_GE(textured, 5);
}

}  // namespace
}  // namespace twopass
