#include <bit>

#include "radiosity/analytic_exchange.h"
#include "radiosity/caustics.h"
#include "radiosity/direct_irradiance.h"
#include "radiosity/enforce.h"
#include "radiosity/ray_survey.h"
#include "radiosity/solution.h"
#include "radiosity/solvers.h"
#include "radiosity/subdivision.h"

namespace twopass {

namespace {

constexpr std::size_t default_elements_rays = 8192;
constexpr std::size_t default_elements_analytic = 1500;
// The albedo that stands in for 1 and more: with them the balance of a closed scene has no solution.
constexpr float largest_reflectance = 0.999f;
// The part of the error that the iteration may use up.
constexpr double iteration_share = 0.1;
// An iteration cannot promise less than rounding allows.
constexpr double smallest_relative_error = 1e-10;

// About a million rays in all, a power of two for each element because such sets are the best stratified.
std::uint32_t default_rays(std::size_t elements) {
  const std::size_t rays = (std::size_t{1} << 20) / std::max<std::size_t>(1, elements);
  return static_cast<std::uint32_t>(std::bit_floor(std::clamp<std::size_t>(rays, 32, 4096)));
}

std::vector<C3f> clamped_reflectances(const ElementMesh& mesh, RadiosityStats& stats) {
  std::vector<C3f> reflectance(mesh.count());
  std::size_t clamped = 0;
  for (std::uint32_t i = 0; i < mesh.count(); ++i) {
    const C3f& rho = mesh.reflectance(i);
    for (int c = 0; c < 3; ++c) reflectance[i][c] = std::clamp(rho[c], 0.0f, largest_reflectance);
    if (reflectance[i] != rho) ++clamped;
  }
  if (clamped > 0)
    stats.notes.push_back("reflectance clamped to 0.999 on " + std::to_string(clamped) +
                          " elements: a closed scene without absorption has no balance");
  return reflectance;
}

// What the rows of the exchange should add up to, as far as the method knows; then, for every method, what they
// must not exceed for the error bound to hold.
class Enforcement {
 public:
  Enforcement(const RaySurvey& survey, const std::vector<double>& area, FormFactorMethod method)
      : survey_(survey), area_(area), by_rays_(method == FormFactorMethod::rays) {}

  void apply(ExchangeMatrix& exchange, const std::vector<double>& exchange_with_lamps,
             RadiosityStats& stats) const {
    const std::size_t n = area_.size();
    std::vector<double> fixed(n, 0.0), target(n, 0.0), limit(n);
    stats.closed = survey_.is_closed();
    // Analytic factors are better than the statistics of rays. Their sums are only known where everything that
    // an element sees is an element or a lamp with factors of its own.
    const bool lamps_known = survey_.met_lamp == 0 || !exchange_with_lamps.empty();
    const bool sums_known = by_rays_ || (survey_.is_closed() && survey_.met_black == 0 && lamps_known);
    if (!by_rays_ && sums_known && !exchange_with_lamps.empty()) fixed = exchange_with_lamps;
    for (std::uint32_t i = 0; i < n; ++i) {
      target[i] = area_[i] * (by_rays_ ? share_on_elements(i) : 1.0);
      limit[i] = area_[i] * (1.0 - survey_.share_on_specular(i));
    }
    if (stats.closed && sums_known) stats.closure_error = closure_error(exchange, fixed, target);
    if (sums_known) scale_to_row_sums(exchange, fixed, target, area_, stats.closed ? 1e-7 : 1e-3);
    // A closed scene's sums are as good as rounding allows: capping would only take from them.
    if (!(stats.closed && sums_known)) cap_row_sums(exchange, limit);
  }

 private:
  // In a closed scene a ray that leaves has slipped through an edge: it counts as if it had not been cast.
  [[nodiscard]] double share_on_elements(std::uint32_t i) const {
    const double leaked = survey_.is_closed() ? survey_.share_in_sky(i) : 0.0;
    return leaked < 1.0 ? survey_.share_on_elements(i) / (1.0 - leaked) : 1.0;
  }

  [[nodiscard]] double closure_error(const ExchangeMatrix& exchange, const std::vector<double>& fixed,
                                     const std::vector<double>& target) const {
    const std::vector<double> sum = row_sums(exchange);
    double worst = 0.0;
    for (std::size_t i = 0; i < area_.size(); ++i)
      if (area_[i] > 0.0) worst = std::max(worst, std::abs(sum[i] + fixed[i] - target[i]) / area_[i]);
    return worst;
  }

  const RaySurvey& survey_;
  const std::vector<double>& area_;
  bool by_rays_;
};

// Keeps the bound where media of different index amplify radiance: no row's sum, specular links included,
// above 1.
void cap_specular_links(Balance& balance) {
  if (balance.specular.first.empty()) return;
  const std::vector<double> direct = row_sums(balance.exchange);
  for (std::uint32_t i = 0; i < balance.count(); ++i) {
    if (!(balance.area[i] > 0.0)) continue;
    const double room = std::max(0.0, 1.0 - direct[i] / balance.area[i]);
    C3d sum(0.0);
    for (const SpecularLink& link : balance.specular.of(i)) sum += C3d(link.weight);
    const double largest = std::max({sum.x, sum.y, sum.z});
    if (largest <= room) continue;
    for (std::size_t k = balance.specular.first[i]; k < balance.specular.first[i + 1]; ++k)
      balance.specular.link[k].weight *= static_cast<float>(room / largest);
  }
}

SolverResult run_solver(Solver solver, const Balance& balance, double relative_error, int max_reflections) {
  if (max_reflections >= 0) return solve_series(balance, max_reflections);
  const StopRule stop{std::max(iteration_share * relative_error, smallest_relative_error)};
  switch (solver) {
    case Solver::lu:
      return solve_lu(balance);
    case Solver::progressive:
      return solve_progressive(balance, stop);
    case Solver::automatic:
    case Solver::gauss_seidel:
      break;
  }
  return solve_gauss_seidel(balance, stop);
}

// Everything of the balance: form factors by `method`, enforced, and direct irradiance.
Balance assemble(const Scene& scene, ElementMesh& mesh, const RadiosityOptions& options,
                 FormFactorMethod method, RadiosityStats& stats) {
  Balance balance;
  balance.reflectance = clamped_reflectances(mesh, stats);
  const std::uint32_t rays = options.rays_per_element ? options.rays_per_element : default_rays(mesh.count());
  RaySurvey survey = survey_with_rays(scene, mesh, rays, options.seed);
  stats.rays += survey.rays;
  mesh.expose(survey.exposed);
  for (std::uint32_t i = 0; i < mesh.count(); ++i) balance.area.push_back(mesh.area(i));
  balance.exchange = method == FormFactorMethod::rays
                         ? exchange_from_landings(survey, mesh)
                         : analytic_exchange(mesh, scene.caster(), method, options.seed, stats.rays);
  const bool all_elements = survey.is_closed() && survey.met_black == 0 && survey.met_lamp == 0;
  DirectIrradiance direct = direct_irradiance(scene, mesh, method, all_elements, options.seed, stats.rays);
  Enforcement(survey, balance.area, method).apply(balance.exchange, direct.exchange_with_lamps, stats);

  balance.direct = std::move(direct.irradiance);
  for (std::uint32_t i = 0; i < mesh.count(); ++i) balance.direct[i] += survey.sky[i];
  if (survey.met_specular > 0) {
    const std::size_t paths = std::size_t{rays} * mesh.count();
    const std::vector<C3d> caustics = caustic_irradiance(scene, mesh, paths, options.seed, stats.rays);
    for (std::uint32_t i = 0; i < mesh.count(); ++i) balance.direct[i] += caustics[i];
  }
  balance.specular = std::move(survey.specular);
  cap_specular_links(balance);
  return balance;
}

}  // namespace

Solution solve_radiosity(const Scene& scene, const RadiosityOptions& options) {
  const bool by_rays =
      options.form_factors == FormFactorMethod::automatic || options.form_factors == FormFactorMethod::rays;
  const FormFactorMethod method = by_rays ? FormFactorMethod::rays : options.form_factors;
  const Solver solver = options.solver == Solver::automatic ? Solver::gauss_seidel : options.solver;
  std::size_t most = by_rays ? default_elements_rays : default_elements_analytic;
  if (solver == Solver::lu) most = std::min<std::size_t>(most, lu_max_elements);
  ElementMesh mesh = divide_surfaces(scene, options.max_elements ? options.max_elements : most);

  RadiosityStats stats;
  stats.solver = options.max_reflections >= 0 ? "series" : name_of_value<Solver>(solver_names, solver);
  stats.form_factors = name_of_value<FormFactorMethod>(form_factor_method_names, method);
  stats.max_reflections = options.max_reflections;
  stats.elements = mesh.count();
  std::vector<Irradiance> irradiance(mesh.count());
  const bool is_dark = scene.lights().empty() && is_black(scene.sky());
  if (mesh.count() == 0 || is_dark) {
    stats.notes.push_back(is_dark ? "nothing emits light" : "no surface reflects light diffusely");
    return Solution(std::move(mesh), std::move(irradiance), std::move(stats));
  }

  const Balance balance = assemble(scene, mesh, options, method, stats);
  const SolverResult result = run_solver(solver, balance, options.relative_error, options.max_reflections);
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    irradiance[i] = {C3f(balance.direct[i]), C3f(result.irradiance[i])};
  stats.links = static_cast<std::size_t>(balance.exchange.nonZeros()) + balance.specular.link.size();
  stats.iterations = result.iterations;
  stats.residual = result.error.residual;
  stats.error_bound = result.error.bound;
  stats.memory_bytes = mesh.memory_bytes() + irradiance.size() * sizeof(Irradiance) +
                       static_cast<std::size_t>(balance.exchange.nonZeros()) * (sizeof(float) + sizeof(int)) +
                       balance.specular.link.size() * sizeof(SpecularLink);
  return Solution(std::move(mesh), std::move(irradiance), std::move(stats));
}

}  // namespace twopass
