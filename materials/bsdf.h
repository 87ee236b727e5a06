// The closed set of scattering models. Adding one: its header, its name in the variant, its line in the
// loader's table.
#pragma once

#include <concepts>
#include <string_view>
#include <type_traits>
#include <variant>

#include "materials/conductor.h"
#include "materials/dielectric.h"
#include "materials/diffuse.h"
#include "materials/null_model.h"
#include "materials/phong.h"
#include "materials/plastic.h"
#include "materials/principled.h"
#include "materials/principled_thin.h"
#include "materials/rough_conductor.h"
#include "materials/rough_dielectric.h"
#include "materials/rough_diffuse.h"
#include "materials/rough_plastic.h"
#include "materials/thin_dielectric.h"
#include "materials/ward.h"

namespace twopass {

/// What a scattering model must offer; conventions in materials/bsdf_sample.h.
template <class Model>
concept ScatteringModel = requires(const Model& model, V3f w, V2f u) {
  { model.eval(w, w) } -> std::same_as<C3f>;     // f(wo, wi) |wi.z|, without Dirac parts
  { model.pdf_w(w, w) } -> std::same_as<float>;  // density of sample() in solid angle, without Dirac parts
  { model.sample(w, u) } -> std::same_as<std::optional<BsdfSample>>;  // nullopt: absorbed
  {
    model.diffuse_reflectance()
    } -> std::same_as<C3f>;                       // albedo of the part that a radiosity solution can hold
  { model.is_specular() } -> std::same_as<bool>;  // only Dirac parts: nothing to evaluate
  Model::visit_parameters(model, [](std::string_view, const auto&) {});  // (name, member) of each parameter
};

using Bsdf = std::variant<Diffuse, Conductor, Dielectric, RoughConductor, RoughDielectric, ThinDielectric,
                          Plastic, RoughPlastic, RoughDiffuse, Phong, Ward, Principled, PrincipledThin, Null>;

/// What the models are called, in the variant's order.
inline constexpr std::string_view model_names[] = {"diffuse",
                                                   "conductor",
                                                   "dielectric",
                                                   "roughconductor",
                                                   "roughdielectric",
                                                   "thindielectric",
                                                   "plastic",
                                                   "roughplastic",
                                                   "roughdiffuse",
                                                   "phong",
                                                   "ward",
                                                   "principled",
                                                   "principledthin",
                                                   "null"};
static_assert(std::size(model_names) == std::variant_size_v<Bsdf>);

template <class... Models>
constexpr bool all_are_models(const std::variant<Models...>*) {
  return (ScatteringModel<Models> && ...);
}
static_assert(all_are_models(static_cast<const Bsdf*>(nullptr)));
static_assert(std::is_trivially_destructible_v<Bsdf> && sizeof(Bsdf) <= 128);  // copied at every textured hit

/// f(model) of the model that it is. Most surfaces are diffuse: they cost a branch that is easy to predict
/// instead of a jump through a table, and are inlined where the others are called.
template <class F>
decltype(auto) visit_model(const Bsdf& bsdf, F&& f) {
  if (const auto* diffuse = std::get_if<Diffuse>(&bsdf)) return f(*diffuse);
  return std::visit(f, bsdf);
}

/// Value and density at once: models that share work between them have a function for both.
template <class Model>
BsdfValue evaluate(const Model& model, const V3f& wo, const V3f& wi) {
  if constexpr (requires { model.evaluate(wo, wi); })
    return model.evaluate(wo, wi);
  else
    return {model.eval(wo, wi), model.pdf_w(wo, wi)};
}

inline C3f eval(const Bsdf& bsdf, const V3f& wo, const V3f& wi) {
  return visit_model(bsdf, [&](const auto& model) { return model.eval(wo, wi); });
}
inline float pdf_w(const Bsdf& bsdf, const V3f& wo, const V3f& wi) {
  return visit_model(bsdf, [&](const auto& model) { return model.pdf_w(wo, wi); });
}
inline std::optional<BsdfSample> sample(const Bsdf& bsdf, const V3f& wo, const V2f& u) {
  return visit_model(bsdf, [&](const auto& model) { return model.sample(wo, u); });
}
inline C3f diffuse_reflectance(const Bsdf& bsdf) {
  return visit_model(bsdf, [](const auto& model) { return model.diffuse_reflectance(); });
}
inline bool is_specular(const Bsdf& bsdf) {
  return visit_model(bsdf, [](const auto& model) { return model.is_specular(); });
}

}  // namespace twopass
