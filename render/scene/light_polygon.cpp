#include "render/scene/light_polygon.h"

#include <bit>
#include <optional>
#include <unordered_map>

#include "render/core/sampler.h"
#include "render/scene/ray.h"

namespace twopass {

namespace {

constexpr int next(int i, int n) { return i + 1 == n ? 0 : i + 1; }

float extent(const LightPolygon& polygon) {
  float largest = 0.0f;
  for (int i = 0; i < polygon.corners; ++i)
    largest =
        std::max(largest, max_abs_component(polygon.corner[i] - polygon.corner[next(i, polygon.corners)]));
  return largest;
}

// Everything that follows from the corners; false if there is no area.
bool complete(LightPolygon& polygon) {
  const auto& c = polygon.corner;
  const V3d origin(c[0]);
  const V3d area_vector = polygon.corners == 4 ? (V3d(c[2]) - origin).cross(V3d(c[3]) - V3d(c[1]))
                                               : (V3d(c[1]) - origin).cross(V3d(c[2]) - origin);
  const double length = area_vector.length();
  if (!(length > 0.0)) return false;
  polygon.normal = area_vector / length;
  polygon.area = 0.5 * length;
  polygon.pdf_a = static_cast<float>(1.0 / polygon.area);
  V3d middle(0.0);
  for (int i = 0; i < polygon.corners; ++i) middle += V3d(c[i]);
  polygon.middle = V3f(middle / static_cast<double>(polygon.corners));
  for (int i = 0; i < polygon.corners; ++i)
    polygon.reach2 = std::max(polygon.reach2, (c[i] - polygon.middle).length2());
  if (polygon.corners == 4)
    polygon.first_share =
        static_cast<float>(0.5 * (V3d(c[1]) - origin).cross(V3d(c[2]) - origin).length() / polygon.area);
  polygon.offset = rounding_offset(std::array{c[0], c[1], c[2]});
  if (polygon.corners == 3) return true;
  polygon.offset = std::max(polygon.offset, rounding_offset(std::array{c[1], c[2], c[3]}));
  const V3d e1 = V3d(c[1]) - origin, e2 = V3d(c[3]) - origin, far_corner = V3d(c[2]) - origin;
  const double gap = (far_corner - e1 - e2).length();
  polygon.is_parallelogram = gap <= polygon.offset && gap <= 1e-5 * extent(polygon);
  const V3d cross = e1.cross(e2);
  polygon.dual1 = V3f(e2.cross(cross) / cross.dot(cross));
  polygon.dual2 = V3f(cross.cross(e1) / cross.dot(cross));
  return true;
}

// The quadrilateral of two triangles that share an edge, from the apex of the first. Nothing if it is bent or
// not convex.
std::optional<LightPolygon> joined(const LightPolygon& a, int apex_a, const LightPolygon& b, int apex_b) {
  // Bent by less than an angle and by less than what the coordinates can express.
  constexpr double largest_sine = 1e-5;
  if (a.normal.dot(b.normal) <= 0.0 || a.normal.cross(b.normal).length() > largest_sine) return std::nullopt;
  const V3f p = a.corner[apex_a], q = b.corner[apex_b];
  if (std::abs(a.normal.dot(V3d(q) - V3d(p))) > std::max(a.offset, b.offset)) return std::nullopt;
  const int second = next(apex_a, 3);
  LightPolygon quad;
  quad.corner = {p, a.corner[second], q, a.corner[next(second, 3)]};
  quad.triangles = {a.triangles[0], b.triangles[0]};
  quad.corners = 4;
  for (int i = 0; i < 4; ++i) {
    const V3d here(quad.corner[i]), there(quad.corner[next(i, 4)]), beyond(quad.corner[(i + 2) % 4]);
    if (!((there - here).cross(beyond - there).dot(a.normal) > 0.0)) return std::nullopt;
  }
  if (!complete(quad)) return std::nullopt;
  return quad;
}

// Positions by value, so that meshes that repeat them join, too.
std::vector<std::uint32_t> merged_positions(const std::vector<V3f>& positions) {
  const auto hash = [](const V3f& p) {
    // -0 and 0 are the same position.
    const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x + 0.0f); };
    return hash_word(hash_words(bits(p.x), bits(p.y)) + bits(p.z));
  };
  std::unordered_map<V3f, std::uint32_t, decltype(hash)> first(positions.size(), hash);
  std::vector<std::uint32_t> merged(positions.size());
  for (std::uint32_t i = 0; i < positions.size(); ++i)
    merged[i] = first.try_emplace(positions[i], i).first->second;
  return merged;
}

class Joiner {
 public:
  explicit Joiner(const Mesh& mesh) : mesh_(mesh), id_(merged_positions(mesh.positions)) {
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const auto p = corners(mesh, i);
      LightPolygon triangle;
      triangle.corner = {p[0], p[1], p[2], V3f(0.0f)};
      triangle.triangles = {i, no_index};
      triangle.corners = 3;
      if (!complete(triangle)) continue;
      const auto index = static_cast<std::uint32_t>(triangles_.size());
      triangles_.push_back(triangle);
      for (int apex = 0; apex < 3; ++apex) opposite_[edge(index, apex, false)] = {index, apex};
    }
    is_taken_.resize(triangles_.size(), false);
  }

  std::vector<LightPolygon> join() {
    std::vector<LightPolygon> polygons;
    for (const bool only_parallelograms : {true, false}) join_pairs(only_parallelograms, polygons);
    for (std::size_t i = 0; i < triangles_.size(); ++i)
      if (!is_taken_[i]) polygons.push_back(triangles_[i]);
    return polygons;
  }

 private:
  struct Apex {
    std::uint32_t triangle;
    int corner;
  };

  // The edge opposite of a corner, along the triangle's sense or against it.
  [[nodiscard]] std::uint64_t edge(std::uint32_t triangle, int apex, bool reversed) const {
    const V3u& index = mesh_.triangles[triangles_[triangle].triangles[0]];
    const std::uint64_t a = id_[index[next(apex, 3)]], b = id_[index[(apex + 2) % 3]];
    return reversed ? b << 32 | a : a << 32 | b;
  }

  void join_pairs(bool only_parallelograms, std::vector<LightPolygon>& polygons) {
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
      for (int apex = 0; apex < 3 && !is_taken_[i]; ++apex) {
        const auto found = opposite_.find(edge(i, apex, true));
        if (found == opposite_.end() || found->second.triangle == i || is_taken_[found->second.triangle])
          continue;
        const Apex other = found->second;
        const auto quad = joined(triangles_[i], apex, triangles_[other.triangle], other.corner);
        if (!quad || (only_parallelograms && !quad->is_parallelogram)) continue;
        polygons.push_back(*quad);
        is_taken_[i] = is_taken_[other.triangle] = true;
      }
    }
  }

  const Mesh& mesh_;
  std::vector<std::uint32_t> id_;
  std::vector<LightPolygon> triangles_;
  std::unordered_map<std::uint64_t, Apex> opposite_;  // by directed edge
  std::vector<bool> is_taken_;
};

}  // namespace

std::vector<LightPolygon> light_polygons(const Mesh& mesh) { return Joiner(mesh).join(); }

}  // namespace twopass
