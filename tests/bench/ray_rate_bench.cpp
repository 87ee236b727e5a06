// How near the path tracer comes to the speed of Embree alone: rays per CPU second of `path` on the Cornell
// box, beside a bare loop over the same kinds of rays. One thread. Compare the counters `rays`.
#include <benchmark/benchmark.h>

#include "integrators/path.h"
#include "render/core/parallel.h"
#include "render/load/load.h"

#if TWOPASS_EMBREE_VERSION >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace twopass {
namespace {

constexpr int size = 512;
constexpr std::uint32_t samples_per_pixel = 4, pixels_drawn = 1 << 14;

const LoadedScene& cornell_box() {
  static const LoadedScene loaded = load_scene(TWOPASS_SOURCE_DIR "/scenes/cornell-box/scene.xml", {});
  return loaded;
}
const Scene& scene() {
  static const Scene built(cornell_box().scene);
  return built;
}

// The ray of one sample of a pixel; pixels in the order of a render's tiles, every sixteenth tile, so that the
// whole picture is covered.
Ray camera_ray(const Camera& camera, std::uint32_t pixel, Sampler& sampler) {
  const std::uint32_t tile = pixel / 256 * 16 + pixel / 4096 * 5, in_tile = pixel % 256;
  const V2f u = sampler.next_2d();
  return camera.ray({static_cast<float>(tile % 32 * 16 + in_tile % 16) + u.x,
                     static_cast<float>(tile / 32 % 32 * 16 + in_tile / 16) + u.y});
}

struct Query {
  V3f origin, direction;
  bool shadow;  // shadow rays end at origin + direction
};

// The rays of path-traced paths, in the order in which the path tracer casts them.
std::vector<Query> recorded_rays() {
  const Camera camera(*cornell_box().scene.camera, size, size);
  std::vector<Query> queries;
  for (std::uint32_t i = 0; i < pixels_drawn * samples_per_pixel; ++i) {
    const std::uint32_t pixel = i / samples_per_pixel;
    Sampler sampler(1, pixel, i % samples_per_pixel);
    Ray ray = camera_ray(camera, pixel, sampler);
    C3f throughput(1.0f);
    for (int edges = 1;; ++edges) {
      queries.push_back({ray.origin, ray.direction, false});
      const Hit hit = scene().caster().intersect(ray);
      if (hit.escaped()) break;
      const SurfacePoint p = scene().surface_point(ray, hit);
      const Bsdf& bsdf = scene().bsdf(p);
      const LightSample light = scene().lights().sample(receiver_at(p, bsdf), sampler.next_2d());
      const V3f start = spawn_position(p, light.direction);
      if (light.pdf_w > 0.0f && !is_black(light.radiance) && light.direction.dot(p.shading.n) > 0.0f &&
          !is_black(diffuse_reflectance(bsdf)))
        queries.push_back({start, light.position - start, true});
      const auto drawn = sample(bsdf, p.shading.to_local(-ray.direction), sampler.next_2d());
      if (!drawn) break;
      throughput *= drawn->weight;
      const V3f w = p.shading.to_world(drawn->wi);
      ray = {spawn_position(p, w), w};
      if (edges >= 5) {
        const float survival = std::min(max_component(throughput), 0.95f);
        if (sampler.next_1d() >= survival) break;
        throughput *= 1.0f / survival;
      }
    }
  }
  return queries;
}

RTCScene bare_scene(RTCDevice device) {
  RTCScene bare = rtcNewScene(device);
  rtcSetSceneFlags(bare, RTC_SCENE_FLAG_ROBUST);
  for (const Shape& shape : scene().shapes()) {
    const Mesh& mesh = std::get<Mesh>(shape.geometry);
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

void bare_embree(benchmark::State& state) {
  const std::vector<Query> queries = recorded_rays();
  RTCDevice device = rtcNewDevice("");
  RTCScene bare = bare_scene(device);
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
BENCHMARK(bare_embree)->Unit(benchmark::kMillisecond);

void path_tracer(benchmark::State& state) {
  const Camera camera(*cornell_box().scene.camera, size, size);
  const PathTracer path(scene(), {});
  RayCounts counts;
  C3f sum(0.0f);
  for (auto _ : state) {
    for (std::uint32_t i = 0; i < pixels_drawn * samples_per_pixel; ++i) {
      const std::uint32_t pixel = i / samples_per_pixel;
      Sampler sampler(1, pixel, i % samples_per_pixel);
      sum += path.radiance(camera_ray(camera, pixel, sampler), sampler, counts).radiance;
    }
  }
  benchmark::DoNotOptimize(sum);
  const auto rays = static_cast<double>(counts.rays + counts.shadow_rays);
  state.counters["rays"] = benchmark::Counter(rays, benchmark::Counter::kIsRate);
  const auto paths = static_cast<double>(state.iterations()) * pixels_drawn * samples_per_pixel;
  state.counters["paths"] = benchmark::Counter(paths, benchmark::Counter::kIsRate);
  state.counters["rays_per_path"] = rays / paths;
}
BENCHMARK(path_tracer)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace twopass
