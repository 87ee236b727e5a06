#include "radiosity/gauss_rules.h"

#include <cassert>
#include <cmath>
#include <mutex>

#include "render/core/types.h"

namespace twopass {
namespace {

struct Legendre {
  long double value;     // P_n(x)
  long double previous;  // P_{n-1}(x)
};

Legendre legendre(int n, long double x) {
  long double p = 1.0L, previous = 0.0L;
  for (int k = 0; k < n; ++k) {
    const long double next = ((2 * k + 1) * x * p - k * previous) / (k + 1);
    previous = p;
    p = next;
  }
  return {p, previous};
}

// A root of f between two arguments of different sign, to the last bit of a long double; slow and safe.
template <class Function>
long double bisect(const Function& f, long double low, long double high) {
  const bool rises = f(low) < 0.0L;
  for (;;) {
    const long double middle = 0.5L * (low + high);
    if (middle <= low || middle >= high) return middle;
    ((f(middle) < 0.0L) == rises ? low : high) = middle;
  }
}

// The n roots of f in (-1, 1). Their angles acos(x) are nearly equidistant, so a few steps per root separate
// them.
template <class Function>
std::array<long double, GaussRule::max_points> roots(int n, const Function& f) {
  std::array<long double, GaussRule::max_points> found{};
  const int steps = 8 * (n + 1);
  int count = 0;
  const auto argument = [&](int k) { return -std::cos(static_cast<long double>(pi) * (k - 0.5L) / steps); };
  for (int k = 1; k < steps && count < n; ++k) {
    const long double low = argument(k), high = argument(k + 1);
    if ((f(low) < 0.0L) != (f(high) < 0.0L)) found[count++] = bisect(f, low, high);
  }
  assert(count == n);
  return found;
}

// Weights 2 / ((1 - x^2) P'_n(x)^2) on [-1, 1] (Abramowitz & Stegun 25.4.29), halved for [0, 1].
GaussRule make_legendre(int n) {
  GaussRule rule{.n = n};
  const auto x = roots(n, [n](long double t) { return legendre(n, t).value; });
  for (int i = 0; i < n; ++i) {
    const long double p = n * legendre(n, x[i]).previous;  // (1 - x^2) P'_n(x), since P_n(x) = 0
    rule.x[i] = static_cast<double>(0.5L * (1.0L + x[i]));
    rule.w[i] = static_cast<double>((1.0L - x[i] * x[i]) / (p * p));
  }
  return rule;
}

// The nodes are Radau's without the fixed one at 1: the roots of (P_n - P_{n+1}) / (1 - x). Radau's weights
// (1 + x) / ((n+1) P_n(x))^2 (Abramowitz & Stegun 25.4.31, mirrored) times 1 - x are those for the weight 1 - x
// on
// [-1, 1]; a quarter of that belongs to [0, 1].
GaussRule make_jacobi(int n) {
  GaussRule rule{.n = n};
  const auto x = roots(n, [n](long double t) {
    const Legendre p = legendre(n + 1, t);
    return p.previous - p.value;
  });
  for (int i = 0; i < n; ++i) {
    const long double p = (n + 1) * legendre(n, x[i]).value;
    rule.x[i] = static_cast<double>(0.5L * (1.0L + x[i]));
    rule.w[i] = static_cast<double>(0.25L * (1.0L + x[i]) * (1.0L - x[i]) / (p * p));
  }
  return rule;
}

// Rules that are made when they are first asked for: all of them together take 40 milliseconds.
template <GaussRule (*make)(int)>
const GaussRule& made_once(int n) {
  static std::array<GaussRule, GaussRule::max_points> table;
  static std::array<std::once_flag, GaussRule::max_points> once;
  assert(n >= 1 && n <= GaussRule::max_points);
  std::call_once(once[n - 1], [n] { table[n - 1] = make(n); });
  return table[n - 1];
}

}  // namespace

const GaussRule& gauss_legendre(int n) { return made_once<make_legendre>(n); }
const GaussRule& gauss_jacobi(int n) { return made_once<make_jacobi>(n); }

}  // namespace twopass
