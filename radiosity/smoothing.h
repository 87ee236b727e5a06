// Irradiance made continuous across elements, for looking at the bare solution.
#pragma once

#include <span>

#include "radiosity/elements.h"
#include "radiosity/irradiance.h"
#include "radiosity/vertex_mesh.h"

namespace twopass {

/// The irradiance at every vertex: the mean of the elements around it, weighted with their areas; around
/// clusters the elements next to them count too, by their distance, so that the step from one cluster to the
/// next is as wide as they are; and on the edge of a larger element what that one interpolates. Never outside
/// of the range of the elements' (but 0 where all of them are buried). REQUIRES: the mesh of the vertices; one
/// irradiance an element.
std::vector<Irradiance> vertex_irradiance(const VertexMesh& vertices, const ElementMesh& mesh,
                                          std::span<const Irradiance> irradiance);

/// The irradiance at the vertices, interpolated linearly between them: continuous wherever elements share
/// vertices, which they do over the borders of triangles and shapes too where vertices are equal.
class SmoothIrradiance {
 public:
  /// REQUIRES: one irradiance an element.
  SmoothIrradiance(const ElementMesh& mesh, std::span<const Irradiance> irradiance);

  /// REQUIRES: a location with an element of the constructor's mesh.
  [[nodiscard]] Irradiance at(const ElementMesh::Location& location) const;

 private:
  VertexMesh::Faces faces_;
  std::vector<Irradiance> value_;  // by vertex
};

}  // namespace twopass
