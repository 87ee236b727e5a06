// How the files of the module twopass_oiio.so give up, before its C interface reports why.
#pragma once

#include <stdexcept>
#include <string>

/// Throws what OpenImageIO says of a failure.
[[noreturn]] inline void fail(const std::string& text) {
  throw std::runtime_error(text.empty() ? "OpenImageIO gives no reason" : text);
}
