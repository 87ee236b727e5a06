#include "render/scene/ies_profile.h"

namespace twopass {

namespace {

constexpr float degrees_of_radians = 180.0f / pi_f;

// Two neighbours of an ascending grid and the share of the second.
struct Between {
  std::size_t first, second;
  float share;
};

// REQUIRES: grid.front() <= x <= grid.back().
Between find_between(const std::vector<float>& grid, float x) {
  if (grid.size() == 1) return {0, 0, 0.0f};
  const auto above = std::upper_bound(grid.begin() + 1, grid.end() - 1, x);
  const auto second = static_cast<std::size_t>(above - grid.begin());
  const float width = grid[second] - grid[second - 1];
  return {second - 1, second, std::clamp((x - grid[second - 1]) / width, 0.0f, 1.0f)};
}

// The integral of a linear function of gamma times sin gamma over [a, b], radians, with the values p and q at
// the ends.
double ring(double a, double b, double p, double q) {
  const double slope = (q - p) / (b - a);
  return p * std::cos(a) - q * std::cos(b) + slope * (std::sin(b) - std::sin(a));
}

}  // namespace

IesProfile::IesProfile(std::vector<float> vertical, std::vector<float> horizontal, std::vector<float> candela)
    : vertical_(std::move(vertical)), horizontal_(std::move(horizontal)), candela_(std::move(candela)) {
  for (const float value : candela_) maximum_ = std::max(maximum_, value);
}

float IesProfile::folded(float degrees) const {
  const float last = horizontal_.back();
  if (horizontal_.size() == 1) return horizontal_.front();
  if (horizontal_.front() > 0.0f)
    return degrees < 90.0f ? 180.0f - degrees : degrees > 270.0f ? 540.0f - degrees : degrees;
  if (last <= 180.0f && degrees > 180.0f) degrees = 360.0f - degrees;
  if (last <= 90.0f && degrees > 90.0f) degrees = 180.0f - degrees;
  return std::min(degrees, last);
}

float IesProfile::candela(const V3f& direction) const {
  const float gamma = std::atan2(std::hypot(direction.x, direction.y), direction.z) * degrees_of_radians;
  // Tables that end at 90 or 180 degrees mean it, whatever the rounding of the angle.
  constexpr float rounding = 1e-4f;
  if (!(gamma >= vertical_.front() - rounding && gamma <= vertical_.back() + rounding)) return 0.0f;
  const Between v = find_between(vertical_, std::clamp(gamma, vertical_.front(), vertical_.back()));
  float c = std::atan2(-direction.y, direction.x) * degrees_of_radians;  // +z looks down: clockwise about it
  if (c < 0.0f) c += 360.0f;
  const Between h = find_between(horizontal_, folded(c));
  const auto on = [&](std::size_t plane) {
    return at(plane, v.first) * (1.0f - v.share) + at(plane, v.second) * v.share;
  };
  return on(h.first) * (1.0f - h.share) + on(h.second) * h.share;
}

double IesProfile::flux() const {
  // Linear in C, so each half-plane counts with the width of its hat; symmetric parts count as often as they
  // occur.
  const std::size_t planes = horizontal_.size();
  const double span = planes == 1 ? 1.0 : static_cast<double>(horizontal_.back()) - horizontal_.front();
  double sum = 0.0;
  for (std::size_t h = 0; h < planes; ++h) {
    double width = 1.0;
    if (planes > 1) {
      const double before = h > 0 ? horizontal_[h] - horizontal_[h - 1] : 0.0f;
      const double after = h + 1 < planes ? horizontal_[h + 1] - horizontal_[h] : 0.0f;
      width = 0.5 * (before + after) / span;
    }
    for (std::size_t v = 0; v + 1 < vertical_.size(); ++v)
      sum += width * ring(vertical_[v] * pi / 180.0, vertical_[v + 1] * pi / 180.0, at(h, v), at(h, v + 1));
  }
  return 2.0 * pi * sum;
}

}  // namespace twopass
