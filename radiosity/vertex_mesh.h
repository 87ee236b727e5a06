// The corners of all elements as one mesh. Elements that meet smoothly share vertices, whatever their
// triangles, shapes and grids; and it is known which vertices lie on the edge of a larger element.
#pragma once

#include <span>
#include <vector>

#include "radiosity/elements.h"

namespace twopass {

/// A vertex is a position and the surface around it: triangles that meet there and are joined by steps of less
/// than 30 degrees share it, and so do the pieces of one side of an analytic surface. REQUIRES: the mesh
/// outlives it.
class VertexMesh {
 public:
  explicit VertexMesh(const ElementMesh& mesh);

  /// The flat pieces: elements that are cells, under their own number, then the triangles of the clusters in
  /// the order of clusters and members.
  struct Faces {
    std::vector<std::array<std::uint32_t, 3>> corner;  ///< vertices, in the order of `cell_corners`
    std::vector<std::uint32_t>
        of_root;            ///< the face of a root that is part of a cluster; empty without clusters
    std::size_t cells = 0;  ///< how many of the faces are elements

    /// REQUIRES: a location with an element.
    [[nodiscard]] std::uint32_t find(const ElementMesh::Location& location) const {
      return location.element < cells ? location.element : of_root[location.root];
    }
  };
  [[nodiscard]] const Faces& faces() const { return faces_; }
  [[nodiscard]] Faces take_faces() && { return std::move(faces_); }

  [[nodiscard]] std::size_t count() const { return position_.size(); }
  /// Of faces that touch, equal bit for bit.
  [[nodiscard]] const V3f& position(std::uint32_t vertex) const { return position_[vertex]; }

  /// A vertex on an edge of a larger element: there that element's value is `1 - t` parts of one vertex and `t`
  /// of another.
  struct Hanging {
    std::uint32_t vertex, from, to;
    float t;
  };
  /// In an order in which `from` and `to` hang, if at all, before `vertex` does.
  [[nodiscard]] std::span<const Hanging> hanging() const { return hanging_; }

  /// A vertex in the interior of an edge of a face: the edge from corner k to corner k + 1.
  struct EdgeVertex {
    std::uint32_t face;
    std::uint32_t edge;
    std::uint32_t vertex;
  };
  /// The vertices in the interior of the face's edges, its own surface's or not, in the order of the border.
  [[nodiscard]] std::span<const EdgeVertex> edge_vertices(std::uint32_t face) const;

 private:
  friend class VertexMeshBuilder;
  Faces faces_;
  std::vector<V3f> position_;
  std::vector<Hanging> hanging_;
  std::vector<EdgeVertex> edge_vertices_;  // by face
};

}  // namespace twopass
