#include "radiosity/indirect_gathering.h"

#include "radiosity/specular_path.h"
#include "radiosity/weights_from_afar.h"
#include "render/core/warp.h"

namespace twopass {

namespace {

// Rays start in this part of the cells around a corner, next to it: at the corner itself, a neighbouring wall
// would be at distance zero.
constexpr float near_corner = 0.25f;
// Net irradiance along the surface weighs rays by the tangent of their angle; by no more than at this cosine.
constexpr float least_cosine = 0.1f;

}  // namespace

Gathered between(const Gathered& a, const Gathered& b, double t) {
  Gathered g;
  g.rays = std::min(a.rays, b.rays);
  const double n = g.rays;
  g.irradiance = (a.mean() * (1.0 - t) + b.mean() * t) * n;
  for (std::size_t axis = 0; axis < 3; ++axis)
    g.across[axis] = (a.mean_across(axis) * (1.0 - t) + b.mean_across(axis) * t) * n;
  g.brightness2 = brightness(g.mean()) * brightness(g.mean()) * n;
  if (g.rays > 0) g.inverse_distance = n * std::max(a.inverse_distance / a.rays, b.inverse_distance / b.rays);
  if (g.rays > 0) g.caustic = (a.caustic / a.rays * (1.0 - t) + b.caustic / b.rays * t) * n;
  return g;
}

Fans::Fans(std::span<const FieldCell> cells, std::size_t vertices) : first_(vertices + 1, 0) {
  for (const FieldCell& cell : cells)
    for (const std::uint32_t v : cell.corner) ++first_[v + 1];
  for (std::size_t v = 0; v < vertices; ++v) first_[v + 1] += first_[v];
  corner_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t c = 0; c < cells.size(); ++c)
    for (std::uint32_t k = 0; k < 3; ++k) corner_[next[cells[c].corner[k]]++] = {c, k};
}

Gathering::Gathering(const Scene& scene, const Solution& solution, const std::vector<V3d>& position,
                     const IndirectFieldOptions& options)
    : scene_(scene),
      mesh_(solution.mesh()),
      position_(position),
      options_(options),
      element_rays_(scene, mesh_),
      response_(scene, mesh_),
      radiosity_(mesh_.count()) {
  for (std::uint32_t i = 0; i < mesh_.count(); ++i)
    radiosity_[i] = C3d(mesh_.reflectance(i) * solution.irradiances()[i].total());
}

// pi times the radiance that the element where a ray has landed diffuses back along it: (R50) holds both ways.
C3d Gathering::diffused(const Ray& ray, const Landing& landing) const {
  const C3d& radiosity = radiosity_[landing.element];
  if (!landing.goes_on) return radiosity;
  const float cosine = std::abs(ray.direction.dot(landing.point.geometric_normal));
  return radiosity * response_.of(landing.element).at(static_cast<double>(cosine));
}

// Where rays start: on a face, out of the part of a triangle that lies near its first corner.
struct Gathering::Start {
  bool is_there;
  V3d corner, edge1, edge2, normal;
  float offset, size;
  Frame frame;
  const DiffuseResponse* response;
};

Gathering::Start Gathering::start(std::uint32_t face, const std::array<V3d, 3>& part, float reach) const {
  const Patch patch = mesh_.patch(face);
  return {can_gather_at(face),
          part[0],
          (part[1] - part[0]) * static_cast<double>(reach),
          (part[2] - part[0]) * static_cast<double>(reach),
          patch.normal,
          patch.offset,
          mesh_.size(face),
          Frame(V3f(patch.normal)),
          &response_.of(face)};
}

// Not on analytic surfaces, which turn away from under the rays' normal, and not where everything is buried.
bool Gathering::can_gather_at(std::uint32_t face) const {
  return !mesh_.is_analytic(mesh_.root(face).shape) && mesh_.area(face) > 0.0;
}

template <class AddRay>
Gathered Gathering::gather(double noise, double direct, std::uint32_t most_rays, const AddRay& add_ray) const {
  Gathered sum;
  std::uint32_t k = 0;
  for (std::uint32_t count = options_.least_rays; count <= most_rays; count *= 2) {
    for (; k < count; ++k) add_ray(k, sum);
    if (sum.noise() <= noise * (direct + brightness(sum.mean()))) break;
  }
  return sum;
}

Gathered Gathering::at(std::uint32_t vertex, std::span<const FieldCell> cells, const Fans& fans, double direct,
                       std::uint32_t most_rays, std::uint64_t& rays) const {
  std::vector<Start> starts;
  for (const auto& [cell, corner] : fans.of(vertex)) {
    const std::array<std::uint32_t, 3>& at = cells[cell].corner;
    starts.push_back(
        start(cells[cell].face,
              {position_[at[corner]], position_[at[(corner + 1) % 3]], position_[at[(corner + 2) % 3]]},
              near_corner));
  }
  if (starts.empty()) return {};
  const double noise = options_.noise * std::sqrt(static_cast<double>(options_.most_rays) / most_rays);
  return gather(noise, direct, most_rays, [&](std::uint32_t k, Gathered& sum) {
    Sampler sampler(options_.seed, vertex, k);
    add_ray(starts[k % starts.size()], sampler, sum, rays);
  });
}

Gathered Gathering::in_the_middle(const FieldCell& cell, std::uint32_t key, double direct,
                                  std::uint64_t& rays) const {
  std::array<V3d, 3> part = corners(cell);
  const V3d middle = (part[0] + part[1] + part[2]) / 3.0;
  for (V3d& corner : part) corner = (corner + middle) * 0.5;
  const Start from = start(cell.face, part, 1.0f);
  return gather(options_.noise, direct, options_.most_rays, [&](std::uint32_t k, Gathered& sum) {
    Sampler sampler(~options_.seed, key, k);
    add_ray(from, sampler, sum, rays);
  });
}

bool Gathering::is_crossed(const FieldCell& cell, std::uint64_t& rays) const {
  constexpr double inset = 0.1, height = 0.01;  // of the way to the middle; of the longest edge
  const std::array<V3d, 3> corner = corners(cell);
  const V3d middle = (corner[0] + corner[1] + corner[2]) / 3.0;
  double longest = 0.0;
  for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, (corner[(k + 1) % 3] - corner[k]).length());
  const Patch patch = mesh_.patch(cell.face);
  const V3d above = patch.normal * (height * longest + static_cast<double>(patch.offset));
  const auto inner = [&](std::size_t k) { return V3f(corner[k] + (middle - corner[k]) * inset + above); };
  for (std::size_t k = 0; k < 3; ++k) {
    rays += 2;
    if (scene_.caster().occluded(inner(k), inner((k + 1) % 3)) ||
        scene_.caster().occluded(inner(k), V3f(middle + above)))
      return true;
  }
  return false;
}

void Gathering::add_ray(const Start& from, Sampler& sampler, Gathered& sum, std::uint64_t& rays) const {
  if (!from.is_there) return;
  const V2f p = square_to_triangle(sampler.next_2d());
  const ElementPoint start{
      from.corner + from.edge1 * static_cast<double>(p.x) + from.edge2 * static_cast<double>(p.y), from.normal,
      from.offset};
  const V3f normal(from.normal);
  const Ray ray{start.ray_position(), from.frame.to_world(square_to_cosine_hemisphere(sampler.next_2d()))};
  const Landing landing = element_rays_.cast(ray, normal, from.size, sampler, rays);
  if (landing.kind == Landing::buried) {
    ++sum.buried;
    return;
  }
  ++sum.rays;
  if (landing.distance > 0.0f) sum.inverse_distance += 1.0 / static_cast<double>(landing.distance);
  C3d found(0.0);
  if (landing.kind == Landing::on_element) found = diffused(ray, landing);
  if (landing.goes_on) found += over_specular(ray, landing, sampler, sum.caustic, rays);
  const float cosine = ray.direction.dot(normal);
  found *= from.response->at(static_cast<double>(cosine));
  sum.irradiance += found;
  if (landing.kind == Landing::on_element && landing.distance < contact_elements * mesh_.size(landing.element))
    sum.nearby += found;
  const V3d along((ray.direction - normal * cosine) / std::max(cosine, least_cosine));
  for (std::size_t axis = 0; axis < 3; ++axis) sum.across[axis] += found * along[static_cast<int>(axis)];
  const double b = brightness(found);
  sum.brightness2 += b * b;
}

// pi times the radiance that elements send over mirrors, glass and glossy lobes; that of lamps into
// `caustic`, too, or, if they are left out, only what comes over other glossy lobes as well.
C3d Gathering::over_specular(const Ray& ray, const Landing& landing, Sampler& sampler, C3d& caustic,
                             std::uint64_t& rays) const {
  bool leaves_out = options_.without_caustics && landing.kind == Landing::on_specular;
  C3d found(0.0);
  SpecularPath path(scene_, ray, landing.point, Carried::radiance, sampler);
  while (leaves_out ? path.next() : path.next_with_lamps()) {
    const SpecularPathEnd& end = path.end();
    const C3f lamp =
        (end.escaped ? scene_.environment().radiance(end.direction) : scene_.emitted_radiance(end.point)) *
        end.lamp_weight;
    const C3d of_lamp =
        std::exchange(leaves_out, false) && !end.escaped ? C3d(0.0) : C3d(end.weight * lamp) * pi;
    if (!end.is_blurred) caustic += of_lamp;
    found += of_lamp;
    if (end.escaped) break;
    if (const std::uint32_t element = mesh_.find(end.point); element != no_index)
      found += C3d(end.weight) * radiosity_[element];
  }
  rays += path.rays();
  return found + C3d(path.sampled()) * pi;
}

}  // namespace twopass
