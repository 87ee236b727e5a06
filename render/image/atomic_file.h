// Files that are either whole or not there: written under a temporary name in the same folder, then renamed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

namespace twopass {

/// Fails early, before hours of rendering: throws Error unless a file can be created or replaced at `path`.
/// Leaves nothing behind and does not touch an existing file.
void check_writable(const std::filesystem::path& path);

/// Replaces the file at `path` by `bytes`, durably (fsync). On any failure (full disk, permissions) throws
/// Error; the temporary file is removed and a file that stood there before is unharmed. A link is followed.
/// Devices and pipes, which cannot be replaced, are written directly.
void write_atomically(const std::filesystem::path& path, std::span<const std::byte> bytes);

/// The same piece by piece, for files that are larger than the memory for them. All members throw Error;
/// without commit() nothing has happened.
class AtomicWriter {
 public:
  explicit AtomicWriter(const std::filesystem::path& path);
  ~AtomicWriter();
  AtomicWriter(const AtomicWriter&) = delete;
  AtomicWriter& operator=(const AtomicWriter&) = delete;

  /// Writes at the position and moves it.
  void write(std::span<const std::byte> bytes);
  [[nodiscard]] std::uint64_t position() const;
  /// REQUIRES: the position is within what has been written.
  void seek(std::uint64_t position);
  /// Puts the file in its place, durably. What stood there is kept under the name `previous` unless that is
  /// empty; at every moment one of the two is whole. Called once, at last.
  void commit(const std::filesystem::path& previous = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A name beside `path` that nobody else uses and that keeps its extension: `.name.PID.N.tmp.ext`.
std::filesystem::path temporary_path_beside(const std::filesystem::path& path);

}  // namespace twopass
