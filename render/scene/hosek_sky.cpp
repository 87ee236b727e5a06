#include "render/scene/hosek_sky.h"

namespace twopass {

namespace {

#include "render/scene/hosek_sky_data.inc"
#include "render/scene/hosek_sun_data.inc"

// Radiometric units per unit of the CIE Y of the equal-energy spectrum: the integral of the observer's y, nm.
constexpr float cie_y_integral = 106.7502594f;
constexpr int control_points = 6;

// Weights of the control points: the Bernstein polynomials over the cube root of the elevation, which spreads
// the sunrise.
void bernstein(float elevation, float (&weight)[control_points]) {
  const float x = std::min(std::cbrt(elevation * (2.0f / pi_f)), 1.0f), y = 1.0f - x;
  constexpr float binomial[control_points] = {1.0f, 5.0f, 10.0f, 10.0f, 5.0f, 1.0f};
  float power = 1.0f;
  for (int i = 0; i < control_points; ++i) {
    weight[i] = binomial[i] * power;
    for (int k = i; k + 1 < control_points; ++k) weight[i] *= y;
    power *= x;
  }
}

// Two turbidities of a table and the share of the second.
struct Haze {
  int first, second;
  float share;
};

Haze haze_of(float turbidity) {
  const float t = std::clamp(turbidity, 1.0f, 10.0f) - 1.0f;
  const int first = std::min(static_cast<int>(t), 8);
  return {first, first + 1, t - static_cast<float>(first)};
}

}  // namespace

HosekSky::HosekSky(float turbidity, const C3f& albedo, float elevation) {
  float weight[control_points];
  bernstein(elevation, weight);
  const Haze haze = haze_of(turbidity);
  for (int c = 0; c < 3; ++c) {
    std::fill(std::begin(shape[c]), std::end(shape[c]), 0.0f);
    level[c] = 0.0f;
    for (const int ground : {0, 1})
      for (const int t : {haze.first, haze.second}) {
        const float share =
            (ground == 0 ? 1.0f - albedo[c] : albedo[c]) * (t == haze.first ? 1.0f - haze.share : haze.share);
        for (int i = 0; i < control_points; ++i) {
          for (int k = 0; k < 9; ++k) shape[c][k] += share * weight[i] * shape_data[c][ground][t][i][k];
          level[c] += share * weight[i] * level_data[c][ground][t][i];
        }
      }
  }
}

C3f HosekSky::radiance(float cos_theta, float gamma) const {
  const float cos_gamma = std::cos(gamma), cos2 = cos_gamma * cos_gamma;
  C3f result;
  for (int c = 0; c < 3; ++c) {
    const float* p = shape[c];
    const float mie = (1.0f + cos2) / std::pow(1.0f + p[8] * p[8] - 2.0f * p[8] * cos_gamma, 1.5f);
    const float horizon = 1.0f + p[0] * std::exp(p[1] / (cos_theta + 0.01f));
    const float around_sun = p[2] + p[3] * std::exp(p[4] * gamma) + p[5] * cos2 + p[6] * mie +
                             p[7] * std::sqrt(std::max(cos_theta, 0.0f));
    // The fit can dip below zero where it is dark.
    result[c] = std::max(0.0f, horizon * around_sun * level[c] * (1.0f / cie_y_integral));
  }
  return result;
}

C3f hosek_sun_radiance(float turbidity, float elevation) {
  // Between nodes the extinction is interpolated, that is the logarithm.
  const float x = std::cbrt(std::clamp(elevation * (2.0f / pi_f), 0.0f, 1.0f)) * sun_segments;
  const int low = std::clamp(static_cast<int>(x), 0, sun_nodes - 2);
  const float up = std::min(x - static_cast<float>(low), 1.0f);
  const Haze haze = haze_of(turbidity);
  const float clear = sun_haze[haze.first] * (1.0f - haze.share) + sun_haze[haze.second] * haze.share;
  const int first = std::min(static_cast<int>(clear), 2);
  const float share = clear - static_cast<float>(first);
  C3f result;
  for (int c = 0; c < 3; ++c) {
    const auto log_at = [&](int t) {
      return log_sun_data[t][low][c] * (1.0f - up) + log_sun_data[t][low + 1][c] * up;
    };
    result[c] = std::exp(log_at(first) * (1.0f - share) + log_at(first + 1) * share) * (1.0f / cie_y_integral);
  }
  return result;
}

}  // namespace twopass
