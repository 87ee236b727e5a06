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

// cos(max(0, a - b)) of two angles in [0, pi].
float cos_difference(float cos_a, float sin_a, float cos_b, float sin_b) {
  return cos_a > cos_b ? 1.0f : cos_a * cos_b + sin_a * sin_b;
}
float sin_difference(float cos_a, float sin_a, float cos_b, float sin_b) {
  return cos_a > cos_b ? 0.0f : sin_a * cos_b - cos_a * sin_b;
}
float sine_of(float cosine) { return std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)); }

}  // namespace

LightTree::LightTree(std::span<const LightBounds> lights) : leaf_(lights.size()) {
  if (lights.empty()) return;
  std::vector<std::uint32_t> order(lights.size());
  std::iota(order.begin(), order.end(), 0u);
  nodes_.reserve(2 * lights.size());
  nodes_.emplace_back();
  nodes_[0].parent = inner;
  build(0, lights, order);
  // Where lights without extent would be infinitely near.
  constexpr float part = 1e-6f;
  least_distance2_ = std::max(part * part * nodes_[0].radius * nodes_[0].radius, 1e-30f);
}

void LightTree::build(std::uint32_t root, std::span<const LightBounds> lights, std::span<std::uint32_t> order) {
  struct Task {
    std::uint32_t node;
    std::span<std::uint32_t> order;
  };
  std::vector<Task> tasks{{root, order}};
  while (!tasks.empty()) {
    const Task task = tasks.back();
    tasks.pop_back();
    LightBounds bounds;
    for (const std::uint32_t i : task.order) unite(bounds, lights[i]);
    Node& node = nodes_[task.node];
    node.center = middle(bounds);
    // A few units in the last place larger, so that it holds the box in spite of rounding.
    const float rounding = 4.0f * std::numeric_limits<float>::epsilon() * max_abs_component(node.center);
    node.radius = 0.5f * (bounds.box.max - bounds.box.min).length() * 1.000001f + rounding;
    node.axis = bounds.axis;
    node.cos_cone = bounds.cos_cone;
    node.sin_cone = sine_of(bounds.cos_cone);
    node.power = bounds.power;
    node.is_two_sided = bounds.is_two_sided;
    node.light = inner;
    if (task.order.size() == 1) {
      node.light = task.order[0];
      leaf_[node.light] = task.node;
      continue;
    }
    const Cut cut = best_cut(lights, task.order);
    auto split = std::partition(task.order.begin(), task.order.end(),
                                [&](std::uint32_t i) { return middle(lights[i])[cut.axis] < cut.position; });
    // All in one place: by number.
    if (split == task.order.begin() || split == task.order.end())
      split = task.order.begin() + static_cast<std::ptrdiff_t>(task.order.size() / 2);
    const auto child = node.child = static_cast<std::uint32_t>(nodes_.size());
    nodes_.resize(nodes_.size() + 2);  // `node` is no longer valid
    nodes_[child].parent = nodes_[child + 1].parent = task.node;
    tasks.push_back({child, {task.order.begin(), split}});
    tasks.push_back({child + 1, {split, task.order.end()}});
  }
}

float LightTree::importance(const Node& node, const Receiver& receiver) const {
  // Added to cosines, so that neither rounding nor a bound that is nearly tight excludes a light.
  constexpr float slack = 1e-3f;
  const V3f to_light = node.center - receiver.position;
  const float distance2 = to_light.dot(to_light), radius2 = node.radius * node.radius;
  const float near2 = std::max({distance2, radius2, least_distance2_});
  if (distance2 <= radius2) return node.power / near2;
  const V3f direction = to_light * (1.0f / std::sqrt(distance2));
  const float sin_b = std::sqrt(radius2 / distance2), cos_b = sine_of(sin_b);
  float result = node.power / near2;
  if (node.cos_cone > -1.0f) {
    const float cosine = -direction.dot(node.axis);
    const float cos_w = node.is_two_sided ? std::abs(cosine) : cosine, sin_w = sine_of(cos_w);
    const float cos_x = cos_difference(cos_w, sin_w, node.cos_cone, node.sin_cone);
    const float sin_x = sin_difference(cos_w, sin_w, node.cos_cone, node.sin_cone);
    result *= std::max(0.0f, cos_difference(cos_x, sin_x, cos_b, sin_b) + slack);
  }
  if (receiver.is_diffuse) {
    const float cos_i = direction.dot(receiver.normal);
    result *= std::max(0.0f, cos_difference(cos_i, sine_of(cos_i), cos_b, sin_b) + slack);
  }
  return result;
}

LightTree::Choice LightTree::sample(const Receiver& receiver, const V2f& u) const {
  // Each level uses digits up, and single precision has 24: the rest comes from both numbers, hashed.
  const std::uint64_t more =
      hash_words(std::bit_cast<std::uint32_t>(u.x), std::bit_cast<std::uint32_t>(u.y)) >> 35;
  double x = u.x + static_cast<double>(more) * 0x1p-53;
  float probability = 1.0f;
  const Node* node = &nodes_[0];
  while (node->light == inner) {
    const Node* child = &nodes_[node->child];
    const float a = importance(child[0], receiver), b = importance(child[1], receiver);
    if (!(a + b > 0.0f)) return {0, 0.0f, 0.0f};
    const float first = a / (a + b);
    const bool takes_first = x < first;
    x = takes_first ? x / first : (x - first) / (1.0 - first);
    probability *= takes_first ? first : b / (a + b);
    node = takes_first ? child : child + 1;
  }
  return {node->light, probability, std::min(static_cast<float>(x), 0x1.fffffep-1f)};
}

float LightTree::probability(const Receiver& receiver, std::uint32_t light) const {
  float probability = 1.0f;
  for (std::uint32_t i = leaf_[light]; nodes_[i].parent != inner; i = nodes_[i].parent) {
    const std::uint32_t child = nodes_[nodes_[i].parent].child;
    const float a = importance(nodes_[child], receiver), b = importance(nodes_[child + 1], receiver);
    if (!(a + b > 0.0f)) return 0.0f;
    probability *= (i == child ? a : b) / (a + b);
  }
  return probability;
}

}  // namespace twopass
