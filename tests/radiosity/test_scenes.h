// Rooms for the tests of the radiosity room, beyond those that all tests share.
#pragma once

#include "tests/support/scenes.h"

namespace twopass::test {

/// The unit cube seen from inside; the ceiling has a radiant exitance of 1 W/m2.
inline SceneDescription lit_cube(float reflectance) {
  return unit_room(C3f(reflectance), C3f(1.0f / pi_f), C3f(reflectance));
}

/// A box without its underside, standing on something.
inline void add_standing_box(SceneDescription& scene, const V3f& lo, const V3f& hi, float reflectance) {
  const V3f x(hi.x - lo.x, 0, 0), y(0, hi.y - lo.y, 0), z(0, 0, hi.z - lo.z);
  for (const Mesh& face :
       {quad(lo + z, x, y), quad(lo, z, y), quad(lo + x, y, z), quad(lo, x, z), quad(lo + y, z, x)})
    add_diffuse(scene, "box", face, C3f(reflectance));
}

/// A unit room with two boxes on the floor and a black lamp of 0.25 x 0.25 and exitance 16 just below the
/// ceiling.
inline SceneDescription lit_room(float reflectance = 0.7f) {
  SceneDescription scene = unit_room(C3f(reflectance), C3f(0.0f), C3f(reflectance));
  add_standing_box(scene, V3f(0.2f, 0.55f, 0.0f), V3f(0.45f, 0.8f, 0.6f), reflectance);
  add_standing_box(scene, V3f(0.55f, 0.25f, 0.0f), V3f(0.8f, 0.5f, 0.3f), reflectance);
  add_diffuse(scene, "lamp", quad(V3f(0.375f, 0.375f, 0.999f), V3f(0, 0.25f, 0), V3f(0.25f, 0, 0)), C3f(0.0f),
              C3f(16.0f / pi_f));
  return scene;
}

/// Two unit squares facing each other along z at a distance, the lower one of exitance 1.
inline SceneDescription plates(float distance, float reflectance) {
  const V3f x(1, 0, 0), y(0, 1, 0);
  SceneDescription scene;
  add_diffuse(scene, "lower", quad(V3f(0.0f), x, y), C3f(reflectance), C3f(1.0f / pi_f));
  add_diffuse(scene, "upper", quad(V3f(0, 0, distance), y, x), C3f(reflectance));
  return scene;
}

/// A sphere of radius 1/2 and exitance 1 inside one of radius 1 seen from inside.
inline SceneDescription concentric_spheres(float reflectance) {
  SceneDescription scene;
  add_diffuse(scene, "inner", Sphere{V3f(0.0f), 0.5f, false}, C3f(reflectance), C3f(1.0f / pi_f));
  add_diffuse(scene, "outer", Sphere{V3f(0.0f), 1.0f, true}, C3f(reflectance));
  return scene;
}

}  // namespace twopass::test
