#include "radiosity/linked_exchange.h"

#include "render/core/interrupt.h"
#include "render/core/parallel.h"

namespace twopass {

void for_each_level(const ElementTree& tree, bool upwards,
                    const std::function<void(std::size_t, std::size_t)>& body) {
  const std::span<const std::uint32_t> level = tree.levels();
  for (std::size_t k = 0; k + 1 < level.size(); ++k) {
    const std::size_t l = upwards ? level.size() - 2 - k : k;
    parallel_for(level[l + 1] - level[l], 2048,
                 [&](std::size_t begin, std::size_t end) { body(level[l] + begin, level[l] + end); });
  }
}

LinkedExchange::LinkedExchange(const ElementTree& tree, std::span<const Link> links)
    : tree_(tree), first_(tree.nodes().size() + 1, 0), factor_(tree.order().size(), 1.0) {
  const auto for_each_end = [&](const auto& visit) {
    for (const Link& link : links) {
      if (!(link.exchange > 0.0f)) continue;
      visit(link.p, link.q, link.exchange);
      if (link.p != link.q) visit(link.q, link.p, link.exchange);
    }
  };
  for_each_end([&](std::uint32_t at, std::uint32_t, float) { ++first_[at + 1]; });
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  end_.resize(first_.back());
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  for_each_end([&](std::uint32_t at, std::uint32_t other, float exchange) {
    end_[next[at]++] = {other, exchange};
  });
}

template <class T>
std::vector<T> LinkedExchange::gather(std::span<const T> value, bool scaled) const {
  throw_if_interrupted();
  const std::span<const TreeNode> node = tree_.nodes();
  // Pull: means over the exposed areas, from the leaves up.
  std::vector<T> mean(node.size(), T(0.0)), received(node.size(), T(0.0));
  for_each_level(tree_, true, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!(node[i].area > 0.0)) continue;
      if (node[i].kind == TreeNode::element) {
        const std::uint32_t e = tree_.element_of(node[i]);
        mean[i] = value[e] * (scaled ? factor_[e] : 1.0);
        continue;
      }
      for (std::uint32_t c = node[i].first_child; c < node[i].first_child + node[i].child_count; ++c)
        mean[i] += mean[c] * (node[c].area / node[i].area);
    }
  });
  // Gather over the links of every level; push: what a node receives all of its parts receive.
  for_each_level(tree_, false, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!(node[i].area > 0.0)) continue;
      T sum(0.0);
      for (std::size_t k = first_[i]; k < first_[i + 1]; ++k)
        sum += mean[end_[k].other] * static_cast<double>(end_[k].exchange);
      received[i] = sum * (1.0 / node[i].area);
      if (i > 0) received[i] += received[node[i].parent];
    }
  });
  std::vector<T> result(value.size(), T(0.0));
  parallel_for(result.size(), 2048, [&](std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e)
      result[e] = received[tree_.leaf_of(static_cast<std::uint32_t>(e))] * (scaled ? factor_[e] : 1.0);
  });
  return result;
}

template std::vector<double> LinkedExchange::gather(std::span<const double>, bool) const;
template std::vector<C3d> LinkedExchange::gather(std::span<const C3d>, bool) const;

double LinkedExchange::scale_to_row_sums(std::span<const double> fixed, std::span<const double> target,
                                         double tolerance) {
  constexpr int most_passes = 100;
  constexpr double largest_factor = 4.0;
  const std::size_t n = factor_.size();
  const std::vector<double> ones(n, 1.0);
  const auto area = [&](std::size_t i) {
    return tree_.node(tree_.leaf_of(static_cast<std::uint32_t>(i))).area;
  };
  for (std::size_t i = 0; i < n; ++i)
    if (!(target[i] > 0.0)) factor_[i] = 0.0;
  for (int pass = 0;; ++pass) {
    const std::vector<double> row = gather(std::span<const double>(ones));
    double worst = 0.0;
    std::vector<double> sum(n);
    for (std::size_t i = 0; i < n; ++i) {
      sum[i] = row[i] * area(i) + factor_[i] * fixed[i];
      if (sum[i] > 0.0) worst = std::max(worst, std::abs(sum[i] - target[i]) / area(i));
    }
    if (worst <= tolerance || pass == most_passes) return worst;
    for (std::size_t i = 0; i < n; ++i)
      if (sum[i] > 0.0 && target[i] > 0.0)
        factor_[i] =
            std::clamp(factor_[i] * std::sqrt(target[i] / sum[i]), 1.0 / largest_factor, largest_factor);
  }
}

void LinkedExchange::cap_row_sums(std::span<const double> limit) {
  const std::vector<double> ones(factor_.size(), 1.0);
  const std::vector<double> row = gather(std::span<const double>(ones));
  // All at once: the columns' factors only make the sums smaller still.
  for (std::uint32_t i = 0; i < factor_.size(); ++i)
    if (const double sum = row[i] * tree_.node(tree_.leaf_of(i)).area; sum > limit[i])
      factor_[i] *= limit[i] / sum;
}

std::size_t LinkedExchange::memory_bytes() const {
  return first_.size() * sizeof(std::size_t) + end_.size() * sizeof(End) + factor_.size() * sizeof(double);
}

}  // namespace twopass
