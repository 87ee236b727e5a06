#include "render/load/mitsuba_shapes.h"

#include "render/scene/geometry.h"
#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

class MitsubaShapes : public LoadTest {
 protected:
  LoadedScene read(const std::string& body) const {
    return load_xml("<scene version='3.0.0'>\n" + body + "\n</scene>");
  }
  Shape shape(const std::string& body) const { return read(body).scene.shapes.at(0); }
  Mesh mesh(const std::string& body) const { return std::get<Mesh>(shape(body).geometry); }
};

const std::string mirror_x = "<transform name='to_world'><scale x='-1'/></transform>";
const std::string flipped = "<boolean name='flip_normals' value='true'/>";

TEST_F(MitsubaShapes, RectangleFacesUp) {
  const Mesh m = mesh("<shape type='rectangle'/>");
  EXPECT_EQ(m.positions.size(), 4u);
  EXPECT_EQ(m.triangles.size(), 2u);
  EXPECT_TRUE(m.normals.empty());
  EXPECT_NEAR(area_of(m), 4.0, 1e-6);
  for (std::size_t t = 0; t < 2; ++t) expect_near(normal_of(m, t), {0, 0, 1});
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(m.uvs[i].x, 0.5f * (m.positions[i].x + 1.0f));
    EXPECT_EQ(m.uvs[i].y, 0.5f * (m.positions[i].y + 1.0f));
  }
}

TEST_F(MitsubaShapes, CubeFacesOutwards) {
  const Mesh m = mesh("<shape type='cube'/>");
  EXPECT_EQ(m.triangles.size(), 12u);
  EXPECT_NEAR(area_of(m), 24.0, 1e-5);
  V3f sum(0.0f);
  for (std::size_t t = 0; t < 12; ++t) {
    const V3f center =
        (m.positions[m.triangles[t].x] + m.positions[m.triangles[t].y] + m.positions[m.triangles[t].z]) / 3.0f;
    EXPECT_NEAR(normal_of(m, t).dot(center), 1.0f, 1e-6f);
    sum += normal_of(m, t);
  }
  expect_near(sum, V3f(0.0f));
}

TEST_F(MitsubaShapes, FrontsSurviveMirrorsAndFlip) {
  expect_near(normal_of(mesh("<shape type='rectangle'>" + mirror_x + "</shape>"), 0), {0, 0, 1});
  expect_near(normal_of(mesh("<shape type='rectangle'>" + flipped + "</shape>"), 0), {0, 0, -1});
  expect_near(normal_of(mesh("<shape type='rectangle'>" + flipped + mirror_x + "</shape>"), 0), {0, 0, -1});
  // Mirrored along its own normal, a rectangle looks the other way.
  const std::string mirror_z = "<transform name='to_world'><scale z='-1'/></transform>";
  expect_near(normal_of(mesh("<shape type='rectangle'>" + mirror_z + "</shape>"), 0), {0, 0, -1});
  const Mesh cube = mesh("<shape type='cube'>" + mirror_x + "</shape>");
  for (std::size_t t = 0; t < 12; ++t)
    EXPECT_GT(normal_of(cube, t).dot(cube.positions[cube.triangles[t].x]), 0.0f);
}

TEST_F(MitsubaShapes, PositionsAreRoundedOnce) {
  // In float the translation would swallow the rectangle's size before the second step gives it back.
  const Mesh m = mesh(
      "<shape type='rectangle'><transform name='to_world'><translate x='1e9'/><translate x='-1e9'/>"
      "</transform></shape>");
  EXPECT_EQ(m.positions[0].x, -1.0f);
}

TEST_F(MitsubaShapes, SphereByCenterRadiusAndTransform) {
  const auto sphere = std::get<Sphere>(
      shape("<shape type='sphere'><point name='center' value='1, 0, 0'/><float name='radius' value='0.5'/>"
            "<transform name='to_world'><scale value='2'/><rotate z='1' angle='90'/><translate "
            "z='7'/></transform></shape>")
          .geometry);
  expect_near(sphere.center, {0, 2, 7});
  EXPECT_FLOAT_EQ(sphere.radius, 1.0f);
  EXPECT_FALSE(sphere.inward);
  EXPECT_TRUE(std::get<Sphere>(shape("<shape type='sphere'>" + flipped + "</shape>").geometry).inward);
  EXPECT_FALSE(std::get<Sphere>(shape("<shape type='sphere'>" + mirror_x + "</shape>").geometry).inward);
}

TEST_F(MitsubaShapes, SpheresStayRound) {
  for (const char* steps : {"<scale x='2'/>", "<matrix value='1 0.1 0 0 1 0 0 0 1'/>", "<scale value='0'/>"})
    expect_error(
        [&] {
          shape("<shape type='sphere'>\n<transform name='to_world'>" + std::string(steps) +
                "</transform></shape>");
        },
        {"scene.xml:3: a sphere cannot be scaled differently along its axes"});
  expect_error([&] { shape("<shape type='sphere'>\n<float name='radius' value='0'/></shape>"); },
               {"scene.xml:3: a sphere's radius must be positive"});
  expect_error([&] { shape("<shape type='sphere'><float name='radius' value='1e20'/></shape>"); },
               {"too large"});
}

TEST_F(MitsubaShapes, DisksByTransform) {
  const auto disk = [&](const std::string& steps) {
    return std::get<Disk>(
        shape("<shape type='disk'><transform name='to_world'>" + steps + "</transform></shape>").geometry);
  };
  const Disk plain = std::get<Disk>(shape("<shape type='disk'/>").geometry);
  expect_near(unit_normal(plain), {0, 0, 1});
  EXPECT_NEAR(area_of(plain), pi, 1e-6);
  const Disk moved = disk("<rotate x='1' angle='90'/><scale value='0.6'/><translate x='1' y='3.4' z='-1'/>");
  expect_near(unit_normal(moved), {0, -1, 0});
  expect_near(moved.center, {1, 3.4f, -1});
  EXPECT_NEAR(area_of(moved), 0.36 * pi, 1e-5);
  // The normal is that of +z, through mirrors too; flip_normals turns it.
  expect_near(unit_normal(disk("<scale x='-1'/>")), {0, 0, 1});
  expect_near(unit_normal(disk("<scale z='-1'/>")), {0, 0, -1});
  expect_near(unit_normal(std::get<Disk>(shape("<shape type='disk'>" + flipped + "</shape>").geometry)),
              {0, 0, -1});
  EXPECT_NEAR(area_of(disk("<scale x='3'/>")), 3.0 * pi, 1e-5);  // an ellipse
  expect_error([&] { disk("<scale x='0'/>"); }, {"scene.xml:2", "no area"});
  expect_error([&] { disk("<translate x='1e15'/>"); }, {"scene.xml:2", "too far away"});
}

TEST_F(MitsubaShapes, CylindersByTheirEndsAndTransform) {
  const std::string ends =
      "<point name='p0' x='1' y='0' z='0'/><point name='p1' x='1' y='2' z='0'/><float name='radius' "
      "value='0.5'/>";
  const auto cylinder = [&](const std::string& steps) {
    return std::get<Cylinder>(
        shape("<shape type='cylinder'>" + ends + "<transform name='to_world'>" + steps + "</transform></shape>")
            .geometry);
  };
  const Cylinder plain = std::get<Cylinder>(shape("<shape type='cylinder'/>").geometry);
  EXPECT_EQ(plain.length, 1.0f);
  EXPECT_EQ(plain.radius, 1.0f);
  expect_near(plain.axes[2], {0, 0, 1});
  const Cylinder moved = cylinder("<scale value='2'/><rotate z='1' angle='90'/>");
  expect_near(moved.base, {0, 2, 0});
  expect_near(moved.axes[2], {-1, 0, 0});
  EXPECT_FLOAT_EQ(moved.length, 4.0f);
  EXPECT_FLOAT_EQ(moved.radius, 1.0f);
  EXPECT_FALSE(moved.inward);
  EXPECT_FLOAT_EQ(cylinder("<scale y='3'/>").length, 6.0f);  // along the axis
  EXPECT_TRUE(std::get<Cylinder>(shape("<shape type='cylinder'>" + flipped + "</shape>").geometry).inward);
  expect_error([&] { cylinder("<scale x='3'/>"); }, {"scene.xml:2", "what is none"});
  expect_error([&] { cylinder("<matrix value='1 0.3 0 0 1 0 0 0 1'/>"); }, {"scene.xml:2", "what is none"});
  expect_error([&] { shape("<shape type='cylinder'>\n<float name='radius' value='-1'/></shape>"); },
               {"scene.xml:3"});
  expect_error([&] { shape("<shape type='cylinder'>\n<point name='p1' value='0'/></shape>"); },
               {"scene.xml:3", "must differ"});
}

const std::string coloured_ply =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty "
    "float u\n"
    "property float v\nproperty float r\nproperty float g\nproperty float b\nelement face 2\n"
    "property list uchar int vertex_indices\nproperty float heat\nend_header\n"
    "0 0 0 0 0.25 1 0 0\n1 0 0 1 0.25 0 1 0\n1 1 1 1 1 0 0 1\n0 1 0 0 1 2 2 2\n3 0 1 2 0.25\n3 0 2 3 3\n";

// Without normals they are computed, smooth; v is turned only where that is asked for.
TEST_F(MitsubaShapes, PlyByMitsubasRules) {
  write("m.ply", coloured_ply);
  const std::string open = "<shape type='ply'><string name='filename' value='m.ply'/>";
  const Mesh smooth = mesh(open + "</shape>");
  EXPECT_EQ(smooth.normals.size(), 4u);
  EXPECT_EQ(smooth.uvs[0], V2f(0, 0.25f));
  EXPECT_TRUE(mesh(open + "<boolean name='face_normals' value='true'/></shape>").normals.empty());
  EXPECT_EQ(mesh(open + "<boolean name='flip_tex_coords' value='true'/></shape>").uvs[0], V2f(0, 0.75f));
  EXPECT_LT(normal_of(mesh(open + flipped + "</shape>"), 0).z, 0.0f);
  expect_error([&] { mesh("<shape type='ply'/>"); }, {"scene.xml:2: shape 'ply' has no filename"});
  expect_error([&] { mesh(open + "<float name='size' value='1'/></shape>"); }, {"flip_tex_coords"});
}

TEST_F(MitsubaShapes, MeshAttributesColourMaterials) {
  write("m.ply", coloured_ply);
  const auto with = [&](const std::string& attribute, const std::string& more = "") {
    return "<shape type='ply'><string name='filename' value='m.ply'/><bsdf type='diffuse'>"
           "<texture name='reflectance' type='mesh_attribute'><string name='name' value='" +
           attribute + "'/>" + more + "</texture></bsdf></shape>";
  };
  const auto albedo = [](const LoadedScene& loaded, std::uint32_t triangle, const V2f& at) {
    const Material& material = loaded.scene.materials[loaded.scene.shapes[0].material];
    return material.side[front].diffuse_reflectance({V2f(0, 0), V2f(0, 0), {triangle, at}});
  };
  const LoadedScene vertices = read(with("vertex_color"));
  expect_near(albedo(vertices, 0, {0.25f, 0.25f}), {0.5f, 0.25f, 0.25f});
  expect_near(albedo(vertices, 1, {0, 1}), V3f(1.0f));  // a reflectance has no more
  EXPECT_TRUE(std::get<Mesh>(vertices.scene.shapes[0].geometry).attributes.empty());
  const LoadedScene faces = read(with("face_heat", "<float name='scale' value='2'/>"));
  expect_near(albedo(faces, 0, {0.3f, 0.3f}), V3f(0.5f));
  expect_near(albedo(faces, 1, {0.3f, 0.3f}), V3f(1.0f));
  // Means over the area: both triangles are of about one size.
  const Material& material = faces.scene.materials[faces.scene.shapes[0].material];
  EXPECT_NEAR(material.side[front].traits().mean_diffuse_reflectance.x, 0.75f, 1e-6f);
  // Of lamps, too.
  const Shape lamp = shape(
      "<shape type='ply'><string name='filename' value='m.ply'/><emitter type='area'><texture name='radiance' "
      "type='mesh_attribute'><string name='name' value='face_heat'/></texture></emitter></shape>");
  EXPECT_NEAR(lamp.radiance[front].x, 1.625f, 1e-5f);

  expect_error([&] { read(with("vertex_heat")); },
               {"scene.xml:2", "no attribute 'vertex_heat'", "vertex_color, face_heat"});
  expect_error([&] { read(with("heat")); }, {"scene.xml:2", "vertex_ or face_"});
  std::string sphere = with("vertex_color");
  sphere.replace(sphere.find("ply"), 3, "sphere");
  sphere.erase(sphere.find("<string"), sphere.find("<bsdf") - sphere.find("<string"));
  expect_error([&] { read(sphere); }, {"scene.xml:2", "is no mesh", "vertex_color"});
}

TEST_F(MitsubaShapes, EmittersShineFromTheFront) {
  const Shape lamp = shape(
      "<shape type='rectangle'><emitter type='area'><rgb name='radiance' value='17 12 4'/>"
      "<float name='sampling_weight' value='2'/></emitter></shape>");
  EXPECT_EQ(lamp.radiance[front], C3f(17, 12, 4));
  EXPECT_EQ(lamp.radiance[back], C3f(0.0f));
  EXPECT_EQ(shape("<shape type='cube'><emitter type='area'/></shape>").radiance[front], C3f(1.0f));
  EXPECT_FALSE(is_emitter(shape("<shape type='cube'/>")));
  expect_error([&] { shape("<shape type='cube'>\n<emitter type='point'/></shape>"); },
               {"scene.xml:3: emitter 'point' is not supported; supported emitters: area"});
  expect_error([&] { shape("<shape type='cube'>\n<emitter type='area'/>\n<emitter type='area'/></shape>"); },
               {"scene.xml:4: a second <emitter> in shape 'cube'"});
  expect_error(
      [&] {
        shape("<shape type='cube'><emitter type='area'>\n<transform name='to_world'/></emitter></shape>");
      },
      {"scene.xml:3: emitter 'area' has no property 'to_world'; its properties: radiance"});
}

TEST_F(MitsubaShapes, NamesAreIdsOrNumbered) {
  const LoadedScene loaded = read("<shape type='cube' id='box'/><shape type='cube'/><shape type='sphere'/>");
  EXPECT_EQ(loaded.scene.shapes[0].name, "box");
  EXPECT_EQ(loaded.scene.shapes[1].name, "cube-2");
  EXPECT_EQ(loaded.scene.shapes[2].name, "sphere-3");
}

TEST_F(MitsubaShapes, ShapesWithoutAreaAreLeftOut) {
  const LoadedScene loaded =
      read("<shape type='rectangle' id='line'><transform name='to_world'><scale x='0'/></transform></shape>");
  EXPECT_TRUE(loaded.scene.shapes.empty());
  EXPECT_TRUE(has_note(loaded, "triangles of shape 'line' without area are left out"));
}

TEST_F(MitsubaShapes, UnsupportedShapesAreRefused) {
  expect_error([&] { shape("<shape type='sdfgrid'/>"); }, {"scene.xml:2", "sdfgrid", "not supported"});
  expect_error([&] { shape("<shape type='cube'><ref id='none'/></shape>"); }, {"no object with the id 'none'"});
  expect_error([&] { shape("<shape type='cube'>\n<medium type='homogeneous' name='interior'/></shape>"); },
               {"scene.xml:3: a <medium> inside shape 'cube' is not supported"});
}

/// A roof: two squares that meet at a right angle in the edge 1 2.
constexpr std::string_view roof = "v 0 0 0\nv 0 1 0\nv 1 0 0\nv 1 1 0\nv 0 0 -1\nv 0 1 -1\n";

TEST_F(MitsubaShapes, ObjNormalsAreComputedUnlessFacesAreWanted) {
  write("roof.obj", std::string(roof) + "f 1 3 4 2\nf 5 1 2 6\n");
  const std::string file = "<string name='filename' value='roof.obj'/>";
  const Mesh smooth = mesh("<shape type='obj'>" + file + "</shape>");
  ASSERT_EQ(smooth.normals.size(), 6u);
  expect_near(smooth.normals[0], V3f(-1, 0, 1).normalized());
  const Mesh flat = mesh("<shape type='obj'>" + file + "<boolean name='face_normals' value='true'/></shape>");
  EXPECT_TRUE(flat.normals.empty());
  EXPECT_EQ(flat.triangles.size(), 4u);
}

TEST_F(MitsubaShapes, ObjNormalsDecideWhereTheFrontIs) {
  write("down.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 -1\nvn 0.6 0 -0.8\nf 1//1 2//2 3//1\n");
  const std::string file = "<string name='filename' value='down.obj'/>";
  expect_near(normal_of(mesh("<shape type='obj'>" + file + "</shape>"), 0), {0, 0, -1});
  expect_near(normal_of(mesh("<shape type='obj'>" + file + mirror_x + "</shape>"), 0), {0, 0, -1});
  const Mesh turned = mesh("<shape type='obj'>" + file + flipped + "</shape>");
  expect_near(normal_of(turned, 0), {0, 0, 1});
  expect_near(turned.normals[0], {0, 0, 1});
  // Without its normals the winding counts, and a mirror turns it over, as in Mitsuba.
  const std::string faces = "<boolean name='face_normals' value='true'/>";
  expect_near(normal_of(mesh("<shape type='obj'>" + file + faces + "</shape>"), 0), {0, 0, 1});
  expect_near(normal_of(mesh("<shape type='obj'>" + file + faces + mirror_x + "</shape>"), 0), {0, 0, -1});
}

TEST_F(MitsubaShapes, ObjTextureCoordinatesAreFlippedUnlessTold) {
  write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.25 0.25\nf 1/1 2/1 3/1\n");
  const std::string file = "<string name='filename' value='t.obj'/>";
  EXPECT_EQ(mesh("<shape type='obj'>" + file + "</shape>").uvs[0], V2f(0.25f, 0.75f));
  EXPECT_EQ(
      mesh("<shape type='obj'>" + file + "<boolean name='flip_tex_coords' value='false'/></shape>").uvs[0],
      V2f(0.25f, 0.25f));
}

TEST_F(MitsubaShapes, ObjIgnoresMaterialsAndGroups) {
  write("a.obj",
        "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\ng a\nusemtl x\nf 1 2 3\ng b\nusemtl y\nf 1 2 3\n");
  const LoadedScene loaded = read("<shape type='obj'><string name='filename' value='a.obj'/></shape>");
  EXPECT_EQ(loaded.scene.shapes.size(), 1u);
  EXPECT_TRUE(loaded.notes.empty());
}

TEST_F(MitsubaShapes, LargeMeshesOfOneFileAreStoredOnce) {
  std::string strip;
  for (int i = 0; i < 302; ++i)
    strip += "v " + std::to_string(i) + ' ' + std::to_string(i % 2) + ' ' + std::to_string(i % 7) + '\n';
  for (int i = 1; i <= 300; ++i)
    strip += "f " + std::to_string(i) + ' ' + std::to_string(i + 1) + ' ' + std::to_string(i + 2) + '\n';
  write("strip.obj", strip);
  const auto shape = [](const std::string& transform, const std::string& more = "") {
    return "<shape type='obj'><string name='filename' value='strip.obj'/><transform name='to_world'>" +
           transform + "</transform>" + more + "</shape>";
  };
  const std::vector<std::string> transforms{"<translate x='1'/>",
                                            "<rotate y='1' angle='30'/><scale value='2'/>", "<scale x='-1'/>",
                                            "<scale x='2'/>"};
  std::string all;
  for (const std::string& transform : transforms) all += shape(transform);
  all += shape("", "<emitter type='area'/>");
  all += "<shape type='shapegroup' id='g'>" + shape("") + shape("") +
         "</shape><shape type='instance'><ref id='g'/></shape>";
  const LoadedScene loaded = load_xml("<scene version='3.0.0'>" + all + "</scene>");
  ASSERT_EQ(loaded.scene.shapes.size(), 7u);
  std::vector<const Mesh*> meshes;
  for (const Shape& s : loaded.scene.shapes) meshes.push_back(mesh_of(s.geometry));
  EXPECT_EQ(meshes[0], meshes[1]);
  for (std::size_t s = 2; s < 5; ++s)  // mirrored, stretched, a lamp
    EXPECT_TRUE(std::holds_alternative<Mesh>(loaded.scene.shapes[s].geometry)) << s;
  for (std::size_t s = 0; s < transforms.size(); ++s) {
    const LoadedScene alone = load_xml("<scene version='3.0.0'>" + shape(transforms[s]) + "</scene>");
    for (std::uint32_t t = 0; t < 300; ++t) {
      const auto a = corners(loaded.scene.shapes[s].geometry, t),
                 b = corners(alone.scene.shapes[0].geometry, t);
      for (std::size_t k = 0; k < 3; ++k) expect_near(a[k], b[k], 1e-3f);
    }
  }
}

TEST_F(MitsubaShapes, ObjErrorsNameTheirFiles) {
  write("bad.obj", "v 0 0 0\nf 1 2 3\n");
  expect_error([&] { shape("<shape type='obj'><string name='filename' value='bad.obj'/></shape>"); },
               {"bad.obj:2: "});
  expect_error([&] { shape("<shape type='obj'>\n<string name='filename' value='none.obj'/></shape>"); },
               {"scene.xml:3: there is no file 'none.obj'"});
  expect_error([&] { shape("<shape type='obj'/>"); }, {"scene.xml:2: shape 'obj' has no filename"});
}

}  // namespace
}  // namespace twopass
