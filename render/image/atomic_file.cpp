#include "render/image/atomic_file.h"

#include <atomic>
#include <cerrno>
#include <cstring>
#include <optional>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

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
      return "free some space there or choose another folder";
    case EACCES:
    case EPERM:
      return "change the permissions or choose another folder";
    case EROFS:
      return "choose a folder that is not read-only";
    case ENAMETOOLONG:
      return "choose a shorter name";
    default:
      return "check the disk or choose another folder";
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

// A file descriptor, closed in the end.
class OpenFile {
 public:
  OpenFile(const fs::path& path, int flags, mode_t mode = 0)
      : descriptor_(::open(path.c_str(), flags | O_CLOEXEC, mode)) {}
  ~OpenFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

// A new file in the folder of `target`, gone in the end unless it has taken its place. Where the file system
// can do so it has no name before, so that nothing is left of it even when the program is killed.
class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& target) : target_(target), name_(temporary_path_beside(target)) {
    if (::access("/proc/self/fd", X_OK) == 0) file_.emplace(folder_of(target), O_TMPFILE | O_WRONLY, 0666);
    if (file_ && descriptor() >= 0) return;
    file_.emplace(name_, O_WRONLY | O_CREAT | O_EXCL, 0666);
    has_name_ = descriptor() >= 0;
  }
  ~TemporaryFile() {
    if (has_name_) ::unlink(name_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  // Negative when it could not be created, which errno then explains.
  [[nodiscard]] int descriptor() const { return file_->descriptor(); }
  // Puts it in the place of the target; false when that fails.
  bool take_place() {
    if (!has_name_) {
      const std::string self = "/proc/self/fd/" + std::to_string(descriptor());
      if (::linkat(AT_FDCWD, self.c_str(), AT_FDCWD, name_.c_str(), AT_SYMLINK_FOLLOW) != 0) return false;
      has_name_ = true;
    }
    if (::rename(name_.c_str(), target_.c_str()) != 0) return false;
    has_name_ = false;
    return true;
  }

 private:
  fs::path target_, name_;
  std::optional<OpenFile> file_;
  bool has_name_ = false;
};

void write_all(int descriptor, std::span<const std::byte> bytes, const fs::path& path) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(path, "writing failed", errno);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

// Gives the file a second name, so that there is one under its first name at every moment; where the file
// system has no second names, moves it.
void keep_as(const fs::path& file, const fs::path& previous) {
  const fs::path second = temporary_path_beside(previous);
  const bool linked = ::link(file.c_str(), second.c_str()) == 0;
  if (::rename(linked ? second.c_str() : file.c_str(), previous.c_str()) != 0) {
    const int error = errno;
    if (linked) ::unlink(second.c_str());
    fail(previous, "the previous file cannot be kept under this name", error);
  }
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
  const TemporaryFile probe(target);
  if (probe.descriptor() < 0) fail(path, "no file can be created there", errno);
}

struct AtomicWriter::Impl {
  fs::path path, target;
  std::optional<OpenFile> special;  // is written as it stands
  std::optional<TemporaryFile> file;
  std::vector<std::byte> buffer{};
  std::uint64_t flushed = 0;  // where in the file the buffer begins

  explicit Impl(const fs::path& path_) : path(path_), target(target_of(path)) {
    if (is_special(path))
      special.emplace(path, O_WRONLY);
    else
      file.emplace(target);
  }

  [[nodiscard]] int descriptor() const { return special ? special->descriptor() : file->descriptor(); }
  void flush() {
    write_all(descriptor(), buffer, path);
    flushed += buffer.size();
    buffer.clear();
  }
};

AtomicWriter::AtomicWriter(const fs::path& path) {
  check_no_folder(path);
  impl_ = std::make_unique<Impl>(path);
  if (impl_->descriptor() < 0)
    fail(path, impl_->special ? "it cannot be opened for writing" : "no file can be created there", errno);
}
AtomicWriter::~AtomicWriter() = default;

void AtomicWriter::write(std::span<const std::byte> bytes) {
  constexpr std::size_t most_buffered = std::size_t{1} << 20;
  if (impl_->buffer.size() + bytes.size() > most_buffered) impl_->flush();
  if (bytes.size() <= most_buffered) {
    impl_->buffer.insert(impl_->buffer.end(), bytes.begin(), bytes.end());
    return;
  }
  write_all(impl_->descriptor(), bytes, impl_->path);
  impl_->flushed += bytes.size();
}

std::uint64_t AtomicWriter::position() const { return impl_->flushed + impl_->buffer.size(); }

void AtomicWriter::seek(std::uint64_t position) {
  impl_->flush();
  if (::lseek(impl_->descriptor(), static_cast<off_t>(position), SEEK_SET) < 0)
    fail(impl_->path, "writing failed", errno);
  impl_->flushed = position;
}

void AtomicWriter::commit(const fs::path& previous) {
  Impl& own = *impl_;
  own.flush();
  if (own.special) return;
  struct stat existing {};
  const bool replaces = ::stat(own.target.c_str(), &existing) == 0;
  // A replaced file keeps its permissions; failing to is no reason to lose a picture.
  if (replaces) (void)!::fchmod(own.descriptor(), existing.st_mode & 0777);
  if (::fsync(own.descriptor()) != 0) fail(own.path, "writing failed", errno);
  if (replaces && !previous.empty()) keep_as(own.target, previous);
  if (!own.file->take_place()) fail(own.path, "the finished file cannot be renamed", errno);
  // The rename itself becomes durable with the folder; not every file system lets a folder be synchronised.
  const OpenFile folder(folder_of(own.target), O_RDONLY | O_DIRECTORY);
  if (folder.descriptor() >= 0) (void)::fsync(folder.descriptor());
}

void write_atomically(const fs::path& path, std::span<const std::byte> bytes) {
  AtomicWriter writer(path);
  writer.write(bytes);
  writer.commit();
}

}  // namespace twopass
