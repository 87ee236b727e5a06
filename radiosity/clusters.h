// Triangles that are smaller than an element, joined: neighbours of one material that face nearly the same way.
#pragma once

#include <span>
#include <vector>

#include "radiosity/patch.h"
#include "render/scene/ray.h"

namespace twopass {

/// What decides which cluster a triangle side (or octant of a sphere) may join.
struct ClusterCandidate {
  V3f centroid;
  float extent;          ///< longest edge
  std::uint32_t group;   ///< only candidates of one group join: material and side
  std::uint32_t facing;  ///< which of 54 cones of directions, each about 20 degrees wide, holds its normal
};

ClusterCandidate cluster_candidate(const Patch& patch, std::uint32_t material, Side side);

/// About how many clusters and single triangles the candidates of at most the extent `size` make; never less
/// than there are, but with a probability of about one in a thousand.
double count_clusters(std::span<const ClusterCandidate> candidates, float size);

/// The cluster of each candidate, numbered without gaps; no_index for those larger than `size` and those that
/// have nobody to join. Members of a cluster lie in one cube of the edge `size`, face the same of 54 ways, and
/// their distances along it agree to a quarter of `size`, so that the sheets of a thin wall or the boards of a
/// shelf stay apart.
std::vector<std::uint32_t> form_clusters(std::span<const ClusterCandidate> candidates, float size);

}  // namespace twopass
