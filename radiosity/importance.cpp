#include "radiosity/importance.h"

#include <algorithm>

namespace twopass {

namespace {

// Light of more reflections than this tells elements apart no more.
constexpr int reflections = 8;
// Elements darker than this part of what the picture sees on average count as if they were not.
constexpr double dark = 0.01;

double brightest(const C3d& c) { return std::max({c.x, c.y, c.z}); }

}  // namespace

std::vector<double> indirect_importance(const Balance& balance, std::span<const C3d> radiosity,
                                        std::span<const double> parts) {
  const std::uint32_t n = balance.count();
  double mean = 0.0;
  for (std::uint32_t i = 0; i < n; ++i) mean += parts[i] * brightest(radiosity[i]);
  std::vector<double> result(n, 0.0);
  if (!(mean > 0.0)) return result;
  std::vector<C3d> all(n, C3d(0.0)), seen(n, C3d(0.0)), over_area(n);
  for (std::uint32_t i = 0; i < n; ++i)
    seen[i] = all[i] = C3d(parts[i] / std::max(brightest(radiosity[i]), dark * mean));
  for (int k = 0; k < reflections; ++k) {
    // Exchange is symmetric: Sum_i rho_i F_ij I_i = Sum_i X_ji rho_i I_i / A_i.
    for (std::uint32_t i = 0; i < n; ++i)
      over_area[i] = balance.area[i] > 0.0 ? C3d(balance.reflectance[i]) * all[i] / balance.area[i] : C3d(0.0);
    std::vector<C3d> next = balance.gather_all_directly(over_area);
    for (std::uint32_t i = 0; i < n; ++i) next[i] *= balance.area[i];
    for (std::uint32_t i = 0; i < n; ++i)
      for (const SpecularLink& link : balance.specular.of(i))
        next[link.element] += all[i] * C3d(balance.reflectance[i]) * C3d(link.weight);
    for (std::uint32_t i = 0; i < n; ++i) all[i] = seen[i] + next[i];
    if (k + 1 == reflections)
      for (std::uint32_t i = 0; i < n; ++i) result[i] = brightest(next[i]);
  }
  return result;
}

}  // namespace twopass
