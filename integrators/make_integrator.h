// The integrators by name.
#pragma once

#include <memory>

#include "integrators/integrator.h"
#include "radiosity/indirect_field.h"
#include "radiosity/solution.h"
#include "render/core/names.h"

namespace twopass {

class Guide;

enum class IntegratorKind { two_pass, unbiased, path, radiosity, direct };

inline constexpr Named<IntegratorKind> integrator_names[] = {
    {"twopass", IntegratorKind::two_pass}, {"unbiased", IntegratorKind::unbiased},
    {"path", IntegratorKind::path},        {"radiosity", IntegratorKind::radiosity},
    {"direct", IntegratorKind::direct},
};

/// Whether the integrator draws directions from a guide.
inline bool is_guided(IntegratorKind kind) { return kind == IntegratorKind::unbiased; }

/// Whether the integrator reads a radiosity solution.
inline bool reads_solution(IntegratorKind kind) {
  return kind == IntegratorKind::two_pass || kind == IntegratorKind::unbiased ||
         kind == IntegratorKind::radiosity;
}

/// Edges of the shortest path that ends with direct light held by the solution: a gather ray goes between the
/// camera's ray and the look-up.
inline int edges_to_solution(IntegratorKind kind) { return kind == IntegratorKind::radiosity ? 2 : 3; }

/// REQUIRES: scene, solution, field and guide outlive the integrator. `solution` may be null: the pass was
/// skipped; `field` and `guide`, too: indirect light is gathered everywhere, directions are drawn without a
/// guide.
std::unique_ptr<Integrator> make_integrator(IntegratorKind kind, const Scene& scene, const Solution* solution,
                                            const IndirectField* field, const PathLimits& limits,
                                            const Guide* guide = nullptr);
/// The same without field and guide.
inline std::unique_ptr<Integrator> make_integrator(IntegratorKind kind, const Scene& scene,
                                                   const Solution* solution, const PathLimits& limits) {
  return make_integrator(kind, scene, solution, nullptr, limits);
}

}  // namespace twopass
