// A surface that is not there to light: everything goes straight through (M15).
#pragma once

#include "materials/bsdf_sample.h"

namespace twopass {

struct Null {
  [[nodiscard]] C3f eval(const V3f&, const V3f&) const { return C3f(0.0f); }
  [[nodiscard]] float pdf_w(const V3f&, const V3f&) const { return 0.0f; }
  [[nodiscard]] std::optional<BsdfSample> sample(const V3f& wo, const V2f&) const {
    return BsdfSample{-wo, C3f(1.0f), 1.0f, 1.0f, true};
  }
  [[nodiscard]] C3f diffuse_reflectance() const { return C3f(0.0f); }
  [[nodiscard]] bool is_specular() const { return true; }
  template <class Self, class Visit>
  static void visit_parameters(Self&, Visit&&) {}
};

}  // namespace twopass
