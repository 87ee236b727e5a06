// A render in words: while it runs, and at its end.
#pragma once

#include <span>
#include <string>

#include "integrators/clamp.h"
#include "render/console.h"
#include "render/render_image.h"
#include "render/statistics.h"

namespace twopass {

/// What the clamps do to the picture; empty without them.
std::string clamp_text(const PathLimits& limits);

/// "pass 3, 24 spp, noise 0.034, 5.1 Mrays/s"
std::string progress_text(const RenderProgress& at);

/// Prints what was written, how good it is and what was wrong with it; nothing on quiet consoles.
void report_render(std::span<const std::string> outputs, const RenderStatistics& s, const Console& console);

}  // namespace twopass
