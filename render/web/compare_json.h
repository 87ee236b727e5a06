// The measures of a comparison as JSON: the same in --json and in the report.
#pragma once

#include <span>

#include <nlohmann/json_fwd.hpp>

#include "render/web/compare_page.h"

namespace twopass {

/// The first layer's measures, and under "layers" those of every layer by name; null where there is no value.
nlohmann::ordered_json comparison_json(std::span<const ComparedLayer> layers);

}  // namespace twopass
