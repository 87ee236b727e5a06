#include "integrators/two_pass.h"

#include "integrators/look_up.h"
#include "integrators/trace.h"

namespace twopass {

namespace {

// Gather rays shorter than this many element sizes come from so near that one constant irradiance cannot stand
// for what the vertex sees of the element: evaluate instead.
constexpr float contact_elements = 2.0f;
// The field knows what arrives around the geometric normal, within rounding errors of this.
constexpr float flat_cosine = 0.9999f;

}  // namespace

bool TwoPass::resolves(const SurfacePoint& point, float distance) const {
  if (!solution_) return false;
  const float size = solution_->element_size(point);
  return size > 0.0f && distance >= contact_elements * size;
}

std::optional<C3f> TwoPass::indirect(const Walk& walk) const {
  if (!field_ || !std::holds_alternative<Diffuse>(walk.bsdf())) return std::nullopt;
  const SurfacePoint& point = walk.point();
  if (point.shading.n.dot(point.geometric_normal) < flat_cosine) return std::nullopt;
  return field_->at(point);
}

void TwoPass::trace(std::span<PathSample> samples, RayCounts& counts) const {
  trace_bundles(scene_, limits_, samples, counts, [this](Walk& walk) {
    if (is_specular(walk.bsdf())) return walk.leave();
    // Only the end of a gather ray may be looked up, and the solution knows diffuse reflection alone.
    if (walk.gathers() && std::holds_alternative<Diffuse>(walk.bsdf()) &&
        resolves(walk.point(), walk.distance())) {
      walk.add(reflected_radiance(walk.bsdf(), solution_->irradiance(walk.point())));
      return false;
    }
    if (const std::optional<C3f> irradiance = indirect(walk)) {
      walk.sample_lights(Rival::none);
      walk.add(diffuse_reflectance(walk.bsdf()) * *irradiance * (1.0f / pi_f));
      return false;
    }
    walk.sample_lights();
    return walk.leave();
  });
}

}  // namespace twopass
