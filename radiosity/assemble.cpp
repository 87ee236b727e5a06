#include "radiosity/assemble.h"

#include <bit>

#include "radiosity/analytic_exchange.h"
#include "radiosity/direct_irradiance.h"
#include "radiosity/enforce.h"
#include "radiosity/hemicube.h"

namespace twopass {

namespace {

// About a million rays in all, a power of two for each element because such sets are the best stratified.
std::uint32_t rays_of_a_million(std::size_t elements, std::size_t least, std::size_t most) {
  const std::size_t rays = (std::size_t{1} << 20) / std::max<std::size_t>(1, elements);
  return static_cast<std::uint32_t>(std::bit_floor(std::clamp<std::size_t>(rays, least, most)));
}

// What the rows of the exchange should add up to, as far as the method knows; then, for every method, what they
// must not exceed for the error bound to hold.
class Enforcement {
 public:
  Enforcement(const RaySurvey& survey, const std::vector<double>& area, FormFactorMethod method)
      : survey_(survey),
        area_(area),
        by_rays_(method == FormFactorMethod::rays || method == FormFactorMethod::hemicube) {}

  // What the sums are, or may be.
  [[nodiscard]] RowSums sums(const std::vector<double>& exchange_with_lamps) const {
    const std::size_t n = area_.size();
    RowSums sums{false, survey_.is_closed(), std::vector<double>(n, 0.0), std::vector<double>(n, 0.0),
                 std::vector<double>(n)};
    // Analytic factors are better than the statistics of rays. Their sums are only known where everything that
    // an element sees is an element or a lamp with factors of its own.
    const bool lamps_known = survey_.met_lamp == 0 || !exchange_with_lamps.empty();
    sums.known = by_rays_ || (survey_.is_closed() && survey_.met_black == 0 && lamps_known);
    if (!by_rays_ && sums.known && !exchange_with_lamps.empty()) sums.fixed = exchange_with_lamps;
    for (std::uint32_t i = 0; i < n; ++i) {
      sums.target[i] = area_[i] * (by_rays_ ? share_on_elements(i) : 1.0);
      sums.limit[i] = area_[i] * (1.0 - static_cast<double>(survey_.shares[i].on_specular));
    }
    return sums;
  }

  void apply(ExchangeMatrix& exchange, const RowSums& sums, RadiosityStats& stats) const {
    stats.closed = sums.closed;
    if (sums.closed && sums.known) stats.closure_error = closure_error(exchange, sums.fixed, sums.target);
    double left = infinity_f;
    if (sums.known)
      left = scale_to_row_sums(exchange, sums.fixed, sums.target, area_, sums.closed ? 1e-7 : 1e-3);
    // A closed scene's sums are as good as rounding allows: capping would only take from them. Where scaling
    // did not get that far, nothing else keeps them below one.
    if (!(sums.closed && left < 1e-4)) cap_row_sums(exchange, sums.limit);
  }

 private:
  // In a closed scene a ray that leaves has slipped through an edge: it counts as if it had not been cast.
  [[nodiscard]] double share_on_elements(std::uint32_t i) const {
    const RaySurvey::Shares& shares = survey_.shares[i];
    const double leaked = survey_.is_closed() ? static_cast<double>(shares.in_the_sky) : 0.0;
    return leaked < 1.0 ? std::min(1.0, static_cast<double>(shares.on_elements) / (1.0 - leaked)) : 1.0;
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
  bool by_rays_;  // its sums are no better than what the survey's rays say
};

// Keeps the bound (R16) where media of different index amplify radiance: under white light everywhere, no
// element receives back more than the largest albedo, specular links included.
void cap_specular_links(Balance& balance) {
  if (balance.specular.first.empty()) return;
  const std::vector<C3d> white(balance.reflectance.begin(), balance.reflectance.end());
  for (std::uint32_t i = 0; i < balance.count(); ++i) {
    if (!(balance.area[i] > 0.0)) continue;
    const C3d direct = balance.gather_directly(i, white);
    C3d sum(0.0);
    for (const SpecularLink& link : balance.specular.of(i)) sum += white[link.element] * C3d(link.weight);
    for (int c = 0; c < 3; ++c) {
      const double room = std::max(0.0, static_cast<double>(largest_reflectance) - direct[c]);
      if (sum[c] <= room) continue;
      for (std::size_t k = balance.specular.first[i]; k < balance.specular.first[i + 1]; ++k)
        balance.specular.link[k].weight[c] *= static_cast<float>(room / sum[c]);
    }
  }
}

ExchangeMatrix exchange_by(FormFactorMethod method, const Scene& scene, const ElementMesh& mesh,
                           const RaySurvey& survey, const RadiosityOptions& options, std::uint64_t& rays) {
  if (method == FormFactorMethod::rays) return exchange_from_landings(survey, mesh);
  if (method == FormFactorMethod::hemicube)
    return hemicube_exchange(scene, mesh, options.hemicube_resolution, options.seed, rays);
  return analytic_exchange(mesh, scene.caster(), method, options.seed, rays);
}

// What reaches elements before the first diffuse reflection, but not straight from emitters.
void add_sky_and_caustics(std::vector<C3d>& direct, const ElementMesh& mesh, const RaySurvey& survey,
                          const CausticParticles& caustics) {
  for (std::uint32_t i = 0; i < mesh.count(); ++i) direct[i] += C3d(survey.sky[i]);
  for (const CausticParticle& particle : caustics.all()) {
    const std::uint32_t element = mesh.find(particle.point());
    if (element != no_index && mesh.area(element) > 0.0)
      direct[element] += C3d(particle.power) * (1.0 / mesh.area(element));
  }
}

}  // namespace

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

Balance assemble_balance(const Scene& scene, ElementMesh& mesh, const RadiosityOptions& options,
                         FormFactorMethod method, const CausticParticles& caustics, RadiosityStats& stats) {
  Balance balance;
  balance.reflectance = clamped_reflectances(mesh, stats);
  const std::uint32_t rays =
      options.rays_per_element ? options.rays_per_element : rays_of_a_million(mesh.count(), 32, 4096);
  const Keep keep = method == FormFactorMethod::rays ? Keep::landings : Keep::links;
  RaySurvey survey = survey_with_rays(scene, mesh, rays, options.seed, keep);
  stats.rays += survey.rays;
  mesh.expose(survey.exposed);
  for (std::uint32_t i = 0; i < mesh.count(); ++i) balance.area.push_back(mesh.area(i));
  balance.exchange = exchange_by(method, scene, mesh, survey, options, stats.rays);
  DirectIrradiance direct = direct_irradiance(scene, mesh, method, survey.sees_only_elements(), options.seed,
                                              stats.rays, options.least_direct_rays);
  const Enforcement enforcement(survey, balance.area, method);
  enforcement.apply(balance.exchange, enforcement.sums(direct.exchange_with_lamps), stats);

  balance.direct = std::move(direct.irradiance);
  add_sky_and_caustics(balance.direct, mesh, survey, caustics);
  balance.specular = std::move(survey.specular);
  cap_specular_links(balance);
  return balance;
}

FirstLight find_first_light(const Scene& scene, ElementMesh& mesh, const RadiosityOptions& options,
                            FormFactorMethod method, Keep keep, const CausticParticles& caustics,
                            RadiosityStats& stats) {
  // The survey only says what is buried and open, unless it stands for the light of the sky or of mirrors.
  const bool is_light = !scene.environment().is_black() || keep == Keep::links;
  std::uint32_t rays = rays_of_a_million(mesh.count(), is_light ? 64 : 16, 1024);
  if (keep == Keep::links && options.rays_per_element) rays = options.rays_per_element;
  RaySurvey survey = survey_with_rays(scene, mesh, rays, options.seed, keep);
  stats.rays += survey.rays;
  stats.closed = survey.is_closed();
  mesh.expose(survey.exposed);
  DirectIrradiance direct = direct_irradiance(scene, mesh, method, survey.sees_only_elements(), options.seed,
                                              stats.rays, options.least_direct_rays);
  FirstLight light;
  light.direct = std::move(direct.irradiance);
  add_sky_and_caustics(light.direct, mesh, survey, caustics);
  if (keep == Keep::totals) return light;
  std::vector<double> area;
  for (std::uint32_t i = 0; i < mesh.count(); ++i) area.push_back(mesh.area(i));
  light.sums = Enforcement(survey, area, method).sums(direct.exchange_with_lamps);
  light.specular = std::move(survey.specular);
  return light;
}

}  // namespace twopass
