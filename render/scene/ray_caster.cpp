#include "render/scene/ray_caster.h"

#include <atomic>
#include <cstring>
#include <string>

#if TWOPASS_EMBREE_VERSION >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "render/core/error.h"
#include "render/scene/geometry.h"

namespace twopass {

namespace {

// Embree builds with asserts abort on rays that are not finite or start further out than this.
constexpr float largest_coordinate = 1e18f;

bool is_valid(const V3f& v) {  // false for NaN, too
  return std::abs(v.x) < largest_coordinate && std::abs(v.y) < largest_coordinate &&
         std::abs(v.z) < largest_coordinate;
}

// The one difference between Embree 3 and 4 that queries see.
#if TWOPASS_EMBREE_VERSION >= 4
void query_intersect(RTCScene scene, RTCRayHit& ray_hit) { rtcIntersect1(scene, &ray_hit, nullptr); }
void query_occluded(RTCScene scene, RTCRay& ray) { rtcOccluded1(scene, &ray, nullptr); }
#else
void query_intersect(RTCScene scene, RTCRayHit& ray_hit) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &ray_hit);
}
void query_occluded(RTCScene scene, RTCRay& ray) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, &ray);
}
#endif

// Written field by field in place: copying a finished ray would stall on its own stores.
void set_ray(RTCRay& ray, const V3f& origin, const V3f& direction, float t_far) {
  ray.org_x = origin.x, ray.org_y = origin.y, ray.org_z = origin.z;
  ray.tnear = 0.0f;
  ray.dir_x = direction.x, ray.dir_y = direction.y, ray.dir_z = direction.z;
  ray.time = 0.0f;
  ray.tfar = t_far;
  ray.mask = 0xffffffffu;
  ray.id = 0;
  ray.flags = 0;
}

// The nearest distance within (tnear, tfar) at which the ray meets the sphere; false if there is none.
bool nearest_in_range(const Sphere& sphere, const RTCRay& ray, float& t) {
  double near, far;
  if (!intersect_sphere(sphere, {ray.org_x, ray.org_y, ray.org_z}, {ray.dir_x, ray.dir_y, ray.dir_z}, near,
                        far))
    return false;
  for (const double candidate : {near, far}) {
    t = static_cast<float>(candidate);
    if (t > ray.tnear && t < ray.tfar) return true;
  }
  return false;
}

const Sphere& sphere_of(void* user_data) { return *static_cast<const Sphere*>(user_data); }

void sphere_bounds(const RTCBoundsFunctionArguments* args) {
  const Sphere& sphere = sphere_of(args->geometryUserPtr);
  const float r = sphere.radius + rounding_offset(sphere);
  args->bounds_o->lower_x = sphere.center.x - r, args->bounds_o->upper_x = sphere.center.x + r;
  args->bounds_o->lower_y = sphere.center.y - r, args->bounds_o->upper_y = sphere.center.y + r;
  args->bounds_o->lower_z = sphere.center.z - r, args->bounds_o->upper_z = sphere.center.z + r;
}

void sphere_intersect(const RTCIntersectFunctionNArguments* args) {
  if (args->valid[0] == 0) return;
  auto& ray_hit = *reinterpret_cast<RTCRayHit*>(args->rayhit);  // only single rays are ever cast
  float t;
  if (!nearest_in_range(sphere_of(args->geometryUserPtr), ray_hit.ray, t)) return;
  ray_hit.ray.tfar = t;
  ray_hit.hit.geomID = args->geomID;
  ray_hit.hit.primID = args->primID;
  ray_hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  ray_hit.hit.u = ray_hit.hit.v = 0.0f;
}

void sphere_occluded(const RTCOccludedFunctionNArguments* args) {
  if (args->valid[0] == 0) return;
  auto& ray = *reinterpret_cast<RTCRay*>(args->ray);
  float t;
  if (nearest_in_range(sphere_of(args->geometryUserPtr), ray, t)) ray.tfar = -infinity_f;
}

}  // namespace

struct RayCaster::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::atomic<std::int64_t> bytes{0};

  ~Impl() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
  void check(const char* what) const {
    const RTCError code = rtcGetDeviceError(device);
    if (code == RTC_ERROR_NONE) return;
    if (code == RTC_ERROR_OUT_OF_MEMORY)
      throw Error("ray caster", std::string("out of memory while ") + what,
                  "use a smaller scene or a larger machine");
    throw Error("ray caster",
                std::string("Embree failed while ") + what + " (error " + std::to_string(code) + ")",
                "check that the scene's coordinates are of reasonable size");
  }
  void attach(RTCGeometry geometry, std::uint32_t id) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, id);
    rtcReleaseGeometry(geometry);
  }
  void add_mesh(const Mesh& mesh, std::uint32_t id) {
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    // Vertices are copied (Embree reads past the last one), indices are shared.
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                             sizeof(V3f), mesh.positions.size());
    check("copying a mesh");
    std::memcpy(vertices, static_cast<const void*>(mesh.positions.data()), mesh.positions.size() * sizeof(V3f));
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                               sizeof(V3u), mesh.triangles.size());
    attach(geometry, id);
  }
  void add_sphere(const Sphere& sphere, std::uint32_t id) {
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, 1);
    rtcSetGeometryUserData(geometry, const_cast<Sphere*>(&sphere));
    rtcSetGeometryBoundsFunction(geometry, sphere_bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, sphere_intersect);
    rtcSetGeometryOccludedFunction(geometry, sphere_occluded);
    attach(geometry, id);
  }
};

RayCaster::RayCaster(std::span<const Shape> shapes) : impl_(std::make_unique<Impl>()) {
  impl_->device = rtcNewDevice("");
  if (!impl_->device) throw Error("ray caster", "Embree cannot start", "check the installation of libembree");
  rtcSetDeviceMemoryMonitorFunction(
      impl_->device,
      [](void* bytes, ssize_t change, bool) {
        *static_cast<std::atomic<std::int64_t>*>(bytes) += change;
        return true;
      },
      &impl_->bytes);
  impl_->scene = rtcNewScene(impl_->device);
  rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);
  for (std::uint32_t id = 0; id < shapes.size(); ++id) {
    if (const auto* mesh = std::get_if<Mesh>(&shapes[id].geometry)) {
      if (!mesh->triangles.empty()) impl_->add_mesh(*mesh, id);
    } else {
      impl_->add_sphere(std::get<Sphere>(shapes[id].geometry), id);
    }
  }
  rtcCommitScene(impl_->scene);
  impl_->check("building the acceleration structure");
}

RayCaster::~RayCaster() = default;

Hit RayCaster::intersect(const Ray& ray) const {
  Hit hit;
  if (!is_valid(ray.origin) || !is_valid(ray.direction)) return hit;
  RTCRayHit query;
  set_ray(query.ray, ray.origin, ray.direction, infinity_f);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  query_intersect(impl_->scene, query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
  hit.shape = query.hit.geomID;
  hit.primitive = query.hit.primID;
  hit.t = query.ray.tfar;
  hit.u = query.hit.u;
  hit.v = query.hit.v;
  return hit;
}

bool RayCaster::occluded(const V3f& from, const V3f& to) const {
  const V3f direction = to - from;
  if (!is_valid(from) || !is_valid(direction)) return true;
  RTCRay ray;
  // The rounding of `direction` moves the end by some units in the last place of the whole length.
  set_ray(ray, from, direction, 1.0f - 16.0f * std::numeric_limits<float>::epsilon());
  query_occluded(impl_->scene, ray);
  return ray.tfar < 0.0f;
}

std::size_t RayCaster::memory_bytes() const {
  return static_cast<std::size_t>(std::max<std::int64_t>(0, impl_->bytes));
}

}  // namespace twopass
