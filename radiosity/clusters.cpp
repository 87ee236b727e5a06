#include "radiosity/clusters.h"

#include <algorithm>
#include <tuple>

#include "render/core/parallel.h"
#include "render/core/sampler.h"

namespace twopass {

namespace {

// Directions by the face of a cube that they leave through, and a 3 x 3 grid on it, so that walls, floors and
// ceilings of buildings fall in the middle of a cell.
constexpr int grid = 3;

std::uint32_t facing_of(const V3d& normal) {
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
  const double length = std::abs(normal[axis]);
  if (!(length > 0.0)) return 0;
  const auto cell = [&](double x) {
    return std::clamp(static_cast<int>((x / length + 1.0) * 0.5 * grid), 0, grid - 1);
  };
  const int face = 2 * axis + (normal[axis] < 0.0 ? 1 : 0);
  return static_cast<std::uint32_t>((face * grid + cell(normal[(axis + 1) % 3])) * grid +
                                    cell(normal[(axis + 2) % 3]));
}

V3f middle_of(std::uint32_t facing) {
  const auto coordinate = [](std::uint32_t cell) {
    return (static_cast<float>(cell) + 0.5f) * 2.0f / grid - 1.0f;
  };
  const std::uint32_t face = facing / (grid * grid);
  const int axis = static_cast<int>(face / 2);
  V3f direction;
  direction[axis] = face % 2 == 1 ? -1.0f : 1.0f;
  direction[(axis + 1) % 3] = coordinate(facing / grid % grid);
  direction[(axis + 2) % 3] = coordinate(facing % grid);
  return unit(direction);
}

// Candidates with equal keys join.
struct Key {
  std::uint64_t cube;
  std::uint32_t group, facing;
  std::int32_t sheet;

  friend auto operator<=>(const Key&, const Key&) = default;
};

class KeyMaker {
 public:
  KeyMaker(std::span<const ClusterCandidate> candidates, float size) : inverse_size_(1.0f / size) {
    V3f low(infinity_f);
    for (const ClusterCandidate& c : candidates)
      for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], c.centroid[k]);
    origin_ = low;
    for (std::uint32_t f = 0; f < direction_.size(); ++f) direction_[f] = middle_of(f);
  }
  [[nodiscard]] Key operator()(const ClusterCandidate& c) const {
    const V3f p = (c.centroid - origin_) * inverse_size_;
    const auto coordinate = [](float x) {
      return static_cast<std::uint64_t>(std::min(std::max(x, 0.0f), 2097151.0f));
    };
    const float distance = p.dot(direction_[c.facing]) * 4.0f;
    return {coordinate(p.x) << 42 | coordinate(p.y) << 21 | coordinate(p.z), c.group, c.facing,
            static_cast<std::int32_t>(std::clamp(std::floor(distance), -2e9f, 2e9f))};
  }

 private:
  V3f origin_;
  float inverse_size_;
  std::array<V3f, 6 * grid * grid> direction_;
};

std::uint64_t hash(const Key& key) {
  const std::uint64_t rest = hash_words(key.group, key.facing ^ static_cast<std::uint32_t>(key.sheet) << 6);
  return hash_word(key.cube ^ rest);
}

}  // namespace

ClusterCandidate cluster_candidate(const Patch& patch, std::uint32_t material, Side side) {
  double longest = 0.0;
  for (int k = 0; k < 3; ++k)
    longest = std::max(longest, (patch.corner[(k + 1) % 3] - patch.corner[k]).length());
  const ElementPoint middle = patch.centroid();
  return {V3f(middle.position), static_cast<float>(longest), material << 1 | side, facing_of(middle.normal)};
}

double count_clusters(std::span<const ClusterCandidate> candidates, float size) {
  // Of many, the keys of every 16th hash value stand for all.
  constexpr std::size_t many = 1 << 18;
  const std::uint64_t mask = candidates.size() > many ? 15 : 0;
  const KeyMaker key(candidates, size);
  std::vector<std::uint64_t> found;
  for (const ClusterCandidate& c : candidates) {
    if (c.extent > size) continue;
    const std::uint64_t h = hash(key(c));
    if ((h & mask) == 0) found.push_back(h);
  }
  std::sort(found.begin(), found.end());
  const auto distinct = static_cast<double>(std::unique(found.begin(), found.end()) - found.begin());
  return mask == 0 ? distinct : 16.0 * (distinct + 3.0 * std::sqrt(distinct));
}

std::vector<std::uint32_t> form_clusters(std::span<const ClusterCandidate> candidates, float size) {
  struct Keyed {
    Key key;
    std::uint32_t candidate;
  };
  const KeyMaker key(candidates, size);
  std::vector<Keyed> keyed;
  for (std::uint32_t r = 0; r < candidates.size(); ++r)
    if (candidates[r].extent <= size) keyed.push_back({key(candidates[r]), r});
  std::sort(keyed.begin(), keyed.end(), [](const Keyed& a, const Keyed& b) {
    return std::tie(a.key, a.candidate) < std::tie(b.key, b.candidate);
  });
  std::vector<std::uint32_t> cluster(candidates.size(), no_index);
  std::uint32_t clusters = 0;
  for (std::size_t begin = 0, end = 0; begin < keyed.size(); begin = end) {
    while (end < keyed.size() && keyed[end].key == keyed[begin].key) ++end;
    if (end - begin == 1) continue;
    for (std::size_t k = begin; k < end; ++k) cluster[keyed[k].candidate] = clusters;
    ++clusters;
  }
  return cluster;
}

}  // namespace twopass
