// The user's wish to stop early (Ctrl-C), asked for by loops that can end between two pieces of work.
#pragma once

#include <atomic>

namespace twopass {

/// True once the user has asked the program to stop. Set by main's signal handler, read by any thread.
inline std::atomic<bool>& interrupt_requested() {
  static std::atomic<bool> requested{false};
  return requested;
}

}  // namespace twopass
