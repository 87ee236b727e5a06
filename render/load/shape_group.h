// Shapes that stand in several places: their meshes are stored once.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "render/core/types.h"
#include "render/load/notes.h"
#include "render/scene/shape.h"

namespace twopass {

class ShapeGroup {
 public:
  explicit ShapeGroup(std::vector<Shape> members);

  /// Whether any of the members emits.
  [[nodiscard]] bool emits() const;
  /// Whether the transform neither flattens what it is applied to nor has numbers too large or too small.
  [[nodiscard]] static bool is_placeable(const M44d& to_world);
  /// Copies of all members at `to_world` (row vectors), called name/member, or name where that has none. Meshes
  /// are shared (mirror images share a mirrored one). Disks stay disks, and under similarities spheres and
  /// cylinders what they are; stretched or sheared, they become fine meshes, with a note. Throws Error at
  /// `where` for transforms that flatten the group or carry it too far away.
  std::vector<Shape> place(const M44d& to_world, const std::string& name, const std::string& where,
                           Notes& notes);

 private:
  std::shared_ptr<const Mesh> shared_mesh(std::size_t member, bool mirrored);

  std::vector<Shape> members_;
  std::vector<std::array<std::shared_ptr<const Mesh>, 2>> meshes_;  // by member: as it is, mirrored
};

/// Lengths, and angles but for their sense, are kept up to one factor, which is returned; 0 if they are not.
double similarity_scale(const M44d& to_world);

}  // namespace twopass
