// The system of equations that a radiosity solution satisfies, and nothing of where its numbers come from.
#pragma once

#include <span>
#include <vector>

#include <Eigen/SparseCore>

#include "render/core/types.h"

namespace twopass {

/// X_ij = A_i F_ij = A_j F_ji in units of area, both triangles stored.
using ExchangeMatrix = Eigen::SparseMatrix<float, Eigen::RowMajor>;

/// A way of light from one element to another over specular surfaces.
struct SpecularLink {
  std::uint32_t element;  ///< where the light comes from
  C3f weight;             ///< irradiance at the receiver over radiosity there
};

/// The links of all elements, by receiver.
struct SpecularLinks {
  std::vector<std::size_t>
      first;  ///< links of element i: [first[i], first[i + 1]); empty when there are none at all
  std::vector<SpecularLink> link;

  [[nodiscard]] std::span<const SpecularLink> of(std::uint32_t element) const {
    if (first.empty()) return {};
    return {link.data() + first[element], link.data() + first[element + 1]};
  }
};

/// B = rho (H + F B) (R11): the reflected radiosity B of each element, from direct irradiance H and form
/// factors F.
struct Balance {
  ExchangeMatrix exchange;       ///< what elements see of each other directly
  SpecularLinks specular;        ///< what they see of each other over specular surfaces
  std::vector<double> area;      ///< >= 0; elements of no area receive nothing
  std::vector<C3f> reflectance;  ///< in [0, 1)
  std::vector<C3d> direct;       ///< H, W/m2

  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(area.size()); }
  /// (F B)_i without the specular links: what elements see of each other directly.
  [[nodiscard]] C3d gather_directly(std::uint32_t i, std::span<const C3d> radiosity) const;
  /// (F B)_i: the irradiance at element i from elements of the given radiosity.
  [[nodiscard]] C3d gather(std::uint32_t i, std::span<const C3d> radiosity) const;
  /// The same of all elements.
  [[nodiscard]] std::vector<C3d> gather_all_directly(std::span<const C3d> radiosity) const;
  /// (F B) of all elements.
  [[nodiscard]] std::vector<C3d> gather_all(std::span<const C3d> radiosity) const;
};

}  // namespace twopass
