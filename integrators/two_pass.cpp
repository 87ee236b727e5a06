#include "integrators/two_pass.h"

#include "integrators/look_up.h"
#include "integrators/trace.h"

namespace twopass {

namespace {

// The field knows what arrives around the geometric normal, within rounding errors of this, and about what does
// around others that are not more tilted.
constexpr float flat_cosine = 0.9999f, least_cosine = 0.94f;

bool is_all_diffuse(const Bsdf& bsdf) {
  return std::holds_alternative<Diffuse>(bsdf) || std::holds_alternative<RoughDiffuse>(bsdf);
}

// Where all that is reflected diffusely has been looked up: what is left is glossy, or nothing.
Step after_look_up(Vertex& vertex) {
  if (is_all_diffuse(vertex.bsdf())) return Step::end;
  vertex.leave_out_diffuse();
  return std::holds_alternative<Plastic>(vertex.bsdf()) ? Step::scatter : Step::light_and_scatter;
}

// What is left to be found by rays.
Step step_after(Known known, Vertex& vertex) {
  switch (known) {
    case Known::nothing:
      break;
    case Known::no_direct:
      return Step::scatter;
    case Known::indirect:
      if (is_all_diffuse(vertex.bsdf())) return Step::light;
      vertex.leave_out_indirect_diffuse();
      break;
    case Known::all:
      return Step::end;
  }
  return Step::light_and_scatter;
}

}  // namespace

IndirectField::LookUp TwoPass::look_up(const Vertex& vertex) const {
  if (!field_ || is_black(diffuse_reflectance(vertex.bsdf()))) return {};
  const SurfacePoint& point = vertex.point();
  const float cosine = point.shading.n.dot(point.geometric_normal);
  if (cosine < least_cosine) return {};
  IndirectField::LookUp found = field_->at(vertex.place());
  const bool is_tilted = cosine < flat_cosine;
  // How much of it coats let through depends on where light comes from: lamps are sampled there (radiosity,
  // R50).
  if (found.known == Known::all && (is_tilted || !std::holds_alternative<Diffuse>(vertex.bsdf())))
    found = {Known::indirect, found.irradiance - field_->direct_at(vertex.place())};
  if (!is_tilted) return found;
  if (found.known != Known::indirect) return {};
  found.irradiance = field_->tilted(found.irradiance, vertex.place(), point.geometric_normal, point.shading.n);
  return found;
}

// (I19)
void TwoPass::add_caustics(Vertex& vertex) const {
  const SurfacePoint& point = vertex.point();
  const C3f albedo = vertex.diffuse_albedo() * (1.0f / pi_f);
  vertex.add_caustic(albedo * caustics_->irradiance(point));
  if (!vertex.has_layers()) return;
  caustics_->visit(point, [&](const C3f& irradiance, std::uint32_t light) {
    vertex.add_caustic_to_layers(albedo * irradiance, light);
  });
}

// Finds the element, and asks for what is kept of it: each would be waited for in turn.
void TwoPass::look_ahead(Vertex& vertex) const {
  if (!solution_ || is_specular(vertex.bsdf())) return;
  vertex.set_place(solution_->mesh().locate(vertex.point()));
  const std::uint32_t element = vertex.element();
  if (element == no_index) return;
  __builtin_prefetch(&solution_->irradiances()[element]);
  if (field_) field_->prefetch(element);
  if (guide_) guide_->prefetch(element);
}

Step TwoPass::at(Vertex& vertex) const {
  if (caustics_) {
    if (scene_.side(vertex.point()).scatters_without_diffusing())
      vertex.pass_on_caustics();
    else
      vertex.set_has_caustics();
  }
  if (is_specular(vertex.bsdf())) return Step::scatter;
  // Only the end of a gather ray may be looked up, and the solution knows diffuse reflection alone.
  if (solution_ && vertex.gathers() && vertex.scatterings() >= least_scatterings_ &&
      !is_black(diffuse_reflectance(vertex.bsdf())) &&
      resolves(solution_->mesh(), vertex.element(), vertex.distance())) {
    const Irradiance& irradiance = solution_->irradiances()[vertex.element()];
    vertex.add(vertex.diffuse_albedo() * irradiance.total() * (1.0f / pi_f), irradiance, LookUp::element);
    return after_look_up(vertex);
  }
  if (caustics_ && !is_black(diffuse_reflectance(vertex.bsdf()))) add_caustics(vertex);
  const IndirectField::LookUp found = look_up(vertex);
  if (found.known >= Known::indirect) {
    const bool has_direct = found.known == Known::all && vertex.has_layers();
    const C3f direct = has_direct ? field_->direct_at(vertex.place()) : C3f(0.0f);
    vertex.add(vertex.diffuse_albedo() * found.irradiance * (1.0f / pi_f), {direct, found.irradiance - direct},
               LookUp::field);
  }
  const Step step = step_after(found.known, vertex);
  if (guide_ && step >= Step::scatter && found.known < Known::indirect && vertex.element() != no_index)
    vertex.guide_by(guide_->at(vertex.element(), vertex.point().geometric_normal));
  return step;
}

void TwoPass::trace(std::span<PathSample> samples, RayCounts& counts) const {
  struct AtVertex {
    const TwoPass& integrator;
    Step operator()(Vertex& vertex) const { return integrator.at(vertex); }
    void look_ahead(Vertex& vertex) const { integrator.look_ahead(vertex); }
  };
  trace_bundles(scene_, limits_, samples, counts, AtVertex{*this});
}

}  // namespace twopass
