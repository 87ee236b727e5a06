#include "radiosity/indirect_field.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <numeric>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "radiosity/indirect_gathering.h"
#include "radiosity/lamp_light.h"
#include "radiosity/smoothing.h"
#include "radiosity/vertex_mesh.h"
#include "render/core/interrupt.h"
#include "render/core/parallel.h"

namespace twopass {

namespace {

// Faces with less of their area exposed than this reach under something.
constexpr double whole = 0.999;
// Corners that differ by more than this factor have an edge of light or a wall between them.
constexpr double most_contrast = 2.0;
// The most that parts of elements may receive from elements that are nearer than they resolve, of all light.
constexpr double most_nearby = 0.3;
// Rays from a vertex, beyond which the solution's own errors are what is left.
constexpr double most_worth = 4096.0;
// How often a cell is divided into four.
constexpr int most_levels = 3;

using Corners = std::array<C3f, 3>;
bool is_black(const Corners& corners) {
  return std::all_of(corners.begin(), corners.end(), [](const C3f& c) { return twopass::is_black(c); });
}

// The part of a flat patch between three places of it that were rounded: in its plane again, or the surface
// itself would hide it.
Polygon part_of(const Patch& patch, std::array<V3d, 3> corner) {
  for (V3d& c : corner) c -= patch.normal * patch.normal.dot(c - patch.corner[0]);
  // Cells are in the order of the front, the patch may be a back.
  if ((corner[1] - corner[0]).cross(corner[2] - corner[0]).dot(patch.normal) < 0.0)
    std::swap(corner[1], corner[2]);
  return make_polygon(corner[0], corner[1], corner[2]);
}

// (R43): what the lamps send to the corners of a flat polygon, if that is certain and linear in between but for
// the given part of all the light. `indirect`: at the corners.
std::optional<Corners> direct_of(const Polygon& polygon, const V3d& normal, const std::array<V3d, 3>& corner,
                                 const LampLight& lamps, const Corners& indirect, double tolerance) {
  const auto seen = lamps.seen_from(polygon);
  if (!seen) return std::nullopt;
  std::array<C3d, 3> at;
  for (std::size_t k = 0; k < 3; ++k) at[k] = lamps.irradiance(corner[k], normal, *seen);
  const auto is_linear_at = [&](const V3d& weight) {
    V3d point(0.0);
    C3d linear(0.0), others(0.0);
    for (std::size_t k = 0; k < 3; ++k) {
      const double w = weight[static_cast<int>(k)];
      point += corner[k] * w;
      linear += at[k] * w;
      others += C3d(indirect[k]) * w;
    }
    const C3d truth = lamps.irradiance(point, normal, *seen);
    return brightness(C3d(std::abs(linear.x - truth.x), std::abs(linear.y - truth.y),
                          std::abs(linear.z - truth.z))) <= tolerance * brightness(truth + others);
  };
  const V3d middles[] = {V3d(0.5, 0.5, 0), V3d(0, 0.5, 0.5), V3d(0.5, 0, 0.5), V3d(1.0 / 3.0)};
  if (*seen != 0 && !std::all_of(std::begin(middles), std::end(middles), is_linear_at)) return std::nullopt;
  return Corners{C3f(at[0]), C3f(at[1]), C3f(at[2])};
}

// An edge of a cell, whichever way it is gone along.
std::uint64_t edge_of(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
}

}  // namespace

// Gathers, judges and divides, level by level.
class IndirectFieldBuilder {
 public:
  IndirectFieldBuilder(const Scene& scene, const Solution& solution, const IndirectFieldOptions& options,
                       IndirectField& field)
      : solution_(solution),
        mesh_(solution.mesh()),
        options_(options),
        field_(field),
        vertices_(mesh_),
        gathering_(scene, solution, position_, options),
        lamps_(scene) {}

  void build() {
    std::vector<std::uint32_t> pending = begin();
    for (int level = 0; !pending.empty(); ++level) {
      judge(pending);
      if (level == most_levels) break;
      pending = divide(pending, level);
    }
    field_.elements_ = faces();
    field_.rays_ = rays_;
    finish();
  }

 private:
  // What a look-up may make of a cell.
  enum class Verdict : std::uint8_t {
    unknown,
    trusted,
    too_coarse,  // smaller cells may be trusted
    never
  };

  [[nodiscard]] std::uint32_t faces() const { return static_cast<std::uint32_t>(vertices_.faces().cells); }

  // The elements as cells, gathered at where somebody looks. Returns those to be judged.
  std::vector<std::uint32_t> begin() {
    const std::size_t count = vertices_.count();
    for (std::uint32_t v = 0; v < count; ++v) position_.emplace_back(vertices_.position(v));
    for (std::uint32_t f = 0; f < faces(); ++f) cells_.push_back({f, vertices_.faces().corner[f]});
    grow();
    for (const Irradiance& smooth : vertex_irradiance(vertices_, mesh_, solution_.irradiances()))
      direct_brightness_.push_back(brightness(C3d(smooth.direct)));
    std::vector<std::uint32_t> wanted;
    // Which vertices are gathered at: the corners of wanted faces, and in place of those that hang their ends.
    std::vector<std::uint8_t> gathers(count, 0), hangs(count, 0);
    for (std::uint32_t f = 0; f < faces(); ++f) {
      if (!options_.wanted.empty() && !options_.wanted[f]) continue;
      wanted.push_back(f);
      for (const std::uint32_t v : cells_[f].corner) gathers[v] = 1;
    }
    for (auto h = vertices_.hanging().rbegin(); h != vertices_.hanging().rend(); ++h) {
      hangs[h->vertex] = 1;
      if (gathers[h->vertex]) gathers[h->from] = gathers[h->to] = 1;
    }
    gathered_.resize(count);
    std::vector<std::uint32_t> places;
    for (std::uint32_t v = 0; v < count; ++v)
      if (gathers[v] && !hangs[v]) places.push_back(v);
    most_rays_ = most_rays(places.size());
    add_shares(cells_, 0);
    for (const std::uint32_t v : places)
      mean_root_ += std::sqrt(share_[v]) / static_cast<double>(places.size());
    gather(places, cells_);
    for (const VertexMesh::Hanging& h : vertices_.hanging())
      if (gathers[h.vertex])
        gathered_[h.vertex] = between(gathered_[h.from], gathered_[h.to], static_cast<double>(h.t));
    find_caustics();
    return wanted;
  }

  // What part of the picture depends on a vertex.
  void add_shares(std::span<const FieldCell> cells, int level) {
    share_.resize(position_.size(), 0.0);
    if (options_.parts.empty()) return;
    for (const FieldCell& cell : cells)
      for (const std::uint32_t v : cell.corner)
        share_[v] += options_.parts[cell.face] / (3.0 * std::pow(4.0, level));
  }

  // (R55)
  [[nodiscard]] std::uint32_t most_rays_from(std::uint32_t v) const {
    if (!(mean_root_ > 0.0)) return most_rays_;
    // Numbers are doubled: to the nearest of them.
    const double rays = std::sqrt(2.0) * most_rays_ * std::sqrt(share_[v]) / mean_root_;
    return std::bit_floor(static_cast<std::uint32_t>(
        std::clamp(rays, static_cast<double>(std::min(options_.least_rays, most_rays_)),
                   std::max(most_worth, static_cast<double>(most_rays_)))));
  }

  // From each of so many vertices.
  [[nodiscard]] std::uint32_t most_rays(std::size_t vertices) const {
    if (vertices == 0) return options_.most_rays;
    const double affordable = std::min(options_.affordable_rays / static_cast<double>(vertices), most_worth);
    return std::max(options_.most_rays, std::bit_floor(static_cast<std::uint32_t>(affordable)));
  }

  // The vertices that see a caustic, and those that share a face with one: rays find caustics by chance, so
  // that some vertices in the midst of one miss it.
  void find_caustics() {
    near_caustic_.assign(position_.size(), false);
    std::vector<bool> sees(position_.size());
    for (std::size_t v = 0; v < sees.size(); ++v) sees[v] = gathered_[v].sees_caustic(direct_brightness_[v]);
    for (const FieldCell& cell : cells_)
      if (std::ranges::any_of(cell.corner, [&](std::uint32_t v) { return sees[v]; }))
        for (const std::uint32_t v : cell.corner) near_caustic_[v] = true;
  }

  void gather(std::span<const std::uint32_t> places, std::span<const FieldCell> around) {
    const Fans fans(around, position_.size());
    std::atomic<std::uint64_t> rays{0};
    parallel_for(places.size(), 16, [&](std::size_t begin, std::size_t end) {
      throw_if_interrupted();
      std::uint64_t cast = 0;
      for (std::size_t i = begin; i < end; ++i)
        gathered_[places[i]] = gathering_.at(places[i], around, fans, direct_brightness_[places[i]],
                                             most_rays_from(places[i]), cast);
      rays += cast;
    });
    rays_ += rays;
  }

  void judge(std::span<const std::uint32_t> pending) {
    std::atomic<std::uint64_t> rays{0};
    parallel_for(pending.size(), 64, [&](std::size_t begin, std::size_t end) {
      throw_if_interrupted();
      std::uint64_t cast = 0;
      for (std::size_t i = begin; i < end; ++i) judge(pending[i], cast);
      rays += cast;
    });
    rays_ += rays;
  }

  void judge(std::uint32_t c, std::uint64_t& rays) {
    const FieldCell& cell = cells_[c];
    for (std::size_t k = 0; k < 3; ++k) field_.value_[c][k] = C3f(gathered_[cell.corner[k]].mean());
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t k = 0; k < 3; ++k)
        field_.across_[c][axis][k] = C3f(gathered_[cell.corner[k]].mean_across(axis));
    verdict_[c] = verdict_of(c, rays);
    const bool is_trusted = verdict_[c] == Verdict::trusted;
    const auto direct = options_.with_direct && lamps_.is_known() ? direct_of(c) : std::nullopt;
    if (is_trusted) field_.known_[c] = direct ? Known::all : Known::indirect;
    if (!is_trusted && direct && is_black(*direct)) field_.known_[c] = Known::no_direct;
    if (!is_trusted || !direct) return;
    field_.direct_[c] = *direct;
    for (std::size_t k = 0; k < 3; ++k) field_.value_[c][k] += (*direct)[k];
  }

  [[nodiscard]] std::optional<Corners> direct_of(std::uint32_t c) const {
    const Patch patch = mesh_.patch(cells_[c].face);
    if (patch.is_analytic() || !(patch.area > 0.0)) return std::nullopt;
    const std::array<V3d, 3> corner = gathering_.corners(cells_[c]);
    return twopass::direct_of(c < faces() ? patch.polygon() : part_of(patch, corner), patch.normal, corner,
                              lamps_, field_.value_[c], options_.direct_tolerance);
  }

  // (R40): whether interpolation on the cell is as good as gathering, relative to all the light there.
  Verdict verdict_of(std::uint32_t c, std::uint64_t& rays) {
    const FieldCell& cell = cells_[c];
    const bool is_part = c >= faces();
    if (mesh_.is_analytic(mesh_.root(cell.face).shape)) return Verdict::never;
    const bool is_whole = mesh_.area(cell.face) >= whole * mesh_.whole_area(cell.face);
    if (!is_whole && !is_part) return Verdict::too_coarse;
    double longest = 0.0, nearness = 0.0, noise = 0.0, low = infinity_f, high = 0.0, direct = infinity_f;
    C3d linear(0.0);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = cell.corner[k];
      const Gathered& g = gathered_[v];
      if (near_caustic_[v]) return Verdict::never;
      if (g.rays == 0 || (is_part && g.buried > 0)) return Verdict::too_coarse;
      // Small cells beside large elements see how constant those are.
      if (is_part &&
          brightness(g.nearby) > most_nearby * (direct_brightness_[v] * g.rays + brightness(g.irradiance)))
        return Verdict::never;
      longest = std::max(longest, (position_[cell.corner[(k + 1) % 3]] - position_[v]).length());
      nearness = std::max(nearness, g.inverse_distance / g.rays);
      noise = std::max(noise, g.noise());
      low = std::min(low, brightness(g.mean()));
      high = std::max(high, brightness(g.mean()));
      direct = std::min(direct, direct_brightness_[v]);
      linear += g.mean() / 3.0;
    }
    if (high > most_contrast * low || gathering_.is_crossed(cell, rays)) return Verdict::too_coarse;
    const double bend = longest * nearness;
    const double error = high > 0.0 ? (high * bend * bend / 8.0 + noise) / (direct + low) : 0.0;
    if (error <= options_.tolerance && is_whole) return Verdict::trusted;
    // What is doubted is looked at: distances are those from corners, where walls that meet are always near.
    const Gathered middle = gathering_.in_the_middle(cell, c, direct, rays);
    if (middle.sees_caustic(direct)) return Verdict::never;
    if (middle.rays == 0 || (is_part && middle.buried > 0)) return Verdict::too_coarse;
    const C3d found = middle.mean(), off = linear - found;
    const double difference = brightness(C3d(std::abs(off.x), std::abs(off.y), std::abs(off.z)));
    return difference <= options_.middle_tolerance * (direct + brightness(found)) ? Verdict::trusted
                                                                                  : Verdict::too_coarse;
  }

  // Divides the cells that are too coarse where that pays, and gathers at the new vertices. Returns the new
  // cells (R53).
  std::vector<std::uint32_t> divide(std::span<const std::uint32_t> pending, int level) {
    for (const std::uint32_t c : pending)
      if (verdict_[c] == Verdict::trusted)
        for (std::size_t k = 0; k < 3; ++k)
          straight_.insert(edge_of(cells_[c].corner[k], cells_[c].corner[(k + 1) % 3]));
    const auto first = static_cast<std::uint32_t>(cells_.size());
    std::vector<std::uint32_t> fresh;
    for (const std::uint32_t c : pending) {
      if (verdict_[c] != Verdict::too_coarse || options_.parts.empty()) continue;
      const double affordable = options_.dividing_rays * options_.parts[cells_[c].face];
      if (affordable < rays_of_division() * std::pow(4.0, level)) continue;
      field_.child_[c] = static_cast<std::uint32_t>(cells_.size());
      const auto [face, corner] = cells_[c];
      std::array<std::uint32_t, 3> middle;  // of the edges from each corner to the next
      for (std::size_t k = 0; k < 3; ++k) middle[k] = middle_of(corner[k], corner[(k + 1) % 3], fresh);
      cells_.push_back({face, {corner[0], middle[0], middle[2]}});
      cells_.push_back({face, {middle[0], corner[1], middle[1]}});
      cells_.push_back({face, {middle[2], middle[1], corner[2]}});
      cells_.push_back({face, {middle[1], middle[2], middle[0]}});
      grow();
    }
    const auto made = std::span(cells_).subspan(first);
    add_shares(made, level + 1);
    gather(fresh, made);
    for (const std::uint32_t v : fresh) near_caustic_[v] = gathered_[v].sees_caustic(direct_brightness_[v]);
    std::vector<std::uint32_t> divided(made.size());
    std::iota(divided.begin(), divided.end(), first);
    return divided;
  }

  // The vertex between two others, made if there is none. On the edge of a cell that is looked up as it is, it
  // has what that interpolates there, so that there is no seam.
  std::uint32_t middle_of(std::uint32_t a, std::uint32_t b, std::vector<std::uint32_t>& fresh) {
    const auto [entry, is_new] =
        middle_.try_emplace(edge_of(a, b), static_cast<std::uint32_t>(position_.size()));
    const std::uint32_t v = entry->second;
    if (!is_new) return v;
    position_.push_back((position_[a] + position_[b]) * 0.5);
    direct_brightness_.push_back(0.5 * (direct_brightness_[a] + direct_brightness_[b]));
    near_caustic_.push_back(false);
    gathered_.emplace_back();
    if (straight_.count(edge_of(a, b)) == 0) {
      fresh.push_back(v);
      return v;
    }
    gathered_[v] = between(gathered_[a], gathered_[b], 0.5);
    straight_.insert(edge_of(a, v));
    straight_.insert(edge_of(v, b));
    return v;
  }

  void grow() {
    const Corners black{C3f(0.0f), C3f(0.0f), C3f(0.0f)};
    field_.value_.resize(cells_.size(), black);
    field_.direct_.resize(cells_.size(), black);
    field_.across_.resize(cells_.size(), {black, black, black});
    field_.known_.resize(cells_.size(), Known::nothing);
    field_.child_.resize(cells_.size(), 0);
    verdict_.resize(cells_.size(), Verdict::unknown);
  }

  // What is known of all parts of a cell is known of the cell; what part of all elements that is.
  void finish() {
    for (std::size_t c = cells_.size(); c-- > 0;)
      if (const std::uint32_t child = field_.child_[c])
        field_.known_[c] = *std::min_element(&field_.known_[child], &field_.known_[child] + 4);
    double area = 0.0;
    for (std::uint32_t f = 0; f < mesh_.count(); ++f) area += mesh_.area(f);
    if (!(area > 0.0)) return;
    std::vector<double> part(cells_.size());
    for (std::uint32_t c = 0; c < cells_.size(); ++c) {
      if (c < faces()) part[c] = mesh_.area(c) / area;
      if (const std::uint32_t child = field_.child_[c]) {
        std::fill_n(&part[child], 4, part[c] / 4.0);
        continue;
      }
      for (int k = 0; k <= static_cast<int>(field_.known_[c]); ++k)
        field_.share_[static_cast<std::size_t>(k)] += part[c];
    }
  }

  // So many rays a division has to be worth: eleven times those of a vertex and a half and of four middles, for
  // it saves only a part of the rays that start there, and what it makes may not be trusted either.
  [[nodiscard]] double rays_of_division() const { return 11.0 * (1.5 * most_rays_ + 4.0 * options_.most_rays); }

  const Solution& solution_;
  const ElementMesh& mesh_;
  const IndirectFieldOptions& options_;
  IndirectField& field_;
  const VertexMesh vertices_;
  // By vertex.
  std::vector<V3d> position_;
  std::vector<double> direct_brightness_;  // of the light of lamps there
  std::vector<Gathered> gathered_;
  std::vector<bool> near_caustic_;
  std::vector<double> share_;    // of the picture, see add_shares()
  double mean_root_ = 0.0;       // of the shares of all that are gathered at first
  std::uint32_t most_rays_ = 0;  // from one with the mean root
  // By cell: elements, then parts of them, four for each that is divided.
  std::vector<FieldCell> cells_;
  std::vector<Verdict> verdict_;
  Gathering gathering_;
  LampLight lamps_;
  std::unordered_map<std::uint64_t, std::uint32_t> middle_;  // by edge
  std::unordered_set<std::uint64_t> straight_;               // edges on which light is linear
  std::uint64_t rays_ = 0;
};

IndirectField::IndirectField(const Scene& scene, const Solution& solution, const IndirectFieldOptions& options)
    : mesh_(&solution.mesh()) {
  IndirectFieldBuilder(scene, solution, options, *this).build();
}

C3f IndirectField::direct_at(const ElementMesh::Location& location) const {
  if (location.element >= elements_) return C3f(0.0f);
  const Place place = place_of(location);
  return interpolated(direct_[place.cell], place);
}

C3f IndirectField::tilted(const C3f& irradiance, const ElementMesh::Location& location, const V3f& flat,
                          const V3f& normal) const {
  const Place place = place_of(location);
  const float cosine = normal.dot(flat);
  C3f sum = irradiance * (0.5f + 0.5f * cosine);
  for (std::size_t axis = 0; axis < 3; ++axis)
    sum += interpolated(across_[place.cell][axis], place) * normal[static_cast<int>(axis)];
  return {std::max(sum.x, 0.0f), std::max(sum.y, 0.0f), std::max(sum.z, 0.0f)};
}

C3f IndirectField::indirect_at_any(const SurfacePoint& point) const {
  const ElementMesh::Location location = mesh_->locate(point);
  if (location.element >= elements_) return C3f(0.0f);
  const Place place = place_of(location);
  return interpolated(value_[place.cell], place);
}

}  // namespace twopass
