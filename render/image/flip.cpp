#include "render/image/flip.h"

#include <array>
#include <cassert>

#include "render/core/parallel.h"
#include "render/image/flip_planes.h"
#include "render/image/image.h"

namespace twopass {
namespace {

// --- The kernels (Andersson et al. 2020, sections 4.1 and 4.2) ---

// A Gaussian exp(-pi^2 x^2 / b), x in degrees, cut where it falls below 1e-9 or at `radius`; not normalised.
Kernel csf_gaussian(double b, int radius) {
  const double falloff = pi * pi / (b * flip_pixels_per_degree * flip_pixels_per_degree);
  const int needed = std::min(radius, static_cast<int>(std::ceil(std::sqrt(std::log(1e9) / falloff))));
  Kernel kernel;
  for (int x = -needed; x <= needed; ++x) kernel.push_back(static_cast<float>(std::exp(-falloff * x * x)));
  return kernel;
}

double sum_of(const Kernel& kernel) {
  double sum = 0.0;
  for (const float weight : kernel) sum += weight;
  return sum;
}

Kernel scaled(Kernel kernel, double factor) {
  for (float& weight : kernel) weight = static_cast<float>(weight * factor);
  return kernel;
}

// Positive weights sum to 1 and negative ones to -1, so that a step from black to white answers with 1.
Kernel balanced(Kernel kernel) {
  double positive = 0.0, negative = 0.0;
  for (const float weight : kernel) (weight > 0.0f ? positive : negative) += weight;
  for (float& weight : kernel) weight = static_cast<float>(weight / (weight > 0.0f ? positive : -negative));
  return kernel;
}

// Every 2-D kernel of FLIP is a product of two 1-D ones, or the sum of two such products (blue-yellow): exact
// and ten times faster than filtering in the plane.
struct FlipKernels {
  Kernel achromatic, red_green;         // for rows and columns alike
  Kernel blue_yellow_1, blue_yellow_2;  // for rows; for columns they carry the weights of the sum:
  Kernel blue_yellow_1_columns, blue_yellow_2_columns;
  Kernel smooth, edge, point;
  int radius;  // of the widest

  FlipKernels() {
    // Parameters of the contrast sensitivity functions; the widest decides where all of them end.
    constexpr double b_achromatic = 0.0047, b_red_green = 0.0053, b_1 = 0.04, b_2 = 0.025, a_1 = 34.1,
                     a_2 = 13.5;
    radius = static_cast<int>(std::ceil(3.0 * std::sqrt(b_1 / (2.0 * pi * pi)) * flip_pixels_per_degree));
    achromatic = csf_gaussian(b_achromatic, radius);
    achromatic = scaled(achromatic, 1.0 / sum_of(achromatic));
    red_green = csf_gaussian(b_red_green, radius);
    red_green = scaled(red_green, 1.0 / sum_of(red_green));
    blue_yellow_1 = csf_gaussian(b_1, radius);
    blue_yellow_2 = csf_gaussian(b_2, radius);
    const double weight_1 = a_1 * std::sqrt(pi / b_1), weight_2 = a_2 * std::sqrt(pi / b_2);
    const double sum_1 = sum_of(blue_yellow_1), sum_2 = sum_of(blue_yellow_2);
    const double total = weight_1 * sum_1 * sum_1 + weight_2 * sum_2 * sum_2;
    blue_yellow_1_columns = scaled(blue_yellow_1, weight_1 / total);
    blue_yellow_2_columns = scaled(blue_yellow_2, weight_2 / total);
    make_feature_kernels();
  }

 private:
  // First and second derivative of a Gaussian whose peaks lie 0.082 degrees apart.
  void make_feature_kernels() {
    const double sd = 0.5 * 0.082 * flip_pixels_per_degree;
    const int feature_radius = static_cast<int>(std::ceil(3.0 * sd));
    radius = std::max(radius, feature_radius);
    for (int x = -feature_radius; x <= feature_radius; ++x) {
      const double g = std::exp(-x * x / (2.0 * sd * sd));
      smooth.push_back(static_cast<float>(g));
      edge.push_back(static_cast<float>(-x * g));
      point.push_back(static_cast<float>((x * x / (sd * sd) - 1.0) * g));
    }
    smooth = scaled(smooth, 1.0 / sum_of(smooth));
    edge = balanced(edge);
    point = balanced(point);
  }
};

const FlipKernels& kernels() {
  static const FlipKernels made;
  return made;
}

// --- One picture, some rows of it ---

// What an observer sees of each pixel: the colour after the eye's blur, and how strongly it is an edge or a
// point.
struct Seen {
  std::vector<C3f> hunt_lab;
  std::vector<float> edge;
  std::vector<float> point;
};

// Lengths of the vectors (horizontal, vertical answer) of a derivative filter.
std::vector<float> feature_strength(const Plane& luminance_y, const Plane& smoothed_rows,
                                    const Kernel& derivative) {
  const FlipKernels& k = kernels();
  const Plane horizontal = filter_columns(filter_rows(luminance_y, derivative), k.smooth, k.radius);
  const Plane vertical = filter_columns(smoothed_rows, derivative, k.radius);
  std::vector<float> strength(horizontal.values.size());
  for (std::size_t i = 0; i < strength.size(); ++i)
    strength[i] =
        std::sqrt(horizontal.values[i] * horizontal.values[i] + vertical.values[i] * vertical.values[i]);
  return strength;
}

// Looks at rows with a margin of kernels().radius rows above and below. `pixels` are display-linear in [0,1].
Seen look(std::span<const C3f> pixels, int width, int height) {
  const FlipKernels& k = kernels();
  Plane y(width, height), cx(width, height), cz(width, height), relative_y(width, height);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const C3f color = linear_to_ycxcz(pixels[i]);
    y.values[i] = color.x;
    cx.values[i] = color.y;
    cz.values[i] = color.z;
    relative_y.values[i] = (color.x + 16.0f) / 116.0f;
  }
  const Plane blurred_y = filter_columns(filter_rows(y, k.achromatic), k.achromatic, k.radius);
  const Plane blurred_cx = filter_columns(filter_rows(cx, k.red_green), k.red_green, k.radius);
  const Plane blurred_cz_1 =
      filter_columns(filter_rows(cz, k.blue_yellow_1), k.blue_yellow_1_columns, k.radius);
  const Plane blurred_cz_2 =
      filter_columns(filter_rows(cz, k.blue_yellow_2), k.blue_yellow_2_columns, k.radius);
  const Plane smoothed_rows = filter_rows(relative_y, k.smooth);
  Seen seen{{},
            feature_strength(relative_y, smoothed_rows, k.edge),
            feature_strength(relative_y, smoothed_rows, k.point)};
  seen.hunt_lab.reserve(blurred_y.values.size());
  for (std::size_t i = 0; i < blurred_y.values.size(); ++i) {
    const C3f rgb = ycxcz_to_linear(
        {blurred_y.values[i], blurred_cx.values[i], blurred_cz_1.values[i] + blurred_cz_2.values[i]});
    // A display cannot show what lies outside its cube.
    seen.hunt_lab.push_back(linear_to_hunt_lab(
        {std::clamp(rgb.x, 0.0f, 1.0f), std::clamp(rgb.y, 0.0f, 1.0f), std::clamp(rgb.z, 0.0f, 1.0f)}));
  }
  return seen;
}

// --- The difference of two pixels (section 4.3 and equation 1) ---

constexpr float color_exponent = 0.7f;

// The largest possible colour difference, between green and blue, as the exponent makes it.
float largest_color_difference() {
  static const float largest = std::pow(
      hyab(linear_to_hunt_lab({0.0f, 1.0f, 0.0f}), linear_to_hunt_lab({0.0f, 0.0f, 1.0f})), color_exponent);
  return largest;
}

// Spreads the common small differences over [0, 0.95] and squeezes the rare large ones into the rest.
float color_error(const C3f& test, const C3f& reference) {
  constexpr float knee = 0.4f, knee_value = 0.95f;
  const float largest = largest_color_difference();
  const float difference = std::pow(hyab(test, reference), color_exponent);
  if (difference < knee * largest) return knee_value / (knee * largest) * difference;
  const float beyond = (difference - knee * largest) / (largest - knee * largest);
  return std::min(1.0f, knee_value + beyond * (1.0f - knee_value));
}

void difference(const Seen& test, const Seen& reference, std::span<float> error) {
  for (std::size_t i = 0; i < error.size(); ++i) {
    const float color = color_error(test.hunt_lab[i], reference.hunt_lab[i]);
    const float feature =
        std::max(std::abs(test.edge[i] - reference.edge[i]), std::abs(test.point[i] - reference.point[i]));
    const float feature_error = std::min(1.0f, std::sqrt(feature * std::sqrt(0.5f)));
    // A difference of features raises the error of colour; where the colours are the same there is none.
    error[i] = color == 0.0f ? 0.0f : std::pow(color, 1.0f - feature_error);
  }
}

// --- Whole pictures, in strips of rows that fit the caches ---

using ToneCurve = float (*)(float value, float scale);

float clamped(float value, float) { return std::clamp(value, 0.0f, 1.0f); }

// ACES approximation of Narkowicz (2015) with its pre-exposure of 0.6 in the coefficients (2021, section 3).
constexpr float aces_a = 0.6f * 0.6f * 2.51f, aces_b = 0.6f * 0.03f;
constexpr float aces_c = 0.6f * 0.6f * 2.43f, aces_d = 0.6f * 0.59f, aces_e = 0.14f;

float aces(float value, float scale) {
  // Beyond 1e6 the curve is flat, and squares must not overflow.
  const float x = std::clamp(value * scale, 0.0f, 1e6f);
  return std::clamp(x * (aces_a * x + aces_b) / (x * (aces_c * x + aces_d) + aces_e), 0.0f, 1.0f);
}

std::vector<C3f> strip_of(std::span<const C3f> picture, int width, int height, int first, int rows,
                          ToneCurve tone, float scale) {
  std::vector<C3f> strip;
  strip.reserve(static_cast<std::size_t>(rows) * static_cast<std::size_t>(width));
  for (int y = first; y < first + rows; ++y) {
    const auto from = static_cast<std::size_t>(std::clamp(y, 0, height - 1)) * static_cast<std::size_t>(width);
    for (const C3f& c : picture.subspan(from, static_cast<std::size_t>(width)))
      strip.emplace_back(tone(c.x, scale), tone(c.y, scale), tone(c.z, scale));
  }
  return strip;
}

Flip flip(std::span<const C3f> test, std::span<const C3f> reference, int width, int height, ToneCurve tone,
          std::span<const float> scales) {
  assert(test.size() == reference.size());
  assert(test.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  constexpr int strip_rows = 64;
  const int margin = kernels().radius;
  Flip result;
  result.map.resize(test.size());
  const auto strips = static_cast<std::size_t>((height + strip_rows - 1) / strip_rows);
  parallel_for(strips, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const int first = static_cast<int>(s) * strip_rows, rows = std::min(strip_rows, height - first);
      const auto pixels = static_cast<std::size_t>(rows) * static_cast<std::size_t>(width);
      const auto map = std::span(result.map)
                           .subspan(static_cast<std::size_t>(first) * static_cast<std::size_t>(width), pixels);
      std::vector<float> error(pixels);
      for (const float scale : scales) {
        const auto seen = [&](std::span<const C3f> picture) {
          return look(strip_of(picture, width, height, first - margin, rows + 2 * margin, tone, scale), width,
                      rows + 2 * margin);
        };
        difference(seen(test), seen(reference), error);
        for (std::size_t i = 0; i < pixels; ++i) map[i] = std::max(map[i], error[i]);
      }
    }
  });
  for (const float error : result.map) result.mean += error;
  result.mean /= static_cast<double>(std::max<std::size_t>(1, result.map.size()));
  return result;
}

// The exposures, in stops: the brightest pixel of the reference, and its median one, mapped to 0.85.
std::array<float, 2> exposure_range(std::span<const C3f> reference) {
  std::vector<float> luminances;
  for (const C3f& c : reference) {
    const float y = luminance(c);
    // Where more than half is black the median would ask for an infinite exposure: only light counts then. The
    // papers do not treat that case; pixels too dark for a normal float count as black.
    if (y >= std::numeric_limits<float>::min() && std::isfinite(y)) luminances.push_back(y);
  }
  if (luminances.empty()) return {0.0f, 0.0f};
  const std::size_t black = reference.size() - luminances.size();
  const std::size_t lit = luminances.size();
  // The median over all pixels if it is lit, counting the black ones as the darkest.
  const std::size_t rank = black < (lit + black) / 2 ? (lit + black) / 2 - black : lit / 2;
  std::nth_element(luminances.begin(), luminances.begin() + static_cast<std::ptrdiff_t>(rank),
                   luminances.end());
  const float median = luminances[rank];
  const float brightest = *std::max_element(luminances.begin(), luminances.end());
  // The x where the curve reaches t: (a - c t) x^2 + (b - d t) x - e t = 0.
  constexpr double t = 0.85;
  constexpr double a = aces_a - aces_c * t, b = aces_b - aces_d * t, c = -aces_e * t;
  const double x = (-b + std::sqrt(b * b - 4.0 * a * c)) / (2.0 * a);
  return {static_cast<float>(std::log2(x / brightest)), static_cast<float>(std::log2(x / median))};
}

}  // namespace

Flip ldr_flip(std::span<const C3f> test, std::span<const C3f> reference, int width, int height) {
  constexpr std::array<float, 1> scale{1.0f};
  return flip(test, reference, width, height, clamped, scale);
}

Flip hdr_flip(std::span<const C3f> test, std::span<const C3f> reference, int width, int height) {
  const auto [start, stop] = exposure_range(reference);
  // One exposure a stop, but both ends in any case (2021, section 2.1).
  const int count = stop > start ? std::max(2, static_cast<int>(std::ceil(stop - start))) : 1;
  std::vector<float> scales;
  for (int i = 0; i < count; ++i)
    scales.push_back(
        std::exp2(start + (stop - start) * static_cast<float>(i) / static_cast<float>(std::max(1, count - 1))));
  Flip result = flip(test, reference, width, height, aces, scales);
  result.start_stops = start;
  result.stop_stops = stop;
  result.exposures = count;
  return result;
}

}  // namespace twopass
