#include "render/scene/punctual_light.h"

#include <gtest/gtest.h>

#include "render/core/warp.h"
#include "render/scene/camera.h"

namespace twopass {
namespace {

constexpr float degree = pi_f / 180.0f;

// A picture of one colour a pixel, rows from top to bottom.
Texture picture(int width, int height, std::initializer_list<float> reds) {
  Image image(width, height, {"R", "G", "B"});
  int i = 0;
  for (const float red : reds) {
    image.pixels[3 * static_cast<std::size_t>(i)] = red;
    ++i;
  }
  return Bitmap{std::make_shared<TextureImage>(image)};
}

// The power that a light really sends through a sphere around it, by a fine sum over directions.
double measured_power(const PunctualLight& light, const V3f& centre) {
  constexpr int n = 400;
  double sum = 0.0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 2 * n; ++j) {
      const float z = 1.0f - 2.0f * (static_cast<float>(i) + 0.5f) / n,
                  phi = 2 * pi_f * (static_cast<float>(j) + 0.5f) / (2 * n);
      const float r = std::sqrt(1.0f - z * z);
      sum +=
          mean_component(illumination(light, centre + V3f(r * std::cos(phi), r * std::sin(phi), z)).irradiance);
    }
  return sum * 4.0 * pi / (2.0 * n * n);
}

TEST(PointLight, FallsWithTheSquareOfTheDistance) {
  const PunctualLight light = PointLight{V3f(1, 2, 3), C3f(8, 4, 2)};
  const Illumination there = illumination(light, V3f(1, 2, 5));
  EXPECT_EQ(there.direction, V3f(0, 0, -1));
  EXPECT_EQ(there.distance, 2.0f);
  EXPECT_EQ(there.irradiance, C3f(2, 1, 0.5f));
  EXPECT_NEAR(power(light, 1.0), 4.0 * pi * 14.0 / 3.0, 1e-5);
  EXPECT_STREQ(kind_name(light), "point");
}

TEST(PointLight, NeverGivesWhatIsNotANumber) {
  for (const float offset : {0.0f, 1e-38f, 1e-30f, 1e-15f, 1e30f, 3e38f}) {
    const Illumination there = illumination(PointLight{V3f(0.0f), C3f(1e10f)}, V3f(offset, 0, 0));
    EXPECT_TRUE(is_finite(there.irradiance) && is_finite(there.direction)) << offset;
    EXPECT_GE(there.irradiance.x, 0.0f);
  }
  EXPECT_EQ(illumination(PointLight{}, V3f(0.0f)).irradiance, C3f(0.0f));
}

TEST(PointLight, ShinesByItsProfile) {
  // Candela 100 straight down, 0 at the horizon; twice that towards C = 90.
  const auto profile =
      std::make_shared<const IesProfile>(std::vector<float>{0, 90}, std::vector<float>{0, 90, 180, 270, 360},
                                         std::vector<float>{100, 50, 100, 200, 100, 0, 100, 0, 100, 50});
  PointLight lamp{V3f(0, 0, 2), C3f(1.0f), profile, {}};
  // The nadir looks along -z of the world, C = 0 along +x.
  M44d down;
  down[1][1] = down[2][2] = -1.0;
  lamp.frame = light_frame(down);
  const auto candela = [&](const V3f& w) {
    return illumination(lamp, lamp.position + w).irradiance.x;  // at a metre
  };
  EXPECT_NEAR(candela({0, 0, -1}), 100.0f, 1e-3f);
  EXPECT_NEAR(candela({1, 0, 0}), 50.0f, 1e-3f);
  EXPECT_NEAR(candela({0, 1, 0}), 200.0f, 1e-3f) << "C runs counter-clockwise seen from above";
  EXPECT_NEAR(candela({-1, 0, 0}), 0.0f, 1e-3f);
  EXPECT_NEAR(candela(V3f(std::sqrt(0.5f), 0, -std::sqrt(0.5f))), 75.0f, 1e-3f);
  EXPECT_NEAR(candela(V3f(std::sqrt(0.5f), std::sqrt(0.5f), 0)), 125.0f, 1e-3f);
  EXPECT_EQ(candela({0, 0, 1}), 0.0f) << "above the table it is dark";
  EXPECT_NEAR(power(lamp, 1.0) / measured_power(lamp, lamp.position), 1.0, 2e-3);
}

TEST(IesProfile, KnowsItsSymmetries) {
  const auto at = [](const IesProfile& p, float c) {
    return p.candela(V3f(std::cos(c * degree), -std::sin(c * degree), 0.0f));  // gamma = 90
  };
  const IesProfile quarter({0, 90}, {0, 90}, {1, 10, 1, 20});
  for (const auto& [c, candela] :
       {std::pair{0.0f, 10.0f}, {90.0f, 20.0f}, {180.0f, 10.0f}, {270.0f, 20.0f}, {225.0f, 15.0f}})
    EXPECT_NEAR(at(quarter, c), candela, 1e-3f) << c;
  const IesProfile half({0, 90}, {0, 90, 180}, {1, 10, 1, 20, 1, 40});
  for (const auto& [c, candela] : {std::pair{45.0f, 15.0f}, {135.0f, 30.0f}, {225.0f, 30.0f}, {315.0f, 15.0f}})
    EXPECT_NEAR(at(half, c), candela, 1e-3f) << c;
  const IesProfile across({0, 90}, {90, 180, 270}, {1, 10, 1, 20, 1, 40});
  for (const auto& [c, candela] :
       {std::pair{90.0f, 10.0f}, {0.0f, 20.0f}, {270.0f, 40.0f}, {45.0f, 15.0f}, {315.0f, 30.0f}})
    EXPECT_NEAR(at(across, c), candela, 1e-3f) << c;
  EXPECT_NEAR(IesProfile({0, 180}, {0}, {1, 1}).flux(), 4.0 * pi, 1e-6);
}

TEST(SpotLight, FadesLinearlyInTheAngle) {
  SpotLight spot;
  spot.frame = light_frame(look_at({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, "test"));
  spot.intensity = C3f(4, 2, 1);
  spot.cutoff_angle = 30.0f * degree;
  spot.beam_width = 10.0f * degree;
  const auto at = [&](float angle) {
    return illumination(spot, V3f(std::cos(angle * degree), 0, std::sin(angle * degree)) * 2.0f).irradiance.x;
  };
  EXPECT_NEAR(at(0), 1.0f, 1e-6f);
  EXPECT_NEAR(at(9.9f), 1.0f, 1e-6f);
  EXPECT_NEAR(at(15), 0.75f, 1e-5f);
  EXPECT_NEAR(at(25), 0.25f, 1e-5f);
  EXPECT_EQ(at(30.1f), 0.0f);
  EXPECT_EQ(at(180), 0.0f);
  EXPECT_NEAR(power(spot, 1.0) / measured_power(spot, V3f(0.0f)), 1.0, 1e-3);
  spot.beam_width = spot.cutoff_angle;
  EXPECT_EQ(at(29.9f), 1.0f);
  EXPECT_EQ(at(30.1f), 0.0f);
  EXPECT_NEAR(power(spot, 1.0) / measured_power(spot, V3f(0.0f)), 1.0, 5e-3);
}

TEST(SpotLight, ProjectsItsTexture) {
  SpotLight spot;  // along +z
  spot.cutoff_angle = spot.beam_width = 45.0f * degree;
  spot.texture = std::make_shared<const Texture>(picture(2, 2, {1, 2, 3, 4}));
  // Pixel centres are at tangents of -1/2 and 1/2; rows run down along +y, as Mitsuba has it.
  EXPECT_NEAR(illumination(spot, V3f(-0.5f, -0.5f, 1)).irradiance.x * 1.5f, 1.0f, 1e-5f);
  EXPECT_NEAR(illumination(spot, V3f(0.5f, -0.5f, 1)).irradiance.x * 1.5f, 2.0f, 1e-5f);
  EXPECT_NEAR(illumination(spot, V3f(-0.5f, 0.5f, 1)).irradiance.x * 1.5f, 3.0f, 1e-5f);
  EXPECT_NEAR(illumination(spot, V3f(0, 0, 2)).irradiance.x * 4.0f, 2.5f, 1e-5f);
}

TEST(DirectionalLight, IsTheSameEverywhere) {
  const PunctualLight sun = DirectionalLight{V3f(0, 0, -1), C3f(3, 2, 1)};
  const Illumination there = illumination(sun, V3f(1e6f, 5, 7));
  EXPECT_EQ(there.direction, V3f(0, 0, 1));
  EXPECT_EQ(there.distance, infinity_f);
  EXPECT_EQ(there.irradiance, C3f(3, 2, 1));
  EXPECT_NEAR(power(sun, 2.0), 2.0 * 4.0 * pi, 1e-5);
}

TEST(Projector, LightsAPlaneEvenly) {
  Projector projector;
  projector.texture = std::make_shared<const Texture>(C3f(2, 1, 0));
  projector.scale = 0.5f;
  projector.tan_half_fov = 0.5f;
  for (const V3f& p : {V3f(0, 0, 3), V3f(1.4f, 0, 3), V3f(-1, 1.3f, 3)}) {
    const Illumination there = illumination(projector, p);
    EXPECT_NEAR(there.irradiance.x * there.direction.dot(V3f(0, 0, -1)), pi_f / 9.0f, 1e-6f) << p;
  }
  for (const V3f& p : {V3f(1.6f, 0, 3), V3f(0, -1.6f, 3), V3f(0, 0, -3), V3f(1, 0, 0), V3f(0.0f)})
    EXPECT_EQ(illumination(projector, p).irradiance, C3f(0.0f)) << p;
  EXPECT_NEAR(power(projector, 1.0) / measured_power(projector, V3f(0.0f)), 1.0, 5e-3);
}

TEST(Projector, ShowsItsPictureUpright) {
  Projector projector;
  projector.tan_half_fov = 1.0f;
  projector.texture = std::make_shared<const Texture>(picture(2, 2, {1, 2, 3, 4}));
  const auto at = [&](float x, float y) {
    const Illumination there = illumination(projector, V3f(x, y, 1));
    return there.irradiance.x * -there.direction.z / pi_f;
  };
  EXPECT_NEAR(at(0.5f, 0.5f), 1.0f, 1e-5f);  // as a camera there would see it: +x is left, +y up
  EXPECT_NEAR(at(-0.5f, 0.5f), 2.0f, 1e-5f);
  EXPECT_NEAR(at(0.5f, -0.5f), 3.0f, 1e-5f);
  EXPECT_NEAR(at(-0.5f, -0.5f), 4.0f, 1e-5f);
}

TEST(PunctualLight, FingerprintsTellLightsApart) {
  const PointLight point;
  PointLight other = point;
  other.intensity.z = 1.0001f;
  PointLight shaped = point;
  shaped.profile = std::make_shared<const IesProfile>(std::vector<float>{0, 90}, std::vector<float>{0},
                                                      std::vector<float>{1, 1});
  EXPECT_EQ(fingerprint(point), fingerprint(PointLight{}));
  EXPECT_NE(fingerprint(point), fingerprint(other));
  EXPECT_NE(fingerprint(point), fingerprint(shaped));
  EXPECT_NE(fingerprint(SpotLight{}), fingerprint(DirectionalLight{}));
}

// From Rec.709 to AP1, about.
const ColorMatrix to_ap1{
    {C3f(0.613f, 0.070f, 0.021f), C3f(0.340f, 0.916f, 0.110f), C3f(0.047f, 0.014f, 0.869f)}};

void expect_near(const C3f& a, const C3f& b) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-5f * std::max(1.0f, std::abs(b[c])));
}

TEST(Primaries, LightsShineInTheNewOnes) {
  Image image(1, 1, {"R", "G", "B"});
  image.pixels = {0.8f, 0.2f, 0.1f};
  const auto texture = std::make_shared<const Texture>(Bitmap{std::make_shared<TextureImage>(image)});
  const C3f color(3.0f, 1.0f, 0.2f);
  SpotLight spot{light_frame(M44d{}), color}, slide = spot;
  slide.texture = texture;
  Projector projector;
  projector.frame = light_frame(M44d{});
  projector.texture = texture;
  const PunctualLight lights[] = {PointLight{V3f(0.0f), color}, spot, slide,
                                  DirectionalLight{V3f(0, 0, 1), color}, projector};
  for (const PunctualLight& light : lights) {
    const C3f before = illumination(light, V3f(0.0f, 0.0f, 2.0f)).irradiance;
    ASSERT_FALSE(is_black(before)) << kind_name(light);
    expect_near(illumination(in_primaries(light, to_ap1), V3f(0.0f, 0.0f, 2.0f)).irradiance, to_ap1(before));
    EXPECT_NE(fingerprint(in_primaries(light, to_ap1)), fingerprint(light)) << kind_name(light);
  }
}

}  // namespace
}  // namespace twopass
