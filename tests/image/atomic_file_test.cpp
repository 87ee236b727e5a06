#include "render/image/atomic_file.h"

#include <csignal>

#include <sys/resource.h>

#include "tests/image/files.h"

namespace twopass {
namespace {

namespace fs = std::filesystem;

using AtomicFile = FileTest;

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

// Makes every file of this process end at `bytes`, as a full disk would.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  void (*handler_)(int);
  rlimit before_{};
};

TEST_F(AtomicFile, WritesAndReplaces) {
  write_atomically(file("a.exr"), bytes_of("first"));
  EXPECT_EQ(content_of(file("a.exr")), "first");
  write_atomically(file("a.exr"), bytes_of("second"));
  EXPECT_EQ(content_of(file("a.exr")), "second");
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(AtomicFile, AFailureLeavesTheOldFileAndNothingElse) {
  write_atomically(file("a.exr"), bytes_of("good"));
  {
    const FileSizeLimit limit(1000);
    const std::string large(5000, 'x');
    EXPECT_TRUE(
        contains(error_of([&] { write_atomically(file("a.exr"), bytes_of(large)); }), "writing failed"));
  }
  EXPECT_EQ(content_of(file("a.exr")), "good");
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(AtomicFile, ThePreviousFileIsKeptUnderItsOwnName) {
  for (const char* text : {"first", "second", "third"}) {
    AtomicWriter writer(file("a.exr"));
    writer.write(bytes_of(text));
    writer.commit(file("a.previous.exr"));
  }
  EXPECT_EQ(content_of(file("a.exr")), "third");
  EXPECT_EQ(content_of(file("a.previous.exr")), "second");
  EXPECT_EQ(files_in_folder(), 2u);
  {
    AtomicWriter writer(file("a.exr"));
    writer.write(bytes_of("never finished"));
  }
  const FileSizeLimit limit(1000);
  EXPECT_TRUE(contains(error_of([&] {
                         AtomicWriter writer(file("a.exr"));
                         writer.write(bytes_of(std::string(5000, 'x')));
                         writer.commit(file("a.previous.exr"));
                       }),
                       "writing failed"));
  EXPECT_EQ(content_of(file("a.exr")), "third");
  EXPECT_EQ(content_of(file("a.previous.exr")), "second");
  EXPECT_EQ(files_in_folder(), 2u);
}

TEST_F(AtomicFile, PiecesAndCorrectionsAreOneFile) {
  std::string expected;
  AtomicWriter writer(file("a.exr"));
  for (int i = 0; i < 50; ++i) {
    const std::string piece(static_cast<std::size_t>(100000 + i), static_cast<char>('a' + i % 26));
    EXPECT_EQ(writer.position(), expected.size());
    writer.write(bytes_of(piece));
    expected += piece;
  }
  writer.seek(1234567);
  writer.write(bytes_of("corrected"));
  expected.replace(1234567, 9, "corrected");
  writer.seek(expected.size());
  writer.write(bytes_of("end"));
  EXPECT_FALSE(fs::exists(file("a.exr")));
  writer.commit();
  EXPECT_EQ(content_of(file("a.exr")), expected + "end");
}

TEST_F(AtomicFile, AFullDeviceIsAnError) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  const std::string message = error_of([] { write_atomically("/dev/full", bytes_of("x")); });
  EXPECT_TRUE(contains(message, "free some space")) << message;
  EXPECT_TRUE(fs::is_character_file("/dev/full")) << "a device must not be replaced by a file";
}

TEST_F(AtomicFile, DevicesAreWrittenNotReplaced) {
  check_writable("/dev/null");
  write_atomically("/dev/null", bytes_of("x"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(AtomicFile, FollowsLinksAndKeepsPermissions) {
  write_atomically(file("real.exr"), bytes_of("old"));
  fs::permissions(file("real.exr"), fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("real.exr", file("link.exr"));
  write_atomically(file("link.exr"), bytes_of("new"));
  EXPECT_TRUE(fs::is_symlink(file("link.exr")));
  EXPECT_EQ(content_of(file("real.exr")), "new");
  EXPECT_EQ(fs::status(file("real.exr")).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(AtomicFile, CheckLeavesNoTrace) {
  put(file("a.exr"), "old");
  check_writable(file("a.exr"));
  check_writable(file("new.exr"));
  EXPECT_EQ(content_of(file("a.exr")), "old");
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(AtomicFile, CheckNamesTheFact) {
  EXPECT_TRUE(contains(error_of([&] { check_writable(folder()); }), "it is a folder"));
  EXPECT_TRUE(contains(error_of([&] { check_writable(folder() / ""); }), "it is a folder"));
  EXPECT_TRUE(contains(error_of([&] { check_writable(file("none/a.exr")); }), "there is no folder"));
  EXPECT_TRUE(contains(error_of([&] { check_writable(file(std::string(300, 'a'))); }), "shorter name"));
  put(file("plain"), "");
  EXPECT_TRUE(contains(error_of([&] { check_writable(file("plain") / "a.exr"); }), "there is no folder"));
}

TEST_F(AtomicFile, AFolderWithoutPermissionIsAnError) {
  if (::geteuid() == 0) GTEST_SKIP() << "nothing is forbidden to root";
  fs::permissions(folder(), fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_TRUE(contains(error_of([&] { check_writable(file("a.exr")); }), "permissions"));
  fs::permissions(folder(), fs::perms::owner_all);
}

TEST_F(AtomicFile, TemporaryNamesAreUniqueAndKeepTheExtension) {
  const fs::path a = temporary_path_beside("out/x.exr"), b = temporary_path_beside("out/x.exr");
  EXPECT_NE(a, b);
  EXPECT_EQ(a.extension(), ".exr");
  EXPECT_EQ(a.parent_path(), "out");
  EXPECT_EQ(temporary_path_beside("x.exr").parent_path(), ".");
}

}  // namespace
}  // namespace twopass
