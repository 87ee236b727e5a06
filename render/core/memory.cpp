#include "render/core/memory.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

#include <sys/resource.h>
#include <unistd.h>

namespace twopass {
namespace {

constexpr double unknown = std::numeric_limits<double>::infinity();

// The number in a file of a control group; "max" and what cannot be read are no limit.
double limit_in(const std::string& path) {
  std::ifstream in(path);
  double bytes = 0.0;
  return in >> bytes ? bytes : unknown;
}

// The least limit of a group and those that it is in.
double limit_up_from(const std::string& root, std::string group, const char* file) {
  double least = unknown;
  for (;;) {
    least = std::min(least, limit_in(root + group + "/" + file));
    if (group.empty() || group == "/") return least;
    group.erase(group.find_last_of('/'));
  }
}

// Lines of /proc/self/cgroup are NUMBER:CONTROLLERS:GROUP; version 2 has the number 0 and no controllers.
double control_group_limit() {
  double least = unknown;
  std::ifstream in("/proc/self/cgroup");
  for (std::string line; std::getline(in, line);) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1), group = line.substr(second + 1);
    if (controllers.empty()) least = std::min(least, limit_up_from("/sys/fs/cgroup", group, "memory.max"));
    if (controllers == "memory")
      least = std::min(least, limit_up_from("/sys/fs/cgroup/memory", group, "memory.limit_in_bytes"));
  }
  return least;
}

}  // namespace

double memory_limit_bytes() {
  double least = control_group_limit();
  const long pages = ::sysconf(_SC_PHYS_PAGES), page = ::sysconf(_SC_PAGESIZE);
  if (pages > 0 && page > 0) least = std::min(least, static_cast<double>(pages) * static_cast<double>(page));
  rlimit address_space{};
  if (::getrlimit(RLIMIT_AS, &address_space) == 0 && address_space.rlim_cur != RLIM_INFINITY)
    least = std::min(least, static_cast<double>(address_space.rlim_cur));
  return least;
}

}  // namespace twopass
