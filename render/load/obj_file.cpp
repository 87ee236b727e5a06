#include "render/load/obj_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <unordered_map>

#include "render/core/error.h"
#include "render/load/mesh_tools.h"
#include "render/load/number.h"
#include "render/load/text_file.h"
#include "render/load/text_lines.h"

namespace twopass {
namespace {

constexpr std::uint32_t most_corners = 2000;  // cutting a concave polygon takes up to n^3 steps
constexpr std::size_t longest_name = 1000;    // "g" makes a name of the object's and its own from two bytes

/// Appends to an array that is expected to be as long at the end as its part of the text read so far says:
/// growing by doubling would copy all of it once more, and touch twice the memory.
template <class T>
void append(std::vector<T>& array, const T& value, const LineReader& lines) {
  if (array.size() == array.capacity()) {
    const double size = static_cast<double>(array.size());
    array.reserve(
        static_cast<std::size_t>(std::clamp(1.02 * size / lines.share_read(), 2.0 * size, 64.0 * size)) + 64);
  }
  array.push_back(value);
}

/// Reads one statement after the other; remembers where it is for errors.
class Parser {
 public:
  Parser(LineReader& lines, const std::string& file, Notes& notes)
      : lines_(lines), file_name_(file), notes_(notes) {}

  ObjFile run() {
    std::string_view line;
    while (lines_.next(line)) statement(line);
    return finish();
  }

 private:
  using Names = std::unordered_map<std::string, std::uint32_t>;

  void statement(std::string_view line) {
    line_ = lines_.number();
    Words words(line);
    const std::string_view keyword = words.next();
    if (keyword.empty() || keyword[0] == '#') return;
    const std::string_view name = words.rest();
    // Names may contain '#' (3ds Max writes "usemtl Material #26"); numbers are followed by comments.
    Words arguments(before_comment(name));
    if (keyword == "v")
      position(arguments);
    else if (keyword == "vn")
      normal(arguments);
    else if (keyword == "vt")
      uv(arguments);
    else if (keyword == "f" || keyword == "fo")
      face(arguments);
    else
      state(keyword, name, arguments);
  }

  /// Positive indices may point forward, so what they lead to can only be looked at in the end.
  ObjFile finish() {
    for (const ObjFace& face : result_.faces)
      for (std::uint32_t i = 0; i < face.corner_count; ++i) {
        ObjCorner& corner = result_.corners[face.first_corner + i];
        check(corner.position, result_.positions.size(), "position", face.line);
        if (corner.uv != no_obj_index) check(corner.uv, result_.uvs.size(), "texture coordinate", face.line);
        if (corner.normal == no_obj_index) continue;
        check(corner.normal, result_.normals.size(), "normal", face.line);
        if (result_.normals[corner.normal] == V3f(0.0f)) corner.normal = no_obj_index;
      }
    for (const auto& [keyword, count] : left_out_)
      notes_.add(file_name_ + ": " + std::to_string(count) + " '" + keyword +
                 "' statements are left out: only polygons are read");
    if (small_faces_ > 0)
      notes_.add(file_name_ + ": " + std::to_string(small_faces_) +
                 " faces of fewer than three corners are left out");
    if (result_.faces.empty())
      throw Error(file_name_, "there is no face in this file", "give an OBJ file with polygons");
    return std::move(result_);
  }

  [[noreturn]] void fail(const std::string& what, std::string_view remedy) const { fail(what, remedy, line_); }
  [[noreturn]] void fail(const std::string& what, std::string_view remedy, std::uint32_t line) const {
    throw Error(file_name_ + ":" + std::to_string(line), what, remedy);
  }

  void position(Words& words) {
    V3f p;
    numbers(words, "v", 3, {&p.x, &p.y, &p.z});
    for (int axis = 0; axis < 3; ++axis)
      if (!(std::abs(p[axis]) <= largest_coordinate))
        fail("a coordinate is larger than 1e12", "use larger units");
    append(result_.positions, p, lines_);
  }
  void normal(Words& words) {
    V3f n;
    numbers(words, "vn", 3, {&n.x, &n.y, &n.z});
    if (!is_finite(n)) fail("a normal is too large for a float", "normalise it");
    append(result_.normals, V3f(V3d(n).normalized()), lines_);
  }
  void uv(Words& words) {
    V2f uv(0.0f);
    numbers(words, "vt", 1, {&uv.x, &uv.y});
    if (!is_finite(uv)) fail("a texture coordinate is too large for a float", "correct it");
    append(result_.uvs, uv, lines_);
  }

  /// At least `least` numbers; numbers too large for a float become infinite. What follows (weights, vertex
  /// colours) is not used.
  void numbers(Words& words, std::string_view keyword, std::size_t least,
               std::initializer_list<float*> values) {
    std::size_t count = 0;
    for (float* value : values) {
      if (words.at_end()) break;
      if (!words.take_float(*value)) {
        const std::string_view word = words.next();
        const std::optional<double> number = parse_number(word);
        if (!number) fail(in_quotes(word) + " is not a finite number", "write numbers like -1.5e3");
        *value = static_cast<float>(*number);
      }
      ++count;
    }
    if (count < least)
      fail(in_quotes(keyword) + " has " + std::to_string(count) + " numbers",
           "give at least " + std::to_string(least));
  }

  void face(Words& words) {
    const std::size_t first = result_.corners.size();
    if (first > no_obj_index - most_corners) fail("more than 4 billion corners of faces", "split the file");
    while (!words.at_end()) {
      const std::string_view rest = words.rest();
      const char* at = rest.data();
      append(result_.corners, corner(at, at + rest.size(), words), lines_);
      words.advance(static_cast<std::size_t>(at - rest.data()));
    }
    const std::size_t count = result_.corners.size() - first;
    if (count > most_corners)
      fail("a face of " + std::to_string(count) + " corners",
           "split it: at most " + std::to_string(most_corners) + " are supported");
    if (count < 3) {
      ++small_faces_;
      result_.corners.resize(first);
      return;
    }
    append(result_.faces,
           {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count), group_, material_, smoothing_,
            line_},
           lines_);
  }

  /// position, position/uv, position//normal or position/uv/normal, from `at`, which moves behind it.
  ObjCorner corner(const char*& at, const char* end, const Words& words) const {
    const std::array<std::size_t, 3> counts{result_.positions.size(), result_.uvs.size(),
                                            result_.normals.size()};
    std::array<std::uint32_t, 3> indices{no_obj_index, no_obj_index, no_obj_index};
    for (std::size_t part = 0;; ++part) {
      if (part == 3) fail(in_quotes(words.peek()) + " has more than three indices", "write position/uv/normal");
      const bool is_absent = part > 0 && (at == end || *at == '/' || is_blank(*at));
      if (!is_absent) indices[part] = index(at, end, counts[part], words);
      if (at == end || is_blank(*at)) return {indices[0], indices[1], indices[2]};
      if (*at++ != '/') bad_corner(words);
    }
  }

  std::uint32_t index(const char*& at, const char* end, std::size_t count, const Words& words) const {
    if (end - at > 1 && *at == '+' && at[1] != '-') ++at;
    std::int32_t value = 0;
    const auto [after, code] = std::from_chars(at, end, value);
    if (code != std::errc() || value == 0) bad_corner(words);
    at = after;
    if (value > 0) return static_cast<std::uint32_t>(value - 1);
    const long long absolute = static_cast<long long>(count) + value;
    if (absolute < 0)
      fail("index " + std::to_string(value) + " points before the first of " + std::to_string(count),
           "correct the face");
    return static_cast<std::uint32_t>(absolute);
  }

  [[noreturn]] void bad_corner(const Words& words) const {
    fail(in_quotes(words.peek()) + " is not a corner of a face",
         "write position/uv/normal indices counted from 1, or from -1 backwards");
  }

  void check(std::uint32_t index, std::size_t count, std::string_view kind, std::uint32_t line) const {
    if (index >= count)
      fail(std::string(kind) + " " + std::to_string(index + 1ull) + " does not exist: there are " +
               std::to_string(count),
           "correct the face", line);
  }

  /// Statements that say what the faces behind them belong to.
  void state(std::string_view keyword, std::string_view name, Words& arguments) {
    name = trim(name);
    if (name.size() > longest_name)
      fail("a name of " + std::to_string(name.size()) + " characters",
           "shorten it: at most " + std::to_string(longest_name) + " are supported");
    if (keyword == "g") {
      group_name_ = name;
      enter_group();
    } else if (keyword == "o") {
      object_name_ = name;
      group_name_.clear();
      enter_group();
    } else if (keyword == "usemtl") {
      material_ = index_of(std::string(name), material_index_, result_.materials);
    } else if (keyword == "mtllib") {
      index_of(std::string(name), library_index_, result_.libraries);
    } else if (keyword == "s") {
      smoothing_ = smoothing_group(arguments.peek());
    } else {
      left_out(keyword);
    }
  }

  std::uint32_t smoothing_group(std::string_view word) const {
    if (word == "off" || word.empty()) return 0;
    if (word == "on") return 1;
    const std::optional<long long> group = parse_integer(word);
    if (!group || *group < 0 || *group > no_obj_index)
      fail(in_quotes(word) + " is not a smoothing group", "write a number, or off");
    return static_cast<std::uint32_t>(*group);
  }

  static std::uint32_t index_of(const std::string& name, Names& known, std::vector<std::string>& list) {
    const auto [entry, is_new] = known.try_emplace(name, static_cast<std::uint32_t>(list.size()));
    if (is_new) list.push_back(name);
    return entry->second;
  }
  void enter_group() {
    std::string name = object_name_;
    if (!name.empty() && !group_name_.empty()) name += '/';
    group_ = index_of(name + group_name_, group_index_, result_.groups);
  }

  void left_out(std::string_view keyword) {
    // Free-form geometry's settings are nothing to miss without the geometry; state and display hints neither.
    constexpr std::array<std::string_view, 17> quiet = {
        "vp",    "cstype",   "deg",      "bmat", "step", "parm",   "trim",       "hole",     "end",
        "bevel", "c_interp", "d_interp", "lod",  "mg",   "usemap", "shadow_obj", "trace_obj"};
    if (std::ranges::find(quiet, keyword) == quiet.end()) ++left_out_[std::string(keyword.substr(0, 20))];
  }

  LineReader& lines_;
  const std::string& file_name_;
  Notes& notes_;
  ObjFile result_;
  std::uint32_t line_ = 0;
  std::string object_name_, group_name_;
  std::uint32_t group_ = 0, material_ = 0, smoothing_ = 0;
  Names group_index_{{"", 0}}, material_index_{{"", 0}}, library_index_;
  std::size_t small_faces_ = 0;
  std::map<std::string, std::size_t> left_out_;
};

}  // namespace

ObjFile parse_obj(std::string_view text, const std::string& file, Notes& notes) {
  LineReader lines(text, file);
  return Parser(lines, file, notes).run();
}

ObjFile read_obj(const std::filesystem::path& path, Notes& notes) {
  RegularFile file(path);
  LineReader lines(file, path.string());
  return Parser(lines, path.string(), notes).run();
}

}  // namespace twopass
