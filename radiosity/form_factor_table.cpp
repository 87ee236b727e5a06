#include "radiosity/form_factor_table.h"

#include "radiosity/enforce.h"
#include "radiosity/form_factor_pair.h"
#include "radiosity/visibility.h"
#include "render/core/distribution.h"
#include "render/core/error.h"
#include "render/core/parallel.h"
#include "render/core/sampler.h"
#include "render/core/warp.h"

namespace twopass {

namespace {

constexpr std::size_t most_triangles_exact = 2048;      // their pairs take minutes
constexpr std::size_t most_triangles_automatic = 1024;  // and these seconds

using Table = std::vector<std::vector<double>>;

// The fronts of all shapes, in pieces.
struct Fronts {
  std::vector<Patch> patch;
  std::vector<std::uint32_t> shape;  // of each patch
  std::vector<double> area;          // of each shape
  bool has_spheres = false;
};

Fronts collect_fronts(const Scene& scene) {
  Fronts fronts;
  for (std::uint32_t s = 0; s < scene.shapes().size(); ++s) {
    const std::size_t first = fronts.patch.size();
    if (const auto* mesh = std::get_if<Mesh>(&scene.shapes()[s].geometry)) {
      for (std::uint32_t i = 0; i < mesh->triangles.size(); ++i) {
        const Patch patch = triangle_patch(*mesh, i, front);
        if (patch.area > 0.0) fronts.patch.push_back(patch);
      }
    } else {
      fronts.has_spheres = true;
      for (std::uint32_t octant = 0; octant < 8; ++octant)
        fronts.patch.push_back(
            spherical_patch(std::get<Sphere>(scene.shapes()[s].geometry), octant_corners(octant), front));
    }
    double area = 0.0;
    for (std::size_t i = first; i < fronts.patch.size(); ++i) area += fronts.patch[i].area;
    fronts.area.push_back(area);
    fronts.shape.resize(fronts.patch.size(), s);
  }
  return fronts;
}

std::array<Patch, 4> quarters(const Patch& whole) {
  const auto& c = whole.corner;
  const V3d m01 = (c[0] + c[1]) * 0.5, m12 = (c[1] + c[2]) * 0.5, m20 = (c[2] + c[0]) * 0.5;
  std::array<Patch, 4> part{whole, whole, whole, whole};
  part[0].corner = {c[0], m01, m20};
  part[1].corner = {m01, c[1], m12};
  part[2].corner = {m20, m12, c[2]};
  part[3].corner = {m12, m20, m01};
  for (Patch& p : part) p.area = 0.25 * whole.area;
  return part;
}

// The exchange between two triangles, divided where they partly hide from each other.
class VisibleExchange {
 public:
  // `probes`: pairs of points that must agree before two whole triangles count as fully visible or hidden.
  VisibleExchange(const RayCaster& caster, std::uint32_t probes) : caster_(caster), probes_(probes) {}

  [[nodiscard]] double operator()(const Patch& a, const Patch& b, std::uint32_t key, int depth = 0) const {
    constexpr int most_divisions = 6;
    // Parts need fewer digits than the whole: visibility is the larger error then.
    const double unoccluded = exchange_exact(a.polygon(), b.polygon(), depth == 0 ? 1e-10 : 1e-6);
    if (!(unoccluded > 0.0)) return 0.0;
    std::uint64_t rays = 0;
    const std::uint32_t probes = std::max(16u, probes_ >> (2 * depth));
    const double fraction = visible_fraction(caster_, a, b, key, probes, rays);
    if (fraction == 0.0 || fraction == 1.0 || depth == most_divisions) return unoccluded * fraction;
    double sum = 0.0;
    const bool divide_a = a.area >= b.area;
    std::uint32_t part_key = key;
    for (const Patch& part : quarters(divide_a ? a : b)) {
      part_key = hash_words(part_key, 1);
      sum += divide_a ? (*this)(part, b, part_key, depth + 1) : (*this)(a, part, part_key, depth + 1);
    }
    return sum;
  }

 private:
  const RayCaster& caster_;
  std::uint32_t probes_;
};

double exchange_of_pair(const Patch& a, const Patch& b, const FormFactorOptions& options,
                        const VisibleExchange& visible, const RayCaster& caster, std::uint32_t key) {
  const bool exact = options.method == FormFactorMethod::exact;
  if (exact && options.occlusion) return visible(a, b, key);
  const Polygon pa = a.polygon(), pb = b.polygon();
  if (exact) return exchange_exact(pa, pb, 1e-10);
  const double unoccluded = 0.5 * (exchange_point(pa, pb) + exchange_point(pb, pa));
  std::uint64_t rays = 0;
  if (!(unoccluded > 0.0) || !options.occlusion) return unoccluded;
  return unoccluded * visible_fraction(caster, a, b, key, 64, rays);
}

Table analytic_exchanges(const Scene& scene, const Fronts& fronts, const FormFactorOptions& options) {
  const std::size_t shapes = fronts.area.size(), patches = fronts.patch.size();
  const VisibleExchange visible(scene.caster(), patches <= 256 ? 1024 : 64);
  // What each patch exchanges with each shape: written by one thread each, added up in order.
  Table by_patch(patches, std::vector<double>(shapes, 0.0));
  parallel_for(patches, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t j = i + 1; j < patches; ++j) {
        const std::uint32_t key =
            hash_words(hash_words(options.seed, static_cast<std::uint32_t>(i)), static_cast<std::uint32_t>(j));
        by_patch[i][fronts.shape[j]] +=
            exchange_of_pair(fronts.patch[i], fronts.patch[j], options, visible, scene.caster(), key);
      }
  });
  Table exchange(shapes, std::vector<double>(shapes, 0.0));
  for (std::size_t i = 0; i < patches; ++i)
    for (std::size_t s = 0; s < shapes; ++s) {
      const std::uint32_t own = fronts.shape[i];
      exchange[own][s] += by_patch[i][s];
      exchange[s][own] += by_patch[i][s];  // for s == own both ways are in one entry
    }
  return exchange;
}

// Counts of the fronts that the rays of a shape land on.
std::vector<std::uint64_t> cast_from_shape(const Scene& scene, const Fronts& fronts, std::uint32_t s,
                                           std::uint32_t rays, std::uint32_t seed) {
  std::vector<std::uint64_t> landed(fronts.area.size(), 0);
  const auto first = std::lower_bound(fronts.shape.begin(), fronts.shape.end(), s) - fronts.shape.begin();
  const auto last = std::upper_bound(fronts.shape.begin(), fronts.shape.end(), s) - fronts.shape.begin();
  std::vector<double> area;
  for (auto i = first; i < last; ++i) area.push_back(fronts.patch[static_cast<std::size_t>(i)].area);
  const DiscreteDistribution choice(area);
  if (choice.empty()) return landed;
  for (std::uint32_t k = 0; k < rays; ++k) {
    Sampler sampler(seed, s, k);
    const V2f u = sampler.next_2d();
    const auto chosen = choice.sample(u.x);
    const Patch& patch = fronts.patch[static_cast<std::size_t>(first) + chosen.index];
    const ElementPoint start = patch.sample({chosen.remapped, u.y});
    const V3f direction = Frame(V3f(start.normal)).to_world(square_to_cosine_hemisphere(sampler.next_2d()));
    const Ray ray{start.ray_position(), direction};
    const Hit hit = scene.caster().intersect(ray);
    if (!hit.escaped() && scene.surface_point(ray, hit).side == front) ++landed[hit.shape];
  }
  return landed;
}

Table ray_exchanges(const Scene& scene, const Fronts& fronts, std::uint32_t rays, std::uint32_t seed) {
  const std::size_t shapes = fronts.area.size();
  std::vector<std::vector<std::uint64_t>> landed(shapes);
  parallel_for(shapes, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s)
      landed[s] = cast_from_shape(scene, fronts, static_cast<std::uint32_t>(s), rays, seed);
  });
  // Both ways together (R13), then scaled to what each shape's own rays say of its sum (R14).
  ExchangeMatrix exchange(static_cast<Eigen::Index>(shapes), static_cast<Eigen::Index>(shapes));
  std::vector<double> target(shapes), fixed(shapes, 0.0);
  for (std::size_t i = 0; i < shapes; ++i) {
    for (std::size_t j = 0; j < shapes; ++j) {
      const double hits = static_cast<double>(landed[i][j] + landed[j][i]);
      const double area = fronts.area[i] * fronts.area[j] / (fronts.area[i] + fronts.area[j]);
      target[i] += fronts.area[i] * static_cast<double>(landed[i][j]) / rays;
      if (hits > 0.0)
        exchange.insert(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
            static_cast<float>(area * hits / rays);
    }
  }
  scale_to_row_sums(exchange, fixed, target, fronts.area, 1e-6);
  Table table(shapes, std::vector<double>(shapes, 0.0));
  for (std::size_t i = 0; i < shapes; ++i)
    for (ExchangeMatrix::InnerIterator it(exchange, static_cast<Eigen::Index>(i)); it; ++it)
      table[i][static_cast<std::size_t>(it.col())] = static_cast<double>(it.value());
  return table;
}

FormFactorMethod choose_method(const Fronts& fronts, const FormFactorOptions& options) {
  const bool analytic_possible = !fronts.has_spheres && fronts.patch.size() <= most_triangles_exact;
  switch (options.method) {
    case FormFactorMethod::automatic:
      if (!options.occlusion) break;
      return analytic_possible && fronts.patch.size() <= most_triangles_automatic ? FormFactorMethod::exact
                                                                                  : FormFactorMethod::rays;
    case FormFactorMethod::rays:
      if (!options.occlusion)
        throw Error("form factors", "rays cannot ignore obstacles", "use --method exact or point");
      return FormFactorMethod::rays;
    case FormFactorMethod::hemicube:
      throw Error("form factors", "hemicubes see from elements, and whole shapes are not divided into any",
                  "use --method exact, point or rays");
    case FormFactorMethod::exact:
    case FormFactorMethod::point:
      break;
  }
  if (!analytic_possible)
    throw Error("form factors",
                fronts.has_spheres ? "analytic form factors are known for triangles, and the scene has spheres"
                                   : std::to_string(fronts.patch.size()) + " triangles have too many pairs",
                "use --method rays (with occlusion)");
  return options.method == FormFactorMethod::automatic ? FormFactorMethod::exact : options.method;
}

}  // namespace

FormFactorTable form_factor_table(const Scene& scene, const FormFactorOptions& options) {
  const Fronts fronts = collect_fronts(scene);
  FormFactorTable table;
  table.areas = fronts.area;
  for (const Shape& shape : scene.shapes()) table.names.push_back(shape.name);
  FormFactorOptions chosen = options;
  chosen.method = table.method = choose_method(fronts, options);
  const std::size_t shapes = fronts.area.size();
  if (chosen.method == FormFactorMethod::rays) {
    // Four million in all, but enough for two digits and not more than three digits need.
    const std::size_t share = (std::size_t{1} << 22) / std::max<std::size_t>(1, shapes);
    const auto rays = static_cast<std::uint32_t>(std::clamp<std::size_t>(share, 1 << 13, 1 << 20));
    table.F = ray_exchanges(scene, fronts, options.rays ? options.rays : rays, options.seed);
  } else {
    table.F = analytic_exchanges(scene, fronts, chosen);
  }
  for (std::size_t i = 0; i < shapes; ++i) {
    double sum = 0.0;
    for (double& f : table.F[i]) {
      f = fronts.area[i] > 0.0 ? f / fronts.area[i] : 0.0;
      sum += f;
    }
    if (fronts.area[i] > 0.0) table.closure_error = std::max(table.closure_error, std::abs(sum - 1.0));
  }
  return table;
}

}  // namespace twopass
