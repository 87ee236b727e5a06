// A page to walk through a solution in a browser.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace twopass {

/// A self-contained HTML page that shows `glb`, made by glb_of, by WebGL: it needs no network and no other
/// file. `title` is shown as it is. Throws Error at `where` unless `glb` is such a display.
std::string walk_page(std::string_view title, std::span<const std::byte> glb, std::string_view where);

}  // namespace twopass
