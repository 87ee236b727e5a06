#include "render/load/gltf_nodes.h"

#include "tests/load/gltf_writer.h"
#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

using json = nlohmann::json;

std::vector<GltfPlace> places_of(const GltfWriter& writer) {
  Notes notes;
  return gltf_places(parse_gltf(writer.gltf(), "a.gltf", notes));
}
void refused(const GltfWriter& writer, std::initializer_list<std::string_view> parts) {
  expect_error([&] { places_of(writer); }, parts);
}
V3f moved(const M44d& m, const V3d& p) {
  V3d result;
  m.multVecMatrix(p, result);
  return V3f(result);
}

TEST(GltfNodes, ScaledThenTurnedThenMoved) {
  GltfWriter w;
  const double h = std::sqrt(0.5);  // a quarter turn around z, quaternion of any length
  w.add_root({{"translation", {10, 20, 30}}, {"rotation", {0, 0, 2 * h, 2 * h}}, {"scale", {2, 3, 4}}});
  const M44d m = places_of(w).at(0).to_world;
  expect_near(moved(m, {1, 0, 0}), {10, 22, 30});
  expect_near(moved(m, {0, 1, 0}), {7, 20, 30});
  expect_near(moved(m, {0, 0, 1}), {10, 20, 34});
}

TEST(GltfNodes, AxesOfRotation) {
  const double h = std::sqrt(0.5);
  GltfWriter w;
  w.add_root({{"rotation", {h, 0, 0, h}}});
  w.add_root({{"rotation", {0, h, 0, h}}});
  expect_near(moved(places_of(w)[0].to_world, {0, 1, 0}), {0, 0, 1});  // around x: y to z
  expect_near(moved(places_of(w)[1].to_world, {0, 0, 1}), {1, 0, 0});  // around y: z to x
}

TEST(GltfNodes, MatricesAreByColumns) {
  GltfWriter w;
  w.add_root({{"matrix", {0, 2, 0, 0, -3, 0, 0, 0, 0, 0, 4, 0, 10, 20, 30, 1}}});
  const M44d m = places_of(w).at(0).to_world;
  expect_near(moved(m, {1, 1, 1}), {10 - 3, 20 + 2, 34});
  w.document["nodes"][0]["matrix"][3] = 1;
  refused(w, {"node 0 has a matrix that is not affine"});
  w.document["nodes"][0]["matrix"] = {1, 2};
  refused(w, {"node 0 has a matrix of 2 numbers"});
}

TEST(GltfNodes, ChildrenMoveWithTheirParents) {
  GltfWriter w;
  w.add_root({{"scale", {2, 2, 2}}, {"children", {1, 2}}});
  w.add("nodes", {{"translation", {1, 0, 0}}, {"children", {3}}});
  w.add("nodes", {{"translation", {0, 1, 0}}});
  w.add("nodes", {{"translation", {0, 0, 1}}});
  const std::vector<GltfPlace> all = places_of(w);
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[1].node, 1u);
  EXPECT_EQ(all[2].node, 3u);  // depth first
  EXPECT_EQ(all[3].node, 2u);
  expect_near(moved(all[2].to_world, {0, 0, 0}), {2, 0, 2});
}

TEST(GltfNodes, WhichSceneCounts) {
  GltfWriter w;
  w.add("nodes", {{"name", "a"}, {"children", {1}}});
  w.add("nodes", {{"name", "b"}});
  w.add("nodes", {{"name", "c"}});
  w.document["scenes"] = {{{"nodes", {2}}}, {{"nodes", {0}}}};
  w.document["scene"] = 1;
  EXPECT_EQ(places_of(w).size(), 2u);
  w.document.erase("scene");
  EXPECT_EQ(places_of(w).size(), 1u);
  w.document.erase("scenes");
  EXPECT_EQ(places_of(w).size(), 3u);  // a library: all of it
  w.document["scene"] = 5;
  EXPECT_EQ(places_of(w).size(), 3u);
  w.document["scenes"] = {{{"nodes", {2}}}};
  refused(w, {"'scene' refers to scene 5, but there are only 1"});
}

TEST(GltfNodes, WhatIsNoTreeIsRefused) {
  GltfWriter w;
  w.add_root({{"children", {1}}});
  w.add("nodes", {{"children", {0}}});
  refused(w, {"a.gltf: node 0 hangs in several places or in itself"});
  w.document.erase("scenes");
  refused(w, {"node 0 hangs in itself"});
  GltfWriter shared;
  shared.add_root({{"children", {1, 1}}});
  shared.add("nodes", json::object());
  refused(shared, {"node 1 hangs in several places"});
  shared.document["nodes"][0]["children"] = {7};
  refused(shared, {"node 0 refers to node 7, but there are only 2"});
  shared.document["scenes"][0]["nodes"] = {3};
  refused(shared, {"the scene refers to node 3"});
}

TEST(GltfNodes, DepthIsNoProblem) {
  GltfWriter w;
  constexpr int depth = 20000;
  json nodes = json::array();
  for (int i = 0; i < depth; ++i) nodes.push_back({{"children", {i + 1}}, {"translation", {1, 0, 0}}});
  nodes.push_back({{"translation", {1, 0, 0}}});
  w.document["nodes"] = std::move(nodes);
  w.document["scenes"][0]["nodes"] = {0};
  expect_near(moved(places_of(w).back().to_world, {0, 0, 0}), {depth + 1, 0, 0});
}

TEST(GltfNodes, TransformsThatAreNoneAreRefused) {
  GltfWriter w;
  w.add_root({{"rotation", {0, 0, 0, 0}}});
  refused(w, {"node 0 has a rotation of length 0"});
  w.document["nodes"][0] = {{"scale", {1e300, 1, 1}}};
  refused(w, {"node 0 has a transform that is not finite"});
  w.document["nodes"][0] = {{"translation", {1, 2}}};
  refused(w, {"node 0 has a translation of 2 numbers"});
}

}  // namespace
}  // namespace twopass
