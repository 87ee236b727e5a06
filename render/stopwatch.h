// Wall-clock and processor time of a phase.
#pragma once

#include <chrono>

namespace twopass {

struct Elapsed {
  double seconds = 0.0;      ///< wall clock
  double cpu_seconds = 0.0;  ///< user and system time of the whole process, all threads

  Elapsed& operator+=(const Elapsed& other) {
    seconds += other.seconds;
    cpu_seconds += other.cpu_seconds;
    return *this;
  }
};

class Stopwatch {
 public:
  Stopwatch() : start_(std::chrono::steady_clock::now()), cpu_start_(process_cpu_seconds()) {}
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  [[nodiscard]] Elapsed elapsed() const { return {seconds(), process_cpu_seconds() - cpu_start_}; }

  static double process_cpu_seconds();

 private:
  std::chrono::steady_clock::time_point start_;
  double cpu_start_;
};

/// Most memory that the process has held so far, bytes.
std::size_t peak_memory_bytes();

}  // namespace twopass
