// Wavefront OBJ files as neutral arrays: no materials, no shapes, no triangles yet. The only place that parses
// OBJ geometry with tinyobjloader.
#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "render/core/types.h"
#include "render/load/notes.h"
#include "render/scene/shape.h"

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
  std::uint32_t line;             ///< in the file, counted from 1
};

/// All indices are in range, all numbers finite.
struct ObjFile {
  std::vector<V3f> positions, normals;
  std::vector<V2f> uvs;
  std::vector<ObjCorner> corners;
  std::vector<ObjFace> faces;
  std::vector<std::string> groups{""};     ///< "object/group", "object", "group", or "" before any
  std::vector<std::string> materials{""};  ///< names behind usemtl; "" before any
  std::vector<std::string> libraries;      ///< what stands behind each mtllib
  bool smoothing = false;                  ///< the file switches smoothing groups on; they are not read
};

/// Reads a file. Throws Error with file:line for whatever is malformed, and when there is no face.
ObjFile read_obj(const std::filesystem::path& path, Notes& notes);

/// The triangles of some of the file's faces, each combination of indices one vertex. Corners without a normal
/// get their face's when others have one; without uv, (0, 0). Texture coordinates as in the file (v upwards).
Mesh mesh_of_faces(const ObjFile& file, const std::vector<std::uint32_t>& faces);

}  // namespace twopass
