// The packets of tev's network protocol (github.com/Tom94/tev, Ipc.h), which HDRView understands, too: pictures
// and pieces of pictures for a viewer. Knows no socket.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "render/core/types.h"

namespace twopass {

/// Makes, or replaces, an empty picture of float channels. `name` and channels: UTF-8 without zero bytes.
std::vector<std::byte> create_image_packet(const std::string& name, const V2i& size,
                                           std::span<const std::string> channels, bool grab_focus);

/// Replaces a part of it, of all the channels; `pixels` are interleaved, row by row (UpdateImage, version 3:
/// tev 1.18 and later). REQUIRES: one float for each channel and pixel.
std::vector<std::byte> update_image_packet(const std::string& name, std::span<const std::string> channels,
                                           const V2i& corner, const V2i& size, std::span<const float> pixels);

/// Closes it.
std::vector<std::byte> close_image_packet(const std::string& name);

}  // namespace twopass
