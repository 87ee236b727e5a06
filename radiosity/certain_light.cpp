#include "radiosity/certain_light.h"

#include <cmath>

#include "render/core/interrupt.h"
#include "render/core/parallel.h"

namespace twopass {

namespace {

// More than so many tests of a polygon between an element and a lamp take longer than what is gained.
constexpr double most_work = 1e8;

using Four [[gnu::vector_size(32)]] = double;

// What belongs to the next corner. Vectors are not returned: how that is done depends on the processor.
void take_next(const Four& v, Four& next) { next = __builtin_shufflevector(v, v, 1, 2, 3, 0); }

// acos(x) / sqrt(1 - x^2) for x in [0, 1]: Chebyshev interpolation, relative error 6e-11.
void take_angle_over_sine(const Four& x, Four& ratio) {
  constexpr double c[] = {1.209199576156147,      -0.26360014049691044,    0.06973319179922054,
                          -0.019837168803543165,  0.005861636026432304,    -0.001772755035770474,
                          0.0005447181048497694,  -0.00016989431191278143, 5.326198275230791e-05,
                          -1.580591823496364e-05, 5.010450579972642e-06,   -2.3987637230395476e-06,
                          7.688557493915702e-07};
  const Four t = 2.0 * x - 1.0;
  ratio = t * c[12] + c[11];
  for (int k = 10; k >= 0; --k) ratio = ratio * t + c[k];
}

}  // namespace

LampInView::LampInView(const Polygon& polygon) {
  for (int i = 0; i < 4; ++i) {
    const V3d& corner = polygon.v[std::min(i, polygon.n - 1)];
    x_[i] = corner.x, y_[i] = corner.y, z_[i] = corner.z;
  }
}

double LampInView::form_factor(const V3f& point, const V3f& normal) const {
  const Four x = x_ - point.x, y = y_ - point.y, z = z_ - point.z;
  Four length = x * x + y * y + z * z;
  for (int i = 0; i < 4; ++i) length[i] = std::sqrt(length[i]);
  Four next_length, u, v, w, ratio;
  take_next(length, next_length);
  take_next(x, u);
  take_next(y, v);
  take_next(z, w);
  const Four scale = 1.0 / (length * next_length);
  const Four triple = normal.x * (y * w - z * v) + normal.y * (z * u - x * w) + normal.z * (x * v - y * u);
  const Four cosine = (x * u + y * v + z * w) * scale;
  const Four magnitude = cosine < 0.0 ? -cosine : cosine;
  take_angle_over_sine(magnitude, ratio);
  // Beyond a right angle it is the supplement's: pi / sine less that of -x.
  for (int i = 0; i < 4; ++i)
    if (cosine[i] < 0.0) [[unlikely]]
      ratio[i] = pi / std::sqrt(std::max(1.0 - cosine[i] * cosine[i], 1e-30)) - ratio[i];
  const Four terms = triple * scale * ratio;
  return std::clamp((terms[0] + terms[1] + terms[2] + terms[3]) * (-0.5 / pi), 0.0, 1.0);
}

CertainLight::CertainLight(const Scene& scene, const ElementMesh& mesh) : lamps_(scene) {
  const std::size_t count = mesh.count();
  if (!lamps_.is_known() || static_cast<double>(lamps_.work()) * static_cast<double>(count) > most_work) return;
  for (std::size_t k = 0; k < lamps_.count(); ++k) {
    in_view_.emplace_back(lamps_.polygon(k));
    exitance_.emplace_back(lamps_.exitance(k));
  }
  seen_.resize(count);
  parallel_for(count, 64, [&](std::size_t begin, std::size_t end) {
    throw_if_interrupted();
    for (auto e = static_cast<std::uint32_t>(begin); e < end; ++e) {
      if (mesh.is_cluster(e)) continue;
      const Patch patch = mesh.patch(e);
      if (patch.is_analytic() || !(patch.area > 0.0)) continue;
      const auto lamps = lamps_.seen_from(patch.polygon());
      if (!lamps) continue;
      seen_[e] = {*lamps, true, lamps_.are_above(*lamps, patch.corner[0], patch.normal)};
    }
  });
  double area = 0.0, sure = 0.0;
  for (std::uint32_t e = 0; e < count; ++e) {
    area += mesh.area(e);
    if (seen_[e].is_known) sure += mesh.area(e);
  }
  share_ = area > 0.0 ? sure / area : 0.0;
}

}  // namespace twopass
