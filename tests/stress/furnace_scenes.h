// Hostile scenes with one answer: every surface emits what it does not reflect of a radiance of 1, and the sky
// is as bright, so that whatever its geometry (slivers, cracks, faces inside each other) a scene is as bright
// everywhere and in every direction, and none of it can be seen. Light that is lost or found twice shows.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "tests/support/scenes.h"

namespace twopass::stress {

inline constexpr float furnace_radiance = 1.0f;

struct FurnaceScene {
  std::string name;  ///< letters, digits and underscores
  SceneDescription scene;
};
inline void PrintTo(const FurnaceScene& scene, std::ostream* out) { *out << scene.name; }

/// Adds a two-sided diffuse shape that emits (1 - albedo) from both sides.
Shape& add_furnace(SceneDescription& scene, const std::string& name, Geometry geometry, const C3f& albedo);
/// Adds a shape of a material that loses nothing and emits nothing.
Shape& add_lossless(SceneDescription& scene, const std::string& name, Geometry geometry,
                    const Material& material);
/// The unit room of albedo .5 with two boxes and a ball in it, under the sky of the furnace. The undersides of
/// the boxes are as high above the floor as given.
SceneDescription furnished_furnace(float above_floor = 0.0f);

/// 120 triangles anywhere in the unit cube, needles and specks among them.
SceneDescription triangle_soup(std::uint32_t seed = 1);
/// The room with one of its boxes four times in the same place, of four albedos: it has no answer.
FurnaceScene duplicate_faces();

/// Everything that geometry does wrong.
std::vector<FurnaceScene> broken_geometry();
/// The furnished room with its camera in a wall, on surfaces, edges and corners, in a lamp.
std::vector<FurnaceScene> misplaced_cameras();
/// Mirrors, glass and rough surfaces at the ends of their ranges.
std::vector<FurnaceScene> extreme_materials();

/// The scene `factor` times as large, then moved; its camera with it.
SceneDescription transformed(SceneDescription scene, float factor, const V3f& offset = V3f(0.0f));

}  // namespace twopass::stress
