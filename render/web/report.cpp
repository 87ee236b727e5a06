#include "render/web/report.h"

#include <cmath>
#include <cstdio>

#include "render/image/raster_file.h"
#include "render/version.h"
#include "render/web/base64.h"
#include "render/web/page_template.h"

namespace twopass {

namespace {

constexpr char report_css[] =
#include "web/report.css.inc"
    ;

}  // namespace

std::string escape_json_in_html(std::string json) {
  // "<" stands in strings alone, where \u003c is the same.
  for (std::size_t at = 0; (at = json.find('<', at)) != std::string::npos; at += 6)
    json.replace(at, 1, "\\u003c");
  return json;
}

std::string png_uri(const Image& image) { return "data:image/png;base64," + base64(encode_png(image)); }

std::string number_text(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

std::string html_document(std::string_view title, std::string_view body, std::string_view script) {
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      // Nothing is fetched from anywhere, whatever the page holds.
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
      "img-src data: blob:; style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n<title>";
  page += escape_html(title);
  page += "</title>\n<style>\n";
  page += report_css;
  page += "</style>\n</head>\n<body>\n";
  page += body;
  page += "<footer>twopass " + std::string(program_version) + "</footer>\n";
  if (!script.empty()) page.append("<script>\n").append(script).append("</script>\n");
  page += "</body>\n</html>\n";
  return page;
}

}  // namespace twopass
