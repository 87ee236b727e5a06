#include "materials/ior.h"

#include <gtest/gtest.h>

#include "render/core/error.h"

namespace twopass {
namespace {

TEST(Ior, KnowsNamesAndListsThemOtherwise) {
  EXPECT_FLOAT_EQ(ior_of("bk7", "here"), 1.5046f);
  try {
    ior_of("kryptonite", "a.xml:1");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("diamond"), std::string::npos);
  }
}

}  // namespace
}  // namespace twopass
