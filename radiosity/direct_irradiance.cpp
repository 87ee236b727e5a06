#include "radiosity/direct_irradiance.h"

#include <atomic>

#include "radiosity/element_response.h"
#include "radiosity/form_factor_pair.h"
#include "radiosity/lambert.h"
#include "radiosity/punctual_irradiance.h"
#include "radiosity/visibility.h"
#include "render/core/interrupt.h"
#include "render/core/parallel.h"
#include "render/core/sampler.h"
#include "render/core/warp.h"

namespace twopass {

namespace {

struct Emitter {
  Patch patch;
  Polygon polygon;
  C3d exitance;  // pi times its radiance
  bool is_element;
};

// The emitting sides of triangles, or nothing if analytic surfaces emit, if what is emitted varies over a
// surface, or if there are too many.
std::vector<Emitter> analytic_emitters(const Scene& scene, const ElementMesh& mesh) {
  std::vector<Emitter> emitters;
  for (std::uint32_t s = 0; s < scene.shapes().size(); ++s) {
    const Shape& shape = scene.shapes()[s];
    if (!is_emitter(shape)) continue;
    const Mesh* triangles = mesh_of(shape.geometry);
    if (!triangles || shape.radiance_texture || triangles->triangles.size() > most_analytic_emitters) return {};
    for (const Side side : {front, back}) {
      if (is_black(shape.radiance[side])) continue;
      for (std::uint32_t i = 0; i < triangles->triangles.size(); ++i) {
        const Patch patch = piece_patch(shape.geometry, i, side);
        if (patch.area > 0.0)
          emitters.push_back(
              {patch, patch.polygon(), C3d(shape.radiance[side]) * pi, mesh.has_elements(s, side)});
      }
    }
    if (emitters.size() > most_analytic_emitters) return {};
  }
  return emitters;
}

// A_i F_ie without obstacles. Pieces of analytic surfaces are seen by points of theirs.
double unoccluded_exchange_with(const Patch& patch, const Emitter& emitter, FormFactorMethod method,
                                std::uint32_t key) {
  if (patch.is_analytic()) {
    constexpr std::uint32_t points = 16;
    double sum = 0.0;
    for (std::uint32_t k = 0; k < points; ++k) {
      const ElementPoint point = patch.sample(Sampler(key, 1, k).next_2d());
      sum += point_form_factor(point.position, point.normal, emitter.polygon);
    }
    return patch.area * sum / points;
  }
  if (method == FormFactorMethod::point || method == FormFactorMethod::hemicube)
    return exchange_point(patch.polygon(), emitter.polygon);
  // Rays are content with less than what the statistics of everything else allow.
  return exchange_exact(patch.polygon(), emitter.polygon, method == FormFactorMethod::exact ? 1e-6 : 1e-3);
}

class AnalyticDirect {
 public:
  AnalyticDirect(const Scene& scene, const ElementMesh& mesh, std::vector<Emitter> emitters,
                 std::size_t least_rays)
      : scene_(scene),
        mesh_(mesh),
        emitters_(std::move(emitters)),
        least_rays_(least_rays),
        exchange_(mesh.count() * emitters_.size()) {}

  void find_exchange(FormFactorMethod method, std::uint32_t seed, std::uint64_t& rays) {
    for_each_pair([&](std::uint32_t i, std::size_t e) {
      double sum = 0.0;
      for (std::size_t k = 0; k < mesh_.patch_count(i); ++k)
        sum += unoccluded_exchange_with(mesh_.patch(i, k), emitters_[e], method, key_of(seed, i, e));
      exchange(i, e) = sum;
    });
    std::vector<double> total(emitters_.size(), 0.0);
    for (std::size_t i = 0; i < mesh_.count(); ++i)
      for (std::size_t e = 0; e < emitters_.size(); ++e) total[e] += exchange(i, e);
    std::atomic<std::uint64_t> rays_cast{0};
    for_each_pair([&](std::uint32_t i, std::size_t e) {
      if (!(exchange(i, e) > 0.0)) return;
      std::uint64_t own_rays = 0;
      exchange(i, e) =
          visible_exchange(i, e, method, key_of(seed, i, e), pairs_for(exchange(i, e) / total[e]), own_rays);
      rays_cast += own_rays;
    });
    rays += rays_cast;
  }

  // Scales what leaves each emitter to its area: nothing is lost in a closed scene.
  void conserve() {
    for (std::size_t e = 0; e < emitters_.size(); ++e) {
      double sum = 0.0;
      for (std::size_t i = 0; i < mesh_.count(); ++i) sum += exchange(i, e);
      for (std::size_t i = 0; sum > 0.0 && i < mesh_.count(); ++i)
        exchange(i, e) *= emitters_[e].patch.area / sum;
    }
  }

  [[nodiscard]] DirectIrradiance result(const ElementResponse& response, std::uint32_t seed) {
    DirectIrradiance direct;
    direct.irradiance.assign(mesh_.count(), C3d(0.0));
    direct.exchange_with_lamps.assign(mesh_.count(), 0.0);
    for (std::size_t i = 0; i < mesh_.count(); ++i) {
      const double area = mesh_.area(static_cast<std::uint32_t>(i));
      if (!(area > 0.0)) continue;
      for (std::size_t e = 0; e < emitters_.size(); ++e) {
        if (!(exchange(i, e) > 0.0)) continue;
        direct.irradiance[i] +=
            emitters_[e].exitance *
            (exchange(i, e) / area * mean_response(response, static_cast<std::uint32_t>(i), e, seed));
        if (!emitters_[e].is_element) direct.exchange_with_lamps[i] += exchange(i, e);
      }
    }
    return direct;
  }

 private:
  // (R50), over the light that the emitter would send to the element, were nothing in between.
  [[nodiscard]] double mean_response(const ElementResponse& response, std::uint32_t element, std::size_t e,
                                     std::uint32_t seed) const {
    constexpr std::uint32_t pairs = 16;
    const DiffuseResponse& own = response.of(element);
    if (own.is_even()) return 1.0;
    const ElementSampler sample(mesh_, element);
    double sum = 0.0, weights = 0.0;
    for (std::uint32_t k = 0; k < pairs; ++k) {
      Sampler sampler(key_of(seed, element, e), 2, k);
      const ElementPoint x = sample(sampler.next_2d()), y = emitters_[e].patch.sample(sampler.next_2d());
      const V3d segment = y.position - x.position;
      const double d2 = segment.length2(), cosine = segment.dot(x.normal) / std::sqrt(d2);
      const double weight = cosine * -segment.dot(y.normal) / (d2 * std::sqrt(d2));
      if (!(weight > 0.0) || !(cosine > 0.0)) continue;
      sum += weight * own.at(cosine);
      weights += weight;
    }
    return weights > 0.0 ? sum / weights : 1.0;
  }

  double& exchange(std::size_t i, std::size_t e) { return exchange_[i * emitters_.size() + e]; }

  static std::uint32_t key_of(std::uint32_t seed, std::uint32_t element, std::size_t emitter) {
    return hash_words(hash_words(seed, element), ~static_cast<std::uint32_t>(emitter));
  }

  template <class Use>
  void for_each_pair(const Use& use) {
    parallel_for(mesh_.count(), 32, [&](std::size_t begin, std::size_t end) {
      throw_if_interrupted();
      for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i)
        for (std::size_t e = 0; e < emitters_.size(); ++e) use(i, e);
    });
  }

  // Shadow rays to an emitter, of which the element could catch a share, were nothing in between: 16 for each
  // of up to four emitters; more emitters share them, because their errors average out. Four times as many
  // where the share is more than four times that of an average element, and so on: the error of an element that
  // catches a tenth of the light is that of the whole scene.
  [[nodiscard]] std::uint32_t pairs_for(double share) const {
    constexpr std::uint32_t most = 4096;
    const std::size_t usual = std::clamp<std::size_t>(64 / emitters_.size(), 4, 16);
    auto pairs = static_cast<std::uint32_t>(
        std::clamp<std::size_t>(least_rays_ / (mesh_.count() * emitters_.size()), usual, most));
    for (double part = share * static_cast<double>(mesh_.count()); part > 4.0 && pairs < most; part /= 4.0)
      pairs *= 4;
    return pairs;
  }

  // Of all patches of the element, in which the shadow rays share. What has one patch has its exchange without
  // obstacles already.
  [[nodiscard]] double visible_exchange(std::uint32_t element, std::size_t e, FormFactorMethod method,
                                        std::uint32_t key, std::uint32_t pairs, std::uint64_t& rays) {
    const Emitter& emitter = emitters_[e];
    const std::size_t patches = mesh_.patch_count(element);
    if (patches == 1)
      return exchange(element, e) *
             visible_fraction(scene_.caster(), mesh_.patch(element), emitter.patch, key, pairs, rays);
    const std::uint32_t own = std::max<std::uint32_t>(1, pairs / static_cast<std::uint32_t>(patches));
    double sum = 0.0;
    for (std::size_t k = 0; k < patches; ++k) {
      const Patch patch = mesh_.patch(element, k);
      const double unoccluded = unoccluded_exchange_with(patch, emitter, method, key);
      if (unoccluded > 0.0)
        sum += unoccluded * visible_fraction(scene_.caster(), patch, emitter.patch,
                                             key + static_cast<std::uint32_t>(k), own, rays);
    }
    return sum;
  }

  const Scene& scene_;
  const ElementMesh& mesh_;
  std::vector<Emitter> emitters_;
  std::size_t least_rays_;        // of all elements together
  std::vector<double> exchange_;  // by element, then emitter
};

// Half of the samples on the lights, half of the directions cosine-distributed, combined by the balance
// heuristic (Veach 1997, section 9.2.2): neither small nor huge nor touching lights are a problem.
C3d sampled_irradiance(const Scene& scene, const Lights& lights, const ElementMesh& mesh,
                       const DiffuseResponse& response, std::uint32_t samples, std::uint32_t seed,
                       std::uint32_t element, std::uint64_t& rays) {
  const ElementSampler sample(mesh, element);
  C3d sum(0.0);
  for (std::uint32_t k = 0; k < samples; ++k) {
    Sampler sampler(seed, element, k);
    const ElementPoint point = sample(sampler.next_2d());
    const V3f start = point.ray_position(), normal(point.normal);

    const LightSample light = lights.sample({start, normal, true}, sampler.next_2d());
    const float cosine = light.direction.dot(normal);
    if (light.pdf_w > 0.0f && cosine > 0.0f && !is_black(light.radiance)) {
      ++rays;
      if (!scene.caster().occluded(start, light.position))
        sum += C3d(light.radiance) * (response.at(static_cast<double>(cosine)) *
                                      (cosine / (light.pdf_w + cosine_hemisphere_pdf_w(cosine))));
    }

    const V3f direction = Frame(normal).to_world(square_to_cosine_hemisphere(sampler.next_2d()));
    const Ray ray{start, direction};
    const Hit hit = scene.caster().intersect(ray);
    ++rays;
    if (hit.escaped()) continue;
    const SurfacePoint seen = scene.surface_point(ray, hit);
    const float cosine_seen = direction.dot(normal);
    const C3f& radiance = scene.emitted_radiance(seen);
    if (cosine_seen > 0.0f && !is_black(radiance))
      sum += C3d(radiance) * (response.at(static_cast<double>(cosine_seen)) *
                              (cosine_seen / (lights.pdf_w({start, normal, true}, direction, hit.t, seen) +
                                              cosine_hemisphere_pdf_w(cosine_seen))));
  }
  return sum / static_cast<double>(samples);
}

// More emitters than can be evaluated, or analytic surfaces, or elements that are not seen as a whole.
std::vector<C3d> sampled_irradiance(const Scene& scene, const ElementMesh& mesh,
                                    const ElementResponse& response, std::size_t least_rays, std::uint32_t seed,
                                    std::uint64_t& rays) {
  std::vector<C3d> irradiance(mesh.count(), C3d(0.0));
  const Lights lights(scene.shapes());  // without the sky
  if (lights.empty() || mesh.count() == 0) return irradiance;
  const auto samples = static_cast<std::uint32_t>(std::clamp<std::size_t>(least_rays / mesh.count(), 64, 4096));
  std::atomic<std::uint64_t> rays_cast{0};
  parallel_for(mesh.count(), 32, [&](std::size_t begin, std::size_t end) {
    throw_if_interrupted();
    std::uint64_t own_rays = 0;
    for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i) {
      if (!(mesh.area(i) > 0.0)) continue;
      // Buried points receive nothing: the exposed ones have it all.
      irradiance[i] = sampled_irradiance(scene, lights, mesh, response.of(i), samples, seed, i, own_rays) *
                      (mesh.whole_area(i) / mesh.area(i));
    }
    rays_cast += own_rays;
  });
  rays += rays_cast;
  return irradiance;
}

DirectIrradiance from_emitters(const Scene& scene, const ElementMesh& mesh, FormFactorMethod method,
                               bool conserve, const ElementResponse& response, std::size_t least_rays,
                               std::uint32_t seed, std::uint64_t& rays) {
  // Lambert's formula is for whole elements.
  std::vector<Emitter> emitters;
  if (mesh.weights().empty()) emitters = analytic_emitters(scene, mesh);
  if (emitters.empty()) return {sampled_irradiance(scene, mesh, response, least_rays, seed, rays), {}};
  AnalyticDirect analytic(scene, mesh, std::move(emitters), least_rays);
  analytic.find_exchange(method, seed, rays);
  if (conserve) analytic.conserve();
  return analytic.result(response, seed);
}

}  // namespace

DirectIrradiance direct_irradiance(const Scene& scene, const ElementMesh& mesh, FormFactorMethod method,
                                   bool conserve, std::uint32_t seed, std::uint64_t& rays,
                                   std::size_t least_rays) {
  const ElementResponse response(scene, mesh);
  DirectIrradiance direct = from_emitters(scene, mesh, method, conserve, response, least_rays, seed, rays);
  const std::vector<C3d> punctual = punctual_irradiance(scene, mesh, response, seed, rays);
  for (std::size_t i = 0; i < mesh.count(); ++i) direct.irradiance[i] += punctual[i];
  return direct;
}

}  // namespace twopass
