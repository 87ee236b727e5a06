#include "render/core/parallel.h"

#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace twopass {
namespace {

TEST(Parallel, VisitsEveryIndexOnceOnAnyNumberOfThreads) {
  for (const int threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    EXPECT_EQ(limit.threads(), threads);
    std::vector<int> visits(1001, 0);
    parallel_for(visits.size(), 7, [&](std::size_t begin, std::size_t end) {
      EXPECT_LE(end - begin, 7u);
      for (std::size_t i = begin; i < end; ++i) ++visits[i];
    });
    EXPECT_EQ(visits, std::vector<int>(1001, 1));
  }
}

TEST(Parallel, NothingToDoIsFine) {
  parallel_for(0, 1, [](std::size_t, std::size_t) { FAIL(); });
}

TEST(Parallel, ExceptionsReachTheCaller) {
  EXPECT_THROW(parallel_for(10, 1, [](std::size_t, std::size_t) { throw std::runtime_error("x"); }),
               std::runtime_error);
}

TEST(Parallel, TheFirstFailureByOrderIsTheOneReported) {
  for (const int threads : {1, 2, 4}) {
    const ThreadLimit limit(threads);
    for (int repeat = 0; repeat < 20; ++repeat) {
      std::vector<int> done(200, 0);
      const auto failure = [&]() -> std::string {
        try {
          parallel_tasks(done.size(), [&](std::size_t i) {
            if (i == 60 || i == 61 || i == 150) throw std::runtime_error(std::to_string(i));
            done[i] = 1;
          });
        } catch (const std::runtime_error& error) {
          return error.what();
        }
        return "none";
      }();
      EXPECT_EQ(failure, "60");
      EXPECT_EQ(std::vector<int>(done.begin(), done.begin() + 60), std::vector<int>(60, 1));
    }
  }
}

}  // namespace
}  // namespace twopass
