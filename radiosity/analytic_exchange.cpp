#include "radiosity/analytic_exchange.h"

#include <atomic>

#include "radiosity/form_factor_pair.h"
#include "radiosity/visibility.h"
#include "render/core/error.h"
#include "render/core/interrupt.h"
#include "render/core/parallel.h"
#include "render/core/sampler.h"

namespace twopass {

namespace {

// Few, because there are many pairs of elements and their errors average out.

struct Entry {
  std::uint32_t column;
  float value;
};

bool share_inside_of_sphere(const Patch& a, const Patch& b) {
  return a.on_sphere && b.on_sphere && a.signed_radius < 0.0 && a.signed_radius == b.signed_radius &&
         a.center == b.center;
}

ExchangeMatrix symmetric_matrix(const std::vector<std::vector<Entry>>& upper) {
  const auto n = static_cast<Eigen::Index>(upper.size());
  // Entries of a row left of its diagonal are those of the rows above it.
  Eigen::VectorXi size = Eigen::VectorXi::Zero(n);
  for (std::size_t i = 0; i < upper.size(); ++i)
    for (const Entry& entry : upper[i]) {
      ++size[static_cast<Eigen::Index>(i)];
      if (entry.column != i) ++size[entry.column];
    }
  ExchangeMatrix matrix(n, n);
  matrix.reserve(size);
  // Rows in ascending order append to every row in ascending order of columns: no insertion ever moves
  // anything.
  for (std::size_t i = 0; i < upper.size(); ++i)
    for (const Entry& entry : upper[i]) {
      const auto row = static_cast<Eigen::Index>(i);
      if (entry.column != i) matrix.insert(entry.column, row) = entry.value;
    }
  for (std::size_t i = 0; i < upper.size(); ++i)
    for (const Entry& entry : upper[i]) matrix.insert(static_cast<Eigen::Index>(i), entry.column) = entry.value;
  matrix.makeCompressed();
  return matrix;
}

}  // namespace

double unoccluded_exchange(const Patch& a, const Patch& b, FormFactorMethod method) {
  if (share_inside_of_sphere(a, b)) return a.area * b.area / (4.0 * pi * a.signed_radius * a.signed_radius);
  const Polygon pa = a.polygon(), pb = b.polygon();
  double exchange = method == FormFactorMethod::exact ? exchange_exact(pa, pb)
                                                      : 0.5 * (exchange_point(pa, pb) + exchange_point(pb, pa));
  if (exchange == 0.0) return 0.0;
  if (a.is_analytic()) exchange *= a.area / polygon_area(pa);
  if (b.is_analytic()) exchange *= b.area / polygon_area(pb);
  return exchange;
}

namespace {

// All patches of all elements: one each, more of a cluster.
struct Patches {
  std::vector<Patch> patch;
  std::vector<std::size_t> first;  // by element, and the end

  explicit Patches(const ElementMesh& mesh) : first(mesh.count() + 1, 0) {
    for (std::uint32_t i = 0; i < mesh.count(); ++i) {
      for (std::size_t k = 0; k < mesh.patch_count(i); ++k) patch.push_back(mesh.patch(i, k));
      first[i + 1] = patch.size();
    }
  }
  [[nodiscard]] std::span<const Patch> of(std::uint32_t element) const {
    return {patch.data() + first[element], patch.data() + first[element + 1]};
  }
};

// X_ij of two elements, or of an element with itself: over all pairs of their patches.
double visible_exchange(const RayCaster& caster, std::span<const Patch> a, std::span<const Patch> b,
                        FormFactorMethod method, std::uint32_t key, double total_area, std::uint64_t& rays) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k)
    for (std::size_t l = 0; l < b.size(); ++l) {
      const double unoccluded = unoccluded_exchange(a[k], b[l], method);
      if (!(unoccluded > 0.0)) continue;
      const bool same = &a[k] == &b[l];  // the inside of a sphere sees itself
      const auto pair = static_cast<std::uint32_t>(k * b.size() + l);
      sum += same ? unoccluded
                  : unoccluded * visible_fraction(caster, a[k], b[l], key + pair,
                                                  visibility_pairs(unoccluded, total_area), rays);
    }
  return sum;
}

}  // namespace

ExchangeMatrix analytic_exchange(const ElementMesh& mesh, const RayCaster& caster, FormFactorMethod method,
                                 std::uint32_t seed, std::uint64_t& rays) {
  const auto n = static_cast<std::uint32_t>(mesh.count());
  std::size_t patches = 0;
  for (std::uint32_t i = 0; i < n; ++i) patches += mesh.patch_count(i);
  if (patches > analytic_max_elements)
    throw Error("form factors",
                std::to_string(patches) + " elements and triangles of clusters are more than the " +
                    std::to_string(analytic_max_elements) + " whose pairs can all be visited",
                "use --form-factors rays, or fewer elements (--elements)");
  const Patches all(mesh);
  double total_area = 0.0;
  for (const Patch& patch : all.patch) total_area += patch.area;
  std::vector<std::vector<Entry>> upper(n);
  std::atomic<std::uint64_t> rays_cast{0};
  parallel_for(n, 1, [&](std::size_t begin, std::size_t end) {
    std::uint64_t row_rays = 0;
    for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i) {
      throw_if_interrupted();
      for (std::uint32_t j = i; j < n; ++j) {
        const std::uint32_t key = hash_words(hash_words(seed, i), j);
        const double exchange =
            visible_exchange(caster, all.of(i), all.of(j), method, key, total_area, row_rays);
        if (exchange > 0.0) upper[i].push_back({j, static_cast<float>(exchange)});
      }
    }
    rays_cast += row_rays;
  });
  rays += rays_cast;
  return symmetric_matrix(upper);
}

}  // namespace twopass
