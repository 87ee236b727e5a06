#include "render/scene/light_tree.h"

#include <array>
#include <bit>
#include <numeric>

#include "render/core/sampler.h"

namespace twopass {

namespace {

bool is_all_directions(const LightBounds& b) { return b.cos_cone <= -1.0f; }

// The smallest cone around two (Conty Estevez and Kulla 2018, algorithm 1), slightly wider than rounding.
void unite_cones(LightBounds& a, const LightBounds& b) {
  if (is_all_directions(a)) return;
  if (is_all_directions(b)) {
    a.cos_cone = -1.0f;
    return;
  }
  constexpr double slack = 1e-4;
  const auto angle = [](double cosine) { return std::acos(std::clamp(cosine, -1.0, 1.0)); };
  const double half_a = angle(a.cos_cone), half_b = angle(b.cos_cone);
  V3d axis_a(a.axis), axis_b(b.axis);
  // What emits to both sides may be named by either normal.
  if (a.is_two_sided && b.is_two_sided && axis_a.dot(axis_b) < 0.0) axis_b = -axis_b;
  const double between = angle(axis_a.dot(axis_b) / (axis_a.length() * axis_b.length()));
  if (between + half_b <= half_a) return;
  if (between + half_a <= half_b) {
    a.axis = V3f(axis_b);
    a.cos_cone = b.cos_cone;
    return;
  }
  const double half = 0.5 * (half_a + between + half_b) + slack;
  const V3d across = axis_b - axis_a * axis_a.dot(axis_b);
  if (half >= pi || !(across.length() > 0.0)) {
    a.cos_cone = -1.0f;
    return;
  }
  const double turn = half - slack - half_a;
  a.axis = V3f((axis_a * std::cos(turn) + across / across.length() * std::sin(turn)).normalized());
  a.cos_cone = static_cast<float>(std::cos(half));
}

void unite(LightBounds& a, const LightBounds& b) {
  if (a.power == 0.0f) {
    a = b;
    return;
  }
  unite_cones(a, b);
  a.is_two_sided = a.is_two_sided || b.is_two_sided;
  a.box.extendBy(b.box);
  a.power += b.power;
}

// The measure of the directions into which the cone emits, with the cosine's hemisphere around each normal
// (Conty Estevez and Kulla 2018, section 4.4).
double orientation_measure(const LightBounds& b) {
  const double half = std::acos(std::clamp(static_cast<double>(b.cos_cone), -1.0, 1.0));
  const double wide = std::min(half + 0.5 * pi, pi), sine = std::sin(half);
  const double one_side =
      2.0 * pi * (1.0 - std::cos(half)) +
      0.5 * pi * (2.0 * wide * sine - std::cos(half - 2.0 * wide) - 2.0 * half * sine + std::cos(half));
  return b.is_two_sided ? 2.0 * one_side : one_side;
}

double surface_measure(const Box3f& box) {
  const V3d d = V3d(box.max) - V3d(box.min);
  return d.x * d.y + d.y * d.z + d.z * d.x + d.dot(d);  // the square of the diagonal: lines have no area
}

double cost(const LightBounds& b) {
  return b.power == 0.0f ? 0.0 : b.power * orientation_measure(b) * surface_measure(b.box);
}

V3f middle(const LightBounds& b) { return b.box.min + (b.box.max - b.box.min) * 0.5f; }

// How to divide lights in two: where along an axis the cost of both halves is least.
struct Cut {
  int axis = 0;
  float position = 0.0f;
  double cost = std::numeric_limits<double>::infinity();
};

Cut best_cut(std::span<const LightBounds> lights, std::span<const std::uint32_t> order) {
  constexpr int bins = 12;
  Box3f centers;
  for (const std::uint32_t i : order) centers.extendBy(middle(lights[i]));
  const V3f size = centers.max - centers.min;
  Cut best;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(size[axis] > 0.0f)) continue;
    std::array<LightBounds, bins> bin;
    for (const std::uint32_t i : order) {
      const float x = (middle(lights[i])[axis] - centers.min[axis]) / size[axis];
      unite(bin[std::min(bins - 1, static_cast<int>(x * bins))], lights[i]);
    }
    std::array<double, bins> above{};
    LightBounds sum;
    for (int k = bins - 1; k > 0; --k) {
      if (bin[k].power > 0.0f) unite(sum, bin[k]);
      above[k] = cost(sum);
    }
    sum = {};
    for (int k = 0; k + 1 < bins; ++k) {
      if (bin[k].power > 0.0f) unite(sum, bin[k]);
      // Thin boxes are cut across (Conty Estevez and Kulla 2018, equation 4).
      const double total = (cost(sum) + above[k + 1]) * max_component(size) / size[axis];
      if (total < best.cost)
        best = {axis, centers.min[axis] + size[axis] * (static_cast<float>(k + 1) / bins), total};
    }
  }
  return best;
}

// Lights that belong together, in a binary tree.
struct Cluster {
  LightBounds bounds;
  std::uint32_t count;  // of its lights
  std::uint32_t child;  // the first of two that follow each other; of one light, its number
};

// The first is the root.
std::vector<Cluster> clusters_of(std::span<const LightBounds> lights) {
  std::vector<std::uint32_t> order(lights.size());
  std::iota(order.begin(), order.end(), 0u);
  struct Task {
    std::size_t cluster;
    std::span<std::uint32_t> order;
  };
  std::vector<Cluster> clusters(1);
  clusters.reserve(2 * lights.size());
  std::vector<Task> tasks{{0, order}};
  while (!tasks.empty()) {
    const Task task = tasks.back();
    tasks.pop_back();
    LightBounds bounds;
    for (const std::uint32_t i : task.order) unite(bounds, lights[i]);
    Cluster& cluster = clusters[task.cluster];
    cluster = {bounds, static_cast<std::uint32_t>(task.order.size()), task.order[0]};
    if (cluster.count == 1) continue;
    const Cut cut = best_cut(lights, task.order);
    auto split = std::partition(task.order.begin(), task.order.end(),
                                [&](std::uint32_t i) { return middle(lights[i])[cut.axis] < cut.position; });
    // All in one place: by number.
    if (split == task.order.begin() || split == task.order.end())
      split = task.order.begin() + static_cast<std::ptrdiff_t>(task.order.size() / 2);
    cluster.child = static_cast<std::uint32_t>(clusters.size());
    tasks.push_back({clusters.size(), {task.order.begin(), split}});
    tasks.push_back({clusters.size() + 1, {split, task.order.end()}});
    clusters.resize(clusters.size() + 2);
  }
  return clusters;
}

// The clusters below one that stand side by side in a wide node: whichever has the most lights gives way to its
// two parts while there is room, so that the tree is shallow. (One light alone stays as it is.)
std::vector<std::uint32_t> opened(std::span<const Cluster> clusters, std::uint32_t root, std::size_t most) {
  std::vector<std::uint32_t> open{root};
  while (open.size() < most) {
    const auto largest = std::ranges::max_element(open, {}, [&](std::uint32_t i) { return clusters[i].count; });
    if (clusters[*largest].count == 1) break;
    *largest = clusters[*largest].child;
    open.push_back(*largest + 1);
  }
  return open;
}

}  // namespace

LightTree::LightTree(std::span<const LightBounds> lights) : leaf_(lights.size()) {
  if (lights.empty()) return;
  const std::vector<Cluster> clusters = clusters_of(lights);
  struct Task {
    std::uint32_t cluster, parent;
  };
  std::vector<Task> tasks{{0, none}};
  while (!tasks.empty()) {
    const Task task = tasks.back();
    tasks.pop_back();
    const auto number = static_cast<std::uint32_t>(nodes_.size());
    Node& node = nodes_.emplace_back();
    node.parent = task.parent;
    if (task.parent != none) nodes_[task.parent / width].child[task.parent % width] = number;
    const std::vector<std::uint32_t> children = opened(clusters, task.cluster, width);
    for (std::uint32_t k = 0; k < children.size(); ++k) {
      const Cluster& child = clusters[children[k]];
      set_child(node, k, child.bounds);
      const auto place = static_cast<std::uint32_t>(number * width + k);
      if (child.count > 1) {
        tasks.push_back({children[k], place});
        continue;
      }
      node.child[k] = is_light | child.child;
      leaf_[child.child] = place;
    }
  }
  // Where lights without extent would be infinitely near.
  constexpr float part = 1e-6f;
  const float size = 0.5f * (clusters[0].bounds.box.max - clusters[0].bounds.box.min).length();
  least_distance2_ = std::max(part * part * size * size, 1e-30f);
}

void LightTree::set_child(Node& node, std::size_t k, const LightBounds& bounds) {
  const V3f center = middle(bounds);
  node.center_x[k] = center.x, node.center_y[k] = center.y, node.center_z[k] = center.z;
  // A few units in the last place larger, so that it holds the box in spite of rounding.
  const float rounding = 4.0f * std::numeric_limits<float>::epsilon() * max_abs_component(center);
  node.radius[k] = 0.5f * (bounds.box.max - bounds.box.min).length() * 1.000001f + rounding;
  node.axis_x[k] = bounds.axis.x, node.axis_y[k] = bounds.axis.y, node.axis_z[k] = bounds.axis.z;
  node.cos_cone[k] = bounds.cos_cone;
  node.sin_cone[k] = std::sqrt(std::max(0.0f, 1.0f - bounds.cos_cone * bounds.cos_cone));
  node.both_sides[k] = bounds.is_two_sided ? 1.0f : 0.0f;
  node.power[k] = bounds.power;
}

LightTree::Sums LightTree::sums_of_importance(const Node& node, const Receiver& receiver) const {
  // Added to cosines, so that neither rounding nor a bound that is nearly tight excludes a light.
  constexpr float slack = 1e-3f;
  const V3f &p = receiver.position, &n = receiver.normal;
  // Where the receiver's normal does not matter, all lights are as if straight above.
  const float unlit = receiver.is_diffuse ? 0.0f : infinity_f;
  Lanes importance;
  for (std::size_t k = 0; k < width; ++k) {
    const float x = node.center_x[k] - p.x, y = node.center_y[k] - p.y, z = node.center_z[k] - p.z;
    const float distance2 = x * x + y * y + z * z, distance = std::sqrt(distance2);
    const float radius = node.radius[k], radius2 = radius * radius, wider = radius + slack * distance;
    // Cosines times the distance, and not above it. Of the least angle to a normal in the cone:
    const float along = -(x * node.axis_x[k] + y * node.axis_y[k] + z * node.axis_z[k]);
    const float towards = node.both_sides[k] > 0.0f ? std::abs(along) : along;
    const float across = std::sqrt(std::max(distance2 - towards * towards, 0.0f));
    const float at_rim = towards * node.cos_cone[k] + across * node.sin_cone[k];
    const float in_cone = towards >= distance * node.cos_cone[k] ? distance : at_rim;
    const float emitted = std::min(std::max(in_cone + wider, 0.0f), distance);
    const float above = x * n.x + y * n.y + z * n.z;
    const float received = std::min(std::max(above + wider, unlit), distance);
    const float inverse = 1.0f / distance;
    const float cosines = distance2 > radius2 ? (emitted * inverse) * (received * inverse) : 1.0f;
    importance[k] = node.power[k] * cosines / std::max(std::max(distance2, radius2), least_distance2_);
  }
  // In pairs, which takes half the time; never falling, for the sums share their first terms.
  std::array<double, width> w;
  for (std::size_t k = 0; k < width; ++k) w[k] = importance[k];
  const double first2 = w[0] + w[1], first4 = first2 + (w[2] + w[3]), first6 = first4 + (w[4] + w[5]);
  return {w[0], first2, first2 + w[2], first4, first4 + w[4], first6, first6 + w[6], first6 + (w[6] + w[7])};
}

LightTree::Choice LightTree::sample(const Receiver& receiver, const V2f& u) const {
  // Each level uses digits up, and single precision has 24: the rest comes from both numbers, hashed.
  const std::uint64_t more =
      hash_words(std::bit_cast<std::uint32_t>(u.x), std::bit_cast<std::uint32_t>(u.y)) >> 35;
  double x = u.x + static_cast<double>(more) * 0x1p-53, probability = 1.0;
  for (const Node* node = &nodes_[0];;) {
    const Sums sums = sums_of_importance(*node, receiver);
    const double total = sums.back(), wanted = x * total;
    if (!(total > 0.0)) return {0, 0.0f, 0.0f};
    std::size_t k = 0;
    for (std::size_t i = 0; i + 1 < width; ++i) k += sums[i] <= wanted;
    // Rounding may lead to a child without importance behind the last that has some.
    while (k > 0 && sums[k] == sums[k - 1]) --k;
    const double before = k > 0 ? sums[k - 1] : 0.0, own = sums[k] - before;
    x = std::clamp((wanted - before) / own, 0.0, 0x1.fffffep-1);
    probability *= own / total;
    const std::uint32_t child = node->child[k];
    if (child & is_light) return {child & ~is_light, static_cast<float>(probability), static_cast<float>(x)};
    node = &nodes_[child];
  }
}

float LightTree::probability(const Receiver& receiver, std::uint32_t light) const {
  double probability = 1.0;
  for (std::uint32_t place = leaf_[light]; place != none; place = nodes_[place / width].parent) {
    const Sums sums = sums_of_importance(nodes_[place / width], receiver);
    if (!(sums.back() > 0.0)) return 0.0f;
    const std::size_t k = place % width;
    probability *= (sums[k] - (k > 0 ? sums[k - 1] : 0.0)) / sums.back();
  }
  return static_cast<float>(probability);
}

}  // namespace twopass
