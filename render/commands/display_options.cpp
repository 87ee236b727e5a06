#include "render/commands/display_options.h"

namespace twopass {

void add_display_options(CLI::App& command, DisplayOptions& display) {
  command.add_option("--ocio", display.config, "OpenColorIO configuration (default: $OCIO, else built in)");
  command.add_option("--display", display.display, "Display of the configuration");
  command.add_option("--view", display.view, "View of the display");
  command.add_option("--exposure", display.exposure_stops, "Exposure of display-referred pictures, stops");
}

}  // namespace twopass
