#include "radiosity/indirect_field.h"

#include <atomic>

#include "radiosity/landing.h"
#include "radiosity/smoothing.h"
#include "radiosity/specular_path.h"
#include "radiosity/vertex_mesh.h"
#include "render/core/interrupt.h"
#include "render/core/parallel.h"
#include "render/core/warp.h"

namespace twopass {

namespace {

// Rays start in this part of the elements around a corner, next to it: at the corner itself, a neighbouring
// wall would be at distance zero.
constexpr float near_corner = 0.25f;
// Faces with less of their area exposed than this reach under something.
constexpr double whole = 0.999;
// Corners that differ by more than this factor have an edge of light or a wall between them.
constexpr float most_contrast = 2.0f;

double brightness(const C3d& c) { return std::max(std::max(c.x, c.y), c.z); }

// What the rays from one corner found: sums over those that did not start buried.
struct Gathered {
  std::uint32_t rays = 0;
  C3d irradiance{0.0};
  double brightness2 = 0.0;       // squared brightness of each ray
  double inverse_distance = 0.0;  // of what they met
  bool sees_caustic = false;      // light came over specular surfaces straight from a lamp

  [[nodiscard]] C3d mean() const { return rays == 0 ? C3d(0.0) : irradiance / static_cast<double>(rays); }
  // Standard error of the mean's brightness, as if the rays were independent: stratified ones are better.
  [[nodiscard]] double noise() const {
    if (rays == 0) return 0.0;
    const double n = rays, b = brightness(mean());
    return std::sqrt(std::max(0.0, brightness2 / n - b * b) / n);
  }
};

// The cells around each vertex.
struct Fans {
  std::vector<std::uint32_t> first;                                  // by vertex, and the end
  std::vector<std::pair<std::uint32_t, std::uint32_t>> corner;  // face and which of its corners

  Fans(const VertexMesh& vertices) : first(vertices.count() + 1, 0) {
    const VertexMesh::Faces& faces = vertices.faces();
    for (std::size_t f = 0; f < faces.cells; ++f)
      for (const std::uint32_t v : faces.corner[f]) ++first[v + 1];
    for (std::size_t v = 0; v < vertices.count(); ++v) first[v + 1] += first[v];
    corner.resize(first.back());
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (std::uint32_t f = 0; f < faces.cells; ++f)
      for (std::uint32_t k = 0; k < 3; ++k) corner[next[faces.corner[f][k]]++] = {f, k};
  }
  [[nodiscard]] std::span<const std::pair<std::uint32_t, std::uint32_t>> of(std::uint32_t vertex) const {
    return {corner.data() + first[vertex], corner.data() + first[vertex + 1]};
  }
};

class Gathering {
 public:
  Gathering(const Scene& scene, const Solution& solution, const VertexMesh& vertices)
      : scene_(scene),
        mesh_(solution.mesh()),
        vertices_(vertices),
        fans_(vertices),
        element_rays_(scene, mesh_),
        radiosity_(mesh_.count()) {
    for (std::uint32_t i = 0; i < mesh_.count(); ++i)
      radiosity_[i] = C3d(mesh_.reflectance(i) * solution.irradiances()[i].total());
  }

  // (R39): rays from the corner until their noise is small against all the light there, of which `direct` is
  // known.
  [[nodiscard]] Gathered at(std::uint32_t vertex, double direct, const IndirectFieldOptions& options,
                            std::uint64_t& rays) const {
    Gathered sum;
    const auto fan = fans_.of(vertex);
    if (fan.empty()) return sum;
    std::uint32_t k = 0;
    for (std::uint32_t count = options.least_rays; count <= options.most_rays; count *= 2) {
      for (; k < count; ++k) {
        const auto& [face, corner] = fan[k % fan.size()];
        Sampler sampler(options.seed, vertex, k);
        if (can_gather_at(face)) add_ray(face, corner, sampler, sum, rays);
      }
      if (sum.noise() <= options.noise * (direct + brightness(sum.mean()))) break;
    }
    return sum;
  }

 private:
  // Not on analytic surfaces, which turn away from under the rays' normal, and not where everything is buried.
  [[nodiscard]] bool can_gather_at(std::uint32_t face) const {
    return !mesh_.is_analytic(mesh_.root(face).shape) && mesh_.area(face) > 0.0;
  }
  void add_ray(std::uint32_t face, std::uint32_t corner, Sampler& sampler, Gathered& sum,
               std::uint64_t& rays) const {
    const Patch patch = mesh_.patch(face);
    const std::array<std::uint32_t, 3>& at = vertices_.faces().corner[face];
    const V3d here(vertices_.position(at[corner])), next(vertices_.position(at[(corner + 1) % 3])),
        last(vertices_.position(at[(corner + 2) % 3]));
    const V2f p = square_to_triangle(sampler.next_2d()) * near_corner;
    const ElementPoint start{here + (next - here) * static_cast<double>(p.x) + (last - here) * static_cast<double>(p.y),
                             patch.normal, patch.offset};
    const V3f normal(patch.normal);
    const Ray ray{start.ray_position(),
                  Frame(normal).to_world(square_to_cosine_hemisphere(sampler.next_2d()))};
    const Landing landing = element_rays_.cast(ray, normal, mesh_.size(face), sampler, rays);
    if (landing.kind == Landing::buried) return;
    ++sum.rays;
    if (landing.distance > 0.0f) sum.inverse_distance += 1.0 / static_cast<double>(landing.distance);
    C3d found(0.0);
    if (landing.kind == Landing::on_element) found = radiosity_[landing.element];
    if (landing.kind == Landing::on_specular) {
      const SpecularPathEnd end = follow_specular(scene_, ray, landing.point, Carried::radiance, sampler);
      rays += end.rays;
      if (is_black(end.weight)) return;
      const C3f lamp = end.escaped ? scene_.environment().radiance(end.direction) : scene_.emitted_radiance(end.point);
      sum.sees_caustic = sum.sees_caustic || !is_black(end.weight * lamp);
      const std::uint32_t element = end.escaped ? no_index : mesh_.find(end.point);
      if (element != no_index) found = C3d(end.weight) * radiosity_[element];
    }
    sum.irradiance += found;
    const double b = brightness(found);
    sum.brightness2 += b * b;
  }

  const Scene& scene_;
  const ElementMesh& mesh_;
  const VertexMesh& vertices_;
  Fans fans_;
  ElementRays element_rays_;
  std::vector<C3d> radiosity_;  // reflected, by element
};

// (R40): the error that a look-up on the face may have, relative to all the light there. `smooth`: at the
// vertices.
double error_of(const ElementMesh& mesh, std::uint32_t face, const VertexMesh& vertices,
                std::span<const Gathered> gathered, std::span<const Irradiance> smooth) {
  constexpr double no_trust = std::numeric_limits<double>::infinity();
  if (mesh.area(face) < whole * mesh.whole_area(face)) return no_trust;
  const std::array<std::uint32_t, 3>& at = vertices.faces().corner[face];
  double longest = 0.0, nearness = 0.0, noise = 0.0, low = no_trust, high = 0.0, direct = no_trust;
  for (std::size_t k = 0; k < 3; ++k) {
    const Gathered& g = gathered[at[k]];
    if (g.rays == 0 || g.sees_caustic) return no_trust;
    const V3d edge = V3d(vertices.position(at[(k + 1) % 3])) - V3d(vertices.position(at[k]));
    longest = std::max(longest, edge.length());
    nearness = std::max(nearness, g.inverse_distance / g.rays);
    noise = std::max(noise, g.noise());
    low = std::min(low, brightness(g.mean()));
    high = std::max(high, brightness(g.mean()));
    direct = std::min(direct, brightness(C3d(smooth[at[k]].direct)));
  }
  if (high > most_contrast * low) return no_trust;
  if (high == 0.0) return 0.0;
  const double bend = longest * nearness;
  return (high * bend * bend / 8.0 + noise) / (direct + low);
}

// What a hanging vertex has: as much of two others as the larger element interpolates there.
Gathered between(const Gathered& a, const Gathered& b, double t) {
  Gathered g;
  g.rays = std::min(a.rays, b.rays);
  const double n = g.rays;
  g.irradiance = (a.mean() * (1.0 - t) + b.mean() * t) * n;
  g.brightness2 = brightness(g.mean()) * brightness(g.mean()) * n;
  if (g.rays > 0) g.inverse_distance = n * std::max(a.inverse_distance / a.rays, b.inverse_distance / b.rays);
  g.sees_caustic = a.sees_caustic || b.sees_caustic;
  return g;
}

}  // namespace

IndirectField::IndirectField(const Scene& scene, const Solution& solution, const IndirectFieldOptions& options)
    : mesh_(&solution.mesh()) {
  const VertexMesh vertices(*mesh_);
  const std::vector<Irradiance> smooth = vertex_irradiance(vertices, *mesh_, solution.irradiances());
  const Gathering gathering(scene, solution, vertices);
  std::vector<Gathered> gathered(vertices.count());
  std::vector<std::uint8_t> hangs(vertices.count(), 0);
  for (const VertexMesh::Hanging& h : vertices.hanging()) hangs[h.vertex] = 1;
  std::atomic<std::uint64_t> rays{0};
  parallel_for(vertices.count(), 16, [&](std::size_t begin, std::size_t end) {
    throw_if_interrupted();
    std::uint64_t cast = 0;
    for (auto v = static_cast<std::uint32_t>(begin); v < end; ++v)
      if (!hangs[v]) gathered[v] = gathering.at(v, brightness(C3d(smooth[v].direct)), options, cast);
    rays += cast;
  });
  rays_ = rays;
  for (const VertexMesh::Hanging& h : vertices.hanging())
    gathered[h.vertex] = between(gathered[h.from], gathered[h.to], static_cast<double>(h.t));

  const auto faces = static_cast<std::uint32_t>(vertices.faces().cells);
  value_.resize(faces);
  trusted_.resize(faces);
  double area = 0.0, trusted_area = 0.0;
  for (std::uint32_t f = 0; f < mesh_->count(); ++f) area += mesh_->area(f);
  for (std::uint32_t f = 0; f < faces; ++f) {
    const std::array<std::uint32_t, 3>& corner = vertices.faces().corner[f];
    for (std::size_t k = 0; k < 3; ++k) value_[f][k] = C3f(gathered[corner[k]].mean());
    trusted_[f] = error_of(*mesh_, f, vertices, gathered, smooth) <= options.tolerance;
    if (trusted_[f]) trusted_area += mesh_->area(f);
  }
  trusted_share_ = area > 0.0 ? trusted_area / area : 0.0;
}

}  // namespace twopass
