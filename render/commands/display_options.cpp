#include "render/commands/display_options.h"

namespace twopass {

void add_display_options(CLI::App& command, DisplayOptions& display) {
  add_ocio_option(command, display.config);
  command.add_option("--display", display.display, "Display of the configuration");
  command.add_option("--view", display.view, "View of the display");
  command.add_option("--look", display.look, "Look of the configuration to apply before the view");
  command.add_option("--exposure", display.exposure_stops, "Exposure of display-referred pictures, stops");
}

void add_ocio_option(CLI::App& command, std::string& config) {
  command.add_option("--ocio", config, "OpenColorIO configuration (default: $OCIO, else built in)");
}

void add_working_space_option(CLI::App& command, std::string& name) {
  command.add_option(
      "--working-space", name,
      "Linear space of the configuration, by name or role, that light is computed and stored in, "
      "such as ACEScg (default: linear Rec.709)");
}

}  // namespace twopass
