#include "radiosity/display_mesh.h"

#include <map>

#include <gtest/gtest.h>

#include "radiosity/subdivision.h"
#include "tests/radiosity/test_scenes.h"
#include "tests/radiosity/walls.h"

namespace twopass {
namespace {

Solution constant_solution(ElementMesh mesh, float irradiance) {
  std::vector<Irradiance> values(mesh.count(), {C3f(irradiance), C3f(0.0f)});
  return Solution(std::move(mesh), std::move(values), {});
}

using Point = std::tuple<float, float, float>;
Point point(const V3f& p) { return {p.x, p.y, p.z}; }

// How often each edge is used in each direction, by position.
std::map<std::pair<Point, Point>, int> directed_edges(const DisplayMesh& mesh) {
  std::map<std::pair<Point, Point>, int> edges;
  for (const DisplaySide& side : mesh.sides)
    for (const V3u& t : side.triangle)
      for (int k = 0; k < 3; ++k) ++edges[{point(side.position[t[k]]), point(side.position[t[(k + 1) % 3]])}];
  return edges;
}

double area_of(const DisplayMesh& mesh) {
  double area = 0.0;
  for (const DisplaySide& side : mesh.sides)
    for (const V3u& t : side.triangle)
      area += 0.5 * double((side.position[t.y] - side.position[t.x])
                               .cross(side.position[t.z] - side.position[t.x])
                               .length());
  return area;
}

// Closed: every edge of every triangle runs once there and once back, whatever the grids, quad-trees and
// clusters, over creases and beside surfaces without elements too.
TEST(DisplayMesh, IsWatertightWhereTheSceneIs) {
  SceneDescription description = test::unit_room(C3f(0.5f), C3f(0.0f), C3f(0.0f));  // the ceiling is black
  description.materials.push_back(one_sided("mirror", Conductor{}));
  description.shapes[3].material = static_cast<std::uint32_t>(description.materials.size() - 1);
  const Scene scene(std::move(description));
  std::vector<ElementRoot> roots;
  std::vector<std::uint32_t> cluster;
  const std::uint16_t divisions[] = {5, 1, 3, 6, 4, 0, 0, 1};
  for (const std::uint32_t s : {0u, 2u, 4u, 5u})
    for (std::uint32_t t = 0; t < 2; ++t) {
      roots.push_back({s, t, 0, no_index, divisions[roots.size()], front});
      cluster.push_back(roots.back().divisions == 0 ? 0 : no_index);
    }
  const ElementMesh mesh(scene.shapes(), scene.description().materials, roots, cluster);
  for (const int splits : {0, 3}) {
    const DisplayMesh display =
        display_mesh(scene, constant_solution(test::split_at_random(mesh, splits, 0.3f), 1.0f));
    EXPECT_EQ(display.sides.size(), 6u);
    const auto edges = directed_edges(display);
    for (const auto& [edge, count] : edges) {
      EXPECT_EQ(count, 1);
      EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
    }
    EXPECT_NEAR(area_of(display), 6.0, 1e-5);
  }
}

TEST(DisplayMesh, SpheresAreClosedToo) {
  SceneDescription description;
  test::add_diffuse(description, "ball", Sphere{V3f(1, 2, 3), 2.0f, false}, C3f(0.5f));
  description.materials.push_back(one_sided("mirror", Conductor{}));
  description.shapes.push_back({"mirror", Sphere{V3f(-3, 0, 0), 1.0f, false}, 1, {}});
  const Scene scene(std::move(description));
  const ElementMesh mesh = test::split_at_random(divide_surfaces(scene, 100), 2, 0.3f);
  const auto edges = directed_edges(display_mesh(scene, constant_solution(mesh, 1.0f)));
  EXPECT_GT(edges.size(), 1000u);
  for (const auto& [edge, count] : edges) EXPECT_EQ(count + int(edges.count({edge.second, edge.first})), 2);
}

// With and without elements; seams around a cylinder and between the quarters of a disk are none.
TEST(DisplayMesh, AnalyticSurfacesAreWholeAndRightSideOut) {
  const std::array<V3f, 3> axes{V3f(0, 0, 1), V3f(1, 0, 0), V3f(0, 1, 0)};
  const std::array<V3f, 3> mirrored{axes[1], axes[0], axes[2]};
  const std::array<C3f, 2> dark{C3f(0.0f), C3f(0.0f)};
  SceneDescription description;
  description.materials = {one_sided("grey", Diffuse{C3f(0.5f)}), one_sided("mirror", Conductor{})};
  const V3f middle(1, 2, 3);
  for (const std::uint32_t material : {0u, 1u})
    for (const bool inward : {false, true}) {
      description.shapes.push_back({"sphere", Sphere{middle, 2.0f, inward}, material, dark});
      description.shapes.push_back({"disk", Disk{middle, V3f(2, 0, 0), V3f(0, 1, 0), inward}, material, dark});
      description.shapes.push_back({"cylinder", Cylinder{middle, 0.5f, 2.0f, inward, axes}, material, dark});
      description.shapes.push_back(
          {"cylinder", Cylinder{middle, 0.5f, 2.0f, inward, mirrored}, material, dark});
    }
  for (const Shape& shape : description.shapes) {
    SceneDescription one;
    one.materials = description.materials;
    one.shapes = {shape};
    const Scene scene(one);
    const ElementMesh mesh = test::split_at_random(divide_surfaces(scene, 200), 2, 0.3f);
    const DisplayMesh display = display_mesh(scene, constant_solution(mesh, 1.0f));
    ASSERT_EQ(display.sides.size(), 1u);
    std::size_t border = 0;
    const auto edges = directed_edges(display);
    for (const auto& [edge, count] : edges) {
      EXPECT_EQ(count, 1);
      border += edges.count({edge.second, edge.first}) == 0;
    }
    // Round the rim of a disk, and twice round a cylinder.
    EXPECT_EQ(border > 0, shape.name != "sphere");
    EXPECT_LT(border, edges.size() / 4);
    const DisplaySide& side = display.sides[0];
    for (const V3u& t : side.triangle) {
      const V3f normal =
          (side.position[t.y] - side.position[t.x]).cross(side.position[t.z] - side.position[t.x]);
      V3f outward = side.position[t.x] + side.position[t.y] + side.position[t.z] - middle * 3.0f;
      if (shape.name == "disk") outward = V3f(0, 0, 1);
      if (shape.name == "cylinder") outward.y = 0.0f;
      const bool is_inward = std::visit(
          [](const auto& kind) {
            if constexpr (requires { kind.inward; }) return kind.inward;
            if constexpr (requires { kind.reversed; }) return kind.reversed;
            return false;
          },
          shape.geometry);
      ASSERT_GT(normal.dot(outward) * (is_inward ? -1.0f : 1.0f), 0.0f) << shape.name;
    }
  }
}

TEST(DisplayMesh, TrianglesRunCounterClockwiseSeenFromTheirSide) {
  SceneDescription description;
  description.materials = {two_sided("both", Diffuse{C3f(0.8f)}, Diffuse{C3f(0.4f)})};
  description.shapes = {{"sheet", test::quad(V3f(0.0f), V3f(1, 0, 0), V3f(0, 1, 0)), 0, {}}};
  const Scene scene(std::move(description));
  const DisplayMesh display = display_mesh(scene, constant_solution(divide_surfaces(scene, 100), 1.0f));
  ASSERT_EQ(display.sides.size(), 2u);
  for (const DisplaySide& side : display.sides)
    for (const V3u& t : side.triangle) {
      const V3f normal =
          (side.position[t.y] - side.position[t.x]).cross(side.position[t.z] - side.position[t.x]);
      EXPECT_GT(normal.z * (side.side == front ? 1.0f : -1.0f), 0.0f);
    }
  // 0.8 / pi is the brightest and becomes 0.8; the back has half of it.
  EXPECT_NEAR(display.exposure, pi, 1e-6);
  EXPECT_NEAR(display.sides[0].color[0].x, 0.8f, 1e-6f);
  EXPECT_NEAR(display.sides[1].color[0].x, 0.4f, 1e-6f);
}

TEST(DisplayMesh, ShowsLampsMirrorsAndBlackThingsWithoutElements) {
  SceneDescription description = test::lit_room();
  description.shapes.back().radiance[front] = C3f(1.0f, 0.5f, 0.0f);
  description.materials.push_back(interface_material("glass", Dielectric{}));
  const auto glass = static_cast<std::uint32_t>(description.materials.size() - 1);
  description.shapes.push_back({"glass", Sphere{V3f(0.3f, 0.2f, 0.2f), 0.1f, false}, glass, {}});
  test::add_diffuse(description, "black", test::quad(V3f(0.6f, 0.6f, 0.2f), V3f(0.1f, 0, 0), V3f(0, 0.1f, 0)),
                    C3f(0.0f));
  const Scene scene(std::move(description));
  const DisplayMesh display = display_mesh(scene, constant_solution(divide_surfaces(scene, 500), 1.0f));
  std::map<std::string, std::vector<C3f>> color;
  for (const DisplaySide& side : display.sides) {
    EXPECT_EQ(side.position.size(), side.color.size());
    for (const C3f& c : side.color) {
      EXPECT_GE(std::min({c.x, c.y, c.z}), 0.0f);
      EXPECT_LE(std::max({c.x, c.y, c.z}), 1.0f);
      color[scene.shapes()[side.shape].name].push_back(c);
    }
  }
  EXPECT_EQ(color.count("lamp") + color.count("glass") + color.count("black") + color.count("box"), 4u);
  EXPECT_NEAR(color["floor"][0].x, 0.8f, 1e-6f);
  EXPECT_EQ(color["lamp"][0], C3f(1.0f, 0.5f, 0.0f));  // too bright: keeps its hue
  EXPECT_NEAR(color["glass"][0].x, 0.18f, 1e-6f);
  EXPECT_EQ(color["black"][0], C3f(0.0f));
}

TEST(DisplayMesh, DarkAndEmptyScenesAreNoTrouble) {
  const Scene empty{SceneDescription{}};
  EXPECT_TRUE(display_mesh(empty, solve_radiosity(empty)).sides.empty());
  const Scene night(test::unit_room(C3f(0.5f), C3f(0.0f), C3f(0.5f)));
  const DisplayMesh dark = display_mesh(night, constant_solution(divide_surfaces(night, 50), 0.0f));
  EXPECT_EQ(dark.exposure, 1.0);
  for (const DisplaySide& side : dark.sides)
    for (const C3f& c : side.color) EXPECT_EQ(c, C3f(0.0f));
}

}  // namespace
}  // namespace twopass
