// Light that lamps throw onto surfaces that diffuse, over mirrors, glass, metals and coats: shot from the
// lamps, because small ones are rarely found from the other end.
#pragma once

#include <span>
#include <vector>

#include "render/scene/scene.h"

namespace twopass {

struct CausticParticlesOptions {
  /// Most particles that are shot.
  std::size_t particles = std::size_t{1} << 20;
  std::uint32_t seed = 0;
};

/// Power that has arrived at a surface.
struct CausticParticle {
  std::uint32_t shape, primitive;  ///< where, as in SurfacePoint
  float u, v;
  V3f position, normal;  ///< the geometric normal on the side where it arrives
  C3f power;             ///< W
  std::uint32_t light;   ///< its number, as in Lights
  Side side;
  bool is_caustic;  ///< it has come over surfaces alone that scatter without diffusing, L (S|G)+ D; others over
                    ///< coats

  [[nodiscard]] SurfacePoint point() const;
};

/// What lamps that are surfaces send over one or more surfaces that scatter otherwise than diffusely. Const and
/// thread-safe once shot; the same bits on any number of threads.
class CausticParticles {
 public:
  /// Particles are aimed at where a few of them have shown that such surfaces are, and fewer where little power
  /// goes over mirrors, glass and metals. Throws Interrupted when the user stops it.
  explicit CausticParticles(const Scene& scene, const CausticParticlesOptions& options = {});

  [[nodiscard]] std::span<const CausticParticle> all() const { return particles_; }
  [[nodiscard]] std::uint64_t rays() const { return rays_; }

 private:
  std::vector<CausticParticle> particles_;
  std::uint64_t rays_ = 0;
};

}  // namespace twopass
