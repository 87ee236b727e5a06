#include "render/load/mitsuba_scene.h"

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

class MitsubaScene : public LoadTest {
 protected:
  LoadedScene read(const std::string& body) const {
    return load_xml("<scene version='3.0.0'>\n" + body + "\n</scene>");
  }
};

TEST_F(MitsubaScene, AnEmptySceneIsAScene) {
  const LoadedScene loaded = read("");
  EXPECT_TRUE(loaded.scene.shapes.empty());
  EXPECT_TRUE(loaded.notes.empty());
}

TEST_F(MitsubaScene, ConstantEmittersAreTheEnvironment) {
  EXPECT_TRUE(read("").scene.environment.is_black());
  EXPECT_EQ(read("<emitter type='constant'><rgb name='radiance' value='1 2 3'/></emitter>")
                .scene.environment.constant(),
            C3f(1, 2, 3));
  EXPECT_EQ(read("<emitter type='constant'/>").scene.environment.constant(), C3f(1.0f));
  expect_error([&] { read("<emitter type='constant'/>\n<emitter type='constant'/>"); },
               {"scene.xml:3: a second environment, the first is 'constant' at", "scene.xml:2"});
}

// Where a scene lies far away, floats have no digits for it: it is read about a point of its own. Nothing is
// lost of what transforms in the file say, and all of it stays where it was.
TEST_F(MitsubaScene, FarFromTheOriginLosesNothing) {
  const auto scene_at = [&](const std::string& offset) {
    const std::string moved = "<translate value='" + offset + "'/></transform>";
    return read(
               "<sensor type='perspective'><transform name='to_world'><lookat origin='.1,-.3,.2' "
               "target='.4,1,.3' up='0,0,1'/>" +
               moved + "</sensor><emitter type='spot'><transform name='to_world'><translate x='.3'/>" + moved +
               "</emitter><shape type='cube'><transform name='to_world'><scale value='.37'/><rotate z='1' "
               "angle='33'/>" +
               moved +
               "</shape><shape type='sphere'><float name='radius' value='.1'/><transform name='to_world'>" +
               "<translate y='.7'/>" + moved +
               "</shape><shape type='cylinder'><float name='radius' value='.1'/>" +
               "<transform name='to_world'>" + moved +
               "</shape><shape type='shapegroup' id='g'><shape type='cube'>" +
               "<transform name='to_world'><scale value='.1'/><translate x='.2'/></transform></shape></shape>" +
               "<shape type='instance'><ref id='g'/><transform name='to_world'>" + moved + "</shape>")
        .scene;
  };
  const V3d offset(1234567.0, -3456789.0, 4e6);
  const SceneDescription near = scene_at("0,0,0"), far = scene_at("1234567,-3456789,4e6");
  EXPECT_EQ(near.frame.origin, V3d(0.0));
  EXPECT_NE(far.frame.origin, V3d(0.0));
  ASSERT_EQ(near.shapes.size(), far.shapes.size());
  const auto expect_same_place = [&](const V3f& a, const V3f& b) {
    EXPECT_NEAR((far.frame.to_world(V3d(b)) - offset - V3d(a)).length(), 0.0, 1e-6);
  };
  const auto& cube = std::get<Mesh>(near.shapes[0].geometry).positions;
  for (std::size_t i = 0; i < cube.size(); ++i)
    expect_same_place(cube[i], std::get<Mesh>(far.shapes[0].geometry).positions[i]);
  expect_same_place(std::get<Sphere>(near.shapes[1].geometry).center,
                    std::get<Sphere>(far.shapes[1].geometry).center);
  expect_same_place(std::get<Cylinder>(near.shapes[2].geometry).base,
                    std::get<Cylinder>(far.shapes[2].geometry).base);
  const auto corner_of = [](const SceneDescription& scene) {
    const Shape& copy = scene.shapes[3];
    if (const auto* instance = std::get_if<MeshInstance>(&copy.geometry))
      return instance->to_world.point(instance->mesh->positions[0]);
    return std::get<Mesh>(copy.geometry).positions[0];
  };
  expect_same_place(corner_of(near), corner_of(far));
  expect_same_place(std::get<SpotLight>(near.punctual_lights[0]).frame.position,
                    std::get<SpotLight>(far.punctual_lights[0]).frame.position);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(near.camera->to_world[3][axis] + offset[axis],
                far.camera->to_world[3][axis] + far.frame.origin[axis], 1e-6);
}

TEST_F(MitsubaScene, AreaLightsBelongToShapes) {
  expect_error([&] { read("<emitter type='area'/>"); }, {"emitter 'area' outside of a shape"});
}

TEST_F(MitsubaScene, StrayElementsAreRefused) {
  expect_error([&] { read("<medium type='homogeneous' id='m'/>"); }, {"<medium> is not supported"});
  expect_error([&] { read("<float name='x' value='1'/>"); }, {"<float> outside of an object"});
}

TEST_F(MitsubaScene, SeveralSensorsLeaveTheFirst) {
  const LoadedScene loaded = read(
      "<sensor type='perspective'><float name='fov' value='10'/></sensor>"
      "<sensor type='perspective'><float name='fov' value='20'/></sensor>");
  EXPECT_EQ(loaded.scene.camera->fov_degrees, 10.0);
  EXPECT_TRUE(has_note(loaded, "several sensors; the first one is used"));
}

TEST_F(MitsubaScene, FilmsMayBeReferenced) {
  const LoadedScene loaded = read(
      "<film type='hdrfilm' id='f'><integer name='width' value='5'/></film>"
      "<sensor type='perspective'><ref id='f'/></sensor>");
  EXPECT_EQ(loaded.settings.width, 5);
}

TEST_F(MitsubaScene, MaterialsFailBeforeMeshesAreRead) {
  write("bad.obj", "not an obj");
  expect_error(
      [&] {
        read(
            "<shape type='obj'><string name='filename' value='bad.obj'/><ref id='p'/></shape>\n"
            "<bsdf type='hair' id='p'/>");
      },
      {"scene.xml:3: bsdf 'hair' is not supported"});
}

TEST_F(MitsubaScene, ParametersReachTheSettings) {
  const std::string text =
      "<scene version='3.0.0'><default name='spp' value='4'/><default name='i' value='path'/>"
      "<integrator type='$i'/><sensor type='perspective'><sampler type='independent'>"
      "<integer name='sample_count' value='$spp'/></sampler></sensor></scene>";
  EXPECT_EQ(load_xml(text).settings.samples_per_pixel, 4);
  const LoadedScene loaded = load_xml(text, {{"spp", "99"}, {"i", "unbiased"}});
  EXPECT_EQ(loaded.settings.samples_per_pixel, 99);
  EXPECT_EQ(loaded.settings.integrator, "unbiased");
}

TEST_F(MitsubaScene, OldVersionsLoad) {
  const LoadedScene loaded = load_xml(
      "<?xml version='1.0' encoding='utf-8'?>\n<scene version='0.6.0'><integrator type='path'>"
      "<integer name='maxDepth' value='65'/><integer name='rrDepth' value='9'/>"
      "<boolean name='strictNormals' value='true'/><boolean name='hideEmitters' value='true'/></integrator>"
      "<sensor type='perspective'><float name='fov' value='35'/><string name='fovAxis' value='y'/>"
      "<float name='nearClip' value='0.1'/><transform name='toWorld'><lookAt origin='0,0,5' target='0,0,0' "
      "up='0,1,0'/>"
      "</transform><film type='hdrfilm'><string name='fileFormat' value='openexr'/>"
      "<string name='componentFormat' value='float32'/><boolean name='attachLog' "
      "value='false'/></film></sensor>"
      "<shape type='rectangle'><boolean name='flipNormals' value='true'/><transform name='toWorld'><scale "
      "value='2'/>"
      "</transform></shape></scene>");
  EXPECT_EQ(loaded.settings.max_depth, 65);
  EXPECT_EQ(loaded.settings.rr_depth, 9);
  EXPECT_TRUE(loaded.settings.hide_emitters);
  EXPECT_EQ(loaded.settings.half, false);
  EXPECT_EQ(loaded.scene.camera->fov_axis, FovAxis::y);
  expect_near(normal_of(mesh_of(loaded), 0), {0, 0, -1});
  EXPECT_NEAR(area_of(mesh_of(loaded)), 16.0, 1e-5);
  EXPECT_TRUE(loaded.notes.empty());
}

}  // namespace
}  // namespace twopass
