#include "integrators/unbiased.h"

#include "integrators/look_up.h"
#include "integrators/read_errors.h"
#include "integrators/trace.h"

namespace twopass {

namespace {

// A path survives with the part of the picture's radiance that it is expected to bring, times this (I12).
constexpr float window = 2.0f;
// What is known of it counts so much: to find it again is not what the path is for.
constexpr float share_of_known = 0.5f;
// Never less often than this, so that light of which the solution knows nothing is not too dear.
constexpr float least_survival = 0.25f;
// With fewer edges than this, what the solution holds of longer paths would count.
constexpr int least_long_depth = 16;
// The root mean square over the channels of what the path brings as a part of what is expected.
float relative(const C3f& brings, const C3f& expected) {
  float sum = 0.0f;
  for (int c = 0; c < 3; ++c)
    if (expected[c] > 0.0f) sum += (brings[c] / expected[c]) * (brings[c] / expected[c]);
  return std::sqrt(sum * (1.0f / 3.0f));
}

// Ends the path with what the solution says that it would still find, or has it go on for the rest (I12).
// `known`: direct light that needs not be found, W/m2, but says how much the path carries. False: ended.
bool settle(Vertex& vertex, const Irradiance& irradiance, const C3f& known) {
  const C3f to_radiance = vertex.diffuse_albedo() * (1.0f / pi_f);
  const C3f cached = to_radiance * irradiance.total(), direct = to_radiance * known;
  C3f& expected = vertex.expected();
  float survival = 1.0f;
  if (is_black(expected))
    expected = vertex.throughput() * (cached + direct);
  else if (!is_black(cached + direct))
    survival = std::clamp(window * relative(vertex.throughput() * (cached + direct * share_of_known), expected),
                          least_survival, 1.0f);
  if (vertex.is_long()) survival = std::min(survival, vertex.survival());
  if (survival >= 1.0f) {
    vertex.settle(1.0f);
    return true;
  }
  if (vertex.sampler().next_1d() >= survival) {
    vertex.add(cached, irradiance, LookUp::element);
    return false;
  }
  const float scale = 1.0f / survival;
  vertex.add(cached * (1.0f - scale), irradiance, LookUp::element);
  vertex.settle(scale);
  return true;
}

}  // namespace

Unbiased::Unbiased(const Scene& scene, const PassOne& pass_one, const PathLimits& limits)
    : scene_(scene), solution_(pass_one.solution), guide_(pass_one.guide), limits_(limits) {
  // The mean is right under any limit, but what a short path would find is not what the solution holds.
  const bool is_short = limits.max_depth >= 0 && limits.max_depth < least_long_depth;
  returns_cached_ = solution_ != nullptr && !is_short && !is_clamped(limits);
  // Clamps are for single samples of light.
  if (solution_ && !is_clamped(limits)) certain_.emplace(scene, solution_->mesh());
}

// Finds the element, and asks for what is kept of it: each would be waited for in turn.
void Unbiased::look_ahead(Vertex& vertex) const {
  if (!solution_ || is_specular(vertex.bsdf())) return;
  vertex.set_place(solution_->mesh().locate(vertex.point()));
  const std::uint32_t element = vertex.element();
  if (element == no_index) return;
  __builtin_prefetch(&solution_->irradiances()[element]);
  if (certain_) certain_->prefetch(element);
  if (guide_) guide_->prefetch(element);
}

Step Unbiased::at(Vertex& vertex) const {
  if (is_specular(vertex.bsdf())) return Step::scatter;
  const SurfacePoint& point = vertex.point();
  const std::uint32_t element = vertex.element();
  if (element == no_index) return Step::light_and_scatter;
  Step step = Step::light_and_scatter;
  // The solution knows what is reflected diffusely: others go on as in the path tracer.
  if (!is_black(diffuse_reflectance(vertex.bsdf()))) {
    Irradiance rest = solution_->irradiances()[element];
    if (vertex.sample().errors) [[unlikely]]
      record(vertex, rest);
    C3f known(0.0f);
    if (certain_ && std::holds_alternative<Diffuse>(vertex.bsdf()) && certain_->knows(element) &&
        point.shading.n == point.geometric_normal) {
      known = add_direct(vertex, element);
      rest.direct = C3f(0.0f);
      step = Step::scatter;
    }
    if (returns_cached_ && !settle(vertex, rest, known)) return Step::end;
  }
  if (guide_) vertex.guide_by(guide_->at(element, point.geometric_normal));
  return step;
}

// (I20). What others than Lambert's surfaces reflect is more than the solution knows: theirs is left to the
// vertex before.
void Unbiased::record(const Vertex& vertex, const Irradiance& irradiance) const {
  if (!std::holds_alternative<Diffuse>(vertex.bsdf())) return;
  ReadErrors& errors = *vertex.sample().errors;
  if (!errors.has_begun() &&
      !(vertex.gathers() && resolves(solution_->mesh(), vertex.element(), vertex.distance())))
    return;
  errors.arrive(
      vertex.element(), static_cast<double>(mean_component(vertex.sample().seen.radiance)),
      static_cast<double>(mean_component(vertex.throughput() * reflected_radiance(vertex.bsdf(), irradiance))));
}

// Adds the direct light that is known, and says how much it is.
C3f Unbiased::add_direct(Vertex& vertex, std::uint32_t element) const {
  C3f sum(0.0f);
  certain_->visit(element, vertex.point().position, vertex.point().geometric_normal,
                  [&](const C3f& irradiance, std::uint32_t light) {
                    sum += irradiance;
                    vertex.add_direct(irradiance, light);
                  });
  vertex.set_has_direct();
  return sum;
}

void Unbiased::trace(std::span<PathSample> samples, RayCounts& counts) const {
  struct AtVertex {
    const Unbiased& integrator;
    Step operator()(Vertex& vertex) const { return integrator.at(vertex); }
    void look_ahead(Vertex& vertex) const { integrator.look_ahead(vertex); }
  };
  trace_bundles(scene_, limits_, samples, counts, AtVertex{*this});
}

}  // namespace twopass
