#include "radiosity/element_tree.h"

#include <gtest/gtest.h>

#include "radiosity/subdivision.h"
#include "tests/radiosity/test_scenes.h"
#include "tests/support/crowded_room.h"

namespace twopass {
namespace {

// Large and small triangles, both sides of a sphere, and an odd number of divisions.
Scene mixed_scene() {
  SceneDescription description = test::lit_room();
  test::add_diffuse(description, "ball", Sphere{V3f(0.3f, 0.25f, 0.3f), 0.2f, false}, C3f(0.6f, 0.2f, 0.1f));
  description.materials.back().side[back] = description.materials.back().side[front];
  return Scene(std::move(description));
}

struct Fixture {
  Scene scene = mixed_scene();
  ElementMesh mesh;
  std::vector<C3f> reflectance;
  explicit Fixture(std::size_t elements) : mesh(divide_surfaces(scene, elements)) {
    for (std::uint32_t i = 0; i < mesh.count(); ++i) reflectance.push_back(mesh.reflectance(i));
  }
};

TEST(ElementTree, EveryElementIsInOneLeafAndNodesArePartitionedByTheirChildren) {
  const Fixture f(1500);
  const ElementTree tree(f.mesh, f.reflectance);
  std::vector<int> times(f.mesh.count(), 0);
  for (const std::uint32_t element : tree.order()) ++times[element];
  for (const int count : times) EXPECT_EQ(count, 1);
  EXPECT_EQ(tree.nodes().size(), tree.levels().back());
  std::size_t leaves = 0;
  for (std::uint32_t i = 0; i < tree.nodes().size(); ++i) {
    const TreeNode& node = tree.node(i);
    if (node.kind == TreeNode::element) {
      ++leaves;
      EXPECT_EQ(node.child_count, 0u);
      EXPECT_EQ(node.end, node.begin + 1);
      EXPECT_EQ(tree.leaf_of(tree.element_of(node)), i);
      continue;
    }
    std::uint32_t place = node.begin;
    for (std::uint32_t c = node.first_child; c < node.first_child + node.child_count; ++c) {
      EXPECT_GT(c, i);
      EXPECT_EQ(tree.node(c).parent, i);
      EXPECT_EQ(tree.node(c).begin, place);
      place = tree.node(c).end;
    }
    EXPECT_EQ(place, node.end);
  }
  EXPECT_EQ(leaves, f.mesh.count());
}

TEST(ElementTree, AreasAndReflectancesAreThoseOfTheElements) {
  Fixture f(1500);
  std::vector<float> exposed(f.mesh.count(), 1.0f);
  exposed[3] = 0.25f, exposed[100] = 0.0f;
  f.mesh.expose(exposed);
  const ElementTree tree(f.mesh, f.reflectance);
  for (const TreeNode& node : tree.nodes()) {
    double area = 0.0, whole = 0.0, red = 0.0;
    for (std::uint32_t k = node.begin; k < node.end; ++k) {
      const std::uint32_t e = tree.order()[k];
      area += f.mesh.area(e);
      whole += f.mesh.patch(e).area;
      red += f.mesh.area(e) * f.reflectance[e].x;
    }
    EXPECT_NEAR(node.area, area, 1e-12 * whole);
    EXPECT_NEAR(node.whole_area, whole, 1e-12 * whole);
    if (area > 0.0) {
      EXPECT_NEAR(node.reflectance.x, red / area, 1e-6);
    }
    // Pieces of the grid are polygons of the area of their elements.
    if (node.is_flat) {
      EXPECT_NEAR(polygon_area(tree.surface(node).polygon), whole, 1e-12 * whole);
    }
  }
}

TEST(ElementTree, NodesContainTheirElementsAndTheirNormals) {
  const Fixture f(1500);
  const ElementTree tree(f.mesh, f.reflectance);
  for (const TreeNode& node : tree.nodes()) {
    for (std::uint32_t k = node.begin; k < node.end; ++k) {
      const Patch patch = f.mesh.patch(tree.order()[k]);
      for (const V3d& corner : patch.corner)
        EXPECT_LE((corner - V3d(node.center)).length(), node.radius * (1.0 + 1e-5));
      if (&node == &tree.node(0)) continue;  // faces everywhere
      EXPECT_LE(std::acos(std::min(1.0, patch.centroid().normal.dot(V3d(node.axis)))), node.cone + 1e-3);
    }
    if (!node.is_flat) continue;
    // In the plane of its root, on the same side.
    const Patch root =
        triangle_patch(std::get<Mesh>(f.scene.shapes()[f.mesh.roots()[node.root].shape].geometry),
                       f.mesh.roots()[node.root].primitive, f.mesh.roots()[node.root].side);
    EXPECT_NEAR(tree.surface(node).normal.dot(root.normal), 1.0, 1e-12);
    for (int k = 0; k < tree.surface(node).polygon.n; ++k)
      EXPECT_NEAR((tree.surface(node).polygon.v[std::size_t(k)] - root.corner[0]).dot(root.normal), 0.0, 1e-12);
  }
}

TEST(ElementTree, ChildrenOfTheSceneFaceOneDirectionEach) {
  const Fixture f(1500);
  const ElementTree tree(f.mesh, f.reflectance);
  const TreeNode& all = tree.node(0);
  EXPECT_LE(all.child_count, 26u);
  EXPECT_GE(all.child_count, 6u + 8u);  // the walls' and the octants'
  for (std::uint32_t c = all.first_child; c < all.first_child + all.child_count; ++c)
    EXPECT_LT(tree.node(c).cone, 0.65f + 0.96f);  // of a direction, and of an octant
}

TEST(ElementTree, PointsOfANodeLieOnIt) {
  const Fixture f(700);
  const ElementTree tree(f.mesh, f.reflectance);
  for (const TreeNode& node : tree.nodes())
    for (const ElementPoint& point : tree.points(node, 5)) {
      EXPECT_LE((point.position - V3d(node.center)).length(), node.radius * (1.0 + 1e-5));
      EXPECT_NEAR(point.normal.length(), 1.0, 1e-6);
      if (node.is_flat) {
        EXPECT_NEAR((point.position - tree.surface(node).polygon.v[0]).dot(point.normal), 0.0, 1e-9);
      }
    }
}

// Clusters of small triangles and quad-trees are leaves like all others, inside their parents.
TEST(ElementTree, HoldsClustersAndSplitElements) {
  const Scene scene(test::crowded_room(20000));
  ElementMesh mesh = divide_surfaces(scene, 2000);
  std::vector<bool> chosen(mesh.count());
  for (std::uint32_t i = 0; i < mesh.count(); ++i) chosen[i] = i % 3 == 0;
  mesh = mesh.split(chosen);
  const std::vector<C3f> reflectance(mesh.count(), C3f(0.5f));
  const ElementTree tree(mesh, reflectance);
  std::size_t patchworks = 0;
  std::vector<int> times(mesh.count(), 0);
  for (const std::uint32_t element : tree.order()) ++times.at(element);
  for (std::uint32_t e = 0; e < mesh.count(); ++e) {
    ASSERT_EQ(times[e], 1);
    const TreeNode& leaf = tree.node(tree.leaf_of(e));
    ASSERT_EQ(tree.element_of(leaf), e);
    EXPECT_EQ(leaf.is_patchwork, mesh.is_cluster(e));
    EXPECT_NEAR(leaf.whole_area / mesh.whole_area(e), 1.0, 1e-6);
    patchworks += leaf.is_patchwork;
    for (std::uint32_t i = tree.leaf_of(e); i != no_index; i = tree.node(i).parent)
      for (std::size_t k = 0; k < mesh.patch_count(e); ++k)
        for (const V3d& corner : mesh.patch(e, k).corner)
          ASSERT_LE((corner - V3d(tree.node(i).center)).length(), tree.node(i).radius * (1.0 + 1e-4));
  }
  EXPECT_GT(patchworks, 200u);
}

// Every number of divisions up to 40 comes apart into as many elements as there are.
TEST(ElementTree, GridsOfAnySizeComeApart) {
  SceneDescription description;
  Mesh mesh;
  mesh.positions = {V3f(0.0f), V3f(2, 0, 0), V3f(0, 1, 0)};
  mesh.triangles = {V3u(0, 1, 2)};
  test::add_diffuse(description, "tile", mesh, C3f(0.5f));
  for (std::uint16_t divisions = 1; divisions <= 40; ++divisions) {
    const ElementMesh elements(description.shapes, description.materials,
                               {{0, 0, 0, no_index, divisions, front}});
    const std::vector<C3f> reflectance(elements.count(), C3f(0.5f));
    const ElementTree tree(elements, reflectance);
    std::vector<int> times(elements.count(), 0);
    for (const std::uint32_t element : tree.order()) ++times.at(element);
    for (const int count : times) ASSERT_EQ(count, 1) << divisions;
    for (const TreeNode& node : tree.nodes()) {
      double whole = 0.0;
      for (std::uint32_t k = node.begin; k < node.end; ++k) whole += elements.area(tree.order()[k]);
      if (node.is_flat) {
        ASSERT_NEAR(polygon_area(tree.surface(node).polygon), whole, 1e-7) << divisions;
      }
    }
  }
}

}  // namespace
}  // namespace twopass
