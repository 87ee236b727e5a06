// A loop with a race: the thread sanitizer has to report it, although TBB is not instrumented.
#include <chrono>
#include <cstdio>
#include <thread>

#include "render/core/parallel.h"

int main() {
  const twopass::ThreadLimit limit(2);
  int sum = 0;
  twopass::parallel_for(200, 1, [&](std::size_t, std::size_t) {
    std::this_thread::sleep_for(std::chrono::microseconds(100));
    ++sum;
  });
  std::printf("%d\n", sum);
  return 0;
}
