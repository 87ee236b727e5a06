// How near the path tracer comes to the speed of Embree alone: rays per CPU second of `path`, beside bare loops
// over the same rays, one by one and in packets. Compare the counters `rays`; between versions of the path
// tracer, the counters `paths`.
#include <filesystem>
#include <map>

#include <benchmark/benchmark.h>

#include "integrators/path.h"
#include "integrators/vertex.h"
#include "render/core/parallel.h"
#include "render/load/load.h"
#include "render/scene/embree.h"

namespace twopass {
namespace {

constexpr int size = 512;
constexpr std::uint32_t samples_per_pixel = 4, pixels_drawn = 1 << 14;

// A scene without a camera is seen from its middle, one without lamps is lit by the sky.
struct BenchScene {
  explicit BenchScene(SceneDescription description)
      : scene(lit(std::move(description))), camera(camera_of(scene), size, size) {}
  Scene scene;
  Camera camera;

 private:
  static SceneDescription lit(SceneDescription description) {
    if (std::none_of(description.shapes.begin(), description.shapes.end(), is_emitter))
      description.environment = Environment(C3f(1.0f));
    return description;
  }
  static CameraDescription camera_of(const Scene& scene) {
    if (scene.description().camera) return *scene.description().camera;
    const V3d middle(scene.bounds().center());
    return {look_at(middle, middle + V3d(1, 0, 0), {0, 0, 1}, "bench"), 80.0, FovAxis::x};
  }
};
const BenchScene& bench_scene(const std::string& file) {
  static std::map<std::string, std::unique_ptr<BenchScene>> all;
  auto& one = all[file];
  if (!one) one = std::make_unique<BenchScene>(load_scene(TWOPASS_SOURCE_DIR + file, {}).scene);
  return *one;
}

bool is_there(const std::string& file) { return std::filesystem::exists(TWOPASS_SOURCE_DIR + file); }

// The ray of one sample of a pixel; pixels in the order of a render's tiles, every sixteenth tile, so that the
// whole picture is covered.
Ray camera_ray(const Camera& camera, std::uint32_t pixel, Sampler& sampler) {
  const std::uint32_t tile = pixel / 256 * 16 + pixel / 4096 * 5, in_tile = pixel % 256;
  const V2f u = sampler.next_2d();
  return camera
      .ray({static_cast<float>(tile % 32 * 16 + in_tile % 16) + u.x,
            static_cast<float>(tile / 32 % 32 * 16 + in_tile / 16) + u.y})
      .ray;
}

struct Query {
  V3f origin, direction;
  bool shadow;  // shadow rays end at origin + direction
  std::uint32_t path;
  int edge;  // of the path, from 1; a shadow ray belongs to the edge that led to it
};

// The rays of path-traced paths, in the order in which the path tracer casts them one by one.
std::vector<Query> recorded_rays(const BenchScene& bench) {
  const Scene& scene = bench.scene;
  std::vector<Query> queries;
  for (std::uint32_t i = 0; i < pixels_drawn * samples_per_pixel; ++i) {
    const std::uint32_t pixel = i / samples_per_pixel;
    Sampler sampler(1, pixel, i % samples_per_pixel);
    Ray ray = camera_ray(bench.camera, pixel, sampler);
    C3f throughput(1.0f);
    for (int edges = 1;; ++edges) {
      queries.push_back({ray.origin, ray.direction, false, i, edges});
      const Hit hit = scene.caster().intersect(ray);
      if (hit.escaped()) break;
      SurfacePoint p = scene.surface_point(ray, hit);
      Bsdf resolved;
      const Bsdf& bsdf = scene.resolve(p, ray.direction, resolved, [&] { return sampler.next_1d(); });
      const V3f wo = p.shading.to_local(-ray.direction);
      if (!is_specular(bsdf) && !scene.lights().empty()) {
        const LightSample light = scene.lights().sample(receiver_at(p, bsdf), sampler.next_2d());
        const V3f start = spawn_position(p, light.direction);
        if (light.pdf_w > 0.0f && !is_black(light.radiance) &&
            !is_black(eval(bsdf, wo, p.shading.to_local(light.direction))))
          queries.push_back({start, light.position - start, true, i, edges});
      }
      const auto drawn = sample(bsdf, wo, sampler.next_2d());
      if (!drawn) break;
      throughput *= drawn->weight;
      const V3f w = p.shading.to_world(drawn->wi);
      ray = {spawn_position(p, w), w};
      if (edges >= 5) {
        const float survival = survival_probability(max_component(throughput));
        if (sampler.next_1d() >= survival) break;
        throughput *= 1.0f / survival;
      }
    }
  }
  return queries;
}

RTCScene bare_scene(RTCDevice device, const Scene& scene) {
  RTCScene bare = rtcNewScene(device);
  rtcSetSceneFlags(bare, RTC_SCENE_FLAG_ROBUST);
  for (const Shape& shape : scene.shapes()) {
    const Mesh& mesh = std::get<Mesh>(shape.geometry);
    if (mesh.triangles.empty()) continue;
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<V3f*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(V3f), mesh.positions.size()));
    std::copy(mesh.positions.begin(), mesh.positions.end(), vertices);
    auto* indices = static_cast<V3u*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(V3u), mesh.triangles.size()));
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), indices);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(bare, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(bare);
  return bare;
}

void bare_embree(benchmark::State& state, const std::string& file) {
  if (!is_there(file)) return state.SkipWithError("not there");
  const std::vector<Query> queries = recorded_rays(bench_scene(file));
  RTCDevice device = rtcNewDevice("");
  RTCScene bare = bare_scene(device, bench_scene(file).scene);
  std::uint64_t hits = 0;
  for (auto _ : state) {
    for (const Query& q : queries) {
      RTCRayHit query;
      RTCRay& ray = query.ray;
      ray.org_x = q.origin.x, ray.org_y = q.origin.y, ray.org_z = q.origin.z;
      ray.tnear = ray.time = 0.0f;
      ray.dir_x = q.direction.x, ray.dir_y = q.direction.y, ray.dir_z = q.direction.z;
      ray.tfar = q.shadow ? 1.0f : infinity_f;
      ray.mask = 0xffffffffu;
      ray.id = ray.flags = 0;
      query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if TWOPASS_EMBREE_VERSION >= 4
      if (q.shadow)
        rtcOccluded1(bare, &query.ray, nullptr);
      else
        rtcIntersect1(bare, &query, nullptr);
#else
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      if (q.shadow)
        rtcOccluded1(bare, &context, &query.ray);
      else
        rtcIntersect1(bare, &context, &query);
#endif
      hits += query.hit.geomID;
    }
  }
  benchmark::DoNotOptimize(hits);
  state.counters["rays"] =
      benchmark::Counter(static_cast<double>(queries.size() * state.iterations()), benchmark::Counter::kIsRate);
  rtcReleaseScene(bare);
  rtcReleaseDevice(device);
}

// The same rays in packets of 16: those of as many paths as a bundle holds, edge by edge.
void bare_embree_packets(benchmark::State& state, const std::string& file) {
  if (!is_there(file)) return state.SkipWithError("not there");
  std::vector<Query> queries = recorded_rays(bench_scene(file));
  const auto order = [](const Query& q) { return std::tuple(q.path / bundle_size, q.edge, q.shadow, q.path); };
  std::sort(queries.begin(), queries.end(),
            [&](const Query& a, const Query& b) { return order(a) < order(b); });
  RTCDevice device = rtcNewDevice("");
  RTCScene bare = bare_scene(device, bench_scene(file).scene);
  std::uint64_t hits = 0;
  for (auto _ : state) {
    for (std::size_t first = 0; first < queries.size();) {
      const Query& q = queries[first];
      alignas(64) int valid[16] = {};
      RTCRayHit16 query;
      RTCRay16& ray = query.ray;
      std::size_t n = 0;
      for (; n < 16 && first + n < queries.size(); ++n) {
        const Query& r = queries[first + n];
        if (r.shadow != q.shadow || r.edge != q.edge || r.path / bundle_size != q.path / bundle_size) break;
        valid[n] = -1;
        ray.org_x[n] = r.origin.x, ray.org_y[n] = r.origin.y, ray.org_z[n] = r.origin.z;
        ray.dir_x[n] = r.direction.x, ray.dir_y[n] = r.direction.y, ray.dir_z[n] = r.direction.z;
      }
      first += n;
      for (int i = 0; i < 16; ++i) {
        ray.tnear[i] = ray.time[i] = 0.0f;
        ray.tfar[i] = q.shadow ? 1.0f : infinity_f;
        ray.mask[i] = 0xffffffffu;
        ray.id[i] = ray.flags[i] = 0;
        query.hit.geomID[i] = query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
      }
#if TWOPASS_EMBREE_VERSION >= 4
      RTCIntersectArguments arguments;
      rtcInitIntersectArguments(&arguments);
      if (q.edge == 1) arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
      if (q.shadow)
        rtcOccluded16(valid, bare, &query.ray, nullptr);
      else
        rtcIntersect16(valid, bare, &query, &arguments);
#else
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      if (q.edge == 1 && !q.shadow) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
      if (q.shadow)
        rtcOccluded16(valid, bare, &context, &query.ray);
      else
        rtcIntersect16(valid, bare, &context, &query);
#endif
      hits += query.hit.geomID[0];
    }
  }
  benchmark::DoNotOptimize(hits);
  state.counters["rays"] =
      benchmark::Counter(static_cast<double>(queries.size() * state.iterations()), benchmark::Counter::kIsRate);
  rtcReleaseScene(bare);
  rtcReleaseDevice(device);
}

// Every thread renders all of the samples; rates are of the CPU time of all threads.
void path_tracer(benchmark::State& state, const std::string& file) {
  if (!is_there(file)) return state.SkipWithError("not there");
  const BenchScene& bench = bench_scene(file);
  const PathTracer path(bench.scene, {});
  RayCounts counts;
  C3f sum(0.0f);
  std::vector<PathSample> samples;
  const RayCone cone =
      bench.scene.has_textures() ? sample_cone(bench.camera, size, size, samples_per_pixel) : RayCone{};
  for (auto _ : state) {
    for (std::uint32_t i = 0; i < pixels_drawn * samples_per_pixel;) {
      samples.clear();
      for (std::uint32_t k = 0; k < bundle_size; ++k, ++i) {
        const std::uint32_t pixel = i / samples_per_pixel;
        Sampler sampler(1, pixel, i % samples_per_pixel);
        const Ray ray = camera_ray(bench.camera, pixel, sampler);
        samples.push_back({ray, sampler, {}, infinity_f, cone});
      }
      path.trace(samples, counts);
      for (const PathSample& sample : samples) sum += sample.seen.radiance;
    }
  }
  benchmark::DoNotOptimize(sum);
  const auto rays = static_cast<double>(counts.rays + counts.shadow_rays);
  state.counters["rays"] = benchmark::Counter(rays, benchmark::Counter::kIsRate);
  const auto paths = static_cast<double>(state.iterations()) * pixels_drawn * samples_per_pixel;
  state.counters["paths"] = benchmark::Counter(paths, benchmark::Counter::kIsRate);
  state.counters["rays_per_path"] = benchmark::Counter(rays / paths, benchmark::Counter::kAvgThreads);
  state.counters["mean"] = benchmark::Counter(mean_component(sum) / paths, benchmark::Counter::kAvgThreads);
}
const std::string cornell_box = "/scenes/cornell-box/scene.xml",
                  specular = "/scenes/cornell-box-specular/scene.xml",
                  conference = "/../shared/scenes/conference/conference.obj",
                  staircase = "/../shared/scenes/staircase/scene.xml";

BENCHMARK_CAPTURE(bare_embree, cornell_box, cornell_box)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bare_embree_packets, cornell_box, cornell_box)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(path_tracer, cornell_box, cornell_box)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->Threads(1)
    ->Threads(2);
BENCHMARK_CAPTURE(path_tracer, cornell_box_specular, specular)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bare_embree, conference, conference)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(path_tracer, conference, conference)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bare_embree, staircase, staircase)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bare_embree_packets, staircase, staircase)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(path_tracer, staircase, staircase)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace twopass
