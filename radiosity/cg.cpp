#include "radiosity/solvers.h"
#include "render/core/interrupt.h"
#include "render/core/parallel.h"

namespace twopass {

namespace {

// How far the inner iteration goes before the specular links' light is brought up to date: further would be
// work on a right-hand side that changes anyway.
constexpr double inner_share = 0.1;

// One run of conjugate gradients for (I - rho F) x = r, all channels at once, F without specular links. Written
// in radiosities and the inner product <x, y> = Sum A / rho x y, in which I - rho F is symmetric and positive
// definite (R22): the residual is that of the balance itself, so the bound can be asked for after every step.
// Eigen's ConjugateGradient knows only its own stop, |r| / |b|, would want a matrix a channel where one pass
// over the exchange serves three, and its matrix-free interface is longer than the method.
class ConjugateGradients {
 public:
  explicit ConjugateGradients(const Balance& balance) : balance_(balance), weight_(balance.count(), C3d(0.0)) {
    // Elements that reflect or receive nothing are eliminated: their radiosity is known from the start, so
    // their residual is zero and no direction ever moves them.
    for (std::uint32_t i = 0; i < balance.count(); ++i)
      for (int c = 0; c < 3; ++c)
        if (balance.reflectance[i][c] > 0.0f)
          weight_[i][c] = balance.area[i] / static_cast<double>(balance.reflectance[i][c]);
  }

  void start(std::vector<C3d> residual) {
    residual_ = std::move(residual);
    direction_ = residual_;
    squared_ = product(residual_, residual_);
  }

  void step(std::vector<C3d>& radiosity) {
    const std::vector<C3d> image = apply(direction_);
    const C3d length = ratio(squared_, product(direction_, image));
    for (std::size_t i = 0; i < radiosity.size(); ++i) {
      radiosity[i] += length * direction_[i];
      residual_[i] -= length * image[i];
    }
    const C3d squared = product(residual_, residual_);
    const C3d share = ratio(squared, squared_);
    for (std::size_t i = 0; i < radiosity.size(); ++i) direction_[i] = residual_[i] + share * direction_[i];
    squared_ = squared;
  }

  [[nodiscard]] const std::vector<C3d>& residual() const { return residual_; }

 private:
  // A channel that is dark or solved has no direction left.
  static C3d ratio(const C3d& a, const C3d& b) {
    C3d result(0.0);
    for (int c = 0; c < 3; ++c)
      if (b[c] > 0.0) result[c] = a[c] / b[c];
    return result;
  }

  [[nodiscard]] C3d product(const std::vector<C3d>& a, const std::vector<C3d>& b) const {
    C3d sum(0.0);
    for (std::size_t i = 0; i < a.size(); ++i) sum += weight_[i] * a[i] * b[i];
    return sum;
  }

  // (I - rho F) x without specular links.
  [[nodiscard]] std::vector<C3d> apply(const std::vector<C3d>& x) const {
    std::vector<C3d> result(x.size());
    throw_if_interrupted();
    parallel_for(x.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i)
        result[i] = x[i] - C3d(balance_.reflectance[i]) * balance_.gather_directly(i, x);
    });
    return result;
  }

  const Balance& balance_;
  std::vector<C3d> weight_;  // A / rho; zero for what is eliminated
  std::vector<C3d> residual_, direction_;
  C3d squared_{0.0};  // <residual, residual>
};

}  // namespace

SolverResult solve_cg(const Balance& balance, const StopRule& stop) {
  const Contraction q = contraction(balance);
  ConjugateGradients inner(balance);
  SolverResult result;
  const std::uint32_t n = balance.count();
  result.radiosity.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) result.radiosity[i] = C3d(balance.reflectance[i]) * balance.direct[i];
  while (true) {
    // The residual of the whole balance, specular links included, and free of what rounding has added up: only
    // its bound is believed. Without links the first run is also the last, but for rounding.
    result.irradiance = balance.gather_all(result.radiosity);
    std::vector<C3d> residual = residual_of(balance, result.radiosity, result.irradiance);
    result.error = error_of_residual(balance, q, result.radiosity, residual);
    if (result.error.bound <= stop.relative_error || result.iterations >= stop.max_iterations) return result;
    const double target =
        balance.specular.link.empty() ? stop.relative_error : inner_share * result.error.bound;
    inner.start(std::move(residual));
    do {
      inner.step(result.radiosity);
      ++result.iterations;
    } while (result.iterations < stop.max_iterations &&
             error_of_residual(balance, q, result.radiosity, inner.residual()).bound > target);
  }
}

}  // namespace twopass
