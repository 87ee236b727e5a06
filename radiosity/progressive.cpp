#include <optional>

#include "radiosity/solvers.h"

namespace twopass {

namespace {

// Nothing guarantees that overshooting converges. Unless a check finds the unshot power, signs apart, below
// this times that of the last check, everything starts anew without it: shooting just what is unshot always
// converges. The first sweep is exempt, since it spreads what is expected before it arrives.
constexpr double least_progress = 0.999;

// Finds the element of the largest unshot power in n / 64 + 64 steps: the powers' maxima by blocks of 64.
class LargestPower {
 public:
  explicit LargestPower(std::size_t count) : power_(count, 0.0), block_((count + 63) / 64, 0.0) {}

  void set(std::size_t i, double power) {
    const double before = power_[i];
    power_[i] = power;
    double& largest = block_[i / 64];
    if (power >= largest)
      largest = power;
    else if (before == largest)
      find_again(i / 64);
  }
  [[nodiscard]] std::size_t find() const {
    const auto block = std::max_element(block_.begin(), block_.end());
    std::size_t i = static_cast<std::size_t>(block - block_.begin()) * 64;
    while (power_[i] != *block) ++i;
    return i;
  }

 private:
  void find_again(std::size_t block) {
    const auto begin = power_.begin() + static_cast<std::ptrdiff_t>(block * 64);
    const auto end = power_.begin() + static_cast<std::ptrdiff_t>(std::min(power_.size(), (block + 1) * 64));
    block_[block] = *std::max_element(begin, end);
  }

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

// The irradiance that a watt of unshot power, spread evenly, will have brought everywhere in the end (R23):
// (R19) in a closed scene, and less where a part of it leaves an open one.
C3d expected_of_power(const Balance& balance) {
  const std::vector<C3d> share = balance.gather_all(std::vector<C3d>(balance.count(), C3d(1.0)));
  C3d received(0.0), reflected(0.0);
  double area = 0.0;
  for (std::uint32_t i = 0; i < balance.count(); ++i) {
    received += share[i] * balance.area[i];
    reflected += C3d(balance.reflectance[i]) * share[i] * balance.area[i];
    area += balance.area[i];
  }
  C3d result(0.0);
  for (int c = 0; c < 3; ++c)
    if (reflected[c] < area) result[c] = received[c] / area / (area - reflected[c]);
  return result;
}

class Shooting {
 public:
  Shooting(const Balance& balance, bool overshoot)
      : balance_(balance),
        overshoot_(overshoot),
        by_source_(links_by_source(balance.specular, balance.count())),
        shot_(balance.count(), C3d(0.0)),
        unshot_(balance.count(), C3d(0.0)),
        largest_(balance.count()) {
    if (overshoot) expected_of_power_ = expected_of_power(balance);
    for (std::uint32_t i = 0; i < balance.count(); ++i)
      if (balance.area[i] > 0.0) receive(i, balance.direct[i]);
  }

  void shoot_largest() {
    if (overshoot_ && shots_++ % shots_of_one_expectation() == 0) expect(unshot_power_ * expected_of_power_);
    const auto i = static_cast<std::uint32_t>(largest_.find());
    const C3d radiosity = to_shoot(i);
    shot_[i] += radiosity;
    add_unshot(i, -radiosity);
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
    C3d reflected(0.0);
    double area = 0.0;
    for (std::uint32_t i = 0; i < balance_.count(); ++i) {
      reflected += C3d(balance_.reflectance[i]) * balance_.area[i];
      area += balance_.area[i];
    }
    C3d result(0.0);
    for (int c = 0; c < 3 && area > 0.0; ++c) result[c] = unshot_power_[c] / area / (1.0 - reflected[c] / area);
    return result;
  }

  [[nodiscard]] double unshot_of_any_sign() const {
    double sum = 0.0;
    for (std::uint32_t i = 0; i < balance_.count(); ++i)
      sum += balance_.area[i] * (std::abs(unshot_[i].x) + std::abs(unshot_[i].y) + std::abs(unshot_[i].z));
    return sum;
  }

  // Takes from the running sum what rounding has added up.
  void recount() {
    unshot_power_ = C3d(0.0);
    for (std::uint32_t i = 0; i < balance_.count(); ++i) unshot_power_ += unshot_[i] * balance_.area[i];
  }

 private:
  void receive(std::uint32_t i, const C3d& irradiance) {
    add_unshot(i, C3d(balance_.reflectance[i]) * irradiance);
  }

  void add_unshot(std::uint32_t i, const C3d& radiosity) {
    unshot_[i] += radiosity;
    unshot_power_ += radiosity * balance_.area[i];
    rank(i);
  }

  // (R23): what is unshot, and what the others' unshot power is expected to bring here sooner or later.
  [[nodiscard]] C3d to_shoot(std::uint32_t i) const {
    return unshot_[i] + C3d(balance_.reflectance[i]) * expected_;
  }

  // By what would be shot: by what is unshot, elements that have just overshot would come first, to take it
  // back, and at albedos of 0.8 and more the iteration would not converge.
  void rank(std::uint32_t i) {
    const C3d radiosity = to_shoot(i);
    largest_.set(
        i, balance_.area[i] * std::max({std::abs(radiosity.x), std::abs(radiosity.y), std::abs(radiosity.z)}));
  }

  // A new expectation ranks all elements anew, as much work as an element of n links shooting: 16 times while n
  // elements shoot is as good as every time.
  [[nodiscard]] std::size_t shots_of_one_expectation() const {
    return std::max<std::size_t>(1, balance_.count() / 16);
  }
  void expect(const C3d& irradiance) {
    expected_ = irradiance;
    for (std::uint32_t i = 0; i < balance_.count(); ++i) rank(i);
  }

  const Balance& balance_;
  bool overshoot_;
  std::size_t shots_ = 0;
  SpecularLinks by_source_;
  std::vector<C3d> shot_, unshot_;
  C3d unshot_power_{0.0};  // Sum A unshot
  C3d expected_of_power_{0.0};
  C3d expected_{0.0};  // irradiance everywhere, as of the last time it was asked for; 0 without overshooting
  LargestPower largest_;
};

}  // namespace

SolverResult solve_progressive(const Balance& balance, const StopRule& stop, bool overshoot) {
  const Contraction q = contraction(balance);
  SolverResult result;
  const std::size_t n = balance.count();
  std::optional<Shooting> shooting(std::in_place, balance, overshoot);
  // The bound costs a pass over the whole matrix, as much as n shots, so it is asked for rarely.
  const std::size_t shots_between_checks = std::max<std::size_t>(1, n / 2);
  double last_unshot = 0.0;
  while (true) {
    shooting->recount();
    result.radiosity = shooting->radiosity();
    result.irradiance = balance.gather_all(result.radiosity);
    result.error = balance_error(balance, q, result.radiosity, result.irradiance);
    if (result.error.bound <= stop.relative_error || result.iterations >= stop.max_iterations) break;
    const double unshot = overshoot ? shooting->unshot_of_any_sign() : 0.0;
    if (overshoot && result.iterations > n && !(unshot <= least_progress * last_unshot)) {
      overshoot = false;
      shooting.emplace(balance, false);
    }
    last_unshot = unshot;
    const std::size_t shots = std::min(shots_between_checks, stop.max_iterations - result.iterations);
    for (std::size_t k = 0; k < shots; ++k) shooting->shoot_largest();
    result.iterations += shots;
  }
  result.ambient = shooting->ambient();
  return result;
}

}  // namespace twopass
