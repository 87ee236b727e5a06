#include "render/load/mitsuba_parameters.h"

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

class ParametersTest : public LoadTest {
 protected:
  XmlNode node_ = read_xml(write("a.xml", "<scene/>"));
};

TEST_F(ParametersTest, ReplacesWithinText) {
  const Definitions given{{"a", "1"}};
  Parameters parameters(given);
  parameters.set_default("b", "two");
  EXPECT_EQ(parameters.replace("x$a/$b.obj", node_), "x1/two.obj");
  EXPECT_EQ(parameters.replace("nothing", node_), "nothing");
  EXPECT_EQ(parameters.replace("", node_), "");
}

TEST_F(ParametersTest, GivenValuesAndFirstDefaultsWin) {
  const Definitions given{{"a", "1"}};
  Parameters parameters(given);
  parameters.set_default("a", "2");
  parameters.set_default("b", "3");
  parameters.set_default("b", "4");
  EXPECT_EQ(parameters.replace("$a $b", node_), "1 3");
}

TEST_F(ParametersTest, TheLongestNameFits) {
  const Definitions given{{"s", "1"}, {"size", "2"}};
  Parameters parameters(given);
  EXPECT_EQ(parameters.replace("$size$s$sizes$si", node_), "212s1i");
}

TEST_F(ParametersTest, ValuesAreNotReplacedAgain) {
  const Definitions given{{"a", "$a"}};
  Parameters parameters(given);
  EXPECT_EQ(parameters.replace("$a", node_), "$a");
}

TEST_F(ParametersTest, NamesWithoutValuesAreErrors) {
  const Definitions given{{"known", "1"}};
  Parameters parameters(given);
  expect_error([&] { parameters.replace("x$other_1.obj", node_); },
               {"a.xml:1: parameter '$other_1' has no value; give -D other_1=VALUE", "known here: known"});
  expect_error([&] { parameters.replace("100 $", node_); }, {"parameter '$' has no value"});
}

TEST_F(ParametersTest, ValuesWithoutUseAreErrors) {
  const Definitions given{{"a", "1"}, {"b", "1"}, {"c", "1"}};
  Parameters parameters(given);
  parameters.replace("$a", node_);
  parameters.set_default("b", "2");
  expect_error([&] { parameters.check_all_used(); },
               {"-D c: the scene has no such parameter; its parameters: a, b"});
}

TEST_F(ParametersTest, ListsAtMostTwelve) {
  std::set<std::string> names;
  EXPECT_EQ(list_some(names), "none");
  for (char c = 'a'; c < 'a' + 13; ++c) names.insert(std::string(1, c));
  EXPECT_EQ(list_some(names), "a, b, c, d, e, f, g, h, i, j, k, l, ...");
}

}  // namespace
}  // namespace twopass
