#include "render/web/base64.h"

#include <algorithm>
#include <cstdint>

namespace twopass {

std::string base64(std::span<const std::byte> bytes) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - k);
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < 3; ++i)
      bits = bits << 8 | (i < count ? std::to_integer<std::uint32_t>(bytes[k + i]) : 0u);
    for (std::size_t i = 0; i < 4; ++i) text.push_back(i <= count ? digits[bits >> (18 - 6 * i) & 63u] : '=');
  }
  return text;
}

}  // namespace twopass
