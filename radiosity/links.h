// Which nodes of the tree of elements exchange light as wholes, so that the error stays below what is asked
// for.
#pragma once

#include "radiosity/element_tree.h"
#include "render/scene/ray_caster.h"

namespace twopass {

/// All elements of node p and all of node q exchange light, in both directions, as if the kernel of (R1) were
/// constant over them. p <= q; p = q: within one node.
struct Link {
  std::uint32_t p, q;
  float exchange;            ///< X_pq, in units of area
  float spread_p, spread_q;  ///< standard deviation over p (over q) of what its parts exchange with q (p) (R31)
  float noise;               ///< standard error of the exchange itself
};

/// What the radiosities of a node's elements are, in units of the scene's total power by channel.
struct NodeLight {
  C3f radiosity{0.0f};  ///< mean over the exposed area
  C3f deviation{0.0f};  ///< standard deviation from it
};

/// Largest error of a link, as power over the total power, of the worst direction and channel (R32), and the
/// node whose division makes it smaller.
struct LinkError {
  double power = 0.0;
  bool divide_p = false;
};

/// Finds links and refines them. Const and without memory: links are a pure function of the scene, the light,
/// epsilon and the seed.
class LinkRefiner {
 public:
  LinkRefiner(const ElementTree& tree, const RayCaster& caster, std::uint32_t seed)
      : tree_(tree), caster_(caster), seed_(seed) {}

  /// Replaces links whose error is above epsilon by links between their parts, down to elements; with an empty
  /// `links`, begins with the whole scene. Pairs of elements that cannot see each other are left out. No
  /// further division once there are `most` links. The same result on any number of threads; `rays` is
  /// increased. Returns whether anything was divided. `light`: by node.
  bool refine(std::vector<Link>& links, std::span<const NodeLight> light, double epsilon, std::size_t most,
              std::uint64_t& rays) const;

  [[nodiscard]] LinkError error(const Link& link, std::span<const NodeLight> light) const;

 private:
  struct Pair {
    std::uint32_t p, q;
  };
  struct Output;
  class Search;

  const ElementTree& tree_;
  const RayCaster& caster_;
  std::uint32_t seed_;
};

}  // namespace twopass
