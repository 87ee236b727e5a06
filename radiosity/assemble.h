// From a divided scene to the equations: surveys, form factors, their sums, direct light.
#pragma once

#include "radiosity/balance.h"
#include "radiosity/caustic_particles.h"
#include "radiosity/elements.h"
#include "radiosity/enforce.h"
#include "radiosity/options.h"
#include "radiosity/ray_survey.h"

namespace twopass {

/// Albedos of the elements, at most `largest_reflectance`; a note says where they were more.
std::vector<C3f> clamped_reflectances(const ElementMesh& mesh, RadiosityStats& stats);

/// Everything of the balance: form factors by `method`, enforced, and direct irradiance. Exposes the elements.
/// The statistics get rays, closure and notes. REQUIRES: method not automatic.
Balance assemble_balance(const Scene& scene, ElementMesh& mesh, const RadiosityOptions& options,
                         FormFactorMethod method, const CausticParticles& caustics, RadiosityStats& stats);

/// What solvers start from that find form factors by themselves.
struct FirstLight {
  std::vector<C3d> direct;  ///< irradiance by element, W/m2: emitters, sky, caustics
  SpecularLinks specular;   ///< only with Keep::links
  RowSums sums;             ///< only with Keep::links
};

/// The same without form factors, at most 64 bytes an element with Keep::totals, for which `method` has to be
/// `rays`.
FirstLight find_first_light(const Scene& scene, ElementMesh& mesh, const RadiosityOptions& options,
                            FormFactorMethod method, Keep keep, const CausticParticles& caustics,
                            RadiosityStats& stats);

}  // namespace twopass
