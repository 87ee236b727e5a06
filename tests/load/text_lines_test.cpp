#include "render/load/text_lines.h"

#include <random>

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

using Lines = std::vector<std::pair<std::uint32_t, std::string>>;

Lines lines_of(std::string_view text) {
  Lines result;
  LineReader reader(text, "a.obj");
  std::string_view line;
  while (reader.next(line)) result.emplace_back(reader.number(), line);
  return result;
}

TEST(LineReader, KnowsEveryLineEnd) {
  EXPECT_EQ(lines_of("a\nb\r\nc\rd"), (Lines{{1, "a"}, {2, "b"}, {3, "c"}, {4, "d"}}));
  EXPECT_EQ(lines_of("a\r\rb\n\nc\r\n\r\n"), (Lines{{1, "a"}, {2, ""}, {3, "b"}, {4, ""}, {5, "c"}, {6, ""}}));
  EXPECT_EQ(lines_of(""), Lines{});
  EXPECT_EQ(lines_of("\n"), (Lines{{1, ""}}));
}

TEST(LineReader, JoinsContinuedLines) {
  EXPECT_EQ(lines_of("f 1 2 \\\n3\\\r\n4\nv"), (Lines{{1, "f 1 2  3 4"}, {4, "v"}}));
  EXPECT_EQ(lines_of("a\\"), (Lines{{1, "a "}}));
  EXPECT_EQ(lines_of("a\\\n\\\n"), (Lines{{1, "a  "}}));
}

TEST(LineReader, CommentsAreNotContinued) {
  EXPECT_EQ(lines_of(" # C:\\models\\\nv 1\n"), (Lines{{1, " # C:\\models\\"}, {2, "v 1"}}));
}

TEST(LineReader, FilesOfOneKindOfLineEndAreLinear) {
  // A search for the other kind from each line would take 10^11 steps.
  for (const char end : {'\r', '\n'}) {
    const std::string text(1 << 20, end);
    EXPECT_EQ(lines_of(text).size(), text.size());
  }
}

using LineReaderOnDisk = LoadTest;

TEST_F(LineReaderOnDisk, LinesAreTheSameThroughTheBuffer) {
  // Blanks, back-slashes and all line ends at random, lines of up to a megabyte, several buffers in all.
  std::mt19937 random(5);
  std::string text = "\xEF\xBB\xBF";
  for (int i = 0; i < 150000; ++i) text += "a \\\r\n\r\nb#\n"[random() % 10];
  text.append(1000000, 'x');
  text += "\r\n";
  for (int i = 0; i < 300000; ++i) text += "ab\r\n\n"[random() % 5];
  for (const char* end : {"", "\r", "\\"}) {
    RegularFile file(write("a.txt", text + end));
    LineReader reader(file, "a.txt");
    Lines lines;
    std::string_view line;
    while (reader.next(line)) lines.emplace_back(reader.number(), line);
    EXPECT_EQ(reader.share_read(), 1.0);
    EXPECT_TRUE(lines == lines_of(text + end));
  }
}

TEST_F(LineReaderOnDisk, FilesOfNothing) {
  for (const char* text : {"", "\xEF\xBB\xBF"}) {
    RegularFile file(write("a.txt", text));
    LineReader reader(file, "a.txt");
    std::string_view line;
    EXPECT_FALSE(reader.next(line));
  }
}

TEST(Words, StepThroughALine) {
  Words words(" \tone  two\t");
  EXPECT_EQ(words.peek(), "one");
  EXPECT_EQ(words.rest(), "one  two\t");
  EXPECT_EQ(words.next(), "one");
  EXPECT_EQ(words.next(), "two");
  EXPECT_TRUE(words.at_end());
  EXPECT_EQ(words.next(), "");
}

TEST(Words, TakeFloatsAndNothingElse) {
  Words words("1 -2.5e3 +.5 1e-60x 0,5 nan inf 1e39 1e-50 +-1 7");
  float value = 0.0f;
  for (const float expected : {1.0f, -2500.0f, 0.5f}) {
    ASSERT_TRUE(words.take_float(value));
    EXPECT_EQ(value, expected);
  }
  for (const char* refused : {"1e-60x", "0,5", "nan", "inf", "1e39", "1e-50", "+-1"}) {
    EXPECT_FALSE(words.take_float(value)) << refused;
    EXPECT_EQ(words.next(), refused);
  }
  ASSERT_TRUE(words.take_float(value));
  EXPECT_EQ(value, 7.0f);
  EXPECT_FALSE(words.take_float(value));
}

TEST(LineReader, TextHasNoZeroBytes) {
  using namespace std::string_literals;
  EXPECT_THROW(LineReader("v 0\0 0"s, "a.obj"), Error);
}

TEST_F(LoadTest, ZeroBytesFarInAreFoundToo) {
  const std::string text = std::string(300000, '\n') + std::string("v 0 0\0 0", 8);
  expect_error([&] { load_obj(text); }, {"scene.obj: it holds zero bytes: this is no text; check"});
}

}  // namespace
}  // namespace twopass
