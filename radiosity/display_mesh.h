// A solution as triangles with colours at their vertices, for viewers that know no radiosity.
#pragma once

#include <string>
#include <vector>

#include "radiosity/solution.h"

namespace twopass {

/// One side of a shape. Triangles run counter-clockwise seen from it.
struct DisplaySide {
  std::uint32_t shape;
  Side side;
  std::vector<V3f> position;  ///< in the world
  std::vector<C3f> color;     ///< by position: linear, in [0, 1]
  std::vector<V3u> triangle;
};

/// All that is to be seen of a scene under a solution.
struct DisplayMesh {
  std::vector<DisplaySide> sides;  ///< in the order of shape and side
  double exposure = 1.0;           ///< colour = exposure x radiance in W/(m2 sr); brighter ones keep their hue
};

/// The elements with the radiance that they reflect and emit, smoothed; and without elements lamps in their
/// colour, mirrors and glass in grey, black surfaces black. A back that is plain black is left out, so that a
/// room can be looked into from outside. Positions of triangles that touch are equal bit for bit and no vertex
/// lies within another triangle's edge, if that holds for the scene. The 99th percentile, by area, of what is
/// reflected is exposed to 0.8. `to_rec709`: of the scene's
/// colours. REQUIRES: the solution's scene.
DisplayMesh display_mesh(const Scene& scene, const Solution& solution, const ColorMatrix& to_rec709 = {});

}  // namespace twopass
