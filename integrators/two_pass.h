// The second pass: one-bounce final gather over the radiosity solution.
//
// Camera path C S* x, with x the first diffuse vertex. Each family of light paths is carried exactly once:
//
//   family            at x                                    carried by
//   Le, Le S+         emission seen by the camera             the camera path, in full
//   L D               direct light at x                       next-event estimation + gather ray, MIS
//   L S+ D            caustic at x                            the map of caustics; without one, the gather ray
//                                                             that goes S+ to L, in full
//   L (D|S)* D S* D   light from a diffuse vertex y           gather ray S* to y: solution's irradiance at y,
//   times the
//                                                             reflectance at y; no next-event estimation at y
//
// A vertex is either evaluated (next-event estimation, and the walk goes on) or looked up (the solution, and
// the walk ends), never both. Where y is glossy, too, what it reflects diffusely is looked up, and the rest is
// evaluated. y is evaluated like x instead of looked up when the gather ray is too short for
// the elements to resolve (contact fallback), or when no solution was computed; its own gather ray then takes
// the part of y's.
#pragma once

#include "integrators/integrator.h"
#include "integrators/pass_one.h"
#include "radiosity/caustic_map.h"
#include "radiosity/guide.h"
#include "radiosity/indirect_field.h"
#include "radiosity/solution.h"

namespace twopass {

class Vertex;
enum class Step : std::uint8_t;

class TwoPass final : public Integrator {
 public:
  /// Where the radiosity pass was skipped every vertex is evaluated. REQUIRES: the scene outlives the
  /// integrator; the solution holds no more bounces than the limits allow.
  TwoPass(const Scene& scene, const PassOne& pass_one, const PathLimits& limits)
      : scene_(scene),
        solution_(pass_one.solution),
        field_(pass_one.field),
        guide_(pass_one.guide),
        caustics_(pass_one.caustics),
        least_scatterings_(pass_one.gathers_twice ? 2 : 1),
        limits_(limits) {}
  void trace(std::span<PathSample> samples, RayCounts& counts) const override;

 private:
  void look_ahead(Vertex& vertex) const;
  [[nodiscard]] Step at(Vertex& vertex) const;
  void add_caustics(Vertex& vertex) const;
  [[nodiscard]] IndirectField::LookUp look_up(const Vertex& vertex) const;

  const Scene& scene_;
  const Solution* solution_;
  const IndirectField* field_;
  const Guide* guide_;
  const CausticMap* caustics_;
  int least_scatterings_;  // before the solution is read
  PathLimits limits_;
};

}  // namespace twopass
