// The parameters of scattering models by the names that Mitsuba and visit_parameters share.
#pragma once

#include <algorithm>
#include <initializer_list>

#include "materials/material.h"
#include "render/core/error.h"
#include "render/load/mitsuba_textures.h"

namespace twopass {

/// The range of a model's number by its name; the error for numbers outside says it.
struct ParameterRange {
  double low, high;
};
ParameterRange range_of_parameter(std::string_view name);

/// Names of a model's settings, for parameters that are neither colours nor numbers. Version 0.x knew Phong's
/// facets, too, whose alpha meant that of Beckmann's equally wide ones.
inline std::span<const Named<Microfacet>> names_of_setting(Microfacet) {
  static constexpr Named<Microfacet> names[] = {
      {"beckmann", Microfacet::beckmann}, {"ggx", Microfacet::ggx}, {"phong", Microfacet::beckmann}};
  return names;
}
inline std::span<const Named<WardVariant>> names_of_setting(WardVariant) { return ward_variant_names; }

/// Fills a model from a plugin's properties: colours and numbers, or textures in their place, and settings.
class ModelReader {
 public:
  /// `done`: parameters that the caller has set.
  ModelReader(Properties& properties, MitsubaTextures& textures,
              std::initializer_list<std::string_view> done = {})
      : p_(properties), textures_(textures), done_(done) {}

  template <class Model>
  MaterialSide read(Model model) {
    std::size_t number = 0;
    Model::visit_parameters(model, [&](std::string_view name, auto& parameter) {
      if (std::ranges::find(done_, name) == done_.end()) set(name, number, parameter);
      ++number;
    });
    if constexpr (requires { model.prepare(); }) model.prepare();
    return MaterialSide(
        std::make_shared<const MaterialNode>(MaterialNode{TexturedModel{model, std::move(bindings_)}}));
  }

 private:
  void set(std::string_view name, std::size_t number, C3f& parameter);
  void set(std::string_view name, std::size_t number, float& parameter);
  void set(std::string_view name, std::size_t, bool& parameter) {
    parameter = p_.boolean(std::string(name), parameter);
  }
  template <class Setting>
  void set(std::string_view name, std::size_t, Setting& parameter) {
    if (const auto text = p_.text(name))
      parameter = value_of_name<Setting>(names_of_setting(parameter), *text, p_.where(name), std::string(name));
  }

  Properties& p_;
  MitsubaTextures& textures_;
  std::vector<std::string_view> done_;
  std::vector<TextureBinding> bindings_;
};

}  // namespace twopass
