// Indirect irradiance good enough to be looked at: gathered anew at the corners of the elements, with a
// judgement where that is enough.
#pragma once

#include "radiosity/solution.h"

namespace twopass {

struct IndirectFieldOptions {
  /// Largest error that a look-up may have by estimate (R40), relative to all the light at the place. The
  /// estimate is pessimistic: what is measured is a tenth of it and less.
  double tolerance = 0.25;
  /// Where the estimate is larger: what may be between interpolation and what rays from the middle find (R40).
  double middle_tolerance = 0.05;
  /// Rays from a corner: doubled until the mean is known to this part of all the light there.
  double noise = 0.02;
  /// Largest error of direct light that is looked up, too (R43), relative to all the light there.
  double direct_tolerance = 0.005;
  bool with_direct = true;  ///< direct light is looked up at all
  /// What lamps send straight over mirrors, glass and metals is not part of it: a CausticMap has that.
  /// Otherwise nothing is looked up where there is more than a trace of it.
  bool without_caustics = false;
  /// By element: false where nobody will look. Empty: they look everywhere.
  std::vector<bool> wanted{};
  /// By element: the part of the picture that looks there (R55). Empty: not known, and nothing is divided.
  std::vector<double> parts{};
  /// About how many rays may be spent on dividing an element that is too coarse to be trusted, times its part
  /// (R53).
  double dividing_rays = 0.0;
  std::uint32_t least_rays = 64, most_rays = 512;  ///< the most from a corner that is looked at like others
  /// From all corners together: where it is more than `most_rays` from each, up to so many, and 4096.
  double affordable_rays = 0.0;
  std::uint32_t seed = 0;
};

/// What need not be found by rays at a point.
enum class Known : std::uint8_t {
  nothing,
  no_direct,  ///< it is certain that no lamp shines there
  indirect,   ///< the light of diffuse surfaces
  all         ///< with the light of the lamps
};

/// What diffuse surfaces send to each point of flat elements, interpolated linearly between their corners. The
/// solution itself is constant on elements and noisy; one more gathering step, by rays from the corners, is
/// neither (R39). Where that still is too coarse (contacts, thin obstacles, caustics) it says so, and a gather
/// ray has to do it (R40). Where it is certain what flat lamps send as well, that is part of it (R43). Const
/// and thread-safe once built; the same bits on any number of threads.
class IndirectField {
 public:
  /// REQUIRES: scene and solution outlive the field. Throws Interrupted when the user stops it.
  IndirectField(const Scene& scene, const Solution& solution, const IndirectFieldOptions& options = {});

  struct LookUp {
    Known known = Known::nothing;
    C3f irradiance{0.0f};  ///< of what is known, W/m2
  };
  /// On the viewer's side. What diffuse surfaces send includes what comes from them over specular ones.
  [[nodiscard]] LookUp at(const SurfacePoint& point) const { return at(mesh_->locate(point)); }
  /// The same where the element is known.
  [[nodiscard]] LookUp at(const ElementMesh::Location& location) const {
    if (location.element >= elements_) return {};
    const Place place = place_of(location);
    LookUp found{known_[place.cell]};
    if (found.known >= Known::indirect) found.irradiance = interpolated(value_[place.cell], place);
    return found;
  }

  /// Asks for what is kept of an element, so that it is at hand when at() is.
  void prefetch(std::uint32_t element) const {
    if (element >= elements_) return;
    __builtin_prefetch(&known_[element]);
    __builtin_prefetch(&child_[element]);
    __builtin_prefetch(&value_[element]);
  }

  /// What diffuse surfaces send to a surface there whose normal is not quite that of the element, `flat`: on
  /// its side, and of what at() finds without the lamps' part (R54), W/m2. REQUIRES: at() knows it.
  [[nodiscard]] C3f tilted(const C3f& irradiance, const ElementMesh::Location& location, const V3f& flat,
                           const V3f& normal) const;
  /// The light of lamps in what at() finds there, W/m2.
  [[nodiscard]] C3f direct_at(const ElementMesh::Location& location) const;
  /// What diffuse surfaces send where it cannot be trusted, too; 0 where there is none. REQUIRES: built without
  /// direct light.
  [[nodiscard]] C3f indirect_at_any(const SurfacePoint& point) const;

  /// Of all of an element; nothing of those that are no cells.
  [[nodiscard]] Known known(std::uint32_t element) const {
    return element < elements_ ? known_[element] : Known::nothing;
  }
  /// The part of the elements' area where so much or more is known, in [0, 1].
  [[nodiscard]] double share(Known least) const { return share_[static_cast<std::size_t>(least)]; }
  /// All rays cast.
  [[nodiscard]] std::uint64_t rays() const { return rays_; }

 private:
  friend class IndirectFieldBuilder;
  using Corners = std::array<C3f, 3>;
  // A place on a cell, an element or a part of one, in the barycentric coordinates of its corners 1 and 2.
  struct Place {
    std::uint32_t cell;
    float u, v;
  };
  // REQUIRES: an element that is a cell.
  [[nodiscard]] Place place_of(const ElementMesh::Location& location) const {
    Place at{location.element, location.u, location.v};
    while (const std::uint32_t child = child_[at.cell]) {
      const float u = 2.0f * at.u, v = 2.0f * at.v;
      if (u > 1.0f)
        at = {child + 1, u - 1.0f, v};
      else if (v > 1.0f)
        at = {child + 2, u, v - 1.0f};
      else if (u + v < 1.0f)
        at = {child, u, v};
      else
        at = {child + 3, 1.0f - u, 1.0f - v};
    }
    return at;
  }
  [[nodiscard]] static C3f interpolated(const Corners& corner, const Place& at) {
    return corner[0] + (corner[1] - corner[0]) * at.u + (corner[2] - corner[0]) * at.v;
  }

  const ElementMesh* mesh_;
  std::uint32_t elements_ = 0;  // that are cells; clusters have larger numbers
  // By cell: elements that are cells, then the four parts of those that are divided, from the corners 0, 1, 2
  // and the middle.
  std::vector<Corners> value_, direct_;  // at the corners: all that is known, and of that the lamps' part
  std::vector<std::array<Corners, 3>> across_;  // net irradiance along the surface, by axis
  std::vector<Known> known_;
  std::vector<std::uint32_t> child_;  // the first part; 0: not divided
  std::array<double, 4> share_{};
  std::uint64_t rays_ = 0;
};

}  // namespace twopass
