// A scene made ready for one integrator: what is planned, pass one, and everything that the integrator reads.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "radiosity/guide.h"
#include "radiosity/options.h"
#include "render/certificate.h"
#include "render/console.h"
#include "render/plan.h"
#include "render/stopwatch.h"

namespace twopass {

struct SessionSettings {
  IntegratorKind integrator = IntegratorKind::two_pass;
  PathLimits limits;
  int width = 0, height = 0;  ///< of the whole picture, pixels
  std::uint32_t seed = 0;
  RadiosityOptions radiosity;  ///< of pass one; seed, depth and gathered pixels follow from the others
  std::string solution_file;   ///< a saved solution to use instead of solving; empty: none
};

class Session {
 public:
  /// Runs pass one as far as the plan has it, and says on the console what came of it. REQUIRES: the scene
  /// outlives the session; the plan is its own, for these settings. Throws Error, for a saved solution that is
  /// another's, too.
  Session(const Scene& scene, const SessionSettings& settings, const Plan& plan, const Console& console);

  [[nodiscard]] const Integrator& integrator() const { return *integrator_; }
  /// Null where the plan skips the pass.
  [[nodiscard]] const Solution* solution() const { return solution_ ? &*solution_ : nullptr; }
  /// The time of solving, and of deciding what can be looked up.
  [[nodiscard]] const Elapsed& radiosity_time() const { return radiosity_time_; }
  /// The time of learning directions.
  [[nodiscard]] const Elapsed& guide_time() const { return guide_time_; }

  /// Measures the bias of the window of a picture (I13), with a twentieth of the rays that the picture took.
  /// Clamps count as bias. None where nothing is read of a solution, or as certify() says.
  [[nodiscard]] std::optional<Certificate> certify_picture(const Camera& camera, const PixelWindow& window,
                                                           const RayCounts& counts) const;

 private:
  void solve(const RadiosityOptions& options, const std::string& solution_file, const Console& console);
  void prepare_field(const Console& console);

  const Scene& scene_;
  IntegratorKind kind_;
  PathLimits limits_;
  std::uint32_t seed_;
  std::optional<Solution> solution_;
  std::optional<IndirectField> field_;
  std::optional<Guide> guide_;
  std::unique_ptr<Integrator> integrator_;
  Elapsed radiosity_time_, guide_time_;
};

}  // namespace twopass
