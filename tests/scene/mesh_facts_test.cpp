#include "render/scene/mesh_facts.h"

#include <gtest/gtest.h>

namespace twopass {
namespace {

// The unit cube of 12 triangles on 24 vertices, front outside.
Mesh cube_mesh() {
  Mesh mesh;
  const auto quad = [&](const V3f& a, const V3f& b, const V3f& c, const V3f& d) {
    const auto i = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {a, b, c, d});
    mesh.triangles.insert(mesh.triangles.end(), {V3u(i, i + 1, i + 2), V3u(i, i + 2, i + 3)});
  };
  quad({0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0});
  quad({0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1});
  quad({0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1});
  quad({0, 1, 0}, {0, 1, 1}, {1, 1, 1}, {1, 1, 0});
  quad({0, 0, 0}, {0, 0, 1}, {0, 1, 1}, {0, 1, 0});
  quad({1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 0, 1});
  return mesh;
}

Mesh turned(Mesh mesh) {
  for (V3u& t : mesh.triangles) std::swap(t.y, t.z);
  return mesh;
}

TEST(MeshFacts, ACubeIsClosed) {
  const MeshFacts facts = facts_of(cube_mesh());
  EXPECT_TRUE(facts.is_closed()) << "its corners have three vertices each, in the same place";
  EXPECT_NEAR(facts.area, 6.0, 1e-9);
  EXPECT_NEAR(facts.signed_volume, 1.0, 1e-9);
  EXPECT_NEAR(facts_of(turned(cube_mesh())).signed_volume, -1.0, 1e-9);
  EXPECT_TRUE(facts_of(turned(cube_mesh())).is_closed());
}

TEST(MeshFacts, FindsWhatIsWrong) {
  Mesh open = cube_mesh();
  open.triangles.pop_back();
  EXPECT_EQ(facts_of(open).open_edges, 3u);
  EXPECT_FALSE(facts_of(open).is_closed());

  Mesh flipped = cube_mesh();
  std::swap(flipped.triangles[0].y, flipped.triangles[0].z);
  EXPECT_EQ(facts_of(flipped).turned_edges, 3u);

  Mesh doubled = cube_mesh();
  doubled.triangles.push_back(doubled.triangles[5]);
  EXPECT_EQ(facts_of(doubled).duplicates, 1u);
  EXPECT_EQ(facts_of(doubled).crowded_edges, 3u);

  Mesh degenerate = cube_mesh();
  degenerate.triangles.push_back(V3u(0, 0, 1));
  EXPECT_EQ(facts_of(degenerate).degenerate, 1u);
  EXPECT_TRUE(facts_of(degenerate).is_closed());

  EXPECT_FALSE(facts_of(Mesh{}).is_closed());
}

TEST(MeshFacts, RoomsFaceInward) {
  const auto inward = [](Mesh mesh) {
    std::vector<Shape> shapes(1);
    shapes[0].geometry = std::move(mesh);
    return faces_inward(shapes);
  };
  EXPECT_FALSE(inward(cube_mesh()));
  EXPECT_TRUE(inward(turned(cube_mesh())));
  Mesh box = turned(cube_mesh());  // open in front (+z)
  box.triangles.erase(box.triangles.begin() + 2, box.triangles.begin() + 4);
  EXPECT_TRUE(inward(box));
  EXPECT_FALSE(faces_inward({}));
}

}  // namespace
}  // namespace twopass
