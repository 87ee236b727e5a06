#include "radiosity/hierarchical.h"

#include <random>

#include <gtest/gtest.h>

#include "radiosity/analytic_exchange.h"
#include "radiosity/solution.h"
#include "radiosity/subdivision.h"
#include "render/core/error.h"
#include "render/core/parallel.h"
#include "tests/radiosity/test_scenes.h"
#include "tests/support/crowded_room.h"

namespace twopass {
namespace {

SceneDescription room_with_ball() {
  SceneDescription scene = test::lit_room();
  test::add_diffuse(scene, "ball", Sphere{V3f(0.3f, 0.25f, 0.3f), 0.2f, false}, C3f(0.6f, 0.2f, 0.1f));
  return scene;
}

SceneDescription room_with_mirror() {
  SceneDescription scene = test::lit_room();
  scene.materials[2] = one_sided("mirror", Conductor{});
  return scene;
}

// Random triangles in a room.
SceneDescription crowded_room(int triangles) {
  SceneDescription scene = test::lit_room();
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(-0.5f, 0.5f);
  const auto vector = [&] { return V3f(uniform(random), uniform(random), uniform(random)); };
  Mesh mesh;
  for (int i = 0; i < triangles; ++i) {
    const V3f p = V3f(0.5f) + vector() * 0.8f;
    const float size = 0.6f / std::sqrt(static_cast<float>(triangles));
    const auto base = static_cast<std::uint32_t>(mesh.positions.size());
    for (const V3f& corner : {p, p + vector() * size, p + vector() * size}) mesh.positions.push_back(corner);
    mesh.triangles.emplace_back(base, base + 1, base + 2);
  }
  test::add_diffuse(scene, "crowd", mesh, C3f(0.6f));
  return scene;
}

struct Linked {
  Scene scene;
  ElementMesh mesh;
  std::vector<C3f> reflectance;
  ElementTree tree;
  std::vector<Link> links;

  static std::vector<C3f> reflectances(const ElementMesh& mesh) {
    std::vector<C3f> result;
    for (std::uint32_t i = 0; i < mesh.count(); ++i) result.push_back(mesh.reflectance(i));
    return result;
  }
  // Links under an even light.
  Linked(SceneDescription description, std::size_t elements, double epsilon)
      : scene(std::move(description)),
        mesh(divide_surfaces(scene, elements)),
        reflectance(reflectances(mesh)),
        tree(mesh, reflectance) {
    const float radiosity = static_cast<float>(1.0 / tree.node(0).area);
    const std::vector<NodeLight> light(tree.nodes().size(), {C3f(radiosity), C3f(0.1f * radiosity)});
    std::uint64_t rays = 0;
    LinkRefiner(tree, scene.caster(), 0).refine(links, light, epsilon, std::size_t{1} << 40, rays);
  }
  // How many links serve each pair of elements, by row and column.
  [[nodiscard]] Eigen::MatrixXi coverage() const {
    const auto n = static_cast<Eigen::Index>(mesh.count());
    Eigen::MatrixXi count = Eigen::MatrixXi::Zero(n, n);
    for (const Link& link : links)
      for (std::uint32_t a = tree.node(link.p).begin; a < tree.node(link.p).end; ++a)
        for (std::uint32_t b = tree.node(link.q).begin; b < tree.node(link.q).end; ++b) {
          ++count(tree.order()[a], tree.order()[b]);
          if (link.p != link.q) ++count(tree.order()[b], tree.order()[a]);
        }
    return count;
  }
};

TEST(Links, EveryPairThatExchangesLightIsServedOnce) {
  for (const double epsilon : {1e-3, 1e-5}) {
    const Linked linked(room_with_ball(), 300, epsilon);
    std::uint64_t rays = 0;
    const ExchangeMatrix exact =
        analytic_exchange(linked.mesh, linked.scene.caster(), FormFactorMethod::exact, 0, rays);
    const Eigen::MatrixXi count = linked.coverage();
    EXPECT_LE(count.maxCoeff(), 1);
    EXPECT_EQ(count, count.transpose());
    for (std::uint32_t i = 0; i < linked.mesh.count(); ++i)
      for (ExchangeMatrix::InnerIterator it(exact, i); it; ++it)
        if (it.value() > 1e-12f) {
          EXPECT_EQ(count(i, it.col()), 1) << i << " " << it.col();
        }
    for (const Link& link : linked.links) {
      EXPECT_GE(link.exchange, 0.0f);
      EXPECT_LE(link.exchange,
                1.001 * std::min(linked.tree.node(link.p).whole_area, linked.tree.node(link.q).whole_area));
    }
  }
}

TEST(Links, WithoutAllowanceTheyAreTheMethodExactBitForBit) {
  const Linked linked(room_with_ball(), 300, 0.0);
  std::uint64_t rays = 0;
  const ExchangeMatrix exact =
      analytic_exchange(linked.mesh, linked.scene.caster(), FormFactorMethod::exact, 0, rays);
  std::size_t seen = 0;
  for (const Link& link : linked.links) {
    if (!(link.exchange > 0.0f)) continue;
    ASSERT_EQ(linked.tree.node(link.p).kind, TreeNode::element);
    const std::uint32_t i = linked.tree.element_of(linked.tree.node(link.p)),
                        j = linked.tree.element_of(linked.tree.node(link.q));
    EXPECT_EQ(link.exchange, exact.coeff(i, j));
    seen += i == j ? 1 : 2;
  }
  EXPECT_EQ(seen, static_cast<std::size_t>(exact.nonZeros()));
}

TEST(Links, FewerErrorsNeedMoreLinks) {
  std::size_t before = 0;
  for (const double epsilon : {1e-3, 1e-4, 1e-5, 1e-6}) {
    const Linked linked(test::lit_room(), 500, epsilon);
    EXPECT_GT(linked.links.size(), before);
    before = linked.links.size();
  }
}

TEST(Links, RefiningInStepsKeepsTheirErrorsBelowEpsilon) {
  Linked linked(test::lit_room(), 500, 1e-4);
  std::vector<NodeLight> light(linked.tree.nodes().size());
  for (std::size_t i = 0; i < light.size(); ++i)
    light[i] = {C3f(i % 3 == 0 ? 0.5f : 0.1f), C3f(i % 2 == 0 ? 0.1f : 0.0f)};
  std::uint64_t rays = 0;
  const LinkRefiner refiner(linked.tree, linked.scene.caster(), 0);
  EXPECT_TRUE(refiner.refine(linked.links, light, 1e-5, std::size_t{1} << 40, rays));
  for (const Link& link : linked.links) EXPECT_LE(refiner.error(link, light).power, 1e-5);
  EXPECT_FALSE(refiner.refine(linked.links, light, 1e-5, std::size_t{1} << 40, rays));
}

// (R33): symmetric, and the sum that it claims to be.
TEST(LinkedExchange, IsTheSymmetricMatrixOfItsLinks) {
  const Linked linked(room_with_ball(), 400, 1e-5);
  LinkedExchange exchange(linked.tree, linked.links);
  const std::size_t n = linked.mesh.count();
  const std::vector<double> fixed(n, 0.0);
  std::vector<double> target, u, v;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (std::uint32_t i = 0; i < n; ++i) {
    target.push_back(linked.mesh.area(i));
    u.push_back(uniform(random));
    v.push_back(uniform(random));
  }
  std::vector<double> expected(n, 0.0);
  for (const Link& link : linked.links) {
    const TreeNode &p = linked.tree.node(link.p), &q = linked.tree.node(link.q);
    for (std::uint32_t a = p.begin; a < p.end; ++a)
      for (std::uint32_t b = q.begin; b < q.end; ++b) {
        const std::uint32_t i = linked.tree.order()[a], j = linked.tree.order()[b];
        expected[i] += link.exchange * v[j] * linked.mesh.area(j) / (p.area * q.area);
        if (link.p != link.q) expected[j] += link.exchange * v[i] * linked.mesh.area(i) / (p.area * q.area);
      }
  }
  const std::vector<double> got = exchange.gather(std::span<const double>(v));
  for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(got[i], expected[i], 1e-12);
  exchange.scale_to_row_sums(fixed, target, 1e-7);
  const std::vector<double> fu = exchange.gather(std::span<const double>(u)),
                            fv = exchange.gather(std::span<const double>(v));
  double u_fv = 0.0, v_fu = 0.0;
  for (std::uint32_t i = 0; i < n; ++i) {
    u_fv += linked.mesh.area(i) * u[i] * fv[i];
    v_fu += linked.mesh.area(i) * v[i] * fu[i];
  }
  EXPECT_NEAR(u_fv / v_fu, 1.0, 1e-12);
}

RadiosityOptions hierarchical(std::size_t elements, double error) {
  RadiosityOptions options;
  options.solver = Solver::hierarchical;
  options.max_elements = elements;
  options.relative_error = error;
  options.rays_per_element = 64;
  return options;
}

RadiosityOptions exact(std::size_t elements) {
  RadiosityOptions options = hierarchical(elements, 1e-6);
  options.solver = Solver::lu;
  options.form_factors = FormFactorMethod::exact;
  return options;
}

// Sum A |B - B'| / Sum A B' of the worst channel.
double difference(const Solution& a, const Solution& b) {
  double worst = 0.0;
  for (int c = 0; c < 3; ++c) {
    double sum = 0.0, all = 0.0;
    for (std::uint32_t i = 0; i < a.mesh().count(); ++i) {
      const double weight = a.mesh().area(i) * a.mesh().reflectance(i)[c];
      sum += weight * std::abs(a.irradiances()[i].total()[c] - b.irradiances()[i].total()[c]);
      all += weight * b.irradiances()[i].total()[c];
    }
    if (all > 0.0) worst = std::max(worst, sum / all);
  }
  return worst;
}

// Where no sums of factors are known, the method `exact` cuts off every row that its 4 rays a pair and the
// survey's statistics have made too long; links do so only as far as convergence asks. There both agree less,
// and links are compared with their own limit.
TEST(Hierarchical, ApproachesTheExactSolutionWithinItsBound) {
  const std::vector<std::pair<std::string, SceneDescription>> scenes{
      {"room", test::lit_room()},          {"bright room", test::lit_room(0.95f)},
      {"cube", test::lit_cube(0.5f)},      {"plates", test::plates(0.1f, 0.5f)},
      {"ball", room_with_ball()},          {"spheres", test::concentric_spheres(0.5f)},
      {"mirror room", room_with_mirror()}, {"crowd", crowded_room(150)}};
  for (const auto& [name, description] : scenes) {
    const Scene scene(description);
    const bool sums_are_known = name != "mirror room" && name != "crowd";
    const Solution truth = solve_radiosity(scene, exact(300));
    const Solution limit = solve_radiosity(scene, hierarchical(300, 1e-4));
    EXPECT_LT(difference(limit, truth), sums_are_known ? 1e-4 : 0.03) << name;
    double before = 1.0;
    std::size_t links = 0;
    for (const double error : {0.1, 0.03, 0.01}) {
      const Solution solution = solve_radiosity(scene, hierarchical(300, error));
      const double off = difference(solution, sums_are_known ? truth : limit);
      EXPECT_LE(solution.stats().error_bound, error) << name;
      EXPECT_LE(off, solution.stats().error_bound) << name << " " << error;
      EXPECT_LE(off, before) << name << " " << error;
      EXPECT_GE(solution.stats().links, links);
      for (const Irradiance& irradiance : solution.irradiances())
        for (int c = 0; c < 3; ++c) EXPECT_GE(irradiance.indirect[c], 0.0f) << name;
      before = off;
      links = solution.stats().links;
    }
  }
}

// Converged values for the unit cube (albedo 0.5, ceiling of exitance 1) and for plates at distance 1.
TEST(Hierarchical, SolvesCubeAndPlates) {
  const Scene cube(test::lit_cube(0.5f)), plates(test::plates(1.0f, 0.5f));
  const auto mean = [](const Solution& solution, std::uint32_t shape) {
    double power = 0.0, area = 0.0;
    for (std::uint32_t i = 0; i < solution.mesh().count(); ++i) {
      if (solution.mesh().root(i).shape != shape) continue;
      area += solution.mesh().area(i);
      power += 0.5 * solution.mesh().area(i) * solution.irradiances()[i].total().x;
    }
    return power / area;
  };
  const Solution in_cube = solve_radiosity(cube, hierarchical(900, 0.01));
  EXPECT_NEAR(mean(in_cube, 0) / 0.171216, 1.0, 0.006);  // floor
  EXPECT_NEAR(mean(in_cube, 2) / 0.181105, 1.0, 0.006);  // a wall
  const Solution between = solve_radiosity(plates, hierarchical(400, 0.003));
  EXPECT_NEAR(mean(between, 1) / 0.1009472, 1.0, 0.006);
}

// Enforcement (R14) over links: Sum A B = Sum A E / (1 - rho), however coarse they are.
TEST(Hierarchical, ConservesEnergyInClosedRooms) {
  const Scene scene(test::lit_cube(0.8f));
  const Solution solution = solve_radiosity(scene, hierarchical(500, 0.1));
  EXPECT_TRUE(solution.stats().closed);
  double power = 1.0;
  for (std::uint32_t i = 0; i < solution.mesh().count(); ++i)
    power += 0.8 * solution.mesh().area(i) * solution.irradiances()[i].total().x;
  EXPECT_NEAR(power * 0.2, 1.0, 0.01 * 0.1 + 1e-4);  // the iteration's share of the error, at most
}

// Radiance is 1 everywhere: constant fields are exact.
TEST(Hierarchical, FurnaceIsConstant) {
  const Scene scene(test::furnace_room(C3f(0.3f, 0.6f, 0.9f), 1.0f));
  const Solution solution = solve_radiosity(scene, hierarchical(600, 0.01));
  for (const Irradiance& irradiance : solution.irradiances())
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(irradiance.total()[c] / pi_f, 1.0f, 2e-3f);
}

TEST(Hierarchical, CutsOffAfterTheReflectionsAskedFor) {
  const Scene scene(test::lit_room());
  RadiosityOptions reference = exact(300), options = hierarchical(300, 0.003);
  reference.max_reflections = options.max_reflections = 1;
  const Solution one = solve_radiosity(scene, options);
  EXPECT_LT(difference(one, solve_radiosity(scene, reference)), 0.003);
  options.max_reflections = -1;
  EXPECT_GT(difference(one, solve_radiosity(scene, options)), 0.1);
}

TEST(Hierarchical, IsTheSameBitForBitOnAnyNumberOfThreads) {
  const Scene scene(room_with_mirror());
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return solve_radiosity(scene, hierarchical(400, 0.05));
  };
  const Solution one = run(1), two = run(2);
  EXPECT_EQ(one.stats().links, two.stats().links);
  for (std::size_t i = 0; i < one.irradiances().size(); ++i)
    EXPECT_EQ(one.irradiances()[i].indirect, two.irradiances()[i].indirect);
}

// The slope of log(links) over log(elements), least squares.
double exponent(const std::vector<double>& elements, const std::vector<double>& links) {
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  const auto n = static_cast<double>(elements.size());
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const double u = std::log(elements[i]), v = std::log(links[i]);
    x += u, y += v, xx += u * u, xy += u * v;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

TEST(Hierarchical, LinksGrowNoFasterThanElements) {
  const Scene scene(test::lit_room());
  std::vector<double> elements, links;
  for (const std::size_t wanted : {1000, 4000, 16000}) {
    RadiosityOptions options = hierarchical(wanted, 0.2);
    options.rays_per_element = 16;
    const RadiosityStats stats = solve_radiosity(scene, options).stats();
    elements.push_back(static_cast<double>(stats.elements));
    links.push_back(static_cast<double>(stats.links));
  }
  EXPECT_LT(exponent(elements, links), 1.15);
}

TEST(Hierarchical, LinksOfManySmallTrianglesGrowNoFasterThanTheTriangles) {
  std::vector<double> elements, links;
  for (const int triangles : {1000, 6000}) {
    const Scene scene(crowded_room(triangles));
    // Enough for one element each: no clusters.
    RadiosityOptions options = hierarchical(static_cast<std::size_t>(3 * triangles), 0.3);
    options.rays_per_element = 16;
    const RadiosityStats stats = solve_radiosity(scene, options).stats();
    elements.push_back(static_cast<double>(stats.elements));
    links.push_back(static_cast<double>(stats.links));
  }
  EXPECT_LT(exponent(elements, links), 1.15);
}

TEST(Hierarchical, SmallAndDarkScenesAreNoTrouble) {
  SceneDescription lone;
  Mesh tile;
  tile.positions = {V3f(0.0f), V3f(1, 0, 0), V3f(0, 1, 0)};
  tile.triangles = {V3u(0, 1, 2)};
  test::add_diffuse(lone, "tile", tile, C3f(0.5f), C3f(1.0f));
  const Scene one(lone);
  const Solution single = solve_radiosity(one, hierarchical(1, 0.01));
  ASSERT_EQ(single.irradiances().size(), 1u);
  EXPECT_EQ(single.irradiances()[0].total(), C3f(0.0f));
  EXPECT_EQ(single.stats().error_bound, 0.0);

  SceneDescription unlit = test::lit_cube(0.5f);
  unlit.shapes[1].radiance[front] = C3f(0.0f);
  const Solution night = solve_radiosity(Scene(unlit), hierarchical(100, 0.01));
  for (const Irradiance& irradiance : night.irradiances()) EXPECT_EQ(irradiance.total(), C3f(0.0f));

  // Degenerate triangles, and light that no element receives.
  Mesh flat;
  flat.positions = {V3f(0.0f), V3f(1.0f), V3f(2.0f)};
  flat.triangles = {{0, 1, 2}};
  test::add_diffuse(lone, "flat", flat, C3f(0.5f), C3f(1.0f));
  const Scene degenerate(lone);
  const Solution nothing = solve_radiosity(degenerate, hierarchical(50, 0.01));
  for (const Irradiance& irradiance : nothing.irradiances()) EXPECT_EQ(irradiance.total(), C3f(0.0f));
}

TEST(Hierarchical, SaysWhatItDid) {
  const Scene scene(test::lit_room());
  const RadiosityStats stats = solve_radiosity(scene, hierarchical(500, 0.03)).stats();
  EXPECT_EQ(stats.solver, "hierarchical");
  EXPECT_EQ(stats.form_factors, "exact");
  EXPECT_GT(stats.links, 1000u);
  EXPECT_GT(stats.memory_bytes, stats.links * LinkedExchange::bytes_per_link / 2);
  EXPECT_LE(stats.residual, stats.error_bound);
  EXPECT_LE(stats.error_bound, 0.03);
}

TEST(Hierarchical, RefusesOtherFormFactorsThanItsOwn) {
  const Scene scene(test::lit_cube(0.5f));
  RadiosityOptions options = hierarchical(50, 0.1);
  for (const FormFactorMethod method : {FormFactorMethod::rays, FormFactorMethod::point}) {
    options.form_factors = method;
    EXPECT_THROW(solve_radiosity(scene, options), Error);
  }
  options.form_factors = FormFactorMethod::exact;
  EXPECT_NO_THROW(solve_radiosity(scene, options));
}

// On the same elements, clusters and quad-trees among them, as by rays, within what it states.
TEST(Hierarchical, SolvesClustersAndSplitElements) {
  const Scene scene(test::crowded_room(3000));
  const auto power = [](const Solution& solution) {
    double sum = 0.0;
    for (std::uint32_t i = 0; i < solution.mesh().count(); ++i)
      sum += solution.mesh().area(i) *
             static_cast<double>((solution.mesh().reflectance(i) * solution.irradiances()[i].indirect).y);
    return sum;
  };
  for (const Subdivision subdivision : {Subdivision::uniform, Subdivision::adaptive}) {
    RadiosityOptions options;
    options.max_elements = 2000;
    options.rays_per_element = 64;
    options.subdivision = subdivision;
    options.relative_error = 0.1;
    const Solution by_rays = solve_radiosity(scene, options);
    options.solver = Solver::hierarchical;
    const Solution linked = solve_radiosity(scene, options);
    ASSERT_EQ(linked.mesh().count(), by_rays.mesh().count());
    std::size_t clusters = 0;
    for (std::uint32_t i = 0; i < linked.mesh().count(); ++i) clusters += linked.mesh().is_cluster(i);
    EXPECT_GT(clusters, 100u);
    EXPECT_NEAR(power(linked) / power(by_rays), 1.0, linked.stats().error_bound + 0.01);
    EXPECT_LT(linked.stats().error_bound, 0.25);
  }
}

}  // namespace
}  // namespace twopass
