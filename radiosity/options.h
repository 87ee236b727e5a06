// What the radiosity pass may be asked for, and what it says about its work. Names serve the command line,
// errors and documentation alike.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "render/core/names.h"

namespace twopass {

/// How form factors are found. All methods estimate the same numbers.
enum class FormFactorMethod {
  automatic,
  exact,  ///< analytic area to area, times the visible fraction; work and memory grow with elements squared
  point,  ///< analytic from the element's centroid to areas, times the visible fraction; likewise
  rays,   ///< cosine-distributed rays; work grows with the elements
};

inline constexpr Named<FormFactorMethod> form_factor_method_names[] = {
    {"auto", FormFactorMethod::automatic},
    {"exact", FormFactorMethod::exact},
    {"point", FormFactorMethod::point},
    {"rays", FormFactorMethod::rays},
};

/// How the system of equations is solved. All solvers have the same solution.
enum class Solver {
  automatic,
  gauss_seidel,  ///< gathers: relaxes one row after the other
  progressive,   ///< shoots: relaxes columns in the order of unshot power
  lu,            ///< Gaussian elimination: exact, for at most `lu_max_elements`
};

inline constexpr Named<Solver> solver_names[] = {
    {"auto", Solver::automatic},
    {"gauss-seidel", Solver::gauss_seidel},
    {"progressive", Solver::progressive},
    {"lu", Solver::lu},
};

/// How element sizes are chosen.
enum class Subdivision {
  uniform,   ///< one size everywhere
  adaptive,  ///< small where the irradiance changes quickly
};

inline constexpr Named<Subdivision> subdivision_names[] = {
    {"uniform", Subdivision::uniform},
    {"adaptive", Subdivision::adaptive},
};

struct RadiosityOptions {
  Solver solver = Solver::automatic;
  FormFactorMethod form_factors = FormFactorMethod::automatic;
  /// Relative error to aim at. The iteration stops when the guaranteed mean error of the radiosity over its
  /// mean is a tenth of it: an early stop always loses light, and the other errors need the rest.
  double relative_error = 0.01;
  /// Most elements, as long as one a triangle and side is enough; 0: a number that suits the method.
  std::size_t max_elements = 0;
  /// Rays an element, for the method `rays` and for what is seen through specular surfaces; 0: chosen.
  std::uint32_t rays_per_element = 0;
  Subdivision subdivision = Subdivision::uniform;
  /// Shoots more than the unshot light, to arrive sooner; for the solver `progressive`.
  bool overshoot = false;
  /// Pixels along an edge of the top face of a hemicube, for the method `hemicube`.
  int hemicube_resolution = 64;
  std::uint32_t seed = 0;
  /// Most diffuse reflections of the indirect light, for pictures of limited depth; -1: all of them.
  int max_reflections = -1;
};

struct RadiosityStats {
  std::string solver, form_factors;  ///< names of what was used
  std::size_t elements = 0;
  std::size_t links = 0;       ///< non-zero form factors, those through specular surfaces included
  std::size_t iterations = 0;  ///< sweeps over all rows (gauss-seidel), shots (progressive), 1 (lu)
  std::uint64_t rays = 0;      ///< all rays cast, shadow rays included
  /// Sum of area x |residual| over sum of area x radiosity, of the worst channel.
  double residual = 0.0;
  /// Guaranteed upper bound of the sum of area x |error| over the sum of area x radiosity, of the worst
  /// channel: the error of having stopped early, not that of the elements' size or of the form factors.
  double error_bound = 0.0;
  /// Largest |sum of an element's form factors - 1| before enforcement; 0 where the scene is not closed.
  double closure_error = 0.0;
  bool closed = false;  ///< no ray escaped or met a specular surface: the factors of an element add up to one
  int max_reflections = -1;  ///< as in RadiosityOptions
  std::size_t memory_bytes = 0;
  std::vector<std::string> notes;  ///< what the user should know, such as reflectances that had to be clamped
};

}  // namespace twopass
