#include "radiosity/form_factor_table.h"

#include "radiosity/form_factor_pair.h"
#include "radiosity/hemicube_pixels.h"
#include "radiosity/shape_exchange.h"
#include "radiosity/shape_rays.h"
#include "radiosity/table_closure.h"
#include "radiosity/visibility.h"
#include "radiosity/visible_exchange.h"
#include "render/core/error.h"
#include "render/core/interrupt.h"
#include "render/core/parallel.h"
#include "render/core/sampler.h"
#include "render/scene/centred_scene.h"

namespace twopass {

namespace {

constexpr std::size_t most_triangles_in_pairs = 4096;    // their pairs take minutes, longer where things hide
constexpr std::size_t most_triangles_automatic = 256;    // and these seconds
constexpr std::size_t most_triangles_as_control = 1024;  // seconds, too: nothing is hidden from a control
constexpr double accuracy_in_sight = 1e-10, accuracy_past_blockers = 3e-4;

ExchangeTable empty_table(std::size_t rows, std::size_t columns) {
  return ExchangeTable(rows, std::vector<double>(columns, 0.0));
}

// What the methods `exact` and `point` take pairs of.
struct Surfaces {
  std::vector<Polygon> polygon;
  std::vector<std::uint32_t> shape;  // of each polygon
};

// Triangles, or where whole polygons will do these.
Surfaces surfaces_of(const ShapeFronts& fronts, bool join) {
  Surfaces surfaces;
  for (std::uint32_t s = 0; s < fronts.shapes(); ++s) {
    std::vector<Polygon> polygons;
    for (const Patch& patch : fronts.patches_of(s)) polygons.push_back(patch.polygon());
    if (join) polygons = join_triangles(polygons);
    surfaces.polygon.insert(surfaces.polygon.end(), polygons.begin(), polygons.end());
    surfaces.shape.resize(surfaces.polygon.size(), s);
  }
  return surfaces;
}

// The methods `exact` and `point` for one pair of polygons.
class PairOfPolygons {
 public:
  PairOfPolygons(const Scene& scene, const ShapeFronts& fronts, const FormFactorOptions& options)
      : scene_(scene),
        fronts_(fronts),
        options_(options),
        surfaces_(surfaces_of(fronts, options.method == FormFactorMethod::exact)),
        blockers_(surfaces_.polygon) {}

  [[nodiscard]] const Surfaces& surfaces() const { return surfaces_; }

  [[nodiscard]] double exchange(std::size_t i, std::size_t j) const {
    const Polygon &a = surfaces_.polygon[i], &b = surfaces_.polygon[j];
    const bool exact = options_.method == FormFactorMethod::exact;
    const double unoccluded =
        exact ? exchange_exact(a, b, accuracy_in_sight) : 0.5 * (exchange_point(a, b) + exchange_point(b, a));
    if (!(unoccluded > 0.0) || !options_.occlusion) return unoccluded;
    if (exact) return blockers_.visible_exchange(a, b, unoccluded, accuracy_past_blockers);
    return blockers_.none_between(a, b) ? unoccluded : unoccluded * fraction_by_rays(i, j);
  }

 private:
  // For `point`, whose polygons are the fronts' triangles.
  [[nodiscard]] double fraction_by_rays(std::size_t i, std::size_t j) const {
    constexpr std::uint32_t pairs_of_points = 64;
    const std::uint64_t key = hash_words(options_.seed, static_cast<std::uint32_t>(i));
    std::uint64_t rays = 0;
    return visible_fraction(
        scene_.caster(), fronts_.patch[i], fronts_.patch[j],
        static_cast<std::uint32_t>(hash_words(static_cast<std::uint32_t>(key), static_cast<std::uint32_t>(j))),
        pairs_of_points, rays);
  }

  const Scene& scene_;
  const ShapeFronts& fronts_;
  const FormFactorOptions& options_;
  Surfaces surfaces_;
  Blockers blockers_;
};

ExchangeTable pair_exchanges(const Scene& scene, const ShapeFronts& fronts, const FormFactorOptions& options) {
  const PairOfPolygons pair(scene, fronts, options);
  const std::vector<std::uint32_t>& shape = pair.surfaces().shape;
  const std::size_t shapes = fronts.shapes(), polygons = shape.size();
  // What each polygon exchanges with each shape: written by one thread each, added up in order.
  ExchangeTable by_polygon = empty_table(polygons, shapes);
  parallel_for(polygons, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t j = i + 1; j < polygons; ++j) {
        throw_if_interrupted();
        by_polygon[i][shape[j]] += pair.exchange(i, j);
      }
  });
  ExchangeTable exchange = empty_table(shapes, shapes);
  for (std::size_t i = 0; i < polygons; ++i)
    for (std::size_t s = 0; s < shapes; ++s) {
      exchange[shape[i]][s] += by_polygon[i][s];
      exchange[s][shape[i]] += by_polygon[i][s];  // for s == shape[i] both ways are in one entry
    }
  return exchange;
}

// What the hemicube at a patch's centroid sees of each shape, times the patch's area.
std::vector<double> hemicube_exchange(const Scene& scene, const Patch& patch, std::size_t shapes,
                                      const std::vector<HemicubePixel>& pixels, bool occlusion) {
  const ElementPoint eye = patch.centroid();
  const Frame frame{V3f(eye.normal)};
  const LineFollower line(scene);
  FrontsMet met;
  std::vector<double> exchange(shapes, 0.0);
  for (const HemicubePixel& pixel : pixels) {
    line.follow({eye.ray_position(), frame.to_world(V3f(pixel.direction))}, !occlusion, met);
    for (const FrontsMet::Front& front : met.fronts) exchange[front.shape] += patch.area * pixel.weight;
  }
  return exchange;
}

ExchangeTable hemicube_exchanges(const Scene& scene, const ShapeFronts& fronts,
                                 const FormFactorOptions& options) {
  constexpr std::size_t at_once = 1024;  // bounds the memory
  const std::vector<HemicubePixel> pixels = hemicube_pixels(options.hemicube_resolution);
  const std::size_t shapes = fronts.shapes(), patches = fronts.patch.size();
  ExchangeTable exchange = empty_table(shapes, shapes);
  std::vector<std::vector<double>> by_patch(std::min(at_once, patches));
  for (std::size_t first = 0; first < patches; first += at_once) {
    const std::size_t count = std::min(at_once, patches - first);
    parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        throw_if_interrupted();
        by_patch[k] = hemicube_exchange(scene, fronts.patch[first + k], shapes, pixels, options.occlusion);
      }
    });
    // Each way is an estimate of the same exchange: their mean.
    for (std::size_t k = 0; k < count; ++k)
      for (std::size_t s = 0; s < shapes; ++s) {
        exchange[fronts.shape[first + k]][s] += 0.5 * by_patch[k][s];
        exchange[s][fronts.shape[first + k]] += 0.5 * by_patch[k][s];
      }
  }
  return exchange;
}

// The exchange of two shapes from the counts of their rays and, if it is known, what they would exchange if
// nothing were in the way.
double exchange_from_counts(const ShapeRayCounts& counts, const ShapeFronts& fronts, std::size_t i,
                            std::size_t j, std::optional<double> unoccluded, bool occlusion) {
  const auto visible = static_cast<double>(counts.visible[i][j] + counts.visible[j][i]);
  const auto met = visible + static_cast<double>(counts.blocked[i][j] + counts.blocked[j][i]);
  if (unoccluded) return occlusion && met > 0.0 ? *unoccluded * (visible / met) : *unoccluded;  // (R25)
  // (R13)
  const double area = fronts.area[i] * fronts.area[j] / (fronts.area[i] + fronts.area[j]);
  return area * ((occlusion ? visible : met) / counts.rays);
}

bool can_have_control(const ShapeFronts& fronts) {
  std::size_t triangles = 0;
  for (std::size_t s = 0; s < fronts.shapes(); ++s)
    if (!fronts.is_analytic[s]) triangles += fronts.first[s + 1] - fronts.first[s];
  return triangles <= most_triangles_as_control;
}

ExchangeTable ray_exchanges(const Scene& scene, const ShapeFronts& fronts, const FormFactorOptions& options,
                            const ShapeRayCounts& counts) {
  const std::size_t shapes = fronts.shapes();
  const bool control = can_have_control(fronts);
  ExchangeTable exchange = empty_table(shapes, shapes);
  // Row i writes the entries (i, j) and (j, i) of j >= i: one thread each.
  parallel_for(shapes, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t j = i; j < shapes; ++j) {
        throw_if_interrupted();
        if (!(fronts.area[i] > 0.0) || !(fronts.area[j] > 0.0)) continue;
        std::optional<double> unoccluded;
        if (control)
          unoccluded = unoccluded_exchange(scene, fronts, static_cast<std::uint32_t>(i),
                                           static_cast<std::uint32_t>(j), accuracy_in_sight);
        exchange[i][j] = exchange[j][i] =
            exchange_from_counts(counts, fronts, i, j, unoccluded, options.occlusion);
      }
  });
  return exchange;
}

bool any_analytic(const ShapeFronts& fronts) {
  return std::find(fronts.is_analytic.begin(), fronts.is_analytic.end(), true) != fronts.is_analytic.end();
}

FormFactorMethod choose_method(const ShapeFronts& fronts, const FormFactorOptions& options) {
  const bool analytic = any_analytic(fronts);
  switch (options.method) {
    case FormFactorMethod::automatic:
      return !analytic && fronts.patch.size() <= most_triangles_automatic ? FormFactorMethod::exact
                                                                          : FormFactorMethod::rays;
    case FormFactorMethod::rays:
      return FormFactorMethod::rays;
    case FormFactorMethod::hemicube:
      if (options.hemicube_resolution < 2 || options.hemicube_resolution > largest_hemicube_resolution ||
          options.hemicube_resolution % 2 != 0)
        throw Error("form factors",
                    std::to_string(options.hemicube_resolution) + " pixels are no edge of a hemicube",
                    "give an even number from 2 to " + std::to_string(largest_hemicube_resolution));
      break;
    case FormFactorMethod::exact:
    case FormFactorMethod::point:
      if (fronts.patch.size() > most_triangles_in_pairs)
        throw Error("form factors", std::to_string(fronts.patch.size()) + " triangles have too many pairs",
                    "use --method rays");
  }
  if (analytic)
    throw Error("form factors",
                "this method divides surfaces into triangles, and the scene has spheres, disks or cylinders",
                "use --method rays");
  return options.method;
}

std::uint32_t chosen_rays(const FormFactorOptions& options, std::size_t shapes) {
  if (options.rays) return options.rays;
  // Four million in all, but enough for two digits and not more than three digits need.
  return static_cast<std::uint32_t>(std::clamp<std::size_t>((std::size_t{1} << 22) / shapes, 1 << 13, 1 << 20));
}

// Whether the scene is closed: by the rays that there are and, if they are few, by test rays.
bool is_closed(const Scene& scene, const ShapeFronts& fronts, const ShapeRayCounts& counts,
               std::uint32_t seed) {
  const auto tests = static_cast<std::uint32_t>(std::clamp<std::size_t>(65536 / fronts.shapes(), 64, 8192));
  if (counts.rays > 0 && !counts.closed()) return false;
  return counts.rays >= tests || count_shape_rays(scene, fronts, tests, false, seed).closed();
}

double closure_error(const ExchangeTable& exchange, std::span<const double> area) {
  double worst = 0.0;
  for (std::size_t i = 0; i < area.size(); ++i) {
    if (!(area[i] > 0.0)) continue;
    double sum = 0.0;
    for (const double x : exchange[i]) sum += x;
    worst = std::max(worst, std::abs(sum / area[i] - 1.0));
  }
  return worst;
}

// Everything but the names: in the units of the centred scene.
void fill_in(FormFactorTable& table, const Scene& scene, const FormFactorOptions& given) {
  const ShapeFronts fronts = collect_fronts(scene);
  FormFactorOptions options = given;
  options.method = table.method = choose_method(fronts, options);
  table.areas = fronts.area;
  table.degenerate_triangles = fronts.degenerate;
  ShapeRayCounts counts;
  if (options.method == FormFactorMethod::rays) {
    counts = count_shape_rays(scene, fronts, chosen_rays(options, fronts.shapes()), true, options.seed);
    table.F = ray_exchanges(scene, fronts, options, counts);
  } else if (options.method == FormFactorMethod::hemicube) {
    table.F = hemicube_exchanges(scene, fronts, options);
  } else {
    table.F = pair_exchanges(scene, fronts, options);
  }
  table.closed = is_closed(scene, fronts, counts, options.seed);
  table.closure_error_before = closure_error(table.F, fronts.area);
  if (options.occlusion) {
    if (table.closed)
      scale_rows_to_areas(table.F, fronts.area);
    else
      cap_rows_at_areas(table.F, fronts.area);
  }
  table.closure_error = closure_error(table.F, fronts.area);
  for (std::size_t i = 0; i < fronts.shapes(); ++i)
    for (double& f : table.F[i]) f = fronts.area[i] > 0.0 ? f / fronts.area[i] : 0.0;
}

}  // namespace

FormFactorTable form_factor_table(const Scene& scene, const FormFactorOptions& options) {
  FormFactorTable table;
  for (const Shape& shape : scene.shapes()) table.names.push_back(shape.name);
  if (scene.shapes().empty()) return table;
  const Scene local(centred(scene.description()));
  fill_in(table, local, options);
  const double unit = local.description().frame.unit;
  for (double& area : table.areas) area *= unit * unit;
  if (table.degenerate_triangles > 0)
    table.notes.push_back(std::to_string(table.degenerate_triangles) +
                          " triangles without area exchange nothing and were left out");
  return table;
}

}  // namespace twopass
