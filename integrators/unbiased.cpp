#include "integrators/unbiased.h"

#include "integrators/guided_directions.h"
#include "integrators/look_up.h"
#include "integrators/trace.h"

namespace twopass {

namespace {

// A path survives with the part of the picture's radiance that it is expected to bring, times this (I12).
constexpr float window = 2.0f;
// Never less often than this, so that light of which the solution knows nothing is not too dear.
constexpr float least_survival = 0.1f;
// Of the directions of surfaces that do not reflect by the cosine alone.
constexpr float guided_share = 0.5f;

// The part of the directions that the guide draws. Under one flat normal the cosine that it knows is all there
// is.
float share_of_guide(const Walk& walk, const Guide::Lobe& lobe) {
  if (lobe.empty()) return 0.0f;
  const bool is_flat = walk.point().shading.n == walk.point().geometric_normal;
  if (std::holds_alternative<Diffuse>(walk.bsdf()) && is_flat) return 1.0f;
  return is_black(diffuse_reflectance(walk.bsdf())) ? 0.0f : guided_share;
}

// The root mean square over the channels of what the path brings as a part of what is expected.
float relative(const C3f& brings, const C3f& expected) {
  float sum = 0.0f;
  for (int c = 0; c < 3; ++c)
    if (expected[c] > 0.0f) sum += (brings[c] / expected[c]) * (brings[c] / expected[c]);
  return std::sqrt(sum * (1.0f / 3.0f));
}

// Ends the path with what the solution says that it would still find, or has it go on for the rest (I12).
// False: ended.
bool settle(Walk& walk, const C3f& cached) {
  const C3f brings = walk.throughput() * cached;
  C3f& expected = walk.expected();
  float survival = 1.0f;
  if (is_black(expected))
    expected = brings;
  else
    survival = std::clamp(window * relative(brings, expected), least_survival, 1.0f);
  if (walk.is_long()) survival = std::min(survival, walk.survival());
  if (survival >= 1.0f) return true;
  if (walk.sampler().next_1d() >= survival) {
    walk.add(cached);
    return false;
  }
  const float scale = 1.0f / survival;
  walk.add(cached * (1.0f - scale));
  walk.scale(scale);
  return true;
}

}  // namespace

Unbiased::Unbiased(const Scene& scene, const Solution* solution, const Guide* guide, const PathLimits& limits)
    : scene_(scene), solution_(solution), guide_(guide), limits_(limits) {
  const bool is_limited =
      limits.max_depth >= 0 || std::isfinite(limits.clamp_direct) || std::isfinite(limits.clamp_indirect);
  returns_cached_ = solution != nullptr && !is_limited;
}

bool Unbiased::at_vertex(Walk& walk) const {
  if (is_specular(walk.bsdf())) return walk.leave();
  const std::uint32_t element = solution_ ? solution_->mesh().find(walk.point()) : no_index;
  // Only what Lambert's surfaces reflect does the solution know: others go on as in the path tracer.
  const bool is_known = returns_cached_ && element != no_index && std::holds_alternative<Diffuse>(walk.bsdf());
  if (is_known && !settle(walk, reflected_radiance(walk.bsdf(), solution_->irradiances()[element])))
    return false;
  const Guide::Lobe lobe =
      guide_ && element != no_index ? guide_->at(element, walk.point().geometric_normal) : Guide::Lobe();
  const GuidedDirections directions(walk.bsdf(), walk.wo(), walk.point().shading, lobe,
                                    share_of_guide(walk, lobe));
  walk.sample_lights(directions);
  return walk.leave(directions) && (is_known || walk.plays_roulette());
}

void Unbiased::trace(std::span<PathSample> samples, RayCounts& counts) const {
  trace_bundles(scene_, limits_, samples, counts, [this](Walk& walk) { return at_vertex(walk); });
}

}  // namespace twopass
