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

TEST(Progress, TheLineFitsTheTerminal) {
  EXPECT_EQ(progress_line("rendering", 0.5, "  50 %", 200),
            "rendering [" + std::string(15, '#') + std::string(15, '.') + "]  50 %");
  EXPECT_EQ(progress_line("rendering", 1.0, " 100 %", 27), "rendering [########] 100 %");
  EXPECT_EQ(progress_line("rendering", 1.0, " 100 %", 20), "rendering 100 %");
  const std::string text(300, 'x');
  for (std::size_t columns = 2; columns < 400; ++columns)
    for (const double fraction : {0.0, 0.3, 1.0})
      EXPECT_LT(progress_line("rendering", fraction, text, columns).size(), columns);
}

TEST(Progress, DurationsAreForPeople) {
  EXPECT_EQ(duration_text(0.2), "0 s");
  EXPECT_EQ(duration_text(99.4), "99 s");
  EXPECT_EQ(duration_text(120.0), "2 min");
  EXPECT_EQ(duration_text(3600.0), "60 min");
  EXPECT_EQ(duration_text(3600.0 * 19 + 60.0 * 5), "19 h 5 min");
}

}  // namespace
}  // namespace twopass
