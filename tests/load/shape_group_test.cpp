#include "render/load/shape_group.h"

#include "render/scene/geometry.h"
#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

class ShapeGroups : public LoadTest {
 protected:
  LoadedScene read(const std::string& body) const {
    return load_xml("<scene version='3.0.0'>\n" + body + "\n</scene>");
  }
};

const std::string group =
    "<shape type='shapegroup' id='g'><shape type='rectangle' id='r'><bsdf type='diffuse' id='grey'/></shape>"
    "<shape type='sphere' id='s'><float name='radius' value='0.5'/></shape><shape type='disk' id='d'/></shape>";
std::string instance(const std::string& steps) {
  return "<shape type='instance'><ref id='g'/><transform name='to_world'>" + steps + "</transform></shape>";
}

TEST_F(ShapeGroups, ShapesStandWhereTheirInstancesSay) {
  const LoadedScene loaded =
      read(group + instance("<translate x='5'/>") + instance("<rotate y='1' angle='90'/><scale value='2'/>"));
  ASSERT_EQ(loaded.scene.shapes.size(), 6u);
  const auto& a = std::get<MeshInstance>(loaded.scene.shapes[0].geometry);
  const auto& b = std::get<MeshInstance>(loaded.scene.shapes[3].geometry);
  EXPECT_EQ(a.mesh.get(), b.mesh.get());
  EXPECT_EQ(loaded.scene.shapes[0].name, "instance-1/r");
  EXPECT_EQ(loaded.scene.shapes[0].material, loaded.scene.shapes[3].material);
  expect_near(a.to_world.point(V3f(1, 1, 0)), V3f(6, 1, 0));
  expect_near(b.to_world.point(V3f(1, 1, 0)), V3f(0, 2, -2));
  // Under similarities, spheres and disks are what they are.
  const auto& sphere = std::get<Sphere>(loaded.scene.shapes[4].geometry);
  EXPECT_FLOAT_EQ(sphere.radius, 1.0f);
  expect_near(unit_normal(std::get<Disk>(loaded.scene.shapes[5].geometry)), V3f(1, 0, 0));
  EXPECT_NEAR(area_of(std::get<Disk>(loaded.scene.shapes[5].geometry)), 4.0 * pi, 1e-5);
}

// The front of a mirror image is the mirror image of the front.
TEST_F(ShapeGroups, MirrorImagesKeepTheirFronts) {
  const LoadedScene loaded =
      read(group + instance("<scale x='-1'/><translate x='3'/>") + instance("<scale z='-1'/>"));
  for (const std::size_t first : {0u, 3u}) {
    const Geometry& mesh = loaded.scene.shapes[first].geometry;
    const V3f expected(0, 0, first == 0 ? 1.0f : -1.0f);
    const std::array<V3f, 3> p = corners(mesh, 0);
    expect_near(unit((p[1] - p[0]).cross(p[2] - p[0])), expected);
    const Placement& place = std::get<MeshInstance>(mesh).to_world;
    EXPECT_GT(place.x.cross(place.y).dot(place.z), 0.0f);
    expect_near(unit_normal(std::get<Disk>(loaded.scene.shapes[first + 2].geometry)), expected);
  }
  expect_near(bounds_of({&loaded.scene.shapes[0], 1}).min, V3f(2, -1, 0));
}

TEST_F(ShapeGroups, StretchedSpheresBecomeMeshes) {
  const LoadedScene loaded = read(group + instance("<scale x='3'/>"));
  EXPECT_TRUE(has_note(loaded, "'s' is stretched and becomes a mesh"));
  const Shape& shape = loaded.scene.shapes[1];
  const auto& ellipsoid = std::get<MeshInstance>(shape.geometry);
  EXPECT_NEAR(bounds_of({&shape, 1}).max.x, 1.5f, 1e-5f);
  for (std::uint32_t t = 0; t < ellipsoid.mesh->triangles.size(); ++t) {
    const std::array<V3f, 3> p = corners(shape.geometry, t);
    EXPECT_GT((p[1] - p[0]).cross(p[2] - p[0]).dot(p[0]), 0.0f);
    const V3f s(p[0].x / 1.5f, p[0].y / 0.5f, p[0].z / 0.5f);
    EXPECT_NEAR(s.length(), 1.0f, 1e-5f);
  }
  EXPECT_TRUE(std::holds_alternative<Disk>(loaded.scene.shapes[2].geometry));  // an ellipse
}

TEST_F(ShapeGroups, GroupsMayFollowTheirInstancesAndStayUnseen) {
  EXPECT_EQ(read(instance("<translate x='5'/>") + group).scene.shapes.size(), 3u);
  EXPECT_EQ(read(group).scene.shapes.size(), 0u);
}

TEST_F(ShapeGroups, WhatCannotBeIsNamed) {
  expect_error([&] { read(group + instance("<scale x='0'/>")); }, {"scene.xml:2", "flattens"});
  expect_error([&] { read(group + instance("<translate x='1e13'/>")); }, {"scene.xml:2", "1e12"});
  expect_error([&] { read("<shape type='instance'/>"); }, {"scene.xml:2", "one shapegroup"});
  expect_error([&] { read("<shape type='sphere' id='s'/><shape type='instance'><ref id='s'/></shape>"); },
               {"scene.xml:2", "one shapegroup"});
  expect_error([&] { read("<shape type='shapegroup' id='g'/>"); }, {"scene.xml:2", "without shapes"});
  expect_error(
      [&] {
        read("<shape type='shapegroup' id='g'>\n<shape type='sphere'>\n<emitter type='area'/></shape></shape>");
      },
      {"scene.xml:4", "emitter in a shapegroup"});
  expect_error([&] { read(group + "<shape type='shapegroup' id='h'>\n" + instance("") + "</shape>"); },
               {"scene.xml:3", "not nested"});
  expect_error([&] { read(group + "<shape type='shapegroup' id='h'>\n<shape type='shapegroup'/></shape>"); },
               {"scene.xml:3", "not nested"});
  expect_error(
      [&] { read(group + "<shape type='instance'><ref id='g'/><float name='size' value='1'/></shape>"); },
      {"size"});
}

}  // namespace
}  // namespace twopass
