#include "radiosity/vertex_mesh.h"

#include <numeric>
#include <tuple>

#include "radiosity/smooth_groups.h"
#include "render/core/interrupt.h"
#include "render/scene/geometry.h"

namespace twopass {

namespace {

// A corner of a root and where it is. Pieces of an analytic surface only ever meet those of its own side: they
// are keyed by it and by piece_corner_key().
struct CornerUse {
  std::uint32_t surface;  // shape and side of an analytic surface; no_index: triangles
  V3f position;
  std::uint32_t use;  // 3 x root + corner

  [[nodiscard]] auto key() const { return std::tuple(surface, position.x, position.y, position.z); }
};

// An edge of a root: edge k runs from corner k to the next.
struct EdgeUse {
  std::uint32_t low, high;  // the places of its ends
  std::uint32_t use;        // 3 x root + edge

  [[nodiscard]] auto key() const { return std::tuple(low, high); }
};

// How far along an edge, exactly.
struct Fraction {
  std::uint32_t numerator, denominator;

  friend bool operator<(const Fraction& a, const Fraction& b) {
    return a.numerator * b.denominator < b.numerator * a.denominator;  // at most 13 bits each
  }
  [[nodiscard]] Fraction from_other_end() const { return {denominator - numerator, denominator}; }
  [[nodiscard]] double value() const { return static_cast<double>(numerator) / denominator; }
};

struct EdgePoint {
  Fraction at;
  std::uint32_t vertex;
};

// The vertices in the interior of a root's edge, its own and its neighbours', from the end with the lower
// place.
struct EdgePoints {
  std::size_t first = 0;
  std::uint32_t count = 0;
  bool reversed = false;  // the root runs it the other way
};

// A point of a root's finest grid.
using Key = std::uint32_t;
Key key_of(const V2i& p) { return static_cast<Key>(p.y) << 16 | static_cast<Key>(p.x); }
V2i point_of(Key key) { return {static_cast<int>(key & 0xffffu), static_cast<int>(key >> 16)}; }

// The point's way along an edge of a grid of n divisions; -1: it is not on it.
int along_edge(const V2i& p, int edge, int n) {
  if (edge == 0) return p.y == 0 ? p.x : -1;
  if (edge == 1) return p.x + p.y == n ? p.y : -1;
  return p.x == 0 ? n - p.y : -1;
}
V2i edge_point(int edge, const Fraction& at) {
  const auto k = static_cast<int>(at.numerator), n = static_cast<int>(at.denominator);
  if (edge == 0) return {k, 0};
  if (edge == 1) return {n - k, k};
  return {0, n - k};
}

}  // namespace

class VertexMeshBuilder {
 public:
  VertexMeshBuilder(const ElementMesh& mesh, VertexMesh& result) : mesh_(mesh), result_(result) {}

  void build() {
    collect_grids();
    join_corners();
    throw_if_interrupted();
    join_edges();
    throw_if_interrupted();
    make_faces();
    make_cluster_faces();
    std::stable_sort(result_.edge_vertices_.begin(), result_.edge_vertices_.end(),
                     [](const auto& a, const auto& b) { return a.face < b.face; });
  }

 private:
  [[nodiscard]] std::uint32_t root_count() const { return static_cast<std::uint32_t>(mesh_.roots().size()); }
  [[nodiscard]] const ElementRoot& root(std::uint32_t r) const { return mesh_.roots()[r]; }
  [[nodiscard]] bool is_analytic(std::uint32_t r) const { return mesh_.is_analytic(root(r).shape); }
  [[nodiscard]] const Geometry& geometry(std::uint32_t r) const {
    return mesh_.shapes()[root(r).shape].geometry;
  }

  std::uint32_t add_vertex(const V3d& position) {
    result_.position_.emplace_back(position);
    return static_cast<std::uint32_t>(result_.position_.size() - 1);
  }

  // The elements of a root that is cut, and the points of its finest grid that are corners of elements.
  void collect_grids() {
    const std::uint32_t cells = static_cast<std::uint32_t>(mesh_.count() - mesh_.cluster_count());
    result_.faces_.cells = cells;
    first_key_.reserve(root_count() + 1);
    finest_.reserve(root_count());
    for (std::uint32_t r = 0; r < root_count(); ++r) {
      first_key_.push_back(key_.size());
      finest_.push_back(1);
      if (root(r).divisions == 0) continue;
      std::uint32_t end = root(r).first_element;
      std::uint32_t& finest = finest_.back();
      for (; end < cells && &mesh_.root(end) == &root(r); ++end)
        finest = std::max(finest, mesh_.cell(end).divisions);
      if (finest == 1) continue;
      for (std::uint32_t element = root(r).first_element; element < end; ++element) {
        const ElementCell cell = mesh_.cell(element);
        for (const V2i& corner : cell_corners(cell))
          key_.push_back(key_of(corner * static_cast<int>(finest / cell.divisions)));
      }
      const auto begin = key_.begin() + static_cast<std::ptrdiff_t>(first_key_.back());
      std::sort(begin, key_.end());
      key_.erase(std::unique(begin, key_.end()), key_.end());
    }
    first_key_.push_back(key_.size());
    vertex_of_key_.assign(key_.size(), no_index);
  }
  [[nodiscard]] std::span<const Key> keys(std::uint32_t r) const {
    return {key_.data() + first_key_[r], key_.data() + first_key_[r + 1]};
  }
  // Index into key_; no_key: no element has a corner there.
  static constexpr std::size_t no_key = ~std::size_t{0};
  [[nodiscard]] std::size_t find_key(std::uint32_t r, Key wanted) const {
    const std::span<const Key> all = keys(r);
    const auto n = static_cast<std::size_t>(finest_[r]);
    if (all.size() == (n + 1) * (n + 2) / 2) {  // a full grid: row y has n + 1 - y points
      const V2i p = point_of(wanted);
      const auto y = static_cast<std::size_t>(p.y);
      return first_key_[r] + y * (2 * n + 3 - y) / 2 + static_cast<std::size_t>(p.x);
    }
    const auto found = std::lower_bound(all.begin(), all.end(), wanted);
    if (found == all.end() || *found != wanted) return no_key;
    return first_key_[r] + static_cast<std::size_t>(found - all.begin());
  }

  void join_corners() {
    std::vector<CornerUse> uses;
    uses.reserve(3 * mesh_.roots().size());
    for (std::uint32_t r = 0; r < root_count(); ++r) {
      const ElementRoot& where = root(r);
      const std::array<V3f, 3> p =
          is_analytic(r) ? std::array<V3f, 3>{} : corners(geometry(r), where.primitive);
      for (std::uint32_t k = 0; k < 3; ++k) {
        CornerUse use{no_index, p[k], 3 * r + k};
        if (is_analytic(r)) {
          use.surface = where.shape << 1 | where.side;
          use.position = piece_corner_key(geometry(r), where.primitive, static_cast<int>(k));
        }
        uses.push_back(use);
      }
      normal_.push_back(normal_of(r));
    }
    std::sort(uses.begin(), uses.end(), [](const CornerUse& a, const CornerUse& b) {
      return std::tuple(a.key(), a.use) < std::tuple(b.key(), b.use);
    });
    place_.resize(uses.size());
    corner_vertex_.resize(uses.size());
    std::uint32_t places = 0;
    for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end, ++places) {
      while (end < uses.size() && uses[end].key() == uses[begin].key()) ++end;
      label_group(std::span(uses).subspan(begin, end - begin));
      const auto first_vertex = static_cast<std::uint32_t>(result_.count());
      for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t use = uses[i].use;
        place_[use] = places;
        corner_vertex_[use] = first_vertex + label_[i - begin];
        if (corner_vertex_[use] == result_.count())
          add_vertex(mesh_.grid_point(root(use / 3), edge_point(static_cast<int>(use % 3), {0, 1}), 1));
      }
    }
  }

  [[nodiscard]] V3f normal_of(std::uint32_t r) const {
    // The pieces that meet are always one surface.
    if (is_analytic(r)) return V3f(1.0f, 0.0f, 0.0f);
    return V3f(piece_patch(geometry(r), root(r).primitive, root(r).side).normal);
  }

  // Fills label_ for corners or edges that lie at one place.
  template <class Use>
  void label_group(std::span<Use> group) {
    group_normal_.clear();
    for (const Use& use : group) group_normal_.push_back(normal_[use.use / 3]);
    smooth_groups(group_normal_, label_);
  }

  void join_edges() {
    std::vector<EdgeUse> uses;
    uses.reserve(3 * mesh_.roots().size());
    for (std::uint32_t use = 0; use < 3 * root_count(); ++use) {
      const std::uint32_t from = place_[use], to = place_[next_corner(use)];
      uses.push_back({std::min(from, to), std::max(from, to), use});
    }
    std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
      return std::tuple(a.low, a.high, a.use) < std::tuple(b.low, b.high, b.use);
    });
    edge_points_of_use_.resize(uses.size());
    for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
      bool is_cut = false;
      for (; end < uses.size() && uses[end].key() == uses[begin].key(); ++end)
        is_cut = is_cut || finest_[uses[end].use / 3] > 1;
      if (is_cut) join_edge(std::span(uses).subspan(begin, end - begin));
    }
  }
  static std::uint32_t next_corner(std::uint32_t use) { return use % 3 == 2 ? use - 2 : use + 1; }
  [[nodiscard]] bool is_reversed(std::uint32_t use) const { return place_[use] > place_[next_corner(use)]; }

  // Where the elements of a group of roots cut their common edge. On each surface only those points are free in
  // which all of its roots have a corner: between them the trace must be linear from every side, so that it is
  // the same from every side.
  void join_edge(std::span<const EdgeUse> group) {
    label_group(group);
    struct Cut {
      Fraction at;
      std::uint32_t label;
    };
    std::vector<Cut> cuts;
    const std::uint32_t labels = 1 + *std::max_element(label_.begin(), label_.end());
    std::vector<std::uint32_t> members(labels, 0), seen(labels), first_use(labels, no_index);
    for (std::size_t i = 0; i < group.size(); ++i) {
      const std::uint32_t use = group[i].use, r = use / 3;
      ++members[label_[i]];
      if (first_use[label_[i]] == no_index) first_use[label_[i]] = use;
      const auto n = static_cast<int>(finest_[r]);
      for (const Key key : keys(r)) {
        const int along = along_edge(point_of(key), static_cast<int>(use % 3), n);
        if (along <= 0 || along >= n) continue;
        const Fraction at{static_cast<std::uint32_t>(along), finest_[r]};
        cuts.push_back({is_reversed(use) ? at.from_other_end() : at, label_[i]});
      }
    }
    std::stable_sort(cuts.begin(), cuts.end(), [](const Cut& a, const Cut& b) { return a.at < b.at; });
    std::vector<Fraction> at;
    std::vector<std::uint8_t> is_free;  // by point and label
    for (std::size_t begin = 0, end = 0; begin < cuts.size(); begin = end) {
      std::fill(seen.begin(), seen.end(), 0);
      for (; end < cuts.size() && !(cuts[begin].at < cuts[end].at); ++end) ++seen[cuts[end].label];
      at.push_back(cuts[begin].at);
      for (std::uint32_t l = 0; l < labels; ++l) is_free.push_back(seen[l] == members[l]);
    }
    std::vector<std::size_t> first_point(labels);
    for (std::uint32_t l = 0; l < labels; ++l) {
      first_point[l] = edge_points_.size();
      add_edge_points(first_use[l], at, [&](std::size_t k) { return is_free[k * labels + l] != 0; });
    }
    for (std::size_t i = 0; i < group.size(); ++i)
      edge_points_of_use_[group[i].use] = {first_point[label_[i]], static_cast<std::uint32_t>(at.size()),
                                           is_reversed(group[i].use)};
  }

  template <class IsFree>
  void add_edge_points(std::uint32_t use, const std::vector<Fraction>& at, IsFree is_free) {
    const bool reversed = is_reversed(use);
    const std::uint32_t first_end = corner_vertex_[reversed ? next_corner(use) : use],
                        last_end = corner_vertex_[reversed ? use : next_corner(use)];
    const std::size_t first = edge_points_.size();
    for (const Fraction& f : at) {
      const Fraction own = reversed ? f.from_other_end() : f;
      const V2i p = edge_point(static_cast<int>(use % 3), own);
      edge_points_.push_back({f, add_vertex(mesh_.grid_point(root(use / 3), p, own.denominator))});
    }
    std::uint32_t from = first_end;
    double from_value = 0.0;
    for (std::size_t k = 0; k < at.size(); ++k) {
      if (is_free(k)) {
        from = edge_points_[first + k].vertex;
        from_value = at[k].value();
        continue;
      }
      std::size_t next = k + 1;
      while (next < at.size() && !is_free(next)) ++next;
      const std::uint32_t to = next < at.size() ? edge_points_[first + next].vertex : last_end;
      const double to_value = next < at.size() ? at[next].value() : 1.0;
      for (; k < next; ++k)
        result_.hanging_.push_back(
            {edge_points_[first + k].vertex, from, to,
             static_cast<float>((at[k].value() - from_value) / (to_value - from_value))});
      --k;  // the loop goes on to the free point
    }
  }

  void make_faces() {
    result_.faces_.corner.resize(result_.faces_.cells);
    for (std::uint32_t r = 0; r < root_count(); ++r) {
      if (root(r).divisions == 0) continue;
      if (finest_[r] == 1) {
        make_whole_face(r, root(r).first_element);
        continue;
      }
      number_keys(r);
      hanging_.clear();
      for (std::uint32_t element = root(r).first_element;
           element < result_.faces_.cells && &mesh_.root(element) == &root(r); ++element)
        make_cell_face(r, element);
      // Larger elements first: what hangs on their edges can only be an end of smaller ones.
      std::stable_sort(hanging_.begin(), hanging_.end(),
                       [](const auto& a, const auto& b) { return a.length > b.length; });
      for (const LongHanging& h : hanging_) result_.hanging_.push_back(h.hanging);
    }
  }

  void number_keys(std::uint32_t r) {
    const auto n = static_cast<int>(finest_[r]);
    for (std::size_t k = first_key_[r]; k < first_key_[r + 1]; ++k) {
      const V2i p = point_of(key_[k]);
      std::uint32_t& vertex = vertex_of_key_[k];
      for (std::uint32_t edge = 0; edge < 3 && vertex == no_index; ++edge) {
        const int along = along_edge(p, static_cast<int>(edge), n);
        if (along == 0)
          vertex = corner_vertex_[3 * r + edge];
        else if (along > 0 && along < n)
          vertex = find_edge_point(3 * r + edge, {static_cast<std::uint32_t>(along), finest_[r]});
      }
      if (vertex == no_index) vertex = add_vertex(mesh_.grid_point(root(r), p, finest_[r]));
    }
  }
  [[nodiscard]] std::uint32_t find_edge_point(std::uint32_t use, const Fraction& along) const {
    const EdgePoints& points = edge_points_of_use_[use];
    const Fraction at = points.reversed ? along.from_other_end() : along;
    const auto begin = edge_points_.begin() + static_cast<std::ptrdiff_t>(points.first);
    return std::lower_bound(begin, begin + points.count, at,
                            [](const EdgePoint& p, const Fraction& f) { return p.at < f; })
        ->vertex;
  }

  void make_whole_face(std::uint32_t r, std::uint32_t face) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      result_.faces_.corner[face][k] = corner_vertex_[3 * r + k];
      add_border_vertices(face, k, 3 * r + k, {0, 1}, {1, 1});
    }
  }

  void make_cell_face(std::uint32_t r, std::uint32_t face) {
    const ElementCell cell = mesh_.cell(face);
    const std::uint32_t length = finest_[r] / cell.divisions;
    const auto n = static_cast<int>(finest_[r]);
    std::array<V2i, 3> corner = cell_corners(cell);
    for (V2i& p : corner) p *= static_cast<int>(length);
    for (std::uint32_t k = 0; k < 3; ++k)
      result_.faces_.corner[face][k] = vertex_of_key_[find_key(r, key_of(corner[k]))];
    for (std::uint32_t k = 0; k < 3; ++k) {
      const V2i from = corner[k], to = corner[(k + 1) % 3];
      // Cells lie in their root as its edges do: edge k is on the border, if at all, on the root's edge k.
      const int begin = along_edge(from, static_cast<int>(k), n), end = along_edge(to, static_cast<int>(k), n);
      if (!cell.inverted && begin >= 0 && end >= 0)
        add_border_vertices(face, k, 3 * r + k, {static_cast<std::uint32_t>(begin), finest_[r]},
                            {static_cast<std::uint32_t>(end), finest_[r]});
      else
        add_inner_vertices(r, face, k, from, to, length);
    }
  }

  // What lies on the edge of a face that is a part of an edge of its root.
  void add_border_vertices(std::uint32_t face, std::uint32_t edge, std::uint32_t use, const Fraction& begin,
                           const Fraction& end) {
    const EdgePoints& points = edge_points_of_use_[use];
    if (points.count == 0) return;
    const std::span<const EdgePoint> all = std::span(edge_points_).subspan(points.first, points.count);
    const auto before = [](const EdgePoint& p, const Fraction& f) { return p.at < f; };
    const auto after = [](const Fraction& f, const EdgePoint& p) { return f < p.at; };
    const Fraction low = points.reversed ? end.from_other_end() : begin,
                   high = points.reversed ? begin.from_other_end() : end;
    const auto first = std::upper_bound(all.begin(), all.end(), low, after);
    const auto last = std::lower_bound(first, all.end(), high, before);
    const auto count = static_cast<std::uint32_t>(last - first);
    for (std::uint32_t i = 0; i < count; ++i)
      result_.edge_vertices_.push_back({face, edge, first[points.reversed ? count - 1 - i : i].vertex});
  }

  // What lies on an edge between two cells of one root: the middle, if a corner is there, and so on in its
  // halves.
  void add_inner_vertices(std::uint32_t r, std::uint32_t face, std::uint32_t edge, const V2i& from,
                          const V2i& to, std::uint32_t length) {
    if (length == 1) return;
    const V2i middle = (from + to) / 2;
    const std::size_t key = find_key(r, key_of(middle));
    if (key == no_key) return;
    add_inner_vertices(r, face, edge, from, middle, length / 2);
    result_.edge_vertices_.push_back({face, edge, vertex_of_key_[key]});
    hanging_.push_back({{vertex_of_key_[key], vertex_of_key_[find_key(r, key_of(from))],
                         vertex_of_key_[find_key(r, key_of(to))], 0.5f},
                        length});
    add_inner_vertices(r, face, edge, middle, to, length / 2);
  }

  void make_cluster_faces() {
    VertexMesh::Faces& faces = result_.faces_;
    if (mesh_.cluster_count() == 0) return;
    faces.of_root.assign(root_count(), no_index);
    for (std::size_t element = faces.cells; element < mesh_.count(); ++element)
      for (const std::uint32_t r : mesh_.members(static_cast<std::uint32_t>(element))) {
        faces.of_root[r] = static_cast<std::uint32_t>(faces.corner.size());
        faces.corner.emplace_back();
        make_whole_face(r, faces.of_root[r]);
      }
  }

  struct LongHanging {
    VertexMesh::Hanging hanging;
    std::uint32_t length;  // of the edge, on the root's finest grid
  };

  const ElementMesh& mesh_;
  VertexMesh& result_;
  std::vector<std::size_t> first_key_;          // by root, and the end
  std::vector<Key> key_;                        // of one root ascending; none for a root that is not cut
  std::vector<std::uint32_t> vertex_of_key_;    // by key
  std::vector<std::uint32_t> finest_;           // by root: divisions of its finest grid
  std::vector<V3f> normal_;                     // by root
  std::vector<std::uint32_t> place_;            // by 3 x root + corner: equal where corners coincide
  std::vector<std::uint32_t> corner_vertex_;    // by 3 x root + corner
  std::vector<EdgePoints> edge_points_of_use_;  // by 3 x root + edge
  std::vector<EdgePoint> edge_points_;
  std::vector<LongHanging> hanging_;  // of one root
  std::vector<V3f> group_normal_;     // scratch
  std::vector<std::uint32_t> label_;  // scratch
};

VertexMesh::VertexMesh(const ElementMesh& mesh) { VertexMeshBuilder(mesh, *this).build(); }

std::span<const VertexMesh::EdgeVertex> VertexMesh::edge_vertices(std::uint32_t face) const {
  const auto begin = std::lower_bound(edge_vertices_.begin(), edge_vertices_.end(), face,
                                      [](const EdgeVertex& v, std::uint32_t f) { return v.face < f; });
  auto end = begin;
  while (end != edge_vertices_.end() && end->face == face) ++end;
  return {begin, end};
}

}  // namespace twopass
