// The user's wish to stop early (Ctrl-C), asked for by loops that can end between two pieces of work.
#pragma once

#include <atomic>

namespace twopass {

/// True once the user has asked the program to stop. Set by main's signal handler, read by any thread.
inline std::atomic<bool>& interrupt_requested() {
  static std::atomic<bool> requested{false};
  return requested;
}

/// Thrown by work that has no partial result worth keeping.
struct Interrupted {};

inline void throw_if_interrupted() {
  if (interrupt_requested()) throw Interrupted{};
}

}  // namespace twopass
