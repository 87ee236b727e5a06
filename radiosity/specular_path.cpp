#include "radiosity/specular_path.h"

#include "materials/lobes.h"

namespace twopass {

namespace {
constexpr int most_surfaces = 64;
constexpr int surfaces_before_roulette = 4;
}  // namespace

// Draws where to go from the present surface, other than diffusely. False: absorbed.
bool SpecularPath::scatter() {
  SurfacePoint& point = end_.point;
  Bsdf storage;
  const Bsdf& bsdf = scene_.resolve(point, ray_.direction, storage, [this] { return sampler_.next_1d(); });
  const V3f wo = point.shading.to_local(-ray_.direction);
  const auto scattered = sample(bsdf, wo, sampler_.next_2d());
  if (!scattered) return false;
  C3f weight = scattered->weight;
  if (!scattered->is_specular && !is_black(diffuse_reflectance(bsdf)))
    weight *= C3f(1.0f) - diffuse_share(bsdf, wo, scattered->wi);
  const float eta2 = scattered->eta * scattered->eta;
  power_ *= weight * eta2;
  if (is_black(power_)) return false;
  radiance_scale_ /= eta2;
  if (surface_ >= surfaces_before_roulette) {
    const float survival = std::min(1.0f, max_component(power_));
    if (!(sampler_.next_1d() < survival)) return false;
    power_ *= 1.0f / survival;
  }
  ray_.direction = point.shading.to_world(scattered->wi);
  ray_.origin = spawn_position(point, ray_.direction);
  return true;
}

bool SpecularPath::next() {
  while (!is_over_ && surface_ < most_surfaces) {
    if (!scatter()) break;
    ++surface_;
    const Hit hit = scene_.caster().intersect(ray_);
    ++end_.rays;
    end_.escaped = is_over_ = hit.escaped();
    if (!is_over_) {
      end_.point = scene_.surface_point(ray_, hit);
      const MaterialSide& side = scene_.side(end_.point);
      if (side.scatters_without_diffusing()) continue;
      is_over_ = !is_more_than_diffuse(side);
    }
    end_.weight = carried_ == Carried::radiance ? power_ * radiance_scale_ : power_;
    end_.direction = ray_.direction;
    return true;
  }
  is_over_ = true;
  return false;
}

SpecularPathEnd follow_specular(const Scene& scene, const Ray& ray, const SurfacePoint& point, Carried carried,
                                Sampler& sampler) {
  SpecularPath path(scene, ray, point, carried, sampler);
  path.next();
  return path.end();
}

}  // namespace twopass
