#include "radiosity/grouped_light.h"

namespace twopass {

GroupedIrradiance solve_by_group(const Scene& scene, const LightGroups& groups, const Solution& solution,
                                 const RadiosityOptions& options) {
  GroupedIrradiance grouped;
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    const Scene lit(groups.lit_by(scene.description(), g));
    const Solution of_group = solve_radiosity_on(lit, solution.mesh(), options);
    const std::span<const Irradiance> irradiance = of_group.irradiances();
    grouped.names.push_back(groups.names()[g]);
    grouped.by_group.emplace_back(irradiance.begin(), irradiance.end());
  }
  return grouped;
}

GroupedLight::GroupedLight(const Scene& scene, const Solution& solution, GroupedIrradiance groups,
                           bool with_field, const IndirectFieldOptions& field_options) {
  solutions_.reserve(groups.by_group.size());  // fields point into them
  IndirectFieldOptions indirect = field_options;
  indirect.with_direct = false;
  for (std::vector<Irradiance>& irradiance : groups.by_group) {
    solutions_.emplace_back(solution.mesh(), std::move(irradiance), solution.stats());
    if (with_field) fields_.emplace_back(scene, solutions_.back(), indirect);
  }
}

C3f GroupedLight::light(std::size_t group, const SurfacePoint& point, LookUp look_up) const {
  switch (look_up) {
    case LookUp::smooth:
      return solutions_[group].smooth_irradiance(point).total();
    case LookUp::field:
      return fields_[group].indirect_at_any(point);
    case LookUp::lamps:
      return solutions_[group].smooth_irradiance(point).direct;
    case LookUp::element:
      break;
  }
  return solutions_[group].irradiance(point).total();
}

void GroupedLight::divide(const C3f& radiance, const SurfacePoint& point, LookUp look_up,
                          std::span<C3f> groups) const {
  C3f sum(0.0f);
  for (std::size_t g = 0; g < groups.size(); ++g) sum += light(g, point, look_up);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const C3f part = light(g, point, look_up);
    for (int c = 0; c < 3; ++c)
      groups[g][c] += sum[c] > 0.0f ? radiance[c] * (part[c] / sum[c]) : g == 0 ? radiance[c] : 0.0f;
  }
}

}  // namespace twopass
