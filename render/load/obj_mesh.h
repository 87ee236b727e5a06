// Meshes of an OBJ file's faces: its triple indices to one, its polygons to triangles, its smoothing groups to
// normals.
#pragma once

#include <span>

#include "render/load/obj_file.h"
#include "render/scene/shape.h"

namespace twopass {

/// Faces [first, end) of a file.
struct FaceRange {
  std::uint32_t first, end;
};

/// The triangles of some of the file's faces, each combination of indices one vertex. Corners without a normal
/// get their face's when others have one; without uv, (0, 0). Texture coordinates as in the file (v upwards).
Mesh mesh_of_faces(const ObjFile& file, std::span<const FaceRange> ranges);

/// The same of all faces.
inline Mesh mesh_of(const ObjFile& file) {
  const FaceRange all{0, static_cast<std::uint32_t>(file.faces.size())};
  return mesh_of_faces(file, {&all, 1});
}

/// Gives normals to the corners without one of faces in a smoothing group: the mean of the group's faces around
/// the position, weighted by their angles there (as in compute_smooth_normals). Corners stay without where that
/// mean faces away from their own face.
void add_smooth_normals(ObjFile& file);

}  // namespace twopass
