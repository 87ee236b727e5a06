#include "render/console.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <sys/ioctl.h>
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

namespace {

std::size_t columns_of_terminal() {
  winsize size{};
  const bool known = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
  return known ? size.ws_col : 80;
}

}  // namespace

Progress::Progress(const Console& console, std::string label)
    : label_(std::move(label)),
      silent_(console.verbosity() == Verbosity::quiet),
      terminal_(isatty(STDERR_FILENO) != 0),
      next_seconds_(terminal_ ? 0.1 : 2.0) {}

Progress::~Progress() {
  if (terminal_ && drawn_) std::fprintf(stderr, "\r\033[K");
}

void Progress::update(double fraction, const std::function<std::string()>& details) {
  if (silent_) return;
  double none = -1.0;
  if (first_ < 0.0) first_.compare_exchange_strong(none, fraction);
  const double seconds = stopwatch_.seconds();
  if (seconds < next_seconds_.load(std::memory_order_relaxed)) return;
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock.owns_lock()) return;
  next_seconds_ = seconds + (terminal_ ? 0.1 : 1.0);
  draw(std::clamp(fraction, 0.0, 1.0), seconds, details ? details() : std::string());
}

std::string duration_text(double seconds) {
  char text[48];
  if (seconds < 99.5)
    std::snprintf(text, sizeof text, "%.0f s", seconds);
  else if (seconds < 5970.0)
    std::snprintf(text, sizeof text, "%.0f min", seconds / 60.0);
  else
    std::snprintf(text, sizeof text, "%.0f h %.0f min", std::floor(std::round(seconds / 60.0) / 60.0),
                  std::fmod(std::round(seconds / 60.0), 60.0));
  return text;
}

std::string progress_line(const std::string& label, double fraction, const std::string& text,
                          std::size_t columns) {
  // One column less than there are: some terminals begin a new line in the last one.
  constexpr std::size_t most = 30, least = 5;
  std::string line = label;
  const std::size_t used = label.size() + text.size() + 4;
  if (columns >= used + least) {
    const std::size_t width = std::min(most, columns - used);
    const auto filled = static_cast<std::size_t>(static_cast<double>(width) * fraction);
    line += " [" + std::string(filled, '#') + std::string(width - filled, '.') + "]";
  }
  line += text;
  return line.substr(0, columns - 1);
}

void Progress::draw(double fraction, double seconds, const std::string& details) {
  const int percent = static_cast<int>(100.0 * fraction);
  std::string text;
  if (fraction > first_) text = duration_text(seconds * (1.0 - fraction) / (fraction - first_)) + " left";
  if (!details.empty()) text += (text.empty() ? "" : ", ") + details;
  if (terminal_) {
    char share[16];
    std::snprintf(share, sizeof share, " %3d %%  ", percent);
    std::fprintf(stderr, "\r\033[K%s",
                 progress_line(label_, fraction, share + text, columns_of_terminal()).c_str());
    std::fflush(stderr);
    drawn_ = true;
  } else if (percent / 10 > last_tenth_) {
    last_tenth_ = percent / 10;
    std::fprintf(stderr, "%s %d %%, %s\n", label_.c_str(), percent, text.c_str());
  }
}

}  // namespace twopass
