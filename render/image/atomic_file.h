// Files that are either whole or not there: written under a temporary name in the same folder, then renamed.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

namespace twopass {

/// Fails early, before hours of rendering: throws Error unless a file can be created or replaced at `path`.
/// Leaves nothing behind and does not touch an existing file.
void check_writable(const std::filesystem::path& path);

/// Replaces the file at `path` by `bytes`, durably (fsync). On any failure (full disk, permissions) throws
/// Error; the temporary file is removed and a file that stood there before is unharmed. A link is followed.
/// Devices and pipes, which cannot be replaced, are written directly.
void write_atomically(const std::filesystem::path& path, std::span<const std::byte> bytes);

/// A name beside `path` that nobody else uses and that keeps its extension: `.name.PID.N.tmp.ext`.
std::filesystem::path temporary_path_beside(const std::filesystem::path& path);

}  // namespace twopass
