// The report of `twopass bench`: one file with plots, pictures and tables.
#pragma once

#include <string>

#include "render/bench/results.h"
#include "render/image/color.h"

namespace twopass {

/// The page. `display` shows the pictures. Throws Error.
std::string bench_page(const BenchResults& results, const DisplayTransform& display);

}  // namespace twopass
