#include "render/console.h"

#include <algorithm>
#include <cstdio>

#include <unistd.h>

namespace twopass {

std::string printable(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    // C1 in UTF-8: C2 and 80 to 9F.
    if (byte == 0xc2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xa0 &&
        static_cast<unsigned char>(text[i + 1]) >= 0x80) {
      result += '?';
      ++i;
    } else if (byte == '\n' || byte == '\r' || byte == '\t') {
      result += ' ';
    } else {
      result += byte < 0x20 || byte == 0x7f ? '?' : text[i];
    }
  }
  return result;
}

void Console::note(const std::string& text) const {
  if (verbosity_ != Verbosity::quiet) std::fprintf(stderr, "%s\n", printable(text).c_str());
}

void Console::detail(const std::string& text) const {
  if (verbosity_ == Verbosity::verbose) std::fprintf(stderr, "%s\n", printable(text).c_str());
}

Progress::Progress(const Console& console, std::string label)
    : label_(std::move(label)),
      silent_(console.verbosity() == Verbosity::quiet),
      terminal_(isatty(STDERR_FILENO) != 0),
      next_seconds_(terminal_ ? 0.1 : 2.0) {}

Progress::~Progress() {
  if (terminal_ && drawn_) std::fprintf(stderr, "\r\033[K");
}

void Progress::update(double fraction) {
  if (silent_) return;
  const double seconds = stopwatch_.seconds();
  if (seconds < next_seconds_.load(std::memory_order_relaxed)) return;
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock.owns_lock()) return;
  next_seconds_ = seconds + (terminal_ ? 0.1 : 1.0);
  draw(std::clamp(fraction, 0.0, 1.0), seconds);
}

void Progress::draw(double fraction, double seconds) {
  const int percent = static_cast<int>(100.0 * fraction);
  char left[48] = "";
  if (fraction > 0.0) std::snprintf(left, sizeof left, "%.0f s left", seconds * (1.0 - fraction) / fraction);
  if (terminal_) {
    constexpr int width = 30;
    const int filled = static_cast<int>(width * fraction);
    std::fprintf(stderr, "\r\033[K%s [%s%s] %3d %%  %s", label_.c_str(), std::string(filled, '#').c_str(),
                 std::string(width - filled, '.').c_str(), percent, left);
    std::fflush(stderr);
    drawn_ = true;
  } else if (percent / 10 > last_tenth_) {
    last_tenth_ = percent / 10;
    std::fprintf(stderr, "%s %d %%, %s\n", label_.c_str(), percent, left);
  }
}

}  // namespace twopass
