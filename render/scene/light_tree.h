// Choosing one of many lights by what it may send to a receiver.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "render/scene/receiver.h"

namespace twopass {

/// What is known of one light, or of several, without looking at them.
struct LightBounds {
  Box3f box;
  V3f axis{0.0f, 0.0f, 1.0f};  ///< unit; of a cone that holds the normals of all that emits...
  float cos_cone = -1.0f;      ///< ...whose half angle has this cosine; -1: all directions
  bool is_two_sided = false;   ///< emits around the opposite normals, too
  float power = 0.0f;          ///< > 0
};

/// A tree over lights with up to eight children a node, sampled from the root down by importance (L7): Conty
/// Estevez and Kulla 2018, Pharr, Jakob and Humphreys 2023 (section 12.6.3). Const once built.
class LightTree {
 public:
  LightTree() = default;
  explicit LightTree(std::span<const LightBounds> lights);

  [[nodiscard]] bool empty() const { return nodes_.empty(); }

  struct Choice {
    std::uint32_t light;
    float probability;  ///< 0: none of them can reach the receiver
    float remapped;     ///< u stretched back to [0, 1) within the choice, to be used again
  };
  /// REQUIRES: !empty(), u.x in [0, 1). `u.y` only lends its digits to u.x.
  [[nodiscard]] Choice sample(const Receiver& receiver, const V2f& u) const;
  /// The probability with which sample() chooses the light: > 0 if it may reach the receiver.
  [[nodiscard]] float probability(const Receiver& receiver, std::uint32_t light) const;

 private:
  static constexpr std::size_t width = 8;
  using Lanes = std::array<float, width>;
  // Its children side by side, for vector instructions; those that are missing have no power, and come last.
  struct alignas(64) Node {
    Lanes center_x{}, center_y{}, center_z{}, radius{};  // of spheres around their boxes
    Lanes axis_x{}, axis_y{}, axis_z{}, cos_cone{}, sin_cone{};
    Lanes both_sides{};  // 1 where lights emit around the opposite normals, too
    Lanes power{};
    std::array<std::uint32_t, width> child{};  // a node, or a light and `is_light`
    std::uint32_t parent = none;               // as in leaf_
  };
  static constexpr std::uint32_t is_light = 0x80000000u, none = 0xffffffffu;
  // Sums of the children's importances up to each of them.
  using Sums = std::array<double, width>;
  [[nodiscard]] Sums sums_of_importance(const Node& node, const Receiver& receiver) const;
  static void set_child(Node& node, std::size_t k, const LightBounds& bounds);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> leaf_;  // by light: node * width + child
  float least_distance2_ = 0.0f;     // below which all are equally near
};

}  // namespace twopass
