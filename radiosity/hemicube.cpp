#include "radiosity/hemicube.h"

#include <atomic>
#include <utility>

#include "radiosity/analytic_exchange.h"
#include "radiosity/hemicube_pixels.h"
#include "radiosity/landing.h"
#include "render/core/error.h"
#include "render/core/interrupt.h"
#include "render/core/parallel.h"
#include "render/core/sampler.h"

namespace twopass {

namespace {

struct Entry {
  std::uint32_t column;
  double factor;
};

// What one element's hemicube has seen.
struct View {
  std::vector<Entry> factors;  // by ascending column
  bool covered = false;        // mostly of what lies right on top of it: it tells nothing
};

// The two axes across the normal, turned about it by a hash of the element.
Frame turned_frame(const V3f& normal, std::uint32_t seed, std::uint32_t element) {
  const Frame frame(normal);
  // A quarter turn maps the cube onto itself.
  const float angle = 0.5f * pi_f * Sampler(seed, element, 0).next_1d();
  Frame turned = frame;
  turned.s = frame.s * std::cos(angle) + frame.t * std::sin(angle);
  turned.t = frame.t * std::cos(angle) - frame.s * std::sin(angle);
  return turned;
}

class Hemicube {
 public:
  Hemicube(const Scene& scene, const ElementMesh& mesh, int resolution, std::uint32_t seed)
      : scene_(scene), mesh_(mesh), pixels_(hemicube_pixels(resolution)), seed_(seed) {}

  // `seen`: as many zeros as there are elements, before and after.
  [[nodiscard]] View look(std::uint32_t element, std::vector<double>& seen, std::uint64_t& rays) const {
    View view;
    if (!(mesh_.area(element) > 0.0)) {
      view.covered = true;
      return view;
    }
    const ElementPoint start = mesh_.centroid(element);
    const V3f normal(start.normal);
    const Frame frame = turned_frame(normal, seed_, element);
    const float size = mesh_.size(element);
    double covered = 0.0;
    for (const HemicubePixel& pixel : pixels_) {
      const Ray ray{start.ray_position(), frame.to_world(V3f(pixel.direction))};
      const Hit hit = scene_.caster().intersect(ray);
      if (hit.escaped()) continue;
      const SurfacePoint point = scene_.surface_point(ray, hit);
      if (is_covered(scene_, ray, hit, point, normal, size)) {
        covered += pixel.weight;
        continue;
      }
      const std::uint32_t other = mesh_.find(point);
      if (other == no_index) continue;
      if (seen[other] == 0.0) view.factors.push_back({other, 0.0});
      seen[other] += pixel.weight;
    }
    rays += pixels_.size();
    collect(view, seen);
    view.covered = covered > 0.5;
    return view;
  }

 private:
  static void collect(View& view, std::vector<double>& seen) {
    std::sort(view.factors.begin(), view.factors.end(),
              [](const Entry& a, const Entry& b) { return a.column < b.column; });
    for (Entry& entry : view.factors) entry.factor = std::exchange(seen[entry.column], 0.0);
  }

  const Scene& scene_;
  const ElementMesh& mesh_;
  std::vector<HemicubePixel> pixels_;
  std::uint32_t seed_;
};

// (R24): F of each row, and 1 / A of those whose estimates count.
ExchangeMatrix joined_estimates(const std::vector<View>& views, const ElementMesh& mesh) {
  const auto n = static_cast<Eigen::Index>(views.size());
  ExchangeMatrix factors(n, n);
  std::size_t entries = 0;
  for (const View& view : views) entries += view.covered ? 0 : view.factors.size();
  factors.reserve(static_cast<Eigen::Index>(entries));
  for (std::size_t i = 0; i < views.size(); ++i) {
    factors.startVec(static_cast<Eigen::Index>(i));
    if (views[i].covered) continue;
    for (const Entry& entry : views[i].factors)
      factors.insertBack(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(entry.column)) =
          static_cast<float>(entry.factor);
  }
  factors.finalize();
  const ExchangeMatrix reverse = factors.transpose();
  ExchangeMatrix exchange = factors + reverse;
  const auto counts = [&](std::size_t i) {
    return views[i].covered ? 0.0 : 1.0 / mesh.area(static_cast<std::uint32_t>(i));
  };
  for (std::uint32_t i = 0; i < views.size(); ++i)
    for (ExchangeMatrix::InnerIterator it(exchange, i); it; ++it) {
      const auto j = static_cast<std::uint32_t>(it.col());
      const bool both_exist = mesh.area(i) > 0.0 && mesh.area(j) > 0.0;
      it.valueRef() =
          both_exist ? static_cast<float>(static_cast<double>(it.value()) / (counts(i) + counts(j))) : 0.0f;
    }
  return exchange;
}

}  // namespace

ExchangeMatrix hemicube_exchange(const Scene& scene, const ElementMesh& mesh, int resolution,
                                 std::uint32_t seed, std::uint64_t& rays) {
  const std::size_t n = mesh.count();
  if (n > analytic_max_elements)
    throw Error("form factors",
                std::to_string(n) + " elements are more than the " + std::to_string(analytic_max_elements) +
                    " whose hemicubes can all be filled",
                "use --form-factors rays, or fewer elements (--elements)");
  const Hemicube hemicube(scene, mesh, resolution, seed);
  std::vector<View> views(n);
  std::atomic<std::uint64_t> rays_cast{0};
  parallel_for(n, 16, [&](std::size_t begin, std::size_t end) {
    std::vector<double> seen(n, 0.0);
    std::uint64_t own_rays = 0;
    for (std::size_t i = begin; i < end; ++i) {
      throw_if_interrupted();
      views[i] = hemicube.look(static_cast<std::uint32_t>(i), seen, own_rays);
    }
    rays_cast += own_rays;
  });
  rays += rays_cast;
  return joined_estimates(views, mesh);
}

}  // namespace twopass
