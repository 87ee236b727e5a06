#include "render/image/regular_file.h"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include "tests/image/files.h"

namespace twopass {
namespace {

namespace fs = std::filesystem;

using RegularFile = FileTest;

TEST_F(RegularFile, IsReadWhole) {
  const std::string content("a\r\nb\0c", 6);
  put(file("a"), content);
  put(file("empty"), "");
  EXPECT_EQ(read_regular_file(file("a")), content);
  EXPECT_EQ(read_regular_file(file("empty")), "");
  fs::create_symlink("a", file("link"));
  EXPECT_EQ(read_regular_file(file("link")), content);
  check_regular_file(file("link"));
}

// Each refusal by the check and by reading. A pipe that nobody writes to would block a naive reader for ever.
TEST_F(RegularFile, NothingElseIsRead) {
  ASSERT_EQ(::mkfifo(file("pipe").c_str(), 0600), 0);
  fs::create_symlink("pipe", file("link"));
  fs::create_symlink("circle", file("circle"));
  const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{.sun_family = AF_UNIX, .sun_path = {}};
  const std::string socket_name =
      (fs::temp_directory_path() / ("twopass_" + std::to_string(::getpid()))).string();
  ASSERT_LT(socket_name.size(), sizeof address.sun_path);
  socket_name.copy(address.sun_path, sizeof address.sun_path - 1);
  ASSERT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  const std::pair<fs::path, std::string> cases[] = {
      {file("none"), "there is no such file"},          {folder(), "this is a folder"},
      {"/dev/zero", "not a regular file but a device"}, {file("pipe"), "not a regular file but a pipe"},
      {file("link"), "not a regular file but a pipe"},  {socket_name, "not a regular file but a socket"},
      {file("circle"), "cannot be opened: "},           {file("none") / "a", "there is no such file"}};
  for (const auto& [path, what] : cases) {
    const std::string by_check = error_of([&] { check_regular_file(path); });
    EXPECT_TRUE(by_check.starts_with(path.string() + ": ")) << by_check;
    EXPECT_TRUE(contains(by_check, what)) << by_check;
    EXPECT_TRUE(contains(by_check, "; ")) << by_check;
    EXPECT_EQ(error_of([&] { (void)read_regular_file(path); }), by_check);
  }
  ::close(socket);
  fs::remove(socket_name);
}

TEST_F(RegularFile, ErrorsNameWhoAsked) {
  const std::string path = file("none").string();
  EXPECT_EQ(error_of([&] { (void)read_regular_file(path, "scene.xml:7"); }),
            "scene.xml:7: " + path + ": there is no such file; check the name");
  EXPECT_EQ(error_of([&] { check_regular_file(path, "scene.xml:7"); }),
            "scene.xml:7: " + path + ": there is no such file; check the name");
}

// A sparse file takes no room on the disk, but would take all of the memory.
TEST_F(RegularFile, AbsurdSizesAreRefusedBeforeMemoryIsTaken) {
  put(file("huge"), "x");
  std::error_code failure;
  fs::resize_file(file("huge"), std::uintmax_t{1} << 42, failure);
  if (failure) GTEST_SKIP() << "no sparse files here";
  EXPECT_TRUE(
      contains(error_of([&] { (void)read_regular_file(file("huge")); }), "more than this machine's memory"));
}

TEST_F(RegularFile, IsFoundInAnyCase) {
  fs::create_directories(file("Textures/Wood"));
  put(file("Textures/Wood/Oak.PNG"), "oak");
  put(file("b.png"), "lower");
  put(file("B.png"), "upper");
  const auto found = [&](const char* name) {
    const auto path = find_any_case(folder() / name);
    return path ? path->lexically_relative(folder()).string() : "nothing";
  };
  EXPECT_EQ(found("Textures/Wood/Oak.PNG"), "Textures/Wood/Oak.PNG");
  EXPECT_EQ(found("textures/WOOD/oak.png"), "Textures/Wood/Oak.PNG");
  EXPECT_EQ(found("textures\\wood\\OAK.png"), "Textures/Wood/Oak.PNG");
  EXPECT_EQ(found("textures/../textures/wood/oak.png"), "Textures/../Textures/Wood/Oak.PNG");
  EXPECT_EQ(found("b.png"), "b.png") << "the exact name comes first";
  EXPECT_EQ(found("B.png"), "B.png");
  EXPECT_EQ(found("b.PNG"), "B.png") << "then the first in byte order";
  EXPECT_EQ(found("textures"), "Textures");
  EXPECT_EQ(found("textures/pine.png"), "nothing");
  EXPECT_EQ(found("b.png/x"), "nothing");
  EXPECT_FALSE(find_any_case("").has_value());
}

// A name that contains a back-slash is a name here.
TEST_F(RegularFile, ExactNamesWinOverBackSlashes) {
  fs::create_directories(file("a"));
  put(file("a/b"), "in the folder");
  put(file("a\\b"), "the odd name");
  EXPECT_EQ(find_any_case(file("a\\b")), file("a\\b"));
}

}  // namespace
}  // namespace twopass
