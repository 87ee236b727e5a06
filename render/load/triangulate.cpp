#include "render/load/triangulate.h"

#include <numeric>

namespace twopass {
namespace {

using V2d = Imath::V2d;
using Triangle = std::array<std::uint32_t, 3>;

/// Twice the signed area of a triangle in the plane.
double turn(const V2d& a, const V2d& b, const V2d& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The polygon in the plane perpendicular to its mean normal, counter-clockwise. Newell's sum gives twice the
/// area vector of any closed polygon, bent or concave.
std::vector<V2d> project(std::span<const V3f> corners) {
  const V3d origin(corners[0]);
  V3d normal(0.0);
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    normal += (V3d(corners[i]) - origin).cross(V3d(corners[i + 1]) - origin);
  // Dropping the normal's largest component keeps every turn's sign and needs no roots.
  const V3d size(std::abs(normal.x), std::abs(normal.y), std::abs(normal.z));
  int drop = 2;
  if (size.x >= size.y && size.x >= size.z)
    drop = 0;
  else if (size.y >= size.z)
    drop = 1;
  const int u = (drop + 1) % 3, v = (drop + 2) % 3;
  const double sign = normal[drop] < 0.0 ? -1.0 : 1.0;
  std::vector<V2d> plane;
  plane.reserve(corners.size());
  for (const V3f& corner : corners) {
    const V3d p = V3d(corner) - origin;
    plane.emplace_back(p[u] * sign, p[v]);
  }
  return plane;
}

bool is_convex(std::span<const V2d> p) {
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i)
    if (turn(p[i], p[(i + 1) % n], p[(i + 2) % n]) < 0.0) return false;
  // Turning left everywhere is not enough: a pentagram does, too. A fan of a convex polygon never turns back.
  for (std::size_t i = 1; i + 1 < n; ++i)
    if (turn(p[0], p[i], p[i + 1]) < 0.0) return false;
  return true;
}

bool is_ear(std::span<const V2d> p, std::span<const std::uint32_t> ring, std::size_t at) {
  const std::size_t n = ring.size();
  const V2d &a = p[ring[(at + n - 1) % n]], &b = p[ring[at]], &c = p[ring[(at + 1) % n]];
  if (turn(a, b, c) <= 0.0) return false;
  for (std::size_t i = 2; i < n - 1; ++i) {
    const V2d& q = p[ring[(at + i) % n]];
    if (q == a || q == b || q == c) continue;  // bridges to holes visit a corner twice
    if (turn(a, b, q) >= 0.0 && turn(b, c, q) >= 0.0 && turn(c, a, q) >= 0.0) return false;
  }
  return true;
}

/// The corner to cut when there is no ear (numbers too close, or a polygon that crosses itself): the one with
/// the least area, which does the least harm.
std::size_t least_corner(std::span<const V2d> p, std::span<const std::uint32_t> ring) {
  const std::size_t n = ring.size();
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < n; ++i) {
    const double area = std::abs(turn(p[ring[(i + n - 1) % n]], p[ring[i]], p[ring[(i + 1) % n]]));
    if (area < least) {
      least = area;
      best = i;
    }
  }
  return best;
}

}  // namespace

std::vector<Triangle> triangulate(std::span<const V3f> corners) {
  const auto n = static_cast<std::uint32_t>(corners.size());
  std::vector<Triangle> triangles;
  triangles.reserve(n - 2);
  const auto fan = [&] {
    for (std::uint32_t i = 1; i + 1 < n; ++i) triangles.push_back({0, i, i + 1});
  };
  if (n == 3) {
    fan();
    return triangles;
  }
  const std::vector<V2d> plane = project(corners);
  if (is_convex(plane)) {
    fan();
    return triangles;
  }
  std::vector<std::uint32_t> ring(n);
  std::iota(ring.begin(), ring.end(), 0u);
  std::size_t start = 0;
  while (ring.size() > 3) {
    const std::size_t m = ring.size();
    std::size_t at = m;
    for (std::size_t i = 0; i < m && at == m; ++i)
      if (is_ear(plane, ring, (start + i) % m)) at = (start + i) % m;
    if (at == m) at = least_corner(plane, ring);
    triangles.push_back({ring[(at + m - 1) % m], ring[at], ring[(at + 1) % m]});
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(at));
    start = at;  // go round the polygon instead of fanning out from one corner: fewer slivers
  }
  triangles.push_back({ring[0], ring[1], ring[2]});
  return triangles;
}

}  // namespace twopass
