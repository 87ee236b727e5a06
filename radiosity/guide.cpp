#include "radiosity/guide.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <compare>
#include <numeric>

#include "materials/lobes.h"
#include "radiosity/specular_path.h"
#include "render/core/distribution.h"
#include "render/core/parallel.h"
#include "render/core/sampler.h"
#include "render/core/warp.h"

namespace twopass {

namespace {

constexpr int rows = Guide::rows, columns = Guide::columns, bins = rows * columns;
constexpr float whole = 65536.0f;  // of a cumulative distribution
constexpr std::uint16_t last = 65535;

// The interval of a cumulative distribution of n entries that holds x in [0, whole).
template <int n>
int find_bin(const std::uint16_t* cumulative, float x) {
  const auto at = static_cast<std::uint16_t>(x);
  std::uint16_t bin = 0;
  for (int i = 0; i < n; ++i)
    bin += cumulative[i] <= at ? 1 : 0;  // in a few instructions, and none to mispredict
  return std::min<int>(bin, n - 1);
}

struct Interval {
  float begin, width;
};
template <int n>
Interval interval_of(const std::uint16_t* cumulative, int bin) {
  const float begin = bin == 0 ? 0.0f : static_cast<float>(cumulative[bin - 1]);
  const float end = bin == n - 1 ? whole : static_cast<float>(cumulative[bin]);
  return {begin, end - begin};
}

// Bins are of equal area on the square and the square's density is cosine / pi (R41).
float density(const Interval& row, const Interval& column, float cosine) {
  constexpr float scale = static_cast<float>(bins) / (whole * whole);
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
  static_assert(columns == 16);
  constexpr float tan_of_eighth = 0.414213562f;  // of pi / 8
  const float a = std::abs(x), b = std::abs(y);
  const int k = (b > tan_of_eighth * a ? 1 : 0) + (b > a ? 1 : 0) + (tan_of_eighth * b > a ? 1 : 0);
  if (y >= 0.0f) return x >= 0.0f ? k : 7 - k;
  return x >= 0.0f ? 15 - k : 8 + k;
}

// The share of each of n bins, at least 2^-16, as a cumulative distribution. REQUIRES: positive weights.
template <int n>
void quantise(const float* weight, std::uint16_t* cumulative) {
  const double total = std::accumulate(weight, weight + n, 0.0);
  double sum = 0.0;
  int before = 0;
  for (int i = 0; i < n - 1; ++i) {
    sum += weight[i];
    const int rounded = static_cast<int>(sum / total * 65536.0 + 0.5);
    before = std::clamp(rounded, before + 1, 65536 - (n - 1 - i));
    cumulative[i] = static_cast<std::uint16_t>(before);
  }
  cumulative[n - 1] = last;
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
  friend auto operator<=>(const Key&, const Key&) = default;
};

std::uint32_t facing_of(const V3f& n) {
  const int axis = nearest_axis(n);
  const float length = std::abs(n[axis]);
  const auto third = [&](float x) {
    return static_cast<std::uint32_t>(std::clamp((x / length + 1.0f) * 1.5f, 0.0f, 2.0f));
  };
  return (static_cast<std::uint32_t>(2 * axis + (n[axis] < 0.0f ? 1 : 0)) * 3 + third(n[(axis + 1) % 3])) * 3 +
         third(n[(axis + 2) % 3]);
}

}  // namespace

Guide::Lobe::Direction Guide::Lobe::sample(const V2f& u) const {
  const float y = u.y * whole, x = u.x * whole;
  const int row = find_bin<rows>(cell_, y);
  const std::uint16_t* in_row = cell_ + rows + row * columns;
  const int column = find_bin<columns>(in_row, x);
  const Interval height = interval_of<rows>(cell_, row), width = interval_of<columns>(in_row, column);
  const V3f local =
      square_to_cosine_hemisphere({within<rows>(height, y, row), within<columns>(width, x, column)});
  return {frame_.to_world(local), density(height, width, local.z)};
}

float Guide::Lobe::pdf_w(const V3f& direction) const {
  const V3f local = frame_.to_local(direction);
  if (!(local.z > 0.0f)) return 0.0f;
  const float sin2 = local.x * local.x + local.y * local.y;
  const int row = std::min(static_cast<int>(sin2 * static_cast<float>(rows)), rows - 1);
  const int column = sector_of(local.x, local.y);
  return density(interval_of<rows>(cell_, row), interval_of<columns>(cell_ + rows + row * columns, column),
                 local.z);
}

std::size_t Guide::memory_bytes() const {
  return place_.size() * sizeof(place_[0]) + cumulative_.size() * sizeof(cumulative_[0]);
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
  // Divides the elements into cells. False: more than may be.
  bool group(const std::vector<ElementPoint>& middle, float size) {
    std::vector<Key> keys(middle.size());
    for (std::size_t e = 0; e < middle.size(); ++e) {
      const V3f normal(middle[e].normal), p = (V3f(middle[e].position) - scene_.bounds().min) * (1.0f / size);
      const auto coordinate = [](float x) {
        return static_cast<std::uint64_t>(std::clamp(x, 0.0f, 2097151.0f));
      };
      keys[e] = {coordinate(p.x) << 42 | coordinate(p.y) << 21 | coordinate(p.z), facing_of(normal),
                 normal.z < -0.5f};
    }
    members_.resize(middle.size());
    std::iota(members_.begin(), members_.end(), 0u);
    std::sort(members_.begin(), members_.end(),
              [&](std::uint32_t a, std::uint32_t b) { return keys[a] != keys[b] ? keys[a] < keys[b] : a < b; });
    first_.clear();
    guide_.place_.resize(middle.size());
    for (std::size_t i = 0; i < members_.size(); ++i) {
      const std::uint32_t e = members_[i];
      if (i == 0 || keys[e] != keys[members_[i - 1]]) first_.push_back(i);
      guide_.place_[e] = {static_cast<std::uint32_t>(first_.size() - 1), keys[e].down ? -1.0f : 1.0f};
    }
    first_.push_back(members_.size());
    return first_.size() - 1 <= options_.max_cells || size > 8.0f * max_component(scene_.bounds().size());
  }

  [[nodiscard]] bool is_wanted(std::size_t cell) const {
    if (options_.wanted.empty()) return true;
    return std::any_of(members_.begin() + static_cast<std::ptrdiff_t>(first_[cell]),
                       members_.begin() + static_cast<std::ptrdiff_t>(first_[cell + 1]),
                       [&](std::uint32_t e) { return options_.wanted[e]; });
  }

  void fill() {
    const std::size_t cells = first_.size() - 1;
    guide_.cumulative_.resize(cells * stride);
    std::atomic<std::uint64_t> rays{0};
    parallel_for(cells, 4, [&](std::size_t begin, std::size_t end) {
      std::uint64_t own = 0;
      for (std::size_t cell = begin; cell < end; ++cell) fill_cell(static_cast<std::uint32_t>(cell), own);
      rays += own;
    });
    guide_.rays_ = rays;
  }

  void fill_cell(std::uint32_t cell, std::uint64_t& rays) {
    const std::span<const std::uint32_t> members(members_.data() + first_[cell],
                                                 first_[cell + 1] - first_[cell]);
    const auto leave_empty = [&] {
      for (const std::uint32_t e : members) guide_.place_[e].sign = 0.0f;
    };
    if (!is_wanted(cell)) return leave_empty();
    const std::vector<C3f> radiance = radiances_at(cell, members, rays);
    // The mean square of the radiance that arrives from each bin, each channel in units of its mean: what
    // matters in a picture is relative (R42).
    C3d mean(0.0);
    for (const C3f& r : radiance) mean += C3d(r);
    if (is_black(C3f(mean))) return leave_empty();
    mean *= 1.0 / static_cast<double>(radiance.size());
    C3f scale;
    for (int c = 0; c < 3; ++c) scale[c] = mean[c] > 0.0 ? static_cast<float>(1.0 / mean[c]) : 0.0f;
    std::array<float, bins> weight{};
    float total = 0.0f;
    const auto per_bin = static_cast<std::size_t>(options_.rays_per_bin);
    for (std::size_t bin = 0; bin < bins; ++bin) {
      for (std::size_t k = 0; k < per_bin; ++k) {
        const C3f relative = radiance[bin * per_bin + k] * scale;
        weight[bin] += relative.dot(relative);
      }
      weight[bin] = std::sqrt(weight[bin]);
      total += weight[bin];
    }
    const float share = options_.uniform_share, even = share * total / bins;
    std::array<float, rows> row{};
    std::uint16_t* const cumulative = &guide_.cumulative_[std::size_t{cell} * stride];
    for (std::size_t r = 0; r < rows; ++r) {
      for (std::size_t c = 0; c < columns; ++c) {
        float& w = weight[r * columns + c];
        w = (1.0f - share) * w + even;
        row[r] += w;
      }
      quantise<columns>(&weight[r * columns], cumulative + rows + r * columns);
    }
    quantise<rows>(row.data(), cumulative);
  }

  // What arrives at random points of the cell, rays_per_bin times from each bin. Of a point that lies under
  // another surface: mostly nothing, which takes from all bins alike.
  std::vector<C3f> radiances_at(std::uint32_t cell, std::span<const std::uint32_t> members,
                                std::uint64_t& rays) const {
    std::vector<double> areas;
    for (const std::uint32_t e : members) areas.push_back(mesh_.area(e));
    const DiscreteDistribution choice(areas);
    if (choice.empty()) return {};
    std::vector<Ray> gather;
    std::vector<Sampler> samplers;
    for (int bin = 0; bin < bins; ++bin)
      for (int k = 0; k < options_.rays_per_bin; ++k) {
        Sampler& sampler = samplers.emplace_back(options_.seed, cell,
                                                 static_cast<std::uint32_t>(bin * options_.rays_per_bin + k));
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
    while (path.next()) {
      const SpecularPathEnd& end = path.end();
      if (end.escaped) {
        sum += end.weight * scene_.environment().radiance(end.direction);
        break;
      }
      sum += end.weight * (scene_.emitted_radiance(end.point) + reflected(mesh_.find(end.point)));
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
  std::vector<std::size_t> first_;      // by cell, into members_, and the end
};

Guide::Guide(const Scene& scene, const Solution& solution, const GuideOptions& options)
    : mesh_(&solution.mesh()) {
  Builder(scene, solution, options, *this).build();
}

}  // namespace twopass
