// The path tracer's light against closed forms and CIE 171:2006 (Test Cases to Assess the Accuracy of Lighting
// Computer Programs). Units are lm, cd and lx in all channels.
#include <gtest/gtest.h>

#include "integrators/make_integrator.h"
#include "radiosity/lambert.h"
#include "render/core/warp.h"
#include "tests/support/scenes.h"
#include "tests/support/statistics.h"

namespace twopass {
namespace {

const V3f x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);

// Mean radiance of one ray of many samples: one stream, whose points fill the square far more evenly than
// random ones, so that 2^n of them have an error far below 1/sqrt(2^n).
C3d mean_radiance(const Integrator& integrator, const Ray& ray, std::uint32_t samples) {
  std::vector<PathSample> all;
  for (std::uint32_t i = 0; i < samples; ++i) all.push_back({ray, Sampler(9, 1, i)});
  RayCounts counts;
  integrator.trace(all, counts);
  C3d sum(0.0);
  for (const PathSample& sample : all) sum += C3d(sample.seen.radiance);
  return sum / samples;
}

constexpr float reflectance = 0.5f;  // of what illuminance is measured on

// Illuminance at a point of a Lambertian surface, from the light that it reflects to a camera just
// above it.
double illuminance(const Integrator& integrator, const V3f& position, const V3f& normal,
                   std::uint32_t samples = 1) {
  const Ray ray{position + normal * 0.01f, -normal};
  return pi / double(reflectance) * mean_radiance(integrator, ray, samples).x;
}

std::unique_ptr<Integrator> direct(const Scene& scene) {
  return make_integrator(IntegratorKind::direct, scene, {}, {});
}

Mesh horizontal(float z_of, const V2f& low, const V2f& high, bool faces_up) {
  const V3f corner(low.x, low.y, z_of), u(high.x - low.x, 0, 0), v(0, high.y - low.y, 0);
  return faces_up ? test::quad(corner, u, v) : test::quad(corner, v, u);
}

Polygon polygon_of(const Mesh& quad) {
  const std::vector<V3f>& p = quad.positions;
  return make_polygon(V3d(p[0]), V3d(p[1]), V3d(p[2]), V3d(p[3]));
}

// A floor of 8 x 8 under a point light at (0, 0, 3).
SceneDescription floor_and(const PunctualLight& light) {
  SceneDescription scene;
  test::add_diffuse(scene, "floor", horizontal(0, V2f(-4), V2f(4), true), C3f(reflectance));
  scene.punctual_lights.push_back(light);
  return scene;
}

struct Reading {
  V3f position;
  double lux;
};

// ---------------------------------------------------------------------------------------------------------
// Closed forms.

// Lambert's formula: polygon lamps over, beside and crossing the horizon of their receivers.
TEST(PathTruth, PolygonLampsOnDifferentReceivers) {
  const Mesh lamps[] = {horizontal(2, V2f(-0.5f, -0.3f), V2f(0.7f, 0.4f), false),
                        test::quad(V3f(1.5f, -0.5f, -0.4f), z, y),
                        test::quad(V3f(-1.0f, 0.8f, 0.5f), V3f(0.5f, 0.3f, 0.8f), V3f(0.9f, -0.2f, 0.1f))};
  const V3f receivers[] = {{0, 0, 0}, {0.9f, 0.2f, 0}, {-0.8f, -0.9f, 0}};
  for (const Mesh& lamp : lamps) {
    SceneDescription description;
    test::add_diffuse(description, "floor", horizontal(0, V2f(-1), V2f(1), true), C3f(reflectance));
    Shape& shape = test::add_diffuse(description, "lamp", lamp, C3f(0.0f), C3f(10.0f));
    shape.radiance[back] = C3f(10.0f);
    const Scene scene(description);
    const auto integrator = direct(scene);
    for (const V3f& p : receivers) {
      const double truth = 10.0 * pi * std::abs(signed_point_form_factor(V3d(p), V3d(z), polygon_of(lamp)));
      EXPECT_NEAR(illuminance(*integrator, p, z, 1 << 14) / truth, 1.0, 2e-3) << p;
    }
  }
}

// A sphere above the horizon: E = pi L (r / d)^2 cos.
TEST(PathTruth, SphereLamp) {
  SceneDescription description;
  test::add_diffuse(description, "floor", horizontal(0, V2f(-4), V2f(4), true), C3f(reflectance));
  test::add_diffuse(description, "lamp", Sphere{V3f(0, 0, 1.5f), 0.5f, false}, C3f(0.0f), C3f(10.0f));
  const Scene scene(description);
  const auto integrator = direct(scene);
  for (const V3f& p : {V3f(0, 0, 0), V3f(1, 0.5f, 0), V3f(-3, 2, 0)}) {
    const V3d to_lamp = V3d(0, 0, 1.5) - V3d(p);
    const double d2 = to_lamp.dot(to_lamp);
    const double truth = pi * 10.0 * 0.25 / d2 * to_lamp.z / std::sqrt(d2);
    EXPECT_NEAR(illuminance(*integrator, p, z, 1 << 12) / truth, 1.0, 2e-3) << p;
  }
}

// ---------------------------------------------------------------------------------------------------------
// CIE 171:2006. All within half a per cent; what needs no integration, within five digits.

TEST(PathTruth, CIE_5_2_CosineLuminaire) {
  std::vector<float> angles, candela;
  for (int i = 0; i <= 360; ++i) {
    angles.push_back(0.25f * static_cast<float>(i));
    candela.push_back(1000.0f * std::max(0.0f, std::cos(angles.back() * pi_f / 180.0f)));
  }
  PointLight light{V3f(0, 0, 3), C3f(1.0f)};
  light.profile = std::make_shared<const IesProfile>(angles, std::vector<float>{0.0f}, candela);
  light.frame.to_local[1] = -y;  // its nadir points down
  light.frame.to_local[2] = -z;
  const Scene scene(floor_and(light));
  const auto integrator = direct(scene);
  for (const Reading& reading :
       {Reading{{0, 0, 0}, 111.1111}, {{0.5f, 0, 0}, 105.1863}, {{1, 0, 0}, 90.0}, {{1.5f, 1.5f, 0}, 49.3827}})
    EXPECT_NEAR(illuminance(*integrator, reading.position, z) / reading.lux, 1.0, 2e-5) << reading.position;
}

TEST(PathTruth, CIE_5_2_IsotropicLuminaire) {
  const Scene scene(floor_and(PointLight{V3f(0, 0, 3), C3f(10000.0f / (4 * pi_f))}));
  const auto integrator = direct(scene);
  for (const Reading& reading :
       {Reading{{0, 0, 0}, 88.4194}, {{0.5f, 0, 0}, 84.8592}, {{1, 0, 0}, 75.4938}, {{1.5f, 1.5f, 0}, 48.1294}})
    EXPECT_NEAR(illuminance(*integrator, reading.position, z) / reading.lux, 1.0, 1e-5) << reading.position;
}

// A lamp of 1 x 1 m and 1000 cd in the middle of the ceiling of a room of 4 x 4 x 3 m.
TEST(PathTruth, CIE_5_3_AreaLamp) {
  SceneDescription description;
  test::add_diffuse(description, "floor", horizontal(0, V2f(0), V2f(4), true), C3f(reflectance));
  test::add_diffuse(description, "wall", test::quad(V3f(0.0f), z * 3.0f, x * 4.0f), C3f(reflectance));
  const Mesh lamp = horizontal(3, V2f(1.5f), V2f(2.5f), false);
  test::add_diffuse(description, "lamp", lamp, C3f(0.0f), C3f(1000.0f));
  const Scene scene(description);
  const auto integrator = direct(scene);
  const auto check = [&](const V3f& normal, const Reading& reading) {
    const double lux = illuminance(*integrator, reading.position, normal, 1 << 14);
    EXPECT_NEAR(lux / reading.lux, 1.0, 2e-3) << reading.position;
    const double exact = 1000.0 * pi * point_form_factor(V3d(reading.position), V3d(normal), polygon_of(lamp));
    EXPECT_NEAR(exact / reading.lux, 1.0, 1e-5);
  };
  for (const Reading& reading : {Reading{{2, 0, 2.75f}, 32.6769},
                                 {{2, 0, 2.25f}, 75.1939},
                                 {{2, 0, 1.75f}, 81.3232},
                                 {{2, 0, 1.25f}, 69.0606},
                                 {{2, 0, 0.75f}, 53.4035},
                                 {{2, 0, 0.25f}, 40.0019}})
    check(y, reading);
  for (const Reading& reading : {Reading{{2, 0.25f, 0}, 61.4241},
                                 {{2, 0.75f, 0}, 79.2552},
                                 {{2, 1.25f, 0}, 95.6673},
                                 {{2, 1.75f, 0}, 105.7782}})
    check(z, reading);
}

// Flux conservation: all of the 10000 lm of a lamp in a closed black room of 4 x 4 x 3 m arrive at its walls.
// The midpoints of 64 x 64 cells a wall integrate illuminance to 1e-4.
TEST(PathTruth, CIE_5_4_FluxConservation) {
  const V3f size(4, 4, 3);
  const auto flux = [&](const PunctualLight& light) {
    SceneDescription description = test::unit_room(C3f(reflectance), C3f(0.0f), C3f(reflectance));
    for (Shape& shape : description.shapes)
      for (V3f& p : std::get<Mesh>(shape.geometry).positions) p *= size;
    description.punctual_lights.push_back(light);
    const Scene scene(description);
    const auto integrator = direct(scene);
    constexpr int cells = 64;
    double lumen = 0.0;
    for (const Shape& shape : description.shapes) {
      const std::vector<V3f>& p = std::get<Mesh>(shape.geometry).positions;
      const V3f a = p[1] - p[0], b = p[3] - p[0], normal = a.cross(b).normalized();
      const double area = double(a.cross(b).length()) / (cells * cells);
      for (int i = 0; i < cells; ++i)
        for (int j = 0; j < cells; ++j) {
          const float u = (static_cast<float>(i) + 0.5f) / cells, v = (static_cast<float>(j) + 0.5f) / cells;
          lumen += area * illuminance(*integrator, p[0] + a * u + b * v, normal);
        }
    }
    return lumen;
  };
  const PointLight bare{V3f(2, 2, 1.5f), C3f(10000.0f / (4 * pi_f))};
  EXPECT_NEAR(flux(bare) / 10000.0, 1.0, 1e-3);
  PointLight aside = bare;
  aside.position = V3f(1, 2.5f, 2.25f);
  EXPECT_NEAR(flux(aside) / 10000.0, 1.0, 1e-3);
}

// A pane of index 1.52 passes (1 - R) / (1 + R) at normal incidence, as one surface and as a slab of two.
TEST(PathTruth, CIE_5_5_GlassPane) {
  const double once = std::pow(0.52 / 2.52, 2), truth = (1.0 - once) / (1.0 + once);
  EXPECT_NEAR(truth, 0.918318, 1e-6);
  const Mesh pane = horizontal(1, V2f(-1), V2f(1), true);
  for (const bool is_slab : {false, true}) {
    SceneDescription description;
    test::add_diffuse(description, "lamp", horizontal(2, V2f(-1), V2f(1), false), C3f(0.0f), C3f(1.0f));
    if (is_slab) {
      test::add_box(description, "slab", V3f(-1, -1, 0.9f), V3f(1, 1, 1), interface_material("glass", {1.52f}));
    } else {
      test::add_diffuse(description, "pane", pane, C3f(0.0f));
      description.materials.back() = material_of("pane", ThinDielectric{1.52f});
    }
    const Scene scene(description);
    const auto path = make_integrator(IntegratorKind::path, scene, {}, {-1, 100, false});
    EXPECT_NEAR(mean_radiance(*path, {V3f(0.1f, 0.2f, 0), z}, 1 << 16).x, truth, 1e-3) << is_slab;
  }
}

// A floor of 4 x 4 m under even light, seen by the middle of a wall: 100 E / (E_floor rho).
TEST(PathTruth, CIE_5_6_LightReflectedByTheFloor) {
  SceneDescription description;
  test::add_diffuse(description, "floor", horizontal(0, V2f(0), V2f(4), true), C3f(0.3f));
  test::add_diffuse(description, "wall", test::quad(V3f(0.0f), z * 3.0f, x * 4.0f), C3f(reflectance));
  description.punctual_lights.emplace_back(DirectionalLight{V3f(0, 0, -1), C3f(1000.0f)});
  const Scene scene(description);
  // Sun, floor, wall, camera: not what the wall returns to the floor.
  const auto path = make_integrator(IntegratorKind::path, scene, {}, {3, 5, false});
  for (const Reading& reading : {Reading{{2, 0, 0.75f}, 35.9005},
                                 {{2, 0, 1.25f}, 27.9916},
                                 {{2, 0, 1.75f}, 21.6385},
                                 {{2, 0, 2.25f}, 16.7163},
                                 {{2, 0, 2.75f}, 12.9674}})
    EXPECT_NEAR(100.0 * illuminance(*path, reading.position, y, 1 << 16) / (1000.0 * 0.3) / reading.lux, 1.0,
                5e-3)
        << reading.position;
}

// A wall of 4 x 3 m under even light, seen by the wall and the floor opposite over a black box that stands
// across the room: 100 E / (E_wall rho), as corrected by Ashdown (the standard's own table is wrong).
TEST(PathTruth, CIE_5_7_LightReflectedByAWallBehindABox) {
  SceneDescription description;
  test::add_diffuse(description, "wall", test::quad(V3f(0.0f), z * 3.0f, x * 4.0f), C3f(reflectance));
  test::add_diffuse(description, "floor", horizontal(0, V2f(0), V2f(4, 2.5f), true), C3f(reflectance));
  test::add_diffuse(description, "reflector", test::quad(y * 4.0f, x * 4.0f, z * 3.0f), C3f(0.3f));
  test::add_box(description, "box", V3f(0, 2.5f, 0), V3f(4, 2.7f, 1), one_sided("black", Diffuse{C3f(0.0f)}));
  // From behind and above the wall, so that it shines on all of the reflector and on nothing else.
  const float slant = std::sqrt(0.5f);
  description.punctual_lights.emplace_back(DirectionalLight{V3f(0, slant, -slant), C3f(1000.0f / slant)});
  const Scene scene(description);
  // Sun, reflector, receiver, camera.
  const auto path = make_integrator(IntegratorKind::path, scene, {}, {3, 5, false});
  const auto check = [&](const V3f& normal, const Reading& reading) {
    const double lux = illuminance(*path, reading.position, normal, 1 << 16);
    EXPECT_NEAR(100.0 * lux / (1000.0 * 0.3), reading.lux, 5e-3 * reading.lux) << reading.position;
  };
  for (const Reading& reading : {Reading{{2, 0, 2.75f}, 16.0706},
                                 {{2, 0, 2.25f}, 16.3297},
                                 {{2, 0, 1.75f}, 15.3988},
                                 {{2, 0, 1.25f}, 13.3220},
                                 {{2, 0, 0.75f}, 10.3169},
                                 {{2, 0, 0.25f}, 7.0790}})
    check(y, reading);
  for (const Reading& reading : {Reading{{2, 0.25f, 0}, 3.3823},
                                 {{2, 0.75f, 0}, 3.6290},
                                 {{2, 1.25f, 0}, 3.0130},
                                 {{2, 1.75f, 0}, 0.0},
                                 {{2, 2.25f, 0}, 0.0}})
    check(z, reading);
}

// A cube of 4 m around a lamp of 10000 lm: direct light; and the mean of all light, flux / (S (1 - rho)).
TEST(PathTruth, CIE_5_8_Interreflections) {
  SceneDescription description = test::unit_room(C3f(reflectance), C3f(0.0f), C3f(reflectance));
  for (Shape& shape : description.shapes)
    for (V3f& p : std::get<Mesh>(shape.geometry).positions) p *= 4.0f;
  description.punctual_lights.emplace_back(PointLight{V3f(2.0f), C3f(10000.0f / (4 * pi_f))});
  const Scene scene(description);
  const auto integrator = direct(scene);
  EXPECT_NEAR(illuminance(*integrator, V3f(2, 2, 0), z), 198.944, 2e-3);
  EXPECT_NEAR(illuminance(*integrator, V3f(1e-5f, 2, 0), z), 70.337, 2e-3);
  EXPECT_NEAR(illuminance(*integrator, V3f(1e-5f, 1e-5f, 0), z), 38.287, 2e-3);

  const auto path = make_integrator(IntegratorKind::path, scene, {}, {});
  const V3f normals[] = {z, -z, x, -x, y, -y};
  test::Estimate all;
  RayCounts counts;
  for (std::uint32_t i = 0; i < 60000; ++i) {
    Sampler sampler(2, i, 0);
    const V2f u = sampler.next_2d();
    const V3f normal = normals[i % 6];
    const Frame frame(normal);
    const V3f p = V3f(2.0f) + frame.to_world({4 * u.x - 2, 4 * u.y - 2, -2});
    // Seen from the middle, which every surface point sees.
    const Ray ray{V3f(2.0f), (p - V3f(2.0f)).normalized()};
    all.add(pi / double(reflectance) * path->radiance(ray, sampler, counts).radiance.x);
  }
  const double truth = 10000.0 / (96.0 * (1.0 - double(reflectance))), direct_mean = 10000.0 / 96.0;
  EXPECT_NEAR(all.mean(), truth, 4.4 * all.standard_error());
  EXPECT_NEAR((all.mean() - direct_mean) / 104.1667, 1.0, 5e-3);
}

}  // namespace
}  // namespace twopass
