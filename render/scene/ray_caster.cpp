#include "render/scene/ray_caster.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <map>
#include <string>

#include "render/core/error.h"
#include "render/scene/embree_query.h"
#include "render/scene/embree_surface.h"

namespace twopass {

namespace {

// Instances know which shapes of theirs was hit: the shapes of one instance follow each other.
std::uint32_t shape_of(std::uint32_t instance, std::uint32_t geometry) {
  return instance == RTC_INVALID_GEOMETRY_ID ? geometry : instance + geometry;
}

// The number of queries that the next packet takes of `left`; 1: that one alone, because a packet that is not
// half full is slower than its rays one by one.
template <int N>
std::size_t next_packet(std::size_t left) {
  return 2 * left < N ? 1 : std::min<std::size_t>(left, N);
}

// Scattered and shadow rays sorted by octant may be cast as coherent ones, which pays where the whole tree is a
// few nodes: in the Cornell box the second edge takes half the time, shadow rays a few per cent less; a
// conference room of 330 thousand triangles is a third slower.
constexpr std::size_t most_triangles_sorted = 1000;

// An order of queries; by_octant() is that of the octants of their directions.
constexpr std::size_t most_sorted = 256;
using Order = std::array<std::uint8_t, most_sorted>;
const V3f& direction_of(const Ray& ray) { return ray.direction; }
V3f direction_of(const Segment& segment) { return segment.to - segment.from; }
template <class Query>
Order by_octant(std::span<const Query> queries) {
  Order octant;
  std::array<std::uint32_t, 9> begin{};
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const V3f& d = direction_of(queries[i]);
    octant[i] = static_cast<std::uint8_t>((d.x < 0.0f) + 2 * (d.y < 0.0f) + 4 * (d.z < 0.0f));
    ++begin[octant[i] + 1u];
  }
  for (std::size_t k = 1; k < 8; ++k) begin[k] += begin[k - 1];
  Order order;
  for (std::size_t i = 0; i < queries.size(); ++i) order[begin[octant[i]]++] = static_cast<std::uint8_t>(i);
  return order;
}
Order as_given() {
  Order order;
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint8_t>(i);
  return order;
}

// Calls body(queries, order, results) for as many of them at a time as can be sorted.
template <class Query, class Result, class Body>
void in_order(std::span<const Query> queries, std::span<Result> results, bool sorted, const Body& body) {
  while (!queries.empty()) {
    const auto some = queries.first(std::min(queries.size(), most_sorted));
    const Order order = sorted ? by_octant(some) : as_given();
    body(some, std::span(order).first(some.size()), results);
    queries = queries.subspan(some.size());
    results = results.subspan(some.size());
  }
}

}  // namespace

struct RayCaster::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::size_t triangles = 0;
  int packet_width = 1;  // that the processor has instructions for
  std::atomic<std::int64_t> bytes{0};

  std::map<std::vector<const Mesh*>, RTCScene> groups;  // what is instanced

  ~Impl() {
    if (scene) rtcReleaseScene(scene);
    for (const auto& [meshes, group] : groups) rtcReleaseScene(group);
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
  static void attach(RTCScene to, RTCGeometry geometry, std::uint32_t id) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(to, geometry, id);
    rtcReleaseGeometry(geometry);
  }
  void add_mesh(RTCScene to, const Mesh& mesh, std::uint32_t id) {
    if (mesh.triangles.empty()) return;
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    // Vertices are copied (Embree reads past the last one), indices are shared.
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                             sizeof(V3f), mesh.positions.size());
    check("copying a mesh");
    std::memcpy(vertices, static_cast<const void*>(mesh.positions.data()), mesh.positions.size() * sizeof(V3f));
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                               sizeof(V3u), mesh.triangles.size());
    attach(to, geometry, id);
  }
  RTCScene new_scene() const {
    const RTCScene made = rtcNewScene(device);
    rtcSetSceneFlags(made, RTC_SCENE_FLAG_ROBUST);
    return made;
  }
  // One instance of several meshes: the shapes from `id` on.
  void add_instance(const std::vector<const Mesh*>& meshes, const Placement& to_world, std::uint32_t id) {
    RTCScene& group = groups[meshes];
    if (!group) {
      group = new_scene();
      for (std::uint32_t k = 0; k < meshes.size(); ++k) add_mesh(group, *meshes[k], k);
      rtcCommitScene(group);
      check("building the acceleration structure of a group");
    }
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, group);
    rtcSetGeometryTimeStepCount(geometry, 1);
    std::array<float, 12> columns;
    std::size_t next = 0;
    for (const V3f& column : {to_world.x, to_world.y, to_world.z, to_world.origin})
      for (int row = 0; row < 3; ++row) columns[next++] = column[row];
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns.data());
    attach(scene, geometry, id);
  }
  // Adds the shape of this number, or all of its instance. Returns the number after them.
  std::uint32_t add(std::span<const Shape> shapes, std::uint32_t id) {
    const Geometry& geometry = shapes[id].geometry;
    const auto* instance = std::get_if<MeshInstance>(&geometry);
    if (!instance) {
      std::visit(
          [&]<class Kind>(const Kind& kind) {
            if constexpr (std::is_same_v<Kind, Mesh>) {
              triangles += kind.triangles.size();
              add_mesh(scene, kind, id);
            } else if constexpr (!std::is_same_v<Kind, MeshInstance>) {
              attach(scene, new_surface(device, kind), id);
            }
          },
          geometry);
      return id + 1;
    }
    std::vector<const Mesh*> meshes;
    std::uint32_t next = id;
    for (; next < shapes.size(); ++next) {
      const auto* other = std::get_if<MeshInstance>(&shapes[next].geometry);
      // The same mesh again in the same place is another instance: groups stay as they were made.
      if (!other || other->to_world != instance->to_world || std::ranges::count(meshes, other->mesh.get()) > 0)
        break;
      meshes.push_back(other->mesh.get());
      triangles += other->mesh->triangles.size();
    }
    add_instance(meshes, instance->to_world, id);
    return next;
  }
  [[nodiscard]] Hit intersect(const Ray& ray) const;
  [[nodiscard]] bool occluded(const V3f& from, const V3f& to) const;
  // In packets of N, in the given order.
  template <int N>
  void intersect(std::span<const Ray> rays, std::span<const std::uint8_t> order, std::span<Hit> hits,
                 bool coherent) const;
  template <int N>
  void occluded(std::span<const Segment> segments, std::span<const std::uint8_t> order, std::span<bool> results,
                bool coherent) const;
};

Hit RayCaster::Impl::intersect(const Ray& ray) const {
  Hit hit;
  if (!is_valid(ray.origin, ray.direction)) return hit;
  RTCRayHit query;
  set_ray(query.ray, ray.origin, ray.direction, infinity_f);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  query_intersect(scene, query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
  return {shape_of(query.hit.instID[0], query.hit.geomID), query.hit.primID, query.ray.tfar, query.hit.u,
          query.hit.v};
}

bool RayCaster::Impl::occluded(const V3f& from, const V3f& to) const {
  const V3f direction = to - from;
  if (!is_valid(from, direction)) return true;
  RTCRay ray;
  set_ray(ray, from, direction, segment_end);
  query_occluded(scene, ray);
  return ray.tfar < 0.0f;
}

template <int N>
void RayCaster::Impl::intersect(std::span<const Ray> rays, std::span<const std::uint8_t> order,
                                std::span<Hit> hits, bool coherent) const {
  alignas(64) int valid[N];
  PacketRayHit<N> packet;
  set_constants<N>(packet.ray);
  while (!order.empty()) {
    const std::size_t count = next_packet<N>(order.size());
    if (count == 1) {
      hits[order[0]] = intersect(rays[order[0]]);
      order = order.subspan(1);
      continue;
    }
    for (std::size_t lane = 0; lane < count; ++lane)
      put<N>(packet.ray, lane, rays[order[lane]].origin, rays[order[lane]].direction);
    finish<N>(packet.ray, valid, count, infinity_f);
    std::fill_n(packet.hit.geomID, N, RTC_INVALID_GEOMETRY_ID);
    std::fill_n(packet.hit.instID[0], N, RTC_INVALID_GEOMETRY_ID);
    query_intersect<N>(scene, valid, packet, coherent);
    for (std::size_t lane = 0; lane < count; ++lane) {
      const std::uint32_t geometry = packet.hit.geomID[lane];
      Hit& hit = hits[order[lane]];
      hit = {};
      if (geometry == RTC_INVALID_GEOMETRY_ID) continue;
      hit = {shape_of(packet.hit.instID[0][lane], geometry), packet.hit.primID[lane], packet.ray.tfar[lane],
             packet.hit.u[lane], packet.hit.v[lane]};
    }
    order = order.subspan(count);
  }
}

template <int N>
void RayCaster::Impl::occluded(std::span<const Segment> segments, std::span<const std::uint8_t> order,
                               std::span<bool> results, bool coherent) const {
  alignas(64) int valid[N];
  PacketRay<N> packet;
  set_constants<N>(packet);
  while (!order.empty()) {
    const std::size_t count = next_packet<N>(order.size());
    if (count == 1) {
      results[order[0]] = occluded(segments[order[0]].from, segments[order[0]].to);
      order = order.subspan(1);
      continue;
    }
    for (std::size_t lane = 0; lane < count; ++lane)
      put<N>(packet, lane, segments[order[lane]].from, direction_of(segments[order[lane]]));
    finish<N>(packet, valid, count, segment_end);
    query_occluded<N>(scene, valid, packet, coherent);
    for (std::size_t lane = 0; lane < count; ++lane)
      results[order[lane]] = (valid[lane] == 0) | (packet.tfar[lane] < 0.0f);
    order = order.subspan(count);
  }
}

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
  if (rtcGetDeviceProperty(impl_->device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0)
    impl_->packet_width = 16;
  else if (rtcGetDeviceProperty(impl_->device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) != 0)
    impl_->packet_width = 8;
  impl_->scene = impl_->new_scene();
  for (std::uint32_t id = 0; id < shapes.size();) id = impl_->add(shapes, id);
  rtcCommitScene(impl_->scene);
  impl_->check("building the acceleration structure");
}

RayCaster::~RayCaster() = default;

Hit RayCaster::intersect(const Ray& ray) const { return impl_->intersect(ray); }

bool RayCaster::occluded(const V3f& from, const V3f& to) const { return impl_->occluded(from, to); }

void RayCaster::intersect(std::span<const Ray> rays, std::span<Hit> hits, Rays kind) const {
  const bool sorted = kind == Rays::scattered && impl_->triangles <= most_triangles_sorted;
  const bool coherent = kind == Rays::coherent || sorted;
  in_order(rays, hits, sorted, [&](auto some, auto order, auto results) {
    if (impl_->packet_width == 16)
      impl_->intersect<16>(some, order, results, coherent);
    else if (impl_->packet_width == 8)
      impl_->intersect<8>(some, order, results, coherent);
    else
      for (std::size_t i = 0; i < some.size(); ++i) results[i] = impl_->intersect(some[i]);
  });
}

void RayCaster::occluded(std::span<const Segment> segments, std::span<bool> results) const {
  const bool sorted = impl_->triangles <= most_triangles_sorted;
  in_order(segments, results, sorted, [&](auto some, auto order, auto blocked) {
    if (impl_->packet_width == 16)
      impl_->occluded<16>(some, order, blocked, sorted);
    else if (impl_->packet_width == 8)
      impl_->occluded<8>(some, order, blocked, sorted);
    else
      for (std::size_t i = 0; i < some.size(); ++i) blocked[i] = impl_->occluded(some[i].from, some[i].to);
  });
}

std::size_t RayCaster::memory_bytes() const {
  return static_cast<std::size_t>(std::max<std::int64_t>(0, impl_->bytes));
}

}  // namespace twopass
