#include "radiosity/hierarchical.h"

#include "render/core/interrupt.h"
#include "render/core/parallel.h"

namespace twopass {

namespace {

// The part of the error that the iteration may use up.
constexpr double iteration_share = 0.1;
// An iteration cannot promise less than rounding allows.
constexpr double smallest_iteration_error = 1e-10;
// 40 bytes each.
constexpr std::size_t most_links = std::size_t{1} << 26;
// Errors of a receiver's links add up in squares if they are independent. They are not quite: gradients of
// light from neighbouring sources agree in sign, and where no sums of factors are known nothing corrects what
// is left. Measured, so that the estimate stays above the true error.
constexpr double agreement_enforced = 2.0, agreement = 4.0;

double worst_channel(const C3d& value) { return std::max({value.x, value.y, value.z}); }

// The equations of one round: B = rho (H + F B), F from links and specular links.
class LinkedBalance {
 public:
  LinkedBalance(const ElementTree& tree, const HierarchicalInput& input, std::span<const Link> links)
      : tree_(tree), input_(input), exchange_(tree, links), specular_factor_(count(), 1.0) {
    for (const C3f& rho : input.reflectance) largest_albedo_ = std::max(largest_albedo_, max_component(rho));
  }

  // Enforces what is known of the sums. Returns the largest error that there was, relative to the area.
  double enforce(double tolerance) {
    const RowSums& sums = input_.sums;
    const std::vector<double> before = row_sums();
    double closure_error = 0.0;
    for (std::uint32_t i = 0; i < count() && sums.known && sums.closed; ++i)
      if (area(i) > 0.0)
        closure_error =
            std::max(closure_error, std::abs(before[i] + (sums.fixed[i] - sums.target[i]) / area(i)));
    if (sums.known) exchange_.scale_to_row_sums(sums.fixed, sums.target, tolerance);
    if (!(sums.known && sums.closed)) cap_sums();
    cap_specular_links();
    find_contraction();
    return closure_error;
  }

  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(input_.direct.size()); }
  [[nodiscard]] double area(std::uint32_t i) const { return tree_.node(tree_.leaf_of(i)).area; }
  [[nodiscard]] const Contraction& contraction() const { return contraction_; }
  [[nodiscard]] const LinkedExchange& exchange() const { return exchange_; }

  // F B of all elements.
  [[nodiscard]] std::vector<C3d> gather(std::span<const C3d> radiosity) const {
    std::vector<C3d> result = exchange_.gather(radiosity);
    if (input_.specular.first.empty()) return result;
    for (std::uint32_t i = 0; i < count(); ++i)
      for (const SpecularLink& link : input_.specular.of(i))
        if (area(i) > 0.0) result[i] += radiosity[link.element] * C3d(link.weight) * specular_factor_[i];
    return result;
  }
  // rho (H + irradiance).
  [[nodiscard]] C3d reflect(std::uint32_t i, const C3d& irradiance) const {
    return C3d(input_.reflectance[i]) * (input_.direct[i] + irradiance);
  }
  [[nodiscard]] C3d power(std::span<const C3d> radiosity) const {
    C3d sum(0.0);
    for (std::uint32_t i = 0; i < count(); ++i) sum += radiosity[i] * area(i);
    return sum;
  }

  // The power that limits on sums take away, relative to all of it, of the worst channel; with what it would
  // have become.
  [[nodiscard]] double lost_to_limits(std::span<const C3d> radiosity) const {
    if (input_.sums.known && input_.sums.closed) return 0.0;
    const std::vector<C3d> with = exchange_.gather(radiosity), without = exchange_.gather(radiosity, false);
    C3d lost(0.0);
    for (std::uint32_t i = 0; i < count(); ++i) {
      C3d irradiance = without[i] - with[i];
      for (const SpecularLink& link : input_.specular.of(i))
        irradiance += radiosity[link.element] * C3d(link.weight) * (1.0 - specular_factor_[i]);
      lost += C3d(input_.reflectance[i]) * irradiance * area(i);
    }
    const C3d total = power(radiosity);
    double worst = 0.0;
    for (int c = 0; c < 3; ++c)
      if (lost[c] > 0.0)
        worst = std::max(worst, lost[c] / total[c] / (1.0 - std::min(0.9999, amplification(c))));
    return worst;
  }
  [[nodiscard]] double amplification(int c) const {
    return std::min(contraction_.by_power[c], contraction_.by_maximum[c]);
  }

  [[nodiscard]] BalanceError error(std::span<const C3d> radiosity, std::span<const C3d> gathered) const {
    C3d residual_power(0.0), residual_maximum(0.0);
    double total_area = 0.0;
    for (std::uint32_t i = 0; i < count(); ++i) {
      const C3d residual = reflect(i, gathered[i]) - radiosity[i];
      total_area += area(i);
      for (int c = 0; c < 3; ++c) {
        residual_power[c] += area(i) * std::abs(residual[c]);
        residual_maximum[c] = std::max(residual_maximum[c], std::abs(residual[c]));
      }
    }
    const C3d total = power(radiosity);
    BalanceError result;
    for (int c = 0; c < 3; ++c) {
      if (residual_power[c] == 0.0) continue;
      const double absolute = error_from_residual(contraction_.by_power[c], contraction_.by_maximum[c],
                                                  residual_power[c], residual_maximum[c], total_area);
      result.residual = std::max(result.residual, residual_power[c] / total[c]);
      result.bound = std::max(result.bound, absolute / total[c]);
    }
    return result;
  }

 private:
  [[nodiscard]] std::vector<double> row_sums() const {
    const std::vector<double> ones(count(), 1.0);
    return exchange_.gather(std::span<const double>(ones));
  }

  // Where the sums are not known only convergence limits them: while links are coarse, an element may receive
  // too much where its neighbour receives too little, and cutting off the one but not the other would lose
  // light. An element's sums may be above 1 as long as its albedo times them stays halfway below 1.
  [[nodiscard]] double largest_sum(std::uint32_t i) const {
    const float albedo = max_component(input_.reflectance[i]);
    return std::clamp(0.5 * (1.0 + largest_albedo_) / std::max(albedo, 0.1f), 1.0, 2.0);
  }
  void cap_sums() {
    std::vector<double> limit = input_.sums.limit;
    for (std::uint32_t i = 0; i < count(); ++i) limit[i] += (largest_sum(i) - 1.0) * area(i);
    exchange_.cap_row_sums(limit);
  }

  // No row's sum, specular links included, above what convergence needs.
  void cap_specular_links() {
    if (input_.specular.first.empty()) return;
    const std::vector<double> row = row_sums();
    for (std::uint32_t i = 0; i < count(); ++i) {
      C3d sum(0.0);
      for (const SpecularLink& link : input_.specular.of(i)) sum += C3d(link.weight);
      const double room = std::max(0.0, largest_sum(i) - row[i]);
      if (worst_channel(sum) > room) specular_factor_[i] = room / worst_channel(sum);
    }
  }

  // The exchange is symmetric, so that the sums of columns are those of rows with reflectances for radiosities.
  void find_contraction() {
    const std::vector<double> row = row_sums();
    std::vector<C3d> rho(count());
    for (std::uint32_t i = 0; i < count(); ++i) rho[i] = C3d(input_.reflectance[i]);
    std::vector<C3d> column = exchange_.gather(std::span<const C3d>(rho));
    for (std::uint32_t i = 0; i < count(); ++i) {
      C3d sum(area(i) > 0.0 ? row[i] : 0.0);
      for (const SpecularLink& link : input_.specular.of(i)) {
        const C3d weight = C3d(link.weight) * (area(i) > 0.0 ? specular_factor_[i] : 0.0);
        sum += weight;
        if (const double source = area(link.element); source > 0.0)
          column[link.element] += rho[i] * weight * (area(i) / source);
      }
      for (int c = 0; c < 3; ++c)
        contraction_.by_maximum[c] = std::max(contraction_.by_maximum[c], rho[i][c] * sum[c]);
    }
    for (std::uint32_t i = 0; i < count(); ++i)
      for (int c = 0; c < 3 && area(i) > 0.0; ++c)
        contraction_.by_power[c] = std::max(contraction_.by_power[c], column[i][c]);
  }

  const ElementTree& tree_;
  const HierarchicalInput& input_;
  LinkedExchange exchange_;
  std::vector<double> specular_factor_;  // by element
  float largest_albedo_ = 0.0f;
  Contraction contraction_;
};

// (R34): Chebyshev's semi-iteration. Without symmetry, which specular links break, plain sweeps (weight 1).
class Chebyshev {
 public:
  Chebyshev(const Contraction& q, bool symmetric) {
    for (int c = 0; c < 3; ++c)
      sigma2_[c] = symmetric ? std::pow(std::min(q.by_power[c], q.by_maximum[c]), 2) : 0.0;
  }
  // The weight of the next step.
  C3d next() {
    for (int c = 0; c < 3; ++c) {
      const double part = step_ == 0 ? 0.0 : step_ == 1 ? 0.5 * sigma2_[c] : 0.25 * sigma2_[c] * weight_[c];
      weight_[c] = 1.0 / (1.0 - std::min(part, 0.5));
    }
    ++step_;
    return weight_;
  }

 private:
  C3d sigma2_{0.0}, weight_{1.0};
  int step_ = 0;
};

// Iterates from the given radiosity until the bound is at most `accuracy`.
void iterate(const LinkedBalance& balance, bool symmetric, double accuracy, std::size_t max_iterations,
             SolverResult& result) {
  Chebyshev chebyshev(balance.contraction(), symmetric);
  std::vector<C3d> previous = result.radiosity;
  std::size_t sweeps = 0;
  while (true) {
    result.irradiance = balance.gather(result.radiosity);
    result.error = balance.error(result.radiosity, result.irradiance);
    if (result.error.bound <= accuracy || sweeps >= max_iterations) break;
    const C3d weight = chebyshev.next();
    for (std::uint32_t i = 0; i < balance.count(); ++i) {
      const C3d now = result.radiosity[i];
      result.radiosity[i] = previous[i] + (balance.reflect(i, result.irradiance[i]) - previous[i]) * weight;
      previous[i] = now;
    }
    ++sweeps;
  }
  result.iterations += sweeps;
  // The weights may overshoot into the negative where there is next to no light.
  bool changed = false;
  for (C3d& radiosity : result.radiosity)
    for (int c = 0; c < 3; ++c)
      if (radiosity[c] < 0.0) {
        radiosity[c] = 0.0;
        changed = true;
      }
  if (!changed) return;
  result.irradiance = balance.gather(result.radiosity);
  result.error = balance.error(result.radiosity, result.irradiance);
}

// (R20) over links.
void sum_series(const LinkedBalance& balance, int reflections, SolverResult& result) {
  for (std::uint32_t i = 0; i < balance.count(); ++i) result.radiosity[i] = balance.reflect(i, C3d(0.0));
  result.irradiance.assign(balance.count(), C3d(0.0));
  for (int k = 0; k < reflections; ++k) {
    result.irradiance = balance.gather(result.radiosity);
    for (std::uint32_t i = 0; i < balance.count(); ++i)
      result.radiosity[i] = balance.reflect(i, result.irradiance[i]);
  }
  result.iterations += static_cast<std::size_t>(reflections);
  result.error = {};
}

// Means and deviations of the radiosity over all nodes, in units of the total power.
std::vector<NodeLight> light_of_nodes(const ElementTree& tree, std::span<const C3d> radiosity,
                                      const C3d& power) {
  const std::span<const TreeNode> node = tree.nodes();
  std::vector<C3d> mean(node.size(), C3d(0.0)), square(node.size(), C3d(0.0));
  std::vector<NodeLight> light(node.size());
  C3d unit(0.0);
  for (int c = 0; c < 3; ++c) unit[c] = power[c] > 0.0 ? 1.0 / power[c] : 0.0;
  for_each_level(tree, true, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!(node[i].area > 0.0)) continue;
      if (node[i].kind == TreeNode::element) {
        mean[i] = radiosity[tree.element_of(node[i])] * unit;
        square[i] = mean[i] * mean[i];
      }
      for (std::uint32_t c = node[i].first_child; c < node[i].first_child + node[i].child_count; ++c) {
        mean[i] += mean[c] * (node[c].area / node[i].area);
        square[i] += square[c] * (node[c].area / node[i].area);
      }
      light[i].radiosity = C3f(mean[i]);
      for (int c = 0; c < 3; ++c)
        light[i].deviation[c] =
            static_cast<float>(std::sqrt(std::max(0.0, square[i][c] - mean[i][c] * mean[i][c])));
    }
  });
  return light;
}

// (R35): what the links are off by, relative to the power of the worst channel.
double discretisation_error(const ElementTree& tree, std::span<const Link> links,
                            std::span<const NodeLight> light, const Contraction& q, bool enforced) {
  const std::span<const TreeNode> node = tree.nodes();
  std::vector<C3d> variance(node.size(), C3d(0.0));
  C3d of_means(0.0);
  const auto receive = [&](std::uint32_t p, std::uint32_t source, double spread_p, double spread_q,
                           double noise) {
    const C3d b(light[source].radiosity), deviation(light[source].deviation);
    const C3d by_noise = b * noise;
    const C3d by_source = deviation * spread_q, by_receiver = b * spread_p;
    variance[p] += (by_receiver * by_receiver + by_source * by_source + by_noise * by_noise) /
                   (node[p].area * node[p].area);
    const C3d power =
        C3d(node[p].reflectance) * C3d(std::hypot(by_noise.x, by_source.x), std::hypot(by_noise.y, by_source.y),
                                       std::hypot(by_noise.z, by_source.z));
    of_means += power * power;
  };
  for (const Link& link : links) {
    receive(link.p, link.q, link.spread_p, link.spread_q, link.noise);
    if (link.p != link.q) receive(link.q, link.p, link.spread_q, link.spread_p, link.noise);
  }
  C3d local(0.0);
  for (std::size_t i = 0; i < node.size(); ++i) {
    if (i > 0) variance[i] += variance[node[i].parent];
    if (node[i].kind != TreeNode::element) continue;
    const C3d deviation(std::sqrt(variance[i].x), std::sqrt(variance[i].y), std::sqrt(variance[i].z));
    local += C3d(node[i].reflectance) * deviation * node[i].area;
  }
  double worst = 0.0;
  for (int c = 0; c < 3; ++c) {
    const double largest = std::min(q.by_power[c], q.by_maximum[c]);
    worst = std::max(worst, (enforced ? agreement_enforced : agreement) * local[c] +
                                std::sqrt(of_means[c]) * largest / (1.0 - std::min(largest, 0.9999)));
  }
  return worst;
}

}  // namespace

HierarchicalResult solve_hierarchical(const Scene& scene, const ElementMesh& mesh,
                                      const HierarchicalInput& input, const StopRule& stop,
                                      std::uint32_t seed) {
  constexpr std::size_t most_rounds = 60;
  HierarchicalResult result;
  SolverResult& solution = result.solution;
  const ElementTree tree(mesh, input.reflectance);
  const LinkRefiner refiner(tree, scene.caster(), seed);
  const double accuracy = std::max(iteration_share * stop.relative_error, smallest_iteration_error);
  const double for_links = (1.0 - iteration_share) * stop.relative_error;
  std::vector<Link> links;
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    solution.radiosity.push_back(C3d(input.reflectance[i]) * input.direct[i]);
  C3d power(0.0);
  for (std::uint32_t i = 0; i < mesh.count(); ++i) power += solution.radiosity[i] * mesh.area(i);
  double epsilon = 0.01 * for_links;
  std::vector<NodeLight> light = light_of_nodes(tree, solution.radiosity, power);
  while (true) {
    refiner.refine(links, light, epsilon, most_links, result.rays);
    ++result.rounds;
    LinkedBalance balance(tree, input, links);
    result.closure_error = balance.enforce(input.sums.closed ? 1e-7 : 1e-3);
    iterate(balance, input.specular.first.empty(), accuracy, stop.max_iterations, solution);
    power = balance.power(solution.radiosity);
    light = light_of_nodes(tree, solution.radiosity, power);
    result.discretisation =
        discretisation_error(tree, links, light, balance.contraction(), input.sums.known && input.sums.closed) +
        balance.lost_to_limits(solution.radiosity);
    const bool done =
        result.discretisation <= for_links || links.size() >= most_links || result.rounds >= most_rounds;
    if (done) {
      if (input.max_reflections >= 0) sum_series(balance, input.max_reflections, solution);
      result.memory_bytes =
          tree.memory_bytes() + balance.exchange().memory_bytes() + links.size() * sizeof(Link);
      break;
    }
    epsilon *= std::clamp(0.8 * std::pow(for_links / result.discretisation, 1.5), 0.1, 0.5);
  }
  result.links = links.size();
  result.specular_links = input.specular.link.size();
  result.iteration_bound = solution.error.bound;
  solution.error.bound += result.discretisation;
  return result;
}

}  // namespace twopass
