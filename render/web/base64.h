// Bytes as text, for pages that hold them.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace twopass {

/// The bytes in base64 (RFC 4648, section 4), padded.
std::string base64(std::span<const std::byte> bytes);

}  // namespace twopass
