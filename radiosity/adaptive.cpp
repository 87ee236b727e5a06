#include "radiosity/adaptive.h"

#include <algorithm>
#include <numeric>

#include "radiosity/smoothing.h"
#include "render/core/parallel.h"

namespace twopass {

namespace {

double brightest(const C3f& x) { return static_cast<double>(std::max(std::max(x.x, x.y), x.z)); }

// How much the irradiance differs between the corners of an element that is not a cluster.
struct Range {
  C3f low, high;
};
Range range_in(const ElementMesh& mesh, const SmoothIrradiance& smooth, std::uint32_t element) {
  const ElementMesh::Location corner[] = {{element, mesh.root_index(element), 0.0f, 0.0f},
                                          {element, mesh.root_index(element), 1.0f, 0.0f},
                                          {element, mesh.root_index(element), 0.0f, 1.0f}};
  Range range{C3f(infinity_f), C3f(0.0f)};
  for (const ElementMesh::Location& location : corner) {
    const C3f value = smooth.at(location).total();
    for (int c = 0; c < 3; ++c) {
      range.low[c] = std::min(range.low[c], value[c]);
      range.high[c] = std::max(range.high[c], value[c]);
    }
  }
  return range;
}

// Calls `use(element, range)` for each element that can be split, in parallel.
template <class Use>
void for_each_range(const ElementMesh& mesh, std::span<const Irradiance> irradiance, const Use& use) {
  const SmoothIrradiance smooth(mesh, irradiance);
  parallel_for(mesh.count(), 256, [&](std::size_t begin, std::size_t end) {
    for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i)
      if (!mesh.is_cluster(i)) use(i, range_in(mesh, smooth, i));
  });
}

double power_in(const ElementMesh& mesh, std::uint32_t element, const Range& range) {
  return mesh.area(element) * brightest(mesh.reflectance(element) * (range.high - range.low));
}

// (R44): the part of the picture that the element is, times the contrast on it.
double seen_in(double part, const Range& range) {
  const double high = brightest(range.high);
  return high > 0.0 ? part * brightest(range.high - range.low) / high : 0.0;
}

// Elements that follow each other lie beside each other. Their relative error, from that of the elements around
// them as far as their own is lost in noise: halves of halves, each as far from the whole as is more than
// chance.
class RelativeErrors {
 public:
  explicit RelativeErrors(std::span<const ElementError> errors)
      : sums_(errors.size() + 1), result_(errors.size()) {
    for (std::size_t i = 0; i < errors.size(); ++i) {
      sums_[i + 1] = sums_[i];
      sums_[i + 1].carried += errors[i].carried;
      sums_[i + 1].error += errors[i].error;
      sums_[i + 1].squares += errors[i].squares;
      sums_[i + 1].reads += errors[i].reads;
    }
    divide(0, errors.size(), 0.0);
  }
  [[nodiscard]] const std::vector<double>& of_element() const { return result_; }

 private:
  // Few say nothing of their own scatter.
  static constexpr std::uint32_t least_reads = 32;

  [[nodiscard]] ElementError sum(std::size_t begin, std::size_t end) const {
    const ElementError &a = sums_[begin], &b = sums_[end];
    return {b.carried - a.carried, b.error - a.error, b.squares - a.squares, b.reads - a.reads};
  }
  void divide(std::size_t begin, std::size_t end, double around) {
    const ElementError own = sum(begin, end);
    if (own.reads >= least_reads && own.carried > 0.0) {
      const double off = own.error - around * own.carried;
      around += off / own.carried * std::max(0.0, 1.0 - own.squares / (off * off));
    }
    // Where as many reads are on both sides.
    std::size_t middle = begin;
    while (middle < end && 2 * sum(begin, middle).reads < own.reads) ++middle;
    if (middle == end && end > begin) --middle;
    if (middle == begin && end > begin) ++middle;
    if (own.reads < 2 * least_reads || middle == end)
      return std::fill(result_.begin() + static_cast<std::ptrdiff_t>(begin),
                       result_.begin() + static_cast<std::ptrdiff_t>(end), around);
    divide(begin, middle, around);
    divide(middle, end, around);
  }

  std::vector<ElementError> sums_;  // of all elements before
  std::vector<double> result_;
};

}  // namespace

std::vector<double> misplaced_power(const ElementMesh& mesh, std::span<const Irradiance> irradiance) {
  std::vector<double> power(mesh.count(), 0.0);
  for_each_range(mesh, irradiance,
                 [&](std::uint32_t i, const Range& range) { power[i] = power_in(mesh, i, range); });
  return power;
}

std::vector<bool> elements_to_split(const ElementMesh& mesh, std::span<const Irradiance> irradiance,
                                    std::span<const double> seen, std::size_t most, double negligible,
                                    std::span<const double> importance) {
  double total = 0.0;
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    total += mesh.area(i) * brightest(mesh.reflectance(i) * irradiance[i].total());
  std::vector<double> gain(mesh.count(), 0.0);
  for_each_range(mesh, irradiance, [&](std::uint32_t i, const Range& range) {
    if (!importance.empty())
      gain[i] = importance[i] * brightest(mesh.reflectance(i) * (range.high - range.low));
    else if (total > 0.0)
      gain[i] = power_in(mesh, i, range) / total;
    if (!seen.empty()) gain[i] += seen_in(seen[i], range);
  });
  std::vector<std::uint32_t> order(mesh.count());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return gain[a] > gain[b]; });
  double left = std::accumulate(gain.begin(), gain.end(), 0.0);
  std::vector<bool> chosen(mesh.count(), false);
  for (std::size_t k = 0; k < std::min(most, order.size()) && left > negligible; ++k) {
    chosen[order[k]] = true;
    left -= gain[order[k]];
  }
  return chosen;
}

std::vector<double> guilt_of(const ElementMesh& mesh, std::span<const Irradiance> irradiance,
                             std::span<const ElementError> errors) {
  std::vector<double> contrast(mesh.count(), 0.0), guilt(mesh.count(), 0.0);
  for_each_range(mesh, irradiance,
                 [&](std::uint32_t i, const Range& range) { contrast[i] = seen_in(1.0, range); });
  double carried = 0.0, mean = 0.0;
  for (std::uint32_t i = 0; i < mesh.count(); ++i) {
    carried += errors[i].carried;
    mean += errors[i].carried * contrast[i];
  }
  if (!(carried > 0.0)) return guilt;
  mean /= carried;
  const RelativeErrors relative(errors);
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    if (!mesh.is_cluster(i))
      guilt[i] = errors[i].carried * std::abs(relative.of_element()[i]) * (contrast[i] + mean);
  return guilt;
}

std::vector<std::uint8_t> cuts_for(std::span<const double> guilt, double enough, std::size_t most) {
  // Deeper ones would be guesses.
  constexpr int most_cuts = 4;
  // All that have more guilt than the threshold are cut: each of the four has an eighth.
  const auto cuts_of = [](double g, double threshold) {
    int cuts = 0;
    for (; g > threshold && cuts < most_cuts; g /= 8.0) ++cuts;
    return cuts;
  };
  const auto is_enough = [&](double threshold) {
    double left = 0.0;
    for (const double g : guilt) left += std::ldexp(g, -cuts_of(g, threshold));
    return left <= enough;
  };
  const auto are_too_many = [&](double threshold) {
    double count = 0.0;
    for (const double g : guilt) count += std::ldexp(1.0, 2 * cuts_of(g, threshold));
    return count > static_cast<double>(most);
  };
  const double largest = guilt.empty() ? 0.0 : *std::max_element(guilt.begin(), guilt.end());
  // As high as is enough, or as low as there may be elements: the logarithm of the interval is halved.
  double high = largest, low = 1e-9 * largest;
  while (high > 1.001 * low) {
    const double middle = std::sqrt(low * high);
    (are_too_many(middle) || is_enough(middle) ? low : high) = middle;
  }
  if (!are_too_many(low) && is_enough(low)) high = low;
  std::vector<std::uint8_t> cuts(guilt.size());
  for (std::size_t i = 0; i < guilt.size(); ++i) cuts[i] = static_cast<std::uint8_t>(cuts_of(guilt[i], high));
  return cuts;
}

}  // namespace twopass
