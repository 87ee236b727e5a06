#include "render/web/log_plot.h"

#include <array>
#include <cmath>

#include "render/web/page_template.h"
#include "render/web/report.h"

namespace twopass {

namespace {

constexpr double left = 62, top = 12, width = 430, height = 300, bottom = 44, legend = 170;
// Okabe and Ito's colours, which people tell apart however they see.
constexpr std::array<const char*, 7> colors{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                            "#e69f00", "#56b4e9", "#777777"};

// Decades that hold all values.
struct Range {
  int low = 0, high = 0;
  bool is_empty = true;
  void add(double value) {
    const int floor = static_cast<int>(std::floor(std::log10(value)));
    const int ceil = static_cast<int>(std::ceil(std::log10(value)));
    low = is_empty ? floor : std::min(low, floor);
    high = is_empty ? ceil : std::max(high, ceil);
    is_empty = false;
  }
  // At least one decade.
  void widen() {
    if (high <= low) high = low + 1;
  }
};

bool is_good(const V2d& p) { return p.x > 0.0 && p.y > 0.0 && std::isfinite(p.x) && std::isfinite(p.y); }

std::string at(double x, double y) { return number_text(x, 5) + " " + number_text(y, 5); }

std::string text_at(double x, double y, const char* anchor, const std::string& text,
                    const std::string& more = "") {
  return "<text x=\"" + number_text(x, 5) + "\" y=\"" + number_text(y, 5) + "\" text-anchor=\"" + anchor +
         "\"" + more + ">" + escape_html(text) + "</text>\n";
}

}  // namespace

std::string log_plot_svg(const LogPlot& plot) {
  Range x, y;
  for (const PlotLine& line : plot.lines)
    for (const V2d& p : line.points)
      if (is_good(p)) x.add(p.x), y.add(p.y);
  if (x.is_empty) return "<p class=\"quiet\">Nothing to plot.</p>\n";
  x.widen();
  y.widen();
  const auto px = [&](double value) { return left + width * (std::log10(value) - x.low) / (x.high - x.low); };
  const auto py = [&](double value) { return top + height * (y.high - std::log10(value)) / (y.high - y.low); };

  std::string svg = "<svg role=\"img\" aria-label=\"" + escape_html(plot.description) + "\" width=\"" +
                    number_text(left + width + legend) + "\" height=\"" + number_text(top + height + bottom) +
                    "\">\n";
  for (int decade = x.low; decade <= x.high; ++decade) {
    const double at_x = px(std::pow(10.0, decade));
    svg += "<path class=\"grid\" d=\"M" + at(at_x, top) + "V" + number_text(top + height) + "\"/>\n" +
           text_at(at_x, top + height + 16, "middle", number_text(std::pow(10.0, decade), 6));
  }
  for (int decade = y.low; decade <= y.high; ++decade) {
    const double at_y = py(std::pow(10.0, decade));
    svg += "<path class=\"grid\" d=\"M" + at(left, at_y) + "H" + number_text(left + width) + "\"/>\n" +
           text_at(left - 6, at_y + 4, "end", number_text(std::pow(10.0, decade)));
  }
  // Guides cut the left edge at the decades, and are clipped where they leave the frame.
  for (int decade = y.low + 1; decade <= y.high + (x.high - x.low); ++decade) {
    const double rise = plot.slope * (x.high - x.low);  // over the whole width
    double x0 = x.low, y0 = decade, x1 = x.high, y1 = decade + rise;
    if (y0 > y.high) x0 += (y.high - y0) / plot.slope, y0 = y.high;
    if (y1 < y.low) x1 += (y.low - y1) / plot.slope, y1 = y.low;
    if (x0 >= x1) continue;
    svg += "<path class=\"guide\" d=\"M" + at(px(std::pow(10.0, x0)), py(std::pow(10.0, y0))) + "L" +
           at(px(std::pow(10.0, x1)), py(std::pow(10.0, y1))) + "\"/>\n";
  }
  svg += "<path class=\"axis\" d=\"M" + at(left, top) + "V" + number_text(top + height) + "H" +
         number_text(left + width) + "\"/>\n";
  svg += text_at(left + width / 2, top + height + 36, "middle", plot.x_label);
  svg += text_at(0, 0, "middle", plot.y_label,
                 " transform=\"translate(14 " + number_text(top + height / 2) + ") rotate(-90)\"");
  double row = top + 12;
  for (std::size_t i = 0; i < plot.lines.size(); ++i) {
    const std::string color = colors[i % colors.size()];
    std::string path, marks;
    for (const V2d& p : plot.lines[i].points) {
      if (!is_good(p)) continue;
      path += path.empty() ? 'M' : 'L';
      path += at(px(p.x), py(p.y));
      marks += "<circle r=\"3\" fill=\"" + color + "\" cx=\"" + number_text(px(p.x), 5) + "\" cy=\"" +
               number_text(py(p.y), 5) + "\"><title>" + escape_html(plot.lines[i].name) + ": " +
               number_text(p.x, 4) + ", " + number_text(p.y, 3) + "</title></circle>\n";
    }
    if (!path.empty())
      svg += "<path fill=\"none\" stroke=\"" + color + "\" stroke-width=\"2\" d=\"" + path + "\"/>\n" + marks;
    svg += "<path stroke=\"" + color + "\" stroke-width=\"3\" d=\"M" + at(left + width + 14, row - 4) +
           "h18\"/>\n" + text_at(left + width + 38, row, "start", plot.lines[i].name);
    row += 18;
  }
  svg += "<path class=\"guide\" d=\"M" + at(left + width + 14, row - 4) + "h18\"/>\n" +
         text_at(left + width + 38, row, "start", "slope " + number_text(plot.slope, 2));
  return svg + "</svg>\n";
}

}  // namespace twopass
