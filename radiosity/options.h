// What the radiosity pass may be asked for, and what it says about its work. Names serve the command line,
// errors and documentation alike.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "render/core/names.h"
#include "render/scene/ray.h"

namespace twopass {

/// How form factors are found. All methods estimate the same numbers.
enum class FormFactorMethod {
  automatic,
  exact,     ///< analytic area to area, times the visible fraction; work and memory grow with elements squared
  point,     ///< analytic from the element's centroid to areas, times the visible fraction; likewise
  hemicube,  ///< what the element's centroid sees in the pixels of a half cube; work as `rays`, but not random
  rays,      ///< cosine-distributed rays; work grows with the elements
};

inline constexpr Named<FormFactorMethod> form_factor_method_names[] = {
    {"auto", FormFactorMethod::automatic}, {"exact", FormFactorMethod::exact},
    {"point", FormFactorMethod::point},    {"hemicube", FormFactorMethod::hemicube},
    {"rays", FormFactorMethod::rays},
};

/// How the system of equations is solved. All solvers have the same solution.
enum class Solver {
  automatic,
  jacobi,        ///< gathers: relaxes all rows at once
  gauss_seidel,  ///< gathers: relaxes one row after the other
  progressive,   ///< shoots: relaxes columns in the order of unshot power
  cg,            ///< conjugate gradients on the symmetric form
  lu,            ///< Gaussian elimination: exact, for at most `lu_max_elements`
  hierarchical,  ///< links between groups of elements instead of a matrix; finds its own form factors
  stochastic,    ///< shoots power along random rays; no form factors, memory grows with the elements only
};

inline constexpr Named<Solver> solver_names[] = {
    {"auto", Solver::automatic},
    {"jacobi", Solver::jacobi},
    {"gauss-seidel", Solver::gauss_seidel},
    {"progressive", Solver::progressive},
    {"cg", Solver::cg},
    {"lu", Solver::lu},
    {"hierarchical", Solver::hierarchical},
    {"stochastic", Solver::stochastic},
};

/// How the surfaces are divided into elements.
enum class Subdivision {
  automatic,  ///< adaptive if everything else is left to the program, too, and triangles are large enough to
              ///< divide
  uniform,    ///< all of about one size
  adaptive,   ///< refined in a few rounds where the radiosity changes, by adaptive substructuring
};

inline constexpr Named<Subdivision> subdivision_names[] = {
    {"auto", Subdivision::automatic},
    {"uniform", Subdivision::uniform},
    {"adaptive", Subdivision::adaptive},
};

struct RadiosityOptions {
  Solver solver = Solver::automatic;
  FormFactorMethod form_factors = FormFactorMethod::automatic;
  /// For the solver `progressive`: shoot an element's share of everybody's unshot power, too.
  bool overshoot = false;
  /// Relative error to aim at. The iteration stops when the guaranteed mean error of the radiosity over its
  /// mean is a tenth of it: an early stop always loses light, and the other errors need the rest.
  double relative_error = 0.01;
  /// Most elements, as long as one a triangle and side is enough; 0: a number that suits the method.
  std::size_t max_elements = 0;
  /// Pixels of the picture that will be gathered from the solution: the eye will not see the elements, so small
  /// pictures need fewer, and all need fewer rays for their form factors, where everything else is left to the
  /// program. 0: the solution itself will be seen.
  std::size_t gathered_pixels = 0;
  /// The relative error that such a picture may have: the number of elements goes with its inverse.
  double picture_error = 0.03;
  /// Most elements of such a picture by the time that it may take; 0: as many as it needs. Where that is fewer
  /// than 2048, or than one for eight sides of triangles, there are so many.
  std::size_t affordable_elements = 0;
  /// Towards lamps, from all elements together (DirectIrradiance).
  std::size_t least_direct_rays = 0;
  /// How often the number of elements that the program chooses for such a picture is quadrupled.
  int refinement = 0;
  /// Camera rays, evenly over that picture: adaptive subdivision looks at what they see as well as at where the
  /// power is. Empty: the solution is for any view.
  std::vector<Ray> view{};
  Subdivision subdivision = Subdivision::automatic;
  /// Rays an element, for the method `rays`, for what is seen through specular surfaces and for the solver
  /// `stochastic`; 0: chosen, for `stochastic` so that its noise is within `relative_error`, too.
  std::uint32_t rays_per_element = 0;
  /// Pixels along an edge of the top of a hemicube, for the method `hemicube`: even, from 2 to 1024.
  int hemicube_resolution = 64;
  std::uint32_t seed = 0;
  /// Most diffuse reflections of the indirect light, for pictures of limited depth; -1: all of them.
  int max_reflections = -1;
};

struct RadiosityStats {
  std::string solver, form_factors;  ///< names of what was used
  std::size_t elements = 0;
  /// Non-zero form factors, or links of groups (hierarchical), those through specular surfaces included.
  std::size_t links = 0;
  /// Sweeps over all elements (jacobi, gauss-seidel, stochastic) or links (hierarchical), products (cg), shots
  /// (progressive), 1 (lu).
  std::size_t iterations = 0;
  std::uint64_t rays = 0;  ///< all rays cast, shadow rays included
  /// Sum of area x |residual| over sum of area x radiosity, of the worst channel.
  double residual = 0.0;
  /// Guaranteed upper bound of the sum of area x |error| over the sum of area x radiosity, of the worst
  /// channel: the error of having stopped early, not that of the elements' size or of the form factors. For
  /// `stochastic` the expected noise is added, for `hierarchical` an estimate of what links between groups add:
  /// both are not guaranteed.
  double error_bound = 0.0;
  /// Largest |sum of an element's form factors - 1| before enforcement; 0 where the scene is not closed.
  double closure_error = 0.0;
  bool closed = false;  ///< no ray escaped or met a specular surface: the factors of an element add up to one
  int max_reflections = -1;  ///< as in RadiosityOptions
  std::size_t memory_bytes = 0;
  std::vector<std::string> notes;  ///< what the user should know, such as reflectances that had to be clamped
};

}  // namespace twopass
