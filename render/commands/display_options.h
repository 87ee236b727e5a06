// Options of how pictures are coloured, which several commands share.
#pragma once

#include <CLI/CLI.hpp>

#include "render/image/color.h"

namespace twopass {

/// Adds --ocio, --display, --view, --look and --exposure. REQUIRES: `display` outlives the command.
void add_display_options(CLI::App& command, DisplayOptions& display);
/// Adds --ocio alone.
void add_ocio_option(CLI::App& command, std::string& config);
/// Adds --working-space.
void add_working_space_option(CLI::App& command, std::string& name);

}  // namespace twopass
