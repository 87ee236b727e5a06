#include "render/load/mitsuba_bsdfs.h"

#include "materials/conductor_presets.h"
#include "materials/energy.h"
#include "materials/ior.h"
#include "render/core/error.h"
#include "render/load/mitsuba_model.h"
#include "render/load/mitsuba_properties.h"
#include "render/load/text_file.h"

namespace twopass {
namespace {

// What every reader needs.
struct Context {
  const MitsubaTree& tree;
  MitsubaTextures& textures;
};

Material read_bsdf(const XmlNode& node, const Context& context);

/// An index of refraction as a number or as a substance's name.
float read_ior(Properties& p, std::string_view name, std::string_view otherwise) {
  const XmlNode* node = p.element(name, {"float", "integer", "string"});
  if (!node) return ior_of(otherwise, p.where());
  if (node->tag == "string") return ior_of(lower_case(node->get("value")), node->where());
  const auto value = static_cast<float>(parse_number_attribute(*node, "value"));
  if (!(value > 0.0f) || !std::isfinite(value))
    throw Error(node->where(), "an index of refraction must be positive", "water has 1.333, window glass 1.52");
  return value;
}

float read_relative_ior(Properties& p, std::string_view inside) {
  const float relative = read_ior(p, "int_ior", inside) / read_ior(p, "ext_ior", "air");
  if (!(relative >= smallest_ior && relative <= largest_ior))
    throw Error(p.where("int_ior"), "an index of refraction that no substance has",
                "give one between 0.001 and 1000");
  return relative;
}

/// Models without parameters of their own kind.
template <class Model>
Material read_plain(Properties& p, const Context& context) {
  return material_of(p.id_or(p.type()), ModelReader(p, context.textures).read(Model{}));
}

/// Heuristic models: kept from reflecting more than they receive (materials, M13), where neither reflectance
/// varies.
template <class Model>
Material read_heuristic(Properties& p, const Context& context) {
  MaterialSide side = ModelReader(p, context.textures).read(Model{});
  if (side.is_uniform()) {
    Model model = std::get<Model>(side.uniform());
    const float scale = energy_conserving_scale(model.specular_reflectance, model.base_reflectance);
    model.specular_reflectance *= scale;
    model.base_reflectance *= scale;
    side = model;
  }
  return material_of(p.id_or(p.type()), side);
}

/// Models with an index of refraction; `inside` names the substance that they are made of by default.
template <class Model>
Material read_interface(Properties& p, const Context& context, std::string_view inside) {
  Model model{};
  model.eta = read_relative_ior(p, inside);
  p.ignore({"sample_visible"});  // noise, never the mean: we always sample what is visible
  return material_of(p.id_or(p.type()), ModelReader(p, context.textures, {"eta"}).read(model));
}
template <class Model>
Material read_glass(Properties& p, const Context& context) {
  return read_interface<Model>(p, context, "bk7");
}
Material read_rough_glass(Properties& p, const Context& context) {
  const Material material = read_glass<RoughDielectric>(p, context);
  if (read_relative_ior(p, "bk7") == 1.0f)
    throw Error(p.where("int_ior"), "a rough interface needs two different indices of refraction",
                "change one, or use bsdf 'null'");
  return material;
}
template <class Model>
Material read_plastic(Properties& p, const Context& context) {
  return read_interface<Model>(p, context, "polypropylene");
}

/// eta and k relative to the outside, by number or by name.
template <class Model>
Material read_metal(Properties& p, const Context& context) {
  Model metal{};
  const bool has_index = p.has("eta") || p.has("k");
  const std::optional<std::string> given = p.text("material");
  const std::optional<C3f> eta = p.color("eta", ColorUse::index), k = p.color("k", ColorUse::index);
  if (given && (eta || k))
    throw Error(p.where("material"), "both 'material' and 'eta' or 'k' are given", "give one of them");
  if (eta.has_value() != k.has_value())
    throw Error(p.where(), "a conductor needs both 'eta' and 'k'", "give the other one, too");
  // Mitsuba 1 took copper for granted, later versions an ideal mirror.
  const std::string name = given.value_or(context.tree.version < 2.0 && !has_index ? "Cu" : "none");
  const ConductorIndex index = eta ? ConductorIndex{*eta, *k} : conductor_index_of(name, p.where("material"));
  const float outside = p.has("ext_eta") ? read_ior(p, "ext_eta", "vacuum") : 1.0f;
  metal.eta = index.eta * (1.0f / outside);
  metal.k = index.k * (1.0f / outside);
  p.ignore({"sample_visible"});
  return material_of(p.id_or(p.type()), ModelReader(p, context.textures, {"eta", "k"}).read(metal));
}

bool may_differ_from_zero(Properties& p, std::string_view name) {
  const XmlNode* node = p.element(name, {});
  return node && (node->tag == "texture" || *p.number(name) != 0.0);
}

template <class Model>
Material read_principled(Properties& p, const Context& context) {
  Model model{};
  if (p.has("eta") && p.has("specular"))
    throw Error(p.where("specular"), "both 'eta' and 'specular' are given", "give one of them");
  // As in Mitsuba, what may let light through has some step of the index of refraction.
  const bool may_transmit = may_differ_from_zero(p, "spec_trans");
  if (std::optional<double> specular = p.number("specular")) {
    if (!(*specular >= 0.0 && *specular <= 1.0))
      throw Error(p.where("specular"), "specular is out of range", "must be between 0 and 1");
    if (may_transmit && *specular == 0.0) specular = 1e-3;
    model.eta = eta_of_specular(static_cast<float>(*specular));
  } else if (p.has("eta")) {
    model.eta = read_ior(p, "eta", "vacuum");
    if (may_transmit && model.eta == 1.0f) model.eta = 1.001f;
  }
  return material_of(p.id_or(p.type()), ModelReader(p, context.textures, {"eta", "inside"}).read(model));
}

const XmlNode& only_bsdf(Properties& p) {
  const XmlNode* nested = p.object_of("bsdf");
  if (!nested)
    throw Error(p.where(), "bsdf '" + p.type() + "' holds no bsdf", "put the bsdf that it changes into it");
  return *nested;
}

Material read_two_sided(Properties& p, const Context& context) {
  const std::vector<const XmlNode*> nested = p.objects("bsdf");
  if (nested.empty() || nested.size() > 2)
    throw Error(p.where(), "bsdf 'twosided' holds " + std::to_string(nested.size()) + " bsdfs",
                "give one for both sides, or one for the front and one for the back");
  const bool allows_transmission = p.boolean("allow_transmission", false);
  for (const XmlNode* inner : nested)
    if (inner->get("type") == "twosided")
      throw Error(inner->where(), "bsdf 'twosided' has two sides already", "do not nest it in twosided");
  const Material front_material = read_bsdf(*nested.front(), context),
                 back_material = read_bsdf(*nested.back(), context);
  for (std::size_t i = 0; i < nested.size(); ++i)
    if ((i == 0 ? front_material : back_material).side[front].traits().transmits && !allows_transmission)
      throw Error(nested[i]->where(), "bsdf '" + nested[i]->get("type") + "' has two sides already",
                  "do not nest it in twosided");
  return two_sided(p.id_or(front_material.name), front_material.side[front], back_material.side[front]);
}

MaterialSide side_of(MaterialNode node) {
  return MaterialSide(std::make_shared<const MaterialNode>(std::move(node)));
}

/// Both sides of two materials mixed by a texture.
Material mixture(std::string name, const Texture& weight, const Material& first, const Material& second) {
  const auto mixed = [&](Side side) {
    return side_of({Mixture{weight, first.side[side].node(), second.side[side].node()}});
  };
  return two_sided(std::move(name), mixed(front), mixed(back));
}

Material read_mask(Properties& p, const Context& context) {
  const Texture opacity = context.textures.property(p, "opacity", ColorUse::reflectance).value_or(C3f(0.5f));
  const Material nothing = material_of("null", MaterialSide(Null{}));
  return mixture(p.id_or("mask"), opacity, nothing, read_bsdf(only_bsdf(p), context));
}

Material read_blend(Properties& p, const Context& context) {
  const std::vector<const XmlNode*> nested = p.objects("bsdf");
  if (nested.size() != 2)
    throw Error(p.where(), "bsdf 'blendbsdf' holds " + std::to_string(nested.size()) + " bsdfs", "give two");
  const std::optional<Texture> weight = context.textures.property(p, "weight", ColorUse::reflectance);
  if (!weight)
    throw Error(p.where(), "bsdf 'blendbsdf' has no weight", "add <float name=\"weight\" value=\"0.5\"/>");
  return mixture(p.id_or("blendbsdf"), *weight, read_bsdf(*nested[0], context), read_bsdf(*nested[1], context));
}

/// Version 0.x: any number of bsdfs with their weights; what they leave of 1 is black.
Material read_mixture(Properties& p, const Context& context) {
  const std::vector<const XmlNode*> nested = p.objects("bsdf");
  const std::optional<std::string> text = p.text("weights");
  if (!text)
    throw Error(p.where(), "bsdf 'mixturebsdf' has no weights", "add <string name=\"weights\" value=\"...\"/>");
  const XmlNode& weights_node = *p.element("weights", {"string"});
  const std::vector<double> weights = parse_numbers_attribute(weights_node, "value");
  double total = 0.0;
  for (const double weight : weights) {
    if (!(weight >= 0.0)) throw Error(weights_node.where(), "a negative weight", "correct it");
    total += weight;
  }
  if (weights.size() != nested.size() || weights.empty() || !(total > 0.0))
    throw Error(weights_node.where(),
                std::to_string(weights.size()) + " weights for " + std::to_string(nested.size()) + " bsdfs",
                "give one weight for each, not all zero");
  // Mitsuba scales weights of more than 1 in all down.
  Material result = one_sided("black", Diffuse{C3f(0.0f)});
  double sum = std::max(0.0, 1.0 - total);
  for (std::size_t i = 0; i < nested.size(); ++i) {
    sum += weights[i];
    const auto share = static_cast<float>(sum > 0.0 ? weights[i] / sum : 0.0);
    result = mixture(p.id_or("mixturebsdf"), C3f(share), result, read_bsdf(*nested[i], context));
  }
  return result;
}

PerturbedNormal read_perturbed_normal(Properties& p) {
  return {p.boolean("flip_invalid_normals", true), p.boolean("use_shadowing_function", true)};
}

Material read_bump_map(Properties& p, const Context& context) {
  const XmlNode* texture = p.object_of("texture");
  if (!texture) throw Error(p.where(), "bsdf 'bumpmap' holds no texture", "add the texture of its heights");
  const Texture height = context.textures.of(*texture, ColorUse::emission);
  const auto scale = static_cast<float>(p.number("scale").value_or(1.0));
  const PerturbedNormal options = read_perturbed_normal(p);
  const Material nested = read_bsdf(only_bsdf(p), context);
  const auto bumped = [&](Side side) {
    return side_of({BumpMap{height, scale, options, nested.side[side].node()}});
  };
  return two_sided(p.id_or("bumpmap"), bumped(front), bumped(back));
}

Material read_normal_map(Properties& p, const Context& context) {
  const std::optional<Texture> normals = context.textures.property(p, "normalmap", ColorUse::emission);
  if (!normals)
    throw Error(p.where(), "bsdf 'normalmap' has no normalmap", "add a <texture name=\"normalmap\" ...>");
  const PerturbedNormal options = read_perturbed_normal(p);
  const Material nested = read_bsdf(only_bsdf(p), context);
  const auto mapped = [&](Side side) {
    return side_of({NormalMap{*normals, options, nested.side[side].node()}});
  };
  return two_sided(p.id_or("normalmap"), mapped(front), mapped(back));
}

using Reader = Material (*)(Properties&, const Context&);

constexpr Named<Reader> readers[] = {
    {"blendbsdf", read_blend},
    {"bumpmap", read_bump_map},
    {"conductor", read_metal<Conductor>},
    {"dielectric", read_glass<Dielectric>},
    {"diffuse", read_plain<Diffuse>},
    {"mask", read_mask},
    {"mixturebsdf", read_mixture},
    {"normalmap", read_normal_map},
    {"null", read_plain<Null>},
    {"phong", read_heuristic<Phong>},
    {"plastic", read_plastic<Plastic>},
    {"principled", read_principled<Principled>},
    {"principledthin", read_principled<PrincipledThin>},
    {"roughconductor", read_metal<RoughConductor>},
    {"roughdielectric", read_rough_glass},
    {"roughdiffuse", read_plain<RoughDiffuse>},
    {"roughplastic", read_plastic<RoughPlastic>},
    {"thindielectric", read_glass<ThinDielectric>},
    {"twosided", read_two_sided},
    {"ward", read_heuristic<Ward>},
};

Material read_bsdf(const XmlNode& node, const Context& context) {
  const Reader reader = plugin_of_type<Reader>(readers, node);
  Properties properties(node, context.tree);
  Material material = reader(properties, context);
  properties.finish();
  return material;
}

}  // namespace

std::uint32_t MitsubaMaterials::add(Material material) {
  materials_.push_back(std::move(material));
  return static_cast<std::uint32_t>(materials_.size() - 1);
}

std::uint32_t MitsubaMaterials::of(const XmlNode& bsdf) {
  if (const auto known = index_.find(&bsdf); known != index_.end()) return known->second;
  return index_[&bsdf] = add(read_bsdf(bsdf, {tree_, textures_}));
}

std::uint32_t MitsubaMaterials::standard(bool emits) {
  if (const auto known = standard_.find(emits); known != standard_.end()) return known->second;
  const Diffuse diffuse{C3f(emits ? 0.0f : 0.5f)};
  return standard_[emits] = add(one_sided(emits ? "black" : "default", diffuse));
}

}  // namespace twopass
