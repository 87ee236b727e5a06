// Pieces of reports: one HTML file each, that opens by double click and needs no network.
#pragma once

#include <string>
#include <string_view>

#include "render/image/image.h"

namespace twopass {

/// JSON that may stand in a script element: nothing in it ends the element. REQUIRES: `json` is JSON.
std::string escape_json_in_html(std::string json);
/// A data: URI of a PNG of display-referred R, G, B in [0, 1]. Throws Error.
std::string png_uri(const Image& image);
/// A number as people read it: six significant digits, "-" if it is infinite.
std::string number_text(double value, int digits = 6);

/// A document of its own: the style of all reports, `body`, and a script that runs once the body is there
/// (empty: none). `title` is plain text.
std::string html_document(std::string_view title, std::string_view body, std::string_view script);

}  // namespace twopass
