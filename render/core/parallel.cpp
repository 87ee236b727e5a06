#include "render/core/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#ifdef TWOPASS_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace twopass {

namespace {

// What the thread sanitizer cannot see of a loop, because TBB is not instrumented: that all of its pieces come
// after what its caller did before, and before what the caller does next. Nothing in other builds.
class LoopOrder {
#ifdef TWOPASS_THREAD_SANITIZER
 public:
  LoopOrder() { __tsan_release(&begin_); }
  ~LoopOrder() { __tsan_acquire(&end_); }
  struct Piece {
    explicit Piece(LoopOrder& loop) : order(loop) { __tsan_acquire(&order.begin_); }
    ~Piece() { __tsan_release(&order.end_); }
    LoopOrder& order;
  };

 private:
  char begin_ = 0, end_ = 0;
#else
 public:
  struct Piece {
    explicit Piece(const LoopOrder&) {}
  };
#endif
};

}  // namespace

struct ThreadLimit::Impl {
  explicit Impl(std::size_t threads) : control(tbb::global_control::max_allowed_parallelism, threads) {}
  tbb::global_control control;
};

ThreadLimit::ThreadLimit(int threads)
    : impl_(std::make_unique<Impl>(threads > 0 ? static_cast<std::size_t>(threads)
                                               : std::max(1u, std::thread::hardware_concurrency()))) {}
ThreadLimit::~ThreadLimit() = default;

int ThreadLimit::threads() const {
  return static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body) {
  if (count == 0) return;
  [[maybe_unused]] LoopOrder order;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, std::max<std::size_t>(1, grain)),
      [&](const tbb::blocked_range<std::size_t>& range) {
        [[maybe_unused]] const LoopOrder::Piece piece(order);
        body(range.begin(), range.end());
      },
      tbb::simple_partitioner());
}

void parallel_tasks(std::size_t count, const std::function<void(std::size_t)>& task) {
  std::atomic<std::size_t> first_failure = count;
  std::exception_ptr failure;
  std::mutex mutex;
  parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      // Only what stands behind a failure is skipped, so that the lowest one is always found.
      if (i > first_failure) return;
      try {
        task(i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (i > first_failure) return;
        first_failure = i;
        failure = std::current_exception();
      }
    }
  });
  if (failure) std::rethrow_exception(failure);
}

}  // namespace twopass
