// Error against time and rays: every form factor method, solver and subdivision of the radiosity pass, as one
// CSV line each on stdout. Usage: radiosity_error SCENE... ; without a scene: those of the project.
//
// Two errors are measured at points spread evenly over the diffuse surfaces, over the mean reference:
//   look-up  mean |E - E_ref| of the irradiance read at the points: what a picture of the bare solution shows;
//   gather   mean |G - G_ref| of the irradiance gathered there along rays that read the solution where they
//            end: what a picture of two passes shows, before noise; and its mean without the bars, the bias.
// The reference is gathered in the same rays from a solution of 262,144 elements and 128 rays an element, so
// that the gathering itself makes no difference; its direct light comes from sampled lights.
#include <cstdio>

#include "radiosity/solution.h"
#include "radiosity/specular_path.h"
#include "render/core/distribution.h"
#include "render/core/parallel.h"
#include "render/core/warp.h"
#include "render/load/load.h"
#include "render/stopwatch.h"

namespace twopass {
namespace {

constexpr std::uint32_t points = 600, gather_rays = 1024, light_samples = 1024;

struct GatherRay {
  SurfacePoint end;
  C3f weight;  // over specular surfaces; black: it ends on nothing that is in the solution
};

// A point of the reference and everything that is seen from there.
struct Probe {
  SurfacePoint point;
  C3d direct{0.0};
  std::vector<GatherRay> ray;
};

std::optional<SurfacePoint> surface_at(const Scene& scene, const ElementPoint& at) {
  const V3f normal(at.normal);
  const Ray ray{at.ray_position() + normal * (3.0f * at.offset), -normal};
  const Hit hit = scene.caster().intersect(ray);
  if (hit.escaped()) return std::nullopt;
  return scene.surface_point(ray, hit);
}

C3d direct_light(const Scene& scene, const V3f& start, const V3f& normal, std::uint32_t key) {
  C3d sum(0.0);
  const Lights lights(scene.shapes());  // the sky is found by the gather rays
  for (std::uint32_t k = 0; k < light_samples && !lights.empty(); ++k) {
    const LightSample light = lights.sample({start, normal, true}, Sampler(key, 1, k).next_2d());
    const float cosine = light.direction.dot(normal);
    if (light.pdf_w > 0.0f && cosine > 0.0f && !scene.caster().occluded(start, light.position))
      sum += C3d(light.radiance) * static_cast<double>(cosine / light.pdf_w);
  }
  return sum / static_cast<double>(light_samples);
}

Probe look_around(const Scene& scene, const SurfacePoint& point, std::uint32_t key) {
  Probe probe{point, C3d(0.0), {}};
  const V3f normal = point.geometric_normal, start = spawn_position(point, normal);
  probe.direct = direct_light(scene, start, normal, key);
  for (std::uint32_t k = 0; k < gather_rays; ++k) {
    Sampler sampler(key, 2, k);
    const Ray ray{start, Frame(normal).to_world(square_to_cosine_hemisphere(sampler.next_2d()))};
    const Hit hit = scene.caster().intersect(ray);
    if (hit.escaped()) {
      probe.direct += C3d(scene.environment().radiance(ray.direction)) * (pi / gather_rays);
      continue;
    }
    const SurfacePoint end = scene.surface_point(ray, hit);
    if (!scene.side(end).scatters_without_diffusing()) {
      probe.ray.push_back({end, C3f(1.0f)});
      continue;
    }
    const SpecularPathEnd chain = follow_specular(scene, ray, end, Carried::radiance, sampler);
    if (!chain.escaped && !is_black(chain.weight)) probe.ray.push_back({chain.point, chain.weight});
  }
  return probe;
}

std::vector<Probe> place_probes(const Scene& scene, const ElementMesh& mesh) {
  std::vector<double> area(mesh.count());
  for (std::uint32_t i = 0; i < mesh.count(); ++i) area[i] = mesh.area(i);
  const DiscreteDistribution choice(area);
  std::vector<std::optional<Probe>> found(points);
  parallel_for(points, 8, [&](std::size_t begin, std::size_t end) {
    for (auto k = static_cast<std::uint32_t>(begin); k < end; ++k) {
      const std::uint32_t element = choice.sample((static_cast<float>(k) + 0.5f) / points).index;
      const auto point = surface_at(scene, mesh.sample(element, Sampler(5, k, 0).next_2d()));
      if (point && mesh.find(*point) != no_index) found[k] = look_around(scene, *point, k);
    }
  });
  std::vector<Probe> probes;
  for (auto& probe : found)
    if (probe) probes.push_back(std::move(*probe));
  return probes;
}

C3d gathered(const Scene& scene, const Probe& probe, const Solution& solution) {
  C3d sum(0.0);
  for (const GatherRay& ray : probe.ray)
    sum += C3d(ray.weight * scene.side(ray.end).traits().mean_diffuse_reflectance *
               solution.irradiance(ray.end).total());
  return sum / static_cast<double>(gather_rays);
}

double mean_of(const C3d& x) { return (x.x + x.y + x.z) / 3.0; }

struct Reference {
  std::vector<Probe> probe;
  std::vector<C3d> gathered;
};

struct Errors {
  double look_up = 0.0, gather = 0.0, bias = 0.0;
};

Errors compare(const Scene& scene, const Reference& reference, const Solution& solution) {
  Errors errors;
  double total = 0.0, indirect = 0.0;
  for (std::size_t k = 0; k < reference.probe.size(); ++k) {
    const Probe& probe = reference.probe[k];
    const C3d truth = probe.direct + reference.gathered[k];
    const C3d gather = gathered(scene, probe, solution) - reference.gathered[k];
    const C3d look_up = C3d(solution.irradiance(probe.point).total()) - truth;
    errors.look_up += (std::abs(look_up.x) + std::abs(look_up.y) + std::abs(look_up.z)) / 3.0;
    errors.gather += (std::abs(gather.x) + std::abs(gather.y) + std::abs(gather.z)) / 3.0;
    errors.bias += mean_of(gather);
    total += mean_of(truth);
    indirect += mean_of(reference.gathered[k]);
  }
  return {errors.look_up / total, errors.gather / indirect, errors.bias / indirect};
}

struct Setting {
  const char* form_factors;
  const char* solver;
  std::size_t elements;
  std::uint32_t rays;
  const char* subdivision = "auto";
  double relative_error = 0.01;
};

// What is compared with what: form factors at several sizes, solvers on the same elements, sizes of elements.
constexpr Setting settings[] = {
    {"auto", "auto", 0, 0},
    // Form factors.
    {"rays", "cg", 500, 0, "uniform"},
    {"rays", "cg", 2000, 0, "uniform"},
    {"exact", "cg", 500, 0, "uniform"},
    {"exact", "cg", 2000, 0, "uniform"},
    {"point", "cg", 500, 0, "uniform"},
    {"point", "cg", 2000, 0, "uniform"},
    {"hemicube", "cg", 500, 0, "uniform"},
    {"hemicube", "cg", 2000, 0, "uniform"},
    // Solvers.
    {"rays", "lu", 2000, 0, "uniform"},
    {"rays", "jacobi", 2000, 0, "uniform"},
    {"rays", "gauss-seidel", 2000, 0, "uniform"},
    {"rays", "progressive", 2000, 0, "uniform"},
    {"auto", "hierarchical", 2000, 0, "uniform", 0.1},
    {"auto", "hierarchical", 2000, 0, "uniform", 0.01},
    {"auto", "stochastic", 2000, 64, "uniform"},
    {"auto", "stochastic", 2000, 512, "uniform"},
    // Rays and elements.
    {"rays", "cg", 8192, 32, "uniform"},
    {"rays", "cg", 8192, 128, "uniform"},
    {"rays", "cg", 16384, 64, "uniform"},
    {"rays", "cg", 65536, 32, "uniform"},
    {"auto", "stochastic", 16384, 64, "uniform"},
    {"auto", "stochastic", 65536, 32, "uniform"},
    {"auto", "hierarchical", 16384, 0, "uniform", 0.1},
    // Adaptive substructuring.
    {"rays", "cg", 1000, 0, "adaptive"},
    {"rays", "cg", 2000, 0, "adaptive"},
    {"rays", "cg", 4000, 0, "adaptive"},
    {"rays", "cg", 8192, 0, "adaptive"},
    {"rays", "cg", 16384, 0, "adaptive"},
    {"rays", "cg", 65536, 0, "adaptive"},
};

void measure(const std::string& file, const char* name) {
  const Scene scene(load_scene(file, {}).scene);
  RadiosityOptions fine;
  fine.max_elements = 262144;
  fine.rays_per_element = 128;
  fine.seed = 99;
  const Solution best = solve_radiosity(scene, fine);
  Reference reference{place_probes(scene, best.mesh()), {}};
  for (const Probe& probe : reference.probe) reference.gathered.push_back(gathered(scene, probe, best));
  for (const Setting& setting : settings) {
    RadiosityOptions options;
    options.form_factors =
        value_of_name<FormFactorMethod>(form_factor_method_names, setting.form_factors, "settings", "method");
    options.solver = value_of_name<Solver>(solver_names, setting.solver, "settings", "solver");
    options.subdivision =
        value_of_name<Subdivision>(subdivision_names, setting.subdivision, "settings", "subdivision");
    options.max_elements = setting.elements;
    options.rays_per_element = setting.rays;
    options.relative_error = setting.relative_error;
    try {
      const Stopwatch stopwatch;
      const Solution solution = solve_radiosity(scene, options);
      const double cpu = stopwatch.elapsed().cpu_seconds;
      const RadiosityStats& stats = solution.stats();
      const Errors errors = compare(scene, reference, solution);
      std::printf("%s,%s%s,%s,%s,%zu,%llu,%zu,%.3f,%.5f,%.5f,%+.5f,%.3g,%zu\n", name,
                  stats.form_factors.c_str(), setting.elements == 0 ? " (default)" : "", stats.solver.c_str(),
                  setting.subdivision, stats.elements, static_cast<unsigned long long>(stats.rays), stats.links,
                  cpu, errors.look_up, errors.gather, errors.bias, stats.error_bound, stats.memory_bytes);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s, %s, %s: %s\n", name, setting.form_factors, setting.solver, error.what());
    }
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace twopass

int main(int argc, char** argv) {
  std::printf(
      "scene,form factors,solver,subdivision,elements,rays,links,cpu seconds,look-up error,gather error,"
      "gather bias,bound,bytes\n");
  if (argc > 1) {
    for (int k = 1; k < argc; ++k) twopass::measure(argv[k], argv[k]);
    return 0;
  }
  for (const char* name : {"cornell-box", "cove", "hidden", "cornell-box-specular"})
    twopass::measure(std::string(TWOPASS_SOURCE_DIR "/scenes/") + name + "/scene.xml", name);
}
