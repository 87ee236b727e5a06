#include "render/scene/environment_map.h"

#include <numeric>

#include "render/core/error.h"
#include "render/core/parallel.h"
#include "render/scene/data_hash.h"

namespace twopass {

namespace {

constexpr std::size_t row_grain = 16;
constexpr double largest_below_one = 0x1.fffffffffffffp-1;

// Where in [0, 1) a density linear from a to b has the share u of its integral. REQUIRES: a, b >= 0.
double invert_linear(double a, double b, double u) {
  const double sum = a + b;
  if (!(sum > 0.0)) return u;
  // The root that does not cancel.
  const double root = std::sqrt(std::max(0.0, a * a + u * (b - a) * sum));
  return std::clamp(u * sum / (a + root), 0.0, largest_below_one);
}

}  // namespace

EnvironmentMap::EnvironmentMap(const Image& image, const EnvironmentMapOptions& options, std::string_view where)
    : width_(static_cast<std::size_t>(image.width)),
      height_(static_cast<std::size_t>(image.height)),
      scale_(options.scale) {
  if (image.width < 2 || image.height < 3)
    throw Error(where, "an environment map has at least 2x3 pixels", "give a larger picture");
  for (int i = 0; i < 3; ++i)
    axes_[i] = unit(V3f(V3d(options.to_world[i][0], options.to_world[i][1], options.to_world[i][2])));
  std::vector<C3f> colors = rgb_pixels(image, where);
  for (C3f& color : colors)
    for (int c = 0; c < 3; ++c)
      if (!(std::isfinite(color[c]) && color[c] > 0.0f)) color[c] = 0.0f;
  store(colors);
  const double step = pi / static_cast<double>(height_ - 1);
  sin_theta_.resize(height_);
  for (std::size_t y = 1; y + 1 < height_; ++y)
    sin_theta_[y] = static_cast<float>(std::sin(step * static_cast<double>(y)));
  // The poles are points, but what stands there is seen as far as halfway to the next row.
  sin_theta_.front() = sin_theta_.back() = static_cast<float>(step / 6.0);
  measure(options.mis_compensation);
  prepare_sampling();
}

void EnvironmentMap::store(const std::vector<C3f>& colors) {
  const auto fits = [](float x) { return static_cast<float>(half(x)) == x; };
  const bool all_fit = std::ranges::all_of(
      colors, [&](const C3f& color) { return fits(color.x) && fits(color.y) && fits(color.z); });
  const auto fill = [&](auto& list) {
    list.reserve(3 * colors.size());
    for (const C3f& color : colors)
      for (int c = 0; c < 3; ++c) list.push_back(typename std::decay_t<decltype(list)>::value_type(color[c]));
  };
  if (!all_fit) pixels_.emplace<std::vector<float>>();
  std::visit(fill, pixels_);
}

C3f EnvironmentMap::pixel(std::size_t x, std::size_t y) const {
  const std::size_t at = 3 * (y * width_ + x);
  return std::visit([&](const auto& list) { return C3f(list[at], list[at + 1], list[at + 2]); }, pixels_);
}

void EnvironmentMap::measure(bool mis_compensation) {
  struct Row {
    C3d color{0.0};
    double luminance = 0.0, least = infinity_f;
    std::uint64_t hash = 0;
  };
  std::vector<Row> rows(height_);
  parallel_for(height_, row_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) {
      DataHash hash;
      for (std::size_t x = 0; x < width_; ++x) {
        const C3f color = pixel(x, y);
        rows[y].color += C3d(color);
        const double l = luminance(color);
        rows[y].luminance += l;
        rows[y].least = std::min(rows[y].least, l);
        hash.add(color);
      }
      rows[y].hash = hash.value();
    }
  });
  C3d color(0.0);
  double sin_sum = 0.0, sum = 0.0, least = infinity_f;
  DataHash hash;
  for (std::size_t y = 0; y < height_; ++y) {
    color += rows[y].color * static_cast<double>(sin_theta_[y]);
    sin_sum += sin_theta_[y];
    sum += rows[y].luminance;
    least = std::min(least, rows[y].least);
    hash.add(rows[y].hash);
  }
  mean_ = C3f(color * (scale_ / (sin_sum * static_cast<double>(width_))));
  hash.add(scale_);
  for (const V3f& axis : axes_) hash.add(axis);
  fingerprint_ = hash.value();
  if (!mis_compensation) return;
  // Subtracting the mean from a map that is all but constant would leave nothing.
  const double mean = sum / static_cast<double>(width_ * height_);
  if (mean - least > 0.01 * mean) dark_ = static_cast<float>(mean);
}

double EnvironmentMap::weight(std::size_t x, std::size_t y) const {
  return std::max(0.0f, luminance(pixel(x, y)) - dark_) * static_cast<double>(sin_theta_[y]);
}

void EnvironmentMap::prepare_sampling() {
  cumulative_.resize(width_ * height_);
  row_sum_.resize(height_);
  parallel_for(height_, row_grain, [&](std::size_t begin, std::size_t end) {
    std::vector<double> sums(width_);
    for (std::size_t y = begin; y < end; ++y) {
      // The density is linear from each pixel to the next, round to the first again.
      double sum = 0.0, before = weight(0, y);
      for (std::size_t x = 0; x < width_; ++x) {
        const double after = weight(x + 1 < width_ ? x + 1 : 0, y);
        sums[x] = sum += 0.5 * (before + after);
        before = after;
      }
      row_sum_[y] = sum;
      for (std::size_t x = 0; x < width_; ++x)
        cumulative_[y * width_ + x] = sum > 0.0 ? static_cast<float>(sums[x] / sum) : 0.0f;
    }
  });
  row_cumulative_.resize(height_);
  double sum = 0.0;
  for (std::size_t y = 0; y + 1 < height_; ++y)
    row_cumulative_[y + 1] = sum += 0.5 * (row_sum_[y] + row_sum_[y + 1]);
}

EnvironmentMap::Spot EnvironmentMap::spot(const V3f& local) const {
  // (L24)
  const float u = std::atan2(local.x, -local.z) * (0.5f / pi_f);
  const float v = std::atan2(std::hypot(local.x, local.z), local.y) * (1.0f / pi_f);
  const auto w = static_cast<float>(width_);
  float x = u * w - 0.5f;
  if (x < 0.0f) x += w;
  const float y = v * static_cast<float>(height_ - 1);
  Spot spot;
  spot.x0 = std::min(static_cast<std::size_t>(x), width_ - 1);
  spot.x1 = spot.x0 + 1 < width_ ? spot.x0 + 1 : 0;
  spot.y = std::min(static_cast<std::size_t>(y), height_ - 2);
  spot.fx = std::min(x - static_cast<float>(spot.x0), 1.0f);
  spot.fy = std::min(y - static_cast<float>(spot.y), 1.0f);
  return spot;
}

C3f EnvironmentMap::interpolated(const Spot& spot) const {
  const C3f upper = pixel(spot.x0, spot.y) * (1.0f - spot.fx) + pixel(spot.x1, spot.y) * spot.fx;
  const C3f lower = pixel(spot.x0, spot.y + 1) * (1.0f - spot.fx) + pixel(spot.x1, spot.y + 1) * spot.fx;
  return (upper * (1.0f - spot.fy) + lower * spot.fy) * scale_;
}

double EnvironmentMap::density(const Spot& spot) const {
  const double upper = weight(spot.x0, spot.y) * (1.0 - spot.fx) + weight(spot.x1, spot.y) * spot.fx;
  const double lower = weight(spot.x0, spot.y + 1) * (1.0 - spot.fx) + weight(spot.x1, spot.y + 1) * spot.fx;
  return upper * (1.0 - spot.fy) + lower * spot.fy;
}

float EnvironmentMap::pdf_w(const Spot& spot, float sin_theta) const {
  // From pixels to solid angle: a pixel spans 2 pi / width by pi / (height - 1).
  const double pixels = static_cast<double>(width_) * static_cast<double>(height_ - 1) / (2.0 * pi * pi);
  const double total = row_cumulative_.back();
  if (!(total > 0.0 && sin_theta > 0.0f)) return 0.0f;
  return static_cast<float>(density(spot) / total * pixels / static_cast<double>(sin_theta));
}

C3f EnvironmentMap::radiance(const V3f& direction) const {
  return interpolated(spot({direction.dot(axes_[0]), direction.dot(axes_[1]), direction.dot(axes_[2])}));
}

float EnvironmentMap::pdf_w(const V3f& direction) const {
  const V3f local(direction.dot(axes_[0]), direction.dot(axes_[1]), direction.dot(axes_[2]));
  return pdf_w(spot(local), std::hypot(local.x, local.z));
}

EnvironmentMap::Drawn EnvironmentMap::sample(const V2f& u) const {
  const double total = row_cumulative_.back();
  if (!(total > 0.0)) return {V3f(0.0f, 1.0f, 0.0f), C3f(0.0f), 0.0f};
  // First the height, whose density is linear between rows ...
  const double target = static_cast<double>(u.y) * total;
  const auto above = std::upper_bound(row_cumulative_.begin() + 1, row_cumulative_.end() - 1, target);
  const auto y = static_cast<std::size_t>(above - row_cumulative_.begin()) - 1;
  const double in_row = row_cumulative_[y + 1] - row_cumulative_[y];
  const double fy =
      invert_linear(row_sum_[y], row_sum_[y + 1],
                    in_row > 0.0 ? std::clamp((target - row_cumulative_[y]) / in_row, 0.0, 1.0) : 0.0);
  // ... then the longitude at this height, from the blend of the two rows.
  const double part0 = (1.0 - fy) * row_sum_[y], part1 = fy * row_sum_[y + 1];
  const float *row0 = cumulative_.data() + y * width_, *row1 = row0 + width_;
  const auto blend = [&](std::size_t x) { return part0 * row0[x] + part1 * row1[x]; };
  const double wanted = static_cast<double>(u.x) * (part0 + part1);
  std::size_t x = 0;
  for (std::size_t count = width_; count > 1;) {
    const std::size_t middle = count / 2;
    x += blend(x + middle - 1) <= wanted ? middle : 0;
    count -= middle;
  }
  const double begin = x > 0 ? blend(x - 1) : 0.0, width = blend(x) - begin;
  Spot spot{x, x + 1 < width_ ? x + 1 : 0, y, 0.0f, static_cast<float>(fy)};
  const double a = weight(spot.x0, y) * (1.0 - fy) + weight(spot.x0, y + 1) * fy;
  const double b = weight(spot.x1, y) * (1.0 - fy) + weight(spot.x1, y + 1) * fy;
  spot.fx = static_cast<float>(
      invert_linear(a, b, width > 0.0 ? std::clamp((wanted - begin) / width, 0.0, 1.0) : 0.0));

  const double phi =
      2.0 * pi * (static_cast<double>(x) + 0.5 + static_cast<double>(spot.fx)) / static_cast<double>(width_);
  const double theta = pi * (static_cast<double>(y) + fy) / static_cast<double>(height_ - 1);
  const auto sin_theta = static_cast<float>(std::sin(theta)), cos_theta = static_cast<float>(std::cos(theta));
  const V3f direction = axes_[0] * (static_cast<float>(std::sin(phi)) * sin_theta) + axes_[1] * cos_theta -
                        axes_[2] * (static_cast<float>(std::cos(phi)) * sin_theta);
  return {unit(direction), interpolated(spot), pdf_w(spot, sin_theta)};
}

}  // namespace twopass
