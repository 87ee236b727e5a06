#include "render/image/filter.h"

#include <array>
#include <string>

#include "render/image/signed_kernel.h"

namespace twopass {
namespace {

constexpr double cutoff_stddevs = 4.0;

float checked_length(float length, const char* kind, const char* parameter) {
  if (std::isfinite(length) && length > 0.0f) return length;
  throw Error(kind, std::string(parameter) + " is " + std::to_string(length),
              "give a positive length in pixels, such as 0.5");
}

// The Gaussian in units of its standard deviation, t >= 0: exp(-t^2/2) - exp(-8). It serves every width.
struct UnitGaussian {
  static double value(double t) {
    return std::exp(-0.5 * t * t) - std::exp(-0.5 * cutoff_stddevs * cutoff_stddevs);
  }
  // Its integral from 0 to t.
  static double integral(double t) {
    return std::sqrt(pi / 2.0) * std::erf(t / std::sqrt(2.0)) -
           t * std::exp(-0.5 * cutoff_stddevs * cutoff_stddevs);
  }
};

// The inverse of the one-sided distribution function P(t) = integral(t) / integral(cutoff), tabulated over
// s = sqrt(1 - P): the density falls to zero linearly at the cut-off, where t(P) has an infinite slope, but
// t(s) is smooth there. Cubic Hermite interpolation with exact slopes leaves an error below 1e-6 in P.
class GaussianQuantile {
 public:
  GaussianQuantile() {
    const double total = UnitGaussian::integral(cutoff_stddevs);
    for (int i = 0; i <= cells; ++i) {
      const double s = static_cast<double>(i) / cells;
      const double t = quantile(1.0 - s * s, total);
      // dt/ds = (dP/ds) / (dP/dt); at s = 0 the limit follows from the density's slope -t exp(-t^2/2) there.
      const double slope = i == 0 ? -std::sqrt(2.0 * total / (cutoff_stddevs * std::exp(-0.5 * 16.0)))
                                  : -2.0 * s * total / UnitGaussian::value(t);
      knots_[static_cast<std::size_t>(i)] = {static_cast<float>(t), static_cast<float>(slope / cells)};
    }
  }

  /// t of the probability 1 - q. REQUIRES: 0 <= q <= 1.
  [[nodiscard]] float operator()(float q) const {
    const float position = std::sqrt(q) * cells;
    const int cell = std::min(static_cast<int>(position), cells - 1);
    const float x = position - static_cast<float>(cell);
    const Knot& a = knots_[static_cast<std::size_t>(cell)];
    const Knot& b = knots_[static_cast<std::size_t>(cell) + 1];
    const float y = 1.0f - x;
    return y * y * ((1.0f + 2.0f * x) * a.t + x * a.slope) + x * x * ((1.0f + 2.0f * y) * b.t - y * b.slope);
  }

 private:
  static constexpr int cells = 512;
  struct Knot {
    float t;
    float slope;
  };

  // Bisection: exact to double precision, and only done once.
  static double quantile(double probability, double total) {
    double low = 0.0, high = cutoff_stddevs;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (UnitGaussian::integral(middle) < probability * total ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }

  std::array<Knot, cells + 1> knots_{};
};

float sample_1d(const Filter& filter, float u) {
  // A symmetric kernel: u in [-1,1) gives the side by its sign, |u| the probability from the centre outwards.
  const float v = 2.0f * u - 1.0f;
  switch (filter.kind) {
    case FilterKind::box:
      return filter.radius * v;
    case FilterKind::tent:
      return std::copysign(filter.radius * (1.0f - std::sqrt(1.0f - std::abs(v))), v);
    default:
      break;
  }
  static const GaussianQuantile quantile;
  return std::copysign(filter.stddev * quantile(1.0f - std::abs(v)), v);
}

// Mitchell and Netravali 1988, equation 8; r in [0, 2].
double cubic(double r, double b, double c) {
  if (r < 1.0)
    return (((12.0 - 9.0 * b - 6.0 * c) * r + (-18.0 + 12.0 * b + 6.0 * c)) * r * r + (6.0 - 2.0 * b)) / 6.0;
  return ((((-b - 6.0 * c) * r + (6.0 * b + 30.0 * c)) * r + (-12.0 * b - 48.0 * c)) * r +
          (8.0 * b + 24.0 * c)) /
         6.0;
}

double sinc(double x) { return x < 1e-6 ? 1.0 : std::sin(pi * x) / (pi * x); }

float value_1d(const Filter& filter, float x) {
  const float r = std::abs(x);
  if (!(r <= filter.radius)) return 0.0f;
  switch (filter.kind) {
    case FilterKind::box:
      return 1.0f;
    case FilterKind::tent:
      return 1.0f - r / filter.radius;
    case FilterKind::mitchell:
    case FilterKind::catmullrom:
      return static_cast<float>(cubic(r, filter.b, filter.c));
    case FilterKind::lanczos:
      return static_cast<float>(sinc(r) * sinc(r / filter.radius));
    case FilterKind::gaussian:
      break;
  }
  return static_cast<float>(std::max(0.0, UnitGaussian::value(r / filter.stddev)));
}

float integral_1d(const Filter& filter) {
  switch (filter.kind) {
    case FilterKind::box:
      return 2.0f * filter.radius;
    case FilterKind::tent:
      return filter.radius;
    default:
      break;
  }
  return filter.stddev * static_cast<float>(2.0 * UnitGaussian::integral(cutoff_stddevs));
}

constexpr std::array<Named<FilterKind>, 6> names{{{"box", FilterKind::box},
                                                  {"tent", FilterKind::tent},
                                                  {"gaussian", FilterKind::gaussian},
                                                  {"mitchell", FilterKind::mitchell},
                                                  {"catmullrom", FilterKind::catmullrom},
                                                  {"lanczos", FilterKind::lanczos}}};

Filter with_table(Filter filter) {
  filter.table = std::make_shared<SignedKernel>(
      [&filter](double x) { return value_1d(filter, static_cast<float>(x)); }, filter.radius);
  return filter;
}

}  // namespace

Filter box_filter(float radius) {
  return {FilterKind::box, checked_length(radius, "box filter", "radius"), 0.0f};
}

Filter tent_filter(float radius) {
  return {FilterKind::tent, checked_length(radius, "tent filter", "radius"), 0.0f};
}

Filter gaussian_filter(float stddev) {
  checked_length(stddev, "gaussian filter", "stddev");
  return {FilterKind::gaussian, static_cast<float>(cutoff_stddevs) * stddev, stddev};
}

Filter mitchell_filter(float b, float c) {
  for (const float parameter : {b, c})
    if (!(std::abs(parameter) <= 10.0f))
      throw Error("mitchell filter", "a parameter is " + std::to_string(parameter),
                  "give B and C from -10 to 10");
  return with_table({FilterKind::mitchell, 2.0f, 0.0f, b, c});
}

Filter catmullrom_filter() { return with_table({FilterKind::catmullrom, 2.0f, 0.0f, 0.0f, 0.5f}); }

Filter lanczos_filter(int lobes) {
  if (lobes < 1 || lobes > 16)
    throw Error("lanczos filter", "it has " + std::to_string(lobes) + " lobes", "give 1 to 16, such as 3");
  return with_table({FilterKind::lanczos, static_cast<float>(lobes)});
}

std::span<const Named<FilterKind>> filter_names() { return names; }

Filter filter_of_name(std::string_view name, std::string_view where) {
  switch (value_of_name(filter_names(), name, where, "filter")) {
    case FilterKind::box:
      return box_filter();
    case FilterKind::tent:
      return tent_filter();
    case FilterKind::mitchell:
      return mitchell_filter();
    case FilterKind::catmullrom:
      return catmullrom_filter();
    case FilterKind::lanczos:
      return lanczos_filter();
    case FilterKind::gaussian:
      break;
  }
  return gaussian_filter();
}

FilterSample sample_filter(const Filter& filter, const V2f& u) {
  if (filter.table) {
    const SignedKernel& kernel = *filter.table;
    const V2f offset(kernel.sample(u.x), kernel.sample(u.y));
    const float density = kernel.integral() * kernel.pdf(offset.x) * kernel.integral() * kernel.pdf(offset.y);
    return {offset, density > 0.0f ? filter_value(filter, offset) / density : 0.0f};
  }
  // Positive kernels are drawn from exactly, so that value over density is constant: the weight is 1.
  return {{sample_1d(filter, u.x), sample_1d(filter, u.y)}, 1.0f};
}

float filter_pdf(const Filter& filter, const V2f& offset) {
  if (filter.table) return filter.table->pdf(offset.x) * filter.table->pdf(offset.y);
  const float integral = integral_1d(filter);
  return filter_value(filter, offset) / (integral * integral);
}

float filter_value(const Filter& filter, const V2f& offset) {
  return value_1d(filter, offset.x) * value_1d(filter, offset.y);
}

}  // namespace twopass
