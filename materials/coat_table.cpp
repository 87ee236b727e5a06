#include "materials/coat_table.h"

#include <map>
#include <mutex>
#include <tuple>

#include "materials/fresnel.h"

namespace twopass {

namespace {

/// Fractions of the light from the direction with this cosine that facets reflect and transmit, averaged over a
/// Fibonacci lattice of n points, n and m successive Fibonacci numbers. The rest meets more than one facet.
struct Fractions {
  double reflected = 0.0, transmitted = 0.0;
};
Fractions fractions(const MicrofacetDistribution& surface, float cosine, float eta, int n, int m) {
  const V3f wo(std::sqrt(1.0f - cosine * cosine), 0.0f, cosine);
  Fractions sum;
  for (int i = 0; i < n; ++i) {
    const auto index = static_cast<std::int64_t>(i);
    const V2f u((static_cast<float>(i) + 0.5f) / static_cast<float>(n),
                static_cast<float>(index * m % n) / static_cast<float>(n));
    const V3f normal = surface.sample(wo, u), mirrored = reflect(wo, normal);
    const float wo_m = std::clamp(wo.dot(normal), 0.0f, 1.0f);
    float cos_t;
    const float fresnel = fresnel_dielectric(wo_m, eta, cos_t);
    if (mirrored.z > 0.0f) sum.reflected += fresnel * surface.sample_weight(wo, mirrored, normal);
    const V3f refracted = normal * (wo_m / eta - cos_t) - wo * (1.0f / eta);
    if (refracted.z < 0.0f && fresnel < 1.0f)
      sum.transmitted += (1.0f - fresnel) * surface.sample_weight(wo, refracted, normal);
  }
  return {sum.reflected / n, sum.transmitted / n};
}

/// 2 int_0^1 T(mu) mu dmu of the piecewise linear table.
float mean_over_cosines(const std::array<float, CoatTable::size>& table) {
  constexpr double step = 1.0 / (CoatTable::size - 1);
  double sum = 0.0;
  for (int i = 0; i + 1 < CoatTable::size; ++i)
    sum += step * (0.5 * i * step * (table[i] + table[i + 1]) + step * (table[i] / 6.0 + table[i + 1] / 3.0));
  return static_cast<float>(2.0 * sum);
}

CoatTable compute(Microfacet distribution, float alpha, float eta) {
  const MicrofacetDistribution surface(distribution, alpha, alpha);
  CoatTable table{distribution, alpha, eta, {}, 0.0f, 0.0f};
  double internal = 0.0;
  for (int i = 0; i < CoatTable::size; ++i) {
    const float cosine = std::max(1e-6f, static_cast<float>(i) / (CoatTable::size - 1));
    table.transmittance[i] = static_cast<float>(fractions(surface, cosine, eta, 987, 610).transmitted);
    internal += cosine * fractions(surface, cosine, 1.0f / eta, 2584, 1597).reflected;
  }
  // The mean over the table's nodes as Mitsuba 3 takes it, which is 1.6 % below the integral: its rough plastic
  // is a little darker than that integral makes it.
  table.mean_transmittance = mean_over_cosines(table.transmittance);
  // By reciprocity no less leaves than 1 / eta^2 of what enters, which the difference has no digits for where
  // the index is high.
  table.escape = std::max(static_cast<float>(1.0 - 2.0 * internal / CoatTable::size),
                          table.mean_transmittance / (eta * eta));
  return table;
}

}  // namespace

const CoatTable& coat_table(Microfacet distribution, float alpha, float eta) {
  static std::mutex mutex;
  static std::map<std::tuple<Microfacet, float, float>, CoatTable> tables;  // never moves its values
  const std::lock_guard lock(mutex);
  const auto key = std::tuple(distribution, alpha, eta);
  const auto found = tables.find(key);
  if (found != tables.end()) return found->second;
  return tables.emplace(key, compute(distribution, alpha, eta)).first->second;
}

}  // namespace twopass
