#include "render/scene/punctual_light.h"

#include "render/scene/texture_hash.h"

namespace twopass {

namespace {

// The way from a receiver to a light.
struct Way {
  V3f direction;  // unit
  float distance;
  double attenuation;  // 1 / distance^2; 0 where the two coincide

  // A quotient beyond all numbers, of a receiver all but inside the light, counts as nothing.
  [[nodiscard]] Illumination carrying(const C3f& intensity) const {
    const C3d irradiance = C3d(intensity) * attenuation;
    const double most = std::max({irradiance.x, irradiance.y, irradiance.z});
    const bool fits = most <= static_cast<double>(std::numeric_limits<float>::max());
    return {direction, distance, fits ? C3f(irradiance) : C3f(0.0f)};
  }
};

Way way_to(const V3f& light, const V3f& receiver) {
  const V3d d = V3d(light) - V3d(receiver);
  const double distance2 = d.dot(d);
  if (!(distance2 > 0.0)) return {V3f(0.0f, 0.0f, 1.0f), 0.0f, 0.0};
  const double distance = std::sqrt(distance2);
  return {V3f(d / distance), static_cast<float>(distance), 1.0 / distance2};
}

Illumination illumination_of(const PointLight& light, const V3f& receiver) {
  const Way way = way_to(light.position, receiver);
  if (!light.profile) return way.carrying(light.intensity);
  return way.carrying(light.intensity * light.profile->candela(unit(light.frame.local(-way.direction))));
}

// (L20): 1 in the beam, falling linearly with the angle to 0.
float falloff(const SpotLight& light, float angle) {
  if (angle <= light.beam_width) return 1.0f;
  if (!(angle < light.cutoff_angle)) return 0.0f;
  return (light.cutoff_angle - angle) / (light.cutoff_angle - light.beam_width);
}

Illumination illumination_of(const SpotLight& light, const V3f& receiver) {
  const Way way = way_to(light.frame.position, receiver);
  const V3f local = light.frame.local(-way.direction);
  C3f intensity = light.intensity * falloff(light, std::atan2(std::hypot(local.x, local.y), local.z));
  if (light.texture && !is_black(intensity)) {
    const float scale = 0.5f / (local.z * std::tan(light.cutoff_angle));
    intensity *= color_at(*light.texture, V2f(std::clamp(0.5f + local.x * scale, 0.0f, 1.0f),
                                              std::clamp(0.5f + local.y * scale, 0.0f, 1.0f)));
  }
  return way.carrying(intensity);
}

Illumination illumination_of(const DirectionalLight& light, const V3f&) {
  return {-light.direction, infinity_f, light.irradiance};
}

Illumination illumination_of(const Projector& light, const V3f& receiver) {
  const Way way = way_to(light.frame.position, receiver);
  const V3f local = light.frame.local(-way.direction);
  const float cosine = -light.frame.forward.dot(way.direction);
  if (!(local.z > 0.0f && cosine > 0.0f)) return way.carrying(C3f(0.0f));
  const float scale = 0.5f / (local.z * light.tan_half_fov);
  const V2f uv(0.5f - local.x * scale, 0.5f - local.y * scale * aspect_of(*light.texture));
  const bool is_inside = uv.x >= 0.0f && uv.x <= 1.0f && uv.y >= 0.0f && uv.y <= 1.0f;
  if (!is_inside) return way.carrying(C3f(0.0f));
  // (L21) with the local z of the receiver as distance times the local z of the direction.
  return way.carrying(color_at(*light.texture, uv) * (light.scale * pi_f / (local.z * local.z * cosine)));
}

double power_of(const PointLight& light, double) {
  return (light.profile ? light.profile->flux() : 4.0 * pi) * mean_component(light.intensity);
}

double power_of(const SpotLight& light, double) {
  // The integral of (L20) over the cone.
  const double b = light.beam_width, c = light.cutoff_angle;
  const double slope = c > b ? (std::sin(c) - std::sin(b)) / (c - b) : std::cos(c);
  const C3f factor = light.texture ? mean_color(*light.texture) : C3f(1.0f);
  return 2.0 * pi * (1.0 - slope) * mean_component(light.intensity * factor);
}

double power_of(const DirectionalLight& light, double scene_radius) {
  return pi * scene_radius * scene_radius * mean_component(light.irradiance);
}

double power_of(const Projector& light, double) {
  // The irradiance of the plane z = 1 is pi times the texture (L21).
  const double half = light.tan_half_fov, area = 4.0 * half * half / aspect_of(*light.texture);
  return pi * area * light.scale * mean_component(mean_color(*light.texture));
}

void add(DataHash& hash, const LightFrame& frame) {
  hash.add(frame.position);
  for (const V3f& axis : frame.to_local) hash.add(axis);
  hash.add(frame.forward);
}

void add(DataHash& hash, const Texture* texture) {
  hash.add(std::uint64_t{texture != nullptr});
  if (texture) add_texture(hash, *texture);
}

void add(DataHash& hash, const PointLight& light) {
  hash.add(light.position);
  hash.add(light.intensity);
  hash.add(std::uint64_t{light.profile != nullptr});
  if (!light.profile) return;
  add(hash, light.frame);
  for (const auto* list :
       {&light.profile->vertical(), &light.profile->horizontal(), &light.profile->values()}) {
    hash.add(std::uint64_t{list->size()});
    for (const float x : *list) hash.add(x);
  }
}

void add(DataHash& hash, const SpotLight& light) {
  add(hash, light.frame);
  hash.add(light.intensity);
  hash.add(light.cutoff_angle);
  hash.add(light.beam_width);
  add(hash, light.texture.get());
}

void add(DataHash& hash, const DirectionalLight& light) {
  hash.add(light.direction);
  hash.add(light.irradiance);
}

void add(DataHash& hash, const Projector& light) {
  add(hash, light.frame);
  add(hash, light.texture.get());
  hash.add(light.scale);
  hash.add(light.tan_half_fov);
}

}  // namespace

LightFrame light_frame(const M44d& to_world) {
  const M44d inverse = to_world.inverse();
  LightFrame frame;
  frame.position = V3f(V3d(to_world[3][0], to_world[3][1], to_world[3][2]));
  for (int i = 0; i < 3; ++i) frame.to_local[i] = V3f(V3d(inverse[0][i], inverse[1][i], inverse[2][i]));
  frame.forward = V3f(V3d(to_world[2][0], to_world[2][1], to_world[2][2]));
  return frame;
}

Illumination illumination(const PunctualLight& light, const V3f& receiver) {
  return std::visit([&](const auto& kind) { return illumination_of(kind, receiver); }, light);
}

double power(const PunctualLight& light, double scene_radius) {
  return std::visit([&](const auto& kind) { return power_of(kind, scene_radius); }, light);
}

const char* kind_name(const PunctualLight& light) {
  constexpr const char* names[] = {"point", "spot", "directional", "projector"};
  return names[light.index()];
}

PunctualLight in_primaries(PunctualLight light, const ColorMatrix& primaries) {
  const auto textured = [](const std::shared_ptr<const Texture>& texture, const ColorMatrix& own) {
    return std::make_shared<const Texture>(in_primaries(*texture, own));
  };
  if (auto* point = std::get_if<PointLight>(&light)) {
    point->intensity = primaries(point->intensity);
  } else if (auto* spot = std::get_if<SpotLight>(&light)) {
    if (spot->texture)
      // The texture's factors are colours of the beam.
      spot->texture = textured(spot->texture, primaries.relative_to(spot->intensity));
    else
      spot->intensity = primaries(spot->intensity);
  } else if (auto* directional = std::get_if<DirectionalLight>(&light)) {
    directional->irradiance = primaries(directional->irradiance);
  } else {
    auto& projector = std::get<Projector>(light);
    projector.texture = textured(projector.texture, primaries);
  }
  return light;
}

std::uint64_t fingerprint(const PunctualLight& light) {
  DataHash hash;
  hash.add(std::uint64_t{light.index()});
  std::visit([&](const auto& kind) { add(hash, kind); }, light);
  return hash.value();
}

}  // namespace twopass
