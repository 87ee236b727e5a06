#include "radiosity/indirect_field.h"

#include <algorithm>
#include <atomic>
#include <optional>
#include <utility>

#include "radiosity/lamp_light.h"
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
  C3d caustic{0.0};               // of the irradiance: light straight from lamps over specular surfaces

  // Rays find caustics by chance: what is more than a trace of them is left to gather rays, which are many.
  [[nodiscard]] bool sees_caustic(double direct) const {
    constexpr double trace = 0.02;
    return brightness(caustic) > trace * (direct * rays + brightness(irradiance));
  }
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
  std::vector<std::uint32_t> first;                             // by vertex, and the end
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
    const auto fan = fans_.of(vertex);
    if (fan.empty()) return {};
    std::vector<Start> starts;
    for (const auto& [face, corner] : fan) {
      const std::array<std::uint32_t, 3>& at = vertices_.faces().corner[face];
      starts.push_back(
          start(face, {position(at[corner]), position(at[(corner + 1) % 3]), position(at[(corner + 2) % 3])},
                near_corner));
    }
    return gather(direct, options, [&](std::uint32_t k, Gathered& sum) {
      Sampler sampler(options.seed, vertex, k);
      add_ray(starts[k % starts.size()], options, sampler, sum, rays);
    });
  }

  // The same from the inner quarter of a face: of what is linear on it, the mean over its corners.
  [[nodiscard]] Gathered in_the_middle(std::uint32_t face, double direct, const IndirectFieldOptions& options,
                                       std::uint64_t& rays) const {
    const std::array<std::uint32_t, 3>& at = vertices_.faces().corner[face];
    std::array<V3d, 3> part{position(at[0]), position(at[1]), position(at[2])};
    const V3d middle = (part[0] + part[1] + part[2]) / 3.0;
    for (V3d& corner : part) corner = (corner + middle) * 0.5;
    const Start from = start(face, part, 1.0f);
    return gather(direct, options, [&](std::uint32_t k, Gathered& sum) {
      Sampler sampler(~options.seed, face, k);
      add_ray(from, options, sampler, sum, rays);
    });
  }

  // Whether something stands across the face, a wall between its corners: then light is different on both
  // sides, however alike it is at the corners.
  [[nodiscard]] bool is_crossed(std::uint32_t face, std::uint64_t& rays) const {
    constexpr double inset = 0.1, height = 0.01;  // of the way to the middle; of the longest edge
    const std::array<std::uint32_t, 3>& at = vertices_.faces().corner[face];
    const std::array<V3d, 3> corner{position(at[0]), position(at[1]), position(at[2])};
    const V3d middle = (corner[0] + corner[1] + corner[2]) / 3.0;
    double longest = 0.0;
    for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, (corner[(k + 1) % 3] - corner[k]).length());
    const Patch patch = mesh_.patch(face);
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

 private:
  // Not on analytic surfaces, which turn away from under the rays' normal, and not where everything is buried.
  [[nodiscard]] bool can_gather_at(std::uint32_t face) const {
    return !mesh_.is_analytic(mesh_.root(face).shape) && mesh_.area(face) > 0.0;
  }
  [[nodiscard]] V3d position(std::uint32_t vertex) const { return V3d(vertices_.position(vertex)); }

  template <class AddRay>
  [[nodiscard]] static Gathered gather(double direct, const IndirectFieldOptions& options,
                                       const AddRay& add_ray) {
    Gathered sum;
    std::uint32_t k = 0;
    for (std::uint32_t count = options.least_rays; count <= options.most_rays; count *= 2) {
      for (; k < count; ++k) add_ray(k, sum);
      if (sum.noise() <= options.noise * (direct + brightness(sum.mean()))) break;
    }
    return sum;
  }

  // Where rays start: on a face, out of the part of a triangle that lies near its first corner.
  struct Start {
    bool is_there;
    V3d corner, edge1, edge2, normal;
    float offset, size;
    Frame frame;
  };
  [[nodiscard]] Start start(std::uint32_t face, const std::array<V3d, 3>& part, float reach) const {
    const Patch patch = mesh_.patch(face);
    return {can_gather_at(face),
            part[0],
            (part[1] - part[0]) * static_cast<double>(reach),
            (part[2] - part[0]) * static_cast<double>(reach),
            patch.normal,
            patch.offset,
            mesh_.size(face),
            Frame(V3f(patch.normal))};
  }

  void add_ray(const Start& from, const IndirectFieldOptions& options, Sampler& sampler, Gathered& sum,
               std::uint64_t& rays) const {
    if (!from.is_there) return;
    const V2f p = square_to_triangle(sampler.next_2d());
    const ElementPoint start{
        from.corner + from.edge1 * static_cast<double>(p.x) + from.edge2 * static_cast<double>(p.y),
        from.normal, from.offset};
    const V3f normal(from.normal);
    const Ray ray{start.ray_position(), from.frame.to_world(square_to_cosine_hemisphere(sampler.next_2d()))};
    const Landing landing = element_rays_.cast(ray, normal, from.size, sampler, rays);
    if (landing.kind == Landing::buried) return;
    ++sum.rays;
    if (landing.distance > 0.0f) sum.inverse_distance += 1.0 / static_cast<double>(landing.distance);
    C3d found(0.0);
    if (landing.kind == Landing::on_element) found = radiosity_[landing.element];
    if (landing.goes_on) found += over_specular(ray, landing, options.without_caustics, sampler, sum.caustic, rays);
    sum.irradiance += found;
    const double b = brightness(found);
    sum.brightness2 += b * b;
  }

  // pi times the radiance that elements send over mirrors, glass and glossy lobes; that of lamps into
  // `caustic`, too, or, if they are left out, only what comes over other glossy lobes as well.
  [[nodiscard]] C3d over_specular(const Ray& ray, const Landing& landing, bool leaves_out, Sampler& sampler,
                                  C3d& caustic, std::uint64_t& rays) const {
    C3d found(0.0);
    SpecularPath path(scene_, ray, landing.point, Carried::radiance, sampler);
    leaves_out = leaves_out && landing.kind == Landing::on_specular;
    while (leaves_out ? path.next() : path.next_with_lamps()) {
      const SpecularPathEnd& end = path.end();
      const C3f lamp = (end.escaped ? scene_.environment().radiance(end.direction)
                                    : scene_.emitted_radiance(end.point)) *
                       end.lamp_weight;
      const C3d of_lamp = std::exchange(leaves_out, false) && !end.escaped ? C3d(0.0) : C3d(end.weight * lamp) * pi;
      caustic += of_lamp;
      found += of_lamp;
      if (end.escaped) break;
      if (const std::uint32_t element = mesh_.find(end.point); element != no_index)
        found += C3d(end.weight) * radiosity_[element];
    }
    rays += path.rays();
    return found + C3d(path.sampled()) * pi;
  }

  const Scene& scene_;
  const ElementMesh& mesh_;
  const VertexMesh& vertices_;
  Fans fans_;
  ElementRays element_rays_;
  std::vector<C3d> radiosity_;  // reflected, by element
};

// The vertices that see a caustic, and those that share a face with one: rays find caustics by chance, so that
// some vertices in the midst of one miss it.
std::vector<bool> near_caustics(const VertexMesh& vertices, std::span<const Gathered> gathered,
                                std::span<const Irradiance> smooth) {
  std::vector<bool> sees(vertices.count()), near(vertices.count());
  for (std::size_t v = 0; v < sees.size(); ++v)
    sees[v] = gathered[v].sees_caustic(brightness(C3d(smooth[v].direct)));
  const VertexMesh::Faces& faces = vertices.faces();
  for (std::size_t f = 0; f < faces.cells; ++f)
    if (std::ranges::any_of(faces.corner[f], [&](std::uint32_t v) { return sees[v]; }))
      for (const std::uint32_t v : faces.corner[f]) near[v] = true;
  return near;
}

// (R40): the error that a look-up on the face may have, relative to all the light there, of which
// `least_direct` is direct; infinite where linear interpolation is out of the question. `smooth`: at the
// vertices, as `near_caustic`.
struct Doubt {
  double error, least_direct;
};
Doubt doubt_of(const ElementMesh& mesh, std::uint32_t face, const VertexMesh& vertices,
               std::span<const Gathered> gathered, std::span<const Irradiance> smooth,
               const std::vector<bool>& near_caustic) {
  constexpr double no_trust = std::numeric_limits<double>::infinity();
  constexpr Doubt never{no_trust, 0.0};
  if (mesh.area(face) < whole * mesh.whole_area(face)) return never;
  const std::array<std::uint32_t, 3>& at = vertices.faces().corner[face];
  double longest = 0.0, nearness = 0.0, noise = 0.0, low = no_trust, high = 0.0, direct = no_trust;
  for (std::size_t k = 0; k < 3; ++k) {
    const Gathered& g = gathered[at[k]];
    if (g.rays == 0 || near_caustic[at[k]]) return never;
    const V3d edge = V3d(vertices.position(at[(k + 1) % 3])) - V3d(vertices.position(at[k]));
    longest = std::max(longest, edge.length());
    nearness = std::max(nearness, g.inverse_distance / g.rays);
    noise = std::max(noise, g.noise());
    low = std::min(low, brightness(g.mean()));
    high = std::max(high, brightness(g.mean()));
    direct = std::min(direct, brightness(C3d(smooth[at[k]].direct)));
  }
  if (high > most_contrast * low) return never;
  if (high == 0.0) return {0.0, direct};
  const double bend = longest * nearness;
  return {(high * bend * bend / 8.0 + noise) / (direct + low), direct};
}

using Corners = std::array<C3f, 3>;
bool is_black(const Corners& corners) {
  return std::all_of(corners.begin(), corners.end(), [](const C3f& c) { return twopass::is_black(c); });
}

// (R43): what the lamps send to the corners of a flat patch, if that is certain and linear in between but for
// the given part of all the light. `indirect`: at the corners.
// `corner`: in the order of the face's cell, which is not that of a patch of a back.
std::optional<Corners> direct_of(const Patch& patch, const std::array<V3d, 3>& corner, const LampLight& lamps,
                                 const Corners& indirect, double tolerance) {
  if (patch.is_analytic() || !(patch.area > 0.0)) return std::nullopt;
  const auto seen = lamps.seen_from(patch.polygon());
  if (!seen) return std::nullopt;
  std::array<C3d, 3> at;
  for (std::size_t k = 0; k < 3; ++k) at[k] = lamps.irradiance(corner[k], patch.normal, *seen);
  const auto is_linear_at = [&](const V3d& weight) {
    V3d point(0.0);
    C3d linear(0.0), others(0.0);
    for (std::size_t k = 0; k < 3; ++k) {
      const double w = weight[static_cast<int>(k)];
      point += corner[k] * w;
      linear += at[k] * w;
      others += C3d(indirect[k]) * w;
    }
    const C3d truth = lamps.irradiance(point, patch.normal, *seen);
    return brightness(C3d(std::abs(linear.x - truth.x), std::abs(linear.y - truth.y),
                          std::abs(linear.z - truth.z))) <= tolerance * brightness(truth + others);
  };
  const V3d middles[] = {V3d(0.5, 0.5, 0), V3d(0, 0.5, 0.5), V3d(0.5, 0, 0.5), V3d(1.0 / 3.0)};
  if (*seen != 0 && !std::all_of(std::begin(middles), std::end(middles), is_linear_at)) return std::nullopt;
  return Corners{C3f(at[0]), C3f(at[1]), C3f(at[2])};
}

// What a hanging vertex has: as much of two others as the larger element interpolates there.
Gathered between(const Gathered& a, const Gathered& b, double t) {
  Gathered g;
  g.rays = std::min(a.rays, b.rays);
  const double n = g.rays;
  g.irradiance = (a.mean() * (1.0 - t) + b.mean() * t) * n;
  g.brightness2 = brightness(g.mean()) * brightness(g.mean()) * n;
  if (g.rays > 0) g.inverse_distance = n * std::max(a.inverse_distance / a.rays, b.inverse_distance / b.rays);
  if (g.rays > 0) g.caustic = (a.caustic / a.rays * (1.0 - t) + b.caustic / b.rays * t) * n;
  return g;
}

}  // namespace

IndirectField::IndirectField(const Scene& scene, const Solution& solution, const IndirectFieldOptions& options)
    : mesh_(&solution.mesh()) {
  const VertexMesh vertices(*mesh_);
  const std::vector<Irradiance> smooth = vertex_irradiance(vertices, *mesh_, solution.irradiances());
  const Gathering gathering(scene, solution, vertices);
  std::vector<Gathered> gathered(vertices.count());
  const auto faces = static_cast<std::uint32_t>(vertices.faces().cells);
  const auto is_wanted = [&](std::uint32_t face) { return options.wanted.empty() || options.wanted[face]; };
  // Which vertices are gathered at: the corners of wanted faces, and in place of those that hang their ends.
  std::vector<std::uint8_t> gathers(vertices.count(), 0), hangs(vertices.count(), 0);
  for (std::uint32_t f = 0; f < faces; ++f)
    if (is_wanted(f))
      for (const std::uint32_t v : vertices.faces().corner[f]) gathers[v] = 1;
  for (auto h = vertices.hanging().rbegin(); h != vertices.hanging().rend(); ++h) {
    hangs[h->vertex] = 1;
    if (gathers[h->vertex]) gathers[h->from] = gathers[h->to] = 1;
  }
  std::atomic<std::uint64_t> rays{0};
  parallel_for(vertices.count(), 16, [&](std::size_t begin, std::size_t end) {
    throw_if_interrupted();
    std::uint64_t cast = 0;
    for (auto v = static_cast<std::uint32_t>(begin); v < end; ++v)
      if (gathers[v] && !hangs[v])
        gathered[v] = gathering.at(v, brightness(C3d(smooth[v].direct)), options, cast);
    rays += cast;
  });
  for (const VertexMesh::Hanging& h : vertices.hanging())
    if (gathers[h.vertex])
      gathered[h.vertex] = between(gathered[h.from], gathered[h.to], static_cast<double>(h.t));

  const std::vector<bool> near_caustic = near_caustics(vertices, gathered, smooth);
  const LampLight lamps(scene);
  value_.resize(faces);
  direct_.resize(faces, Corners{C3f(0.0f), C3f(0.0f), C3f(0.0f)});
  known_.resize(faces, Known::nothing);
  // What (R40) doubts is looked at: its distances are those from corners, where walls that meet are always
  // near.
  const auto is_trusted = [&](std::uint32_t f, std::uint64_t& cast) {
    if (gathering.is_crossed(f, cast)) return false;
    const Doubt doubt = doubt_of(*mesh_, f, vertices, gathered, smooth, near_caustic);
    if (doubt.error <= options.tolerance) return true;
    if (!std::isfinite(doubt.error)) return false;
    const Gathered middle = gathering.in_the_middle(f, doubt.least_direct, options, cast);
    if (middle.rays == 0 || middle.sees_caustic(doubt.least_direct)) return false;
    C3d linear(0.0);
    for (const std::uint32_t v : vertices.faces().corner[f]) linear += gathered[v].mean() / 3.0;
    const C3d found = middle.mean(), off = linear - found;
    return brightness(C3d(std::abs(off.x), std::abs(off.y), std::abs(off.z))) <=
           options.middle_tolerance * (doubt.least_direct + brightness(found));
  };
  parallel_for(faces, 64, [&](std::size_t begin, std::size_t end) {
    throw_if_interrupted();
    std::uint64_t cast = 0;
    for (auto f = static_cast<std::uint32_t>(begin); f < end; ++f) {
      if (!is_wanted(f)) continue;
      const std::array<std::uint32_t, 3>& corner = vertices.faces().corner[f];
      for (std::size_t k = 0; k < 3; ++k) value_[f][k] = C3f(gathered[corner[k]].mean());
      const bool trusted = is_trusted(f, cast);
      const std::array<V3d, 3> at{V3d(vertices.position(corner[0])), V3d(vertices.position(corner[1])),
                                  V3d(vertices.position(corner[2]))};
      const auto direct = options.with_direct && lamps.is_known()
                              ? direct_of(mesh_->patch(f), at, lamps, value_[f], options.direct_tolerance)
                              : std::nullopt;
      if (trusted) known_[f] = direct ? Known::all : Known::indirect;
      if (!trusted && direct && is_black(*direct)) known_[f] = Known::no_direct;
      if (!trusted || !direct) continue;
      direct_[f] = *direct;
      for (std::size_t k = 0; k < 3; ++k) value_[f][k] += (*direct)[k];
    }
    rays += cast;
  });
  rays_ = rays;
  double area = 0.0;
  for (std::uint32_t f = 0; f < mesh_->count(); ++f) area += mesh_->area(f);
  for (std::uint32_t f = 0; f < faces && area > 0.0; ++f)
    for (int k = 0; k <= static_cast<int>(known_[f]); ++k)
      share_[static_cast<std::size_t>(k)] += mesh_->area(f) / area;
}

C3f IndirectField::direct_at(const ElementMesh::Location& location) const {
  return location.element < direct_.size() ? interpolated(direct_[location.element], location) : C3f(0.0f);
}

C3f IndirectField::indirect_at_any(const SurfacePoint& point) const {
  const ElementMesh::Location location = mesh_->locate(point);
  return location.element < value_.size() ? interpolated(value_[location.element], location) : C3f(0.0f);
}

}  // namespace twopass
