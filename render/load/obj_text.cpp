#include "render/load/obj_text.h"

#include <algorithm>
#include <array>
#include <map>

#include "render/core/error.h"
#include "render/load/number.h"
#include "render/load/text_file.h"

namespace twopass {
namespace {

constexpr std::string_view blanks = " \t";  // what tinyobjloader takes for one
constexpr std::size_t most_corners = 2000;  // cutting a concave polygon takes up to n^3 steps

std::string_view trim(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(blanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

/// One OBJ file on its way through; remembers where it is for errors.
class Cleaner {
 public:
  Cleaner(std::string_view file, Notes& notes) : file_(file), notes_(notes) {}

  void statement(std::string_view line, std::uint32_t number) {
    line = trim(line);
    if (line.empty() || line[0] == '#') return;
    number_ = number;
    const std::string_view keyword = line.substr(0, line.find_first_of(blanks));
    const std::string_view name = trim(line.substr(keyword.size()));
    // Names may contain '#' (3ds Max writes "usemtl Material #26"); numbers are followed by comments.
    const std::string_view arguments = name.substr(0, name.find('#'));
    if (keyword == "v" || keyword == "vn")
      numbers(keyword, arguments, 3);
    else if (keyword == "vt")
      numbers(keyword, arguments, 1);
    else if (keyword == "f" || keyword == "fo")
      face(arguments);
    else if (keyword == "g" || keyword == "o" || keyword == "usemtl")
      emit(keyword, name);
    else if (keyword == "mtllib")
      result_.libraries.emplace_back(name);
    else if (keyword == "s")
      result_.smoothing |= arguments != "off" && arguments != "0";
    else
      left_out(keyword);
  }

  ObjText finish() {
    for (const auto& [keyword, count] : left_out_)
      notes_.add(std::string(file_) + ": " + std::to_string(count) + " '" + keyword +
                 "' statements are left out: only polygons are read");
    if (small_faces_ > 0)
      notes_.add(std::string(file_) + ": " + std::to_string(small_faces_) +
                 " faces of fewer than three corners are left out");
    return std::move(result_);
  }

 private:
  [[noreturn]] void fail(const std::string& what, std::string_view remedy) const {
    throw Error(std::string(file_) + ":" + std::to_string(number_), what, remedy);
  }

  void emit(std::string_view keyword, std::string_view rest) {
    result_.text.append(keyword).append(" ").append(rest).append("\n");
    result_.lines.push_back(number_);
  }

  void numbers(std::string_view keyword, std::string_view arguments, std::size_t least) {
    const std::vector<std::string_view> tokens = split(arguments, blanks);
    if (tokens.size() < least)
      fail(in_quotes(keyword) + " has " + std::to_string(tokens.size()) + " numbers",
           "give at least " + std::to_string(least));
    // What follows (weights, vertex colours) is not used.
    const std::size_t used = std::min<std::size_t>(tokens.size(), 3);
    for (std::size_t i = 0; i < used; ++i)
      if (!parse_number(tokens[i]))
        fail(in_quotes(tokens[i]) + " is not a finite number", "write numbers like -1.5e3");
    const char* end = tokens[used - 1].data() + tokens[used - 1].size();
    emit(keyword, {tokens[0].data(), static_cast<std::size_t>(end - tokens[0].data())});
  }

  void face(std::string_view arguments) {
    const std::vector<std::string_view> corners = split(arguments, blanks);
    if (corners.size() > most_corners)
      fail("a face of " + std::to_string(corners.size()) + " corners",
           "split it: at most " + std::to_string(most_corners) + " are supported");
    for (const std::string_view corner : corners) check_corner(corner);
    if (corners.size() < 3)
      ++small_faces_;
    else
      emit("f", trim(arguments));
  }

  /// position, position/uv, position//normal or position/uv/normal.
  void check_corner(std::string_view corner) const {
    std::string_view rest = corner;
    for (int part = 0; part < 3; ++part) {
      const std::size_t slash = std::min(rest.find('/'), rest.size());
      const std::string_view index = rest.substr(0, slash);
      if (index.empty() ? part == 0 : !is_index(index))
        fail(in_quotes(corner) + " is not a corner of a face",
             "write position/uv/normal indices counted from 1, or from -1 backwards");
      if (slash == rest.size()) return;
      rest.remove_prefix(slash + 1);
    }
    fail(in_quotes(corner) + " has more than three indices", "write position/uv/normal");
  }

  static bool is_index(std::string_view text) {
    const std::optional<long long> value = parse_integer(text);
    return value && *value != 0 && std::abs(*value) <= 0x7fffffff;
  }

  void left_out(std::string_view keyword) {
    // Free-form geometry's settings are nothing to miss without the geometry; state and display hints neither.
    constexpr std::array<std::string_view, 17> quiet = {
        "vp",    "cstype",   "deg",      "bmat", "step", "parm",   "trim",       "hole",     "end",
        "bevel", "c_interp", "d_interp", "lod",  "mg",   "usemap", "shadow_obj", "trace_obj"};
    if (std::ranges::find(quiet, keyword) == quiet.end()) ++left_out_[std::string(keyword.substr(0, 20))];
  }

  std::string_view file_;
  Notes& notes_;
  ObjText result_;
  std::uint32_t number_ = 0;
  std::size_t small_faces_ = 0;
  std::map<std::string, std::size_t> left_out_;
};

}  // namespace

std::string_view LineReader::take() {
  const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
  const std::string_view line = rest_.substr(0, end);
  std::size_t skip = end;
  if (skip < rest_.size()) skip += rest_.substr(skip).starts_with("\r\n") ? 2 : 1;
  rest_.remove_prefix(skip);
  ++following_;
  return line;
}

bool LineReader::next(std::string& line) {
  if (rest_.empty()) return false;
  number_ = following_;
  line = take();
  while (line.ends_with('\\') && !rest_.empty()) {
    line.back() = ' ';
    line += take();
  }
  return true;
}

ObjText clean_obj(std::string_view text, std::string_view file, Notes& notes) {
  Cleaner cleaner(file, notes);
  LineReader reader(without_byte_order_mark(text));
  std::string line;
  while (reader.next(line)) cleaner.statement(line, reader.number());
  return cleaner.finish();
}

}  // namespace twopass
