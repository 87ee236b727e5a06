// The result of the radiosity pass: irradiance on both sides of every surface. It knows no camera, no pixel.
#pragma once

#include <memory>
#include <span>

#include "radiosity/caustic_particles.h"
#include "radiosity/elements.h"
#include "radiosity/irradiance.h"
#include "radiosity/options.h"
#include "render/scene/scene.h"

namespace twopass {

/// A radiosity solution. Const and thread-safe once built. REQUIRES: the scene outlives it.
class Solution {
 public:
  /// REQUIRES: one irradiance an element.
  Solution(ElementMesh mesh, std::vector<Irradiance> irradiance, RadiosityStats stats);
  ~Solution();
  Solution(Solution&&) noexcept;
  Solution& operator=(Solution&&) noexcept;

  /// Irradiance on the viewer's side, constant over each element; zero where there is no element.
  [[nodiscard]] Irradiance irradiance(const SurfacePoint& point) const {
    const std::uint32_t element = mesh_.find(point);
    return element == no_index ? Irradiance{} : irradiance_[element];
  }
  /// The same made continuous for the eye: averaged at the corners of elements that meet at less than 30
  /// degrees, and interpolated. Not closer to the truth. The first call prepares the averages.
  [[nodiscard]] Irradiance smooth_irradiance(const SurfacePoint& point) const;

  [[nodiscard]] const RadiosityStats& stats() const { return stats_; }
  [[nodiscard]] const ElementMesh& mesh() const { return mesh_; }
  /// By element.
  [[nodiscard]] std::span<const Irradiance> irradiances() const { return irradiance_; }

 private:
  struct Smooth;
  ElementMesh mesh_;
  std::vector<Irradiance> irradiance_;
  RadiosityStats stats_;
  std::unique_ptr<Smooth> smooth_;
};

/// Most elements that solve_radiosity() makes of the scene.
std::size_t element_limit(const Scene& scene, const RadiosityOptions& options);

/// Divides the surfaces into elements and solves for the balance of light between them, in the order: elements,
/// form factors, enforcement of their sums, direct irradiance, solver. `caustics`: the scene's, if they have
/// been shot before. The same bits on any number of threads. Throws Error when the chosen method cannot handle
/// so many elements, Interrupted when the user stops it.
Solution solve_radiosity(const Scene& scene, const RadiosityOptions& options = {},
                         const CausticParticles* caustics = nullptr);
/// The same on the elements of a solution of the scene, each of them cut so many times into four.
Solution solve_radiosity_again(const Scene& scene, const Solution& before, std::span<const std::uint8_t> cuts,
                               const RadiosityOptions& options, const CausticParticles* caustics = nullptr);
/// The same on the elements of another solution, of a scene with the same surfaces and materials under other
/// lights.
Solution solve_radiosity_on(const Scene& scene, const ElementMesh& elements,
                            const RadiosityOptions& options = {});

}  // namespace twopass
