// Flat walls of many triangles, and meshes refined at random, for the tests of what must be continuous on them.
#pragma once

#include <span>

#include "radiosity/elements.h"
#include "render/core/sampler.h"
#include "tests/support/scenes.h"

namespace twopass::test {

/// The unit square in the plane z = 0 seen from above, cut at these coordinates in both directions, each
/// rectangle in two triangles along the one or the other diagonal; inner points are moved by up to `jitter`
/// times the distance to the next.
inline Mesh wall(std::span<const float> cut, float jitter) {
  Mesh mesh;
  const auto n = static_cast<std::uint32_t>(cut.size());
  for (std::uint32_t row = 0; row < n; ++row)
    for (std::uint32_t column = 0; column < n; ++column) {
      const bool inner = row > 0 && column > 0 && row + 1 < n && column + 1 < n;
      Sampler sampler(3, row, column);
      const V2f u = inner ? (sampler.next_2d() - V2f(0.5f)) * (2.0f * jitter) : V2f(0.0f);
      const auto gap = [&](std::uint32_t k) { return std::min(cut[k + 1] - cut[k], cut[k] - cut[k - 1]); };
      mesh.positions.emplace_back(cut[column] + (inner ? u.x * gap(column) : 0.0f),
                                  cut[row] + (inner ? u.y * gap(row) : 0.0f), 0.0f);
    }
  for (std::uint32_t row = 0; row + 1 < n; ++row)
    for (std::uint32_t column = 0; column + 1 < n; ++column) {
      const std::uint32_t a = row * n + column, b = a + 1, c = a + n + 1, d = a + n;
      if ((row + column) % 2 == 0) {
        mesh.triangles.emplace_back(a, b, c);
        mesh.triangles.emplace_back(a, c, d);
      } else {
        mesh.triangles.emplace_back(a, b, d);
        mesh.triangles.emplace_back(b, c, d);
      }
    }
  return mesh;
}

/// n + 1 equally spaced numbers from 0 to 1.
inline std::vector<float> even_cuts(int n) {
  std::vector<float> cut;
  for (int k = 0; k <= n; ++k) cut.push_back(static_cast<float>(k) / static_cast<float>(n));
  return cut;
}

/// Splits a random part of the elements, a few times over: no balance between neighbours.
inline ElementMesh split_at_random(ElementMesh mesh, int times, float part) {
  for (int t = 0; t < times; ++t) {
    std::vector<bool> chosen(mesh.count());
    for (std::uint32_t i = 0; i < mesh.count(); ++i)
      chosen[i] = Sampler(7, i, static_cast<std::uint32_t>(t)).next_1d() < part;
    mesh = mesh.split(chosen);
  }
  return mesh;
}

/// One root for each front triangle of the scene's meshes, with the given divisions, all others clusters of the
/// given number of triangles in a row.
inline ElementMesh mesh_of_divisions(const Scene& scene, std::span<const std::uint16_t> divisions,
                                     std::uint32_t cluster_size = 1) {
  std::vector<ElementRoot> roots;
  std::vector<std::uint32_t> cluster;
  std::uint32_t members = 0;
  for (std::uint32_t s = 0; s < scene.shapes().size(); ++s) {
    const auto& mesh = std::get<Mesh>(scene.shapes()[s].geometry);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const std::uint16_t n = divisions[roots.size() % divisions.size()];
      roots.push_back({s, t, 0, no_index, n, front});
      cluster.push_back(n == 0 ? members++ / cluster_size : no_index);
    }
  }
  return ElementMesh(scene.shapes(), scene.description().materials, std::move(roots), cluster);
}

}  // namespace twopass::test
