#include "render/core/error.h"

#include <gtest/gtest.h>

#include "render/core/names.h"

namespace twopass {
namespace {

TEST(Error, SaysWhereWhatAndWhatToDo) {
  EXPECT_STREQ(Error("a.xml:3", "unknown shape 'blob'", "use one of: cube").what(),
               "a.xml:3: unknown shape 'blob'; use one of: cube");
}

TEST(Names, FindsBothWaysAndListsTheKnown) {
  static constexpr Named<int> table[] = {{"one", 1}, {"two", 2}};
  EXPECT_EQ(value_of_name<int>(table, "two", "here", "number"), 2);
  EXPECT_EQ(name_of_value<int>(table, 1), "one");
  try {
    value_of_name<int>(table, "three", "here", "number");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "here: unknown number 'three'; use one of: one, two");
  }
}

}  // namespace
}  // namespace twopass
