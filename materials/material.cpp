#include "materials/material.h"

namespace twopass {

namespace {

void assign(C3f& parameter, const Texture& texture, const TexturePoint& where) {
  parameter = color_at(texture, where);
}
void assign(float& parameter, const Texture& texture, const TexturePoint& where) {
  parameter = number_at(texture, where);
}
template <class Setting>
void assign(Setting&, const Texture&, const TexturePoint&) {
}  // settings do not vary: loaders bind no texture to them

template <class Model>
void bind_textures(Model& model, const std::vector<TextureBinding>& textures, const TexturePoint& where) {
  std::size_t number = 0;
  Model::visit_parameters(model, [&](std::string_view, auto& parameter) {
    for (const TextureBinding& binding : textures)
      if (binding.parameter == number) assign(parameter, binding.texture, where);
    ++number;
  });
  if constexpr (requires { model.prepare(); }) model.prepare();
}

void resolve_model(const TexturedModel& node, const TexturePoint& where, Bsdf& bsdf) {
  std::visit(
      [&](const auto& model) {
        bind_textures(bsdf.emplace<std::decay_t<decltype(model)>>(model), node.textures, where);
      },
      node.bsdf);
}
Bsdf bound(const TexturedModel& node, const TexturePoint& where) {
  Bsdf bsdf;
  resolve_model(node, where, bsdf);
  return bsdf;
}

float weight_at(const Mixture& mixture, const TexturePoint& where) {
  return std::clamp(number_at(mixture.weight, where), 0.0f, 1.0f);
}

// Turns the frame to the normal `n`, given in the frame's own coordinates with +z on the viewer's side (M29).
void turn(ShadingGeometry& at, V3f n, const PerturbedNormal& options) {
  const V3f wo = at.frame.to_local(at.wo);
  if (options.flip_invalid && n.dot(wo) <= 0.0f) n = V3f(-n.x, -n.y, n.z);
  n = unit(n);
  if (!is_finite(n) || !(n.z > 0.0f) || !(n.dot(wo) > 0.0f)) return;  // no such surface: it stays as it was
  V3f s = V3f(1.0f, 0.0f, 0.0f) - n * n.x;
  s = s.dot(s) > 0.0f ? unit(s) : V3f(0.0f, 1.0f, 0.0f);
  const float tan2 = (1.0f - n.z * n.z) / (n.z * n.z);
  at.terminator = options.soft_terminator ? std::min(0.125f * tan2, 1.0f) : 0.0f;
  const Frame base = at.frame;
  at.frame.n = base.to_world(n);
  at.frame.s = base.to_world(s);
  at.frame.t = at.frame.n.cross(at.frame.s);
}

void perturb(const BumpMap& bump, ShadingGeometry& at) {
  const V2f slope = gradient_at(bump.height, at.where()) * bump.scale;
  if (slope.x == 0.0f && slope.y == 0.0f) return;
  // Heights are measured along the normal of the front.
  const V3f normal = at.is_back ? -at.frame.n : at.frame.n;
  const V3f du = at.dp_du + normal * (slope.x - normal.dot(at.dp_du));
  const V3f dv = at.dp_dv + normal * (slope.y - normal.dot(at.dp_dv));
  V3f n = du.cross(dv);
  if (n.dot(at.frame.n) < 0.0f) n = -n;
  turn(at, at.frame.to_local(n), bump.options);
}

void perturb(const NormalMap& map, ShadingGeometry& at) {
  const C3f color = color_at(map.normal, at.where());
  V3f n(2.0f * color.x - 1.0f, 2.0f * color.y - 1.0f, 2.0f * color.z - 1.0f);
  // The map is drawn in the frame of the front, which has the viewer below it on the back: z as it is, x and y
  // turned.
  if (at.is_back) n = V3f(-n.x, n.y, n.z);
  turn(at, n, map.options);
}

// The model has something to say of the back of its surface.
bool has_back(const Bsdf& bsdf) {
  return std::visit(
      [](const auto& model) {
        return requires { model.from_behind(); };
      },
      bsdf);
}

// Models with a back transmit light to it unless they say otherwise.
bool transmits(const Bsdf& bsdf) {
  return std::visit(
      [](const auto& model) {
        if constexpr (requires { model.transmits(); })
          return model.transmits();
        else
          return requires { model.from_behind(); };
      },
      bsdf);
}

bool is_see_through(const Bsdf& bsdf) { return std::holds_alternative<Null>(bsdf); }

bool is_black_diffuse(const Bsdf& bsdf) {
  const auto* diffuse = std::get_if<Diffuse>(&bsdf);
  return diffuse && is_black(diffuse->reflectance);
}

// Models with a direction of their own in the tangent plane.
bool has_direction(const Bsdf& bsdf) {
  bool found = false;
  std::visit(
      [&]<class Model>(const Model& model) {
        Model::visit_parameters(model, [&](std::string_view name, const auto&) {
          found = found || name == "alpha_u" || name == "anisotropic";
        });
      },
      bsdf);
  return found;
}

SideTraits traits_of(const Bsdf& bsdf) {
  return {.mean_diffuse_reflectance = diffuse_reflectance(bsdf),
          .may_be_specular = is_specular(bsdf),
          .is_specular = is_specular(bsdf),
          .may_be_smooth = !is_specular(bsdf) && !is_black_diffuse(bsdf),
          .is_see_through = is_see_through(bsdf),
          .transmits = transmits(bsdf),
          .needs_uv = has_direction(bsdf),
          .needs_tangents = has_direction(bsdf)};
}

SideTraits traits_of(const TexturedModel& node) {
  // Reflectances are linear in most textures, so that the model of the means has the mean of the models.
  Bsdf mean = node.bsdf;
  std::visit(
      [&](auto& model) {
        std::vector<TextureBinding> means = node.textures;
        for (TextureBinding& binding : means) binding.texture = mean_color(binding.texture);
        bind_textures(model, means, V2f(0.0f, 0.0f));
      },
      mean);
  SideTraits traits = traits_of(mean);
  traits.needs_uv = true;
  return traits;
}

SideTraits traits_of(const MaterialNode& node);

SideTraits traits_of(const Mixture& node) {
  const SideTraits a = traits_of(*node.first), b = traits_of(*node.second);
  const float weight = std::clamp(mean_number(node.weight), 0.0f, 1.0f);
  return {.mean_diffuse_reflectance =
              a.mean_diffuse_reflectance * (1.0f - weight) + b.mean_diffuse_reflectance * weight,
          .may_be_specular = a.may_be_specular || b.may_be_specular,
          .is_specular = a.is_specular && b.is_specular,
          .may_be_smooth = a.may_be_smooth || b.may_be_smooth,
          .is_see_through = a.is_see_through || b.is_see_through,
          .transmits = a.transmits || b.transmits,
          .needs_uv = a.needs_uv || b.needs_uv || !is_constant(node.weight),
          .needs_tangents = a.needs_tangents || b.needs_tangents,
          .needs_choice = true};
}

SideTraits traits_of(const BumpMap& node) {
  SideTraits traits = traits_of(*node.nested);
  traits.needs_uv = traits.needs_tangents = true;
  return traits;
}
SideTraits traits_of(const NormalMap& node) {
  SideTraits traits = traits_of(*node.nested);
  traits.needs_uv = traits.needs_tangents = true;
  return traits;
}

SideTraits traits_of(const MaterialNode& node) {
  return std::visit([](const auto& kind) { return traits_of(kind); }, node.kind);
}

void resolve_node(const MaterialNode& node, ShadingGeometry& at, float u, Bsdf& bsdf) {
  if (const auto* model = std::get_if<TexturedModel>(&node.kind))
    return resolve_model(*model, at.where(), bsdf);
  if (const auto* mixture = std::get_if<Mixture>(&node.kind)) {
    const float weight = weight_at(*mixture, at.where());
    // What is left of u chooses among mixtures further down.
    if (u < weight) return resolve_node(*mixture->second, at, u / weight, bsdf);
    return resolve_node(*mixture->first, at, std::min((u - weight) / (1.0f - weight), 0x1.fffffep-1f), bsdf);
  }
  if (const auto* bump = std::get_if<BumpMap>(&node.kind)) {
    perturb(*bump, at);
    return resolve_node(*bump->nested, at, u, bsdf);
  }
  const auto& map = std::get<NormalMap>(node.kind);
  perturb(map, at);
  resolve_node(*map.nested, at, u, bsdf);
}

float transparency_of(const MaterialNode& node, const TexturePoint& where) {
  if (const auto* model = std::get_if<TexturedModel>(&node.kind))
    return is_see_through(model->bsdf) ? 1.0f : 0.0f;
  if (const auto* mixture = std::get_if<Mixture>(&node.kind)) {
    const float weight = weight_at(*mixture, where);
    return transparency_of(*mixture->first, where) * (1.0f - weight) +
           transparency_of(*mixture->second, where) * weight;
  }
  if (const auto* bump = std::get_if<BumpMap>(&node.kind)) return transparency_of(*bump->nested, where);
  return transparency_of(*std::get<NormalMap>(node.kind).nested, where);
}

C3f diffuse_reflectance_of(const MaterialNode& node, const TexturePoint& where) {
  if (const auto* model = std::get_if<TexturedModel>(&node.kind))
    return diffuse_reflectance(bound(*model, where));
  if (const auto* mixture = std::get_if<Mixture>(&node.kind)) {
    const float weight = weight_at(*mixture, where);
    return diffuse_reflectance_of(*mixture->first, where) * (1.0f - weight) +
           diffuse_reflectance_of(*mixture->second, where) * weight;
  }
  if (const auto* bump = std::get_if<BumpMap>(&node.kind)) return diffuse_reflectance_of(*bump->nested, where);
  return diffuse_reflectance_of(*std::get<NormalMap>(node.kind).nested, where);
}

MaterialNodePtr behind(const MaterialNodePtr& node) {
  MaterialNode result = *node;
  if (auto* model = std::get_if<TexturedModel>(&result.kind)) {
    if (!has_back(model->bsdf)) model->textures.clear();
    model->bsdf = seen_from_behind(model->bsdf);
  } else if (auto* mixture = std::get_if<Mixture>(&result.kind)) {
    mixture->first = behind(mixture->first);
    mixture->second = behind(mixture->second);
  } else if (auto* bump = std::get_if<BumpMap>(&result.kind)) {
    bump->nested = behind(bump->nested);
  } else {
    auto& map = std::get<NormalMap>(result.kind);
    map.nested = behind(map.nested);
  }
  return std::make_shared<const MaterialNode>(std::move(result));
}

// f(number, colour) of each parameter of a model that is a colour.
template <class F>
void for_each_color(Bsdf& bsdf, const F& f) {
  std::visit(
      [&]<class Model>(Model& model) {
        std::size_t number = 0;
        Model::visit_parameters(model, [&]<class Parameter>(std::string_view name, Parameter& parameter) {
          if constexpr (std::is_same_v<Parameter, C3f>)
            if (name != "eta" && name != "k") f(number, parameter);
          ++number;
        });
      },
      bsdf);
}

// What a metal reflects straight back: the colour that its specular reflectance is a factor of. White of
// others.
C3f metal_of(const Bsdf& bsdf) {
  if (const auto* metal = std::get_if<Conductor>(&bsdf)) return fresnel_conductor(1.0f, metal->eta, metal->k);
  if (const auto* metal = std::get_if<RoughConductor>(&bsdf))
    return fresnel_conductor(1.0f, metal->eta, metal->k);
  return C3f(1.0f);
}

TexturedModel in_primaries(TexturedModel model, const ColorMatrix& primaries) {
  const ColorMatrix own = primaries.relative_to(metal_of(model.bsdf));
  for_each_color(model.bsdf, [&](std::size_t number, C3f& color) {
    color = own(color);
    for (TextureBinding& binding : model.textures)
      if (binding.parameter == number) binding.texture = in_primaries(std::move(binding.texture), own);
  });
  return model;
}

MaterialNodePtr in_primaries(const MaterialNodePtr& node, const ColorMatrix& primaries) {
  MaterialNode result = *node;
  if (auto* model = std::get_if<TexturedModel>(&result.kind)) {
    *model = in_primaries(std::move(*model), primaries);
  } else if (auto* mixture = std::get_if<Mixture>(&result.kind)) {
    mixture->first = in_primaries(mixture->first, primaries);
    mixture->second = in_primaries(mixture->second, primaries);
  } else if (auto* bump = std::get_if<BumpMap>(&result.kind)) {
    bump->nested = in_primaries(bump->nested, primaries);
  } else {
    auto& map = std::get<NormalMap>(result.kind);
    map.nested = in_primaries(map.nested, primaries);
  }
  return std::make_shared<const MaterialNode>(std::move(result));
}

MaterialNodePtr changed(const MaterialNodePtr& node, const std::function<Texture(const Texture&)>& change) {
  MaterialNode result = *node;
  if (auto* model = std::get_if<TexturedModel>(&result.kind)) {
    for (TextureBinding& binding : model->textures) binding.texture = change(binding.texture);
  } else if (auto* mixture = std::get_if<Mixture>(&result.kind)) {
    mixture->weight = change(mixture->weight);
    mixture->first = changed(mixture->first, change);
    mixture->second = changed(mixture->second, change);
  } else if (auto* bump = std::get_if<BumpMap>(&result.kind)) {
    bump->height = change(bump->height);
    bump->nested = changed(bump->nested, change);
  } else {
    auto& map = std::get<NormalMap>(result.kind);
    map.normal = change(map.normal);
    map.nested = changed(map.nested, change);
  }
  return std::make_shared<const MaterialNode>(std::move(result));
}

}  // namespace

MaterialSide::MaterialSide(const Bsdf& bsdf) : bsdf_(bsdf), traits_(traits_of(bsdf)) {}

MaterialSide::MaterialSide(MaterialNodePtr node) {
  const auto* model = std::get_if<TexturedModel>(&node->kind);
  if (model && model->textures.empty()) {
    *this = MaterialSide(model->bsdf);
    return;
  }
  node_ = std::move(node);
  traits_ = traits_of(*node_);
}

MaterialNodePtr MaterialSide::node() const {
  if (node_) return node_;
  return std::make_shared<const MaterialNode>(MaterialNode{TexturedModel{bsdf_, {}}});
}

void MaterialSide::resolve(const TexturePoint& where, Bsdf& bsdf) const {
  resolve_model(std::get<TexturedModel>(node_->kind), where, bsdf);
}
void MaterialSide::resolve(ShadingGeometry& at, float u, Bsdf& bsdf) const {
  resolve_node(*node_, at, u, bsdf);
}

float MaterialSide::transparency(const TexturePoint& where) const {
  if (!traits_.is_see_through) return 0.0f;
  return node_ ? transparency_of(*node_, where) : 1.0f;
}

C3f MaterialSide::diffuse_reflectance(const TexturePoint& where) const {
  return node_ ? diffuse_reflectance_of(*node_, where) : traits_.mean_diffuse_reflectance;
}

Material with_textures(const Material& material, const std::function<Texture(const Texture&)>& change) {
  Material result = material;
  for (MaterialSide& side : result.side)
    if (!side.is_uniform()) side = MaterialSide(changed(side.node(), change));
  return result;
}

Material in_primaries(const Material& material, const ColorMatrix& primaries) {
  Material result = material;
  for (MaterialSide& side : result.side) side = MaterialSide(in_primaries(side.node(), primaries));
  return result;
}

Bsdf seen_from_behind(const Bsdf& bsdf) {
  return std::visit(
      [](const auto& model) -> Bsdf {
        if constexpr (requires { model.from_behind(); })
          return model.from_behind();
        else
          return Diffuse{C3f(0.0f)};
      },
      bsdf);
}

Material material_of(std::string name, const MaterialSide& front_side) {
  if (front_side.is_uniform())
    return {std::move(name), {front_side, MaterialSide(seen_from_behind(front_side.uniform()))}};
  return {std::move(name), {front_side, MaterialSide(behind(front_side.node()))}};
}

}  // namespace twopass
