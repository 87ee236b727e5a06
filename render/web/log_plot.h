// A plot of lines over logarithmic axes, as inline SVG.
#pragma once

#include <string>
#include <vector>

#include "render/core/types.h"

namespace twopass {

struct PlotLine {
  std::string name;
  std::vector<V2d> points;  ///< those not positive are left out
};

struct LogPlot {
  std::string x_label, y_label, description;  ///< the last for those who cannot see it
  std::vector<PlotLine> lines;
  double slope = -1.0;  ///< of the guides, decade per decade
};

/// An SVG element with axes by decades, a legend, a mark and a tooltip at each point, and dotted guides of the
/// given slope. A text that says so, if there is no point.
std::string log_plot_svg(const LogPlot& plot);

}  // namespace twopass
