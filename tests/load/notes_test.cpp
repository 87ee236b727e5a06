#include "render/load/notes.h"

#include <gtest/gtest.h>

namespace twopass {
namespace {

TEST(Notes, CountsRepeatedNotes) {
  Notes notes;
  notes.add("a");
  notes.add("b");
  notes.add("a");
  EXPECT_EQ(notes.lines(), (std::vector<std::string>{"a (2 times)", "b"}));
}

TEST(Notes, StopsAfterTenLines) {
  Notes notes;
  for (int i = 0; i < 25; ++i) notes.add(std::to_string(i));
  const std::vector<std::string> lines = notes.lines();
  ASSERT_EQ(lines.size(), 11u);
  EXPECT_EQ(lines[9], "9");
  EXPECT_EQ(lines[10], "and 15 more");
}

TEST(Notes, ShowsAnEleventhLineInsteadOfAndOneMore) {
  Notes notes;
  for (int i = 0; i < 11; ++i) notes.add(std::to_string(i));
  EXPECT_EQ(notes.lines().back(), "10");
}

}  // namespace
}  // namespace twopass
