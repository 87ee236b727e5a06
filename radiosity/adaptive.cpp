#include "radiosity/adaptive.h"

#include <algorithm>
#include <numeric>

#include "radiosity/smoothing.h"
#include "render/core/parallel.h"

namespace twopass {

namespace {

double brightest(const C3f& x) { return static_cast<double>(std::max(std::max(x.x, x.y), x.z)); }

// (R37) for one element that is not a cluster.
double misplaced_in(const ElementMesh& mesh, const SmoothIrradiance& smooth, std::uint32_t element) {
  const ElementMesh::Location corner[] = {{element, mesh.root_index(element), 0.0f, 0.0f},
                                          {element, mesh.root_index(element), 1.0f, 0.0f},
                                          {element, mesh.root_index(element), 0.0f, 1.0f}};
  C3f low(infinity_f), high(0.0f);
  for (const ElementMesh::Location& location : corner) {
    const C3f value = smooth.at(location).total();
    for (int c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], value[c]);
      high[c] = std::max(high[c], value[c]);
    }
  }
  return mesh.area(element) * brightest(mesh.reflectance(element) * (high - low));
}

}  // namespace

std::vector<double> misplaced_power(const ElementMesh& mesh, std::span<const Irradiance> irradiance) {
  const SmoothIrradiance smooth(mesh, irradiance);
  std::vector<double> power(mesh.count(), 0.0);
  parallel_for(mesh.count(), 256, [&](std::size_t begin, std::size_t end) {
    for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i)
      if (!mesh.is_cluster(i)) power[i] = misplaced_in(mesh, smooth, i);
  });
  return power;
}

std::vector<bool> elements_to_split(const ElementMesh& mesh, std::span<const Irradiance> irradiance,
                                    std::size_t most, double negligible) {
  const std::vector<double> power = misplaced_power(mesh, irradiance);
  double total = 0.0;
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    total += mesh.area(i) * brightest(mesh.reflectance(i) * irradiance[i].total());
  std::vector<std::uint32_t> order(mesh.count());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return power[a] > power[b]; });
  double left = std::accumulate(power.begin(), power.end(), 0.0);
  std::vector<bool> chosen(mesh.count(), false);
  for (std::size_t k = 0; k < std::min(most, order.size()) && left > negligible * total; ++k) {
    chosen[order[k]] = true;
    left -= power[order[k]];
  }
  return chosen;
}

}  // namespace twopass
