#include "render/load/number.h"

#include <gtest/gtest.h>

namespace twopass {
namespace {

TEST(Number, ReadsTheUsualSpellings) {
  EXPECT_EQ(parse_number("1"), 1.0);
  EXPECT_EQ(parse_number("-.5"), -0.5);
  EXPECT_EQ(parse_number("+2.5"), 2.5);
  EXPECT_EQ(parse_number("3."), 3.0);
  EXPECT_EQ(parse_number("-4.37114e-008"), -4.37114e-8);
  EXPECT_EQ(parse_number("1E3"), 1000.0);
}

TEST(Number, RefusesEverythingElse) {
  for (const char* text :
       {"", "a", "1a", "1 ", " 1", "0,5", "--1", "+-1", "1.2.3", "nan", "inf", "-inf", "1e400", "0x10"})
    EXPECT_FALSE(parse_number(text)) << text;
}

TEST(Number, ReadsWholeNumbers) {
  EXPECT_EQ(parse_integer("-12"), -12);
  EXPECT_EQ(parse_integer("+12"), 12);
  EXPECT_FALSE(parse_integer("1.0"));
  EXPECT_FALSE(parse_integer("99999999999999999999"));
}

TEST(Number, SplitsAndDropsEmptyPieces) {
  EXPECT_EQ(split(" a, b  c,,", " ,"), (std::vector<std::string_view>{"a", "b", "c"}));
  EXPECT_TRUE(split(" , ", " ,").empty());
}

}  // namespace
}  // namespace twopass
