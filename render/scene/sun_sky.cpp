#include "render/scene/sun_sky.h"

#include "render/core/parallel.h"
#include "render/core/warp.h"
#include "render/image/image.h"
#include "render/scene/data_hash.h"

namespace twopass {

namespace {

constexpr int bands = 64, sectors = 128;
constexpr float cell_w = 2.0f * pi_f / (bands * sectors);  // solid angle of a cell
// Sun and sky are sampled at least this often each, whatever their powers.
constexpr double least_share = 0.1;
constexpr double standard_aperture = 0.5358;

double one_minus_cos_of_half(double degrees) {
  const double s = std::sin(degrees * pi / 720.0);
  return 2.0 * s * s;
}

V3f direction_of(float z, float turns) {
  const V2f around = circle(turns) * std::sqrt(std::max(0.0f, 1.0f - z * z));
  return {around.x, around.y, z};
}

// Limb darkening at 550 nm by the cosine at the sun's surface (Cox 2000, Allen's Astrophysical Quantities,
// table 14.17), over its mean across the disc.
float limb_darkening(float mu) {
  constexpr float a0 = 0.3f, a1 = 0.93f, a2 = -0.23f;
  return (a0 + mu * (a1 + mu * a2)) / (a0 + a1 * (2.0f / 3.0f) + a2 * 0.5f);
}

V3d to_local(const M44d& to_world, const V3d& w) {
  V3d v;
  for (int i = 0; i < 3; ++i) {
    const V3d axis(to_world[i][0], to_world[i][1], to_world[i][2]);
    v[i] = w.dot(axis) / axis.length();
  }
  return v.normalized();
}

float elevation_of(const V3d& direction) {
  return static_cast<float>(std::asin(std::clamp(direction.z, 0.0, 1.0)));
}

}  // namespace

SunAngles sun_position(const SunTime& time) {
  // Days since noon of 1 January 2000, universal time: the number of the day (Fliegel and Van Flandern 1968),
  // and the hour.
  const double hours = time.hour - time.timezone + (time.minute + time.second / 60.0) / 60.0;
  const int january = (time.month - 14) / 12;
  const int day_number = 1461 * (time.year + 4800 + january) / 4 + 367 * (time.month - 2 - 12 * january) / 12 -
                         3 * ((time.year + 4900 + january) / 100) / 4 + time.day - 32075;
  const double days = day_number - 2451545 - 0.5 + hours / 24.0;

  const double omega = 2.1429 - 0.0010394594 * days;
  const double mean_longitude = 4.8950630 + 0.017202791698 * days;
  const double anomaly = 6.2400600 + 0.0172019699 * days;
  const double longitude = mean_longitude + 0.03341607 * std::sin(anomaly) +
                           0.00034894 * std::sin(2.0 * anomaly) - 0.0001134 - 0.0000203 * std::sin(omega);
  const double obliquity = 0.4090928 - 6.2140e-9 * days + 0.0000396 * std::cos(omega);
  const double right_ascension = std::atan2(std::cos(obliquity) * std::sin(longitude), std::cos(longitude));
  const double declination = std::asin(std::sin(obliquity) * std::sin(longitude));

  const double greenwich_hours = 6.6974243242 + 0.0657098283 * days + hours;  // sidereal
  const double hour_angle = (greenwich_hours * 15.0 + time.longitude) * pi / 180.0 - right_ascension;
  const double latitude = time.latitude * pi / 180.0;
  const double zenith = std::acos(std::clamp(std::cos(latitude) * std::cos(hour_angle) * std::cos(declination) +
                                                 std::sin(declination) * std::sin(latitude),
                                             -1.0, 1.0));
  const double azimuth = std::atan2(-std::sin(hour_angle), std::tan(declination) * std::cos(latitude) -
                                                               std::sin(latitude) * std::cos(hour_angle));
  // The observer stands on the surface, not at the centre: the parallax.
  constexpr double earth_radius = 6371.01, astronomical_unit = 149597890.0;  // km
  return {zenith + earth_radius / astronomical_unit * std::sin(zenith),
          azimuth < 0.0 ? azimuth + 2.0 * pi : azimuth};
}

V3d sun_direction(const SunTime& time) {
  const SunAngles sun = sun_position(time);
  return {-std::cos(sun.azimuth) * std::sin(sun.zenith), -std::sin(sun.azimuth) * std::sin(sun.zenith),
          std::cos(sun.zenith)};
}

SunSky::SunSky(const SunSkyOptions& options)
    : model_(options.turbidity, options.albedo,
             elevation_of(to_local(options.to_world, options.sun_direction))),
      complex_sun_(options.complex_sun),
      sky_scale_(options.sky_scale),
      one_minus_cos_(static_cast<float>(one_minus_cos_of_half(options.sun_aperture))) {
  for (int i = 0; i < 3; ++i)
    axes_[i] = unit(V3f(V3d(options.to_world[i][0], options.to_world[i][1], options.to_world[i][2])));
  const V3d sun = to_local(options.to_world, options.sun_direction);
  sun_ = V3f(sun);
  sun_frame_ = Frame(sun_);
  is_up_ = sun.z >= 0.0;
  if (is_up_) {
    // (L27): another aperture keeps the power.
    const double spread =
        one_minus_cos_of_half(standard_aperture) / one_minus_cos_of_half(options.sun_aperture);
    sun_radiance_ = hosek_sun_radiance(options.turbidity, elevation_of(sun)) *
                    static_cast<float>(spread * options.sun_scale);
    const C3d sky = tabulate_sky(),
              disc = C3d(sun_radiance_) * (2.0 * pi * static_cast<double>(one_minus_cos_));
    mean_ = C3f((sky + disc) * (0.25 / pi));
    const double sky_power = luminance(C3f(sky)), sun_power = luminance(C3f(disc));
    if (sun_power > 0.0)
      sun_probability_ = static_cast<float>(
          sky_power > 0.0 ? std::clamp(sun_power / (sun_power + sky_power), least_share, 1.0 - least_share)
                          : 1.0);
  }
  DataHash hash;
  for (const V3f& axis : axes_) hash.add(axis);
  for (const float x : {options.turbidity, options.sun_scale, options.sky_scale, options.sun_aperture})
    hash.add(x);
  hash.add(options.albedo);
  hash.add(sun_);
  hash.add(std::uint64_t{options.complex_sun});
  fingerprint_ = hash.value();
}

// The table that the sky is sampled from; returns the integral of the sky's radiance.
C3d SunSky::tabulate_sky() {
  constexpr int sub = 2;                              // points of a cell, each way
  std::vector<C3d> cells(bands * sectors, C3d(0.0));  // Imath leaves colours as they are
  parallel_for(bands, 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin * sectors; i < end * sectors; ++i) {
      const auto band = static_cast<float>(i / sectors), sector = static_cast<float>(i % sectors);
      for (int k = 0; k < sub * sub; ++k) {
        const float z = (band + (static_cast<float>(k / sub) + 0.5f) / sub) / bands;
        const float turns = (sector + (static_cast<float>(k % sub) + 0.5f) / sub) / sectors;
        cells[i] += C3d(sky_radiance(direction_of(z, turns))) / (sub * sub);
      }
    }
  });
  C3d sum(0.0);
  for (const C3d& cell : cells) sum += cell;
  // No part of the sky is left out, however dark its four points are.
  const double least = 1e-3 * luminance(C3f(sum)) / (bands * sectors);
  std::vector<double> heights(bands, 0.0);
  for (std::size_t band = 0; band < bands; ++band) {
    std::vector<double> weights(sectors);
    for (std::size_t s = 0; s < sectors; ++s) {
      weights[s] = std::max<double>(luminance(C3f(cells[band * sectors + s])), least);
      heights[band] += weights[s];
    }
    longitude_.emplace_back(weights);
  }
  height_ = DiscreteDistribution(heights);
  return sum * static_cast<double>(cell_w);
}

V3f SunSky::local(const V3f& direction) const {
  return {direction.dot(axes_[0]), direction.dot(axes_[1]), direction.dot(axes_[2])};
}

bool SunSky::is_in_sun(const V3f& local) const {
  // By the chord, whose square is 2 (1 - cos): the cosine of so small an angle has no digits.
  const V3f chord = local - sun_;
  return chord.dot(chord) <= 2.0f * one_minus_cos_;
}

C3f SunSky::sky_radiance(const V3f& local) const {
  if (!(local.z >= 0.0f) || !is_up_ || sky_scale_ == 0.0f) return C3f(0.0f);
  const float gamma = std::atan2(local.cross(sun_).length(), local.dot(sun_));
  return model_.radiance(local.z, gamma) * sky_scale_;
}

C3f SunSky::disc_radiance(const V3f& local) const {
  if (!(local.z >= 0.0f) || !is_up_) return C3f(0.0f);
  if (!complex_sun_) return sun_radiance_;
  const float sin_max2 = one_minus_cos_ * (2.0f - one_minus_cos_);
  const V3f across = local.cross(sun_);
  return sun_radiance_ * limb_darkening(std::sqrt(std::max(0.0f, 1.0f - across.dot(across) / sin_max2)));
}

C3f SunSky::radiance(const V3f& direction) const {
  const V3f w = local(direction);
  return is_in_sun(w) ? sky_radiance(w) + disc_radiance(w) : sky_radiance(w);
}

float SunSky::sky_pdf_w(const V3f& local) const {
  if (height_.empty() || !(local.z >= 0.0f)) return 0.0f;
  const auto cell = [](float x, int count) {
    return static_cast<std::uint32_t>(
        std::clamp(static_cast<int>(x * static_cast<float>(count)), 0, count - 1));
  };
  float turns = std::atan2(local.y, local.x) * (0.5f / pi_f);
  if (turns < 0.0f) turns += 1.0f;
  const std::uint32_t band = cell(local.z, bands);
  return height_.probability(band) * longitude_[band].probability(cell(turns, sectors)) / cell_w;
}

float SunSky::pdf_w_local(const V3f& local, bool in_sun) const {
  const float of_sun = in_sun ? sun_probability_ * cone_pdf_w(one_minus_cos_) : 0.0f;
  return of_sun + (1.0f - sun_probability_) * sky_pdf_w(local);
}

float SunSky::pdf_w(const V3f& direction) const {
  const V3f w = local(direction);
  return pdf_w_local(w, is_in_sun(w));
}

SunSky::Drawn SunSky::sample(const V2f& u) const {
  const bool of_sun = u.x < sun_probability_;
  V3f w;
  if (of_sun) {
    w = sun_frame_.to_world(square_to_cone({u.x / sun_probability_, u.y}, one_minus_cos_));
  } else if (height_.empty()) {
    return {axes_[2], C3f(0.0f), 0.0f};
  } else {
    const float x = std::min((u.x - sun_probability_) / (1.0f - sun_probability_), 0x1.fffffep-1f);
    const DiscreteDistribution::Choice band = height_.sample(u.y), sector = longitude_[band.index].sample(x);
    w = direction_of((static_cast<float>(band.index) + band.remapped) / bands,
                     (static_cast<float>(sector.index) + sector.remapped) / sectors);
  }
  const bool in_sun = of_sun || is_in_sun(w);
  const C3f radiance = in_sun ? sky_radiance(w) + disc_radiance(w) : sky_radiance(w);
  return {unit(axes_[0] * w.x + axes_[1] * w.y + axes_[2] * w.z), radiance, pdf_w_local(w, in_sun)};
}

}  // namespace twopass
