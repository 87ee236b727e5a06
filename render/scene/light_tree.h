// Choosing one of many lights by what it may send to a receiver.
#pragma once

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

/// A binary tree over lights, sampled from the root down by importance (L7): Conty Estevez and Kulla 2018,
/// Pharr, Jakob and Humphreys 2023 (section 12.6.3). Const once built.
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
  static constexpr std::uint32_t inner = 0xffffffffu;
  struct Node {
    V3f center;  // of a sphere around the box
    float radius;
    V3f axis;
    float cos_cone, sin_cone;
    float power;
    std::uint32_t parent;
    std::uint32_t child;  // the first of two that follow each other
    std::uint32_t light;  // `inner` if it has children
    bool is_two_sided;
  };
  [[nodiscard]] float importance(const Node& node, const Receiver& receiver) const;
  void build(std::uint32_t root, std::span<const LightBounds> lights, std::span<std::uint32_t> order);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> leaf_;  // by light
  float least_distance2_ = 0.0f;     // below which all are equally near
};

}  // namespace twopass
