#include "radiosity/indirect_field.h"

#include <gtest/gtest.h>

#include "materials/diffuse_response.h"
#include "radiosity/lambert.h"
#include "render/core/parallel.h"
#include "render/core/sampler.h"
#include "render/core/warp.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

Solution solve(const Scene& scene, std::size_t elements) {
  RadiosityOptions options;
  options.max_elements = elements;
  options.subdivision = Subdivision::adaptive;
  return solve_radiosity(scene, options);
}

SurfacePoint point_below(const Scene& scene, const V3f& from, const V3f& direction) {
  const Ray ray{from, unit(direction)};
  return scene.surface_point(ray, scene.caster().intersect(ray));
}

// Of a room, anywhere that is seen from its middle parts.
SurfacePoint any_point(const Scene& scene, Sampler& sampler) {
  const V2f u = sampler.next_2d();
  const V3f from(0.05f + 0.6f * u.x, 0.05f + 0.4f * u.y, 0.2f + 0.6f * sampler.next_1d());
  return point_below(scene, from, square_to_sphere(sampler.next_2d()));
}

// A thin wall stands on its floor.
SceneDescription divided_room() {
  SceneDescription scene = test::furnished_room();
  const Diffuse white{C3f(0.7f)};
  scene.materials.push_back(two_sided("wall", white, white));
  Shape wall;
  wall.name = "wall";
  wall.geometry = test::quad(V3f(0.731f, 0.0f, 0.0f), V3f(0, 0.63f, 0), V3f(0, 0, 0.83f));
  wall.material = static_cast<std::uint32_t>(scene.materials.size() - 1);
  scene.shapes.push_back(wall);
  return scene;
}

// What a point receives from the elements of the solution, by as many rays as it takes. `normal`: of its
// surface, which may be tilted against its geometric normal. `response`: (R50) of that surface.
C3f gathered(const Scene& scene, const Solution& solution, const SurfacePoint& point, const V3f& normal,
             std::uint32_t key, const DiffuseResponse* response = nullptr) {
  constexpr std::uint32_t rays = 4096;
  C3f sum(0.0f);
  for (std::uint32_t k = 0; k < rays; ++k) {
    Sampler sampler(7, key, k);
    const V3f direction = Frame(normal).to_world(square_to_cosine_hemisphere(sampler.next_2d()));
    if (!(direction.dot(point.geometric_normal) > 0.0f)) continue;
    const Ray ray{spawn_position(point, direction), direction};
    const Hit hit = scene.caster().intersect(ray);
    if (hit.escaped()) continue;
    const SurfacePoint there = scene.surface_point(ray, hit);
    const double counts = response ? response->at(static_cast<double>(direction.dot(normal))) : 1.0;
    sum += scene.side(there).traits().mean_diffuse_reflectance * solution.irradiance(there).total() *
           static_cast<float>(counts);
  }
  return sum / static_cast<float>(rays);
}

TEST(IndirectField, IsConstantInAFurnace) {
  const C3f albedo(0.7f, 0.5f, 0.3f);
  const Scene scene(test::furnace_room(albedo, 2.0f));
  const Solution solution = solve(scene, 4000);
  const IndirectField by_default(scene, solution);
  EXPECT_GT(by_default.share(Known::indirect), 0.4);
  EXPECT_GT(by_default.rays(), 0u);
  for (const double tolerance : {0.005, 0.0}) {  // with and without direct light
    const IndirectField field(scene, solution, {.direct_tolerance = tolerance});
    const auto found = field.at(point_below(scene, V3f(0.5f), V3f(0.1f, 0.2f, -1)));
    ASSERT_EQ(found.known, tolerance > 0.0 ? Known::all : Known::indirect);
    for (int c = 0; c < 3; ++c) {
      const float all = pi_f * 2.0f, expected = tolerance > 0.0 ? all : all * albedo[c];
      EXPECT_NEAR(found.irradiance[c], expected, 0.01f * expected);
    }
  }
}

// A ceiling of exitance 1, reflectance 1/2 everywhere: irradiance at the middle of the floor 0.39521, of a wall
// 0.35530, less what comes straight from the ceiling; of the ceiling 0.18361.
TEST(IndirectField, HasTheIrradianceOfTheCube) {
  const Scene scene(test::unit_room(C3f(0.5f), C3f(1.0f / pi_f), C3f(0.5f)));
  const Solution solution = solve(scene, 4000);
  IndirectFieldOptions options;
  options.least_rays = options.most_rays = 1024;
  options.direct_tolerance = 0.0;
  const IndirectField field(scene, solution, options);
  const struct {
    V3f direction;
    double irradiance;
  } cases[] = {{V3f(0, 0, -1), 0.39521 - 0.23945647046077354},
               {V3f(1, 0, 0), 0.35530 - 0.19013588238480662},
               {V3f(0, 0, 1), 0.18361}};
  for (const auto& [direction, irradiance] : cases) {
    const auto value = field.at(point_below(scene, V3f(0.503f, 0.499f, 0.501f), direction));
    ASSERT_GE(value.known, Known::indirect);
    const bool is_dark = value.known == Known::all;  // the ceiling, which no lamp shines on
    EXPECT_EQ(is_dark, direction.z > 0.0f);
    EXPECT_NEAR(value.irradiance.x, irradiance, 0.02 * irradiance);
  }
}

// A floor under a coat, above which a ceiling is lit from below: it sees the light steeply, and the coat lets
// more of that through than of light from all around (R50).
TEST(IndirectField, CountsWhatACoatLetsThrough) {
  struct Found {
    float field, plain, weighted;  // what the field finds, and gathering, without and with the coat's response
  };
  const auto find = [](const Bsdf& floor) {
    SceneDescription description;
    const V3f x(1, 0, 0), y(0, 1, 0);
    test::add_diffuse(description, "floor", test::quad(V3f(0.0f), x, y), C3f(0.5f));
    description.materials.back() = one_sided("floor", floor);
    test::add_diffuse(description, "ceiling", test::quad(V3f(0, 0, 1.5f), y, x), C3f(0.8f));
    test::add_diffuse(description, "lamp", test::quad(V3f(0.05f, 0.05f, 0.1f), x * 0.1f, y * 0.1f), C3f(0.0f),
                      C3f(1.0f));
    const Scene scene(std::move(description));
    RadiosityOptions radiosity;
    radiosity.max_elements = 500;
    radiosity.subdivision = Subdivision::uniform;
    const Solution solution = solve_radiosity(scene, radiosity);
    const SurfacePoint point = point_below(scene, V3f(0.6f, 0.6f, 0.5f), V3f(0, 0, -1));
    IndirectFieldOptions options;
    options.wanted.assign(solution.mesh().count(), false);
    options.wanted[solution.mesh().find(point)] = true;
    options.least_rays = options.most_rays = 1u << 18;
    options.with_direct = false;
    const IndirectField field(scene, solution, options);
    const DiffuseResponse response(scene.side(point));
    Found found{field.indirect_at_any(point).x, 0.0f, 0.0f};
    for (std::uint32_t key = 0; key < 64; ++key) {
      found.plain += gathered(scene, solution, point, point.geometric_normal, key).x / 64.0f;
      found.weighted += gathered(scene, solution, point, point.geometric_normal, key, &response).x / 64.0f;
    }
    return found;
  };
  RoughPlastic coat;
  coat.alpha = 0.2f;
  coat.prepare();
  const Found bare = find(Diffuse{C3f(0.5f)}), coated = find(coat);
  // One ray in ten meets the ceiling: half a percent of noise in each.
  EXPECT_NEAR(bare.field, bare.weighted, 0.02f * bare.weighted);
  EXPECT_EQ(bare.weighted, bare.plain);
  EXPECT_GT(coated.weighted, 1.04f * coated.plain);
  EXPECT_NEAR(coated.field, coated.weighted, 0.02f * coated.weighted);
}

// As many rays in all, more of them where more of a picture depends on them (R55).
TEST(IndirectField, HasLessNoiseWhereMoreOfAPictureLooks) {
  const Scene scene(test::furnished_room());
  const Solution solution = solve(scene, 2000);
  const ElementMesh& mesh = solution.mesh();
  const auto is_floor = [&](std::uint32_t element) { return mesh.patch(element).normal.z > 0.9; };
  const auto field = [&](double elsewhere, std::uint32_t seed) {
    IndirectFieldOptions options{.noise = 0.0, .with_direct = false, .seed = seed};
    for (std::uint32_t i = 0; i < mesh.count(); ++i) options.parts.push_back(is_floor(i) ? 1.0 : elsewhere);
    return IndirectField(scene, solution, options);
  };
  const auto scatter = [&](double elsewhere) {
    const IndirectField a = field(elsewhere, 1), b = field(elsewhere, 2);
    double squares = 0.0;
    for (std::uint32_t k = 0; k < 2000; ++k) {
      Sampler sampler(3, k, 0);
      const SurfacePoint point = any_point(scene, sampler);
      const std::uint32_t element = mesh.find(point);
      if (element == no_index || mesh.is_cluster(element) || !is_floor(element)) continue;
      const float x = a.indirect_at_any(point).x, y = b.indirect_at_any(point).x;
      if (x + y > 0.0f) squares += std::pow(static_cast<double>((x - y) / (x + y)), 2.0);
    }
    return squares;
  };
  EXPECT_LT(scatter(0.01), 0.7 * scatter(1.0));
  EXPECT_LT(field(0.01, 1).rays(), 1.05 * static_cast<double>(field(1.0, 1).rays()));
}

// A small bright patch is seen by few rays: with as many as a picture is worth, fields of different seeds
// differ less.
TEST(IndirectField, HasLessNoiseWhereMoreRaysAreWorthIt) {
  SceneDescription description = test::unit_room(C3f(0.5f), C3f(0.0f), C3f(0.5f));
  test::add_diffuse(description, "lamp", test::quad(V3f(0.4f, 0.4f, 0.97f), V3f(0.2f, 0, 0), V3f(0, 0.2f, 0)),
                    C3f(0.0f), C3f(10.0f));
  const Scene scene(std::move(description));
  const Solution solution = solve(scene, 2000);
  const auto field = [&](double rays, std::uint32_t seed) {
    return IndirectField(scene, solution, {.direct_tolerance = 0.0, .affordable_rays = rays, .seed = seed});
  };
  const auto scatter = [&](double rays) {
    const IndirectField a = field(rays, 1), b = field(rays, 2);
    double squares = 0.0;
    for (int k = 0; k < 100; ++k) {
      const V3f direction(0.1f * static_cast<float>(k % 10) - 0.45f, 0.1f * static_cast<float>(k / 10) - 0.45f,
                          -1.0f);
      const SurfacePoint point = point_below(scene, V3f(0.5f), direction);
      const float x = mean_component(a.indirect_at_any(point)), y = mean_component(b.indirect_at_any(point));
      if (x + y > 0.0f) squares += std::pow(static_cast<double>((x - y) / (x + y)), 2.0);
    }
    return squares;
  };
  const auto usual = static_cast<double>(field(0.0, 1).rays()),
             more = static_cast<double>(field(1e8, 1).rays());
  EXPECT_GT(more, 2.0 * usual);
  EXPECT_EQ(static_cast<double>(field(0.5 * usual, 1).rays()), usual);  // not fewer than usual
  EXPECT_LT(scatter(1e8), 0.5 * scatter(0.0));
}

// Nothing may be spent on dividing cells, or as much as it takes: then more is trusted, and as well (R53).
class IndirectFieldTest : public testing::TestWithParam<bool> {
 protected:
  static IndirectFieldOptions options(const Solution& solution) {
    IndirectFieldOptions options{.direct_tolerance = 0.0};
    if (GetParam()) {
      options.parts.assign(solution.mesh().count(), 1.0);
      options.dividing_rays = 1e9;
    }
    return options;
  }
};
INSTANTIATE_TEST_SUITE_P(, IndirectFieldTest, testing::Bool(),
                         [](const auto& info) { return info.param ? "Divided" : "Whole"; });

TEST_P(IndirectFieldTest, IsTrustedOnlyWhereItIsAsGoodAsGathering) {
  const Scene scene(divided_room());
  const Solution solution = solve(scene, 3000);
  const IndirectField field(scene, solution, options(solution));
  EXPECT_GT(field.share(Known::indirect), GetParam() ? 0.85 : 0.4);
  double squares = 0.0, worst = 0.0;
  int trusted = 0;
  for (std::uint32_t i = 0; i < 400; ++i) {
    Sampler sampler(3, i, 0);
    const SurfacePoint point = any_point(scene, sampler);
    const auto value = field.at(point);
    if (value.known < Known::indirect) continue;
    ++trusted;
    const C3f truth = gathered(scene, solution, point, point.geometric_normal, i);
    const double error = std::abs(static_cast<double>(value.irradiance.x - truth.x)) /
                         static_cast<double>(truth.x + solution.irradiance(point).direct.x);
    squares += error * error;
    worst = std::max(worst, error);
  }
  ASSERT_GT(trusted, 150);
  EXPECT_LT(std::sqrt(squares / trusted), 0.025);
  EXPECT_LT(worst, 0.12);
}

// Tilted by fourteen degrees (R54).
TEST_P(IndirectFieldTest, KnowsWhatArrivesAroundATiltedNormal) {
  const Scene scene(divided_room());
  const Solution solution = solve(scene, 3000);
  const IndirectField field(scene, solution, options(solution));
  double squares = 0.0, untilted = 0.0;
  int trusted = 0;
  for (std::uint32_t i = 0; i < 200; ++i) {
    Sampler sampler(4, i, 0);
    const SurfacePoint point = any_point(scene, sampler);
    const ElementMesh::Location location = solution.mesh().locate(point);
    const auto value = field.at(location);
    if (value.known < Known::indirect) continue;
    ++trusted;
    const float angle = 2.0f * pi_f * sampler.next_1d();
    const V3f& n = point.geometric_normal;
    const V3f tilted = unit(n + (Frame(n).s * std::cos(angle) + Frame(n).t * std::sin(angle)) * 0.25f);
    const double truth = gathered(scene, solution, point, tilted, i).x,
                 scale = truth + static_cast<double>(solution.irradiance(point).direct.x);
    const double found = field.tilted(value.irradiance, location, n, tilted).x;
    squares += (found - truth) * (found - truth) / (scale * scale);
    const double flat = value.irradiance.x;
    untilted += (flat - truth) * (flat - truth) / (scale * scale);
  }
  ASSERT_GT(trusted, 75);
  EXPECT_LT(std::sqrt(squares / trusted), 0.025);
  EXPECT_LT(squares, 0.4 * untilted);
}

// Direct light on top of it, exactly what a lamp sends, and only where every ray to the lamp arrives.
TEST(IndirectField, HasTheDirectLightWhereTheLampIsInFullView) {
  const Scene scene(divided_room());
  const Solution solution = solve(scene, 3000);
  const IndirectField field(scene, solution), indirect(scene, solution, {.direct_tolerance = 0.0});
  EXPECT_GT(field.share(Known::all), 0.15);
  EXPECT_LT(field.share(Known::all), field.share(Known::indirect));
  EXPECT_EQ(field.share(Known::indirect), indirect.share(Known::indirect));
  int lit = 0, dark = 0;
  for (std::uint32_t i = 0; i < 600; ++i) {
    Sampler sampler(11, i, 0);
    const V3f from(0.05f + 0.6f * sampler.next_1d(), 0.05f + 0.4f * sampler.next_1d(),
                   0.2f + 0.6f * sampler.next_1d());
    const SurfacePoint point = point_below(scene, from, square_to_sphere(sampler.next_2d()));
    const auto found = field.at(point);
    const bool is_dark = found.known == Known::no_direct;
    if (!is_dark && found.known != Known::all) continue;
    int visible = 0, asked = 0;
    for (int k = 0; k < 64; ++k) {
      const LightSample light =
          scene.lights().sample({point.position, point.shading.n, true}, sampler.next_2d());
      if (!(light.pdf_w > 0.0f) || !(light.direction.dot(point.geometric_normal) > 0.0f)) continue;
      ++asked;
      if (!scene.caster().occluded(spawn_position(point, light.direction), light.position)) ++visible;
    }
    EXPECT_TRUE(visible == 0 || visible == asked);
    if (is_dark) {
      EXPECT_EQ(visible, 0);
      continue;
    }
    const V3d corner(V3f(0.35f, 0.35f, 0.999f)), side(V3f(0.3f, 0, 0)), other(V3f(0, 0.3f, 0));
    const Polygon lamp = make_polygon(corner, corner + other, corner + side + other, corner + side);
    const double exact =
        visible > 0 ? 10.0 * pi * point_form_factor(V3d(point.position), V3d(point.geometric_normal), lamp)
                    : 0.0;
    const double others = indirect.at(point).irradiance.x;
    EXPECT_NEAR(found.irradiance.x - others, exact, 0.01 * (exact + others));
    ++(visible > 0 ? lit : dark);
  }
  EXPECT_GT(lit, 50);
  EXPECT_GT(dark, 20);
}

TEST(IndirectField, IsNotTrustedAtTheFootOfAWall) {
  const Scene scene(divided_room());
  const Solution solution = solve(scene, 3000);
  const IndirectField field(scene, solution);
  const IndirectField blind(scene, solution, {.tolerance = 1e9});
  const SurfacePoint corner = point_below(scene, V3f(0.46f, 0.6f, 0.05f), V3f(-0.2f, 0, -1));
  EXPECT_LT(field.at(corner).known, Known::indirect);
  EXPECT_LT(field.share(Known::indirect), 0.99);
  EXPECT_GE(blind.share(Known::indirect), field.share(Known::indirect));
}

TEST(IndirectField, LeavesCausticsAndSpheresToRays) {
  SceneDescription description = divided_room();
  description.materials.push_back(one_sided("mirror", Conductor{}));
  Shape mirror;
  mirror.name = "mirror";
  mirror.geometry = test::quad(V3f(0.3f, 0.02f, 0.3f), V3f(0, 0, 0.5f), V3f(0.4f, 0, 0));
  mirror.material = static_cast<std::uint32_t>(description.materials.size() - 1);
  description.shapes.push_back(mirror);
  test::add_diffuse(description, "ball", Sphere{V3f(0.6f, 0.8f, 0.1f), 0.1f}, C3f(0.5f));
  const Scene without(divided_room()), scene(std::move(description));
  const Solution plain = solve(without, 2000), mirrored = solve(scene, 2000);
  EXPECT_LT(IndirectField(scene, mirrored).share(Known::indirect),
            IndirectField(without, plain).share(Known::indirect));
  const IndirectField field(scene, mirrored, {.tolerance = 1e9});
  const SurfacePoint top = point_below(scene, V3f(0.6f, 0.8f, 0.5f), V3f(0, 0, -1));
  ASSERT_TRUE(std::holds_alternative<Sphere>(scene.shapes()[top.shape].geometry));
  EXPECT_LT(field.at(top).known, Known::indirect);
}

TEST(IndirectField, IsTheSameOnAnyNumberOfThreads) {
  const Scene scene(divided_room());
  const Solution solution = solve(scene, 1000);
  const auto values = [&](int threads) {
    const ThreadLimit limit(threads);
    const IndirectField field(scene, solution);
    std::vector<std::pair<Known, C3f>> all;
    for (std::uint32_t i = 0; i < 200; ++i) {
      const auto found =
          field.at(point_below(scene, V3f(0.1f, 0.3f, 0.6f), square_to_sphere(Sampler(5, i, 0).next_2d())));
      all.emplace_back(found.known, found.irradiance);
    }
    return all;
  };
  EXPECT_EQ(values(1), values(2));
}

}  // namespace
}  // namespace twopass
