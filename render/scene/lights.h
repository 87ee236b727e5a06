// All that shines in a scene, drawn for next-event estimation.
#pragma once

#include <span>
#include <variant>
#include <vector>

#include "render/core/distribution.h"
#include "render/scene/environment.h"
#include "render/scene/light_polygon.h"
#include "render/scene/light_tree.h"
#include "render/scene/punctual_light.h"
#include "render/scene/ray.h"
#include "render/scene/receiver.h"

namespace twopass {

/// A point of a light as seen from a receiver.
struct LightSample {
  V3f position;   ///< clear of the light's own surface: a shadow ray may end here
  V3f direction;  ///< unit, from the receiver to the light
  C3f radiance;   ///< towards the receiver; of a delta light, irradiance of a surface that faces it, W/m2
  float pdf_w;    ///< density of the direction in solid angle at the receiver, of a delta light the
                  ///< probability of having chosen it; 0: nothing to be had
  bool is_delta;  ///< a punctual light: no ray meets it, so its weight is 1
  std::uint32_t light = 0;  ///< its number, see Lights; not set where there is nothing to be had
};

/// Emitting polygons, spheres, disks and cylinders, punctual lights and the environment. What is at a finite
/// place is chosen by a tree (L7), what is infinitely far away takes a fixed share (L8). Const and thread-safe.
///
/// Lights have numbers: emitting shapes those of the shapes, from 0; then punctual lights, in their order; then
/// the environment.
class Lights {
 public:
  /// `bounds` hold everything that can receive light. REQUIRES: all arguments outlive the lights.
  Lights(std::span<const Shape> shapes, std::span<const PunctualLight> punctual, const Environment& environment,
         const Box3f& bounds);
  /// Emitting shapes alone. REQUIRES: the shapes outlive the lights.
  explicit Lights(std::span<const Shape> shapes) : Lights(shapes, {}, no_environment(), Box3f()) {}

  [[nodiscard]] bool empty() const { return entries_.empty() && distant_.empty(); }
  /// Number of lights that are chosen among: polygons (light_polygons()), analytic surfaces, punctual lights
  /// and the environment.
  [[nodiscard]] std::size_t count() const { return entries_.size() + distant_.size(); }
  /// The number of the environment.
  [[nodiscard]] std::uint32_t environment_number() const {
    return static_cast<std::uint32_t>(shapes_.size() + punctual_.size());
  }
  /// REQUIRES: !empty(), u in [0, 1)^2.
  [[nodiscard]] LightSample sample(const Receiver& receiver, const V2f& u) const;
  /// The density with which sample() draws the direction of `point`, seen from the receiver at `distance`. 0
  /// for points that do not emit towards the receiver.
  [[nodiscard]] float pdf_w(const Receiver& receiver, const V3f& direction, float distance,
                            const SurfacePoint& point) const;
  /// The density with which sample() draws `direction` towards the environment.
  [[nodiscard]] float escaped_pdf_w(const Receiver& receiver, const V3f& direction) const;

 private:
  // All about these is in the shape.
  struct SphereLight {};
  struct DiskLight {};
  struct CylinderLight {};
  struct Punctual {  // at a finite place
    std::uint32_t index;
  };
  struct Entry {
    std::uint32_t shape;   // no_index of punctual lights
    std::uint32_t number;  // of the light
    std::variant<LightPolygon, SphereLight, DiskLight, CylinderLight, Punctual> kind;
  };
  [[nodiscard]] std::uint32_t punctual_number(std::uint32_t index) const {
    return static_cast<std::uint32_t>(shapes_.size()) + index;
  }
  static const Environment& no_environment();
  void add_shape(std::uint32_t s, std::vector<LightBounds>& bounds);
  template <class Kind>
  void add_surface(std::uint32_t s, Kind kind, const LightBounds& surface, std::vector<LightBounds>& bounds);
  void add_punctual(std::uint32_t index, std::vector<LightBounds>& bounds, std::vector<double>& weights);
  /// Radiance that a point of the light sends to the side on which the receiver is.
  [[nodiscard]] C3f radiance(const Entry& entry, Side side, const V3f& position) const;
  [[nodiscard]] C3f textured_radiance(const Entry& entry, const V3f& position) const;
  [[nodiscard]] LightSample sample_of(const Entry& entry, const LightPolygon& polygon, const Receiver& receiver,
                                      const V2f& u) const;
  [[nodiscard]] LightSample sample_of(const Entry& entry, SphereLight, const Receiver& receiver,
                                      const V2f& u) const;
  [[nodiscard]] LightSample sample_of(const Entry& entry, DiskLight, const Receiver& receiver,
                                      const V2f& u) const;
  [[nodiscard]] LightSample sample_of(const Entry& entry, CylinderLight, const Receiver& receiver,
                                      const V2f& u) const;
  [[nodiscard]] LightSample sample_of(const Entry& entry, Punctual punctual, const Receiver& receiver,
                                      const V2f& u) const;
  [[nodiscard]] LightSample sample_distant(const Receiver& receiver, const V2f& u) const;
  [[nodiscard]] LightSample sample_punctual(std::uint32_t index, const Receiver& receiver) const;
  [[nodiscard]] V3f far_away(const Receiver& receiver, const V3f& direction) const;

  std::span<const Shape> shapes_;
  std::span<const PunctualLight> punctual_;
  const Environment* environment_;
  V3f center_{0.0f};
  float radius_ = 0.0f;  // of a sphere around the bounds
  std::vector<Entry> entries_;
  LightTree tree_;                       // over the entries
  std::vector<std::uint32_t> first_;     // by shape, into entry_of_: no_index where it does not emit
  std::vector<std::uint32_t> entry_of_;  // by primitive of the emitting shapes; no_index: without area
  std::vector<std::uint32_t> distant_;   // punctual lights infinitely far away; no_index: the environment
  DiscreteDistribution distant_choice_;
  float environment_probability_ = 0.0f;  // among the distant ones
  float distant_share_ = 0.0f;            // how often one of them is chosen
};

}  // namespace twopass
