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

std::optional<C3f> TwoPass::indirect(const Vertex& vertex) const {
  if (!field_ || !std::holds_alternative<Diffuse>(vertex.bsdf())) return std::nullopt;
  const SurfacePoint& point = vertex.point();
  if (point.shading.n.dot(point.geometric_normal) < flat_cosine) return std::nullopt;
  return field_->at(point);
}

void TwoPass::trace(std::span<PathSample> samples, RayCounts& counts) const {
  trace_bundles(scene_, limits_, samples, counts, [this](Vertex& vertex) {
    if (is_specular(vertex.bsdf())) return Step::scatter;
    // Only the end of a gather ray may be looked up, and the solution knows diffuse reflection alone.
    if (vertex.gathers() && std::holds_alternative<Diffuse>(vertex.bsdf()) &&
        resolves(vertex.point(), vertex.distance())) {
      vertex.add(reflected_radiance(vertex.bsdf(), solution_->irradiance(vertex.point())));
      return Step::end;
    }
    if (const std::optional<C3f> irradiance = indirect(vertex)) {
      vertex.add(diffuse_reflectance(vertex.bsdf()) * *irradiance * (1.0f / pi_f));
      return Step::light;
    }
    return Step::light_and_scatter;
  });
}

}  // namespace twopass
