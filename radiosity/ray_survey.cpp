#include "radiosity/ray_survey.h"

#include <atomic>
#include <optional>

#include "radiosity/landing.h"
#include "radiosity/specular_path.h"
#include "render/core/interrupt.h"
#include "render/core/parallel.h"
#include "render/core/warp.h"

namespace twopass {

namespace {

// What the rays of one element have found besides their landings.
struct Finding {
  std::vector<SpecularLink> links;
  C3d sky{0.0};  // sum over rays of what they carry from the sky, W/(m2 sr)
  bool met_gloss = false;
};

constexpr double smallest_exposed = 1.0 / 16.0;

std::size_t count_exposed(std::span<const std::uint32_t> sorted) {
  return static_cast<std::size_t>(std::lower_bound(sorted.begin(), sorted.end(), RaySurvey::buried) -
                                  sorted.begin());
}

// Counts of all elements together. Sums of integers, so the order of threads does not matter.
struct Tally {
  std::atomic<std::uint64_t> lamp{0}, black{0}, specular{0}, sky{0}, rays{0};
  std::atomic<bool> gloss{false};
};

// How the survey's list says it.
std::uint32_t code_of(const Landing& landing) {
  switch (landing.kind) {
    case Landing::on_element:
      return landing.element;
    case Landing::on_lamp:
      return RaySurvey::on_lamp;
    case Landing::on_black:
      return RaySurvey::on_black;
    case Landing::on_specular:
      return RaySurvey::on_specular;
    case Landing::in_the_sky:
      return RaySurvey::in_the_sky;
    case Landing::buried:
      break;
  }
  return RaySurvey::buried;
}

class ElementSurvey {
 public:
  ElementSurvey(const Scene& scene, const ElementMesh& mesh, std::uint32_t seed)
      : scene_(scene), mesh_(mesh), element_rays_(scene, mesh), seed_(seed) {
    // Of an even sky, rays of their own would know no more.
    const Environment& sky = scene.environment();
    if (!sky.is_black() && !sky.constant())
      sky_.emplace(std::span<const Shape>(), std::span<const PunctualLight>(), sky, scene.bounds());
  }

  // Casts the rays of an element and writes their landings, sorted.
  Finding run(std::uint32_t element, std::span<std::uint32_t> landings, std::uint64_t& rays) const {
    Finding finding;
    if (!(mesh_.area(element) > 0.0)) {
      std::fill(landings.begin(), landings.end(), RaySurvey::buried);
      return finding;
    }
    const ElementSampler sample(mesh_, element);
    const float size = mesh_.size(element);
    for (std::uint32_t k = 0; k < landings.size(); ++k) {
      Sampler sampler(seed_, element, k);
      const ElementPoint start = sample(sampler.next_2d());
      const V3f direction = Frame(V3f(start.normal)).to_world(square_to_cosine_hemisphere(sampler.next_2d()));
      landings[k] = cast({start.ray_position(), direction}, V3f(start.normal), size, sampler, finding, rays);
      if (sky_ && landings[k] != RaySurvey::buried) sample_sky(start, sampler, finding, rays);
    }
    std::sort(landings.begin(), landings.end());
    const auto exposed = static_cast<double>(count_exposed(landings));
    // What is left of an element that is all but buried is too little for a measurement.
    if (exposed < smallest_exposed * static_cast<double>(landings.size())) return {};
    merge_links(finding.links, static_cast<float>(1.0 / exposed));
    finding.sky *= 1.0 / exposed;
    return finding;
  }

 private:
  std::uint32_t cast(const Ray& ray, const V3f& normal, float size, Sampler& sampler, Finding& finding,
                     std::uint64_t& rays) const {
    const Landing landing = element_rays_.cast(ray, normal, size, sampler, rays);
    if (landing.kind == Landing::in_the_sky)
      finding.sky += C3d(scene_.environment().radiance(ray.direction)) *
                     (1.0 - share_of_sampling(ray.origin, normal, ray.direction));
    if (landing.goes_on) {
      finding.met_gloss = finding.met_gloss || landing.kind == Landing::on_element;
      follow(ray, landing.point, sampler, finding, rays);
    }
    return code_of(landing);
  }

  // Veach's balance heuristic between the element's rays and as many that are drawn from the sky, where the sun
  // is found by the latter alone: the latter's share of a direction.
  [[nodiscard]] double share_of_sampling(const V3f& start, const V3f& normal, const V3f& direction) const {
    if (!sky_) return 0.0;
    const double own = sky_->escaped_pdf_w({start, normal, true}, direction),
                 others = cosine_hemisphere_pdf_w(direction.dot(normal));
    return own + others > 0.0 ? own / (own + others) : 0.0;
  }
  void sample_sky(const ElementPoint& start, Sampler& sampler, Finding& finding, std::uint64_t& rays) const {
    const V3f from = start.ray_position(), normal(start.normal);
    const LightSample sky = sky_->sample({from, normal, true}, sampler.next_2d());
    const float cosine = sky.direction.dot(normal);
    if (!(sky.pdf_w > 0.0f && cosine > 0.0f) || is_black(sky.radiance)) return;
    ++rays;
    if (scene_.caster().occluded(from, sky.position)) return;
    // Radiance as a cosine-distributed ray would have found it.
    const double others = cosine_hemisphere_pdf_w(cosine);
    finding.sky += C3d(sky.radiance) * (others / (static_cast<double>(sky.pdf_w) + others));
  }

  // (R15): a specular surface is not an end but a continuation.
  void follow(const Ray& ray, const SurfacePoint& point, Sampler& sampler, Finding& finding,
              std::uint64_t& rays) const {
    SpecularPath path(scene_, ray, point, Carried::radiance, sampler);
    while (path.next()) {
      const SpecularPathEnd& end = path.end();
      if (end.escaped) {
        finding.sky += C3d(end.weight * scene_.environment().radiance(end.direction));
        break;
      }
      const std::uint32_t element = mesh_.find(end.point);
      if (element != no_index) finding.links.push_back({element, end.weight});
    }
    rays += path.rays();
  }

  // One link for each source: sums in the order of rays, which is that of the stable sort.
  static void merge_links(std::vector<SpecularLink>& links, float scale) {
    std::stable_sort(links.begin(), links.end(),
                     [](const SpecularLink& a, const SpecularLink& b) { return a.element < b.element; });
    std::size_t kept = 0;
    for (const SpecularLink& link : links) {
      if (kept > 0 && links[kept - 1].element == link.element)
        links[kept - 1].weight += link.weight * scale;
      else
        links[kept++] = {link.element, link.weight * scale};
    }
    links.resize(kept);
  }

  const Scene& scene_;
  const ElementMesh& mesh_;
  ElementRays element_rays_;
  std::uint32_t seed_;
  std::optional<Lights> sky_;
};

void count_landings(std::span<const std::uint32_t> sorted, Tally& tally) {
  const auto count = [&](std::uint32_t landing) {
    const auto range = std::equal_range(sorted.begin(), sorted.end(), landing);
    return static_cast<std::uint64_t>(range.second - range.first);
  };
  tally.lamp += count(RaySurvey::on_lamp);
  tally.black += count(RaySurvey::on_black);
  tally.specular += count(RaySurvey::on_specular);
  tally.sky += count(RaySurvey::in_the_sky);
}

SpecularLinks join_links(const std::vector<std::vector<SpecularLink>>& links) {
  SpecularLinks all;
  std::size_t total = 0;
  for (const auto& own : links) total += own.size();
  if (total == 0) return all;
  all.link.reserve(total);
  all.first.reserve(links.size() + 1);
  for (const auto& own : links) {
    all.first.push_back(all.link.size());
    all.link.insert(all.link.end(), own.begin(), own.end());
  }
  all.first.push_back(all.link.size());
  return all;
}

float share_of(std::span<const std::uint32_t> sorted, std::uint32_t first, std::uint32_t last) {
  const auto begin = std::lower_bound(sorted.begin(), sorted.end(), first);
  const auto end = std::upper_bound(sorted.begin(), sorted.end(), last);
  const std::size_t exposed = count_exposed(sorted);
  return exposed == 0 ? 0.0f
                      : static_cast<float>(static_cast<double>(end - begin) / static_cast<double>(exposed));
}

float exposed_part(std::span<const std::uint32_t> sorted) {
  const double part = static_cast<double>(count_exposed(sorted)) / static_cast<double>(sorted.size());
  return part < smallest_exposed ? 0.0f : static_cast<float>(part);
}

}  // namespace

RaySurvey survey_with_rays(const Scene& scene, const ElementMesh& mesh, std::uint32_t rays_per_element,
                           std::uint32_t seed, Keep keep) {
  const std::size_t n = mesh.count();
  RaySurvey survey;
  survey.rays_per_element = rays_per_element;
  if (keep == Keep::landings) survey.landings.resize(n * rays_per_element);
  survey.exposed.resize(n);
  survey.shares.resize(n);
  survey.sky.resize(n, C3f(0.0f));
  std::vector<std::vector<SpecularLink>> links(keep == Keep::totals ? 0 : n);
  const ElementSurvey element_survey(scene, mesh, seed);
  Tally tally;
  parallel_for(n, 32, [&](std::size_t begin, std::size_t end) {
    throw_if_interrupted();
    std::uint64_t rays = 0;
    std::vector<std::uint32_t> own(rays_per_element);
    for (std::size_t i = begin; i < end; ++i) {
      const std::span<std::uint32_t> landings =
          keep == Keep::landings ? std::span(survey.landings).subspan(i * rays_per_element, rays_per_element)
                                 : std::span(own);
      Finding finding = element_survey.run(static_cast<std::uint32_t>(i), landings, rays);
      count_landings(landings, tally);
      if (finding.met_gloss) tally.gloss = true;
      survey.exposed[i] = exposed_part(landings);
      survey.shares[i] = {share_of(landings, 0, RaySurvey::on_lamp - 1),
                          share_of(landings, RaySurvey::on_specular, RaySurvey::on_specular),
                          share_of(landings, RaySurvey::in_the_sky, RaySurvey::in_the_sky)};
      survey.sky[i] = C3f(finding.sky * pi);
      if (keep != Keep::totals) links[i] = std::move(finding.links);
    }
    tally.rays += rays;
  });
  survey.specular = join_links(links);
  survey.met_lamp = tally.lamp;
  survey.met_black = tally.black;
  survey.met_specular = tally.specular;
  survey.met_sky = tally.sky;
  survey.met_gloss = tally.gloss;
  survey.rays = tally.rays;
  return survey;
}

ExchangeMatrix exchange_from_landings(const RaySurvey& survey, const ElementMesh& mesh) {
  // N / A of whole elements, which is that of their exposed parts, too.
  std::vector<double> rays_by_area(mesh.count());
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    rays_by_area[i] = survey.rays_per_element / mesh.whole_area(i);
  const auto n = static_cast<Eigen::Index>(mesh.count());
  ExchangeMatrix hits(n, n);
  hits.reserve(static_cast<Eigen::Index>(survey.landings.size()));
  for (std::uint32_t i = 0; i < mesh.count(); ++i) {
    hits.startVec(i);
    const std::span<const std::uint32_t> sorted = survey.landings_of(i);
    for (std::size_t k = 0; k < sorted.size() && sorted[k] < RaySurvey::on_lamp;) {
      const std::size_t run = k;
      while (k < sorted.size() && sorted[k] == sorted[run]) ++k;
      hits.insertBack(i, static_cast<Eigen::Index>(sorted[run])) = static_cast<float>(k - run);
    }
  }
  hits.finalize();
  if (!mesh.weights().empty()) {
    // Rays from weighted points say what the element sees, not what sees it.
    for (std::uint32_t i = 0; i < mesh.count(); ++i)
      for (ExchangeMatrix::InnerIterator it(hits, i); it; ++it)
        it.valueRef() *= static_cast<float>(1.0 / rays_by_area[i]);
    return hits;
  }
  const ExchangeMatrix reverse = hits.transpose();
  ExchangeMatrix exchange = hits + reverse;
  // (R13): each of the two counts is Poisson of mean N F; their sum over N / A_i + N / A_j has the least
  // variance.
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    for (ExchangeMatrix::InnerIterator it(exchange, i); it; ++it) {
      const double density = rays_by_area[i] + rays_by_area[static_cast<std::size_t>(it.col())];
      it.valueRef() *= static_cast<float>(1.0 / density);
    }
  return exchange;
}

}  // namespace twopass
