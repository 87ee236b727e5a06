#include "render/stopwatch.h"

#include <fstream>

#include <sys/resource.h>

namespace twopass {

namespace {

rusage usage() {
  rusage own{};
  getrusage(RUSAGE_SELF, &own);
  return own;
}

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

double Stopwatch::process_cpu_seconds() {
  const rusage own = usage();
  return seconds_of(own.ru_utime) + seconds_of(own.ru_stime);
}

std::size_t peak_memory_bytes() { return static_cast<std::size_t>(usage().ru_maxrss) * 1024; }

bool reset_peak_memory() {
  // proc(5), clear_refs: 5 resets the peak to what is held now.
  std::ofstream file("/proc/self/clear_refs");
  file << "5";
  return file.flush().good();
}

}  // namespace twopass
