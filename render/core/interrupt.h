// What the user asks for by signals, looked at by loops between two pieces of work: to stop early (Ctrl-C,
// SIGTERM), to write what there is and go on (SIGUSR1).
#pragma once

#include <atomic>
#include <csignal>

namespace twopass {

/// True once the user has asked the program to stop. Set by main's signal handler, read by any thread.
inline std::atomic<bool>& interrupt_requested() {
  static std::atomic<bool> requested{false};
  return requested;
}

/// The signal that asked it, SIGINT or SIGTERM.
inline std::atomic<int>& interrupt_signal() {
  static std::atomic<int> signal{SIGINT};
  return signal;
}

/// The exit code of a program that a signal ended, as shells have it: 130 after Ctrl-C, 143 after SIGTERM.
inline int exit_interrupted() { return 128 + interrupt_signal(); }

/// True while the user waits for what there is to be written. Whoever writes it sets it back.
inline std::atomic<bool>& write_requested() {
  static std::atomic<bool> requested{false};
  return requested;
}

/// Thrown by work that has no partial result worth keeping.
struct Interrupted {};

inline void throw_if_interrupted() {
  if (interrupt_requested()) throw Interrupted{};
}

}  // namespace twopass
