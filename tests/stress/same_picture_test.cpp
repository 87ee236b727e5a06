// What may not change a picture: the unit of length, the unit of light, threads; and what may change its noise
// only: seeds.
#include <gtest/gtest.h>

#include "render/core/parallel.h"
#include "tests/stress/furnace_scenes.h"
#include "tests/stress/picture.h"

namespace twopass::stress {
namespace {

// A room with boxes and a ball, a small lamp below its ceiling and a bare bulb, lit by nothing else.
SceneDescription lit_room(float radiance = 1.0f) {
  SceneDescription scene = furnished_furnace();
  scene.environment = Environment();
  for (Shape& shape : scene.shapes) shape.radiance = {C3f(0.0f), C3f(0.0f)};
  test::add_diffuse(scene, "lamp", test::quad(V3f(0.4f, 0.4f, 0.99f), V3f(0, 0.3f, 0), V3f(0.3f, 0, 0)),
                    C3f(0.0f), C3f(8.0f * radiance));
  scene.punctual_lights.emplace_back(PointLight{V3f(0.9f, 0.3f, 0.9f), C3f(0.2f * radiance)});
  CameraDescription camera;
  camera.to_world = look_at({0.5, 0.03, 0.5}, {0.5, 1.0, 0.45}, {0, 0, 1}, "camera");
  camera.fov_degrees = 80.0;
  scene.camera = camera;
  return scene;
}

// The share of the pixels' values that are not `factor` times those of the other within a thousandth: paths
// that graze an edge may pass it on its other side when everything is rounded anew, and end up elsewhere.
double share_that_differs(const Picture& a, const Picture& b, double factor) {
  std::size_t differing = 0;
  for (std::size_t i = 0; i < a.image.pixels.size(); ++i) {
    if (i % 4 == 3) continue;
    const double x = factor * static_cast<double>(a.image.pixels[i]),
                 y = static_cast<double>(b.image.pixels[i]);
    if (!(std::abs(x - y) <= 1e-3 * std::max(x, y))) ++differing;
  }
  return static_cast<double>(differing) / (0.75 * static_cast<double>(a.image.pixels.size()));
}

// Powers of two change no digit; others do: then elements are cut elsewhere, and paths that depend on them
// differ.
TEST(SamePicture, InOtherUnitsOfLength) {
  for (const Way& way : all_integrators()) {
    const Picture unit = render(lit_room(), way);
    ASSERT_EQ(fault_of(unit), "");
    for (const float factor : {1e-9f, 0x1p-30f, 1e-6f, 0x1p-10f, 3.0f, 0x1p10f, 1e6f, 0x1p30f, 1e9f}) {
      SCOPED_TRACE(name_of(way) + " at " + std::to_string(std::log10(factor)));
      const Picture other = render(transformed(lit_room(), factor), way);
      ASSERT_EQ(fault_of(other), "");
      int exponent;
      if (std::frexp(factor, &exponent) == 0.5f) {
        EXPECT_EQ(unit.image.pixels, other.image.pixels);
      }
      const double noise =
          way.integrator == IntegratorKind::unbiased ? 4.4 * std::hypot(unit.error, other.error) : 0.0;
      EXPECT_NEAR(other.mean, unit.mean, std::max(0.01 * unit.mean, noise));
    }
  }
}

TEST(SamePicture, InOtherUnitsOfLight) {
  for (const Way& way : all_integrators()) {
    const Picture unit = render(lit_room(), way);
    for (const float factor : {1e-12f, 1e-6f, 1e6f, 1e12f}) {
      SCOPED_TRACE(name_of(way) + " at " + std::to_string(std::log10(factor)));
      const Picture other = render(lit_room(factor), way);
      ASSERT_EQ(fault_of(other), "");
      EXPECT_LT(share_that_differs(unit, other, static_cast<double>(factor)), 0.02);
    }
  }
}

TEST(SamePicture, OnAnyNumberOfThreads) {
  const SceneDescription soup = triangle_soup(), room = lit_room();
  for (const SceneDescription& scene : {soup, room})
    for (const Way& way : all_ways()) {
      std::vector<Image> images;
      for (const int threads : {1, 3}) {
        const ThreadLimit limit(threads);
        PictureOptions options;
        options.width = options.height = 20;  // four tiles
        options.samples = 4;
        images.push_back(render(scene, way, options).image);
      }
      EXPECT_EQ(images[0].pixels, images[1].pixels) << name_of(way);
    }
}

TEST(SamePicture, OfAnySeedButForItsNoise) {
  for (const IntegratorKind integrator : {IntegratorKind::path, IntegratorKind::unbiased})
    for (const SamplerKind sampler : {SamplerKind::independent, SamplerKind::sobol, SamplerKind::stratified}) {
      PictureOptions options;
      options.sampler = sampler;
      options.samples = 64;
      const Picture first = render(lit_room(), {integrator}, options);
      options.seed = 77;
      const Picture second = render(lit_room(), {integrator}, options);
      EXPECT_NE(first.image.pixels, second.image.pixels);
      EXPECT_NEAR(first.mean, second.mean, 4.4 * std::hypot(first.error, second.error));
    }
}

}  // namespace
}  // namespace twopass::stress
