#include "render/scene/environment.h"

#include "render/core/warp.h"

namespace twopass {

namespace {
constexpr float uniform_pdf_w = 1.0f / (4.0f * pi_f);
}

C3f Environment::radiance(const V3f&) const { return constant_; }

EnvironmentSample Environment::sample(const V2f& u) const {
  const V3f direction = square_to_sphere(u);
  return {direction, radiance(direction), uniform_pdf_w};
}

float Environment::pdf_w(const V3f&) const { return uniform_pdf_w; }

}  // namespace twopass
