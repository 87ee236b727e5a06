// Form factors between whole shapes: what an engineer asks for, and a check of everything else.
#pragma once

#include <string>
#include <vector>

#include "radiosity/options.h"
#include "render/scene/scene.h"

namespace twopass {

struct FormFactorOptions {
  FormFactorMethod method = FormFactorMethod::automatic;
  std::uint32_t rays = 0;  ///< of each shape, for the method `rays`; 0: chosen
  bool occlusion = true;   ///< false: shapes do not hide each other
  std::uint32_t seed = 0;
  int hemicube_resolution = 64;  ///< pixels along an edge; even, 2 to `largest_hemicube_resolution`
};

inline constexpr int largest_hemicube_resolution = 4096;

struct FormFactorTable {
  std::vector<std::string> names;  ///< by shape
  std::vector<double> areas;       ///< by shape, of one side
  /// F[i][j]: the fraction of the diffuse power leaving the front of shape i that arrives at the front of shape
  /// j. areas[i] F[i][j] = areas[j] F[j][i] up to one rounding. F[i][i] is not zero for concave shapes. Rows of
  /// shapes without area are zero.
  std::vector<std::vector<double>> F;
  FormFactorMethod method = FormFactorMethod::exact;
  /// The fronts see nothing but fronts, as far as test rays can tell: then each F[i] should add up to one, and
  /// with occlusion is made to (R27).
  bool closed = false;
  /// Largest |Sum_j F[i][j] - 1| of the shapes with area, as returned and before (R27). In scenes that are not
  /// closed: what is open.
  double closure_error = 0.0, closure_error_before = 0.0;
  std::size_t degenerate_triangles = 0;  ///< left out because they have no area
  std::vector<std::string> notes;        ///< what the user should know
};

/// `exact`: analytic over pairs of triangles, to about 1e-9 where nothing is in the way and to about 1e-4 of
/// the unoccluded value elsewhere (R26). `point`: from the triangles' centroids. `hemicube`: likewise, by rays
/// through the pixels of a hemicube. `rays`: by chance, with the analytic factors as control (R25), so that
/// only what is partly hidden has noise. `automatic`: exact, but rays where there are spheres or many
/// triangles. Results do not depend on the unit of length nor, as far as the coordinates have digits, on the
/// origin. Throws Error when `exact`, `point` or `hemicube` meet a sphere, or pairs of too many triangles, and
/// for hemicubes of an impossible resolution.
FormFactorTable form_factor_table(const Scene& scene, const FormFactorOptions& options = {});

}  // namespace twopass
