#include "radiosity/solvers.h"

namespace twopass {

namespace {

// Finds the element of the largest unshot power in n / 64 + 64 steps: the powers' maxima by blocks of 64.
class LargestPower {
 public:
  explicit LargestPower(std::size_t count) : power_(count, 0.0), block_((count + 63) / 64, 0.0) {}

  void raise(std::size_t i, double power) {
    power_[i] = power;
    block_[i / 64] = std::max(block_[i / 64], power);
  }
  void clear(std::size_t i) {
    power_[i] = 0.0;
    const auto begin = power_.begin() + static_cast<std::ptrdiff_t>(i / 64 * 64);
    const auto end = power_.begin() + static_cast<std::ptrdiff_t>(std::min(power_.size(), (i / 64 + 1) * 64));
    block_[i / 64] = *std::max_element(begin, end);
  }
  [[nodiscard]] std::size_t find() const {
    const auto block = std::max_element(block_.begin(), block_.end());
    std::size_t i = static_cast<std::size_t>(block - block_.begin()) * 64;
    while (power_[i] != *block) ++i;
    return i;
  }

 private:
  std::vector<double> power_, block_;
};

// The specular links by where the light comes from, so that it can be shot along them.
SpecularLinks links_by_source(const SpecularLinks& by_receiver, std::uint32_t n) {
  SpecularLinks result;
  if (by_receiver.first.empty()) return result;
  result.first.assign(n + 1, 0);
  for (const SpecularLink& link : by_receiver.link) ++result.first[link.element + 1];
  for (std::uint32_t j = 0; j < n; ++j) result.first[j + 1] += result.first[j];
  result.link.resize(by_receiver.link.size());
  std::vector<std::size_t> next(result.first.begin(), result.first.end() - 1);
  for (std::uint32_t i = 0; i < n; ++i)
    for (const SpecularLink& link : by_receiver.of(i)) result.link[next[link.element]++] = {i, link.weight};
  return result;
}

class Shooting {
 public:
  explicit Shooting(const Balance& balance)
      : balance_(balance),
        by_source_(links_by_source(balance.specular, balance.count())),
        shot_(balance.count(), C3d(0.0)),
        unshot_(balance.count(), C3d(0.0)),
        largest_(balance.count()) {
    for (std::uint32_t i = 0; i < balance.count(); ++i)
      if (balance.area[i] > 0.0) receive(i, balance.direct[i]);
  }

  void shoot_largest() {
    const auto i = static_cast<std::uint32_t>(largest_.find());
    const C3d radiosity = unshot_[i];
    shot_[i] += radiosity;
    unshot_[i] = C3d(0.0);
    largest_.clear(i);
    // Column i of F is row i of the symmetric exchange over the receivers' areas.
    for (ExchangeMatrix::InnerIterator it(balance_.exchange, i); it; ++it) {
      const auto j = static_cast<std::uint32_t>(it.col());
      if (balance_.area[j] > 0.0) receive(j, radiosity * (static_cast<double>(it.value()) / balance_.area[j]));
    }
    for (const SpecularLink& link : by_source_.of(i))
      if (balance_.area[link.element] > 0.0) receive(link.element, radiosity * C3d(link.weight));
  }

  // What has been received, shot or not.
  [[nodiscard]] std::vector<C3d> radiosity() const {
    std::vector<C3d> sum(shot_);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += unshot_[i];
    return sum;
  }

  // (R19): the unshot power, spread over all surfaces and reflected for ever between them.
  [[nodiscard]] C3d ambient() const {
    C3d power(0.0), reflected(0.0);
    double area = 0.0;
    for (std::uint32_t i = 0; i < balance_.count(); ++i) {
      power += unshot_[i] * balance_.area[i];
      reflected += C3d(balance_.reflectance[i]) * balance_.area[i];
      area += balance_.area[i];
    }
    C3d result(0.0);
    for (int c = 0; c < 3 && area > 0.0; ++c) result[c] = power[c] / area / (1.0 - reflected[c] / area);
    return result;
  }

 private:
  void receive(std::uint32_t i, const C3d& irradiance) {
    unshot_[i] += C3d(balance_.reflectance[i]) * irradiance;
    largest_.raise(i, balance_.area[i] * std::max({unshot_[i].x, unshot_[i].y, unshot_[i].z}));
  }

  const Balance& balance_;
  SpecularLinks by_source_;
  std::vector<C3d> shot_, unshot_;
  LargestPower largest_;
};

}  // namespace

SolverResult solve_progressive(const Balance& balance, const StopRule& stop) {
  const Contraction q = contraction(balance);
  SolverResult result;
  const std::size_t n = balance.count();
  Shooting shooting(balance);
  // The bound costs a pass over the whole matrix, as much as n shots, so it is asked for rarely.
  const std::size_t shots_between_checks = std::max<std::size_t>(1, n / 2);
  while (true) {
    result.radiosity = shooting.radiosity();
    result.irradiance = balance.gather_all(result.radiosity);
    result.error = balance_error(balance, q, result.radiosity, result.irradiance);
    if (result.error.bound <= stop.relative_error || result.iterations >= stop.max_iterations) break;
    const std::size_t shots = std::min(shots_between_checks, stop.max_iterations - result.iterations);
    for (std::size_t k = 0; k < shots; ++k) shooting.shoot_largest();
    result.iterations += shots;
  }
  result.ambient = shooting.ambient();
  return result;
}

}  // namespace twopass
