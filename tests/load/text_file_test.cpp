#include "render/load/text_file.h"

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

using TextFile = LoadTest;

TEST_F(TextFile, ReadsAllBytes) {
  const std::string text("a\r\nb\0c", 6);
  EXPECT_EQ(read_text_file(write("file", text)), text);
  EXPECT_EQ(read_text_file(write("empty", "")), "");
}

TEST_F(TextFile, RefusesWhatIsNoFile) {
  expect_error([&] { read_text_file(folder_ / "none.xml"); }, {"none.xml: there is no such file"});
  expect_error([&] { read_text_file(folder_); }, {"this is a folder"});
  expect_error([&] { read_text_file("/dev/zero"); }, {"/dev/zero: this is not a regular file"});
}

TEST_F(TextFile, StripsAByteOrderMark) {
  EXPECT_EQ(without_byte_order_mark("\xEF\xBB\xBFv 1"), "v 1");
  EXPECT_EQ(without_byte_order_mark("v 1"), "v 1");
}

TEST_F(TextFile, LowersAndQuotes) {
  EXPECT_EQ(lower_case("lookAt.XML"), "lookat.xml");
  EXPECT_EQ(in_quotes("a"), "'a'");
}

}  // namespace
}  // namespace twopass
