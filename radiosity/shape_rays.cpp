#include "radiosity/shape_rays.h"

#include <atomic>

#include "render/core/distribution.h"
#include "render/core/interrupt.h"
#include "render/core/parallel.h"
#include "render/core/sampler.h"
#include "render/core/warp.h"

namespace twopass {

namespace {

constexpr std::uint32_t rays_at_once = 4096;

// Rays of one shape, a block of them at a time.
class ShapeRays {
 public:
  ShapeRays(const Scene& scene, std::span<const Patch> patches, std::uint32_t shape, std::uint32_t seed)
      : scene_(scene), patches_(patches), shape_(shape), seed_(seed) {
    std::vector<double> area;
    for (const Patch& patch : patches) area.push_back(patch.area);
    choice_ = DiscreteDistribution(area);
  }

  [[nodiscard]] Ray ray(std::uint32_t k) const {
    Sampler sampler(seed_, shape_, k);
    const V2f u = sampler.next_2d();
    const auto chosen = choice_.sample(u.x);
    const ElementPoint start = patches_[chosen.index].sample({chosen.remapped, u.y});
    const V3f direction = Frame(V3f(start.normal)).to_world(square_to_cosine_hemisphere(sampler.next_2d()));
    return {start.ray_position(), direction};
  }

 private:
  const Scene& scene_;
  std::span<const Patch> patches_;
  std::uint32_t shape_, seed_;
  DiscreteDistribution choice_;
};

}  // namespace

ShapeFronts collect_fronts(const Scene& scene) {
  ShapeFronts fronts;
  for (std::uint32_t s = 0; s < scene.shapes().size(); ++s) {
    fronts.first.push_back(static_cast<std::uint32_t>(fronts.patch.size()));
    const Geometry& geometry = scene.shapes()[s].geometry;
    fronts.is_analytic.push_back(is_analytic(geometry));
    for (std::uint32_t i = 0; i < piece_count(geometry); ++i) {
      const Patch patch = piece_patch(geometry, i, front);
      if (patch.area > 0.0)
        fronts.patch.push_back(patch);
      else
        ++fronts.degenerate;
    }
    double area = 0.0;
    for (std::size_t i = fronts.first.back(); i < fronts.patch.size(); ++i) area += fronts.patch[i].area;
    fronts.area.push_back(area);
    fronts.shape.resize(fronts.patch.size(), s);
  }
  fronts.first.push_back(static_cast<std::uint32_t>(fronts.patch.size()));
  return fronts;
}

LineFollower::LineFollower(const Scene& scene) : scene_(scene) {
  for (const Shape& shape : scene.shapes()) {
    const Mesh* mesh = mesh_of(shape.geometry);
    most_hits_ += mesh ? mesh->triangles.size() : 2;
  }
}

void LineFollower::follow(Ray ray, bool beyond_first, FrontsMet& met) const {
  met.fronts.clear();
  met.escaped = met.met_back = false;
  SurfacePoint last{};
  last.shape = no_index;
  for (std::size_t hits = 0; hits < most_hits_; ++hits) {
    const Hit hit = scene_.caster().intersect(ray);
    if (hit.escaped()) {
      met.escaped = hits == 0;
      return;
    }
    const SurfacePoint point = scene_.surface_point(ray, hit);
    // At a grazing angle the step off a surface may fall short, and it is met again.
    const bool again =
        point.shape == last.shape && point.primitive == last.primitive && point.side == last.side;
    if (point.side == front && !again) met.fronts.push_back({point.shape, hits == 0});
    if (hits == 0) met.met_back = point.side == back;
    if (!beyond_first) return;
    ray.origin = spawn_position(point, ray.direction);
    last = point;
  }
}

bool ShapeRayCounts::closed() const {
  const std::uint64_t all = std::uint64_t{rays} * visible.size();
  return all > 0 && (escaped + met_back) * 100000 <= all;
}

ShapeRayCounts count_shape_rays(const Scene& scene, const ShapeFronts& fronts, std::uint32_t rays,
                                bool beyond_first, std::uint32_t seed) {
  const std::size_t shapes = fronts.shapes();
  std::vector<ShapeRays> source;
  for (std::uint32_t s = 0; s < shapes; ++s) source.emplace_back(scene, fronts.patches_of(s), s, seed);
  const LineFollower line(scene);
  // Sums of integers: the order of threads does not matter.
  std::vector<std::atomic<std::uint64_t>> visible(shapes * shapes), blocked(shapes * shapes);
  std::atomic<std::uint64_t> escaped{0}, met_back{0};
  const std::size_t blocks = (rays + rays_at_once - 1) / rays_at_once;
  parallel_for(shapes * blocks, 1, [&](std::size_t begin, std::size_t end) {
    FrontsMet met;
    for (std::size_t task = begin; task < end; ++task) {
      throw_if_interrupted();
      const std::size_t s = task / blocks;
      if (fronts.patches_of(static_cast<std::uint32_t>(s)).empty()) continue;
      const auto first = static_cast<std::uint32_t>(task % blocks * rays_at_once);
      for (std::uint32_t k = first; k < std::min(rays, first + rays_at_once); ++k) {
        line.follow(source[s].ray(k), beyond_first, met);
        for (const FrontsMet::Front& front : met.fronts)
          ++(front.first ? visible : blocked)[s * shapes + front.shape];
        escaped += met.escaped;
        met_back += met.met_back;
      }
    }
  });
  ShapeRayCounts counts;
  counts.rays = rays;
  for (std::size_t s = 0; s < shapes; ++s) {
    const auto row = static_cast<std::ptrdiff_t>(s * shapes),
               next = static_cast<std::ptrdiff_t>((s + 1) * shapes);
    counts.visible.emplace_back(visible.begin() + row, visible.begin() + next);
    counts.blocked.emplace_back(blocked.begin() + row, blocked.begin() + next);
  }
  counts.escaped = escaped;
  counts.met_back = met_back;
  return counts;
}

}  // namespace twopass
