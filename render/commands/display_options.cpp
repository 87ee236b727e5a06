#include "render/commands/display_options.h"

namespace twopass {

void add_display_options(CLI::App& command, DisplayOptions& display) {
  command.add_option("--ocio", display.config,
                     "OpenColorIO configuration; default $OCIO, else the built-in one");
  command.add_option("--display", display.display, "Display of the configuration");
  command.add_option("--view", display.view, "View of the display");
  command.add_option("--look", display.look, "Looks of the configuration to apply before the view");
  command.add_option("--exposure", display.exposure_stops, "Exposure of display-referred pictures, stops");
  command.add_option(
      "--working-space", display.working_space,
      "Linear space of the configuration that light is computed and stored in, such as ACEScg; default "
      "linear Rec.709");
}

}  // namespace twopass
