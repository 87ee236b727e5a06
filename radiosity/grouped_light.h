// The light of a solution by light group: for pictures in layers that add up, the cached light included.
#pragma once

#include <vector>

#include "radiosity/indirect_field.h"
#include "radiosity/solution.h"
#include "render/scene/light_groups.h"

namespace twopass {

/// What an integrator has looked up.
enum class LookUp : std::uint8_t {
  element,  ///< Solution::irradiance
  smooth,   ///< Solution::smooth_irradiance
  field,    ///< IndirectField::at, but for the light of lamps
  lamps     ///< that light
};

/// Solves once a group, on the elements of the solution of all lights (R45). Light is linear, so that the
/// groups add up to it, within the errors of the solvers. REQUIRES: `solution` is of the scene; options as for
/// it. Throws what solve_radiosity throws.
GroupedIrradiance solve_by_group(const Scene& scene, const LightGroups& groups, const Solution& solution,
                                 const RadiosityOptions& options);

/// A solution for each light group; what is divided by them adds up exactly. Const and thread-safe once built.
class GroupedLight {
 public:
  /// Prepares an IndirectField a group if `with_field`. REQUIRES: the scene outlives this; `solution` is of the
  /// scene, and so are the groups, on its elements.
  GroupedLight(const Scene& scene, const Solution& solution, GroupedIrradiance groups, bool with_field,
               const IndirectFieldOptions& field_options = {});

  /// Adds to each group its part of `radiance`, in proportion to what a look-up at the point finds of it. Where
  /// no group has any, all goes to the first one. REQUIRES: one colour a group; built with fields for
  /// LookUp::field.
  void divide(const C3f& radiance, const SurfacePoint& point, LookUp look_up, std::span<C3f> groups) const;

  [[nodiscard]] std::size_t size() const { return solutions_.size(); }
  [[nodiscard]] const Solution& solution(std::size_t group) const { return solutions_[group]; }

 private:
  [[nodiscard]] C3f light(std::size_t group, const SurfacePoint& point, LookUp look_up) const;

  std::vector<Solution> solutions_;
  std::vector<IndirectField> fields_;
};

}  // namespace twopass
