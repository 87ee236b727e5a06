#include "radiosity/adaptive.h"
#include "radiosity/assemble.h"
#include "radiosity/error_bound.h"
#include "radiosity/hierarchical.h"
#include "radiosity/importance.h"
#include "radiosity/solution.h"
#include "radiosity/solvers.h"
#include "radiosity/stochastic.h"
#include "radiosity/subdivision.h"
#include "radiosity/view_parts.h"
#include "radiosity/weights_from_afar.h"
#include "render/core/error.h"

namespace twopass {

namespace {

// Measured: below this the bias of a gathered picture grows faster than the time shrinks, above it is the other
// way round. Detailed scenes get one element for eight sides of triangles, up to the limit.
constexpr std::size_t least_elements_rays = 8192, most_elements_rays = 262144;
constexpr std::size_t default_elements_analytic = 1500;
// For pictures that are gathered: an element for 64 pixels, 64 rays an element. Measured in the Cornell box,
// the cove and the hidden room: pass one takes half the time, the bias of the picture stays within .5 %.
constexpr std::size_t pixels_of_an_element = 64, least_elements_gathered = 2048,
                      least_elements_affordable = 2048;
constexpr double usual_error = 0.03;  // of a picture, for which that was measured
constexpr std::uint32_t rays_of_a_gathered_element = 64;
// Adaptive substructuring starts with this part of the elements, and its pilot solutions, which only have to
// show where the light changes, with so many rays an element.
constexpr std::size_t coarse_part = 8;
constexpr std::uint32_t pilot_rays = 32;
// Few elements must not miss what comes through a small opening, or nothing would say that they are too few.
constexpr std::size_t pilot_direct_rays = 1u << 16;
// Rays an element of the solver `stochastic` before it looks at its noise.
constexpr double first_stochastic_rays = 16.0;
// The part of the error that the iteration may use up.
constexpr double iteration_share = 0.1;
// An iteration cannot promise less than rounding allows.
constexpr double smallest_relative_error = 1e-10;

// What `automatic` and 0 stand for.
struct Choice {
  FormFactorMethod method;
  Solver solver;
  std::size_t max_elements;
  bool is_adaptive;
  bool is_for_gathering;  // chosen so that a picture may be gathered from it
};

std::size_t triangle_sides(const Scene& scene) {
  std::size_t sides = 0;
  for (std::uint32_t s = 0; s < scene.shapes().size(); ++s)
    for (const Side side : {front, back})
      if (const Mesh* mesh = mesh_of(scene.shapes()[s].geometry))
        sides += can_hold_radiosity(scene, s, side) ? mesh->triangles.size() : 0;
  return sides;
}

// `own`: what the solver's rays or links amount to.
void refuse_form_factors(const char* solver, FormFactorMethod method, FormFactorMethod own) {
  if (method == FormFactorMethod::automatic || method == own) return;
  std::string what("finds its own form factors and uses no ");
  what += name_of_value<FormFactorMethod>(form_factor_method_names, method);
  throw Error(solver, what, "leave --form-factors out");
}

// For a picture of so many pixels and of such an error, as far as there is time.
std::size_t elements_for_gathering(const RadiosityOptions& options) {
  constexpr auto least = double{least_elements_gathered}, most = double{least_elements_rays};
  const double of_pixels =
      std::clamp(static_cast<double>(options.gathered_pixels) / pixels_of_an_element, least, most);
  const double fit = std::clamp(of_pixels * usual_error / options.picture_error, least, most);
  std::size_t elements =
      std::min(static_cast<std::size_t>(fit) << (2 * options.refinement), most_elements_rays);
  if (options.affordable_elements > 0)
    elements = std::min(elements, std::max(options.affordable_elements, least_elements_affordable));
  return elements;
}

Choice choose(const Scene& scene, const RadiosityOptions& options) {
  Choice choice;
  const bool by_rays = options.solver == Solver::hierarchical ||
                       options.form_factors == FormFactorMethod::automatic ||
                       options.form_factors == FormFactorMethod::rays;
  choice.method = by_rays ? FormFactorMethod::rays : options.form_factors;
  choice.solver = options.solver;
  if (choice.solver == Solver::stochastic)
    refuse_form_factors("--solver stochastic", options.form_factors, FormFactorMethod::rays);
  if (choice.solver == Solver::hierarchical)
    refuse_form_factors("--solver hierarchical", options.form_factors, FormFactorMethod::exact);
  if (options.overshoot && choice.solver != Solver::progressive)
    throw Error("--overshoot", "only the solver progressive shoots", "use --solver progressive with it");
  choice.max_elements = default_elements_analytic;
  const std::size_t sides = triangle_sides(scene);
  // Who chooses a method or a number of elements compares, and wants the same elements for all of them.
  const bool all_automatic = options.subdivision == Subdivision::automatic &&
                             options.form_factors == FormFactorMethod::automatic &&
                             options.solver == Solver::automatic && options.max_elements == 0;
  choice.is_for_gathering = all_automatic && options.gathered_pixels > 0;
  if (by_rays) {
    choice.max_elements =
        std::clamp(sides / 8, choice.is_for_gathering ? elements_for_gathering(options) : least_elements_rays,
                   most_elements_rays);
  }
  if (choice.solver == Solver::lu)
    choice.max_elements = std::min<std::size_t>(choice.max_elements, lu_max_elements);
  if (options.max_elements) choice.max_elements = options.max_elements;
  choice.is_adaptive = options.subdivision == Subdivision::adaptive ||
                       (all_automatic && coarse_part * sides <= choice.max_elements);
  return choice;
}

// Whether the light of more reflections than the picture may have is too little to be told from an early stop:
// then it does no harm, and any solver is faster than adding reflection to reflection.
bool is_limit_negligible(const Balance& balance, const RadiosityOptions& options) {
  constexpr double negligible = 0.1;
  const Contraction q = contraction(balance);
  double largest = 0.0;
  for (int c = 0; c < 3; ++c) largest = std::max(largest, std::min(q.by_power[c], q.by_maximum[c]));
  const double left_out = std::pow(largest, options.max_reflections + 1);
  return left_out <= negligible * iteration_share * options.relative_error;
}

SolverResult run_solver(Solver solver, const Balance& balance, const RadiosityOptions& options) {
  const StopRule stop{std::max(iteration_share * options.relative_error, smallest_relative_error)};
  switch (solver) {
    case Solver::lu:
      return solve_lu(balance);
    case Solver::progressive:
      return solve_progressive(balance, stop, options.overshoot);
    case Solver::jacobi:
      return solve_jacobi(balance, stop);
    case Solver::cg:
      return solve_cg(balance, stop);
    case Solver::automatic:
    case Solver::gauss_seidel:
    case Solver::hierarchical:  // these have no such balance
    case Solver::stochastic:
      break;
  }
  return solve_gauss_seidel(balance, stop);
}

// What elements mean to a picture: the parts that see them, and what a solution says of light by way of others.
struct Importance {
  std::vector<double> parts, indirect{};
};

std::vector<Irradiance> solve_with_form_factors(const Scene& scene, ElementMesh& mesh,
                                                const RadiosityOptions& options, const Choice& choice,
                                                const CausticParticles& caustics, RadiosityStats& stats,
                                                Importance* importance) {
  const Balance balance = assemble_balance(scene, mesh, options, choice.method, caustics, stats);
  Solver solver = choice.solver;
  // Conjugate gradients are never slower, and much faster where little is absorbed, but they want symmetry.
  const bool is_symmetric = balance.specular.link.empty() && mesh.weights().empty();
  if (solver == Solver::automatic) solver = is_symmetric ? Solver::cg : Solver::gauss_seidel;
  const bool is_series = options.max_reflections >= 0 && !is_limit_negligible(balance, options);
  const SolverResult result =
      is_series ? solve_series(balance, options.max_reflections) : run_solver(solver, balance, options);
  if (importance) importance->indirect = indirect_importance(balance, result.radiosity, importance->parts);
  std::vector<Irradiance> irradiance(mesh.count());
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    irradiance[i] = {C3f(balance.direct[i]), C3f(result.irradiance[i])};
  stats.solver = is_series ? "series" : name_of_value<Solver>(solver_names, solver);
  stats.form_factors = name_of_value<FormFactorMethod>(form_factor_method_names, choice.method);
  stats.links = static_cast<std::size_t>(balance.exchange.nonZeros()) + balance.specular.link.size();
  stats.iterations = result.iterations;
  stats.residual = result.error.residual;
  stats.error_bound = result.error.bound;
  stats.memory_bytes = mesh.memory_bytes() + irradiance.size() * sizeof(Irradiance) +
                       static_cast<std::size_t>(balance.exchange.nonZeros()) * (sizeof(float) + sizeof(int)) +
                       balance.specular.link.size() * sizeof(SpecularLink);
  return irradiance;
}

std::vector<Irradiance> solve_stochastically(const Scene& scene, ElementMesh& mesh,
                                             const RadiosityOptions& options, const CausticParticles& caustics,
                                             RadiosityStats& stats) {
  clamped_reflectances(mesh, stats);  // says so
  std::vector<C3f> direct;
  {
    const FirstLight light =
        find_first_light(scene, mesh, options, FormFactorMethod::rays, Keep::totals, caustics, stats);
    direct.assign(light.direct.begin(), light.direct.end());
  }
  StochasticOptions stochastic;
  stochastic.relative_error = std::max(options.relative_error, smallest_relative_error);
  stochastic.until_relative_error = options.rays_per_element == 0;
  stochastic.rays_per_element =
      stochastic.until_relative_error ? first_stochastic_rays : options.rays_per_element;
  stochastic.max_reflections = options.max_reflections;
  stochastic.seed = options.seed;
  const StochasticResult result = solve_stochastic(scene, mesh, direct, stochastic);
  stats.solver = name_of_value<Solver>(solver_names, Solver::stochastic);
  stats.form_factors = "none";
  stats.iterations = result.iterations;
  stats.rays += result.rays;
  stats.residual = result.residual;
  stats.error_bound = result.error_bound;
  stats.memory_bytes = mesh.memory_bytes() + mesh.count() * stochastic_bytes_per_element;
  std::vector<Irradiance> irradiance(mesh.count());
  for (std::uint32_t i = 0; i < mesh.count(); ++i) irradiance[i] = {direct[i], result.irradiance[i]};
  return irradiance;
}

std::vector<Irradiance> solve_with_links(const Scene& scene, ElementMesh& mesh, const RadiosityOptions& options,
                                         const CausticParticles& caustics, RadiosityStats& stats) {
  const std::vector<C3f> reflectance = clamped_reflectances(mesh, stats);
  const FirstLight light =
      find_first_light(scene, mesh, options, FormFactorMethod::exact, Keep::links, caustics, stats);
  const HierarchicalResult result = solve_hierarchical(
      scene, mesh, {reflectance, light.direct, light.specular, light.sums, options.max_reflections},
      StopRule{std::max(options.relative_error, smallest_relative_error)}, options.seed);
  stats.solver = name_of_value<Solver>(solver_names, Solver::hierarchical);
  stats.form_factors = name_of_value<FormFactorMethod>(form_factor_method_names, FormFactorMethod::exact);
  stats.closure_error = result.closure_error;
  stats.links = result.links + result.specular_links;
  stats.iterations = result.solution.iterations;
  stats.rays += result.rays;
  stats.residual = result.solution.error.residual;
  stats.error_bound = result.solution.error.bound;
  stats.memory_bytes = mesh.memory_bytes() + mesh.count() * sizeof(Irradiance) + result.memory_bytes;
  std::vector<Irradiance> irradiance(mesh.count());
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    irradiance[i] = {C3f(light.direct[i]), C3f(result.solution.irradiance[i])};
  return irradiance;
}

// Solves on the given elements, exposes them, and fills in the statistics, adding up rays. What is to be known
// of `importance` only a balance of form factors says.
std::vector<Irradiance> solve_on(const Scene& scene, ElementMesh& mesh, const RadiosityOptions& options,
                                 const Choice& choice, const CausticParticles& caustics, RadiosityStats& stats,
                                 Importance* importance = nullptr) {
  stats.elements = mesh.count();
  if (choice.solver == Solver::stochastic) return solve_stochastically(scene, mesh, options, caustics, stats);
  if (choice.solver == Solver::hierarchical) return solve_with_links(scene, mesh, options, caustics, stats);
  return solve_with_form_factors(scene, mesh, options, choice, caustics, stats, importance);
}

// Refines the coarse elements where solutions on them say that it matters, up to the number allowed.
ElementMesh refine_adaptively(const Scene& scene, ElementMesh mesh, const RadiosityOptions& options,
                              const Choice& choice, const CausticParticles& caustics, RadiosityStats& stats) {
  RadiosityOptions pilot = options;
  if (pilot.rays_per_element == 0) pilot.rays_per_element = pilot_rays;
  pilot.least_direct_rays = pilot_direct_rays;
  const Choice pilot_choice{choice.method, Solver::automatic, choice.max_elements, true, false};
  const std::vector<SurfacePoint> seen = seen_points(scene, options.view, options.seed, stats.rays);
  while (mesh.count() + 3 <= choice.max_elements) {
    RadiosityStats pilot_stats;
    Importance importance{parts_of(mesh, seen)};
    const std::vector<Irradiance> irradiance =
        solve_on(scene, mesh, pilot, pilot_choice, caustics, pilot_stats, seen.empty() ? nullptr : &importance);
    stats.rays += pilot_stats.rays;
    // A round at most doubles the number, so that the next one is better informed.
    const std::size_t room = std::min(choice.max_elements - mesh.count(), mesh.count()) / 3;
    const std::vector<bool> chosen =
        elements_to_split(mesh, irradiance, importance.parts, std::max<std::size_t>(1, room),
                          options.relative_error, importance.indirect);
    ElementMesh finer = mesh.split(chosen);
    if (finer.count() == mesh.count()) break;
    mesh = std::move(finer);
  }
  return mesh;
}

// The elements that the solution is found on. Where all is left to the program, for gathering, and triangles
// are so small that elements are not cut adaptively, they are weighted by what is seen of them.
ElementMesh final_elements(const Scene& scene, ElementMesh mesh, const RadiosityOptions& options,
                           const Choice& choice, const CausticParticles& caustics, RadiosityStats& stats) {
  if (choice.is_adaptive) return refine_adaptively(scene, std::move(mesh), options, choice, caustics, stats);
  if (choice.is_for_gathering && !options.view.empty())
    mesh.weigh(weights_from_afar(scene, mesh, options.view, options.seed, stats.rays));
  return mesh;
}

// On elements that are wholly exposed. `rays`: that were cast before.
Solution solve_from(const Scene& scene, ElementMesh mesh, const RadiosityOptions& options, const Choice& choice,
                    const CausticParticles* shot, bool is_final, std::uint64_t rays = 0) {
  RadiosityStats stats;
  stats.rays = rays;
  stats.max_reflections = options.max_reflections;
  const bool is_dark =
      scene.lights().empty() && scene.environment().is_black() && scene.punctual_lights().empty();
  if (mesh.count() == 0 || is_dark) {
    stats.solver = name_of_value<Solver>(solver_names, choice.solver);
    stats.form_factors = name_of_value<FormFactorMethod>(form_factor_method_names, choice.method);
    stats.elements = mesh.count();
    stats.notes.emplace_back(is_dark ? "nothing emits light" : "no surface reflects light diffusely");
    std::vector<Irradiance> darkness(mesh.count());
    return Solution(std::move(mesh), std::move(darkness), std::move(stats));
  }
  std::optional<CausticParticles> own;
  if (!shot) own.emplace(scene, CausticParticlesOptions{.seed = options.seed});
  const CausticParticles& caustics = shot ? *shot : *own;
  stats.rays += caustics.rays();
  if (!is_final) mesh = final_elements(scene, std::move(mesh), options, choice, caustics, stats);
  std::vector<Irradiance> irradiance = solve_on(scene, mesh, options, choice, caustics, stats);
  return Solution(std::move(mesh), std::move(irradiance), std::move(stats));
}

// The same elements before what is buried of them was found: their areas are whole.
ElementMesh whole(const Scene& scene, const ElementMesh& elements) {
  ElementMesh::Saved saved = elements.save();
  for (std::uint32_t i = 0; i < elements.count(); ++i)
    saved.area[i] = static_cast<float>(elements.whole_area(i));
  return std::move(*ElementMesh::restore(scene.shapes(), scene.description().materials, saved));
}

// Fills in what was left to the program.
Choice settle(const Scene& scene, RadiosityOptions& options) {
  const Choice choice = choose(scene, options);
  if (choice.is_for_gathering && options.rays_per_element == 0)
    options.rays_per_element = rays_of_a_gathered_element;
  return choice;
}

}  // namespace

std::size_t element_limit(const Scene& scene, const RadiosityOptions& options) {
  return choose(scene, options).max_elements;
}

Solution solve_radiosity(const Scene& scene, const RadiosityOptions& requested,
                         const CausticParticles* caustics) {
  RadiosityOptions options = requested;
  const Choice choice = settle(scene, options);
  ElementMesh mesh =
      divide_surfaces(scene, choice.is_adaptive ? choice.max_elements / coarse_part : choice.max_elements);
  return solve_from(scene, std::move(mesh), options, choice, caustics, false);
}

Solution solve_radiosity_again(const Scene& scene, const Solution& before, std::span<const std::uint8_t> cuts,
                               const RadiosityOptions& requested, const CausticParticles* caustics) {
  RadiosityOptions options = requested;
  const Choice choice = settle(scene, options);
  ElementMesh mesh = whole(scene, before.mesh()).cut(cuts);
  std::uint64_t rays = 0;
  if (!before.mesh().weights().empty() && !options.view.empty())
    mesh.weigh(weights_from_afar(scene, mesh, options.view, options.seed, rays));
  return solve_from(scene, std::move(mesh), options, choice, caustics, true, rays);
}

Solution solve_radiosity_on(const Scene& scene, const ElementMesh& elements,
                            const RadiosityOptions& requested) {
  RadiosityOptions options = requested;
  const Choice choice = settle(scene, options);
  ElementMesh mesh = whole(scene, elements);
  mesh.weigh(elements.weights());
  return solve_from(scene, std::move(mesh), options, choice, nullptr, true);
}

}  // namespace twopass
