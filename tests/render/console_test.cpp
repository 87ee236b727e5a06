#include "render/console.h"

#include <gtest/gtest.h>

namespace twopass {
namespace {

TEST(Console, NotesGoToStderrUnlessQuietAndDetailsOnRequest) {
  testing::internal::CaptureStderr();
  Console(Verbosity::quiet).note("a");
  Console(Verbosity::normal).detail("b");
  Console(Verbosity::normal).note("c");
  Console(Verbosity::verbose).detail("d");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "c\nd\n");
}

TEST(Progress, ShortWorkAndQuietConsolesPrintNothing) {
  testing::internal::CaptureStderr();
  {
    const Console console(Verbosity::normal), quiet(Verbosity::quiet);
    Progress progress(console, "working"), silent(quiet, "working");
    for (int i = 0; i <= 100; ++i) {
      progress.update(i / 100.0);
      silent.update(i / 100.0);
    }
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace twopass
