// The statements of line-based text files (OBJ, MTL): one a line, words between blanks.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "render/image/regular_file.h"

namespace twopass {

/// Lines of a text or of a text file: any line end (\n, \r\n, \r), lines ending in a back-slash joined to the
/// next. Comment lines are not continued: they end in the paths of folders more often than they go on. A UTF-8
/// byte order mark in front is skipped. Files pass through a small buffer: pages of memory that are touched for
/// the first time cost more than parsing what they hold.
class LineReader {
 public:
  /// `where`: the text's name in errors. Throws Error for UTF-16
  /// and zero bytes; so may next(). REQUIRES: the text or file outlives this.
  LineReader(std::string_view text, std::string_view where);
  LineReader(RegularFile& file, std::string_view where);

  /// The next line without its end, valid until the next call. False when there is none.
  bool next(std::string_view& line);
  /// Number of the line's first line in the file, counted from 1.
  [[nodiscard]] std::uint32_t number() const { return number_; }
  /// The share of the text that has been read, in (0, 1].
  [[nodiscard]] double share_read() const;

 private:
  void begin();
  void check(std::string_view text) const;
  std::string_view take();
  bool refill();

  std::string where_;
  RegularFile* file_ = nullptr;  // null: all of the text is in window_
  std::vector<char> buffer_;
  std::string_view window_;                 // what has been read and not been taken
  std::uint64_t size_, behind_window_ = 0;  // bytes of the text: of all, of what has been read
  std::size_t newline_ = 0;                 // of the first \n in window_ where newline_is_known_, or its size
  bool newline_is_known_ = false;
  std::uint32_t number_ = 0, following_ = 1;
  std::string joined_;
};

inline bool is_blank(char c) { return c == ' ' || c == '\t'; }

/// The text without blanks at its ends.
std::string_view trim(std::string_view text);
/// The text in front of the first '#'.
inline std::string_view before_comment(std::string_view text) { return text.substr(0, text.find('#')); }

/// The words of a text between blanks, from left to right.
class Words {
 public:
  explicit Words(std::string_view text) : at_(text.data()), end_(text.data() + text.size()) { skip_blanks(); }
  [[nodiscard]] bool at_end() const { return at_ == end_; }
  /// The word here, without stepping over it; empty at the end.
  [[nodiscard]] std::string_view peek() const {
    const char* p = at_;
    while (p != end_ && !is_blank(*p)) ++p;
    return {at_, static_cast<std::size_t>(p - at_)};
  }
  /// Everything from the word here on.
  [[nodiscard]] std::string_view rest() const { return {at_, static_cast<std::size_t>(end_ - at_)}; }
  /// The word here; steps over it.
  std::string_view next() {
    const std::string_view word = peek();
    advance(word.size());
    return word;
  }
  /// Reads a number that fits into a float and steps over it; false, without a step, for anything else here.
  bool take_float(float& value);
  /// Steps over `count` characters and the blanks behind them.
  void advance(std::size_t count) {
    at_ += count;
    skip_blanks();
  }

 private:
  void skip_blanks() {
    while (at_ != end_ && is_blank(*at_)) ++at_;
  }

  const char *at_, *end_;
};

}  // namespace twopass
