#include "render/image/regular_file.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "render/core/error.h"
#include "render/core/memory.h"

namespace twopass {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& path, std::string_view asked_by, const std::string& what,
                         const std::string& remedy) {
  throw Error(asked_by.empty() ? path.string() : std::string(asked_by) + ": " + path.string(), what, remedy);
}

// `problem` is errno.
[[noreturn]] void refuse_to_open(const fs::path& path, std::string_view asked_by, int problem) {
  if (problem == ENOENT || problem == ENOTDIR)
    refuse(path, asked_by, "there is no such file", "check the name");
  refuse(path, asked_by, std::string("cannot be opened: ") + std::strerror(problem), "check its permissions");
}

void check_mode(mode_t mode, const fs::path& path, std::string_view asked_by) {
  if (S_ISREG(mode)) return;
  if (S_ISDIR(mode)) refuse(path, asked_by, "this is a folder", "name a file in it");
  const char* kind = S_ISFIFO(mode) ? "pipe" : S_ISSOCK(mode) ? "socket" : "device";
  refuse(path, asked_by, std::string("this is not a regular file but a ") + kind, "name a file");
}

std::string lower(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

// The entry of `folder` that is called `name` up to case.
std::optional<fs::path> entry_any_case(const fs::path& folder, const std::string& name) {
  if (is_there(folder / name)) return folder / name;
  const std::string wanted = lower(name);
  std::optional<std::string> found;
  std::error_code code;
  for (fs::directory_iterator entry(folder.empty() ? "." : folder, code), end; !code && entry != end;
       entry.increment(code)) {
    std::string candidate = entry->path().filename().string();
    if (lower(candidate) == wanted && (!found || candidate < *found)) found = std::move(candidate);
  }
  if (!found) return std::nullopt;
  return folder / *found;
}

}  // namespace

void check_regular_file(const fs::path& path, std::string_view asked_by) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) refuse_to_open(path, asked_by, errno);
  check_mode(status.st_mode, path, asked_by);
}

RegularFile::RegularFile(fs::path path, std::string_view asked_by)
    : path_(std::move(path)), asked_by_(asked_by) {
  // Asked before opening, because opening alone may have an effect on a device, and again of what was opened,
  // which may by now be something else; without blocking, in case that is a pipe.
  check_regular_file(path_, asked_by);
  descriptor_ = ::open(path_.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (descriptor_ < 0) refuse_to_open(path_, asked_by, errno);
  try {
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0) refuse_to_open(path_, asked_by, errno);
    check_mode(status.st_mode, path_, asked_by);
    size_ = static_cast<std::uint64_t>(status.st_size);
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

RegularFile::~RegularFile() { ::close(descriptor_); }

std::size_t RegularFile::read(char* to, std::size_t count) {
  count = static_cast<std::size_t>(std::min<std::uint64_t>(count, size_ - done_));
  for (std::size_t done = 0; done < count;) {
    const ssize_t got = ::read(descriptor_, to + done, count - done);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) refuse(path_, asked_by_, "cannot be read to its end", "check the disk");
    done += static_cast<std::size_t>(got);
  }
  done_ += count;
  return count;
}

std::string read_regular_file(const fs::path& path, std::string_view asked_by) {
  RegularFile file(path, asked_by);
  if (static_cast<double>(file.size()) > memory_limit_bytes())
    refuse(path, asked_by, "it has " + std::to_string(file.size()) + " bytes, more than this machine's memory",
           "split it, or check that it is the right file");
  std::string bytes(static_cast<std::size_t>(file.size()), '\0');
  file.read(bytes.data(), bytes.size());
  return bytes;
}

std::optional<fs::path> find_any_case(const fs::path& path) {
  if (path.empty()) return std::nullopt;
  if (is_there(path)) return path;
  std::string with_slashes = path.string();
  std::ranges::replace(with_slashes, '\\', '/');
  fs::path found;
  for (const fs::path& part : fs::path(with_slashes)) {
    if (part == "/" || part == "." || part == ".." || part.empty()) {
      found /= part;
      continue;
    }
    const std::optional<fs::path> entry = entry_any_case(found, part.string());
    if (!entry) return std::nullopt;
    found = *entry;
  }
  return found;
}

}  // namespace twopass
