#include "radiosity/specular_path.h"

namespace twopass {

namespace {
constexpr int most_surfaces = 64;
constexpr int surfaces_before_roulette = 4;
}  // namespace

SpecularPathEnd follow_specular(const Scene& scene, Ray ray, SurfacePoint point, Carried carried,
                                Sampler& sampler) {
  SpecularPathEnd end;
  C3f power(1.0f);              // what would arrive of a power: decides the roulette, whatever is carried
  float radiance_scale = 1.0f;  // the product of 1 / eta^2 on the way
  for (int surface = 0; surface < most_surfaces; ++surface) {
    Bsdf storage;
    const Bsdf& bsdf = scene.resolve(point, ray.direction, storage, [&] { return sampler.next_1d(); });
    const V3f wo = point.shading.to_local(-ray.direction);
    const auto scattered = sample(bsdf, wo, sampler.next_2d());
    if (!scattered) return end;
    const float eta2 = scattered->eta * scattered->eta;
    power *= scattered->weight * eta2;
    radiance_scale /= eta2;
    if (surface >= surfaces_before_roulette) {
      const float survival = std::min(1.0f, max_component(power));
      if (!(sampler.next_1d() < survival)) return end;
      power *= 1.0f / survival;
    }
    ray.direction = point.shading.to_world(scattered->wi);
    ray.origin = spawn_position(point, ray.direction);
    const Hit hit = scene.caster().intersect(ray);
    ++end.rays;
    end.escaped = hit.escaped();
    if (!hit.escaped()) point = scene.surface_point(ray, hit);
    if (hit.escaped() || !scene.side(point).scatters_without_diffusing()) {
      end.weight = carried == Carried::radiance ? power * radiance_scale : power;
      end.point = point;
      end.direction = ray.direction;
      return end;
    }
  }
  return end;
}

}  // namespace twopass
