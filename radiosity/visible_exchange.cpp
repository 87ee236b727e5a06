#include "radiosity/visible_exchange.h"

#include <algorithm>

#include "radiosity/form_factor_pair.h"
#include "radiosity/lambert.h"
#include "radiosity/polygon_cubature.h"
#include "render/core/interrupt.h"

namespace twopass {

namespace {

constexpr int cubature_order = 3;
constexpr int deepest_division = 9;
constexpr double part_accuracy = 1e-6;

// A blocker between two polygons: which one, and the part of it that is between them.
struct InTheWay {
  std::uint32_t blocker;
  Polygon part;
};

// A convex polygon with room for the cuts of one shadow.
struct Region {
  static constexpr int capacity = 12;
  std::array<V3d, capacity> v;
  int n = 0;
};

// What a polygon hides from a point: inside of all these planes.
struct Shadow {
  struct Plane {
    V3d point, normal;  // unit
    [[nodiscard]] double height(const V3d& p) const { return normal.dot(p - point); }
  };
  std::array<Plane, 5> plane;
  int planes = 0;

  // REQUIRES: p is not in the polygon's plane; at most four corners.
  Shadow(const V3d& p, const Polygon& polygon, const V3d& unit_normal) {
    const double side = unit_normal.dot(p - polygon.v[0]) > 0.0 ? -1.0 : 1.0;
    plane[planes++] = {polygon.v[0], unit_normal * side};
    for (int k = 0; k < polygon.n; ++k)
      plane[planes++] = {p, accurate_cross(polygon.v[k] - p, polygon.next(k) - p).normalized() * side};
  }
  // Whether some plane has all of a polygon outside; false also for some that are.
  [[nodiscard]] bool clearly_misses(const Polygon& polygon, double rounding) const {
    for (int k = 0; k < planes; ++k) {
      bool outside = true;
      for (int i = 0; i < polygon.n && outside; ++i) outside = plane[k].height(polygon.v[i]) <= rounding;
      if (outside) return true;
    }
    return false;
  }
};
constexpr int most_corners = 4;  // of a piece
static_assert(most_corners + 5 + 1 <= Region::capacity);

// A region cut by a plane; vertices within `rounding` of it belong to both sides.
struct Halves {
  Region inside, outside;
};

void cut(const Region& region, const Shadow::Plane& plane, double rounding, Halves& halves) {
  std::array<double, Region::capacity> height;
  bool any_inside = false, any_outside = false;
  for (int i = 0; i < region.n; ++i) {
    height[i] = plane.height(region.v[i]);
    if (std::abs(height[i]) <= rounding) height[i] = 0.0;
    any_inside |= height[i] > 0.0;
    any_outside |= height[i] < 0.0;
  }
  Region &inside = halves.inside, &outside = halves.outside;
  inside.n = outside.n = 0;
  if (!any_inside || !any_outside) {
    (any_inside ? inside : outside) = region;
    return;
  }
  int crossings = 0;
  for (int i = 0; i < region.n; ++i) {
    const int j = i + 1 == region.n ? 0 : i + 1;
    if (height[i] >= 0.0) inside.v[inside.n++] = region.v[i];
    if (height[i] <= 0.0) outside.v[outside.n++] = region.v[i];
    if ((height[i] > 0.0 && height[j] < 0.0) || (height[i] < 0.0 && height[j] > 0.0)) {
      if (++crossings > 2) continue;  // a convex region has two; more come from rounding alone
      const V3d crossing = region.v[i] + (region.v[j] - region.v[i]) * (height[i] / (height[i] - height[j]));
      inside.v[inside.n++] = outside.v[outside.n++] = crossing;
    }
  }
  if (inside.n < 3) inside.n = 0;
  if (outside.n < 3) outside.n = 0;
}

Region region_of(const Polygon& polygon) {
  Region region;
  region.n = polygon.n;
  std::copy_n(polygon.v.begin(), polygon.n, region.v.begin());
  return region;
}

template <class AnyPolygon>
void add_in_pieces(const AnyPolygon& polygon, std::vector<Polygon>& pieces) {
  for (int first = 1; first + 1 < polygon.n; first += most_corners - 2) {
    Polygon& piece = pieces.emplace_back();
    piece.v[piece.n++] = polygon.v[0];
    for (int i = first; i < polygon.n && piece.n < most_corners; ++i) piece.v[piece.n++] = polygon.v[i];
  }
}

// What a point sees of a polygon: convex pieces, more and smaller ones after every shadow.
class View {
 public:
  void begin(const Polygon& source) {
    pieces_.clear();
    add_in_pieces(source, pieces_);
  }
  [[nodiscard]] bool empty() const { return pieces_.empty(); }
  [[nodiscard]] double form_factor(const V3d& p, const V3d& n) const {
    double sum = 0.0;
    for (const Polygon& piece : pieces_) sum += signed_point_form_factor(p, n, piece);
    return std::max(0.0, sum);
  }

  // Takes away what lies in a shadow. False: nothing did.
  bool subtract(const Shadow& shadow, double rounding) {
    bool changed = false;
    const std::size_t pieces = pieces_.size();
    kept_.clear();
    for (std::size_t i = 0; i < pieces; ++i)
      if (shadow.clearly_misses(pieces_[i], rounding))
        kept_.push_back(pieces_[i]);
      else
        changed |= subtract_from(pieces_[i], shadow, rounding);
    if (changed) std::swap(pieces_, kept_);
    return changed;
  }

 private:
  // Keeps what is outside of one of the planes. False: the piece is wholly outside.
  bool subtract_from(const Polygon& piece, const Shadow& shadow, double rounding) {
    const std::size_t before = kept_.size();
    rest_ = region_of(piece);
    for (int k = 0; k < shadow.planes; ++k) {
      cut(rest_, shadow.plane[k], rounding, halves_);
      if (halves_.inside.n == 0) {
        kept_.resize(before);
        kept_.push_back(piece);
        return false;
      }
      if (halves_.outside.n > 0) add_in_pieces(halves_.outside, kept_);
      rest_ = halves_.inside;
    }
    return true;
  }

  std::vector<Polygon> pieces_, kept_;
  Region rest_;
  Halves halves_;
};

double radius_of(const Polygon& polygon) { return polygon_radius(polygon, polygon_centroid(polygon)); }

// How far the blockers stay from a polygon, in units of its radius: the smoother is what it receives past them.
double clearance(const Polygon& polygon, const std::vector<InTheWay>& in_the_way) {
  const V3d normal = polygon_area_vector(polygon).normalized();
  double least = std::numeric_limits<double>::infinity();
  for (const InTheWay& between : in_the_way)
    for (int i = 0; i < between.part.n; ++i)
      least = std::min(least, normal.dot(between.part.v[i] - polygon.v[0]));
  return std::max(0.0, least) / radius_of(polygon);
}

std::array<Polygon, 4> quarters(const Polygon& t) {
  const V3d m01 = (t.v[0] + t.v[1]) * 0.5, m12 = (t.v[1] + t.v[2]) * 0.5, m20 = (t.v[2] + t.v[0]) * 0.5;
  return {make_polygon(t.v[0], m01, m20), make_polygon(m01, t.v[1], m12), make_polygon(m20, m12, t.v[2]),
          make_polygon(m12, m20, m01)};
}

}  // namespace

// The exchange of one pair by recursion over parts of it.
class PairInSight {
 public:
  explicit PairInSight(const Blockers& blockers) : blockers_(blockers) {}

  double exchange(const Polygon& a, const Polygon& b, double unoccluded, double accuracy) {
    const Polygon in_front_a = clip(a, b.v[0], polygon_area_vector(b)),
                  in_front_b = clip(b, a.v[0], polygon_area_vector(a));
    const std::vector<InTheWay> all = between(in_front_a, in_front_b);
    if (all.empty()) return unoccluded;
    const bool a_receives = clearance(in_front_a, all) >= clearance(in_front_b, all);
    const Polygon &receiver = a_receives ? in_front_a : in_front_b,
                  &source = a_receives ? in_front_b : in_front_a;
    double sum = 0.0;
    for (const Polygon& part : triangles_of(receiver, all))
      sum += whole(part, source, all, unoccluded * accuracy);
    return sum;
  }

  // The blockers of which a part is between two polygons; `among`: the only ones that can be.
  std::vector<InTheWay> between(const Polygon& a, const Polygon& b,
                                const std::vector<InTheWay>* among = nullptr) const {
    std::vector<InTheWay> found;
    if (a.empty() || b.empty()) return found;
    const Shaft shaft(a, b, blockers_.rounding_);
    const auto consider = [&](std::uint32_t blocker) {
      if (!shaft.bounds().intersects(blockers_.bounds_[blocker])) return;
      const Polygon part = shaft.part_inside(blockers_.polygon_[blocker]);
      if (!part.empty()) found.push_back({blocker, part});
    };
    if (among)
      for (const InTheWay& candidate : *among) consider(candidate.blocker);
    else
      for (std::uint32_t i = 0; i < blockers_.polygon_.size(); ++i) consider(i);
    return found;
  }

 private:
  struct Pair {
    Polygon receiver, source;  // a triangle, and what it receives from
    double unoccluded;
    std::vector<InTheWay> in_the_way;
    double visible = 0.0, unseen = 0.0;
  };

  // Triangles that make up the receiver, cut by the planes of blockers that stand on it: what is seen changes
  // there at once.
  std::vector<Polygon> triangles_of(const Polygon& receiver, const std::vector<InTheWay>& in_the_way) const {
    constexpr std::size_t most_parts = 32;
    std::vector<Polygon> parts{receiver}, next;
    for (const InTheWay& between : in_the_way) {
      if (clearance(receiver, {between}) > 1e-3 || parts.size() > most_parts) continue;
      const Shadow::Plane plane{blockers_.polygon_[between.blocker].v[0], blockers_.normal_[between.blocker]};
      next.clear();
      Halves halves;
      for (const Polygon& part : parts) {
        cut(region_of(part), plane, blockers_.rounding_, halves);
        add_in_pieces(halves.inside, next);
        add_in_pieces(halves.outside, next);
      }
      std::swap(parts, next);
    }
    std::vector<Polygon> triangles;
    for (const Polygon& part : parts)
      for (int i = 1; i + 1 < part.n; ++i)
        triangles.push_back(make_polygon(part.v[0], part.v[i], part.v[i + 1]));
    return triangles;
  }

  double whole(const Polygon& receiver, const Polygon& source, const std::vector<InTheWay>& among,
               double tolerance) {
    Pair pair{receiver, source, exchange_exact(receiver, source, part_accuracy), {}};
    if (!(pair.unoccluded > 0.0)) return 0.0;
    look(pair, among);
    return divided(pair, tolerance, 0);
  }

  // Fills in what is in the way, and an estimate of what is visible.
  void look(Pair& pair, const std::vector<InTheWay>& among) {
    pair.in_the_way = between(pair.receiver, pair.source, &among);
    pair.visible = pair.unoccluded;
    if (!pair.in_the_way.empty()) estimate(pair);
  }

  // (R26) by one cubature over the receiver.
  void estimate(Pair& pair) {
    const V3d area_vector = polygon_area_vector(pair.receiver), normal = area_vector.normalized();
    Cubature& cubature = cubature_;
    make_cubature(pair.receiver, normal, cubature_order, cubature);
    seen_.assign(pair.in_the_way.size(), false);
    double all = 0.0, visible = 0.0;
    for (int k = 0; k < cubature.n; ++k) {
      const auto& [p, area] = cubature.points[k];
      const double unoccluded = signed_point_form_factor(p, normal, pair.source);
      all += area * unoccluded;
      visible += area * std::min(unoccluded, visible_form_factor(pair, p, normal, unoccluded));
    }
    pair.visible = all > 0.0 ? pair.unoccluded * std::clamp(visible / all, 0.0, 1.0) : 0.0;
    pair.unseen = 0.0;
    for (std::size_t i = 0; i < seen_.size() && pair.unseen < pair.visible; ++i)
      if (!seen_[i]) pair.unseen += most_hidden_by(pair.in_the_way[i], pair);
    pair.unseen = std::min(pair.unseen, pair.visible);
  }

  double visible_form_factor(const Pair& pair, const V3d& p, const V3d& normal, double unoccluded) {
    view_.begin(pair.source);
    bool changed = false;
    for (std::size_t i = 0; i < pair.in_the_way.size(); ++i) {
      if (view_.empty() && seen_[i]) continue;
      const Polygon& blocker = blockers_.polygon_[pair.in_the_way[i].blocker];
      const V3d& blocker_normal = blockers_.normal_[pair.in_the_way[i].blocker];
      if (blocker_normal.dot(p - blocker.v[0]) == 0.0) continue;
      const Shadow shadow(p, blocker, blocker_normal);
      if (shadow.clearly_misses(pair.source, blockers_.rounding_)) continue;
      // Seen even where others hide the same.
      seen_[i] = true;
      changed |= view_.subtract(shadow, blockers_.rounding_);
    }
    return changed ? view_.form_factor(p, normal) : unoccluded;
  }

  // What a blocker takes from a pair must reach it from both: an upper bound for one that no point has noticed.
  [[nodiscard]] static double most_hidden_by(const InTheWay& between, const Pair& pair) {
    constexpr double rough = 1e-2;
    Polygon turned = between.part;
    std::reverse(turned.v.begin(), turned.v.begin() + turned.n);
    const auto reaching = [&](const Polygon& from) {
      return exchange_exact(from, between.part, rough) + exchange_exact(from, turned, rough);
    };
    return std::min(reaching(pair.receiver), reaching(pair.source));
  }

  // The sum over the quarters of one side, if it agrees with the estimate of the whole; else that of theirs.
  double divided(const Pair& pair, double tolerance, int depth) {
    if (pair.in_the_way.empty()) return pair.visible;
    throw_if_interrupted();
    std::array<Pair, 4> part;
    double sum = 0.0, unseen = 0.0;
    const auto receivers = quarters(pair.receiver);
    for (int k = 0; k < 4; ++k) {
      part[k].receiver = receivers[k];
      part[k].source = pair.source;
      part[k].unoccluded = exchange_exact(receivers[k], pair.source, part_accuracy);
      look(part[k], pair.in_the_way);
      sum += part[k].visible;
      unseen += part[k].unseen;
    }
    const bool agree = std::abs(sum - pair.visible) <= tolerance && unseen <= tolerance;
    // The first agreement may be chance, and would cost the most: half a percent in one of 36 cases tried.
    const bool known = agree && (depth > 0 || sum == 0.0);
    if (known || depth == deepest_division) return sum;
    sum = 0.0;
    for (const Pair& p : part) sum += divided(p, 0.5 * tolerance, depth + 1);
    return sum;
  }

  const Blockers& blockers_;
  View view_;
  Cubature cubature_;
  std::vector<bool> seen_;
};

Blockers::Blockers(std::vector<Polygon> polygons) : polygon_(std::move(polygons)) {
  double largest = 0.0;
  for (const Polygon& polygon : polygon_) {
    normal_.push_back(polygon_area_vector(polygon).normalized());
    bounds_.push_back(bounds_of(polygon));
    largest = std::max(largest, largest_coordinate(polygon));
  }
  rounding_ = 64.0 * std::numeric_limits<double>::epsilon() * largest;
}

bool Blockers::none_between(const Polygon& a, const Polygon& b) const {
  return PairInSight(*this)
      .between(clip(a, b.v[0], polygon_area_vector(b)), clip(b, a.v[0], polygon_area_vector(a)))
      .empty();
}

// The segments between two convex polygons cross a plane that separates them in points that are convex
// combinations of where those between their corners do, so that it is enough to look at these.
bool Blockers::one_hides(const Polygon& a, const Polygon& b) const {
  const auto separates = [&](std::size_t k, double side) {
    const auto beyond = [&](const Polygon& polygon, double sign) {
      return std::all_of(polygon.v.begin(), polygon.v.begin() + polygon.n,
                         [&](const V3d& p) { return sign * normal_[k].dot(p - polygon_[k].v[0]) > rounding_; });
    };
    return beyond(a, side) && beyond(b, -side);
  };
  const auto holds = [&](std::size_t k, const V3d& p, const V3d& q) {
    const double at = normal_[k].dot(polygon_[k].v[0] - p) / normal_[k].dot(q - p);
    const V3d crossing = p + (q - p) * at;
    for (int i = 0; i < polygon_[k].n; ++i) {
      const V3d edge = polygon_[k].next(i) - polygon_[k].v[i];
      if (!(normal_[k].dot(edge.cross(crossing - polygon_[k].v[i])) > rounding_ * edge.length())) return false;
    }
    return true;
  };
  const auto hides = [&](std::size_t k) {
    if (!separates(k, 1.0) && !separates(k, -1.0)) return false;
    for (int i = 0; i < a.n; ++i)
      for (int j = 0; j < b.n; ++j)
        if (!holds(k, a.v[i], b.v[j])) return false;
    return true;
  };
  for (std::size_t k = 0; k < polygon_.size(); ++k)
    if (hides(k)) return true;
  return false;
}

double Blockers::visible_exchange(const Polygon& a, const Polygon& b, double unoccluded,
                                  double accuracy) const {
  return unoccluded > 0.0 ? PairInSight(*this).exchange(a, b, unoccluded, accuracy) : 0.0;
}

namespace {

// The quadrilateral that two triangles with a common edge make up, if it is flat and convex.
std::optional<Polygon> joined(const Polygon& s, const Polygon& t) {
  constexpr double straight = 1e-9;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      if (s.v[i] != t.next(j) || s.next(i) != t.v[j]) continue;
      const Polygon quad = make_polygon(s.v[i], t.v[(j + 2) % 3], s.next(i), s.v[(i + 2) % 3]);
      const V3d normal = polygon_area_vector(s).normalized();
      for (int k = 0; k < 4; ++k) {
        const V3d before = quad.next(k) - quad.v[k], after = quad.v[(k + 2) % 4] - quad.next(k);
        if (before.cross(after).dot(normal) <= straight * before.length() * after.length()) return std::nullopt;
      }
      return are_coplanar(s, t) ? std::optional(quad) : std::nullopt;
    }
  return std::nullopt;
}

}  // namespace

std::vector<Polygon> join_triangles(std::span<const Polygon> triangles) {
  std::vector<Polygon> polygons;
  for (const Polygon& triangle : triangles) {
    const std::optional<Polygon> quad =
        !polygons.empty() && polygons.back().n == 3 ? joined(polygons.back(), triangle) : std::nullopt;
    if (quad)
      polygons.back() = *quad;
    else
      polygons.push_back(triangle);
  }
  return polygons;
}

}  // namespace twopass
