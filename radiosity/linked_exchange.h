// The exchange between all elements as links between the nodes of their tree: a matrix of n^2 entries applied
// in the time of its links.
#pragma once

#include <functional>

#include "radiosity/links.h"

namespace twopass {

/// X_ij = d_i d_j Sum over the link (p, q) with i in p and j in q of  X_pq A_i A_j / (A_p A_q)  (R33), with
/// factors d that enforce sums of rows. Symmetric. REQUIRES: the tree outlives it.
class LinkedExchange {
 public:
  LinkedExchange(const ElementTree& tree, std::span<const Link> links);

  /// (1 / A_i) Sum_j X_ij v_j of all elements: the irradiance from elements of radiosity v. The same on any
  /// number of threads. T: double or C3d. `scaled`: false leaves the factors d out.
  template <class T>
  [[nodiscard]] std::vector<T> gather(std::span<const T> value, bool scaled = true) const;

  /// As scale_to_row_sums (R14).
  double scale_to_row_sums(std::span<const double> fixed, std::span<const double> target, double tolerance);
  /// Scales down rows and columns until no row's sum is above its limit.
  void cap_row_sums(std::span<const double> limit);

  [[nodiscard]] std::size_t memory_bytes() const;

  /// What a link costs in all: itself, and its two ends here.
  static constexpr std::size_t bytes_per_link = sizeof(Link) + 2 * (sizeof(std::uint32_t) + sizeof(float));

 private:
  struct End {
    std::uint32_t other;
    float exchange;
  };

  const ElementTree& tree_;
  std::vector<std::size_t> first_;  // by node: of its ends
  std::vector<End> end_;
  std::vector<double> factor_;  // by element: d
};

/// Calls body(begin, end) on pieces of each level of nodes, one level after the other: the last one first if
/// `upwards`.
void for_each_level(const ElementTree& tree, bool upwards,
                    const std::function<void(std::size_t, std::size_t)>& body);

}  // namespace twopass
