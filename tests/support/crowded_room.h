// A generated scene of any number of triangles.
#pragma once

#include "render/core/sampler.h"
#include "tests/support/scenes.h"

namespace twopass::test {

/// A triangulated sphere of rings x 2 rings quads.
inline Mesh tessellated_sphere(const V3f& center, float radius, int rings) {
  Mesh mesh;
  const int columns = 2 * rings;
  for (int y = 0; y <= rings; ++y)
    for (int x = 0; x < columns; ++x) {
      const float theta = pi_f * static_cast<float>(y) / static_cast<float>(rings);
      const float phi = 2.0f * pi_f * static_cast<float>(x) / static_cast<float>(columns);
      const V3f outward(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
      mesh.positions.push_back(center + outward * radius);
    }
  const auto at = [&](int x, int y) { return static_cast<std::uint32_t>(y * columns + x % columns); };
  for (int y = 0; y < rings; ++y)
    for (int x = 0; x < columns; ++x) {
      if (y > 0) mesh.triangles.emplace_back(at(x, y), at(x, y + 1), at(x + 1, y));
      if (y + 1 < rings) mesh.triangles.emplace_back(at(x + 1, y), at(x, y + 1), at(x + 1, y + 1));
    }
  return mesh;
}

/// A unit room with a lamp below the ceiling and 100 balls of four colours in it, of about `triangles`
/// triangles together.
inline SceneDescription crowded_room(std::size_t triangles) {
  constexpr int balls = 100;
  SceneDescription scene = unit_room(C3f(0.7f, 0.6f, 0.5f), C3f(0.0f), C3f(0.8f));
  add_diffuse(scene, "lamp", quad(V3f(0.375f, 0.375f, 0.99f), V3f(0, 0.25f, 0), V3f(0.25f, 0, 0)), C3f(0.0f),
              C3f(5.0f));
  const int rings =
      std::max(2, static_cast<int>(std::sqrt(static_cast<double>(triangles) / balls / 4.0) + 0.5));
  for (std::uint32_t k = 0; k < balls; ++k) {
    Sampler sampler(11, k, 0);
    const V2f xy = sampler.next_2d(), zr = sampler.next_2d();
    const float radius = 0.02f + 0.05f * zr.y;
    const V3f center(0.1f + 0.8f * xy.x, 0.1f + 0.8f * xy.y, 0.1f + 0.7f * zr.x);
    const auto shade = static_cast<float>(k % 4);
    add_diffuse(scene, "ball", tessellated_sphere(center, radius, rings), C3f(0.6f, 0.2f + 0.2f * shade, 0.4f));
    if (k < 4) continue;
    scene.materials.pop_back();
    scene.shapes.back().material = scene.shapes[scene.shapes.size() - 5].material;
  }
  return scene;
}

}  // namespace twopass::test
