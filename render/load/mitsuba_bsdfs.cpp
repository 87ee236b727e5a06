#include "render/load/mitsuba_bsdfs.h"

#include "materials/ior.h"
#include "render/core/error.h"
#include "render/load/mitsuba_properties.h"
#include "render/load/text_file.h"

namespace twopass {
namespace {

Material read_bsdf(const XmlNode& node, const MitsubaTree& tree);

Material read_diffuse(Properties& p, const MitsubaTree&) {
  return one_sided(p.id_or("diffuse"),
                   Diffuse{p.color("reflectance", ColorUse::reflectance).value_or(C3f(0.5f))});
}

Material read_conductor(Properties& p, const MitsubaTree& tree) {
  Conductor metal;
  // Mitsuba 1 took copper for granted, later versions an ideal mirror.
  const bool has_index = p.has("eta") || p.has("k");
  const std::string standard = tree.version < 2.0 && !has_index ? "Cu" : "none";
  const std::optional<std::string> given = p.text("material");
  const std::string material = given.value_or(standard);
  if (material != "none" && !(material.empty() && has_index))
    throw Error(p.where("material"), "metals by name ('" + material + "') are not supported yet",
                "give eta and k, or material \"none\" for an ideal mirror");
  const std::optional<C3f> eta = p.color("eta", ColorUse::index), k = p.color("k", ColorUse::index);
  if (given && (eta || k))
    throw Error(p.where("material"), "both 'material' and 'eta' or 'k' are given", "give one of them");
  if (eta.has_value() != k.has_value())
    throw Error(p.where(), "a conductor needs both 'eta' and 'k'", "give the other one, too");
  if (eta) {
    float outside = 1.0f;
    if (const XmlNode* ext = p.element("ext_eta", {"float", "integer", "string"}))
      outside = ext->tag == "string" ? ior_of(ext->get("value"), ext->where())
                                     : static_cast<float>(parse_number_attribute(*ext, "value"));
    if (!(outside > 0.0f))
      throw Error(p.where("ext_eta"), "an index of refraction must be positive", "correct it");
    metal.eta = *eta * (1.0f / outside);
    metal.k = *k * (1.0f / outside);
  }
  metal.specular_reflectance = p.color("specular_reflectance", ColorUse::reflectance).value_or(C3f(1.0f));
  return one_sided(p.id_or("conductor"), metal);
}

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

Material read_dielectric(Properties& p, const MitsubaTree&) {
  Dielectric outside;
  outside.eta = read_ior(p, "int_ior", "bk7") / read_ior(p, "ext_ior", "air");
  outside.specular_reflectance = p.color("specular_reflectance", ColorUse::reflectance).value_or(C3f(1.0f));
  outside.specular_transmittance = p.color("specular_transmittance", ColorUse::reflectance).value_or(C3f(1.0f));
  return interface_material(p.id_or("dielectric"), outside);
}

Material read_two_sided(Properties& p, const MitsubaTree& tree) {
  const std::vector<const XmlNode*> nested = p.objects("bsdf");
  if (nested.empty() || nested.size() > 2)
    throw Error(p.where(), "bsdf 'twosided' holds " + std::to_string(nested.size()) + " bsdfs",
                "give one for both sides, or one for the front and one for the back");
  for (const XmlNode* inner : nested)
    if (inner->get("type") == "twosided" || inner->get("type") == "dielectric")
      throw Error(inner->where(), "bsdf '" + inner->get("type") + "' has two sides already",
                  "do not nest it in twosided");
  const Material front_material = read_bsdf(*nested.front(), tree),
                 back_material = read_bsdf(*nested.back(), tree);
  return two_sided(p.id_or(front_material.name), front_material.side[front], back_material.side[front]);
}

using Reader = Material (*)(Properties&, const MitsubaTree&);

constexpr Named<Reader> readers[] = {
    {"conductor", read_conductor},
    {"dielectric", read_dielectric},
    {"diffuse", read_diffuse},
    {"twosided", read_two_sided},
};

Material read_bsdf(const XmlNode& node, const MitsubaTree& tree) {
  const Reader reader = plugin_of_type<Reader>(readers, node);
  Properties properties(node, tree);
  Material material = reader(properties, tree);
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
  return index_[&bsdf] = add(read_bsdf(bsdf, tree_));
}

std::uint32_t MitsubaMaterials::standard(bool emits) {
  if (const auto known = standard_.find(emits); known != standard_.end()) return known->second;
  const Diffuse diffuse{C3f(emits ? 0.0f : 0.5f)};
  return standard_[emits] = add(one_sided(emits ? "black" : "default", diffuse));
}

}  // namespace twopass
