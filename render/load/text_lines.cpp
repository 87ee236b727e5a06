#include "render/load/text_lines.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "render/core/error.h"
#include "render/load/text_file.h"

namespace twopass {
namespace {

constexpr std::size_t buffer_size = 1 << 18;

}  // namespace

std::string_view trim(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

LineReader::LineReader(std::string_view text, std::string_view where)
    : where_(where), window_(text), size_(text.size()), behind_window_(text.size()) {
  begin();
}

LineReader::LineReader(RegularFile& file, std::string_view where)
    : where_(where),
      file_(&file),
      buffer_(std::min<std::uint64_t>(buffer_size, file.size())),
      size_(file.size()) {
  const std::size_t got = file.read(buffer_.data(), buffer_.size());
  window_ = {buffer_.data(), got};
  behind_window_ = got;
  begin();
}

void LineReader::begin() {
  window_ = utf8_text(window_, where_);
  check(window_);
}

void LineReader::check(std::string_view text) const {
  if (text.find('\0') != std::string_view::npos)
    throw Error(where_, "it holds zero bytes: this is no text", "check that it is the right file");
}

double LineReader::share_read() const {
  const std::uint64_t taken = behind_window_ - window_.size();
  return size_ == 0 ? 1.0 : static_cast<double>(std::max<std::uint64_t>(taken, 1)) / static_cast<double>(size_);
}

/// Moves what is left to the front of the buffer and fills it up. False: the file has no more.
bool LineReader::refill() {
  if (!file_ || behind_window_ == size_) return false;
  // A line as long as the buffer needs a longer one.
  if (window_.size() == buffer_.size())
    buffer_.resize(std::min<std::uint64_t>(2 * buffer_.size(), size_));
  else
    std::copy(window_.begin(), window_.end(), buffer_.begin());
  const std::size_t got = file_->read(buffer_.data() + window_.size(), buffer_.size() - window_.size());
  behind_window_ += got;
  check({buffer_.data() + window_.size(), got});
  window_ = {buffer_.data(), window_.size() + got};
  newline_is_known_ = false;
  return got > 0;
}

std::string_view LineReader::take() {
  // Looking for \n once and no further than that for \r keeps files of either kind linear.
  std::size_t size = 0;
  while (true) {
    if (!newline_is_known_) newline_ = std::min(window_.find('\n'), window_.size());
    newline_is_known_ = true;
    size = std::min(window_.substr(0, newline_).find('\r'), newline_);
    // The \r at the buffer's end may be that of \r\n.
    if (size + 1 < window_.size() || (size < window_.size() && window_[size] == '\n') || !refill()) break;
  }
  const std::string_view line = window_.substr(0, size);
  std::size_t end = size;
  if (end < newline_ && end + 1 == newline_) ++end;  // the \r of \r\n
  if (end < window_.size()) ++end;
  window_.remove_prefix(end);
  newline_is_known_ = end <= newline_;
  newline_ -= std::min(end, newline_);
  ++following_;
  return line;
}

bool LineReader::next(std::string_view& line) {
  if (window_.empty() && !refill()) return false;
  number_ = following_;
  line = take();
  if (!line.ends_with('\\') || trim(line).starts_with('#')) return true;
  joined_.clear();
  while (line.ends_with('\\')) {
    joined_.append(line.substr(0, line.size() - 1)).append(" ");
    line = !window_.empty() || refill() ? take() : std::string_view();
  }
  line = joined_.append(line);
  return true;
}

bool Words::take_float(float& value) {
  const char* begin = at_;
  if (begin != end_ && *begin == '+' && begin + 1 != end_ && begin[1] != '-')
    ++begin;  // from_chars knows no plus
  const auto [after, code] = std::from_chars(begin, end_, value);
  if (code != std::errc() || (after != end_ && !is_blank(*after)) || !std::isfinite(value)) return false;
  advance(static_cast<std::size_t>(after - at_));
  return true;
}

}  // namespace twopass
