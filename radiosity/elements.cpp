#include "radiosity/elements.h"

#include <algorithm>
#include <numeric>

#include "radiosity/local_albedo.h"
#include "render/core/parallel.h"
#include "render/scene/geometry.h"

namespace twopass {

namespace {

// Of an entry in cells_: what it points at are four more cells.
constexpr std::uint32_t refined = 0x80000000u;
// A packed cell keeps 13 bits each for column, row, 1 for the orientation and 5 for the level.
constexpr std::uint32_t most_divisions = 1u << 13;

std::uint32_t cell_count(const ElementRoot& root) { return std::uint32_t{root.divisions} * root.divisions; }

// Cells are numbered row by row; a row holds 2 (divisions - row) - 1 of them.
std::uint32_t cell_index(std::uint32_t column, std::uint32_t row, bool inverted, std::uint32_t divisions) {
  return row * (2 * divisions - row) + 2 * column + (inverted ? 1 : 0);
}

std::uint32_t pack(const ElementCell& cell, std::uint32_t level) {
  return cell.column | cell.row << 13 | (cell.inverted ? 1u : 0u) << 26 | level << 27;
}
std::uint32_t level_of(std::uint32_t packed) { return packed >> 27; }
ElementCell unpack(std::uint32_t packed, std::uint32_t root_divisions) {
  return {packed & 0x1fffu, packed >> 13 & 0x1fffu, (packed >> 26 & 1u) != 0,
          root_divisions << level_of(packed)};
}

// The quarter of a cell in which a place is; its coordinates become those in the quarter. By arithmetic: which
// quarter a ray meets is nothing that the processor could predict.
std::uint32_t enter_quarter(float& u, float& v) {
  const float a = u, b = v;
  const std::int32_t beyond_0 = a + b > 0.5f ? 1 : 0, at_1 = a >= 0.5f ? 1 : 0, at_2 = b >= 0.5f ? 1 : 0;
  const std::int32_t child = beyond_0 * (3 - 2 * at_1 - (at_2 & ~at_1));
  const std::int32_t middle = child == 3 ? 1 : 0;
  const auto scale = static_cast<float>(2 - 4 * middle);
  u = scale * a + static_cast<float>(middle - (child == 1 ? 1 : 0));
  v = scale * b + static_cast<float>(middle - (child == 2 ? 1 : 0));
  return static_cast<std::uint32_t>(child);
}

struct Parent {
  ElementCell cell;
  int child;  // which of its quarters
};

// The inverse of child_cell.
Parent parent_of(const ElementCell& cell) {
  const bool odd_column = cell.column % 2 == 1, odd_row = cell.row % 2 == 1;
  const bool middle = cell.inverted ? !odd_column && !odd_row : odd_column && odd_row;
  const ElementCell parent{cell.column / 2, cell.row / 2, cell.inverted != middle, cell.divisions / 2};
  if (middle) return {parent, 3};
  if (!cell.inverted) return {parent, odd_column ? 1 : odd_row ? 2 : 0};
  return {parent, odd_column && odd_row ? 0 : odd_row ? 1 : 2};
}

}  // namespace

std::array<V2i, 3> cell_corners(const ElementCell& cell) {
  const V2i p(static_cast<int>(cell.column), static_cast<int>(cell.row));
  if (cell.inverted) return {p + V2i(1, 1), p + V2i(0, 1), p + V2i(1, 0)};
  return {p, p + V2i(1, 0), p + V2i(0, 1)};
}

ElementCell child_cell(const ElementCell& cell, int child) {
  const std::uint32_t c = 2 * cell.column, r = 2 * cell.row, divisions = 2 * cell.divisions;
  if (cell.inverted) {
    if (child == 3) return {c + 1, r + 1, false, divisions};
    return {child == 1 ? c : c + 1, child == 2 ? r : r + 1, true, divisions};
  }
  if (child == 3) return {c, r, true, divisions};
  return {child == 1 ? c + 1 : c, child == 2 ? r + 1 : r, false, divisions};
}

ElementMesh::ElementMesh(std::span<const Shape> shapes, std::span<const Material> materials,
                         std::vector<ElementRoot> roots, std::span<const std::uint32_t> cluster_of_root)
    : shapes_(shapes),
      materials_(materials),
      first_root_(shapes.size(), {no_index, no_index}),
      is_analytic_(shapes.size(), 0),
      roots_(std::move(roots)) {
  for (std::size_t s = 0; s < shapes.size(); ++s) is_analytic_[s] = twopass::is_analytic(shapes[s].geometry);
  for (std::uint32_t r = 0; r < roots_.size(); ++r) {
    std::uint32_t& base = first_root_[roots_[r].shape][roots_[r].side];
    if (base == no_index) base = r;
  }
  number_elements(cluster_of_root);
  measure();
}

// Cells first, in the order of their roots; then the clusters.
void ElementMesh::number_elements(std::span<const std::uint32_t> cluster_of_root) {
  std::size_t cells = 0;
  for (const ElementRoot& root : roots_) cells += cell_count(root);
  place_.reserve(cells);
  for (std::uint32_t r = 0; r < roots_.size(); ++r) {
    ElementRoot& root = roots_[r];
    root.first_cell = no_index;
    root.first_element = static_cast<std::uint32_t>(place_.size());
    for (std::uint32_t row = 0; row < root.divisions; ++row)
      for (std::uint32_t column = 0; column + row < root.divisions; ++column) {
        place_.push_back({r, pack({column, row, false, root.divisions}, 0)});
        if (column + row + 1 < root.divisions)
          place_.push_back({r, pack({column, row, true, root.divisions}, 0)});
      }
  }
  add_clusters(cluster_of_root);
}

void ElementMesh::add_clusters(std::span<const std::uint32_t> cluster_of_root) {
  std::uint32_t clusters = 0, members = 0;
  const auto is_member = [&](std::size_t r) { return roots_[r].divisions == 0; };
  for (std::size_t r = 0; r < cluster_of_root.size(); ++r)
    if (is_member(r)) {
      clusters = std::max(clusters, cluster_of_root[r] + 1);
      ++members;
    }
  if (clusters == 0) return;
  first_member_.assign(clusters + 1, 0);
  for (std::size_t r = 0; r < roots_.size(); ++r)
    if (is_member(r)) ++first_member_[cluster_of_root[r] + 1];
  std::partial_sum(first_member_.begin(), first_member_.end(), first_member_.begin());
  member_.resize(members);
  member_share_.resize(members);
  std::vector<std::uint32_t> next(first_member_.begin(), first_member_.end() - 1);
  const auto first_element = static_cast<std::uint32_t>(place_.size());
  for (std::uint32_t r = 0; r < roots_.size(); ++r) {
    if (!is_member(r)) continue;
    roots_[r].first_element = first_element + cluster_of_root[r];
    member_[next[cluster_of_root[r]]++] = r;
  }
  for (std::uint32_t c = 0; c < clusters; ++c) place_.push_back({member_[first_member_[c]], c});
}

void ElementMesh::measure() {
  area_.resize(place_.size());
  for (std::uint32_t element = 0; element < area_.size(); ++element) {
    double sum = 0.0;
    if (is_cluster(element)) {
      const std::uint32_t first = first_member_[place_[element].cell],
                          last = first_member_[place_[element].cell + 1];
      for (std::uint32_t k = first; k < last; ++k) {
        sum += root_patch(roots_[member_[k]]).area;
        member_share_[k] = static_cast<float>(sum);
      }
      for (std::uint32_t k = first; k < last && sum > 0.0; ++k)
        member_share_[k] = static_cast<float>(static_cast<double>(member_share_[k]) / sum);
    } else {
      sum = patch(element).area;
    }
    area_[element] = static_cast<float>(sum);
  }
  find_reflectances();
}

void ElementMesh::find_reflectances() {
  reflectance_.resize(place_.size());
  parallel_for(place_.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (auto element = static_cast<std::uint32_t>(begin); element < end; ++element) {
      const ElementRoot& first = root(element);
      const Shape& shape = shapes_[first.shape];
      const MaterialSide& side = materials_[shape.material].side[first.side];
      C3f& reflectance = reflectance_[element];
      if (side.is_uniform()) {
        reflectance = side.traits().mean_diffuse_reflectance;
      } else if (!is_cluster(element)) {
        reflectance = mean_albedo(shape, side, first, cell(element));
      } else {
        // Members are of one material, but may be of several shapes.
        C3d sum(0.0);
        double area = 0.0;
        for (const std::uint32_t m : members(element)) {
          const double part = root_patch(roots_[m]).area;
          sum += C3d(mean_albedo(shapes_[roots_[m].shape], side, roots_[m], {0, 0, false, 1})) * part;
          area += part;
        }
        reflectance = area > 0.0 ? C3f(sum / area) : side.traits().mean_diffuse_reflectance;
      }
    }
  });
}

ElementMesh ElementMesh::split(const std::vector<bool>& chosen) const {
  return cut(std::vector<std::uint8_t>(chosen.begin(), chosen.end()));
}

ElementMesh ElementMesh::cut(std::span<const std::uint8_t> times) const {
  ElementMesh result(*this);
  result.place_.clear();
  std::vector<Place> clusters;
  for (std::uint32_t r = 0; r < roots_.size(); ++r) result.roots_[r].first_element = no_index;
  for (std::uint32_t element = 0; element < count(); ++element) {
    const Place& place = place_[element];
    ElementRoot& root = result.roots_[place.root];
    if (root.divisions == 0) {
      clusters.push_back(place);
      continue;
    }
    if (root.first_element == no_index) root.first_element = static_cast<std::uint32_t>(result.place_.size());
    const auto descend = [&](const auto& self, const ElementCell& part, std::uint32_t level, int left) -> void {
      if (left == 0 || 2 * part.divisions > most_divisions) {
        result.place_.push_back({place.root, pack(part, level)});
        return;
      }
      for (int child = 0; child < 4; ++child) self(self, child_cell(part, child), level + 1, left - 1);
    };
    descend(descend, cell(element), level_of(place.cell), times[element]);
  }
  const auto first_cluster = static_cast<std::uint32_t>(result.place_.size());
  for (std::size_t k = 0; k < member_.size(); ++k) {
    ElementRoot& root = result.roots_[member_[k]];
    root.first_element = first_cluster + place_[roots_[member_[k]].first_element].cell;
  }
  result.place_.insert(result.place_.end(), clusters.begin(), clusters.end());
  result.index_cells();
  result.measure();
  return result;
}

ElementMesh::Saved ElementMesh::save() const {
  Saved saved;
  saved.area = area_;
  for (const ElementRoot& root : roots_) {
    const std::uint32_t surface = root.shape << 1 | root.side;
    if (saved.surface.empty() || saved.surface.back() != surface) saved.surface.push_back(surface);
    saved.divisions.push_back(root.divisions);
    if (root.divisions == 0) saved.cluster.push_back(place_[root.first_element].cell);
  }
  if (cells_.empty()) return saved;  // refined roots only
  for (std::size_t element = 0; element + cluster_count() < count(); ++element)
    saved.level.push_back(static_cast<std::uint8_t>(level_of(place_[element].cell)));
  return saved;
}

std::optional<ElementMesh> ElementMesh::restore(std::span<const Shape> shapes,
                                                std::span<const Material> materials, const Saved& saved) {
  std::vector<ElementRoot> roots;
  for (std::size_t k = 0; k < saved.surface.size(); ++k) {
    const std::uint32_t shape = saved.surface[k] >> 1;
    if (shape >= shapes.size() || (k > 0 && saved.surface[k] <= saved.surface[k - 1])) return std::nullopt;
    const std::size_t primitives = piece_count(shapes[shape].geometry);
    if (primitives > saved.divisions.size() - roots.size()) return std::nullopt;
    for (std::uint32_t primitive = 0; primitive < primitives; ++primitive)
      roots.push_back(
          {shape, primitive, 0, no_index, saved.divisions[roots.size()], saved.surface[k] & 1u ? back : front});
  }
  if (roots.size() != saved.divisions.size()) return std::nullopt;

  std::vector<std::uint32_t> cluster_of_root(saved.cluster.empty() ? 0 : roots.size(), no_index);
  std::vector<bool> is_known(saved.cluster.size(), false);
  std::size_t members = 0, cells = 0;
  for (std::size_t r = 0; r < roots.size(); ++r) {
    if (roots[r].divisions > most_divisions) return std::nullopt;
    cells += cell_count(roots[r]);
    if (roots[r].divisions > 0) continue;
    if (members == saved.cluster.size() || saved.cluster[members] >= is_known.size()) return std::nullopt;
    cluster_of_root[r] = saved.cluster[members];
    is_known[saved.cluster[members++]] = true;
  }
  const auto clusters = static_cast<std::size_t>(std::count(is_known.begin(), is_known.end(), true));
  // Numbered without gaps: the first so many are the known ones.
  if (members != saved.cluster.size() ||
      std::find(is_known.begin(), is_known.end(), false) - is_known.begin() !=
          static_cast<std::ptrdiff_t>(clusters))
    return std::nullopt;
  const std::size_t elements = (saved.level.empty() ? cells : saved.level.size()) + clusters;
  if (elements != saved.area.size() || (!saved.level.empty() && cells > saved.level.size()))
    return std::nullopt;
  for (const float area : saved.area)
    if (!(area >= 0.0f && std::isfinite(area))) return std::nullopt;

  std::optional<ElementMesh> mesh(std::in_place, shapes, materials, std::move(roots), cluster_of_root);
  if (!saved.level.empty() && !mesh->refine(saved.level)) return std::nullopt;
  mesh->area_ = saved.area;
  return mesh;
}

// Splits a mesh of grids so that its elements have these levels: in the order of elements, which is depth
// first, they say all. False: they are no such order.
bool ElementMesh::refine(const std::vector<std::uint8_t>& level) {
  std::vector<Place> grid;
  std::swap(grid, place_);
  std::size_t next = 0;
  const auto descend = [&](const auto& self, std::uint32_t root, const ElementCell& whole,
                           std::uint32_t depth) -> bool {
    if (next == level.size() || level[next] < depth) return false;
    if (level[next] == depth) {
      place_.push_back({root, pack(whole, depth)});
      ++next;
      return true;
    }
    if (2 * whole.divisions > most_divisions) return false;
    for (int child = 0; child < 4; ++child)
      if (!self(self, root, child_cell(whole, child), depth + 1)) return false;
    return true;
  };
  const std::size_t clusters = cluster_count();
  for (std::size_t k = 0; k + clusters < grid.size(); ++k) {
    const std::uint32_t r = grid[k].root;
    if (k == 0 || grid[k - 1].root != r) roots_[r].first_element = static_cast<std::uint32_t>(place_.size());
    if (!descend(descend, r, unpack(grid[k].cell, roots_[r].divisions), 0)) return false;
  }
  if (next != level.size()) return false;
  for (const std::uint32_t r : member_)
    roots_[r].first_element += static_cast<std::uint32_t>(next + clusters - grid.size());
  place_.insert(place_.end(), grid.end() - static_cast<std::ptrdiff_t>(clusters), grid.end());
  index_cells();
  measure();
  return true;
}

// Builds the quad-trees of the roots whose elements are not just the cells of its grid.
void ElementMesh::index_cells() {
  cells_.clear();
  for (std::uint32_t element = 0; element < count(); ++element) {
    ElementRoot& root = roots_[place_[element].root];
    if (root.divisions == 0) continue;
    if (element == root.first_element) {
      std::uint32_t last = element;
      while (last < count() && place_[last].root == place_[element].root) ++last;
      const bool is_grid = last - element == cell_count(root);
      root.first_cell = is_grid ? no_index : static_cast<std::uint32_t>(cells_.size());
      if (!is_grid) cells_.resize(cells_.size() + cell_count(root), 0);
    }
    if (root.first_cell == no_index) continue;
    // The way down from the grid to the element, from its end.
    std::array<std::uint32_t, 32> child{};
    ElementCell top = cell(element);
    const std::uint32_t level = level_of(place_[element].cell);
    for (std::uint32_t l = level; l > 0; --l) {
      const Parent parent = parent_of(top);
      child[l] = static_cast<std::uint32_t>(parent.child);
      top = parent.cell;
    }
    std::size_t node = root.first_cell + cell_index(top.column, top.row, top.inverted, top.divisions);
    for (std::uint32_t l = 1; l <= level; ++l) {
      if (!(cells_[node] & refined)) {
        cells_[node] = static_cast<std::uint32_t>(cells_.size()) | refined;
        cells_.resize(cells_.size() + 4, 0);
      }
      node = (cells_[node] & ~refined) + child[l];
    }
    cells_[node] = element;
  }
}

ElementMesh::Location ElementMesh::find_in_root(std::uint32_t root_index, float u, float v) const {
  const ElementRoot& root = roots_[root_index];
  if (root.divisions == 0) return {root.first_element, root_index, u, v};
  const auto divisions = static_cast<std::int32_t>(root.divisions);
  const float x = std::clamp(u, 0.0f, 1.0f) * static_cast<float>(divisions);
  const float y = std::clamp(v, 0.0f, 1.0f) * static_cast<float>(divisions);
  const std::int32_t row = std::min(static_cast<std::int32_t>(y), divisions - 1);
  const std::int32_t column = std::min(static_cast<std::int32_t>(x), divisions - 1 - row);
  const float fx = x - static_cast<float>(column), fy = y - static_cast<float>(row);
  // The last cell of a row has no partner: rounding beyond the third edge stays in it.
  const bool inverted = fx + fy > 1.0f && column + row < divisions - 1;
  const std::uint32_t cell = cell_index(static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(row),
                                        inverted, static_cast<std::uint32_t>(divisions));
  Location location{root.first_element + cell, root_index, inverted ? 1.0f - fx : fx,
                    inverted ? 1.0f - fy : fy};
  if (root.first_cell == no_index) return location;
  std::uint32_t node = cells_[root.first_cell + cell];
  while (node & refined) {
    const std::uint32_t child = enter_quarter(location.u, location.v);
    node = cells_[(node & ~refined) + child];
  }
  location.element = node;
  return location;
}

ElementMesh::Location ElementMesh::find_on_surface(std::uint32_t base, const SurfacePoint& point) const {
  const PieceLocation at = locate_piece(shapes_[point.shape].geometry, point.position);
  return find_in_root(base + at.piece, at.u, at.v);
}

std::span<const std::uint32_t> ElementMesh::members(std::uint32_t cluster_element) const {
  const std::uint32_t cluster = place_[cluster_element].cell;
  return {member_.data() + first_member_[cluster], member_.data() + first_member_[cluster + 1]};
}

ElementCell ElementMesh::cell(std::uint32_t element) const {
  return unpack(place_[element].cell, root(element).divisions);
}

V3d ElementMesh::grid_point(const ElementRoot& root, const V2i& numerators, std::uint32_t divisions) const {
  return piece_grid_point(shapes_[root.shape].geometry, root.primitive, numerators, divisions);
}

Patch ElementMesh::root_patch(const ElementRoot& root) const {
  return piece_patch(shapes_[root.shape].geometry, root.primitive, root.side);
}

Patch ElementMesh::cell_patch(const ElementRoot& root, const ElementCell& cell) const {
  return twopass::cell_patch(shapes_[root.shape].geometry, root.primitive, cell_corners(cell), cell.divisions,
                             root.side);
}

Patch ElementMesh::patch(std::uint32_t element, std::size_t k) const {
  return is_cluster(element) ? root_patch(roots_[members(element)[k]])
                             : cell_patch(root(element), cell(element));
}

double ElementMesh::whole_area(std::uint32_t element) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < patch_count(element); ++k) sum += patch(element, k).area;
  return sum;
}

std::array<std::uint8_t, 2> ElementMesh::Weights::packed(float u, float v) {
  const auto byte = [](float x) {
    return static_cast<std::uint8_t>(std::clamp(x, 0.0f, 1.0f) * 255.0f + 0.5f);
  };
  return {byte(u), byte(v)};
}

ElementMesh::Sixteenth ElementMesh::sixteenth_at(const Location& location) {
  float u = location.u, v = location.v;
  const std::uint32_t quarter = enter_quarter(u, v);
  const std::uint32_t number = 4 * quarter + enter_quarter(u, v);
  return {number, u, v};
}

ElementPoint ElementMesh::sample(std::uint32_t element, const V2f& u) const {
  if (is_even_cell(element)) return patch(element).sample(u);
  if (!is_cluster(element)) {
    const Weights& weights = weights_[element];
    const auto& count = weights.count;
    float left = u.x * static_cast<float>(std::accumulate(count.begin(), count.end(), 0u));
    int chosen = -1;
    for (int k = 0; k < 16; ++k) {
      if (count[k] == 0) continue;
      if (chosen >= 0 && left < static_cast<float>(count[chosen])) break;
      if (chosen >= 0) left -= static_cast<float>(count[chosen]);
      chosen = k;
    }
    V2f place(static_cast<float>(weights.place[chosen][0]) / 255.0f,
              static_cast<float>(weights.place[chosen][1]) / 255.0f);
    // Seen from the back, corners 1 and 2 are the other way round.
    if (root(element).side == back) std::swap(place.x, place.y);
    const ElementCell part = child_cell(child_cell(cell(element), chosen / 4), chosen % 4);
    return cell_patch(root(element), part).at(place);
  }
  const std::uint32_t cluster = place_[element].cell;
  const auto first = member_share_.begin() + first_member_[cluster];
  const auto last = member_share_.begin() + first_member_[cluster + 1];
  const auto member = std::min(std::upper_bound(first, last, u.x), last - 1);
  const float before = member == first ? 0.0f : *(member - 1), share = *member - before;
  const float remapped = share > 0.0f ? std::min((u.x - before) / share, 0x1.fffffep-1f) : 0.5f;
  return patch(element, static_cast<std::size_t>(member - first)).sample({remapped, u.y});
}

void ElementMesh::expose(std::span<const float> fraction) {
  for (std::size_t i = 0; i < area_.size(); ++i) area_[i] *= fraction[i];
}

std::size_t ElementMesh::memory_bytes() const {
  return roots_.size() * sizeof(ElementRoot) + count() * (sizeof(Place) + sizeof(float)) +
         count() * sizeof(reflectance_[0]) + weights_.size() * sizeof(Weights) +
         shapes_.size() * sizeof(first_root_[0]) +
         (cells_.size() + first_member_.size() + member_.size() + member_share_.size()) * sizeof(std::uint32_t);
}

}  // namespace twopass
