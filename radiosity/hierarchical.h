// Hierarchical radiosity: the balance solved over links between groups of elements instead of pairs of
// elements.
#pragma once

#include "radiosity/enforce.h"
#include "radiosity/linked_exchange.h"
#include "radiosity/solvers.h"
#include "render/scene/scene.h"

namespace twopass {

struct HierarchicalInput {
  std::span<const C3f> reflectance;  ///< in [0, 1)
  std::span<const C3d> direct;       ///< H, W/m2
  const SpecularLinks& specular;
  const RowSums& sums;
  int max_reflections = -1;  ///< as in RadiosityOptions
};

struct HierarchicalResult {
  SolverResult solution;  ///< its error's bound: `iteration_bound` + `discretisation`; iterations of all rounds
  double iteration_bound = 0.0;  ///< guaranteed for the equations as linked (R16)
  double discretisation = 0.0;   ///< estimate of what the links are off by (R35)
  double closure_error = 0.0;    ///< largest |sum - target| / area before enforcement; 0 if not closed
  std::size_t links = 0;         ///< between nodes; each serves both directions
  std::size_t specular_links = 0;
  std::size_t rounds = 0;  ///< of linking and solving
  std::size_t memory_bytes = 0;
  std::uint64_t rays = 0;
};

/// Links and solves in turns, with ever smaller errors allowed to a link (R36), until `stop.relative_error` is
/// estimated to be kept: a tenth of it by the iteration, the rest by the links. Elements exchange by links of
/// their own where nothing larger is good enough, with the numbers of the method `exact`. The same bits on any
/// number of threads. `stop.max_iterations`: sweeps of each round.
HierarchicalResult solve_hierarchical(const Scene& scene, const ElementMesh& mesh,
                                      const HierarchicalInput& input, const StopRule& stop, std::uint32_t seed);

}  // namespace twopass
