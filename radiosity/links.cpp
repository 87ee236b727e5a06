#include "radiosity/links.h"

#include "radiosity/analytic_exchange.h"
#include "radiosity/form_factor_pair.h"
#include "radiosity/visibility.h"
#include "render/core/interrupt.h"
#include "render/core/parallel.h"
#include "render/core/sampler.h"

namespace twopass {

namespace {

// Between elements the method `exact` says how many; between larger nodes one link stands for many pairs.
constexpr std::uint32_t node_pairs = 16;
// How often pairs of nodes of which all rays agree are still partly hidden: as if that many of the rays had
// said so, either way.
constexpr double doubt = 0.1;

float largest(const C3f& a, const C3f& b) { return std::max({a.x * b.x, a.y * b.y, a.z * b.z}); }

// Upper bounds of a pair's exchange from the spheres around the nodes and the cones of their normals.
struct Bound {
  double exchange = 0.0;  // 0: they cannot see each other
  bool is_near = true;    // the spheres overlap: nothing is known of distance and direction

  Bound(const TreeNode& p, const TreeNode& q) {
    exchange = std::min(p.whole_area, q.whole_area);
    const V3d d = V3d(q.center) - V3d(p.center);
    const double distance = d.length(), reach = double{p.radius} + q.radius;
    if (lies_behind(p, q, d) || lies_behind(q, p, -d)) exchange = 0.0;
    if (!(distance > reach)) return;
    is_near = false;
    const double widening = std::asin(reach / distance);
    const double cos_p = largest_cosine(p, d / distance, widening);
    const double cos_q = largest_cosine(q, -d / distance, widening);
    const double gap = distance - reach;
    exchange = std::min(exchange, p.whole_area * q.whole_area * cos_p * cos_q / (pi * gap * gap));
  }

 private:
  // All of the other node is behind the plane of a flat one.
  static bool lies_behind(const TreeNode& flat, const TreeNode& other, const V3d& to_other) {
    return flat.is_flat && V3d(flat.axis).dot(to_other) < -double{other.radius} * (1.0 + 1e-5);
  }
  static double largest_cosine(const TreeNode& node, const V3d& direction, double widening) {
    const double angle = std::acos(std::clamp(V3d(node.axis).dot(direction), -1.0, 1.0));
    return std::max(0.0, std::cos(std::min(pi, std::max(0.0, angle - node.cone - widening))));
  }
};

// (R31): the kernel between four points of each node, and what its rows and columns say of its spread.
struct KernelSamples {
  std::array<std::array<double, 4>, 4> value{};  // cos cos / (pi r^2)

  explicit KernelSamples(double constant) {
    for (auto& row : value) row.fill(constant);
  }
  KernelSamples(const std::array<ElementPoint, 4>& a, const std::array<ElementPoint, 4>& b) {
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 4; ++k) {
        const V3d d = b[k].position - a[i].position;
        const double cos_a = a[i].normal.dot(d), cos_b = -b[k].normal.dot(d), d2 = d.dot(d);
        if (cos_a > 0.0 && cos_b > 0.0) value[i][k] = cos_a * cos_b / (pi * d2 * d2);
      }
  }
  void remove_hidden(const RayCaster& caster, const std::array<ElementPoint, 4>& a,
                     const std::array<ElementPoint, 4>& b, std::uint64_t& rays) {
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 4; ++k) {
        if (value[i][k] == 0.0) continue;
        ++rays;
        if (caster.occluded(a[i].ray_position(), b[k].ray_position())) value[i][k] = 0.0;
      }
  }
  [[nodiscard]] double mean() const {
    double sum = 0.0;
    for (const auto& row : value)
      for (const double v : row) sum += v;
    return sum / 16.0;
  }
  // Standard deviation over the first node (rows) or the second (columns) of the mean over the other.
  [[nodiscard]] double spread(bool of_rows) const {
    const double all = mean();
    double sum = 0.0;
    for (int i = 0; i < 4; ++i) {
      double mean_i = 0.0;
      for (int k = 0; k < 4; ++k) mean_i += 0.25 * (of_rows ? value[i][k] : value[k][i]);
      sum += (mean_i - all) * (mean_i - all);
    }
    return std::sqrt(sum / 3.0);
  }
};

// Standard error of a visible fraction, which is not zero when all rays agree.
double visibility_error(double visible) {
  const double believed = (visible * node_pairs + doubt) / (node_pairs + 2.0 * doubt);
  return std::sqrt(believed * (1.0 - believed) / node_pairs);
}

}  // namespace

struct LinkRefiner::Output {
  std::vector<Link> links;
  std::vector<Pair> pairs;  // to be looked at next
  std::uint64_t rays = 0;
};

// One step of a refinement.
class LinkRefiner::Search {
 public:
  Search(const LinkRefiner& refiner, std::span<const NodeLight> light, double epsilon)
      : refiner_(refiner), tree_(refiner.tree_), light_(light), epsilon_(epsilon) {}

  // Links the pair, or names the pairs of its parts, or drops it.
  void visit(const Pair& pair, Output& output) const {
    const TreeNode &p = tree_.node(pair.p), &q = tree_.node(pair.q);
    if (!(p.area > 0.0) || !(q.area > 0.0)) return;
    if (pair.p == pair.q ? p.is_flat : p.is_flat && q.is_flat && p.root == q.root && p.root != no_index) return;
    const Bound bound(p, q);
    if (!(bound.exchange > 0.0)) return;
    if (p.kind == TreeNode::element && q.kind == TreeNode::element)
      p.is_patchwork || q.is_patchwork ? link_patchworks(pair, bound, output) : link_elements(pair, output);
    else if (is_polygon(p) && is_polygon(q))
      link_polygons(pair, bound, output);
    else
      link_by_samples(pair, bound, output);
  }

  // The pairs of the parts of one of the nodes with the other, or of all parts with each other.
  void divide(const Pair& pair, bool divide_p, Output& output) const {
    const TreeNode &p = tree_.node(pair.p), &q = tree_.node(pair.q);
    if (pair.p == pair.q) {
      for (std::uint32_t a = 0; a < p.child_count; ++a)
        for (std::uint32_t b = a; b < p.child_count; ++b)
          output.pairs.push_back({p.first_child + a, p.first_child + b});
      return;
    }
    const TreeNode& divided = divide_p ? p : q;
    const std::uint32_t other = divide_p ? pair.q : pair.p;
    for (std::uint32_t c = divided.first_child; c < divided.first_child + divided.child_count; ++c)
      output.pairs.push_back({std::min(c, other), std::max(c, other)});
  }

 private:
  // Flat, or so small a piece of an analytic surface that it counts as flat.
  static bool is_polygon(const TreeNode& node) {
    return node.is_flat || (node.kind == TreeNode::element && !node.is_patchwork);
  }
  [[nodiscard]] std::uint32_t key(const Pair& pair) const {
    return static_cast<std::uint32_t>(
        hash_words(static_cast<std::uint32_t>(hash_words(refiner_.seed_, pair.p)), pair.q));
  }
  // Divides the pair if the link is not good enough.
  bool is_too_coarse(const Pair& pair, const Link& link, Output& output) const {
    const LinkError error = refiner_.error(link, light_);
    if (!(error.power > epsilon_)) return false;
    divide(pair, error.divide_p, output);
    return true;
  }

  // As the method `exact` does it.
  void link_elements(const Pair& pair, Output& output) const {
    std::uint32_t i = tree_.element_of(tree_.node(pair.p)), j = tree_.element_of(tree_.node(pair.q));
    Patch a = tree_.surface(tree_.node(pair.p)).patch, b = tree_.surface(tree_.node(pair.q)).patch;
    if (i > j) {
      std::swap(i, j);
      std::swap(a, b);
    }
    const double unoccluded = unoccluded_exchange(a, b, FormFactorMethod::exact);
    if (!(unoccluded > 0.0)) return;
    const auto seed = static_cast<std::uint32_t>(hash_words(refiner_.seed_, i));
    const auto pair_key = static_cast<std::uint32_t>(hash_words(seed, j));
    const double visible =
        i == j ? 1.0
               : visible_fraction(refiner_.caster_, a, b, pair_key,
                                  visibility_pairs(unoccluded, tree_.node(0).whole_area), output.rays);
    if (visible > 0.0)
      output.links.push_back({pair.p, pair.q, static_cast<float>(unoccluded * visible), 0.0f, 0.0f, 0.0f});
  }

  // The method `exact` would visit all pairs of their triangles. Sixteen pairs of points stand for them, and
  // where the kernel grows too large for that, (R2) from the points of either to the triangles of the other.
  void link_patchworks(const Pair& pair, const Bound& bound, Output& output) const {
    if (pair.p == pair.q) return;
    const TreeNode &p = tree_.node(pair.p), &q = tree_.node(pair.q);
    const auto a = tree_.points(p, key(pair)), b = tree_.points(q, key(pair) + 1);
    KernelSamples kernel(a, b);
    const double sampled = kernel.mean();
    double exchange = p.whole_area * q.whole_area * sampled;
    if ((V3d(p.center) - V3d(q.center)).length() < 3.0 * (double{p.radius} + q.radius))
      exchange = 0.5 * (p.whole_area * tree_.form_factor(a, q) + q.whole_area * tree_.form_factor(b, p));
    if (!(exchange > 0.0)) return;
    if (sampled > 0.0) {
      kernel.remove_hidden(refiner_.caster_, a, b, output.rays);
      exchange *= kernel.mean() / sampled;
    }
    exchange = std::min(bound.exchange, exchange);
    if (exchange > 0.0)
      output.links.push_back({pair.p, pair.q, static_cast<float>(exchange), 0.0f, 0.0f, 0.0f});
  }

  // The exchange is exact but for visibility.
  void link_polygons(const Pair& pair, const Bound& bound, Output& output) const {
    const NodeSurface a = tree_.surface(tree_.node(pair.p)), b = tree_.surface(tree_.node(pair.q));
    const double exchange = exchange_exact(a.polygon, b.polygon, 1e-3) * a.area_scale * b.area_scale;
    if (!(exchange > 0.0)) return;
    double spread_p = exchange, spread_q = exchange;
    if (!bound.is_near) {
      const KernelSamples kernel(a.quarters(), b.quarters());
      if (const double mean = kernel.mean(); mean > 0.0) {
        spread_p = exchange * std::min(1.0, kernel.spread(true) / mean);
        spread_q = exchange * std::min(1.0, kernel.spread(false) / mean);
      }
    }
    Link link = make_link(pair, exchange, spread_p, spread_q, 0.0);
    if (is_too_coarse(pair, link, output)) return;  // whatever the rays might say
    const double visible = visible_fraction(refiner_.caster_, a, b, key(pair), node_pairs, output.rays);
    const double hidden = exchange * std::sqrt(visible * (1.0 - visible));
    link = make_link(pair, exchange * visible, spread_p * visible + hidden, spread_q * visible + hidden,
                     exchange * visibility_error(visible));
    if (!is_too_coarse(pair, link, output)) output.links.push_back(link);
  }

  void link_by_samples(const Pair& pair, const Bound& bound, Output& output) const {
    const TreeNode &p = tree_.node(pair.p), &q = tree_.node(pair.q);
    const double radius = tree_.radius_of_common_inside(p, q);
    const double areas = p.whole_area * q.whole_area;
    // Where nothing is known but the bound it is the error, too.
    const double floor = radius > 0.0 ? 0.0 : bound.is_near ? bound.exchange : 0.02 * bound.exchange;
    if (is_too_coarse(pair, make_link(pair, 0.0, floor, floor, 0.0), output)) return;
    const std::uint32_t k = key(pair);
    const auto a = tree_.points(p, k), b = tree_.points(q, k + 1);
    KernelSamples kernel =
        radius > 0.0 ? KernelSamples(1.0 / (4.0 * pi * radius * radius)) : KernelSamples(a, b);
    const double unoccluded = std::min(bound.exchange, areas * kernel.mean());
    const auto link_of_kernel = [&](double visibility) {
      const double spread_p = areas * kernel.spread(true), spread_q = areas * kernel.spread(false);
      return make_link(pair, std::min(bound.exchange, areas * kernel.mean()), std::max(floor, spread_p),
                       std::max(floor, spread_q),
                       std::hypot(0.5 * spread_p, 0.5 * spread_q, unoccluded * visibility));
    };
    if (is_too_coarse(pair, link_of_kernel(0.0), output)) return;
    kernel.remove_hidden(refiner_.caster_, a, b, output.rays);
    const double visible = unoccluded > 0.0 ? std::min(1.0, areas * kernel.mean() / unoccluded) : 0.0;
    const Link link = link_of_kernel(visibility_error(visible));
    if (!is_too_coarse(pair, link, output)) output.links.push_back(link);
  }

  // The spread over an element is no error: its radiosity is constant by definition.
  [[nodiscard]] Link make_link(const Pair& pair, double exchange, double spread_p, double spread_q,
                               double noise) const {
    if (tree_.node(pair.p).kind == TreeNode::element) spread_p = 0.0;
    if (tree_.node(pair.q).kind == TreeNode::element) spread_q = 0.0;
    return {pair.p,
            pair.q,
            static_cast<float>(exchange),
            static_cast<float>(spread_p),
            static_cast<float>(spread_q),
            static_cast<float>(noise)};
  }

  const LinkRefiner& refiner_;
  const ElementTree& tree_;
  std::span<const NodeLight> light_;
  double epsilon_;
};

LinkError LinkRefiner::error(const Link& link, std::span<const NodeLight> light) const {
  const TreeNode &p = tree_.node(link.p), &q = tree_.node(link.q);
  const NodeLight &light_p = light[link.p], &light_q = light[link.q];
  // A part of p receives more than another, or sends more to q where p is brighter than its mean.
  const double from_q = largest(p.reflectance, light_q.radiosity),
               from_p = largest(q.reflectance, light_p.radiosity);
  const double by_p = link.spread_p * std::max<double>(from_q, largest(q.reflectance, light_p.deviation));
  const double by_q = link.spread_q * std::max<double>(from_p, largest(p.reflectance, light_q.deviation));
  LinkError error{std::max({by_p, by_q, link.noise * std::max(from_p, from_q)}), by_p > by_q};
  if (by_p == by_q || error.power > std::max(by_p, by_q)) error.divide_p = p.radius > q.radius;
  if (p.kind == TreeNode::element) error.divide_p = false;
  if (q.kind == TreeNode::element) error.divide_p = true;
  return error;
}

bool LinkRefiner::refine(std::vector<Link>& links, std::span<const NodeLight> light, double epsilon,
                         std::size_t most, std::uint64_t& rays) const {
  constexpr std::size_t chunk = 256;
  Output all;
  if (links.empty()) {
    all.pairs.push_back({0, 0});
  } else {
    const Search search(*this, light, epsilon);
    for (const Link& link : links) {
      const LinkError link_error = error(link, light);
      if (link_error.power > epsilon && links.size() < most)
        search.divide({link.p, link.q}, link_error.divide_p, all);
      else
        all.links.push_back(link);
    }
  }
  const bool divided = !all.pairs.empty();
  while (!all.pairs.empty()) {
    throw_if_interrupted();
    const bool is_full = all.links.size() + all.pairs.size() >= most;
    const Search search(*this, light, is_full ? std::numeric_limits<double>::infinity() : epsilon);
    const std::vector<Pair> pairs = std::move(all.pairs);
    all.pairs.clear();
    std::vector<Output> outputs((pairs.size() + chunk - 1) / chunk);
    parallel_for(outputs.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end; ++c)
        for (std::size_t i = c * chunk; i < std::min(pairs.size(), (c + 1) * chunk); ++i)
          search.visit(pairs[i], outputs[c]);
    });
    for (const Output& output : outputs) {
      all.links.insert(all.links.end(), output.links.begin(), output.links.end());
      all.pairs.insert(all.pairs.end(), output.pairs.begin(), output.pairs.end());
      rays += output.rays;
    }
  }
  links = std::move(all.links);
  return divided;
}

}  // namespace twopass
