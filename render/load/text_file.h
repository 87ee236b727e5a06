// Whole files into memory, with an error for everything that is not a readable file.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace twopass {

/// The bytes of a file. Throws Error naming the file when it is missing, is a folder or a device, or cannot be
/// read.
std::string read_text_file(const std::filesystem::path& path);

/// Removes a UTF-8 byte order mark in front of `text`.
std::string_view without_byte_order_mark(std::string_view text);
/// The same. Throws Error at `where` for a byte order mark of UTF-16.
std::string_view utf8_text(std::string_view text, std::string_view where);

/// `text` in single quotes, for errors.
std::string in_quotes(std::string_view text);

/// `text` in lower case (ASCII only: plugin names, extensions, "true").
std::string lower_case(std::string_view text);

}  // namespace twopass
