#include "render/image/compare.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>

#include "render/core/error.h"
#include "render/image/flip.h"
#include "render/image/srgb.h"

namespace twopass {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double display_value(float linear) { return srgb_encode(std::clamp(linear, 0.0f, 1.0f)); }

// What relMSE divides the square of a difference by.
double relative_to(float r) { return static_cast<double>(r) * r + relmse_epsilon; }

// Sums over the finite pixels and their channels.
struct Sums {
  C3d test{0.0, 0.0, 0.0};
  C3d reference{0.0, 0.0, 0.0};
  C3d squares{0.0, 0.0, 0.0};
  double smape = 0.0;
  double display_squares = 0.0;
  std::vector<double> pixel_relmse;  // the mean over the channels of each pixel

  void add(const C3f& t, const C3f& r) {
    double relative = 0.0;
    for (int c = 0; c < 3; ++c) {
      const double d = static_cast<double>(t[c]) - r[c];
      const double display = display_value(t[c]) - display_value(r[c]);
      squares[c] += d * d;
      relative += d * d / relative_to(r[c]);
      smape += 2.0 * std::abs(d) /
               (std::abs(static_cast<double>(r[c])) + std::abs(static_cast<double>(t[c])) + 0.02);
      display_squares += display * display;
    }
    test += C3d(t);
    reference += C3d(r);
    pixel_relmse.push_back(relative / 3.0);
  }
};

// The square of what the pixels of a block have in common, without the square of their noise: the mean of
// e_i e_j over all pairs i != j, (S^2 - Q) / (n (n - 1)).
struct Common {
  double sum = 0.0, squares = 0.0;
  void add(double e) {
    sum += e;
    squares += e * e;
  }
  [[nodiscard]] double pairs(double n) const { return (sum * sum - squares) / (n * (n - 1.0)); }
};

// Bias apart from noise, over all blocks of which at least two pixels are finite.
struct Blocks {
  C3d absolute{0.0, 0.0, 0.0};  // mean of the squared bias
  double relative = 0.0, relative_error = 0.0;

  Blocks(const LayerPair& pair, const std::vector<bool>& is_good) {
    double weights = 0.0, weights2 = 0.0, sum = 0.0, sum2 = 0.0;
    for (int y0 = 0; y0 < pair.height; y0 += bias_block)
      for (int x0 = 0; x0 < pair.width; x0 += bias_block) {
        std::array<Common, 3> plain, weighted;
        double n = 0.0;
        for (int y = y0; y < std::min(y0 + bias_block, pair.height); ++y)
          for (int x = x0; x < std::min(x0 + bias_block, pair.width); ++x) {
            const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(pair.width) +
                                  static_cast<std::size_t>(x);
            if (!is_good[i]) continue;
            n += 1.0;
            for (int c = 0; c < 3; ++c) {
              const double d = static_cast<double>(pair.test[i][c]) - pair.reference[i][c];
              plain[static_cast<std::size_t>(c)].add(d);
              weighted[static_cast<std::size_t>(c)].add(d / std::sqrt(relative_to(pair.reference[i][c])));
            }
          }
        if (n < 2.0) continue;
        double mean = 0.0;
        for (int c = 0; c < 3; ++c) {
          absolute[c] += n * plain[static_cast<std::size_t>(c)].pairs(n);
          mean += weighted[static_cast<std::size_t>(c)].pairs(n) / 3.0;
        }
        weights += n;
        weights2 += n * n;
        sum += n * mean;
        sum2 += n * mean * mean;
      }
    if (weights == 0.0) return;
    absolute /= weights;
    relative = sum / weights;
    const double spread = std::max(0.0, sum2 / weights - relative * relative);
    relative_error = std::sqrt(spread * weights2) / weights;
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

constexpr std::array<Measure, 10> table{{
    {"energy_ratio", "mean(t) / mean(r) for each of R, G, B; 1 if both are zero",
     [](const Comparison& c) {
       return std::max({c.energy_ratio.x, c.energy_ratio.y, c.energy_ratio.z});
     }},
    {"bias2",
     "the part of relmse that neighbours share: mean over 8x8 blocks and channels of (S^2 - Q) / (n (n - 1)), "
     "S and "
     "Q the sums over the block's n pixels of e and e^2, e = d / sqrt(r^2 + 0.01)",
     [](const Comparison& c) { return c.bias2; }},
    {"variance", "relmse - bias2: the part that changes from pixel to pixel",
     [](const Comparison& c) { return c.variance; }},
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

Comparison compare(const LayerPair& pair) {
  Comparison result;
  result.width = pair.width;
  result.height = pair.height;
  const std::size_t pixels = pair.test.size();
  std::vector<bool> is_good(pixels);
  Sums sums;
  sums.pixel_relmse.reserve(pixels);
  double known = 0.0;
  for (std::size_t i = 0; i < pixels; ++i) {
    is_good[i] = is_finite(pair.test[i]) && is_finite(pair.reference[i]);
    if (!is_good[i]) {
      ++result.non_finite;
      continue;
    }
    sums.add(pair.test[i], pair.reference[i]);
    if (pair.variance.empty() || !is_finite(pair.variance[i])) continue;
    for (int c = 0; c < 3; ++c) known += pair.variance[i][c] / relative_to(pair.reference[i][c]);
  }
  const double count = static_cast<double>(sums.pixel_relmse.size());
  const auto mean = [count](double sum) { return count > 0.0 ? sum / (3.0 * count) : infinity; };
  const Blocks blocks(pair, is_good);
  for (int c = 0; c < 3; ++c) {
    result.energy_ratio[c] = count > 0.0 ? ratio(sums.test[c], sums.reference[c]) : infinity;
    const double noise = std::max(0.0, sums.squares[c] - count * blocks.absolute[c]);
    if (sums.reference[c] != 0.0) result.energy_ci95[c] = 1.96 * std::sqrt(noise) / std::abs(sums.reference[c]);
  }
  result.mse = mean(sums.squares.x + sums.squares.y + sums.squares.z);
  result.relmse = mean_of(sums.pixel_relmse);
  result.relmse_trimmed = trimmed_mean(sums.pixel_relmse);
  result.bias2 = count > 0.0 ? blocks.relative : infinity;
  result.bias2_error = blocks.relative_error;
  result.variance = count > 0.0 ? result.relmse - result.bias2 : infinity;
  if (!pair.variance.empty() && count > 0.0) result.known_variance = mean(known);
  result.smape = mean(sums.smape);
  // Without a pixel there is no likeness either.
  result.psnr = count > 0.0 ? -10.0 * std::log10(sums.display_squares / (3.0 * count)) : -infinity;
  result.flip = infinity;
  if (pair.kind != LayerKind::color) {
    result.psnr = infinity;
  } else if (count > 0.0) {
    std::vector<C3f> t = pair.test, r = pair.reference;
    for (std::size_t i = 0; i < pixels; ++i)
      if (!is_good[i]) t[i] = r[i] = C3f(0.0f, 0.0f, 0.0f);
    Flip flip = hdr_flip(t, r, pair.width, pair.height);
    result.flip = flip.mean;
    result.flip_map = std::move(flip.map);
  }
  return result;
}

namespace {

void check_sizes(const Image& test, const Image& reference) {
  if (test.width == reference.width && test.height == reference.height) return;
  throw Error("compare",
              "the test is " + std::to_string(test.width) + "x" + std::to_string(test.height) +
                  " pixels, the reference " + std::to_string(reference.width) + "x" +
                  std::to_string(reference.height),
              "compare pictures of the same size");
}

bool is_variance(const Layer& layer) {
  std::string name = layer.name;
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return layer.kind == LayerKind::color && name == "variance";
}

// Adds the image's variance layer, if it has one, to the pair's.
void add_variance(const Image& image, LayerPair& pair) {
  for (const Layer& layer : layers_of(image)) {
    if (!is_variance(layer)) continue;
    const std::vector<C3f> own = layer_pixels(image, layer);
    if (pair.variance.empty()) pair.variance.resize(own.size(), C3f(0.0f));
    for (std::size_t i = 0; i < own.size(); ++i) pair.variance[i] += own[i];
  }
}

}  // namespace

std::vector<LayerPair> common_layers(const Image& test, const Image& reference) {
  check_sizes(test, reference);
  std::vector<LayerPair> pairs;
  const std::vector<Layer> others = layers_of(reference);
  for (const Layer& layer : layers_of(test)) {
    const auto other = std::find_if(others.begin(), others.end(), [&](const Layer& candidate) {
      return candidate.name == layer.name && candidate.kind == layer.kind;
    });
    if (other == others.end() || is_variance(layer)) continue;
    pairs.push_back({layer.name, layer.kind, test.width, test.height, layer_pixels(test, layer),
                     layer_pixels(reference, *other)});
  }
  if (pairs.empty())
    throw Error("compare", "the pictures have no layer in common",
                "compare pictures with channels R, G, B, or with layers of the same names");
  if (pairs.front().name.empty() && pairs.front().kind == LayerKind::color) {
    add_variance(test, pairs.front());
    add_variance(reference, pairs.front());
  }
  return pairs;
}

Comparison compare(const Image& test, const Image& reference) {
  check_sizes(test, reference);
  return compare(LayerPair{.name = "",
                           .width = test.width,
                           .height = test.height,
                           .test = rgb_pixels(test, "test picture"),
                           .reference = rgb_pixels(reference, "reference picture")});
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
