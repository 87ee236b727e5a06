#include "radiosity/smooth_groups.h"

#include <array>
#include <numeric>

namespace twopass {

namespace {

constexpr float smallest_cosine = 0.8660254f;  // of 30 degrees
// Up to here all pairs are compared.
constexpr std::size_t most_pairs = 32;
// Beyond, one normal stands for all in its cell of a grid in the cube around the unit sphere.
constexpr int cells_per_axis = 16;

std::uint32_t find_root(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

bool is_joined(const V3f& a, const V3f& b) { return a.dot(b) >= smallest_cosine; }

// The lower number stays the root, so that labels come in the order of the normals.
void join(std::vector<std::uint32_t>& parent, std::uint32_t a, std::uint32_t b) {
  a = find_root(parent, a), b = find_root(parent, b);
  parent[std::max(a, b)] = std::min(a, b);
}

std::uint32_t cell_of(const V3f& normal) {
  std::uint32_t cell = 0;
  for (int k = 0; k < 3; ++k) {
    const int index = static_cast<int>((normal[k] + 1.0f) * (cells_per_axis / 2));
    cell = cell * cells_per_axis + static_cast<std::uint32_t>(std::clamp(index, 0, cells_per_axis - 1));
  }
  return cell;
}

// The few normals that stand for all; the others are joined to theirs.
std::vector<std::uint32_t> representatives(std::span<const V3f> normals, std::vector<std::uint32_t>& parent) {
  constexpr std::uint32_t none = 0xffffffffu;
  std::vector<std::uint32_t> first(cells_per_axis * cells_per_axis * cells_per_axis, none), chosen;
  for (std::uint32_t i = 0; i < normals.size(); ++i) {
    if (normals[i].dot(normals[i]) < 0.5f) continue;
    std::uint32_t& in_cell = first[cell_of(normals[i])];
    if (in_cell != none) {
      join(parent, in_cell, i);
      continue;
    }
    in_cell = i;
    chosen.push_back(i);
  }
  return chosen;
}

}  // namespace

void smooth_groups(std::span<const V3f> normals, std::vector<std::uint32_t>& label) {
  label.assign(normals.size(), 0);
  std::size_t alike = 0;
  while (alike < normals.size() && is_joined(normals[0], normals[alike])) ++alike;
  if (alike == normals.size()) return;

  std::vector<std::uint32_t> parent(normals.size()), compared(normals.size());
  std::iota(parent.begin(), parent.end(), 0u);
  std::iota(compared.begin(), compared.end(), 0u);
  if (normals.size() > most_pairs) compared = representatives(normals, parent);
  for (std::size_t i = 0; i < compared.size(); ++i)
    for (std::size_t j = i + 1; j < compared.size(); ++j)
      if (is_joined(normals[compared[i]], normals[compared[j]])) join(parent, compared[i], compared[j]);

  std::uint32_t labels = 0;
  for (std::uint32_t i = 0; i < normals.size(); ++i) {
    const std::uint32_t root = find_root(parent, i);
    label[i] = root == i ? labels++ : label[root];
  }
}

}  // namespace twopass
