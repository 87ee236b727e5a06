// Wavefront OBJ text made safe for tinyobjloader, which rejects or silently misreads much of what files in the
// wild contain: byte order marks, comments behind faces, continued lines, numbers that are none, index 0.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "render/load/notes.h"

namespace twopass {

/// The statements of an OBJ file that we read (v vn vt f g o usemtl), one a line, every number checked.
struct ObjText {
  std::string text;
  std::vector<std::uint32_t> lines;    ///< of each statement: its line in the file, counted from 1
  std::vector<std::string> libraries;  ///< what stands behind each mtllib, in order
  bool smoothing = false;              ///< the file switches smoothing groups on
};

/// Cleans `text`. `file` is its name in errors and notes. Throws Error with file:line for numbers that are
/// missing, malformed or not finite, for index 0 and for faces of more than 2000 corners.
ObjText clean_obj(std::string_view text, std::string_view file, Notes& notes);

/// Lines of a text file: any line end (\n, \r\n, \r), lines ending in a back-slash joined to the next.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : rest_(text) {}
  /// The next line without its end. False when there is none.
  bool next(std::string& line);
  /// Number of the line's first line in the file, counted from 1.
  [[nodiscard]] std::uint32_t number() const { return number_; }

 private:
  std::string_view take();

  std::string_view rest_;
  std::uint32_t number_ = 0, following_ = 1;
};

}  // namespace twopass
