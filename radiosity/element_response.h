// How much of light from a known direction elements reflect diffusely.
#pragma once

#include <vector>

#include "materials/diffuse_response.h"
#include "radiosity/elements.h"
#include "render/scene/scene.h"

namespace twopass {

/// The response (R50) of every element's material.
class ElementResponse {
 public:
  ElementResponse(const Scene& scene, const ElementMesh& mesh);

  [[nodiscard]] const DiffuseResponse& of(std::uint32_t element) const {
    const ElementRoot& root = mesh_.root(element);
    return by_side_[number_of(scene_.shapes()[root.shape].material, root.side)];
  }

 private:
  static std::size_t number_of(std::uint32_t material, Side side) { return 2 * std::size_t{material} + side; }

  const Scene& scene_;
  const ElementMesh& mesh_;
  std::vector<DiffuseResponse> by_side_;  // of all materials
};

}  // namespace twopass
