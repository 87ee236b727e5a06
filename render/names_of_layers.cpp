#include "render/names_of_layers.h"

#include <algorithm>

namespace twopass {

namespace {

std::vector<std::string_view> parts_of(std::string_view list) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t comma = list.find(',');
    parts.push_back(list.substr(0, comma));
    if (comma == std::string_view::npos) return parts;
    list.remove_prefix(comma + 1);
  }
}

}  // namespace

std::vector<Aov> aovs_of(std::string_view list) {
  std::vector<bool> chosen(std::size(aov_names), false);
  const auto choose = [&](Aov first, Aov last) {
    for (auto i = static_cast<std::size_t>(first); i <= static_cast<std::size_t>(last); ++i) chosen[i] = true;
  };
  for (const std::string_view name : parts_of(list)) {
    const auto known = std::find_if(std::begin(aov_names), std::end(aov_names),
                                    [&](const Named<Aov>& entry) { return entry.name == name; });
    if (known != std::end(aov_names)) {
      choose(known->value, known->value);
    } else if (name == "light") {
      choose(Aov::emission, Aov::transmission_indirect);
    } else if (name == "denoise") {
      choose(Aov::albedo, Aov::shading_normal);
    } else if (name == "all") {
      choose(Aov::emission, Aov::invalid);
    } else {
      std::vector<std::string_view> names{"all", "light", "denoise"};
      for (const Named<Aov>& entry : aov_names) names.push_back(entry.name);
      throw Error("--aov", "unknown layer '" + std::string(name) + "'", "use one of: " + join_names(names));
    }
  }
  std::vector<Aov> aovs;
  for (std::size_t i = 0; i < chosen.size(); ++i)
    if (chosen[i]) aovs.push_back(static_cast<Aov>(i));
  return aovs;
}

FilmLayer layer_of(Aov aov) {
  const std::string name(name_of_value<Aov>(aov_names, aov));
  switch (aov) {
    case Aov::shading_normal:
    case Aov::geometric_normal:
      return {name, {"X", "Y", "Z"}, Reduction::mean};
    case Aov::position:
      return {name, {"X", "Y", "Z"}, Reduction::nearest};
    case Aov::depth:
      return {"", {name}, Reduction::nearest};
    case Aov::uv:
      return {name, {"U", "V"}, Reduction::nearest};
    case Aov::id:
      return {name, {"object", "material"}, Reduction::nearest};
    case Aov::element:
      return {name, {"X"}, Reduction::nearest};
    case Aov::cache:
      return {name, {"X"}, Reduction::mean};
    case Aov::choice:
      return {name, {"lookup", "gather", "trace"}, Reduction::mean};
    case Aov::samples:
      return {name, {"X"}, Reduction::samples};
    case Aov::variance:
      return {name, {"R", "G", "B"}, Reduction::variance};
    case Aov::invalid:
      return {name, {"X"}, Reduction::total};
    default:
      return {name, {"R", "G", "B"}, Reduction::mean};
  }
}

std::vector<CryptomatteKind> cryptomattes_of(std::string_view list) {
  if (list == "all") return {CryptomatteKind::object, CryptomatteKind::material, CryptomatteKind::asset};
  std::vector<CryptomatteKind> kinds;
  for (const std::string_view name : parts_of(list)) {
    const auto kind = value_of_name<CryptomatteKind>(cryptomatte_names, name, "--cryptomatte", "kind");
    if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) kinds.push_back(kind);
  }
  return kinds;
}

std::string_view cryptomatte_layer(CryptomatteKind kind) {
  switch (kind) {
    case CryptomatteKind::material:
      return "CryptoMaterial";
    case CryptomatteKind::asset:
      return "CryptoAsset";
    case CryptomatteKind::object:
      break;
  }
  return "CryptoObject";
}

}  // namespace twopass
