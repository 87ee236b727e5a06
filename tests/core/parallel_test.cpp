#include "render/core/parallel.h"

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

}  // namespace
}  // namespace twopass
