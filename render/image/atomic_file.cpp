#include "render/image/atomic_file.h"

#include <atomic>
#include <cerrno>
#include <cstring>
#include <sstream>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "render/core/error.h"

namespace twopass {
namespace {

namespace fs = std::filesystem;

const char* remedy_for(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return "free some space there or choose another folder with -o";
    case EACCES:
    case EPERM:
      return "change the permissions or choose another folder with -o";
    case EROFS:
      return "choose a folder that is not read-only";
    case ENAMETOOLONG:
      return "choose a shorter name";
    default:
      return "check the disk or choose another folder with -o";
  }
}

[[noreturn]] void fail(const fs::path& path, const std::string& what, int error) {
  throw Error(path.string(), what + ": " + std::strerror(error), remedy_for(error));
}

// The file that `path` means: links are followed, because renaming onto a link would replace the link.
fs::path target_of(const fs::path& path) {
  std::error_code ignored;
  const fs::path target = fs::weakly_canonical(path, ignored);
  return target.empty() ? path : target;
}

fs::path folder_of(const fs::path& path) {
  const fs::path folder = path.parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

// Devices, pipes and sockets can be written but not replaced.
bool is_special(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

// A file descriptor, and the file itself unless it is kept.
class OpenFile {
 public:
  OpenFile(fs::path path, int flags, mode_t mode, bool remove)
      : path_(std::move(path)), remove_(remove), descriptor_(::open(path_.c_str(), flags | O_CLOEXEC, mode)) {}
  ~OpenFile() {
    if (descriptor_ < 0) return;
    ::close(descriptor_);
    if (remove_) ::unlink(path_.c_str());
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  [[nodiscard]] int descriptor() const { return descriptor_; }
  [[nodiscard]] const fs::path& path() const { return path_; }
  void keep() { remove_ = false; }

 private:
  fs::path path_;
  bool remove_;
  int descriptor_;
};

void write_all(int descriptor, std::span<const std::byte> bytes, const fs::path& path) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(path, "writing failed", errno);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void write_special(const fs::path& path, std::span<const std::byte> bytes) {
  const OpenFile file(path, O_WRONLY, 0, false);
  if (file.descriptor() < 0) fail(path, "it cannot be opened for writing", errno);
  write_all(file.descriptor(), bytes, path);
}

OpenFile create_temporary(const fs::path& target) {
  return {temporary_path_beside(target), O_WRONLY | O_CREAT | O_EXCL, 0666, true};
}

void check_no_folder(const fs::path& path) {
  std::error_code ignored;
  if (path.filename().empty() || fs::is_directory(path, ignored))
    throw Error(path.string(), "it is a folder", "give the name of a file");
}

}  // namespace

fs::path temporary_path_beside(const fs::path& path) {
  static std::atomic<unsigned> count{0};
  // The extension stays last: libraries choose the format by it.
  std::ostringstream name;
  name << '.' << path.stem().string().substr(0, 100) << '.' << ::getpid() << '.' << count.fetch_add(1) << ".tmp"
       << path.extension().string();
  return folder_of(path) / name.str();
}

void check_writable(const fs::path& path) {
  check_no_folder(path);
  if (is_special(path)) {
    if (::access(path.c_str(), W_OK) != 0) fail(path, "it cannot be written", errno);
    return;
  }
  const fs::path target = target_of(path);
  std::error_code ignored;
  if (!fs::is_directory(folder_of(target), ignored))
    throw Error(path.string(), "there is no folder " + folder_of(target).string(),
                "create it or choose another folder");
  // Creating a file is the only honest test: permissions, quotas and read-only mounts all have their say. The
  // name itself must be possible too, as it may be longer than the temporary one.
  if (::access(target.c_str(), F_OK) != 0 && errno != ENOENT) fail(path, "no file can have this name", errno);
  const OpenFile probe = create_temporary(target);
  if (probe.descriptor() < 0) fail(path, "no file can be created there", errno);
}

void write_atomically(const fs::path& path, std::span<const std::byte> bytes) {
  check_no_folder(path);
  if (is_special(path)) return write_special(path, bytes);
  const fs::path target = target_of(path);
  OpenFile file = create_temporary(target);
  if (file.descriptor() < 0) fail(path, "no file can be created there", errno);
  struct stat existing {};
  // A replaced file keeps its permissions; failing to is no reason to lose a picture.
  if (::stat(target.c_str(), &existing) == 0) (void)!::fchmod(file.descriptor(), existing.st_mode & 0777);
  write_all(file.descriptor(), bytes, path);
  if (::fsync(file.descriptor()) != 0) fail(path, "writing failed", errno);
  if (::rename(file.path().c_str(), target.c_str()) != 0)
    fail(path, "the finished file cannot be renamed", errno);
  file.keep();
  // The rename itself becomes durable with the folder; not every file system lets a folder be synchronised.
  const OpenFile folder(folder_of(target), O_RDONLY | O_DIRECTORY, 0, false);
  if (folder.descriptor() >= 0) (void)::fsync(folder.descriptor());
}

}  // namespace twopass
