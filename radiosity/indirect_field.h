// Indirect irradiance good enough to be looked at: gathered anew at the corners of the elements, with a
// judgement where that is enough.
#pragma once

#include <optional>

#include "radiosity/solution.h"

namespace twopass {

struct IndirectFieldOptions {
  /// Largest error that a look-up may have by estimate (R40), relative to all the light at the place. The
  /// estimate is pessimistic: what is measured is a tenth of it and less.
  double tolerance = 0.25;
  /// Rays from a corner: doubled until the mean is known to this part of all the light there.
  double noise = 0.03;
  std::uint32_t least_rays = 64, most_rays = 512;
  std::uint32_t seed = 0;
};

/// What diffuse surfaces send to each point of flat elements, interpolated linearly between their corners. The
/// solution itself is constant on elements and noisy; one more gathering step, by rays from the corners, is
/// neither (R39). Where that still is too coarse (contacts, thin obstacles, caustics) it says so, and a gather ray
/// has to do it (R40). Const and thread-safe once built; the same bits on any number of threads.
class IndirectField {
 public:
  /// REQUIRES: scene and solution outlive the field. Throws Interrupted when the user stops it.
  IndirectField(const Scene& scene, const Solution& solution, const IndirectFieldOptions& options = {});

  /// Irradiance from diffuse surfaces, straight or over specular ones, on the viewer's side, W/m2; nothing where
  /// it cannot be trusted.
  [[nodiscard]] std::optional<C3f> at(const SurfacePoint& point) const {
    const ElementMesh::Location location = mesh_->locate(point);
    if (location.element >= trusted_.size() || !trusted_[location.element]) return std::nullopt;
    const std::array<C3f, 3>& corner = value_[location.element];
    return corner[0] + (corner[1] - corner[0]) * location.u + (corner[2] - corner[0]) * location.v;
  }

  /// The part of the elements' area where it is trusted, in [0, 1].
  [[nodiscard]] double trusted_share() const { return trusted_share_; }
  /// All rays cast.
  [[nodiscard]] std::uint64_t rays() const { return rays_; }

 private:
  const ElementMesh* mesh_;
  std::vector<std::array<C3f, 3>> value_;  // by face: at its corners
  std::vector<std::uint8_t> trusted_;      // by face: elements that are cells
  double trusted_share_ = 0.0;
  std::uint64_t rays_ = 0;
};

}  // namespace twopass
