// What is in a loaded scene, as JSON: for `info`, in both of its forms.
#pragma once

#include <nlohmann/json.hpp>

#include "render/load/load.h"

namespace twopass {

/// Counts, bounds, camera, lights, textures, needs, what will be skipped; under "problems" sentences, under
/// "notes" the loader's, on what looks like a mistake; under "shapes_by_name" and "materials_by_name" a row for
/// each.
nlohmann::ordered_json scene_report(const LoadedScene& loaded);

}  // namespace twopass
