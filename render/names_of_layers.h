// The layers that can be asked for, by name.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "render/core/names.h"
#include "render/image/film_layers.h"

namespace twopass {

/// Arbitrary output variables. The first eight are in the order of LightClass, and sum to the picture.
enum class Aov : std::uint8_t {
  emission,
  background,
  diffuse_direct,
  diffuse_indirect,
  specular_direct,
  specular_indirect,
  transmission_direct,
  transmission_indirect,
  albedo,
  shading_normal,
  geometric_normal,
  position,
  depth,
  uv,
  id,
  element,
  radiosity,
  cache,
  choice,
  samples,
  variance,
  invalid
};

inline constexpr Named<Aov> aov_names[] = {
    {"emission", Aov::emission},
    {"background", Aov::background},
    {"diffuse_direct", Aov::diffuse_direct},
    {"diffuse_indirect", Aov::diffuse_indirect},
    {"specular_direct", Aov::specular_direct},
    {"specular_indirect", Aov::specular_indirect},
    {"transmission_direct", Aov::transmission_direct},
    {"transmission_indirect", Aov::transmission_indirect},
    {"albedo", Aov::albedo},
    {"N", Aov::shading_normal},
    {"Ng", Aov::geometric_normal},
    {"P", Aov::position},
    {"Z", Aov::depth},
    {"uv", Aov::uv},
    {"id", Aov::id},
    {"element", Aov::element},
    {"radiosity", Aov::radiosity},
    {"cache", Aov::cache},
    {"choice", Aov::choice},
    {"samples", Aov::samples},
    {"variance", Aov::variance},
    {"invalid", Aov::invalid},
};

/// The layers of a list such as "light,N,Z": names, or groups of them ("light": the eight that sum to the
/// picture; "denoise": albedo and N; "all"), each once, in the order of the table. Throws Error, listing the
/// choices.
std::vector<Aov> aovs_of(std::string_view list);
/// Its channels, and how they are filled.
FilmLayer layer_of(Aov aov);

/// What Cryptomatte tells apart.
enum class CryptomatteKind : std::uint8_t {
  object,    ///< shapes by name
  material,  ///< by name
  asset      ///< shapes by the first part of their names, before '/' or ':': instances, nodes
};
inline constexpr Named<CryptomatteKind> cryptomatte_names[] = {{"object", CryptomatteKind::object},
                                                               {"material", CryptomatteKind::material},
                                                               {"asset", CryptomatteKind::asset}};
/// As aovs_of; "all" is all three.
std::vector<CryptomatteKind> cryptomattes_of(std::string_view list);
/// Its layer: "CryptoObject" ...
std::string_view cryptomatte_layer(CryptomatteKind kind);

}  // namespace twopass
