#include "radiosity/centred_scene.h"

namespace twopass {

namespace {

// Floats of one sign whose sizes differ by at most a factor of two subtract exactly (Sterbenz).
float exact_shift(float lowest, float highest) {
  if (!(lowest > 0.0f) && !(highest < 0.0f)) return 0.0f;
  const float nearest = std::min(std::abs(lowest), std::abs(highest));
  return highest - lowest <= nearest ? (lowest > 0.0f ? lowest : highest) : 0.0f;
}

void transform(Mesh& mesh, const V3f& shift, float scale) {
  for (V3f& p : mesh.positions) p = (p - shift) * scale;
}
void transform(Sphere& sphere, const V3f& shift, float scale) {
  sphere.center = (sphere.center - shift) * scale;
  sphere.radius *= scale;
}
void transform(Disk& disk, const V3f& shift, float scale) {
  disk.center = (disk.center - shift) * scale;
  disk.x *= scale;
  disk.y *= scale;
}
void transform(Cylinder& cylinder, const V3f& shift, float scale) {
  cylinder.base = (cylinder.base - shift) * scale;
  cylinder.radius *= scale;
  cylinder.length *= scale;
}
void transform(MeshInstance& instance, const V3f& shift, float scale) {
  Placement& p = instance.to_world;
  p = {p.x * scale, p.y * scale, p.z * scale, (p.origin - shift) * scale};
}

}  // namespace

CentredScene centred(const SceneDescription& scene) {
  CentredScene result{scene};
  const Box3f bounds = bounds_of(scene.shapes);
  if (bounds.isEmpty()) return result;
  V3f shift;
  float largest = 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    const float lowest = bounds.min[axis], highest = bounds.max[axis];
    shift[axis] = exact_shift(lowest, highest);
    largest = std::max({largest, std::abs(lowest - shift[axis]), std::abs(highest - shift[axis])});
  }
  if (!(largest > 0.0f)) return result;
  // Far enough from both ends of a float's range for either power to be one.
  const int exponent = std::clamp(std::ilogb(largest), -100, 100);
  const float scale = std::ldexp(1.0f, -exponent);
  for (Shape& shape : result.scene.shapes)
    std::visit([&](auto& geometry) { transform(geometry, shift, scale); }, shape.geometry);
  result.length_unit = std::ldexp(1.0, exponent);
  return result;
}

}  // namespace twopass
