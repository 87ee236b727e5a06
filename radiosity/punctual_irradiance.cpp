#include "radiosity/punctual_irradiance.h"

#include <atomic>

#include "radiosity/visibility.h"
#include "render/core/interrupt.h"
#include "render/core/parallel.h"
#include "render/core/sampler.h"

namespace twopass {

namespace {

// Shadow rays an element, shared by the lights. Points of up to four lights number 64, of more at least 4.
constexpr std::size_t rays_per_element = 256;
constexpr std::size_t most_points = 64;

class PunctualIrradiance {
 public:
  PunctualIrradiance(const Scene& scene, const ElementMesh& mesh, const ElementResponse& response,
                     std::uint32_t seed)
      : scene_(scene),
        mesh_(mesh),
        response_(response),
        seed_(seed),
        beyond_(2.0f * (scene.bounds().max - scene.bounds().min).length()),
        asks_all_(scene.punctual_lights().size() <= most_punctual_lights_asked),
        lights_({}, scene.punctual_lights(), no_sky_, scene.bounds()),
        points_(static_cast<std::uint32_t>(
            asks_all_ ? std::min(most_points, rays_per_element / scene.punctual_lights().size())
                      : rays_per_element)) {}

  // REQUIRES: the element has an area.
  [[nodiscard]] C3d operator()(std::uint32_t element, std::uint64_t& rays) const {
    const ElementSampler sample(mesh_, element);
    const DiffuseResponse& response = response_.of(element);
    C3d sum(0.0);
    for (std::uint32_t k = 0; k < points_; ++k) {
      Sampler sampler(seed_, element, k);
      const ElementPoint point = sample(sampler.next_2d());
      sum += asks_all_ ? from_all(point, response, rays) : from_one(point, response, sampler, rays);
    }
    // Buried points receive nothing: the exposed ones have it all.
    return sum * (mesh_.whole_area(element) / (points_ * mesh_.area(element)));
  }

 private:
  [[nodiscard]] C3d from_all(const ElementPoint& point, const DiffuseResponse& response,
                             std::uint64_t& rays) const {
    const V3f start = point.ray_position();
    C3d sum(0.0);
    for (const PunctualLight& light : scene_.punctual_lights()) {
      const Illumination seen = illumination(light, start);
      const float distance = std::isfinite(seen.distance) ? seen.distance : beyond_;
      sum +=
          received(point, response, seen.direction, start + seen.direction * distance, seen.irradiance, rays);
    }
    return sum;
  }

  [[nodiscard]] C3d from_one(const ElementPoint& point, const DiffuseResponse& response, Sampler& sampler,
                             std::uint64_t& rays) const {
    const V3f start = point.ray_position();
    const LightSample light = lights_.sample({start, V3f(point.normal), true}, sampler.next_2d());
    if (!(light.pdf_w > 0.0f)) return C3d(0.0);
    return received(point, response, light.direction, light.position, light.radiance, rays) *
           (1.0 / light.pdf_w);
  }

  // `irradiance`: of a surface that faces the light.
  [[nodiscard]] C3d received(const ElementPoint& point, const DiffuseResponse& response, const V3f& direction,
                             const V3f& end, const C3f& irradiance, std::uint64_t& rays) const {
    const double cosine = point.normal.dot(V3d(direction));
    if (!(cosine > 0.0) || is_black(irradiance)) return C3d(0.0);
    ++rays;
    return C3d(irradiance) * (cosine * response.at(cosine) * visible_share(scene_, point.ray_position(), end));
  }

  const Scene& scene_;
  const ElementMesh& mesh_;
  const ElementResponse& response_;
  std::uint32_t seed_;
  float beyond_;  // so far from any point of the scene all of it is left behind
  bool asks_all_;
  Environment no_sky_;  // before lights_, which keep a pointer to it
  Lights lights_;
  std::uint32_t points_;
};

}  // namespace

std::vector<C3d> punctual_irradiance(const Scene& scene, const ElementMesh& mesh,
                                     const ElementResponse& response, std::uint32_t seed, std::uint64_t& rays) {
  std::vector<C3d> irradiance(mesh.count(), C3d(0.0));
  if (scene.punctual_lights().empty()) return irradiance;
  const PunctualIrradiance irradiance_of(scene, mesh, response, seed);
  std::atomic<std::uint64_t> rays_cast{0};
  parallel_for(mesh.count(), 32, [&](std::size_t begin, std::size_t end) {
    throw_if_interrupted();
    std::uint64_t own_rays = 0;
    for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i)
      if (mesh.area(i) > 0.0) irradiance[i] = irradiance_of(i, own_rays);
    rays_cast += own_rays;
  });
  rays += rays_cast;
  return irradiance;
}

}  // namespace twopass
