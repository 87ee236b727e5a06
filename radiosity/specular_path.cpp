#include "radiosity/specular_path.h"

#include "materials/lobes.h"
#include "render/scene/incident.h"

namespace twopass {

namespace {
constexpr int most_surfaces = 64;
constexpr int surfaces_before_roulette = 4;
// Lobes with less density than this, per steradian, blur what they reflect over some degrees.
constexpr float least_sharp_pdf_w = 100.0f;

// What is left of a value of the model without the diffuse part.
C3f glossy_part(const Bsdf& bsdf, const V3f& wo, const V3f& wi, const C3f& value) {
  if (is_black(diffuse_reflectance(bsdf))) return value;
  return value * (C3f(1.0f) - diffuse_share(bsdf, wo, wi));
}
}  // namespace

// (R52): the light that a lamp sends over the glossy part of the present surface.
void SpecularPath::sample_lamps(const Bsdf& bsdf, const V3f& wo) {
  const SurfacePoint& point = end_.point;
  const Incident incident = sample_incident(scene_, point, bsdf, sampler_.next_2d());
  if (incident.reached == 0.0f || is_black(incident.light.radiance)) return;
  const LightSample& light = incident.light;
  const BsdfValue at = visit_model(bsdf, [&](const auto& model) { return evaluate(model, wo, incident.wi); });
  const C3f glossy = glossy_part(bsdf, wo, incident.wi, at.value);
  if (is_black(glossy)) return;
  ++end_.rays;
  const float visible = scene_.transmittance({spawn_position(point, light.direction), light.position});
  const float weight = light.is_delta ? 1.0f : power_heuristic(light.pdf_w, at.pdf_w);
  sampled_ +=
      power_ * radiance_scale_ * glossy * light.radiance * (incident.reached * visible * weight / light.pdf_w);
}

// The share of light met by chance at the present end (integrators, I3).
float SpecularPath::lamp_weight() const {
  if (pdf_w_ == 0.0f) return 1.0f;
  const Lights& lights = scene_.lights();
  return power_heuristic(pdf_w_, end_.escaped ? lights.escaped_pdf_w(receiver_, ray_.direction)
                                              : lights.pdf_w(receiver_, ray_.direction, distance_, end_.point));
}

// Draws where to go from the present surface, other than diffusely. False: absorbed.
bool SpecularPath::scatter(bool samples_lamps) {
  SurfacePoint& point = end_.point;
  Bsdf storage;
  const Bsdf& bsdf = scene_.resolve(point, ray_.direction, storage, [this] { return sampler_.next_1d(); });
  const V3f wo = point.shading.to_local(-ray_.direction);
  samples_lamps = samples_lamps && !is_specular(bsdf) && !scene_.lights().empty();
  if (samples_lamps) sample_lamps(bsdf, wo);
  const auto scattered = sample(bsdf, wo, sampler_.next_2d());
  if (!scattered) return false;
  // Lamps are sampled through holes.
  if (!std::holds_alternative<Null>(bsdf)) {
    pdf_w_ = samples_lamps && !scattered->is_specular ? scattered->pdf_w : 0.0f;
    receiver_ = receiver_at(point, bsdf);
    distance_ = 0.0f;
  }
  end_.is_blurred = end_.is_blurred || (!scattered->is_specular && scattered->pdf_w < least_sharp_pdf_w);
  const C3f weight =
      scattered->is_specular ? scattered->weight : glossy_part(bsdf, wo, scattered->wi, scattered->weight);
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

bool SpecularPath::next(bool samples_lamps) {
  while (!is_over_ && surface_ < most_surfaces) {
    if (!scatter(samples_lamps)) break;
    ++surface_;
    const Hit hit = scene_.caster().intersect(ray_);
    ++end_.rays;
    end_.escaped = is_over_ = hit.escaped();
    distance_ += hit.t;
    if (!is_over_) {
      end_.point = scene_.surface_point(ray_, hit);
      const MaterialSide& side = scene_.side(end_.point);
      if (side.scatters_without_diffusing()) continue;
      is_over_ = !is_more_than_diffuse(side);
    }
    end_.lamp_weight = lamp_weight();
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
