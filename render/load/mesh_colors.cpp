#include "render/load/mesh_colors.h"

#include "render/core/error.h"

namespace twopass {
namespace {

/// The values as the texture shows them: their mean is that of what is limited.
std::shared_ptr<const MeshColors::Values> values_of(const MeshAttribute& attribute, const Mesh& mesh,
                                                    const std::optional<TexelScale>& scale) {
  const auto shown = [&](std::uint32_t k) {
    C3f value = attribute.values[k];
    for (int c = 0; scale && c < 3; ++c)
      value[c] = std::clamp(value[c] * scale->factor[c] + scale->offset[c], scale->lowest, scale->highest);
    return value;
  };
  MeshColors::Values result;
  result.corners.reserve(mesh.triangles.size());
  C3d sum(0.0);
  double area = 0.0;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const V3u& t = mesh.triangles[i];
    const std::array<C3f, 3> corner = attribute.is_of_faces() ? std::array{shown(i), shown(i), shown(i)}
                                                              : std::array{shown(t.x), shown(t.y), shown(t.z)};
    const std::array<V3f, 3> p = corners(mesh, i);
    const double part = (V3d(p[1]) - V3d(p[0])).cross(V3d(p[2]) - V3d(p[0])).length();
    sum += (C3d(corner[0]) + C3d(corner[1]) + C3d(corner[2])) * (part / 3.0);
    area += part;
    result.corners.push_back(corner);
  }
  if (area > 0.0) result.mean = C3f(sum * (1.0 / area));
  return std::make_shared<const MeshColors::Values>(std::move(result));
}

/// Binds textures to one mesh; what both sides look at is made once.
class Binder {
 public:
  Binder(const Shape& shape, const std::string& where)
      : shape_(shape), mesh_(mesh_of(shape.geometry)), where_(where) {}

  Texture operator()(const Texture& texture) {
    const auto* colors = std::get_if<MeshColors>(&texture);
    if (!colors || colors->values) return texture;
    for (const auto& [unbound, bound] : made_)
      if (unbound.name == colors->name && unbound.scale == colors->scale) return bound;
    const MeshAttribute& attribute = attribute_called(colors->name);  // throws where there is no mesh
    const MeshColors bound{colors->name, values_of(attribute, *mesh_, colors->scale), {}};
    made_.emplace_back(*colors, bound);
    return bound;
  }

 private:
  const MeshAttribute& attribute_called(const std::string& name) const {
    if (!mesh_)
      throw Error(where_, "shape '" + shape_.name + "' is no mesh, and its material looks at '" + name + "'",
                  "mesh attributes are in ply and serialized files");
    std::string names;
    for (const MeshAttribute& attribute : mesh_->attributes) {
      if (attribute.name == name) return attribute;
      names += (names.empty() ? "" : ", ") + attribute.name;
    }
    throw Error(where_, "the mesh of shape '" + shape_.name + "' has no attribute '" + name + "'",
                names.empty() ? "it has none" : "it has: " + names);
  }

  const Shape& shape_;
  const Mesh* mesh_;
  const std::string& where_;
  std::vector<std::pair<MeshColors, MeshColors>> made_;
};

bool is_unbound(const Texture& texture) {
  const auto* colors = std::get_if<MeshColors>(&texture);
  return colors && !colors->values;
}

}  // namespace

void bind_mesh_colors(Shape& shape, std::vector<Material>& materials, const std::string& where) {
  Binder binder(shape, where);
  bool has_unbound = false;
  with_textures(materials[shape.material], [&](const Texture& texture) {
    has_unbound |= is_unbound(texture);
    return texture;
  });
  if (has_unbound) {
    materials.push_back(with_textures(materials[shape.material], std::ref(binder)));
    shape.material = static_cast<std::uint32_t>(materials.size() - 1);
  }
  if (shape.radiance_texture && is_unbound(*shape.radiance_texture)) {
    shape.radiance_texture = std::make_shared<const Texture>(binder(*shape.radiance_texture));
    shape.radiance[front] = mean_color(*shape.radiance_texture);
  }
  if (auto* mesh = std::get_if<Mesh>(&shape.geometry)) mesh->attributes = {};
}

}  // namespace twopass
