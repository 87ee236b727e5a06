#include "render/scene/ray_cone.h"

namespace twopass {

namespace {

// Of the pixel with this upper left corner, along its narrower side.
RayCone pixel_cone(const Camera& camera, const V2f& corner) {
  const Ray ray = camera.ray(corner).ray, right = camera.ray(corner + V2f(1.0f, 0.0f)).ray,
            below = camera.ray(corner + V2f(0.0f, 1.0f)).ray;
  return {std::min((right.origin - ray.origin).length(), (below.origin - ray.origin).length()),
          std::min((right.direction - ray.direction).length(), (below.direction - ray.direction).length())};
}

}  // namespace

RayCone sample_cone(const Camera& camera, int width, int height, int samples) {
  const auto right = static_cast<float>(width), bottom = static_cast<float>(height);
  RayCone narrowest = pixel_cone(camera, V2f(0.5f * right, 0.5f * bottom));
  for (const V2f& corner : {V2f(0.0f, 0.0f), V2f(right, 0.0f), V2f(0.0f, bottom), V2f(right, bottom)}) {
    const RayCone cone = pixel_cone(camera, corner);
    narrowest.width = std::min(narrowest.width, cone.width);
    narrowest.spread = std::min(narrowest.spread, cone.spread);
  }
  // Pharr, Jakob and Humphreys, Physically Based Rendering, 4th edition, section 10.1: more samples look at
  // less each, down to an eighth, so that pictures converge to what they would be without filtering.
  constexpr float least = 0.125f;
  const float share = samples > 0 ? std::max(least, 1.0f / std::sqrt(static_cast<float>(samples))) : least;
  return {narrowest.width * share, narrowest.spread * share, share};
}

}  // namespace twopass
