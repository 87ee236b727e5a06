#include "render/scene/duplicate_lamps.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "render/scene/data_hash.h"

namespace twopass {

namespace {

// A triangle in space: its corners from the least one on, in the direction that they run in or against it, so
// that the same triangle is the same three points however it was written.
struct Place {
  std::array<V3f, 3> corner;
  bool operator==(const Place&) const = default;
};
struct PlaceHash {
  std::size_t operator()(const Place& place) const {
    DataHash hash;
    for (const V3f& p : place.corner) hash.add(p);
    return hash.value();
  }
};

bool comes_before(const V3f& a, const V3f& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

// The place, and whether its front is the triangle's.
std::pair<Place, bool> place_of(std::array<V3f, 3> p) {
  for (V3f& corner : p) corner += V3f(0.0f);  // one kind of zero
  std::rotate(p.begin(), std::ranges::min_element(p, comes_before), p.end());
  const bool is_turned = comes_before(p[2], p[1]);
  if (is_turned) std::swap(p[1], p[2]);
  return {{p}, !is_turned};
}

// On which sides of the place it emits.
using Emits = std::array<bool, 2>;

class Lamps {
 public:
  // Whether the triangle adds a lamp, or light on another side of one.
  bool add(const std::array<V3f, 3>& corners, Emits emits) {
    const auto [place, is_front] = place_of(corners);
    if (!is_front) std::swap(emits[front], emits[back]);
    Emits& known = known_[place];
    const bool adds = (emits[front] && !known[front]) || (emits[back] && !known[back]);
    for (const Side side : {front, back}) known[side] = known[side] || emits[side];
    return adds;
  }

 private:
  std::unordered_map<Place, Emits, PlaceHash> known_;
};

void keep(Mesh& mesh, const std::vector<bool>& is_kept) {
  const auto filter = [&](auto& list) {
    std::size_t next = 0;
    for (std::size_t i = 0; i < list.size(); ++i)
      if (is_kept[i]) list[next++] = list[i];
    list.resize(next);
  };
  filter(mesh.triangles);
  for (MeshAttribute& attribute : mesh.attributes)
    if (attribute.is_of_faces()) filter(attribute.values);
}

}  // namespace

std::size_t leave_out_duplicate_lamps(SceneDescription& scene) {
  Lamps lamps;
  std::size_t left_out = 0;
  for (Shape& shape : scene.shapes) {
    auto* mesh = std::get_if<Mesh>(&shape.geometry);
    if (!mesh || !is_emitter(shape)) continue;
    const Emits emits{!is_black(shape.radiance[front]), !is_black(shape.radiance[back])};
    std::vector<bool> is_kept;
    for (const V3u& t : mesh->triangles)
      is_kept.push_back(lamps.add({mesh->positions[t.x], mesh->positions[t.y], mesh->positions[t.z]}, emits));
    const auto duplicates = static_cast<std::size_t>(std::ranges::count(is_kept, false));
    if (duplicates > 0) keep(*mesh, is_kept);
    left_out += duplicates;
  }
  return left_out;
}

}  // namespace twopass
