#include "radiosity/guide.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <compare>
#include <limits>
#include <numeric>
#include <utility>

#include "materials/lobes.h"
#include "radiosity/specular_path.h"
#include "render/core/distribution.h"
#include "render/core/parallel.h"
#include "render/core/sampler.h"
#include "render/core/warp.h"

namespace twopass {

namespace {

constexpr int rows = Guide::rows, columns = Guide::columns, bins = rows * columns;
// Where light comes from few bins, so many times as many rays look for it, or fewer where there are many cells.
constexpr std::size_t most_rounds = 4;
constexpr float concentrated = 0.3f;  // evenness() below which it does

// Cumulative distributions are in units of what makes the whole one more than their words hold; the last entry
// stands for the whole.
template <class Word>
constexpr float whole = static_cast<float>(std::numeric_limits<Word>::max()) + 1.0f;

// The interval that holds x in [0, whole).
template <class Word, std::size_t n>
int find_bin(const std::array<Word, n>& cumulative, float x) {
  const auto at = static_cast<Word>(x);
  Word bin = 0;
  for (const Word entry : cumulative)
    bin += entry <= at ? 1 : 0;  // in a few instructions, and none to mispredict
  return std::min<int>(bin, static_cast<int>(n) - 1);
}

struct Interval {
  float begin, width;
};
template <class Word, std::size_t n>
Interval interval_of(const std::array<Word, n>& cumulative, int bin) {
  const auto i = static_cast<std::size_t>(bin);
  const float begin = i == 0 ? 0.0f : static_cast<float>(cumulative[i - 1]);
  const float end = i == n - 1 ? whole<Word> : static_cast<float>(cumulative[i]);
  return {begin, end - begin};
}

// Bins are of equal area on the square and the square's density is cosine / pi (R41).
float density(const Interval& row, const Interval& column, float cosine) {
  constexpr float scale = static_cast<float>(bins) / (whole<std::uint16_t> * whole<std::uint8_t>);
  return row.width * column.width * scale * cosine_hemisphere_pdf_w(cosine);
}

// Where in a bin, on an edge of n bins.
template <int n>
float within(const Interval& interval, float x, int bin) {
  return (static_cast<float>(bin) + std::min((x - interval.begin) / interval.width, 0x1.fffffep-1f)) *
         (1.0f / static_cast<float>(n));
}

// The sector of the vector (x, y), as `circle` goes around; without its angle.
int sector_of(float x, float y) {
  static_assert(columns == 32);
  constexpr float tangents[] = {0.198912367f, 0.414213562f, 0.668178638f};  // of 1, 2, 3 / 16 pi
  const float a = std::abs(x), b = std::abs(y);
  int k = b > a ? 1 : 0;
  for (const float tangent : tangents) k += (b > tangent * a ? 1 : 0) + (tangent * b > a ? 1 : 0);
  if (y >= 0.0f) return x >= 0.0f ? k : 15 - k;
  return x >= 0.0f ? 31 - k : 16 + k;
}

// The share of each bin, at least one unit, as a cumulative distribution. REQUIRES: positive weights.
template <class Word, std::size_t n>
void quantise(const float* weight, std::array<Word, n>& cumulative) {
  constexpr int units = int{std::numeric_limits<Word>::max()} + 1, count = static_cast<int>(n);
  const double total = std::accumulate(weight, weight + n, 0.0);
  double sum = 0.0;
  int before = 0;
  for (int i = 0; i < count - 1; ++i) {
    sum += weight[i];
    const int rounded = static_cast<int>(sum / total * units + 0.5);
    before = std::clamp(rounded, before + 1, units - (count - 1 - i));
    cumulative[static_cast<std::size_t>(i)] = static_cast<Word>(before);
  }
  cumulative[n - 1] = std::numeric_limits<Word>::max();
}

// The axis nearest to a normal. Of nearly equal ones always the same, whatever the rounding.
int nearest_axis(const V3f& n) {
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(n[k]) > 1.001f * std::abs(n[axis])) axis = k;
  return axis;
}

// Elements with equal keys share a cell.
struct Key {
  std::uint64_t cube;
  std::uint32_t facing;  // direction of the normal: a face of a cube and a ninth of it
  bool down;             // the sign of the frame is -1
  std::uint32_t within;  // where in the cube: the eighth, and the eighth of that
  [[nodiscard]] bool is_grouped_with(const Key& other) const {
    return cube == other.cube && facing == other.facing && down == other.down;
  }
  friend auto operator<=>(const Key&, const Key&) = default;
};

std::uint32_t facing_of(const V3f& n) {
  const int axis = nearest_axis(n);
  const float length = std::abs(n[axis]);
  if (!(length > 0.0f)) return 0;  // without area there is no normal
  const auto third = [&](float x) {
    return static_cast<std::uint32_t>(std::clamp((x / length + 1.0f) * 1.5f, 0.0f, 2.0f));
  };
  return (static_cast<std::uint32_t>(2 * axis + (n[axis] < 0.0f ? 1 : 0)) * 3 + third(n[(axis + 1) % 3])) * 3 +
         third(n[(axis + 2) % 3]);
}

}  // namespace

int Guide::Lobe::row_of(float u) const {
  const int row = find_bin(cell_->row, u * whole<std::uint16_t>);
  __builtin_prefetch(&cell_->column[static_cast<std::size_t>(row)]);
  return row;
}

Guide::Lobe::Direction Guide::Lobe::sample(const V2f& u, int row) const {
  const auto& in_row = cell_->column[static_cast<std::size_t>(row)];
  const float y = u.y * whole<std::uint16_t>, x = u.x * whole<std::uint8_t>;
  const int column = find_bin(in_row, x);
  const Interval height = interval_of(cell_->row, row), width = interval_of(in_row, column);
  const V3f local =
      square_to_cosine_hemisphere({within<rows>(height, y, row), within<columns>(width, x, column)});
  return {frame_.to_world(local), density(height, width, local.z)};
}

float Guide::Lobe::pdf_w(const V3f& direction) const {
  const V3f local = frame_.to_local(direction);
  if (!(local.z > 0.0f)) return 0.0f;
  const float sin2 = local.x * local.x + local.y * local.y;
  const int row = std::min(static_cast<int>(sin2 * static_cast<float>(rows)), rows - 1);
  return density(interval_of(cell_->row, row),
                 interval_of(cell_->column[static_cast<std::size_t>(row)], sector_of(local.x, local.y)),
                 local.z);
}

std::size_t Guide::memory_bytes() const {
  return place_.size() * sizeof(place_[0]) + cells_.size() * sizeof(cells_[0]);
}

class Guide::Builder {
 public:
  Builder(const Scene& scene, const Solution& solution, const GuideOptions& options, Guide& guide)
      : scene_(scene), solution_(solution), mesh_(solution.mesh()), options_(options), guide_(guide) {}

  void build() {
    std::vector<ElementPoint> middle(mesh_.count());
    parallel_for(mesh_.count(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t e = begin; e < end; ++e) middle[e] = mesh_.centroid(static_cast<std::uint32_t>(e));
    });
    const V3f edges = scene_.bounds().max - scene_.bounds().min;
    float size = options_.cell_size * max_component(edges);
    while (!group(middle, size)) size *= 1.25f;
    fill();
  }

 private:
  // Divides the elements into cells, and those into groups. False: more than may be.
  bool group(const std::vector<ElementPoint>& middle, float size) {
    std::vector<Key> keys(middle.size());
    for (std::size_t e = 0; e < middle.size(); ++e) {
      const V3f normal(middle[e].normal), p = (V3f(middle[e].position) - scene_.bounds().min) * (1.0f / size);
      std::uint64_t cube = 0;
      std::uint32_t within = 0;
      for (int k = 0; k < 3; ++k) {
        const auto x = static_cast<std::uint64_t>(std::clamp(p[k], 0.0f, 8388607.0f));
        cube = cube << 21 | x >> 2;
        within |= static_cast<std::uint32_t>((x >> 1 & 1) << (3 + k) | (x & 1) << k);
      }
      keys[e] = {cube, facing_of(normal), normal.z < -0.5f, within};
    }
    members_.resize(middle.size());
    std::iota(members_.begin(), members_.end(), 0u);
    std::sort(members_.begin(), members_.end(),
              [&](std::uint32_t a, std::uint32_t b) { return keys[a] != keys[b] ? keys[a] < keys[b] : a < b; });
    cells_.clear();
    groups_.clear();
    guide_.place_.resize(middle.size());
    for (std::size_t i = 0; i < members_.size(); ++i) {
      const std::uint32_t e = members_[i];
      const Key& key = keys[e];
      if (i == 0 || key != keys[members_[i - 1]]) {
        if (i == 0 || !key.is_grouped_with(keys[members_[i - 1]])) groups_.push_back(cells_.size());
        cells_.push_back({i, key.within >> 3});
      }
      guide_.place_[e] = {static_cast<std::uint32_t>(cells_.size() - 1), key.down ? -1.0f : 1.0f};
    }
    const std::size_t cells = cells_.size();
    groups_.push_back(cells);
    cells_.push_back({members_.size(), 0});
    return cells <= options_.max_cells || size > 8.0f * max_component(scene_.bounds().size());
  }

  [[nodiscard]] std::span<const std::uint32_t> members(std::size_t cell) const {
    return {members_.data() + cells_[cell].first, cells_[cell + 1].first - cells_[cell].first};
  }
  [[nodiscard]] bool is_wanted(std::size_t cell) const {
    if (options_.wanted.empty()) return true;
    const auto all = members(cell);
    return std::any_of(all.begin(), all.end(), [&](std::uint32_t e) { return options_.wanted[e]; });
  }
  void leave_empty(std::size_t cell) {
    for (const std::uint32_t e : members(cell)) guide_.place_[e].sign = 0.0f;
  }

  void fill() {
    guide_.cells_.resize(cells_.size() - 1);
    std::atomic<std::uint64_t> rays{0};
    parallel_for(groups_.size() - 1, 1, [&](std::size_t begin, std::size_t end) {
      std::uint64_t own = 0;
      for (std::size_t group = begin; group < end; ++group) fill_group(groups_[group], groups_[group + 1], own);
      rays += own;
    });
    guide_.rays_ = rays;
  }

  using Weights = std::array<float, bins>;
  static float sum_of(const Weights& weights) { return std::accumulate(weights.begin(), weights.end(), 0.0f); }
  // Adds the one to the other, scaled to a sum of 1. One without light adds nothing.
  static void add(const Weights& squares, Weights& sum) {
    const float total = sum_of(squares);
    if (!(total > 0.0f)) return;
    for (std::size_t i = 0; i < bins; ++i) sum[i] += squares[i] * (1.0f / total);
  }
  // Each bin with its eight neighbours, 1 2 1 in both directions, around the normal and beyond the last row.
  static Weights blurred(const Weights& weights) {
    Weights in_rows, both;
    for (std::size_t r = 0; r < rows; ++r)
      for (std::size_t c = 0; c < columns; ++c) {
        const float* const row = &weights[r * columns];
        in_rows[r * columns + c] = 2.0f * row[c] + row[(c + 1) % columns] + row[(c + columns - 1) % columns];
      }
    for (std::size_t r = 0; r < rows; ++r)
      for (std::size_t c = 0; c < columns; ++c) {
        const std::size_t below = r == 0 ? 0 : r - 1, above = std::min<std::size_t>(r + 1, rows - 1);
        both[r * columns + c] =
            2.0f * in_rows[r * columns + c] + in_rows[below * columns + c] + in_rows[above * columns + c];
      }
    return both;
  }

  // What is known of a group: sums of squares of what arrives, by bin.
  struct Squares {
    std::vector<Weights> own;  // by cell
    std::array<Weights, 8> eighth{};
    Weights whole{};
  };
  // 1 where the light of all bins is even, 1 / bins where it comes from one.
  static float evenness(const Weights& squares) {
    float roots = 0.0f;
    for (const float s : squares) roots += std::sqrt(s);
    return roots * roots / (static_cast<float>(bins) * sum_of(squares));
  }

  // The cells of a group learn from each other (R42): few rays would miss in one what those of its neighbours
  // have met.
  void fill_group(std::size_t begin, std::size_t end, std::uint64_t& rays) {
    std::vector<std::size_t> cells;
    for (std::size_t cell = begin; cell < end; ++cell)
      if (is_wanted(cell))
        cells.push_back(cell);
      else
        leave_empty(cell);
    std::vector<std::vector<C3f>> radiance;
    C3d mean(0.0);
    std::size_t count = 0;
    for (const std::size_t cell : cells) {
      radiance.push_back(radiances_at(cell, 0, rays));
      count += radiance.back().size();
      for (const C3f& r : radiance.back()) mean += C3d(r);
    }
    if (is_black(C3f(mean))) {
      for (const std::size_t cell : cells) leave_empty(cell);
      return;
    }
    // The mean square of the radiance that arrives from each bin, each channel in units of its mean: what
    // matters in a picture is relative.
    C3f scale(0.0f);
    for (int c = 0; c < 3; ++c)
      if (mean[c] > 0.0) scale[c] = static_cast<float>(static_cast<double>(count) / mean[c]);
    Squares squares;
    squares.own.resize(cells.size(), Weights{});
    for (std::size_t i = 0; i < cells.size(); ++i) add(cells[i], i, radiance[i], scale, squares);
    // All rays together stay within what the largest number of cells would take.
    const std::size_t rounds =
        std::clamp<std::size_t>(options_.max_cells / (cells_.size() - 1), 1, most_rounds);
    if (evenness(squares.whole) < concentrated)
      for (std::uint32_t round = 1; round < rounds; ++round)
        for (std::size_t i = 0; i < cells.size(); ++i)
          add(cells[i], i, radiances_at(cells[i], round, rays), scale, squares);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      Weights weight{};
      add(blurred(squares.own[i]), weight);
      add(squares.eighth[cells_[cells[i]].eighth], weight);
      add(blurred(squares.whole), weight);
      for (float& w : weight) w = std::sqrt(w);
      set(cells[i], weight);
    }
  }

  void add(std::size_t cell, std::size_t number_in_group, std::span<const C3f> radiance, const C3f& scale,
           Squares& squares) const {
    const auto per_bin = static_cast<std::size_t>(options_.rays_per_bin);
    Weights& eighth = squares.eighth[cells_[cell].eighth];
    for (std::size_t k = 0; k < radiance.size(); ++k) {
      const C3f relative = radiance[k] * scale;
      const float square = relative.dot(relative);
      squares.own[number_in_group][k / per_bin] += square;
      eighth[k / per_bin] += square;
      squares.whole[k / per_bin] += square;
    }
  }

  void set(std::size_t cell, Weights& weight) {
    const float share = options_.uniform_share, even = share * sum_of(weight) / bins;
    std::array<float, rows> row{};
    Cell& made = guide_.cells_[cell];
    for (std::size_t r = 0; r < rows; ++r) {
      for (std::size_t c = 0; c < columns; ++c) {
        float& w = weight[r * columns + c];
        w = (1.0f - share) * w + even;
        row[r] += w;
      }
      quantise(&weight[r * columns], made.column[r]);
    }
    quantise(row.data(), made.row);
  }

  // What arrives at random points of the cell, rays_per_bin times from each bin. Of a point that lies under
  // another surface: mostly nothing, which takes from all bins alike.
  std::vector<C3f> radiances_at(std::size_t cell, std::uint32_t round, std::uint64_t& rays) const {
    const std::span<const std::uint32_t> members = this->members(cell);
    std::vector<double> areas;
    for (const std::uint32_t e : members) areas.push_back(mesh_.area(e));
    const DiscreteDistribution choice(areas);
    if (choice.empty()) return {};
    std::vector<Ray> gather;
    std::vector<Sampler> samplers;
    for (int bin = 0; bin < bins; ++bin)
      for (int k = 0; k < options_.rays_per_bin; ++k) {
        Sampler& sampler = samplers.emplace_back(options_.seed, static_cast<std::uint32_t>(cell),
                                                 (round * bins + static_cast<std::uint32_t>(bin)) *
                                                         static_cast<std::uint32_t>(options_.rays_per_bin) +
                                                     static_cast<std::uint32_t>(k));
        V2f u = sampler.next_2d();
        const DiscreteDistribution::Choice chosen = choice.sample(u.x);
        u.x = chosen.remapped;
        const ElementPoint start = mesh_.sample(members[chosen.index], u);
        const V2f in_bin = sampler.next_2d();
        const V3f local =
            square_to_cosine_hemisphere({(static_cast<float>(bin / columns) + in_bin.x) / rows,
                                         (static_cast<float>(bin % columns) + in_bin.y) / columns});
        const Frame frame = frame_around(V3f(start.normal), guide_.place_[members[0]].sign);
        gather.push_back({start.ray_position(), frame.to_world(local)});
      }
    std::vector<Hit> hits(gather.size());
    scene_.caster().intersect(gather, hits, Rays::coherent);
    rays += gather.size();
    std::vector<C3f> radiance;
    for (std::size_t i = 0; i < gather.size(); ++i)
      radiance.push_back(hits[i].escaped() ? C3f(0.0f) : radiance_of(gather[i], hits[i], samplers[i], rays));
    return radiance;
  }

  // Without what next-event estimation finds: what emitters and sky send straight.
  C3f radiance_of(const Ray& ray, const Hit& hit, Sampler& sampler, std::uint64_t& rays) const {
    const SurfacePoint point = scene_.surface_point(ray, hit);
    C3f sum = reflected(mesh_.find(point));
    if (!is_more_than_diffuse(scene_.side(point))) return sum;
    SpecularPath path(scene_, ray, point, Carried::radiance, sampler);
    bool leaves_out = options_.without_caustics && scene_.side(point).scatters_without_diffusing();
    while (path.next()) {
      const SpecularPathEnd& end = path.end();
      if (end.escaped) {
        sum += end.weight * scene_.environment().radiance(end.direction);
        break;
      }
      if (!std::exchange(leaves_out, false)) sum += end.weight * scene_.emitted_radiance(end.point);
      sum += end.weight * reflected(mesh_.find(end.point));
    }
    rays += path.rays();
    return sum;
  }

  [[nodiscard]] C3f reflected(std::uint32_t element) const {
    if (element == no_index) return C3f(0.0f);
    const C3f radiance = mesh_.reflectance(element) * solution_.irradiances()[element].total() * (1.0f / pi_f);
    return {std::max(radiance.x, 0.0f), std::max(radiance.y, 0.0f), std::max(radiance.z, 0.0f)};
  }

  const Scene& scene_;
  const Solution& solution_;
  const ElementMesh& mesh_;
  GuideOptions options_;
  Guide& guide_;
  std::vector<std::uint32_t> members_;  // elements, by cell
  struct Range {
    std::size_t first;     // into members_
    std::uint32_t eighth;  // of the group's cube
  };
  std::vector<Range> cells_;         // by cell, and the end
  std::vector<std::size_t> groups_;  // the first cell of each, and the end
};

Guide::Guide(const Scene& scene, const Solution& solution, const GuideOptions& options)
    : mesh_(&solution.mesh()) {
  Builder(scene, solution, options, *this).build();
}

}  // namespace twopass
