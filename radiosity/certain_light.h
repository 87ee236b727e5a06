// Where it is certain which lamps shine, element by element, and what they send there: direct light without
// noise, bias and shadow rays.
#pragma once

#include <bit>
#include <vector>

#include "radiosity/elements.h"
#include "radiosity/lamp_light.h"

namespace twopass {

/// A lamp for receivers that see all of its front, and have all of it above their horizon.
class LampInView {
 public:
  /// REQUIRES: a polygon of at most four corners.
  explicit LampInView(const Polygon& polygon);
  /// The form factor from a differential element to the lamp, as point_form_factor(), at a fraction of its
  /// time; relative error below 1e-6 (R47).
  [[nodiscard]] double form_factor(const V3f& point, const V3f& normal) const;

 private:
  using Four [[gnu::vector_size(32)]] = double;
  Four x_, y_, z_;  // of the corners; the last one again where there are but three
};

/// Const and thread-safe once built.
class CertainLight {
 public:
  /// Asks (R43) of every flat element. Nothing is known where that would take too long. REQUIRES: the scene
  /// outlives it; the mesh is of the scene.
  CertainLight(const Scene& scene, const ElementMesh& mesh);

  /// Whether it is certain of every lamp that all of it shines on all of the element, or nothing of it; false
  /// for what is no flat element.
  [[nodiscard]] bool knows(std::uint32_t element) const {
    return element < seen_.size() && seen_[element].is_known;
  }
  /// Asks for what is kept of an element, so that it is at hand later.
  void prefetch(std::uint32_t element) const {
    if (element < seen_.size()) __builtin_prefetch(&seen_[element]);
  }
  /// Calls `add(irradiance, number of the light)` for each of the lamps that shine on a known element, at a
  /// point of it with its unit normal; W/m2, exact but for rounding.
  template <class Add>
  void visit(std::uint32_t element, const V3f& point, const V3f& normal, const Add& add) const {
    const bool is_above = seen_[element].are_above;
    for (LampLight::Lamps lamps = seen_[element].lamps; lamps != 0; lamps &= lamps - 1) {
      const int k = std::countr_zero(lamps);
      const auto lamp = static_cast<std::size_t>(k);
      add(is_above ? exitance_[lamp] * static_cast<float>(in_view_[lamp].form_factor(point, normal))
                   : C3f(lamps_.irradiance_of(k, V3d(point), V3d(normal))),
          lamps_.number_of(k));
    }
  }
  /// The part of the elements' area where it is certain, in [0, 1].
  [[nodiscard]] double share() const { return share_; }

 private:
  struct Seen {
    LampLight::Lamps lamps = 0;
    bool is_known = false;
    bool are_above = false;  // no lamp reaches below the element's plane
  };

  LampLight lamps_;
  std::vector<LampInView> in_view_;  // by lamp
  std::vector<C3f> exitance_;        // by lamp
  std::vector<Seen> seen_;           // by element; none at all: nothing is known
  double share_ = 0.0;
};

}  // namespace twopass
