// The second pass: one-bounce final gather over the radiosity solution.
//
// Camera path C S* x, with x the first diffuse vertex. Each family of light paths is carried exactly once:
//
//   family            at x                                    carried by
//   Le, Le S+         emission seen by the camera             the camera path, in full
//   L D               direct light at x                       next-event estimation + gather ray, MIS
//   L S+ D            caustic at x                            gather ray that goes S+ to L, in full
//   L (D|S)* D S* D   light from a diffuse vertex y           gather ray S* to y: solution's irradiance at y,
//   times the
//                                                             reflectance at y; no next-event estimation at y
//
// A vertex is either evaluated (next-event estimation, and the walk goes on) or looked up (the solution, and
// the walk ends), never both. y is evaluated like x instead of looked up when the gather ray is too short for
// the elements to resolve (contact fallback), or when no solution was computed; its own gather ray then takes
// the part of y's.
#pragma once

#include "integrators/integrator.h"
#include "radiosity/indirect_field.h"
#include "radiosity/solution.h"

namespace twopass {

class Vertex;

class TwoPass final : public Integrator {
 public:
  /// `solution` may be null where the radiosity pass was skipped: then every vertex is evaluated.
  /// REQUIRES: scene and solution outlive the integrator; the solution holds no more bounces than the limits
  /// allow.
  TwoPass(const Scene& scene, const Solution* solution, const IndirectField* field, const PathLimits& limits)
      : scene_(scene), solution_(solution), field_(field), limits_(limits) {}
  void trace(std::span<PathSample> samples, RayCounts& counts) const override;

 private:
  [[nodiscard]] bool resolves(const SurfacePoint& point, float distance) const;
  [[nodiscard]] std::optional<C3f> indirect(const Vertex& vertex) const;

  const Scene& scene_;
  const Solution* solution_;
  const IndirectField* field_;
  PathLimits limits_;
};

}  // namespace twopass
