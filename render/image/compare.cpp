#include "render/image/compare.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "render/core/error.h"
#include "render/image/flip.h"
#include "render/image/srgb.h"

namespace twopass {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double display_value(float linear) { return srgb_encode(std::clamp(linear, 0.0f, 1.0f)); }

// Sums over the finite pixels and their channels.
struct Sums {
  C3d test{0.0, 0.0, 0.0};
  C3d reference{0.0, 0.0, 0.0};
  double squares = 0.0;
  double smape = 0.0;
  double display_squares = 0.0;
  std::vector<double> pixel_relmse;  // the mean over the channels of each pixel

  void add(const C3f& t, const C3f& r) {
    double relative = 0.0;
    for (int c = 0; c < 3; ++c) {
      const double d = static_cast<double>(t[c]) - r[c];
      const double display = display_value(t[c]) - display_value(r[c]);
      squares += d * d;
      relative += d * d / (static_cast<double>(r[c]) * r[c] + relmse_epsilon);
      smape += 2.0 * std::abs(d) /
               (std::abs(static_cast<double>(r[c])) + std::abs(static_cast<double>(t[c])) + 0.02);
      display_squares += display * display;
    }
    test += C3d(t);
    reference += C3d(r);
    pixel_relmse.push_back(relative / 3.0);
  }
};

double mean_of(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? infinity : sum / static_cast<double>(values.size());
}

// The mean of all but the largest thousandth.
double trimmed_mean(std::vector<double> values) {
  const std::size_t kept = values.size() - values.size() / 1000;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(kept), values.end());
  return mean_of(std::span(values).first(kept));
}

double ratio(double test, double reference) {
  if (reference != 0.0) return test / reference;
  return test == 0.0 ? 1.0 : infinity;
}

constexpr std::array<Measure, 8> table{{
    {"energy_ratio", "mean(t) / mean(r) for each of R, G, B; 1 if both are zero",
     [](const Comparison& c) {
       return std::max({c.energy_ratio.x, c.energy_ratio.y, c.energy_ratio.z});
     }},
    {"mse", "mean over pixels and channels of d^2", [](const Comparison& c) { return c.mse; }},
    {"relmse", "mean over pixels and channels of d^2 / (r^2 + 0.01)",
     [](const Comparison& c) { return c.relmse; }},
    {"relmse_trimmed", "relmse without the 0.1 % of the pixels (rounded down) where it is largest",
     [](const Comparison& c) { return c.relmse_trimmed; }},
    {"smape", "mean over pixels and channels of 2 |d| / (|r| + |t| + 0.02)",
     [](const Comparison& c) { return c.smape; }},
    {"psnr", "-10 log10 of the mean of d^2 in dB, t and r clamped to [0,1] and sRGB-encoded first (peak 1)",
     [](const Comparison& c) { return c.psnr; }},
    {"flip",
     "mean HDR-FLIP (Andersson et al. 2021): 67 pixels per degree, ACES tone mapper, exposures chosen from r",
     [](const Comparison& c) { return c.flip; }},
    {"non_finite", "number of pixels with NaN or infinity in t or r; they are left out of all measures",
     [](const Comparison& c) { return static_cast<double>(c.non_finite); }},
}};

}  // namespace

Comparison compare(const Image& test, const Image& reference) {
  if (test.width != reference.width || test.height != reference.height)
    throw Error("compare",
                "the test is " + std::to_string(test.width) + "x" + std::to_string(test.height) +
                    " pixels, the reference " + std::to_string(reference.width) + "x" +
                    std::to_string(reference.height),
                "compare pictures of the same size");
  std::vector<C3f> t = rgb_pixels(test, "test picture"), r = rgb_pixels(reference, "reference picture");
  Comparison result;
  result.width = test.width;
  result.height = test.height;
  Sums sums;
  sums.pixel_relmse.reserve(t.size());
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (is_finite(t[i]) && is_finite(r[i])) {
      sums.add(t[i], r[i]);
    } else {
      ++result.non_finite;
      t[i] = r[i] = C3f(0.0f, 0.0f, 0.0f);
    }
  }
  const double count = 3.0 * static_cast<double>(sums.pixel_relmse.size());
  const auto mean = [count](double sum) { return count > 0.0 ? sum / count : infinity; };
  for (int c = 0; c < 3; ++c)
    result.energy_ratio[c] = count > 0.0 ? ratio(sums.test[c], sums.reference[c]) : infinity;
  result.mse = mean(sums.squares);
  result.relmse = mean_of(sums.pixel_relmse);
  result.relmse_trimmed = trimmed_mean(sums.pixel_relmse);
  result.smape = mean(sums.smape);
  // Without a pixel there is no likeness either.
  result.psnr = count > 0.0 ? -10.0 * std::log10(sums.display_squares / count) : -infinity;
  result.flip = count > 0.0 ? hdr_flip(t, r, result.width, result.height).mean : infinity;
  return result;
}

std::span<const Measure> measures() { return table; }

const Measure& measure_of_name(std::string_view name, std::string_view where) {
  std::vector<std::string_view> known;
  for (const Measure& measure : table) {
    if (measure.name == name) return measure;
    known.push_back(measure.name);
  }
  throw Error(where, "unknown measure '" + std::string(name) + "'", "use one of: " + join_names(known));
}

}  // namespace twopass
