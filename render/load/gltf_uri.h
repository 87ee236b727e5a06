// What the URIs of a glTF file lead to: bytes in the URI itself, or a file beside the scene. Never the network.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace twopass {

/// The bytes of a "data:" URI, base64 or percent-encoded; nullopt for other URIs. Throws Error at `where` when
/// they cannot be decoded.
std::optional<std::string> bytes_of_data_uri(std::string_view uri, std::string_view where);

/// The file that a relative or absolute path names, percent-encoded as URIs are; relative to `folder`. It need
/// not exist. Throws Error at `where` for anything with a scheme, http among them.
std::filesystem::path path_of_uri(std::string_view uri, const std::filesystem::path& folder,
                                  std::string_view where);

}  // namespace twopass
