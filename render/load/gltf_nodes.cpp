#include "render/load/gltf_nodes.h"

#include <algorithm>

#include "render/core/error.h"

namespace twopass {
namespace {

[[noreturn]] void fail(const GltfDocument& document, std::size_t node, const std::string& what) {
  throw Error(document.file, "node " + std::to_string(node) + " " + what, "correct the file");
}

/// Throws unless the array is absent or as long as it should be.
bool has(const std::vector<double>& numbers, std::size_t size, const GltfDocument& document, std::size_t node,
         const char* member) {
  if (numbers.empty()) return false;
  if (numbers.size() != size)
    fail(document, node, std::string("has a ") + member + " of " + std::to_string(numbers.size()) + " numbers");
  return true;
}

/// The rotation of a quaternion (x, y, z, w) of any length, for row vectors.
M44d rotation_of(const std::vector<double>& q, const GltfDocument& document, std::size_t node) {
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(length > 0.0)) fail(document, node, "has a rotation of length 0");
  const double x = q[0] / length, y = q[1] / length, z = q[2] / length, w = q[3] / length;
  return {1 - 2 * (y * y + z * z),
          2 * (x * y + z * w),
          2 * (x * z - y * w),
          0,
          2 * (x * y - z * w),
          1 - 2 * (x * x + z * z),
          2 * (y * z + x * w),
          0,
          2 * (x * z + y * w),
          2 * (y * z - x * w),
          1 - 2 * (x * x + y * y),
          0,
          0,
          0,
          0,
          1};
}

M44d local_transform(const GltfDocument& document, std::size_t index) {
  const tinygltf::Node& node = document.model.nodes[index];
  M44d m;
  if (has(node.matrix, 16, document, index, "matrix")) {
    // By columns, for column vectors: the same order as by rows for row vectors.
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = node.matrix[static_cast<std::size_t>(i)];
    if (m[0][3] != 0.0 || m[1][3] != 0.0 || m[2][3] != 0.0 || m[3][3] != 1.0)
      fail(document, index, "has a matrix that is not affine");
    return m;
  }
  if (has(node.scale, 3, document, index, "scale"))
    m.setScale(V3d(node.scale[0], node.scale[1], node.scale[2]));
  if (has(node.rotation, 4, document, index, "rotation")) m *= rotation_of(node.rotation, document, index);
  if (has(node.translation, 3, document, index, "translation"))
    for (int i = 0; i < 3; ++i) m[3][i] = node.translation[static_cast<std::size_t>(i)];
  return m;
}

void check_finite(const M44d& m, const GltfDocument& document, std::size_t node) {
  for (int i = 0; i < 16; ++i)
    if (!(std::abs(m[i / 4][i % 4]) <= 1e30))
      fail(document, node, "has a transform that is not finite or beyond 1e30");
}

/// Where the traversal starts.
std::vector<int> roots(const GltfDocument& document) {
  const tinygltf::Model& model = document.model;
  if (!model.scenes.empty()) {
    const int scene = std::max(model.defaultScene, 0);
    return element_of(model.scenes, scene, "scene", "'scene'", document).nodes;
  }
  std::vector<bool> is_child(model.nodes.size(), false);
  for (const tinygltf::Node& node : model.nodes)
    for (const int child : node.children)
      if (child >= 0 && static_cast<std::size_t>(child) < is_child.size())
        is_child[static_cast<std::size_t>(child)] = true;
  std::vector<int> result;
  for (std::size_t i = 0; i < is_child.size(); ++i)
    if (!is_child[i]) result.push_back(static_cast<int>(i));
  if (result.empty() && !model.nodes.empty()) fail(document, 0, "hangs in itself");
  return result;
}

}  // namespace

std::string name_of_node(const GltfDocument& document, std::size_t node) {
  const std::string& name = document.model.nodes[node].name;
  return name.empty() ? "node " + std::to_string(node) : name;
}

std::vector<GltfPlace> gltf_places(const GltfDocument& document) {
  struct Waiting {
    int node;
    M44d parent;
    std::string user;
  };
  // A stack instead of recursion: the file decides how deep it goes.
  std::vector<Waiting> stack;
  const auto push = [&](std::vector<int> nodes, const M44d& parent, const std::string& user) {
    std::ranges::reverse(nodes);  // the first one is taken first
    for (const int node : nodes) stack.push_back({node, parent, user});
  };
  push(roots(document), M44d(), "the scene");
  std::vector<bool> visited(document.model.nodes.size(), false);
  std::vector<GltfPlace> places;
  while (!stack.empty()) {
    const Waiting next = std::move(stack.back());
    stack.pop_back();
    const tinygltf::Node& node = element_of(document.model.nodes, next.node, "node", next.user, document);
    const auto index = static_cast<std::size_t>(next.node);
    // Each node hangs in one place at most (section 3.5.2), so that the work is bounded by the file's size.
    if (visited[index]) fail(document, index, "hangs in several places or in itself");
    visited[index] = true;
    const M44d to_world = local_transform(document, index) * next.parent;
    check_finite(to_world, document, index);
    places.push_back({index, to_world});
    push(node.children, to_world, "node " + std::to_string(index));
  }
  return places;
}

}  // namespace twopass
