// Threads: the only place that knows TBB. Every loop here gives the same result on any number of threads as
// long as its iterations write to disjoint places.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace twopass {

/// Limits the number of threads of the whole process (Embree's included) while it lives; 0 means all cores.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;
  /// The number of threads that loops will use.
  [[nodiscard]] int threads() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Calls body(begin, end) on pieces of [0, count) of at most `grain` iterations, in parallel, in no particular
/// order.
void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body);

/// Calls task(i) for each i in [0, count), in parallel: for tasks that may fail. When some throw, rethrows the
/// exception of the lowest i, which is the one that a serial loop would have met; tasks above it may be
/// skipped.
void parallel_tasks(std::size_t count, const std::function<void(std::size_t)>& task);

}  // namespace twopass
