// Sun and clear sky as an environment, with the parameters of Mitsuba's `sunsky`.
#pragma once

#include <vector>

#include "render/core/distribution.h"
#include "render/core/frame.h"
#include "render/core/types.h"
#include "render/scene/hosek_sky.h"

namespace twopass {

/// A place and a moment, for the position of the sun.
struct SunTime {
  double latitude = 35.6894, longitude = 139.6917;  ///< degrees, north and east positive
  double timezone = 9.0;                            ///< hours that the clock is ahead of universal time
  int year = 2010, month = 7, day = 10;
  double hour = 15.0, minute = 0.0, second = 0.0;
};

/// Angles of the sun, radians.
struct SunAngles {
  double zenith;   ///< from straight up
  double azimuth;  ///< from north through east
};

/// The sun's position, to 0.01 degrees from 1999 to 2015 and little worse after: Blanco-Muriel et al.,
/// "Computing the solar vector", Solar Energy 70(5), 2001 (L28).
SunAngles sun_position(const SunTime& time);
/// The same as a unit vector in the frame of a SunSky: +z up, azimuth counted from -x towards -y, as Mitsuba's.
V3d sun_direction(const SunTime& time);

struct SunSkyOptions {
  float turbidity = 3.0f;            ///< haze, in [1, 10]
  C3f albedo{0.3f};                  ///< of the ground, in [0, 1]
  V3d sun_direction{0.0, 0.0, 1.0};  ///< towards the sun, in the world
  float sun_scale = 1.0f, sky_scale = 1.0f;
  float sun_aperture = 0.5358f;  ///< the disc's diameter, degrees, in (0, 180); keeps its power
  bool complex_sun = false;      ///< the disc is darker towards its limb
  M44d to_world{};               ///< of directions; before it, +z is up
};

/// The sky above the horizon and the disc of the sun; below the horizon, and while the sun is there, black.
/// Const and thread-safe.
class SunSky {
 public:
  /// A direction drawn, and what there is to see.
  struct Drawn {
    V3f direction;
    C3f radiance;
    float pdf_w;
  };

  /// REQUIRES: options in range; to_world keeps lengths and angles.
  explicit SunSky(const SunSkyOptions& options);

  [[nodiscard]] C3f radiance(const V3f& direction) const;
  [[nodiscard]] Drawn sample(const V2f& u) const;
  [[nodiscard]] float pdf_w(const V3f& direction) const;
  [[nodiscard]] C3f mean_radiance() const { return mean_; }
  [[nodiscard]] std::uint64_t fingerprint() const { return fingerprint_; }
  /// Mean radiance of the sun's disc, as it is scaled.
  [[nodiscard]] const C3f& sun_radiance() const { return sun_radiance_; }

 private:
  [[nodiscard]] V3f local(const V3f& direction) const;
  [[nodiscard]] bool is_in_sun(const V3f& local) const;
  [[nodiscard]] C3f sky_radiance(const V3f& local) const;
  [[nodiscard]] C3f disc_radiance(const V3f& local) const;
  [[nodiscard]] float sky_pdf_w(const V3f& local) const;
  [[nodiscard]] float pdf_w_local(const V3f& local, bool in_sun) const;
  C3d tabulate_sky();

  V3f axes_[3];  // local x, y, z in the world
  HosekSky model_;
  V3f sun_;  // local, unit
  Frame sun_frame_;
  bool is_up_, complex_sun_;
  float sky_scale_;
  float one_minus_cos_;  // of the disc's half angle
  C3f sun_radiance_{0.0f};
  DiscreteDistribution height_;                  // bands of equal solid angle, from the horizon up
  std::vector<DiscreteDistribution> longitude_;  // in each band
  float sun_probability_ = 0.0f;
  C3f mean_{0.0f};
  std::uint64_t fingerprint_ = 0;
};

}  // namespace twopass
