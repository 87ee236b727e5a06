#include "render/scene/centred_scene.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <type_traits>
#include <unordered_map>
#include <variant>
#include <vector>

namespace twopass {

namespace {

// Floats of one sign whose sizes differ by at most a factor of two subtract exactly (Sterbenz).
float exact_shift(float lowest, float highest) {
  if (!(lowest > 0.0f) && !(highest < 0.0f)) return 0.0f;
  const float nearest = std::min(std::abs(lowest), std::abs(highest));
  return highest - lowest <= nearest ? (lowest > 0.0f ? lowest : highest) : 0.0f;
}

// The power of two that is at most `largest`, far enough from both ends of a float's range for its inverse to
// be one, too.
float power_of_two(float largest) { return std::ldexp(1.0f, std::clamp(std::ilogb(largest), -100, 100)); }

// What is done to every length and place.
class Move {
 public:
  Move(const V3f& shift, float scale) : shift_(shift), scale_(scale) {}

  void operator()(Mesh& mesh) {
    for (V3f& p : mesh.positions) p = moved(p);
  }
  void operator()(Sphere& sphere) {
    sphere.center = moved(sphere.center);
    sphere.radius *= scale_;
  }
  void operator()(Disk& disk) {
    disk.center = moved(disk.center);
    disk.x *= scale_;
    disk.y *= scale_;
  }
  void operator()(Cylinder& cylinder) {
    cylinder.base = moved(cylinder.base);
    cylinder.radius *= scale_;
    cylinder.length *= scale_;
  }
  // Rays are carried into the mesh's coordinates, which are to be of about unit size, too.
  void operator()(MeshInstance& instance) {
    const auto [mesh, unit] = in_good_range(instance.mesh);
    instance.mesh = mesh;
    Placement& p = instance.to_world;
    const float scale = scale_ * unit;
    p = {p.x * scale, p.y * scale, p.z * scale, moved(p.origin)};
  }

  void operator()(PointLight& light) {
    light.position = moved(light.position);
    light.intensity = light.intensity * scale_ * scale_;
  }
  void operator()(SpotLight& light) {
    light.frame.position = moved(light.frame.position);
    light.intensity = light.intensity * scale_ * scale_;
  }
  void operator()(Projector& light) {
    light.frame.position = moved(light.frame.position);
    light.scale = light.scale * scale_ * scale_;
  }
  void operator()(DirectionalLight&) {}

  // Heights of bump maps are lengths.
  void operator()(MaterialSide& side) {
    if (side.is_uniform() || scale_ == 1.0f) return;
    if (const MaterialNodePtr node = scaled(side.node()); node != side.node()) side = MaterialSide(node);
  }

 private:
  [[nodiscard]] V3f moved(const V3f& p) const { return (p - shift_) * scale_; }

  struct SharedMesh {
    std::shared_ptr<const Mesh> mesh;
    float unit = 1.0f;  // a length of 1 in it is this long in the original
  };
  SharedMesh in_good_range(const std::shared_ptr<const Mesh>& mesh) {
    const auto [entry, is_new] = known_.try_emplace(mesh.get());
    if (!is_new) return entry->second;
    float largest = 0.0f;
    for (const V3f& p : mesh->positions) largest = std::max(largest, max_abs_component(p));
    constexpr float good = 0x1p16f;
    entry->second.mesh = mesh;
    if (!(largest > 0.0f) || (largest < good && largest > 1.0f / good)) return entry->second;
    const float unit = power_of_two(largest);
    Mesh scaled = *mesh;
    for (V3f& p : scaled.positions) p *= 1.0f / unit;
    originals_.push_back(mesh);  // so that no other mesh gets its address
    return entry->second = {std::make_shared<const Mesh>(std::move(scaled)), unit};
  }

  // The node itself where no bump map is in it.
  [[nodiscard]] MaterialNodePtr scaled(const MaterialNodePtr& node) const {
    return std::visit(
        [&]<class Kind>(Kind kind) -> MaterialNodePtr {
          bool has_changed = false;
          const auto replace = [&](MaterialNodePtr& part) {
            const MaterialNodePtr other = scaled(part);
            has_changed = has_changed || other != part;
            part = other;
          };
          if constexpr (std::is_same_v<Kind, Mixture>) {
            replace(kind.first);
            replace(kind.second);
          } else if constexpr (std::is_same_v<Kind, BumpMap>) {
            kind.scale *= scale_;
            replace(kind.nested);
            has_changed = true;
          } else if constexpr (std::is_same_v<Kind, NormalMap>) {
            replace(kind.nested);
          }
          return has_changed ? std::make_shared<const MaterialNode>(MaterialNode{std::move(kind)}) : node;
        },
        node->kind);
  }

  V3f shift_;
  float scale_;
  std::unordered_map<const Mesh*, SharedMesh> known_;
  std::vector<std::shared_ptr<const Mesh>> originals_;
};

}  // namespace

SceneDescription centred(SceneDescription scene) {
  const Box3f bounds = bounds_of(scene.shapes);
  if (bounds.isEmpty()) return scene;
  V3f shift;
  float largest = 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    const float lowest = bounds.min[axis], highest = bounds.max[axis];
    shift[axis] = exact_shift(lowest, highest);
    largest = std::max({largest, std::abs(lowest - shift[axis]), std::abs(highest - shift[axis])});
  }
  if (!(largest > 0.0f)) return scene;
  const float unit = power_of_two(largest);
  Move move(shift, 1.0f / unit);
  for (Shape& shape : scene.shapes) std::visit(move, shape.geometry);
  for (PunctualLight& light : scene.punctual_lights) std::visit(move, light);
  for (Material& material : scene.materials)
    for (MaterialSide& side : material.side) move(side);
  const WorldFrame step{V3d(shift), static_cast<double>(unit)};
  if (scene.camera) scene.camera = step.from_world(*scene.camera);
  scene.frame = {scene.frame.to_world(step.origin), scene.frame.unit * step.unit};
  return scene;
}

}  // namespace twopass
