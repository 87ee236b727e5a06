// Irradiance made continuous across elements, for looking at the bare solution.
#pragma once

#include <span>

#include "radiosity/elements.h"
#include "radiosity/irradiance.h"

namespace twopass {

/// Area-weighted averages at the corners of elements, interpolated linearly between them. Elements that meet at
/// less than 30 degrees share averages, over the borders of triangles and shapes too where vertices are equal.
class SmoothIrradiance {
 public:
  /// REQUIRES: one irradiance an element.
  SmoothIrradiance(const ElementMesh& mesh, std::span<const Irradiance> irradiance);

  /// REQUIRES: the mesh of the constructor, and a location with an element.
  [[nodiscard]] Irradiance at(const ElementMesh& mesh, const ElementMesh::Location& location) const;

 private:
  struct Weighted;
  struct BorderVertex;
  struct BorderEdge;

  [[nodiscard]] std::size_t vertex(const ElementMesh& mesh, std::uint32_t root, const V2i& numerators) const;
  [[nodiscard]] std::vector<Weighted> sum_elements(const ElementMesh& mesh,
                                                   std::span<const Irradiance> irradiance);
  void weld_borders(const ElementMesh& mesh, std::vector<Weighted>& sums) const;
  void align_hanging_vertices(const ElementMesh& mesh);

  std::vector<std::size_t> first_vertex_;  // by root: of its triangular grid of vertices
  std::vector<Irradiance> value_;          // by vertex
};

}  // namespace twopass
