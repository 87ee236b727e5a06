#include "render/web/compare_json.h"

#include <cmath>

#include <nlohmann/json.hpp>

namespace twopass {

namespace {

using nlohmann::ordered_json;

ordered_json number_or_null(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}
ordered_json triple(const C3d& c) { return {number_or_null(c.x), number_or_null(c.y), number_or_null(c.z)}; }

ordered_json measures_json(const Comparison& c) {
  ordered_json json;
  for (const Measure& measure : measures()) json[std::string(measure.name)] = number_or_null(measure.value(c));
  json["energy_ratio"] = triple(c.energy_ratio);
  json["energy_ci95"] = triple(c.energy_ci95);
  json["bias2_error"] = number_or_null(c.bias2_error);
  if (c.known_variance) json["known_variance"] = number_or_null(*c.known_variance);
  json["non_finite"] = c.non_finite;
  json["size"] = {c.width, c.height};
  return json;
}

}  // namespace

ordered_json comparison_json(std::span<const ComparedLayer> layers) {
  ordered_json json = measures_json(layers.front().result);
  ordered_json& by_name = json["layers"] = ordered_json::object();
  for (const ComparedLayer& layer : layers) by_name[layer.pair.name] = measures_json(layer.result);
  return json;
}

}  // namespace twopass
