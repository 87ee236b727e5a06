#include "render/load/load_gltf_scene.h"

#include "render/scene/geometry.h"
#include "tests/load/gltf_writer.h"
#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

using json = nlohmann::json;
using LoadGltfScene = LoadTest;

std::vector<V3u> triangles_of(const LoadedScene& loaded) { return mesh_of(loaded).triangles; }

TEST_F(LoadGltfScene, BothContainersHoldTheSameScene) {
  GltfWriter w;
  w.add_triangle();
  for (const LoadedScene& loaded : {load_gltf(w.gltf()), load_glb(w.glb()), load_gltf(w.glb())}) {
    ASSERT_EQ(loaded.scene.shapes.size(), 1u);
    EXPECT_EQ(loaded.scene.shapes[0].name, "triangle");
    EXPECT_EQ(mesh_of(loaded).positions, (std::vector<V3f>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    expect_near(normal_of(mesh_of(loaded), 0), {0, 0, 1});
    EXPECT_TRUE(mesh_of(loaded).normals.empty());
    EXPECT_FALSE(loaded.scene.camera);
    EXPECT_TRUE(loaded.notes.empty());
  }
}

TEST_F(LoadGltfScene, ListsStripsAndFans) {
  GltfWriter w;
  const std::size_t mesh =
      w.add_mesh({{"attributes", {{"POSITION", w.add_vec3({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 2, 2, 1})}}}});
  w.add_root({{"mesh", mesh}});
  w.primitive()["mode"] = 5;
  EXPECT_EQ(triangles_of(load_gltf(w.gltf())), (std::vector<V3u>{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}}));
  w.primitive()["mode"] = 6;
  EXPECT_EQ(triangles_of(load_gltf(w.gltf())), (std::vector<V3u>{{1, 2, 0}, {2, 3, 0}, {3, 4, 0}}));
  w.primitive()["mode"] = 4;  // two corners are left over, two vertices unused
  EXPECT_EQ(triangles_of(load_gltf(w.gltf())), (std::vector<V3u>{{0, 1, 2}}));
  EXPECT_EQ(mesh_of(load_gltf(w.gltf())).positions.size(), 3u);
  w.primitive()["mode"] = 7;
  expect_error([&] { load_gltf(w.gltf()); }, {"mesh 'mesh' has a primitive of mode 7"});
}

TEST_F(LoadGltfScene, IndicesOfAllTypes) {
  const auto check = [&](auto type) {
    GltfWriter w;
    w.add_triangle();
    w.primitive()["indices"] = w.add_accessor("SCALAR", 1, std::vector<decltype(type)>{2, 1, 0});
    EXPECT_EQ(triangles_of(load_gltf(w.gltf())), (std::vector<V3u>{{2, 1, 0}}));
    w.primitive()["indices"] = w.add_accessor("SCALAR", 1, std::vector<decltype(type)>{0, 1, 2, 0, 1, 3});
    const LoadedScene loaded = load_gltf(w.gltf());
    EXPECT_EQ(triangles_of(loaded), (std::vector<V3u>{{0, 1, 2}}));
    EXPECT_TRUE(has_note(loaded, "1 triangles with indices out of range are left out"));
  };
  check(std::uint8_t{});
  check(std::uint16_t{});
  check(std::uint32_t{});
  GltfWriter w;
  w.add_triangle();
  w.primitive()["indices"] = w.add_accessor("SCALAR", 1, std::vector<float>{0, 1, 2});
  expect_error([&] { load_gltf(w.gltf()); }, {"(indices of mesh 'triangle') does not hold unsigned integers"});
  w.primitive()["indices"] = 99;
  expect_error([&] { load_gltf(w.gltf()); }, {"indices"});
}

TEST_F(LoadGltfScene, NormalsAndTextureCoordinates) {
  GltfWriter w;
  w.add_triangle();
  w.primitive()["attributes"]["NORMAL"] = w.add_vec3({0, 0, 2, 0, 1, 1, 1, 0, 1});
  w.primitive()["attributes"]["TEXCOORD_0"] =
      w.add_accessor("VEC2", 2, std::vector<std::uint16_t>{0, 65535, 65535, 0, 0, 0});
  w.document["accessors"].back()["normalized"] = true;
  const Mesh mesh = mesh_of(load_gltf(w.gltf()));
  const float h = std::sqrt(0.5f);
  ASSERT_EQ(mesh.normals.size(), 3u);
  expect_near(mesh.normals[0], {0, 0, 1});
  expect_near(mesh.normals[1], {0, h, h});
  EXPECT_EQ(mesh.uvs, (std::vector<V2f>{{0, 1}, {1, 0}, {0, 0}}));
  w.primitive()["attributes"]["NORMAL"] = w.add_vec3({0, 0, 2, 0, 1, 1});
  expect_error([&] { load_gltf(w.gltf()); }, {"(NORMAL of mesh 'triangle') has 2 elements for 3 positions"});
  w.primitive()["attributes"]["NORMAL"] = w.primitive()["attributes"]["TEXCOORD_0"];
  expect_error([&] { load_gltf(w.gltf()); }, {"has elements of 2 numbers"});
}

TEST_F(LoadGltfScene, MirroredNodesKeepTheirFronts) {
  GltfWriter w;
  w.add_triangle();
  w.primitive()["attributes"]["NORMAL"] = w.add_vec3({0, 1, 1, 0, 1, 1, 0, 1, 1});
  w.document["nodes"][0]["scale"] = {-2, 1, 1};
  const Mesh mesh = mesh_of(load_gltf(w.gltf()));
  expect_near(mesh.positions[1], {-2, 0, 0});
  expect_near(normal_of(mesh, 0), {0, 0, 1});
  expect_near(mesh.normals[0], V3f(0, 1, 1).normalized());
}

TEST_F(LoadGltfScene, MeshesHangInSeveralNodes) {
  GltfWriter w;
  const std::size_t mesh = w.add_triangle();
  w.add_root({{"mesh", mesh}, {"name", "second"}, {"translation", {0, 0, 5}}});
  const LoadedScene loaded = load_gltf(w.gltf());
  ASSERT_EQ(loaded.scene.shapes.size(), 2u);
  EXPECT_EQ(loaded.scene.shapes[1].name, "second");
  EXPECT_EQ(loaded.scene.materials.size(), 1u);
  expect_near(mesh_of(loaded, 1).positions[0], {0, 0, 5});
}

TEST_F(LoadGltfScene, ShapesOfSeveralPrimitivesAreNamedAfterMaterials) {
  GltfWriter w;
  w.add_triangle();
  json& primitives = w.document["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  primitives[1]["material"] = w.add("materials", {{"name", "red"}});
  const LoadedScene loaded = load_gltf(w.gltf());
  EXPECT_EQ(loaded.scene.shapes.at(0).name, "triangle:0");
  EXPECT_EQ(loaded.scene.shapes.at(1).name, "triangle:red");
}

TEST_F(LoadGltfScene, WhatIsNotWorthRenderingIsCounted) {
  GltfWriter w;
  w.add_triangle();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::size_t mesh =
      w.add_mesh({{"attributes", {{"POSITION", w.add_vec3({0, 0, 0, 1, 0,     0, 0, nan, 0, 0, 0, 0, 1, 0,
                                                           0, 2, 0, 0, 1e20f, 0, 0, 1,   0, 0, 0, 1, 0})}}}});
  w.add_root({{"mesh", mesh}});
  json points = w.primitive();
  points["mode"] = 0;
  w.document["meshes"][0]["primitives"].push_back(points);
  w.document["meshes"][0]["primitives"].push_back({{"attributes", json::object()}});
  w.primitive(0)["targets"] = {{{"POSITION", 0}}};
  const LoadedScene loaded = load_gltf(w.gltf());
  EXPECT_EQ(loaded.scene.shapes.size(), 1u);
  EXPECT_TRUE(has_note(loaded, "1 primitives made of points or lines are left out"));
  EXPECT_TRUE(has_note(loaded, "2 triangles with coordinates that are not finite or too large are left out"));
  EXPECT_TRUE(has_note(loaded, "1 triangles without area are left out"));
  EXPECT_TRUE(has_note(loaded, "morph targets are rendered without them"));
  w.document["scenes"][0]["nodes"] = {1};
  expect_error([&] { load_gltf(w.gltf()); },
               {"hangs in its scene, 2 triangles with coordinates that are not finite"});
  w.add_root({{"mesh", w.add_mesh(points)}});
  w.document["scenes"][0]["nodes"] = {2};
  expect_error([&] { load_gltf(w.gltf()); }, {"hangs in its scene, 1 primitives made of points or lines"});
}

TEST_F(LoadGltfScene, RepetitionIsBoundedByTheSizeOfTheFile) {
  // 200 kB that ask for 300 million triangles: they are instances of one mesh.
  GltfWriter w;
  w.add_mesh({{"mode", 5}, {"attributes", {{"POSITION", w.add_vec3({0, 0, 0, 1, 0, 0, 0, 1, 0})}}}});
  std::vector<std::uint8_t> indices(100000);
  for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = static_cast<std::uint8_t>(i % 3);
  w.primitive()["indices"] = w.add_accessor("SCALAR", 1, indices);
  for (int i = 0; i < 3000; ++i) w.add_root({{"mesh", 0}});
  const LoadedScene loaded = load_gltf(w.gltf());
  ASSERT_EQ(loaded.scene.shapes.size(), 3000u);
  const auto* first = std::get_if<MeshInstance>(&loaded.scene.shapes.front().geometry);
  const auto* last = std::get_if<MeshInstance>(&loaded.scene.shapes.back().geometry);
  ASSERT_TRUE(first && last);
  EXPECT_EQ(first->mesh, last->mesh);
  // Primitives of which nothing is left are none.
  std::ranges::fill(w.bytes, '\x07');
  const json primitive = w.primitive();
  for (int i = 0; i < 3000; ++i) w.document["meshes"][0]["primitives"].push_back(primitive);
  expect_error([&] { load_gltf(w.gltf()); }, {"too many for a file of its size"});
}

TEST_F(LoadGltfScene, CamerasLookAlongMinusZ) {
  GltfWriter w;
  w.add_triangle();
  w.add("cameras",
        {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}, {"aspectRatio", 2.0}}}});
  const double h = std::sqrt(0.5);
  w.add_root({{"camera", 0}, {"translation", {1, 2, 3}}, {"rotation", {0, h, 0, h}}, {"scale", {5, 5, 5}}});
  w.add_root({{"camera", 0}});
  const LoadedScene loaded = load_gltf(w.gltf());
  EXPECT_EQ(loaded.settings.width, 2 * loaded.settings.height);
  ASSERT_TRUE(loaded.scene.camera);
  EXPECT_TRUE(has_note(loaded, "the first of its 2 cameras is used"));
  const Camera camera(*loaded.scene.camera, 200, 100);
  const auto at = [&](float x, float y) { return camera.ray({x, y}).ray; };
  expect_near(at(100, 50).origin, {1, 2, 3});
  expect_near(at(100, 50).direction, {-1, 0, 0});  // -z, turned by 90 degrees around y
  EXPECT_LT(at(200, 50).direction.z, 0.0f);        // the right edge sees the node's +x, which is -z now
  EXPECT_NEAR(std::acos(at(100, 0).direction.dot(at(100, 100).direction)), 0.5, 1e-5);
  EXPECT_GT(at(100, 0).direction.y, 0.0f);
}

TEST_F(LoadGltfScene, OrthographicCamerasSeeABox) {
  GltfWriter w;
  w.add_triangle();
  w.add("cameras", {{"type", "orthographic"},
                    {"orthographic", {{"xmag", 3.0}, {"ymag", 2.0}, {"znear", 0.1}, {"zfar", 10.0}}}});
  w.add_root({{"camera", 0}, {"translation", {1, 2, 3}}});
  const LoadedScene loaded = load_gltf(w.gltf());
  EXPECT_EQ(2 * loaded.settings.width, 3 * loaded.settings.height);
  ASSERT_TRUE(loaded.scene.camera);
  const Camera camera(*loaded.scene.camera, 300, 200);
  expect_near(camera.ray({0, 0}).ray.origin, {1 - 3, 2 + 2, 3});
  expect_near(camera.ray({300, 200}).ray.origin, {1 + 3, 2 - 2, 3});
  expect_near(camera.ray({300, 200}).ray.direction, {0, 0, -1});
  w.document["cameras"][0]["orthographic"]["ymag"] = 0;
  expect_error([&] { load_gltf(w.gltf()); }, {"has ymag 0"});
}

TEST_F(LoadGltfScene, CamerasThatMakeNoPictureAreRefused) {
  GltfWriter w;
  w.add_triangle();
  w.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.0}, {"znear", 0.1}}}});
  w.add_root({{"camera", 0}, {"name", "eye"}});
  expect_error([&] { load_gltf(w.gltf()); }, {"camera 'eye' has yfov 0"});
  w.document["cameras"][0]["perspective"] = {{"yfov", 1.0}, {"znear", 0.1}, {"aspectRatio", -1.0}};
  expect_error([&] { load_gltf(w.gltf()); }, {"camera 'eye' has aspectRatio -1"});
  w.document["cameras"][0]["perspective"]["aspectRatio"] = 1000.0;
  const FileSettings wide = load_gltf(w.gltf()).settings;
  EXPECT_EQ(wide.width, 65536);
  EXPECT_EQ(wide.height, 66);
  w.document["nodes"][1]["scale"] = {1, 0, 1};
  expect_error([&] { load_gltf(w.gltf()); }, {"node 'eye' has no direction to look in"});
  w.document["nodes"][1]["camera"] = 3;
  expect_error([&] { load_gltf(w.gltf()); }, {"node 'eye' refers to camera 3"});
  w.document["cameras"][0]["type"] = "fisheye";
  expect_error([&] { load_gltf(w.gltf()); }, {"fisheye"});
}

class GltfLights : public LoadTest {
 protected:
  std::vector<PunctualLight> lights(json light) {
    GltfWriter w;
    w.add_triangle();
    const double h = std::sqrt(0.5);
    w.add_root({{"name", "lamp"},
                {"translation", {1, 2, 3}},
                {"rotation", {-h, 0, 0, h}},  // -z goes to -y
                {"scale", {3, 3, 3}},
                {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    w.document["extensions"]["KHR_lights_punctual"]["lights"] = json::array({std::move(light)});
    loaded_ = load_gltf(w.gltf());
    return loaded_.scene.punctual_lights;
  }
  LoadedScene loaded_;
};

TEST_F(GltfLights, DirectionalPointAndSpot) {
  const auto directional = std::get<DirectionalLight>(
      lights({{"type", "directional"}, {"color", {1, 0.5, 0}}, {"intensity", 4}}).at(0));
  expect_near(directional.direction, {0, -1, 0});
  EXPECT_EQ(directional.irradiance, C3f(4, 2, 0));
  const auto point = std::get<PointLight>(lights({{"type", "point"}, {"range", 2}}).at(0));
  expect_near(point.position, {1, 2, 3});
  EXPECT_EQ(point.intensity, C3f(1.0f));
  EXPECT_TRUE(has_note(loaded_, "lights shine beyond their range"));
  // A receiver 2 below sees 100 / 2^2 on the axis, half a beam at 15 degrees, nothing beyond 20.
  const PunctualLight spot =
      lights({{"type", "spot"},
              {"intensity", 100},
              {"spot", {{"innerConeAngle", 10 * pi / 180}, {"outerConeAngle", 20 * pi / 180}}}})
          .at(0);
  const auto irradiance = [&](double degrees) {
    const double a = degrees * pi / 180;
    return illumination(spot, V3f(V3d(1 + 2 * std::sin(a), 2 - 2 * std::cos(a), 3))).irradiance.x;
  };
  EXPECT_NEAR(irradiance(0), 25, 1e-3);
  EXPECT_NEAR(irradiance(9.9), 25, 1e-3);
  EXPECT_NEAR(irradiance(15), 12.5, 1e-2);
  EXPECT_EQ(irradiance(20.1), 0);
  EXPECT_TRUE(has_note(loaded_, "fade linearly"));
}

TEST_F(GltfLights, WhatIsNoLightIsRefused) {
  const auto refused = [&](json light, std::initializer_list<std::string_view> parts) {
    expect_error([&] { lights(std::move(light)); }, parts);
  };
  refused({{"type", "area"}}, {"light 'lamp' is of type 'area'"});
  refused({{"type", "point"}, {"intensity", -1}}, {"light 'lamp' has a color or intensity below 0"});
  refused({{"type", "point"}, {"color", {1, 1}}}, {"has a color of 2 numbers"});
  refused({{"type", "spot"}, {"spot", {{"innerConeAngle", 0.5}, {"outerConeAngle", 0.5}}}}, {"has cones of"});
  refused({{"type", "spot"}, {"spot", {{"outerConeAngle", 2.0}}}}, {"has cones of"});
  refused({{"type", "spot"}}, {"Spot light description not found"});
}

TEST_F(LoadGltfScene, ParametersAreMitsubas) {
  GltfWriter w;
  w.add_triangle();
  const auto path = write("scene.gltf", w.gltf());
  expect_error([&] { load_scene(path, {{"a", "1"}}); }, {"-D a", "only Mitsuba's scenes have parameters"});
}

// A wavy strip of `triangles` triangles.
json strip(GltfWriter& w, int triangles) {
  std::vector<float> positions;
  for (int i = 0; i < triangles + 2; ++i) {
    const auto x = static_cast<float>(i);
    positions.insert(positions.end(), {x, static_cast<float>(i % 2), std::sin(x)});
  }
  return {{"attributes", {{"POSITION", w.add_vec3(positions)}}}, {"mode", 5}};
}

const std::vector<json> places{
    {{"translation", {1, 2, 3}}, {"rotation", {0.6, 0, 0, 0.8}}, {"scale", {2, 2, 2}}},
    {{"translation", {-5, 0, 0}}, {"scale", {1, 3, 0.5}}},
    {{"scale", {-1, 1, 1}}}};

TEST_F(LoadGltfScene, NodesThatShareALargeMeshAreInstancesOfIt) {
  GltfWriter shared, copied;
  const json primitive = strip(shared, 400);
  strip(copied, 400);
  shared.add_mesh(primitive);
  for (json node : places) {
    node["mesh"] = 0;
    shared.add_root(node);
    node["mesh"] = copied.add_mesh(primitive);
    copied.add_root(node);
  }
  const LoadedScene instances = load_gltf(shared.gltf()), copies = load_gltf(copied.gltf());
  ASSERT_EQ(instances.scene.shapes.size(), 3u);
  ASSERT_EQ(copies.scene.shapes.size(), 3u);
  std::vector<const Mesh*> meshes;
  for (std::size_t s = 0; s < 3; ++s) {
    const Geometry &instance = instances.scene.shapes[s].geometry, &copy = copies.scene.shapes[s].geometry;
    ASSERT_TRUE(std::holds_alternative<MeshInstance>(instance));
    ASSERT_TRUE(std::holds_alternative<Mesh>(copy));
    EXPECT_EQ(instances.scene.shapes[s].name, copies.scene.shapes[s].name);
    meshes.push_back(mesh_of(instance));
    ASSERT_EQ(mesh_of(instance)->triangles.size(), 400u);
    ASSERT_EQ(mesh_of(copy)->triangles.size(), 400u);
    for (std::uint32_t t = 0; t < 400; ++t) {
      const auto a = corners(instance, t), b = corners(copy, t);
      for (std::size_t k = 0; k < 3; ++k) expect_near(a[k], b[k], 1e-3f);
    }
  }
  EXPECT_EQ(meshes[0], meshes[1]);
  EXPECT_NE(meshes[0], meshes[2]);  // the mirror image
}

TEST_F(LoadGltfScene, SmallMeshesAndLampsAreCopied) {
  for (const int triangles : {100, 400}) {
    GltfWriter w;
    json primitive = strip(w, triangles);
    if (triangles == 400) primitive["material"] = w.add("materials", {{"emissiveFactor", {1, 1, 1}}});
    w.add_mesh(primitive);
    for (json node : places) {
      node["mesh"] = 0;
      w.add_root(node);
    }
    const LoadedScene loaded = load_gltf(w.gltf());
    ASSERT_EQ(loaded.scene.shapes.size(), 3u);
    for (const Shape& shape : loaded.scene.shapes) EXPECT_TRUE(std::holds_alternative<Mesh>(shape.geometry));
  }
}

}  // namespace
}  // namespace twopass
