// The integrators by name.
#pragma once

#include <memory>

#include "integrators/integrator.h"
#include "radiosity/indirect_field.h"
#include "radiosity/solution.h"
#include "render/core/names.h"

namespace twopass {

enum class IntegratorKind { two_pass, path, radiosity, direct };

inline constexpr Named<IntegratorKind> integrator_names[] = {
    {"twopass", IntegratorKind::two_pass},
    {"path", IntegratorKind::path},
    {"radiosity", IntegratorKind::radiosity},
    {"direct", IntegratorKind::direct},
};

/// Whether the integrator reads a radiosity solution.
inline bool reads_solution(IntegratorKind kind) {
  return kind == IntegratorKind::two_pass || kind == IntegratorKind::radiosity;
}

/// Edges of the shortest path that ends with direct light held by the solution: a gather ray goes between the
/// camera's ray and the look-up.
inline int edges_to_solution(IntegratorKind kind) { return kind == IntegratorKind::two_pass ? 3 : 2; }

/// REQUIRES: scene and solution outlive the integrator. `solution` may be null: the pass was skipped.
std::unique_ptr<Integrator> make_integrator(IntegratorKind kind, const Scene& scene, const Solution* solution,
                                            const IndirectField* field, const PathLimits& limits);

}  // namespace twopass
