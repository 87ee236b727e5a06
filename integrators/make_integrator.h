// The integrators by name.
#pragma once

#include <memory>

#include "integrators/integrator.h"
#include "integrators/pass_one.h"
#include "render/core/names.h"

namespace twopass {

enum class IntegratorKind { two_pass, unbiased, path, radiosity, direct };

inline constexpr Named<IntegratorKind> integrator_names[] = {
    {"twopass", IntegratorKind::two_pass}, {"unbiased", IntegratorKind::unbiased},
    {"path", IntegratorKind::path},        {"radiosity", IntegratorKind::radiosity},
    {"direct", IntegratorKind::direct},
};

/// Whether the integrator draws directions from a guide.
inline bool is_guided(IntegratorKind kind) {
  return kind == IntegratorKind::unbiased || kind == IntegratorKind::two_pass;
}

/// Whether the integrator reads a radiosity solution.
inline bool reads_solution(IntegratorKind kind) {
  return kind == IntegratorKind::two_pass || kind == IntegratorKind::unbiased ||
         kind == IntegratorKind::radiosity;
}

/// Edges of the shortest path that ends with direct light held by the solution: a gather ray goes between the
/// camera's ray and the look-up.
inline int edges_to_solution(IntegratorKind kind) { return kind == IntegratorKind::radiosity ? 2 : 3; }

/// REQUIRES: scene and pass one outlive the integrator; the solution holds no more bounces than the limits
/// allow.
std::unique_ptr<Integrator> make_integrator(IntegratorKind kind, const Scene& scene, const PassOne& pass_one,
                                            const PathLimits& limits);

}  // namespace twopass
