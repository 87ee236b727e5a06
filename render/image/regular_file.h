// The door through which every file of a scene is read: meshes, textures, includes. Regular files only, because
// a scene is data from elsewhere, and a pipe or a device that it names could block, never end, or do something.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace twopass {

/// Throws Error unless `path` is a regular file (or a link to one): `path: what; what to do`. With `asked_by`,
/// the file:line that names the path, the error is `asked_by: path: what; what to do`. For libraries that want
/// a name; prefer read_regular_file, which leaves no time between check and reading.
void check_regular_file(const std::filesystem::path& path, std::string_view asked_by = {});

/// A regular file to be read from front to back. Its size is that at opening; bytes that are appended later are
/// not read. (Not mapped: a mapped file that somebody shortens kills its reader.)
class RegularFile {
 public:
  /// Throws as check_regular_file, and when the file cannot be opened.
  explicit RegularFile(std::filesystem::path path, std::string_view asked_by = {});
  ~RegularFile();
  RegularFile(const RegularFile&) = delete;
  RegularFile& operator=(const RegularFile&) = delete;
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Reads the next `count` bytes, or those that are left; returns how many. Throws Error when the file has
  /// become shorter or cannot be read.
  std::size_t read(char* to, std::size_t count);

 private:
  std::filesystem::path path_;
  std::string asked_by_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0, done_ = 0;
};

/// The bytes of a regular file. Throws as RegularFile, and when it is larger than the machine's memory.
std::string read_regular_file(const std::filesystem::path& path, std::string_view asked_by = {});

/// What `path` means on a machine that is strict about names: itself where it exists; else with back-slashes as
/// slashes; else the entry that differs in the case of (ASCII) letters alone, folder by folder, the first in
/// byte order where there are several. Nothing where there is none. What is found may be a folder or a device:
/// reading it says so.
std::optional<std::filesystem::path> find_any_case(const std::filesystem::path& path);

}  // namespace twopass
