#include "radiosity/guide.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <numeric>

#include "radiosity/landing.h"
#include "radiosity/specular_path.h"
#include "render/core/parallel.h"
#include "render/core/warp.h"

namespace twopass {

namespace {

constexpr int bins = Guide::bins;
constexpr float whole = 65536.0f;  // of a cumulative distribution

// The interval of a cumulative distribution of `bins` entries that holds x in [0, whole).
int find_bin(const std::uint16_t* cumulative, float x) {
  const auto at = static_cast<std::uint32_t>(x);
  int bin = 0;
  for (int i = 0; i < bins - 1; ++i) bin += cumulative[i] <= at ? 1 : 0;  // no branch to mispredict
  return bin;
}

struct Interval {
  float begin, width;
};
Interval interval_of(const std::uint16_t* cumulative, int bin) {
  const float begin = bin == 0 ? 0.0f : static_cast<float>(cumulative[bin - 1]);
  const float end = bin == bins - 1 ? whole : static_cast<float>(cumulative[bin]);
  return {begin, end - begin};
}

// Bins are of equal area on the square and the square's density is cosine / pi (R39).
float density(const Interval& row, const Interval& column, float cosine) {
  constexpr float scale = static_cast<float>(bins * bins) / (whole * whole);
  return row.width * column.width * scale * cosine_hemisphere_pdf_w(cosine);
}

// Where in a bin.
float within(const Interval& interval, float x, int bin) {
  return (static_cast<float>(bin) + std::min((x - interval.begin) / interval.width, 0x1.fffffep-1f)) *
         (1.0f / static_cast<float>(bins));
}

// The share of each of n bins, at least 2^-16, as a cumulative distribution. REQUIRES: positive weights.
void quantise(const float* weight, std::uint16_t* cumulative) {
  const double total = std::accumulate(weight, weight + bins, 0.0);
  double sum = 0.0;
  int before = 0;
  for (int i = 0; i < bins; ++i) {
    sum += weight[i];
    const int rounded = static_cast<int>(sum / total * 65536.0 + 0.5);
    before = std::clamp(rounded, before + 1, 65536 - (bins - 1 - i));
    cumulative[i] = static_cast<std::uint16_t>(before);  // the last one, 65536, is never read
  }
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
  friend auto operator<=>(const Key&, const Key&) = default;
};

std::uint32_t facing_of(const V3f& n, int axis) {
  const float length = std::abs(n[axis]);
  const auto third = [&](float x) {
    return static_cast<std::uint32_t>(std::clamp((x / length + 1.0f) * 1.5f, 0.0f, 2.0f));
  };
  return (static_cast<std::uint32_t>(2 * axis + (n[axis] < 0.0f ? 1 : 0)) * 3 + third(n[(axis + 1) % 3])) * 3 +
         third(n[(axis + 2) % 3]);
}

}  // namespace

Frame Guide::frame_around(const V3f& normal, int axis) {
  Frame frame;
  const int along = axis == 2 ? 0 : axis + 1;
  V3f s = normal * -normal[along];
  s[along] += 1.0f;
  frame.n = normal;
  frame.s = unit(s);
  frame.t = normal.cross(frame.s);
  return frame;
}

Guide::Lobe::Direction Guide::Lobe::sample(const V2f& u) const {
  const float y = u.y * whole, x = u.x * whole;
  const int row = find_bin(cell_, y);
  const std::uint16_t* columns = cell_ + bins + row * bins;
  const int column = find_bin(columns, x);
  const Interval height = interval_of(cell_, row), width = interval_of(columns, column);
  const V3f local = square_to_cosine_hemisphere({within(height, y, row), within(width, x, column)});
  return {frame_.to_world(local), density(height, width, local.z)};
}

float Guide::Lobe::pdf_w(const V3f& direction) const {
  const V3f local = frame_.to_local(direction);
  if (!(local.z > 0.0f)) return 0.0f;
  float turn = std::atan2(local.y, local.x) * (0.5f / pi_f);
  if (turn < 0.0f) turn += 1.0f;
  constexpr auto edge = static_cast<float>(bins);
  const int row = std::min(static_cast<int>((local.x * local.x + local.y * local.y) * edge), bins - 1);
  const int column = std::min(static_cast<int>(turn * edge), bins - 1);
  return density(interval_of(cell_, row), interval_of(cell_ + bins + row * bins, column), local.z);
}

std::size_t Guide::memory_bytes() const {
  return cell_of_.size() * sizeof(cell_of_[0]) + axis_.size() + cumulative_.size() * sizeof(cumulative_[0]);
}

class Guide::Builder {
 public:
  Builder(const Scene& scene, const Solution& solution, const GuideOptions& options, Guide& guide)
      : scene_(scene),
        solution_(solution),
        mesh_(solution.mesh()),
        rays_(scene, mesh_),
        options_(options),
        guide_(guide) {}

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
    std::vector<std::uint8_t> axis(middle.size());
    for (std::size_t e = 0; e < middle.size(); ++e) {
      const V3f normal(middle[e].normal), p = (V3f(middle[e].position) - scene_.bounds().min) * (1.0f / size);
      const int nearest = nearest_axis(normal);
      const auto coordinate = [](float x) { return static_cast<std::uint64_t>(std::clamp(x, 0.0f, 2097151.0f)); };
      keys[e] = {coordinate(p.x) << 42 | coordinate(p.y) << 21 | coordinate(p.z), facing_of(normal, nearest)};
      axis[e] = static_cast<std::uint8_t>(nearest);
    }
    members_.resize(middle.size());
    std::iota(members_.begin(), members_.end(), 0u);
    std::sort(members_.begin(), members_.end(), [&](std::uint32_t a, std::uint32_t b) {
      return keys[a] != keys[b] ? keys[a] < keys[b] : a < b;
    });
    first_.clear();
    guide_.axis_.clear();
    guide_.cell_of_.resize(middle.size());
    for (std::size_t i = 0; i < members_.size(); ++i) {
      const std::uint32_t e = members_[i];
      if (i == 0 || keys[e] != keys[members_[i - 1]]) {
        first_.push_back(i);
        guide_.axis_.push_back(axis[e]);
      }
      guide_.cell_of_[e] = static_cast<std::uint32_t>(first_.size() - 1);
    }
    first_.push_back(members_.size());
    return guide_.axis_.size() <= options_.max_cells || size > 8.0f * max_component(scene_.bounds().size());
  }

  void fill() {
    const std::size_t cells = guide_.axis_.size();
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
    const std::span<const std::uint32_t> members(members_.data() + first_[cell], first_[cell + 1] - first_[cell]);
    std::vector<double> areas;
    for (const std::uint32_t e : members) areas.push_back(mesh_.area(e));
    const DiscreteDistribution choice(areas);
    std::array<float, bins * bins> weight{};
    float total = 0.0f;
    for (int bin = 0; bin < bins * bins && !choice.empty(); ++bin)
      total += weight[static_cast<std::size_t>(bin)] = bin_weight(cell, members, choice, bin, rays);
    if (!(total > 0.0f)) {
      guide_.axis_[cell] = dark;
      return;
    }
    const float share = options_.uniform_share, even = share * total / (bins * bins);
    std::array<float, bins> row{};
    std::uint16_t* const cumulative = &guide_.cumulative_[std::size_t{cell} * stride];
    for (std::size_t r = 0; r < bins; ++r) {
      for (std::size_t c = 0; c < bins; ++c) {
        float& w = weight[r * bins + c];
        w = (1.0f - share) * w + even;
        row[r] += w;
      }
      quantise(&weight[r * bins], cumulative + bins + r * bins);
    }
    quantise(row.data(), cumulative);
  }

  // The root of the mean square of the radiance that arrives from the directions of a bin (R40).
  float bin_weight(std::uint32_t cell, std::span<const std::uint32_t> members, const DiscreteDistribution& choice,
                   int bin, std::uint64_t& rays) {
    double squares = 0.0;
    int count = 0;
    const auto column = static_cast<float>(bin % bins), row = static_cast<float>(bin / bins);
    for (int k = 0; k < options_.rays_per_bin; ++k) {
      Sampler sampler(options_.seed, cell, static_cast<std::uint32_t>(bin * options_.rays_per_bin + k));
      V2f u = sampler.next_2d();
      const DiscreteDistribution::Choice chosen = choice.sample(u.x);
      u.x = chosen.remapped;
      const std::uint32_t element = members[chosen.index];
      const ElementPoint start = mesh_.sample(element, u);
      const V2f in_bin = sampler.next_2d();
      const V3f local = square_to_cosine_hemisphere(V2f(row + in_bin.y, column + in_bin.x) * (1.0f / bins));
      const V3f normal(start.normal);
      const Ray ray{start.ray_position(), frame_around(normal, guide_.axis_[cell]).to_world(local)};
      const std::optional<C3f> radiance = radiance_along(ray, normal, mesh_.size(element), sampler, rays);
      if (!radiance) continue;
      const double mean = std::max(mean_component(*radiance), 0.0f);
      squares += mean * mean;
      ++count;
    }
    return count > 0 ? static_cast<float>(std::sqrt(squares / count)) : 0.0f;
  }

  // None: the ray started under another surface.
  std::optional<C3f> radiance_along(const Ray& ray, const V3f& normal, float size, Sampler& sampler,
                                    std::uint64_t& rays) const {
    const Landing landing = rays_.cast(ray, normal, size, sampler, rays);
    if (landing.kind == Landing::buried) return std::nullopt;
    if (landing.kind == Landing::on_element) return reflected(landing.element);
    if (landing.kind != Landing::on_specular) return C3f(0.0f);
    const SpecularPathEnd end = follow_specular(scene_, ray, landing.point, Carried::radiance, sampler);
    rays += end.rays;
    // Emitters behind specular surfaces are nothing that next-event estimation could find.
    if (end.escaped) return end.weight * scene_.environment().radiance(end.direction);
    const std::uint32_t element = mesh_.find(end.point);
    const C3f emitted = scene_.emitted_radiance(end.point);
    return end.weight * (element == no_index ? emitted : emitted + reflected(element));
  }

  [[nodiscard]] C3f reflected(std::uint32_t element) const {
    return mesh_.reflectance(element) * solution_.irradiances()[element].total() * (1.0f / pi_f);
  }

  const Scene& scene_;
  const Solution& solution_;
  const ElementMesh& mesh_;
  ElementRays rays_;
  GuideOptions options_;
  Guide& guide_;
  std::vector<std::uint32_t> members_;  // elements, by cell
  std::vector<std::size_t> first_;      // by cell, into members_, and the end
};

Guide::Guide(const Scene& scene, const Solution& solution, const GuideOptions& options) : mesh_(&solution.mesh()) {
  Builder(scene, solution, options, *this).build();
}

}  // namespace twopass
