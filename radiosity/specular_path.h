// Following light over mirrors, glass and glossy lobes from one surface that diffuses to the next.
#pragma once

#include "render/core/sampler.h"
#include "render/scene/scene.h"

namespace twopass {

/// What a path over specular surfaces carries.
enum class Carried {
  radiance,  ///< traced against the light; shrinks by 1 / eta^2 on entering a denser medium, and grows on
             ///< leaving
  power,     ///< traced with the light; changes only by absorption
};

/// Where a path over specular surfaces arrives.
struct SpecularPathEnd {
  C3f weight{0.0f};  ///< carried from end to end; black: absorbed on the way
  bool escaped = true;
  V3f direction{0.0f};       ///< of the last ray; only if it has escaped
  SurfacePoint point;        ///< of a surface that is not purely specular; only if it has not escaped
  bool is_blurred = false;   ///< by a rough surface on the way: what arrives makes no sharp patterns
  float lamp_weight = 1.0f;  ///< of light that is emitted here: less than 1 where lamps were sampled, too
  unsigned rays = 0;         ///< cast on the way
};

/// A path through reflections and refractions chosen at random, but for diffuse ones (R15). It arrives at every
/// surface that diffuses or absorbs, and goes on from there by what else that scatters: the coat of plastics,
/// the metal or glass in a mixture. It is absorbed at random once it carries little, and after 64 surfaces.
/// Lamps are met by chance, or sampled at glossy surfaces, too (R52).
class SpecularPath {
 public:
  /// Of a ray that has met, at `point`, a surface that scatters otherwise than diffusely. REQUIRES: scene and
  /// sampler outlive the path.
  SpecularPath(const Scene& scene, const Ray& ray, const SurfacePoint& point, Carried carried, Sampler& sampler)
      : scene_(scene), ray_(ray), carried_(carried), sampler_(sampler) {
    end_.point = point;
  }
  /// Goes on to where it arrives next. False: it has been absorbed, or ended there.
  bool next() { return next(false); }
  /// The same with a light sample at each glossy surface that it leaves. REQUIRES: it carries radiance.
  bool next_with_lamps() { return next(true); }
  /// Where it is; of no weight where it has arrived nowhere yet.
  [[nodiscard]] const SpecularPathEnd& end() const { return end_; }
  /// Radiance of all light samples so far, carried to the start, W/(m2 sr).
  [[nodiscard]] const C3f& sampled() const { return sampled_; }
  /// All rays cast so far.
  [[nodiscard]] unsigned rays() const { return end_.rays; }

 private:
  bool next(bool samples_lamps);
  bool scatter(bool samples_lamps);
  void sample_lamps(const Bsdf& bsdf, const V3f& wo);
  [[nodiscard]] float lamp_weight() const;

  const Scene& scene_;
  Ray ray_;
  Carried carried_;
  Sampler& sampler_;
  C3f power_{1.0f};              // what would arrive of a power: decides the roulette, whatever is carried
  float radiance_scale_ = 1.0f;  // the product of 1 / eta^2 on the way
  int surface_ = 0;
  bool is_over_ = false;
  C3f sampled_{0.0f};
  // Of the last surface, holes aside: the density of the direction in which the path left it, 0 if lamps were
  // not sampled there, and how far away it is.
  float pdf_w_ = 0.0f;
  Receiver receiver_{};
  float distance_ = 0.0f;
  SpecularPathEnd end_;
};

/// The first place where the path arrives; of no weight where it is absorbed before.
SpecularPathEnd follow_specular(const Scene& scene, const Ray& ray, const SurfacePoint& point, Carried carried,
                                Sampler& sampler);

}  // namespace twopass
