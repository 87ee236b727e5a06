// What the program says while it works: notes and progress on stderr. Results go to stdout, by the commands.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

#include "render/stopwatch.h"

namespace twopass {

/// Text for a terminal: names come from files, which may hold anything, also what a terminal would obey.
/// Control characters (C0, C1, DEL) become '?', line ends blanks.
std::string printable(std::string_view text);

enum class Verbosity { quiet, normal, verbose };

class Console {
 public:
  explicit Console(Verbosity verbosity) : verbosity_(verbosity) {}
  /// Something the user should know; silent when quiet.
  void note(const std::string& text) const;
  /// Details for those who ask for them.
  void detail(const std::string& text) const;
  [[nodiscard]] Verbosity verbosity() const { return verbosity_; }

 private:
  Verbosity verbosity_;
};

/// "1 h 5 min", "12 s": a duration for people.
std::string duration_text(double seconds);

/// "label [###...] text" in fewer than `columns` characters: the bar is as long as there is room, or left out,
/// and then the text is cut. REQUIRES: fraction in [0, 1], columns > 1.
std::string progress_line(const std::string& label, double fraction, const std::string& text,
                          std::size_t columns);

/// A bar with the time left on a terminal, a plain line now and then elsewhere, nothing when quiet.
class Progress {
 public:
  Progress(const Console& console, std::string label);
  /// Erases the bar.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// `fraction` of the work is done, in [0, 1]. `details` is asked for more only when something is drawn.
  /// Cheap; any thread may call it at any time.
  void update(double fraction, const std::function<std::string()>& details = {});

 private:
  void draw(double fraction, double seconds, const std::string& details);

  std::string label_;
  bool silent_, terminal_;
  Stopwatch stopwatch_;
  std::mutex mutex_;
  std::atomic<double> next_seconds_;
  std::atomic<double> first_{-1.0};  // fraction that was done before: of a render that goes on
  int last_tenth_ = 0;
  bool drawn_ = false;
};

}  // namespace twopass
