#include "radiosity/adaptive.h"

#include <algorithm>
#include <numeric>

#include "radiosity/smoothing.h"
#include "render/core/parallel.h"

namespace twopass {

namespace {

double brightest(const C3f& x) { return static_cast<double>(std::max(std::max(x.x, x.y), x.z)); }

// How much the irradiance differs between the corners of an element that is not a cluster.
struct Range {
  C3f low, high;
};
Range range_in(const ElementMesh& mesh, const SmoothIrradiance& smooth, std::uint32_t element) {
  const ElementMesh::Location corner[] = {{element, mesh.root_index(element), 0.0f, 0.0f},
                                          {element, mesh.root_index(element), 1.0f, 0.0f},
                                          {element, mesh.root_index(element), 0.0f, 1.0f}};
  Range range{C3f(infinity_f), C3f(0.0f)};
  for (const ElementMesh::Location& location : corner) {
    const C3f value = smooth.at(location).total();
    for (int c = 0; c < 3; ++c) {
      range.low[c] = std::min(range.low[c], value[c]);
      range.high[c] = std::max(range.high[c], value[c]);
    }
  }
  return range;
}

// Calls `use(element, range)` for each element that can be split, in parallel.
template <class Use>
void for_each_range(const ElementMesh& mesh, std::span<const Irradiance> irradiance, const Use& use) {
  const SmoothIrradiance smooth(mesh, irradiance);
  parallel_for(mesh.count(), 256, [&](std::size_t begin, std::size_t end) {
    for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i)
      if (!mesh.is_cluster(i)) use(i, range_in(mesh, smooth, i));
  });
}

double power_in(const ElementMesh& mesh, std::uint32_t element, const Range& range) {
  return mesh.area(element) * brightest(mesh.reflectance(element) * (range.high - range.low));
}

// (R44): the part of the picture that the element is, times the contrast on it.
double seen_in(double part, const Range& range) {
  const double high = brightest(range.high);
  return high > 0.0 ? part * brightest(range.high - range.low) / high : 0.0;
}

}  // namespace

std::vector<double> misplaced_power(const ElementMesh& mesh, std::span<const Irradiance> irradiance) {
  std::vector<double> power(mesh.count(), 0.0);
  for_each_range(mesh, irradiance,
                 [&](std::uint32_t i, const Range& range) { power[i] = power_in(mesh, i, range); });
  return power;
}

std::vector<bool> elements_to_split(const ElementMesh& mesh, std::span<const Irradiance> irradiance,
                                    std::span<const double> seen, std::size_t most, double negligible,
                                    std::span<const double> importance) {
  double total = 0.0;
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    total += mesh.area(i) * brightest(mesh.reflectance(i) * irradiance[i].total());
  std::vector<double> gain(mesh.count(), 0.0);
  for_each_range(mesh, irradiance, [&](std::uint32_t i, const Range& range) {
    if (!importance.empty())
      gain[i] = importance[i] * brightest(mesh.reflectance(i) * (range.high - range.low));
    else if (total > 0.0)
      gain[i] = power_in(mesh, i, range) / total;
    if (!seen.empty()) gain[i] += seen_in(seen[i], range);
  });
  std::vector<std::uint32_t> order(mesh.count());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return gain[a] > gain[b]; });
  double left = std::accumulate(gain.begin(), gain.end(), 0.0);
  std::vector<bool> chosen(mesh.count(), false);
  for (std::size_t k = 0; k < std::min(most, order.size()) && left > negligible; ++k) {
    chosen[order[k]] = true;
    left -= gain[order[k]];
  }
  return chosen;
}

}  // namespace twopass
