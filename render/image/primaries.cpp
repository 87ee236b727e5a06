#include "render/image/primaries.h"

#include <Imath/ImathMatrix.h>

namespace twopass {
namespace {

constexpr Named<Primaries> spaces[] = {
    {rec709_id, {V2f(0.64f, 0.33f), V2f(0.30f, 0.60f), V2f(0.15f, 0.06f), V2f(0.3127f, 0.3290f)}},
    {"lin_ap1_scene", {V2f(0.713f, 0.293f), V2f(0.165f, 0.830f), V2f(0.128f, 0.044f), V2f(0.32168f, 0.33767f)}},
    {"lin_ap0_scene", {V2f(0.7347f, 0.2653f), V2f(0.0f, 1.0f), V2f(0.0001f, -0.077f), V2f(0.32168f, 0.33767f)}},
    {"lin_p3d65_scene", {V2f(0.680f, 0.320f), V2f(0.265f, 0.690f), V2f(0.150f, 0.060f), V2f(0.3127f, 0.3290f)}},
    {"lin_rec2020_scene",
     {V2f(0.708f, 0.292f), V2f(0.170f, 0.797f), V2f(0.131f, 0.046f), V2f(0.3127f, 0.3290f)}}};

// Row vectors, as Imath has them.
using M33d = Imath::M33d;

V3d xyz_of(const V2f& xy) {
  const double x = xy.x, y = xy.y;
  return {x / y, 1.0, (1.0 - x - y) / y};
}

M33d rows(const V3d& a, const V3d& b, const V3d& c) { return {a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z}; }

M33d diagonal(const V3d& d) { return {d.x, 0.0, 0.0, 0.0, d.y, 0.0, 0.0, 0.0, d.z}; }

// XYZ of colours whose white has Y = 1.
M33d to_xyz(const Primaries& space) {
  // Of any length each: a primary may have y = 0.
  const auto direction = [](const V2f& p) {
    return V3d(p.x, p.y, 1.0 - static_cast<double>(p.x) - static_cast<double>(p.y));
  };
  const M33d directions = rows(direction(space.red), direction(space.green), direction(space.blue));
  return diagonal(xyz_of(space.white) * directions.inverse()) * directions;
}

M33d adaptation(const V2f& from, const V2f& to) {
  const M33d cones(0.8951, -0.7502, 0.0389, 0.2664, 1.7135, -0.0685, -0.1614, 0.0367, 1.0296);
  return cones * diagonal(xyz_of(to) * cones / (xyz_of(from) * cones)) * cones.inverse();
}

M33d matrix_of(const ColorMatrix& m) { return rows(V3d(m.image[0]), V3d(m.image[1]), V3d(m.image[2])); }

}  // namespace

std::span<const Named<Primaries>> interop_spaces() { return spaces; }

const Primaries* find_interop_space(std::string_view id) {
  for (const auto& [name, primaries] : spaces)
    if (name == id) return &primaries;
  return nullptr;
}

std::string_view interop_id_of(const ColorMatrix& from_rec709) {
  constexpr float tolerance = 2e-4f;  // configurations round their matrices
  for (const auto& [name, primaries] : spaces) {
    const ColorMatrix expected = conversion(spaces[0].value, primaries);
    float difference = 0.0f;
    for (std::size_t i = 0; i < 3; ++i)
      for (int c = 0; c < 3; ++c)
        difference = std::max(difference, std::abs(expected.image[i][c] - from_rec709.image[i][c]));
    if (difference <= tolerance) return name;
  }
  return {};
}

ColorMatrix conversion(const Primaries& from, const Primaries& to) {
  const M33d m = to_xyz(from) * adaptation(from.white, to.white) * to_xyz(to).inverse();
  ColorMatrix result;
  for (int i = 0; i < 3; ++i)
    for (int c = 0; c < 3; ++c) result.image[static_cast<std::size_t>(i)][c] = static_cast<float>(m[i][c]);
  return result;
}

Primaries primaries_of(const ColorMatrix& to_rec709) {
  const M33d m = matrix_of(to_rec709) * to_xyz(spaces[0].value);
  const auto xy = [](const V3d& xyz) { return V2f(V2d(xyz.x, xyz.y) / (xyz.x + xyz.y + xyz.z)); };
  const auto row = [&](int i) { return V3d(m[i][0], m[i][1], m[i][2]); };
  return {xy(row(0)), xy(row(1)), xy(row(2)), xy(row(0) + row(1) + row(2))};
}

}  // namespace twopass
