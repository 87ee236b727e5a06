#include "radiosity/solution.h"

#include <mutex>
#include <optional>

#include "radiosity/smoothing.h"

namespace twopass {

struct Solution::Smooth {
  std::once_flag once;
  std::optional<SmoothIrradiance> field;
};

Solution::Solution(ElementMesh mesh, std::vector<Irradiance> irradiance, RadiosityStats stats)
    : mesh_(std::move(mesh)),
      irradiance_(std::move(irradiance)),
      stats_(std::move(stats)),
      smooth_(std::make_unique<Smooth>()) {}
Solution::~Solution() = default;
Solution::Solution(Solution&&) noexcept = default;
Solution& Solution::operator=(Solution&&) noexcept = default;

Irradiance Solution::smooth_irradiance(const SurfacePoint& point) const {
  const ElementMesh::Location location = mesh_.locate(point);
  if (location.element == no_index) return {};
  std::call_once(smooth_->once, [&] { smooth_->field.emplace(mesh_, irradiance_); });
  return smooth_->field->at(location);
}

}  // namespace twopass
