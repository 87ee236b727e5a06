#include "render/load/mitsuba_model.h"

#include <cstdio>

namespace twopass {

ParameterRange range_of_parameter(std::string_view name) {
  if (name.starts_with("alpha")) return {0.0, 10.0};
  if (name == "exponent") return {0.0, 1e6};
  if (name == "diff_trans") return {0.0, 2.0};
  if (name.ends_with("sampling_rate")) return {0.0, 1e6};
  return {0.0, 1.0};
}

void ModelReader::set(std::string_view name, std::size_t number, C3f& parameter) {
  const std::optional<Texture> given = textures_.property(p_, name, ColorUse::reflectance);
  if (!given) return;
  if (const auto* color = std::get_if<C3f>(&*given))
    parameter = *color;
  else
    bindings_.push_back({number, *given});
}

void ModelReader::set(std::string_view name, std::size_t number, float& parameter) {
  // Roughness may be given once for both tangents.
  std::string_view property = name;
  if ((name == "alpha_u" || name == "alpha_v") && !p_.has(name) && p_.has("alpha")) property = "alpha";
  if (property != name && (p_.has("alpha_u") || p_.has("alpha_v")))
    throw Error(p_.where("alpha"), "'alpha' is given together with 'alpha_u' or 'alpha_v'",
                "give one or the others");
  const XmlNode* node = p_.element(property, {});
  if (!node) return;
  if (node->tag == "texture") {
    bindings_.push_back({number, textures_.of(*node, ColorUse::index)});
    return;
  }
  const double value = *p_.number(property);
  const ParameterRange range = range_of_parameter(name);
  if (!(value >= range.low && value <= range.high)) {
    char text[80];
    std::snprintf(text, sizeof text, "must be between %g and %g", range.low, range.high);
    throw Error(p_.where(property), std::string(property) + " is out of range", text);
  }
  parameter = static_cast<float>(value);
}

}  // namespace twopass
