// Options of how pictures are coloured, which several commands share.
#pragma once

#include <CLI/CLI.hpp>

#include "render/image/color.h"

namespace twopass {

/// Adds --ocio, --display, --view, --look, --exposure and --working-space. REQUIRES: `display` outlives the
/// command.
void add_display_options(CLI::App& command, DisplayOptions& display);

}  // namespace twopass
