#include "render/scene/environment.h"

#include <gtest/gtest.h>

#include "render/core/error.h"
#include "render/core/sampler.h"
#include "render/core/warp.h"
#include "tests/support/statistics.h"

namespace twopass {
namespace {

constexpr double level = 1e-4;

Image blank(int width, int height, float value = 0.0f) {
  Image image(width, height, {"R", "G", "B"});
  std::fill(image.pixels.begin(), image.pixels.end(), value);
  return image;
}

// Uneven everywhere, with bright and black places, deterministic.
Image mottled(int width, int height) {
  Image image = blank(width, height);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const float x = static_cast<float>(hash_words(7, static_cast<std::uint32_t>(i)) >> 40) * 0x1p-24f;
    image.pixels[i] = x < 0.3f ? 0.0f : x < 0.97f ? x : 20.0f * x;
  }
  return image;
}

Environment of(const Image& image, const EnvironmentMapOptions& options = {}) {
  return Environment(std::make_shared<const EnvironmentMap>(image, options, "test"));
}

V3f direction_at(double z, double phi) {
  const double r = std::sqrt(1.0 - z * z);
  return V3f(V3d(r * std::cos(phi), r * std::sin(phi), z));
}

// Calls visit(direction, solid angle) on a fine grid of the sphere; z is the axis.
template <class Visit>
void for_directions(int n, const Visit& visit) {
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 2 * n; ++j)
      visit(direction_at(1.0 - 2.0 * (i + 0.5) / n, pi * (j + 0.5) / n), 2.0 * pi / (double(n) * n));
}

// Samples against the density that pdf_w claims, cell by cell of the sphere.
double chi2_of(const Environment& environment, int samples) {
  constexpr int rows = 16, columns = 32, sub = 24;
  std::vector<double> expected(rows * columns, 0.0), observed(rows * columns, 0.0);
  for (int i = 0; i < rows * sub; ++i)
    for (int j = 0; j < columns * sub; ++j) {
      const double z = 1.0 - 2.0 * (i + 0.5) / (rows * sub), phi = 2.0 * pi * (j + 0.5) / (columns * sub);
      expected[static_cast<std::size_t>(i / sub * columns + j / sub)] +=
          static_cast<double>(environment.pdf_w(direction_at(z, phi))) * 4.0 * pi /
          (rows * sub * columns * sub) * samples;
    }
  for (int k = 0; k < samples; ++k) {
    Sampler sampler(3, static_cast<std::uint32_t>(k), 0);
    const V3f w = environment.sample(sampler.next_2d()).direction;
    const int i = std::clamp(static_cast<int>((1.0f - w.z) * 0.5f * rows), 0, rows - 1);
    double phi = std::atan2(w.y, w.x) / (2.0 * pi);
    if (phi < 0.0) phi += 1.0;
    observed[static_cast<std::size_t>(i * columns +
                                      std::clamp(static_cast<int>(phi * columns), 0, columns - 1))] += 1.0;
  }
  return test::chi2_test(observed, expected);
}

// sample() and pdf_w() agree with each other and with radiance().
void expect_consistent(const Environment& environment, float tolerance = 2e-3f) {
  for (std::uint32_t k = 0; k < 2000; ++k) {
    Sampler sampler(5, k, 0);
    const EnvironmentSample drawn = environment.sample(sampler.next_2d());
    ASSERT_NEAR(drawn.direction.length(), 1.0f, 1e-5f);
    const float pdf = environment.pdf_w(drawn.direction);
    ASSERT_NEAR(drawn.pdf_w, pdf, tolerance * pdf) << drawn.direction;
    const C3f radiance = environment.radiance(drawn.direction);
    ASSERT_NEAR(luminance(drawn.radiance), luminance(radiance), tolerance * luminance(radiance) + 1e-6f);
  }
}

// The irradiance of a surface with the given normal, by sampling.
C3f irradiance(const Environment& environment, const V3f& normal, std::uint32_t samples = 1 << 16) {
  C3d sum(0.0);
  for (std::uint32_t k = 0; k < samples; ++k) {
    Sampler sampler(1, 0, k);
    const EnvironmentSample drawn = environment.sample(sampler.next_2d());
    const float cosine = drawn.direction.dot(normal);
    if (drawn.pdf_w > 0.0f && cosine > 0.0f)
      sum += C3d(drawn.radiance) * static_cast<double>(cosine / drawn.pdf_w);
  }
  return C3f(sum / static_cast<double>(samples));
}

TEST(Environment, ConstantIsTheSameFromEverywhere) {
  const Environment environment(C3f(1, 2, 3));
  EXPECT_EQ(environment.radiance(V3f(0, 1, 0)), C3f(1, 2, 3));
  EXPECT_EQ(*environment.constant(), C3f(1, 2, 3));
  EXPECT_STREQ(environment.kind_name(), "constant");
  EXPECT_STREQ(Environment().kind_name(), "none");
  EXPECT_TRUE(Environment().is_black());
  EXPECT_NEAR(irradiance(environment, V3f(0, 1, 0)).x, pi_f, 2e-3f);
  EXPECT_GT(chi2_of(environment, 20000), level);
}

TEST(EnvironmentMap, StandsAsMitsubaHasIt) {
  // One bright pixel: where is it seen? The middle of the picture is +z, its left quarter +x, its top +y.
  const auto brightest = [](int x, int y, const EnvironmentMapOptions& options = {}) {
    Image image = blank(8, 5);
    image.at(x, y, 0) = 1.0f;
    const Environment environment = of(image, options);
    V3f best(0.0f);
    float most = -1.0f;
    for_directions(120, [&](const V3f& w, double) {
      if (environment.radiance(w).x > most) {
        most = environment.radiance(w).x;
        best = w;
      }
    });
    return best;
  };
  // Column x stands at u = (x + 1/2) / 8 turns from -z over +x.
  const auto at = [](double turns) {
    return V3f(V3d(std::sin(2 * pi * turns), 0.0, -std::cos(2 * pi * turns)));
  };
  EXPECT_LT((brightest(3, 2) - at(3.5 / 8)).length(), 0.05f);
  EXPECT_LT((brightest(4, 2) - at(4.5 / 8)).length(), 0.05f);
  EXPECT_LT((brightest(0, 2) - at(0.5 / 8)).length(), 0.05f);
  EXPECT_LT((brightest(7, 2) - at(7.5 / 8)).length(), 0.05f);
  EXPECT_GT(brightest(1, 2).x, 0.9f);
  // Rows run from the zenith to the nadir, poles included: row 1 of 5 stands 45 degrees below the zenith.
  EXPECT_NEAR(brightest(1, 1).y, std::sqrt(0.5f), 0.03f);
  EXPECT_NEAR(brightest(1, 3).y, -std::sqrt(0.5f), 0.03f);
  // Turned by 90 degrees about +y: what was at +x is at -z.
  EnvironmentMapOptions turned;
  turned.to_world = M44d().rotate(V3d(0.0, pi / 2.0, 0.0));
  EXPECT_LT(brightest(1, 2, turned).z, -0.9f);
}

TEST(EnvironmentMap, InterpolatesAcrossTheSeam) {
  Image image = blank(4, 3);
  for (int y = 0; y < 3; ++y) image.at(0, y, 0) = image.at(3, y, 1) = 1.0f;
  const Environment environment = of(image);
  const C3f seam = environment.radiance(V3f(0, 0, -1));
  EXPECT_NEAR(seam.x, 0.5f, 1e-5f);
  EXPECT_NEAR(seam.y, 0.5f, 1e-5f);
  EXPECT_NEAR(environment.radiance(unit(V3f(1, 0, -1))).x, 1.0f, 1e-5f);   // the centre of column 0
  EXPECT_NEAR(environment.radiance(unit(V3f(-1, 0, -1))).y, 1.0f, 1e-5f);  // that of column 3
}

TEST(EnvironmentMap, DrawsByTheDensityItTells) {
  const EnvironmentMapOptions compensated{2.0f, M44d().rotate(V3d(0.3, 0.4, 0.5)), true};
  for (const Environment& environment : {of(mottled(9, 7)), of(mottled(2, 3)), of(mottled(16, 9), compensated),
                                         of(blank(6, 4, 1.0f)), of(blank(6, 4, 1.0f), compensated)}) {
    double integral = 0.0;
    for_directions(600, [&](const V3f& w, double solid_angle) {
      const double pdf = environment.pdf_w(w);
      EXPECT_TRUE(std::isfinite(pdf));
      integral += pdf * solid_angle;
    });
    EXPECT_NEAR(integral, 1.0, 5e-3);
    EXPECT_GT(chi2_of(environment, 40000), level);
    expect_consistent(environment);
  }
}

TEST(EnvironmentMap, LeavesNothingOut) {
  Image image = blank(8, 6);
  for (int x = 0; x < 8; ++x) image.at(x, 0, 2) = 1.0f;  // only around the zenith
  const Environment environment = of(image);
  EXPECT_FALSE(environment.is_black());
  for_directions(100, [&](const V3f& w, double) {
    EXPECT_TRUE(is_black(environment.radiance(w)) || environment.pdf_w(w) > 0.0f) << w;
  });
  EXPECT_GT(chi2_of(environment, 20000), level);
}

TEST(EnvironmentMap, IrradianceOfKnownPictures) {
  EXPECT_NEAR(irradiance(of(blank(16, 9, 2.0f)), unit(V3f(1, 2, 3))).x, 2.0f * pi_f, 0.02f);
  // Bright above the horizon, black below, linear between the two rows around it: rows 0 ... 63 of 128.
  Image image = blank(64, 128);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) image.at(x, y, 0) = 1.0f;
  const Environment half = of(image);
  EXPECT_NEAR(irradiance(half, V3f(0, 1, 0)).x, pi_f, 1e-3f);
  EXPECT_NEAR(irradiance(half, V3f(1, 0, 0)).x, pi_f / 2, 5e-3f);
  EXPECT_NEAR(half.mean_radiance().x, 0.5f, 1e-3f);
  // One pixel far from the poles: a pyramid over two pixels each way, of volume 1 pixel.
  Image spot = blank(64, 65);
  spot.at(16, 32, 0) = 100.0f;
  const float pixel_w = (2 * pi_f / 64) * (pi_f / 64);
  const V3f towards = unit(V3f(std::sin(2 * pi_f * 16.5f / 64), 0, -std::cos(2 * pi_f * 16.5f / 64)));
  EXPECT_NEAR(irradiance(of(spot), towards).x, 100.0f * pixel_w, 100.0f * pixel_w * 3e-3f);
}

TEST(EnvironmentMap, KeepsWhatHalfPrecisionHolds) {
  const EnvironmentMap exact(blank(4, 3, 0.5f), {}, "test"), rough(blank(4, 3, 0.1f), {}, "test"),
      bright(blank(4, 3, 1e6f), {}, "test");
  EXPECT_TRUE(exact.is_half());
  EXPECT_FALSE(rough.is_half());
  EXPECT_FALSE(bright.is_half());
  EXPECT_FLOAT_EQ(bright.radiance(V3f(1, 0, 0)).x, 1e6f);
}

TEST(EnvironmentMap, BadPixelsAndSizes) {
  Image image = blank(4, 3, 1.0f);
  image.pixels[0] = std::numeric_limits<float>::quiet_NaN();
  image.pixels[4] = infinity_f;
  image.pixels[8] = -5.0f;
  const Environment environment = of(image);
  for_directions(40, [&](const V3f& w, double) {
    EXPECT_TRUE(is_finite(environment.radiance(w)));
    EXPECT_LE(environment.radiance(w).x, 1.0f);
  });
  EXPECT_THROW(of(blank(1, 3)), Error);
  EXPECT_THROW(of(blank(2, 2)), Error);
  EXPECT_TRUE(of(blank(4, 3)).is_black());
}

TEST(Environment, FingerprintsTellThemApart) {
  Image image = blank(4, 3, 1.0f);
  const std::uint64_t before = of(image).fingerprint();
  EXPECT_EQ(before, of(image).fingerprint());
  image.pixels[17] = 0.5f;
  EXPECT_NE(before, of(image).fingerprint());
  EXPECT_NE(before, of(blank(4, 3, 1.0f), {2.0f, M44d(), false}).fingerprint());
  EXPECT_NE(Environment(C3f(1.0f)).fingerprint(), Environment(C3f(2.0f)).fingerprint());
}

Environment sky(const SunSkyOptions& options) { return Environment(std::make_shared<const SunSky>(options)); }

TEST(SunSky, DrawsByTheDensityItTells) {
  SunSkyOptions wide;
  wide.sun_direction = V3d(0.3, -0.5, 0.4);
  wide.sun_aperture = 20.0f;
  wide.to_world =
      M44d().rotate(V3d(-1.4, 0.2, 0.0));  // far from the poles of the grid of directions, whose cells are long
  wide.to_world.multDirMatrix(V3d(wide.sun_direction), wide.sun_direction);
  SunSkyOptions low = wide;
  low.turbidity = 8.0f;
  low.sun_scale = 0.0f;
  // The sky's table is in steps; upright, they fall between the points of the test's grids.
  low.to_world = M44d();
  low.sun_direction = V3d(0.3, -0.5, 0.4);
  for (const SunSkyOptions& options : {wide, low}) {
    const Environment environment = sky(options);
    double integral = 0.0;
    for_directions(512,
                   [&](const V3f& w, double solid_angle) { integral += environment.pdf_w(w) * solid_angle; });
    EXPECT_NEAR(integral, 1.0, 5e-3);
    EXPECT_GT(chi2_of(environment, 40000), level);
  }
}

TEST(SunSky, SunKeepsItsIrradiance) {
  SunSkyOptions options;
  options.sun_direction = V3d(0.0, 0.6, 0.8);
  options.sky_scale = 0.0f;
  const V3f towards(options.sun_direction);
  const SunSky standard(options);
  const float solid_angle = 2 * pi_f * (1.0f - std::cos(0.2679f * pi_f / 180.0f));
  const C3f expected = standard.sun_radiance() * (2 * pi_f * 1.0929e-5f);
  EXPECT_NEAR(solid_angle / (2 * pi_f * 1.0929e-5f), 1.0f, 0.02f);
  EXPECT_NEAR(irradiance(sky(options), towards).x / expected.x, 1.0f, 2e-3f);
  options.complex_sun = true;
  EXPECT_NEAR(irradiance(sky(options), towards).x / expected.x, 1.0f, 2e-3f);
  options.sun_aperture = 5.0f;
  EXPECT_NEAR(irradiance(sky(options), towards).x / expected.x, 1.0f, 3e-3f);
  // Towards the middle of the disc it is brighter than at the limb.
  const Environment complex = sky(options);
  EXPECT_GT(complex.radiance(towards).x, 2.0f * complex.radiance(unit(towards + V3f(0.0434f, 0, 0))).x);
  EXPECT_TRUE(is_black(complex.radiance(unit(towards + V3f(0.05f, 0, 0)))));
}

TEST(SunSky, IsBlackBelowTheHorizonAndAtNight) {
  SunSkyOptions options;
  options.sun_direction = V3d(0.6, 0.0, 0.8);
  EXPECT_EQ(sky(options).radiance(V3f(0, 0, -1)), C3f(0.0f));
  options.sun_direction = V3d(0.6, 0.0, -0.8);
  EXPECT_TRUE(sky(options).is_black());
}

TEST(SunSky, SkyIsBlueAndSmoothInAllParameters) {
  // A wrong digit in the tables would stand out between its neighbours.
  const auto zenith = [](float turbidity, float albedo, float elevation) {
    return HosekSky(turbidity, C3f(albedo), elevation).radiance(1.0f, pi_f / 2 - elevation);
  };
  for (const float albedo : {0.0f, 0.5f, 1.0f})
    for (float turbidity = 1.0f; turbidity <= 8.0f; turbidity += 0.5f)
      for (float elevation = 0.3f; elevation < 1.2f; elevation += 0.1f) {
        const C3f here = zenith(turbidity, albedo, elevation),
                  hazier = zenith(turbidity + 0.5f, albedo, elevation),
                  later = zenith(turbidity, albedo, elevation + 0.1f);
        EXPECT_GT(here.z, here.x) << turbidity << " " << elevation;
        for (int c = 0; c < 3; ++c) {
          EXPECT_NEAR(hazier[c] / here[c], 1.1f, 0.35f) << turbidity << " " << albedo << " " << elevation;
          EXPECT_NEAR(later[c] / here[c], 1.25f, 0.45f) << turbidity << " " << albedo << " " << elevation;
        }
      }
}

TEST(SunPosition, AgreesWithAlmanacs) {
  const auto degrees = [](double radians) { return radians * 180.0 / pi; };
  // Solstice and equinox over Greenwich at noon, universal time: declinations of the almanac for 2010.
  SunTime time{51.4779, 0.0, 0.0, 2010, 6, 21, 12.0, 1.8, 0.0};  // the sun culminates 1.8 minutes late
  EXPECT_NEAR(90.0 - degrees(sun_position(time).zenith), 90.0 - 51.4779 + 23.438, 0.02);
  EXPECT_NEAR(degrees(sun_position(time).azimuth), 180.0, 0.1);
  time = {0.0, 0.0, 0.0, 2010, 3, 20, 17.0, 32.0, 0.0};  // the moment of the equinox: declination 0
  EXPECT_NEAR(degrees(sun_position(time).azimuth), 270.0, 0.05);
  // Reda and Andreas 2008 (NREL/TP-560-34302), the example of the solar position algorithm: Golden, Colorado,
  // 17 October 2003, 12:30:30, zenith 50.11162 (refracted; 50.1284 without), azimuth 194.34024 degrees.
  time = {39.742476, -105.1786, -7.0, 2003, 10, 17, 12.0, 30.0, 30.0};
  EXPECT_NEAR(degrees(sun_position(time).zenith), 50.1284, 0.02);
  EXPECT_NEAR(degrees(sun_position(time).azimuth), 194.34024, 0.02);
  const V3d direction = sun_direction(time);
  EXPECT_NEAR(direction.length(), 1.0, 1e-12);
  EXPECT_GT(direction.x, 0.0);  // south
}

// From Rec.709 to AP1, about.
const ColorMatrix to_ap1{
    {C3f(0.613f, 0.070f, 0.021f), C3f(0.340f, 0.916f, 0.110f), C3f(0.047f, 0.014f, 0.869f)}};

void expect_near(const C3f& a, const C3f& b) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-5f * std::max(1.0f, std::abs(b[c])));
}

TEST(Primaries, SurroundingsAreSeenInTheNewOnes) {
  Image image = mottled(16, 8);
  const Environment environments[] = {Environment(C3f(0.2f, 0.5f, 1.0f)), of(image),
                                      Environment(std::make_shared<const SunSky>(SunSkyOptions{}))};
  for (const Environment& before : environments) {
    const Environment after = before.in_primaries(to_ap1);
    EXPECT_NE(after.fingerprint(), before.fingerprint());
    expect_near(after.mean_radiance(), to_ap1(before.mean_radiance()));
    for (std::uint32_t i = 0; i < 100; ++i) {
      const V2f u = Sampler(3, i, 0).next_2d();
      const EnvironmentSample drawn = before.sample(u), other = after.sample(u);
      EXPECT_EQ(drawn.direction, other.direction);
      EXPECT_EQ(drawn.pdf_w, other.pdf_w);
      expect_near(other.radiance, to_ap1(drawn.radiance));
      expect_near(after.radiance(drawn.direction), to_ap1(before.radiance(drawn.direction)));
    }
  }
}

}  // namespace
}  // namespace twopass
