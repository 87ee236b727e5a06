// Path tracing that uses the radiosity solution without believing it: paths are guided to where the solution
// says that light comes from, and are ended early at the price of what it says that they would have found.
// Whatever the solution holds, the expectation is that of the path tracer.
#pragma once

#include "integrators/integrator.h"
#include "integrators/pass_one.h"
#include "radiosity/certain_light.h"
#include "radiosity/guide.h"
#include "radiosity/solution.h"

namespace twopass {

class Vertex;
enum class Step : std::uint8_t;

class Unbiased final : public Integrator {
 public:
  /// Without solution or guide, paths are ended as in the path tracer, or drawn as there. Clamps have the paths
  /// ended as in the path tracer, too, and limits of less than 16 edges: the solution knows nothing of them.
  /// REQUIRES: the scene outlives the integrator.
  Unbiased(const Scene& scene, const PassOne& pass_one, const PathLimits& limits);
  void trace(std::span<PathSample> samples, RayCounts& counts) const override;

 private:
  void look_ahead(Vertex& vertex) const;
  [[nodiscard]] Step at(Vertex& vertex) const;
  void record(const Vertex& vertex, const Irradiance& irradiance) const;
  C3f add_direct(Vertex& vertex, std::uint32_t element) const;

  const Scene& scene_;
  const Solution* solution_;
  const Guide* guide_;
  PathLimits limits_;
  bool returns_cached_;
  std::optional<CertainLight> certain_;  // none: direct light is sampled everywhere
};

}  // namespace twopass
