// The lights of a scene by group: what compositors turn up and down together.
#pragma once

#include <string>
#include <vector>

#include "render/scene/scene.h"

namespace twopass {

/// Every light belongs to one group: that named by its `light_group`, else by its own name, else "default"; the
/// environment to "environment". Names are reduced to letters, digits, '-' and '_', anything else becomes '_',
/// so that layers can be called by them; lights whose names are the same then share a group.
class LightGroups {
 public:
  /// Groups in the order of their first light; of those that shine alone.
  explicit LightGroups(const SceneDescription& scene);

  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] std::size_t size() const { return names_.size(); }
  /// The group of a light by its number (Lights). REQUIRES: it shines.
  [[nodiscard]] std::uint32_t of(std::uint32_t light) const { return group_[light]; }
  /// The scene with the lights of one group alone: geometry and materials stay as they are.
  [[nodiscard]] SceneDescription lit_by(const SceneDescription& scene, std::uint32_t group) const;

 private:
  void add(std::uint32_t light, const std::string& name);

  std::vector<std::string> names_;
  std::vector<std::uint32_t> group_;  // by light
};

}  // namespace twopass
