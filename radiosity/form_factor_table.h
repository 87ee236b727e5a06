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
};

struct FormFactorTable {
  std::vector<std::string> names;  ///< by shape
  std::vector<double> areas;       ///< by shape, of one side
  /// F[i][j]: the fraction of the diffuse power leaving the front of shape i that arrives at the front of shape
  /// j. areas[i] F[i][j] = areas[j] F[j][i]. F[i][i] is not zero for concave shapes.
  std::vector<std::vector<double>> F;
  FormFactorMethod method;
  /// Largest |Sum_j F[i][j] - 1|: the error in a closed scene, what is open in others.
  double closure_error = 0.0;
};

/// `exact`: analytic over pairs of triangles, to about 1e-9; partly hidden pairs are divided until the visible
/// part is known to about 1e-3. `point`: from the triangles' centroids. `rays`: by chance, about 1 /
/// sqrt(rays). `automatic`: exact, but rays where there are spheres or thousands of triangles. Throws Error
/// when `exact` or `point` meet a sphere or too many triangles, and when all rays are asked to ignore
/// obstacles, and for `hemicube`, which sees from elements.
FormFactorTable form_factor_table(const Scene& scene, const FormFactorOptions& options = {});

}  // namespace twopass
