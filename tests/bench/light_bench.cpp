// What sampling a light costs and how noisy it is: techniques of one polygon, then choosing among many lights.
// Prints two tables. One thread, CPU time, interleaved repetitions.
#include <cstdio>
#include <ctime>
#include <string>

#include "render/core/sampler.h"
#include "render/core/warp.h"
#include "render/scene/lights.h"
#include "render/scene/polygon_view.h"
#include "tests/support/scenes.h"
#include "tests/support/statistics.h"

namespace twopass {
namespace {

// What a vertex of a path costs besides, in ns: a shadow ray, a scattered ray and shading, as `ray_rate_bench`
// has it.
constexpr double other_ns = 400.0;

double cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Result {
  double ns, noise;  // a sample; standard deviation over mean
};

// The least of a few repetitions is the time; all of them have the same numbers.
template <class Draw>
Result measure(const Draw& draw) {
  constexpr std::uint32_t samples = 20000;
  Result result{1e30, 0.0};
  for (int repetition = 0; repetition < 5; ++repetition) {
    test::Estimate e;
    const double begin = cpu_seconds();
    for (std::uint32_t i = 0; i < samples; ++i) e.add(draw(Sampler(3, i, 0).next_2d()));
    result.ns = std::min(result.ns, (cpu_seconds() - begin) / samples * 1e9);
    result.noise = std::sqrt(e.variance()) / e.mean();
  }
  return result;
}

struct Configuration {
  const char* name;
  Mesh mesh;
  Receiver receiver;
};

std::vector<Configuration> configurations(bool is_diffuse) {
  const V3f o(0.0f), up(0, 0, 1), sideways(1, 0, 0);
  const auto square = [](const V3f& p, float size) { return test::quad(p, V3f(0, size, 0), V3f(size, 0, 0)); };
  std::vector<Configuration> list;
  for (const float distance : {0.05f, 0.2f, 0.5f, 1.0f, 2.0f, 4.0f, 16.0f, 1e4f})
    list.push_back({distance < 0.1f   ? "above, d = 0.05"
                    : distance < 0.3f ? "above, d = 0.2"
                    : distance < 0.7f ? "above, d = 0.5"
                    : distance < 1.5f ? "above, d = 1"
                    : distance < 3.0f ? "above, d = 2"
                    : distance < 5.0f ? "above, d = 4"
                    : distance < 20.f ? "above, d = 16"
                                      : "above, d = 1e4",
                    square(V3f(-0.6f, -0.3f, distance), 1.0f),
                    {o, up, is_diffuse}});
  list.push_back({"aside, 1 off", square(V3f(1, 0, 1), 1.0f), {o, up, is_diffuse}});
  list.push_back({"aside, 3 off", square(V3f(3, 0, 1), 1.0f), {o, up, is_diffuse}});
  list.push_back({"grazing its plane", square(V3f(1, 0, 0.05f), 1.0f), {o, up, is_diffuse}});
  list.push_back({"wall below ceiling", square(V3f(0.5f, 0, 0.3f), 1.0f), {o, sideways, is_diffuse}});
  list.push_back({"half below horizon", square(V3f(-0.5f, 0, 1), 1.0f), {o, sideways, is_diffuse}});
  list.push_back(
      {"strip 10 x 0.1", test::quad(V3f(-5, 0, 1), V3f(0, 0.1f, 0), V3f(10, 0, 0)), {o, up, is_diffuse}});
  Mesh triangle = square(V3f(-0.6f, -0.3f, 1), 1.0f);
  triangle.triangles.resize(1);
  list.push_back({"triangle, d = 1", triangle, {o, up, is_diffuse}});
  return list;
}

void polygon_table(bool is_diffuse) {
  std::printf("%s receiver; noise = standard deviation / mean; cost = variance x (time + %.0f ns), ns\n",
              is_diffuse ? "diffuse" : "other", other_ns);
  std::printf("| unit square | technique | ns | noise | cost | default |\n|---|---|---|---|---|---|\n");
  for (const Configuration& c : configurations(is_diffuse)) {
    const LightPolygon polygon = light_polygons(c.mesh).at(0);
    const PolygonTechnique chosen = choose_technique(polygon, c.receiver);
    for (const PolygonTechnique technique : {PolygonTechnique::area, PolygonTechnique::bilinear,
                                             PolygonTechnique::solid_angle, PolygonTechnique::projected}) {
      if (technique == PolygonTechnique::projected && !is_diffuse) continue;
      if (technique == PolygonTechnique::bilinear && !polygon.is_parallelogram) continue;
      const Result r = measure([&](const V2f& u) {
        const PolygonView::Point p = PolygonView(polygon, c.receiver, technique).sample(u);
        const float cosine = is_diffuse ? std::max(0.0f, p.direction.dot(c.receiver.normal)) : 1.0f;
        return p.pdf_w > 0.0f ? cosine / p.pdf_w : 0.0f;
      });
      constexpr const char* names[] = {"area", "bilinear", "solid angle", "projected"};
      std::printf("| %s | %s | %.0f | %.4f | %.3g | %s |\n", c.name, names[static_cast<int>(technique)], r.ns,
                  r.noise, r.noise * r.noise * (r.ns + other_ns), technique == chosen ? "*" : "");
    }
  }
}

// Panels of random places, sizes and orientations in a unit cube.
SceneDescription panels(std::uint32_t count) {
  SceneDescription scene;
  Mesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    Sampler sampler(7, i, 0);
    const V2f a = sampler.next_2d(), b = sampler.next_2d();
    const V3f p(a.x, a.y, b.x);
    const Frame frame(square_to_sphere(sampler.next_2d()));
    const float size = 0.3f * std::exp2(-2.0f * b.y) / std::sqrt(static_cast<float>(count));
    mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    for (const V3f& q : {p, p + frame.s * size, p + frame.t * size}) mesh.positions.push_back(q);
  }
  test::add_diffuse(scene, "panels", mesh, C3f(0.0f), C3f(1.0f));
  return scene;
}

// A light chosen with the given probabilities whatever the receiver, then a point of it as the tree would draw
// it.
float flat_sample(const std::vector<LightPolygon>& polygons, const DiscreteDistribution& choice,
                  const Receiver& receiver, const V2f& u) {
  const auto chosen = choice.sample(u.x);
  const PolygonView view(polygons[chosen.index], receiver);
  const PolygonView::Point p = view.sample({chosen.remapped, u.y});
  if (view.side() == back || !(p.pdf_w > 0.0f)) return 0.0f;
  return std::max(0.0f, p.direction.dot(receiver.normal)) / (p.pdf_w * chosen.probability);
}

void tree_table() {
  std::printf(
      "many lights; noise = standard deviation / mean, root of the mean square over the receivers; gain = "
      "variance x (time + %.0f ns) of uniform choice over that of the tree\n",
      other_ns);
  std::printf(
      "| triangles | ns to build one | ns a sample: tree | power | uniform | ns pdf_w | noise: tree | power | "
      "uniform | gain |\n|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::uint32_t count : {1u, 10u, 100u, 1000u, 10000u, 100000u}) {
    const SceneDescription scene = panels(count);
    const double begin = cpu_seconds();
    const Lights lights(scene.shapes);
    const double build = (cpu_seconds() - begin) / count * 1e9;
    std::vector<double> areas;
    const std::vector<LightPolygon> polygons = light_polygons(std::get<Mesh>(scene.shapes[0].geometry));
    for (const LightPolygon& polygon : polygons) areas.push_back(polygon.area);
    const DiscreteDistribution by_power(areas), uniform(std::vector<double>(areas.size(), 1.0));
    std::array<Result, 3> sums{};  // tree, power, uniform; variances instead of noise
    double pdf_ns = 0.0;
    int receivers = 0;  // that see anything at all
    for (std::uint32_t r = 0; r < 16; ++r) {
      Sampler sampler(9, r, 0);
      const V2f a = sampler.next_2d();
      const Receiver receiver{V3f(a.x, a.y, sampler.next_1d()), square_to_sphere(sampler.next_2d()), true};
      const Result tree = measure([&](const V2f& u) {
        const LightSample s = lights.sample(receiver, u);
        return s.pdf_w > 0.0f ? s.radiance.x * std::max(0.0f, s.direction.dot(receiver.normal)) / s.pdf_w
                              : 0.0f;
      });
      if (!std::isfinite(tree.noise)) continue;
      ++receivers;
      const Result flat[] = {
          measure([&](const V2f& u) { return flat_sample(polygons, by_power, receiver, u); }),
          measure([&](const V2f& u) { return flat_sample(polygons, uniform, receiver, u); })};
      for (std::size_t k = 0; k < 3; ++k) {
        const Result& one = k == 0 ? tree : flat[k - 1];
        sums[k].ns += one.ns;
        sums[k].noise += one.noise * one.noise;
      }
      SurfacePoint point{};
      pdf_ns += measure([&](const V2f& u) {
                  point.primitive = static_cast<std::uint32_t>(u.x * static_cast<float>(count));
                  return lights.pdf_w(receiver, V3f(0, 0, 1), 1.0f, point);
                }).ns;
    }
    for (Result& sum : sums) sum = {sum.ns / receivers, std::sqrt(sum.noise / receivers)};
    const auto cost = [](const Result& r) { return r.noise * r.noise * (r.ns + other_ns); };
    std::printf("| %u | %.0f | %.0f | %.0f | %.0f | %.0f | %.2f | %.2f | %.2f | %.3g |\n", count, build,
                sums[0].ns, sums[1].ns, sums[2].ns, pdf_ns / receivers, sums[0].noise, sums[1].noise,
                sums[2].noise, cost(sums[2]) / cost(sums[0]));
  }
}

}  // namespace
}  // namespace twopass

int main() {
  twopass::polygon_table(true);
  twopass::polygon_table(false);
  twopass::tree_table();
}
