// Wavefront OBJ files as neutral arrays: no materials, no shapes, no triangles yet.
//
// The parser is our own. tinyobjloader, the usual choice, refuses comments behind faces and continued lines,
// loses what follows a byte order mark, and takes malformed numbers and indices out of range silently, so that
// all of its input would have to be read and checked beforehand; and what has been read need not be read again.
// Where it reads a file rightly, so do we, which the tests hold against it (tests/load/obj_peer_test.cpp), in
// less time (tests/bench/load_bench.cpp).
#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "render/core/types.h"
#include "render/load/notes.h"

namespace twopass {

inline constexpr std::uint32_t no_obj_index = std::numeric_limits<std::uint32_t>::max();

/// Indices into the arrays of ObjFile, counted from 0; uv and normal may be no_obj_index.
struct ObjCorner {
  std::uint32_t position, uv, normal;
};

/// A polygon: corners [first_corner, first_corner + corner_count) of ObjFile.
struct ObjFace {
  std::uint32_t first_corner, corner_count;
  std::uint32_t group, material;  ///< indices into ObjFile's names
  std::uint32_t smoothing;        ///< its smoothing group; 0: none
  std::uint32_t line;             ///< in the file, counted from 1
};

/// All indices are in range, all numbers finite.
struct ObjFile {
  std::vector<V3f> positions;
  std::vector<V3f> normals;  ///< unit; corners do not refer to those that the file gives no length
  std::vector<V2f> uvs;
  std::vector<ObjCorner> corners;
  std::vector<ObjFace> faces;
  std::vector<std::string> groups{""};     ///< "object/group", "object", "group", or "" before any
  std::vector<std::string> materials{""};  ///< names behind usemtl; "" before any
  std::vector<std::string> libraries;      ///< what stands behind mtllib, each once
};

/// Reads a file. Throws Error with file:line for whatever is malformed, and when there is no face.
ObjFile read_obj(const std::filesystem::path& path, Notes& notes);

/// Reads OBJ text; `file` is its name in errors and notes. Numbers that are missing, malformed or not finite,
/// coordinates beyond 1e12, indices that are 0 or lead nowhere, faces of more than 2000 corners and names of
/// more than 1000 characters are errors. Faces of fewer than three corners and what is no polygon (points,
/// lines, free-form surfaces) are left out with a counted note.
ObjFile parse_obj(std::string_view text, const std::string& file, Notes& notes);

}  // namespace twopass
