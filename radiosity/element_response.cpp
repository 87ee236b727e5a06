#include "radiosity/element_response.h"

#include "render/core/parallel.h"

namespace twopass {

ElementResponse::ElementResponse(const Scene& scene, const ElementMesh& mesh) : scene_(scene), mesh_(mesh) {
  const std::vector<Material>& materials = scene.description().materials;
  by_side_.assign(2 * materials.size(), DiffuseResponse(MaterialSide(Diffuse{})));
  parallel_for(by_side_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) by_side_[i] = DiffuseResponse(materials[i / 2].side[i % 2]);
  });
}

}  // namespace twopass
