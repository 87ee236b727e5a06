#include "render/view_probe.h"

#include <array>
#include <cmath>
#include <vector>

#include "integrators/path.h"
#include "integrators/trace.h"
#include "radiosity/solution.h"
#include "render/core/parallel.h"
#include "render/image/compare.h"

namespace twopass {

namespace {

constexpr int parts_a_side = 8;
constexpr std::uint32_t pairs_of_a_part = 32;
constexpr double variance_of_gathering = 0.25;
// Measured at 512x512, all that is left of two passes' variance included: 4 % in the Cornell box, where half of
// it is soft shadows and edges, .7 % in the cove and the hidden room, 2.4 % in the room behind a door.
constexpr double variance_of_looking_up = 0.05;
// A path brighter than this many times its surroundings counts as one that is as bright: there are too few
// paths to tell how rare it is.
constexpr double brightest = 20.0;
// So that the samples are none of the picture's.
constexpr std::uint32_t own_seeds = 0x5a3c91e7u;

// The path tracer up to where `twopass` would read a solution.
class WithoutSolution final : public Integrator {
 public:
  WithoutSolution(const Scene& scene, const PathLimits& limits, bool caustics_known)
      : scene_(scene), limits_(limits), caustics_known_(caustics_known) {}
  void trace(std::span<PathSample> samples, RayCounts& counts) const override {
    trace_bundles(scene_, limits_, samples, counts, [this](Vertex& vertex) {
      if (caustics_known_ && scene_.side(vertex.point()).scatters_without_diffusing())
        vertex.pass_on_caustics();
      else if (caustics_known_)
        vertex.set_has_caustics();
      if (is_specular(vertex.bsdf())) return Step::scatter;
      if (vertex.gathers() && !is_black(diffuse_reflectance(vertex.bsdf()))) return Step::end;
      return Step::light_and_scatter;
    });
  }

 private:
  const Scene& scene_;
  PathLimits limits_;
  bool caustics_known_;
};

struct Look {
  double mean = 0.0, variance = 0.0, rays = 0.0;  // of a path
};

// Half of the mean squared difference between two samples of the same ray is their variance, here relative to
// the surroundings as relMSE is. `surroundings`: their mean radiance; 0: this look's own.
Look look(const Integrator& integrator, const std::vector<PathSample>& samples, double surroundings) {
  std::vector<PathSample> first = samples, second;
  for (const PathSample& sample : samples) {
    second.push_back(sample);
    second.back().sampler = Sampler(own_seeds, 1, static_cast<std::uint32_t>(second.size()));
  }
  RayCounts counts;
  integrator.trace(first, counts);
  integrator.trace(second, counts);
  const double n = static_cast<double>(samples.size());
  Look result;
  for (std::size_t i = 0; i < samples.size(); ++i)
    result.mean += 0.5 * (mean_component(first[i].seen.radiance) + mean_component(second[i].seen.radiance)) / n;
  result.rays = static_cast<double>(counts.rays + counts.shadow_rays) / (2.0 * n);
  const double unit = surroundings > 0.0 ? surroundings : result.mean;
  if (!(unit > 0.0) || !std::isfinite(unit)) return result;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double difference = std::min(mean_component(first[i].seen.radiance) / unit, brightest) -
                              std::min(mean_component(second[i].seen.radiance) / unit, brightest);
    result.variance += 0.5 * difference * difference / n;
  }
  result.variance *= unit * unit / (unit * unit + relmse_epsilon);
  return result;
}

std::vector<PathSample> samples_in(const Camera& camera, const PixelWindow& window, std::uint32_t part,
                                   std::uint32_t seed) {
  const V2f size = V2f(window.size) / static_cast<float>(parts_a_side);
  const V2f corner = V2f(window.corner) + V2f(static_cast<float>(part % parts_a_side) * size.x,
                                              static_cast<float>(part / parts_a_side) * size.y);
  std::vector<PathSample> samples;
  for (std::uint32_t k = 0; k < pairs_of_a_part; ++k) {
    Sampler sampler(seed ^ own_seeds, part, k);
    const V2f at = corner + size * sampler.next_2d();
    const CameraRay seen = camera.has_lens() ? camera.ray(at, sampler.next_2d()) : camera.ray(at);
    samples.push_back({seen.ray, sampler, {}, seen.reach});
  }
  return samples;
}

// What solving takes at least of a scene that has more triangles than a picture needs elements, in rays of the
// picture: 500 for each element. In Bitterli's staircase all of pass one took 7.6 CPU seconds for 17,731
// elements, nearly 1000 rays of that picture for each. Others take tenths of a second.
double rays_of_pass_one(const Scene& scene, std::size_t pixels) {
  constexpr std::size_t many = 8192;
  constexpr double rays_of_an_element = 500.0;
  const std::size_t elements = element_limit(scene, {.gathered_pixels = pixels, .affordable_elements = 1});
  return elements > many ? rays_of_an_element * static_cast<double>(elements) : 0.0;
}

// What is left where so much stays of the variance of what the solution brings.
double variance_left(const ViewProbe& probe, double of_what_is_brought) {
  const double brought = std::max(0.0, probe.variance - probe.variance_without);
  return std::min(probe.variance, probe.variance_without) + of_what_is_brought * brought;
}

}  // namespace

double ViewProbe::gain() const {
  const double left = variance_left(*this, variance_of_gathering);
  return left > 0.0 ? variance * rays / (left * rays_without) : 1.0;
}

double ViewProbe::paths_of_a_sample() const {
  const double left = variance_left(*this, variance_of_looking_up);
  return left > 0.0 ? variance / left : 1.0;
}

double ViewProbe::error_of(double samples) const {
  return std::sqrt(variance_left(*this, variance_of_looking_up) / samples);
}

ViewProbe probe_view(const Scene& scene, const Camera& camera, const PixelWindow& window,
                     const PathLimits& limits, std::uint32_t seed, bool caustics_known) {
  constexpr std::size_t parts = std::size_t{parts_a_side} * parts_a_side;
  std::array<ViewProbe, parts> probes;
  const PathTracer path(scene, limits);
  const WithoutSolution without(scene, limits, caustics_known);
  parallel_for(parts, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t part = begin; part < end; ++part) {
      const std::vector<PathSample> samples =
          samples_in(camera, window, static_cast<std::uint32_t>(part), seed);
      const Look all = look(path, samples, 0.0), some = look(without, samples, all.mean);
      probes[part] = {all.variance, all.rays, some.variance, some.rays};
    }
  });
  ViewProbe sum;
  for (const ViewProbe& probe : probes) {
    sum.variance += probe.variance / parts;
    sum.rays += probe.rays / parts;
    sum.variance_without += probe.variance_without / parts;
    sum.rays_without += probe.rays_without / parts;
  }
  return sum;
}

std::optional<ViewProbe> fit_to_view(Plan& plan, IntegratorKind integrator, const Scene& scene,
                                     const Camera& camera, const PixelWindow& window, const PathLimits& limits,
                                     std::uint32_t seed, double picture_rays, bool has_solution) {
  if (!plan.radiosity_pass || integrator != IntegratorKind::two_pass) return std::nullopt;
  const ViewProbe probe = probe_view(scene, camera, window, limits, seed, plan.caustic_map);
  const auto pixels = static_cast<std::size_t>(window.size.x) * static_cast<std::size_t>(window.size.y);
  if (has_solution) return probe;
  if (probe.gain() < least_gain) {
    const bool sees_none = probe.variance_without >= probe.variance;
    plan = {.skipped = {{"radiosity pass",
                         sees_none ? "the picture sees no light that goes from one diffuse surface to another"
                                   : "tracing paths is cheaper for this view"}}};
  } else if (picture_rays > 0.0 && (probe.gain() - 1.0) * picture_rays < rays_of_pass_one(scene, pixels)) {
    plan = {.skipped = {
                {"radiosity pass", "for so few samples of so many surfaces it would cost more than it saves"}}};
  }
  return probe;
}

}  // namespace twopass
