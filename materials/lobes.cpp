#include "materials/lobes.h"

namespace twopass {

namespace {

float normal_reflectance(float eta) {
  const float root = (eta - 1.0f) / (eta + 1.0f);
  return root * root;
}

struct SpecularAlbedo {
  C3f operator()(const Conductor& m) const {
    return m.specular_reflectance * fresnel_conductor(1.0f, m.eta, m.k);
  }
  C3f operator()(const RoughConductor& m) const {
    return m.specular_reflectance * fresnel_conductor(1.0f, m.eta, m.k);
  }
  C3f operator()(const Dielectric& m) const { return glass(m); }
  C3f operator()(const RoughDielectric& m) const { return glass(m); }
  C3f operator()(const ThinDielectric& m) const { return glass(m); }
  C3f operator()(const Plastic& m) const { return m.specular_reflectance * normal_reflectance(m.eta); }
  C3f operator()(const RoughPlastic& m) const { return m.specular_reflectance * normal_reflectance(m.eta); }
  C3f operator()(const Phong& m) const { return m.specular_reflectance; }
  C3f operator()(const Ward& m) const { return m.specular_reflectance; }
  C3f operator()(const Null&) const { return C3f(1.0f); }
  // The diffuse albedo is all.
  C3f operator()(const Diffuse&) const { return C3f(0.0f); }
  C3f operator()(const RoughDiffuse&) const { return C3f(0.0f); }
  // What their diffuse lobes leave of the base colour is that of metal and glass.
  C3f operator()(const Principled& m) const { return rest(m); }
  C3f operator()(const PrincipledThin& m) const { return rest(m); }

 private:
  template <class Glass>
  static C3f glass(const Glass& m) {
    const float reflected = normal_reflectance(m.eta);
    return m.specular_reflectance * reflected + m.specular_transmittance * (1.0f - reflected);
  }
  template <class Model>
  static C3f rest(const Model& m) {
    const C3f diffuse = m.diffuse_reflectance();
    C3f rest(0.0f);
    for (int c = 0; c < 3; ++c) rest[c] = std::max(0.0f, m.base_color[c] - diffuse[c]);
    return rest;
  }
};

// Reflects diffusely and in no other way, or not at all.
bool is_all_diffuse(const Bsdf& bsdf) {
  return std::holds_alternative<Diffuse>(bsdf) || std::holds_alternative<RoughDiffuse>(bsdf) ||
         std::holds_alternative<Null>(bsdf);
}

bool is_more_than_diffuse(const MaterialNode& node) {
  if (const auto* model = std::get_if<TexturedModel>(&node.kind)) return !is_all_diffuse(model->bsdf);
  if (const auto* mixture = std::get_if<Mixture>(&node.kind))
    return is_more_than_diffuse(*mixture->first) || is_more_than_diffuse(*mixture->second);
  if (const auto* bump = std::get_if<BumpMap>(&node.kind)) return is_more_than_diffuse(*bump->nested);
  return is_more_than_diffuse(*std::get<NormalMap>(node.kind).nested);
}

}  // namespace

bool is_more_than_diffuse(const MaterialSide& side) {
  return side.is_uniform() ? !is_all_diffuse(side.uniform()) : is_more_than_diffuse(*side.node());
}

C3f albedo(const Bsdf& bsdf) {
  const C3f sum = diffuse_reflectance(bsdf) + std::visit(SpecularAlbedo{}, bsdf);
  return {std::clamp(sum.x, 0.0f, 1.0f), std::clamp(sum.y, 0.0f, 1.0f), std::clamp(sum.z, 0.0f, 1.0f)};
}

}  // namespace twopass
