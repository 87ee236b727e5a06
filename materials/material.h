// What a surface is made of: how each of its two sides scatters light, at every point.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "materials/bsdf.h"
#include "materials/texture.h"
#include "render/core/frame.h"

namespace twopass {

/// The side of a surface that its geometric normal points away from is the front.
enum Side : std::uint8_t { front = 0, back = 1 };

struct MaterialNode;
using MaterialNodePtr = std::shared_ptr<const MaterialNode>;

/// A texture in place of one of a model's parameters, by its number in visit_parameters.
struct TextureBinding {
  std::size_t parameter;
  Texture texture;
};

/// A scattering model whose parameters may vary over the surface.
struct TexturedModel {
  Bsdf bsdf;  ///< the parameters that do not vary
  std::vector<TextureBinding> textures;
};
/// One of two materials, the second with probability `weight` at each point: a mixture (M28).
struct Mixture {
  Texture weight;
  MaterialNodePtr first, second;
};
/// Options of the two that follow.
struct PerturbedNormal {
  bool flip_invalid = true;     ///< normals that face away from the viewer are mirrored back (M29)
  bool soft_terminator = true;  ///< darkens grazing light instead of cutting it off (M30)
};
/// The shading normal tilted by the slope of a height field, in units of length by unit of u and v (M29).
struct BumpMap {
  Texture height;
  float scale = 1.0f;
  PerturbedNormal options{};
  MaterialNodePtr nested;
};
/// The shading normal taken from a texture: (2 color - 1) in the frame of the surface.
struct NormalMap {
  Texture normal;
  PerturbedNormal options{};
  MaterialNodePtr nested;
};

struct MaterialNode {
  std::variant<TexturedModel, Mixture, BumpMap, NormalMap> kind;
};

/// The part of a surface point that materials look at and change.
struct ShadingGeometry {
  V2f uv{0.0f, 0.0f};
  V3f dp_du{1.0f, 0.0f, 0.0f}, dp_dv{0.0f, 1.0f, 0.0f};  ///< derivatives of the position, world
  V3f wo{0.0f, 0.0f, 1.0f};                              ///< unit, to the viewer, world
  Frame frame;                ///< the normal on the viewer's side; perturbed in place
  bool is_back = false;       ///< the viewer sees the back
  float terminator = 0.0f;    ///< alpha^2 of (M30); 0 where the normal is not perturbed
  V2f footprint{0.0f, 0.0f};  ///< of TexturePoint
  MeshPlace place{};
  [[nodiscard]] TexturePoint where() const { return {uv, footprint, place}; }
};

/// What there is anywhere on a side: it decides what can be skipped.
struct SideTraits {
  C3f mean_diffuse_reflectance{0.0f};  ///< albedo of the part that a radiosity solution can hold
  bool may_be_specular = false;        ///< Dirac models alone, somewhere
  bool is_specular = false;            ///< Dirac models alone, everywhere
  bool may_be_smooth = false;          ///< other than Dirac models, and not black, somewhere
  bool is_see_through = false;         ///< light passes straight through, somewhere
  bool transmits = false;              ///< light comes out on the other side, somewhere
  bool needs_uv = false;               ///< looks at uv, dp_du or dp_dv
  bool needs_tangents = false;         ///< the directions of the tangents matter
  bool needs_choice = false;           ///< chooses among mixtures
};

/// How one side of a surface scatters light: by one model everywhere, or by a tree of nodes that is resolved at
/// each point. Cheap to copy.
class MaterialSide {
 public:
  MaterialSide(const Bsdf& bsdf);  // NOLINT: a model is the simplest material
  template <class Model>
  requires ScatteringModel<Model> MaterialSide(const Model& model) : MaterialSide(Bsdf(model)) {}  // NOLINT
  /// A tree of a single model without textures becomes that model.
  explicit MaterialSide(MaterialNodePtr node);

  /// One model everywhere: nothing to resolve.
  [[nodiscard]] bool is_uniform() const { return node_ == nullptr; }
  /// The model of a uniform side. REQUIRES: is_uniform().
  [[nodiscard]] const Bsdf& uniform() const { return bsdf_; }
  /// The side as a tree: to be put into another.
  [[nodiscard]] MaterialNodePtr node() const;
  [[nodiscard]] const SideTraits& traits() const { return traits_; }

  /// The model at a point into `bsdf`; the shading frame may be turned for it. `u` in [0, 1) chooses among
  /// mixtures: the expectation over it is the material. REQUIRES: !is_uniform().
  void resolve(ShadingGeometry& at, float u, Bsdf& bsdf) const;
  /// Whether the model depends on the texture coordinates alone: then where they are is enough. REQUIRES:
  /// !is_uniform().
  [[nodiscard]] bool is_single_model() const { return std::holds_alternative<TexturedModel>(node_->kind); }
  /// REQUIRES: !is_uniform(), is_single_model().
  void resolve(const TexturePoint& where, Bsdf& bsdf) const;
  [[nodiscard]] Bsdf resolve(ShadingGeometry& at, float u) const {
    Bsdf bsdf;
    resolve(at, u, bsdf);
    return bsdf;
  }
  /// The share of light that passes straight through (masks and null), in [0, 1].
  [[nodiscard]] float transparency(const TexturePoint& where) const;
  /// Albedo of the part that a radiosity solution can hold.
  [[nodiscard]] C3f diffuse_reflectance(const TexturePoint& where) const;
  /// Light goes on, but never diffusely: mirrors, glass, rough metal.
  [[nodiscard]] bool scatters_without_diffusing() const {
    return is_black(traits_.mean_diffuse_reflectance) && (traits_.may_be_specular || traits_.may_be_smooth);
  }

 private:
  Bsdf bsdf_{Diffuse{C3f(0.0f)}};
  MaterialNodePtr node_;  // null where uniform
  SideTraits traits_;
};

/// One-sided models have a black back; `twosided` has a model on both; glass has its inverse index of
/// refraction on the back.
struct Material {
  std::string name;
  std::array<MaterialSide, 2> side{MaterialSide(Diffuse{}), MaterialSide(Diffuse{C3f(0.0f)})};
};

inline Material one_sided(std::string name, const MaterialSide& front_side) {
  return {std::move(name), {front_side, MaterialSide(Diffuse{C3f(0.0f)})}};
}
inline Material two_sided(std::string name, const MaterialSide& front_side, const MaterialSide& back_side) {
  return {std::move(name), {front_side, back_side}};
}
/// The material with change(texture) in place of every texture.
Material with_textures(const Material& material, const std::function<Texture(const Texture&)>& change);

/// The material with all of its colours in other primaries; indices of refraction are none, and metals keep the
/// colour that they have at normal incidence.
Material in_primaries(const Material& material, const ColorMatrix& primaries);

/// The material of a model with the back that belongs to it: `seen_from_behind`.
Material material_of(std::string name, const MaterialSide& front_side);
/// A closed or open interface; `outside` is the model seen from the front.
inline Material interface_material(std::string name, const Dielectric& outside) {
  return material_of(std::move(name), MaterialSide(outside));
}

/// What a viewer behind the surface sees of a model: of interfaces, the way out; of models that only reflect,
/// black.
Bsdf seen_from_behind(const Bsdf& bsdf);

/// The share of light that reaches the bumps of a perturbed surface (M30). `terminator`: ShadingGeometry's;
/// `cos_i`: of the light's direction with the normal before it was perturbed.
inline float soft_terminator(float terminator, float cos_i) {
  if (terminator == 0.0f) return 1.0f;
  const float cos2 = cos_i * cos_i;
  if (!(cos2 > 0.0f)) return 0.0f;
  return 2.0f / (1.0f + std::sqrt(1.0f + terminator * (1.0f - cos2) / cos2));
}

}  // namespace twopass
