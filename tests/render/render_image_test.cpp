#include "render/render_image.h"

#include <atomic>
#include <mutex>

#include <gtest/gtest.h>

#include "integrators/path.h"
#include "render/core/interrupt.h"
#include "render/core/parallel.h"
#include "tests/support/scenes.h"
#include "tests/support/statistics.h"

namespace twopass {
namespace {

// Radiance that is a known function of the ray, with noise of known size, and now and then something broken.
class Synthetic final : public Integrator {
 public:
  explicit Synthetic(float noise, bool broken = false) : noise_(noise), broken_(broken) {}
  void trace(std::span<PathSample> samples, RayCounts& counts) const override {
    counts.rays += samples.size();
    for (PathSample& sample : samples) {
      const float u = sample.sampler.next_1d();
      sample.seen = {broken_ && u < 0.25f ? C3f(NAN) : C3f(1.0f + noise_ * (u - 0.5f)), 1.0f};
    }
  }

 private:
  float noise_;
  bool broken_;
};

const CameraDescription description{look_at({0.5, 0.1, 0.5}, {0.5, 1, 0.5}, {0, 0, 1}, "test"), 60.0,
                                    FovAxis::x};

RenderOutcome run(const Integrator& integrator, Film& film, const SamplingGoal& goal, std::uint32_t seed = 1) {
  const Camera camera(description, film.width(), film.height());
  return render_image({integrator, camera, box_filter(), goal, seed, SamplerKind::sobol, {}}, film);
}

TEST(RenderImage, TakesExactlyTheSamplesAskedFor) {
  for (const int spp : {1, 7, 16, 100}) {
    Film film(35, 18);
    const RenderOutcome outcome = run(Synthetic(1.0f), film, {spp, 0, 0});
    EXPECT_EQ(film.samples(), 35u * 18u * static_cast<unsigned>(spp));
    EXPECT_EQ(outcome.counts.rays, film.samples());
    EXPECT_EQ(outcome.stop_reason, "samples");
    EXPECT_EQ(outcome.non_finite_samples, 0u);
  }
}

TEST(RenderImage, SameBytesOnAnyNumberOfThreads) {
  const Scene scene(test::unit_room(C3f(0.7f), C3f(1.0f), C3f(0.7f)));
  const PathTracer path(scene, {});
  std::vector<Image> images;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    Film film(50, 40);
    run(path, film, {8, 0, 0});
    images.push_back(film.resolve());
  }
  EXPECT_EQ(images[0].pixels, images[1].pixels);
  EXPECT_EQ(images[0].pixels, images[2].pixels);
  Film other(50, 40);
  run(path, other, {8, 0, 0}, 2);
  EXPECT_NE(images[0].pixels, other.resolve().pixels);
}

// A part of the picture is what the whole has there, to the bit: through a pinhole and through a lens.
TEST(RenderImage, APartIsTheSameAsInTheWhole) {
  const Scene scene(test::unit_room(C3f(0.7f), C3f(1.0f), C3f(0.7f)));
  const PathTracer path(scene, {});
  for (const double aperture : {0.0, 0.1}) {
    CameraDescription lens = description;
    lens.aperture_radius = aperture;
    const Camera camera(lens, 50, 40);
    Film whole(50, 40), part(20, 10);
    const SamplingGoal goal{4, 0, 0};
    render_image({path, camera, lanczos_filter(), goal, 1, SamplerKind::sobol, {}, {}}, whole);
    render_image({path, camera, lanczos_filter(), goal, 1, SamplerKind::sobol, {}, {}, V2i(17, 25)}, part);
    for (int y = 0; y < 10; ++y)
      for (int x = 0; x < 20; ++x) ASSERT_EQ(part.pixel(x, y).mean(), whole.pixel(x + 17, y + 25).mean());
  }
}

// What lies before the near and beyond the far clipping plane is not seen, but it lights and shades.
TEST(RenderImage, ClippingPlanesCut) {
  const Scene scene(test::unit_room(C3f(0.7f), C3f(1.0f), C3f(0.7f)));
  const PathTracer path(scene, {});
  const auto alpha = [&](double near_clip, double far_clip) {
    CameraDescription clipped = description;  // looks along +y; the far wall is at depth 0.9
    clipped.near_clip = near_clip;
    clipped.far_clip = far_clip;
    Film film(1, 1);
    render_image({path, Camera(clipped, 1, 1), box_filter(1e-3f), {4, 0, 0}, 1, SamplerKind::sobol, {}}, film);
    return film.pixel(0, 0).mean_alpha();
  };
  EXPECT_EQ(alpha(0.0, infinity_f), 1.0);
  EXPECT_EQ(alpha(0.01, 0.91), 1.0);
  EXPECT_EQ(alpha(0.01, 0.89), 0.0);
  EXPECT_EQ(alpha(0.91, 1e4), 0.0);
}

// Pixels beside a bright edge are negative under kernels with negative lobes; the goal of noise is met all the
// same.
TEST(RenderImage, NegativePixelsAndNoiseGoals) {
  class Edge final : public Integrator {
   public:
    void trace(std::span<PathSample> samples, RayCounts& counts) const override {
      counts.rays += samples.size();
      for (PathSample& sample : samples) {
        const float noise = 0.5f + sample.sampler.next_1d();
        sample.seen = {sample.ray.direction.x > 0.003f ? C3f(50.0f * noise) : C3f(0.0f), 1.0f};
      }
    }
  };
  Film film(24, 24);
  const Camera camera(description, 24, 24);
  const RenderOutcome outcome =
      render_image({Edge(), camera, lanczos_filter(), {0, 0, 0.05}, 1, SamplerKind::sobol, {}}, film);
  EXPECT_EQ(outcome.stop_reason, "noise");
  EXPECT_LE(film.relative_error(), 0.05);
  double least = 0.0;
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x) {
      least = std::min(least, film.pixel(x, y).mean().x);
      ASSERT_TRUE(std::isfinite(film.pixel(x, y).mean().x));
      ASSERT_GE(film.pixel(x, y).mean_alpha(), 0.999);
    }
  // The second pixel from the edge, 1.56 to 1.57 away, has 50 times the integral of the kernel from there to 3:
  // -0.472 in the middle of the picture, -0.417 at its upper and lower border.
  EXPECT_LT(least, -0.417);
}

TEST(RenderImage, NoiseGoalStopsAtTheErrorItPromises) {
  Film film(32, 32);
  const Synthetic noisy(2.0f);
  const RenderOutcome outcome = run(noisy, film, {0, 0, 0.02});
  EXPECT_EQ(outcome.stop_reason, "noise");
  EXPECT_LE(film.relative_error(), 0.02);
  // The true error is that of stratified samples, below that of random ones: 2 / sqrt(12 n).
  double sum = 0.0;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      const double d = film.pixel(x, y).mean().x - 1.0;
      sum += d * d / 1.01 / 1024;
    }
  EXPECT_LT(std::sqrt(sum), 0.02);
}

TEST(RenderImage, TimeGoalStopsAndFinishesTheFirstPass) {
  Film film(64, 64);
  const RenderOutcome outcome = run(Synthetic(1.0f), film, {0, 1e-6, 0});
  EXPECT_EQ(outcome.stop_reason, "time");
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) EXPECT_GT(film.pixel(x, y).samples, 0u);
}

TEST(RenderImage, TheFirstGoalMetWins) {
  Film film(16, 16);
  EXPECT_EQ(run(Synthetic(2.0f), film, {4, 1000, 1e-9}).stop_reason, "samples");
}

TEST(RenderImage, InterruptEndsIt) {
  interrupt_requested() = true;
  Film film(64, 64);
  const RenderOutcome outcome = run(Synthetic(1.0f), film, {100000, 0, 0});
  interrupt_requested() = false;
  EXPECT_EQ(outcome.stop_reason, "interrupted");
}

void expect_same_bits(const Film& a, const Film& b) {
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x) {
      const FilmPixel &p = a.pixel(x, y), &q = b.pixel(x, y);
      ASSERT_TRUE(p.sum == q.sum && p.plain == q.plain && p.spread == q.spread && p.alpha == q.alpha &&
                  p.weight == q.weight && p.samples == q.samples && p.batches == q.batches)
          << x << ' ' << y;
    }
}

// Noise that differs from pixel to pixel, so that adaptive plans have something to decide.
class Uneven final : public Integrator {
 public:
  void trace(std::span<PathSample> samples, RayCounts& counts) const override {
    counts.rays += samples.size();
    for (PathSample& sample : samples) {
      const float u = sample.sampler.next_1d(), wide = sample.ray.direction.x > 0.0f ? 1.8f : 0.1f;
      sample.seen = {C3f(1.0f + wide * (u - 0.5f)), 1.0f};
    }
  }
};

// Where a render stood when it paused for the n-th time that it was asked.
struct Pause {
  Film film;
  RenderState state;
};

TEST(RenderImage, ResumedAnywhereItHasTheSameBytesAsUninterrupted) {
  const Uneven integrator;
  const Camera camera(description, 60, 45);
  for (const SamplingGoal& goal :
       {SamplingGoal{.samples_per_pixel = 40}, SamplingGoal{.relative_error = 0.03}}) {
    const auto job = [&] {
      return RenderJob{
          .integrator = integrator, .camera = camera, .filter = mitchell_filter(), .goal = goal, .seed = 3};
    };
    Film whole(60, 45);
    std::vector<Pause> pauses;
    std::atomic<int> asked{0};
    RenderJob pausing = job();
    pausing.wants_pause = [&] { return ++asked % 7 == 0; };
    pausing.at_pause = [&](const RenderState& state) { pauses.push_back({whole, state}); };
    const RenderOutcome outcome = render_image(pausing, whole);
    Film straight(60, 45);
    const RenderOutcome expected = render_image(job(), straight);
    expect_same_bits(whole, straight);
    ASSERT_GT(pauses.size(), 4u);
    bool adaptive = false;
    for (Pause& pause : pauses) {
      adaptive |= !pause.state.plan.levels.empty();
      RenderJob resumed = job();
      resumed.resumed = &pause.state;
      const RenderOutcome rest = render_image(resumed, pause.film);
      expect_same_bits(pause.film, straight);
      EXPECT_EQ(rest.counts.rays, expected.counts.rays);
      EXPECT_EQ(rest.stop_reason, expected.stop_reason);
    }
    EXPECT_EQ(adaptive, goal.relative_error > 0.0) << "some pauses are behind the pilot";
    EXPECT_EQ(outcome.counts.rays, expected.counts.rays);
  }
}

TEST(RenderImage, AResumedRenderAddsSamples) {
  const Synthetic integrator(1.0f);
  const Camera camera(description, 20, 20);
  Film film(20, 20), straight(20, 20);
  const RenderOutcome first = run(integrator, film, {.samples_per_pixel = 8});
  const RenderState state{first.plan, {first.counts, 0}};
  const SamplingGoal goal{.samples_per_pixel = 32};
  render_image({.integrator = integrator,
                .camera = camera,
                .filter = box_filter(),
                .goal = goal,
                .seed = 1,
                .resumed = &state},
               film);
  run(integrator, straight, goal);
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 20; ++x) {
      EXPECT_EQ(film.pixel(x, y).samples, 32u);
      EXPECT_NEAR(film.pixel(x, y).mean().x, straight.pixel(x, y).mean().x, 1e-12);
    }
}

TEST(RenderImage, SlicesHaveTheSamplesOfTheWholeEachOnce) {
  const Synthetic integrator(1.0f);
  const Camera camera(description, 20, 20);
  for (const SamplerKind sampler : {SamplerKind::sobol, SamplerKind::stratified, SamplerKind::independent}) {
    const auto job = [&](int first, int samples, int all) {
      return RenderJob{.integrator = integrator,
                       .camera = camera,
                       .filter = mitchell_filter(),
                       .goal = {.samples_per_pixel = samples},
                       .seed = 5,
                       .sampler = sampler,
                       .first_sample = static_cast<std::uint32_t>(first),
                       .all_samples = static_cast<std::uint32_t>(all)};
    };
    Film whole(20, 20), merged(20, 20);
    render_image(job(0, 25, 25), whole);
    for (int k = 0; k < 4; ++k) {
      Film part(20, 20);
      render_image(job(25 * k / 4, 25 * (k + 1) / 4 - 25 * k / 4, 25), part);
      merged.merge(part);
    }
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 20; ++x) {
        EXPECT_EQ(merged.pixel(x, y).samples, 25u);
        EXPECT_NEAR(merged.pixel(x, y).mean().x, whole.pixel(x, y).mean().x, 1e-12);
        EXPECT_NEAR(merged.pixel(x, y).weight, whole.pixel(x, y).weight, 1e-12);
      }
  }
}

TEST(RenderImage, ProgressTellsPassSamplesErrorAndSpeed) {
  const Synthetic integrator(1.0f);
  const Camera camera(description, 40, 40);
  std::mutex mutex;
  std::vector<RenderProgress> reports;
  Film film(40, 40);
  RenderJob job{
      .integrator = integrator, .camera = camera, .filter = box_filter(), .goal = {.samples_per_pixel = 64}};
  job.report_progress = [&](const RenderProgress& at) {
    const std::lock_guard lock(mutex);
    reports.push_back(at);
  };
  render_image(job, film);
  ASSERT_FALSE(reports.empty());
  int last_pass = 0;
  double known = 0.0;
  for (const RenderProgress& at : reports) {
    last_pass = std::max(last_pass, at.pass);
    EXPECT_GT(at.rays_per_second, 0.0);
    if (std::isfinite(at.error)) known = at.error;
  }
  EXPECT_EQ(last_pass, 8);
  EXPECT_GT(known, 0.0);
  EXPECT_LT(known, 0.5);
  const auto& furthest = *std::max_element(reports.begin(), reports.end(), [](const auto& a, const auto& b) {
    return a.samples_per_pixel < b.samples_per_pixel;
  });
  EXPECT_EQ(furthest.fraction, 1.0);
  EXPECT_EQ(furthest.samples_per_pixel, 64.0);
}

TEST(RenderImage, NonFiniteSamplesAreCountedAndBlack) {
  Film film(16, 16);
  const RenderOutcome outcome = run(Synthetic(0.0f, true), film, {64, 0, 0});
  EXPECT_EQ(outcome.non_finite_samples, 16u * 16u * 16u);  // a stratified quarter
  for (const float v : film.resolve().pixels) EXPECT_TRUE(std::isfinite(v));
  EXPECT_NEAR(film.pixel(3, 3).mean().x, 0.75, 1e-6);
  ASSERT_TRUE(outcome.first_non_finite);
  EXPECT_EQ(outcome.first_non_finite->pixel, V2i(0, 0));
  EXPECT_FALSE(run(Synthetic(1.0f), film, {1, 0, 0}).first_non_finite);
}

// The first by row, column and sample, on any number of threads, in the camera's picture.
TEST(RenderImage, TheFirstNonFiniteSampleIsLocated) {
  class BrokenDownThere final : public Integrator {
   public:
    void trace(std::span<PathSample> samples, RayCounts&) const override {
      for (PathSample& sample : samples) {
        const bool is_broken = sample.ray.direction.z < -0.2f && sample.sampler.next_1d() < 0.01f;
        sample.seen = {is_broken ? C3f(0, INFINITY, 0) : C3f(1.0f), 1.0f};
      }
    }
  };
  const Camera camera(description, 60, 50);
  std::vector<SamplePlace> places;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    Film film(40, 40);
    const RenderOutcome outcome = render_image(
        {BrokenDownThere(), camera, box_filter(), {40, 0, 0}, 1, SamplerKind::sobol, {}, {}, V2i(10, 5)}, film);
    ASSERT_TRUE(outcome.first_non_finite);
    places.push_back(*outcome.first_non_finite);
    const auto& [pixel, index] = places.back();
    EXPECT_EQ(pixel, places[0].pixel);
    EXPECT_EQ(index, places[0].sample);
    // Alone, it is broken, too; none above it is.
    const V2i at = pixel - V2i(10, 5);
    EXPECT_LT(film.pixel(at.x, at.y).mean().y, 1.0);
    for (int y = 0; y < at.y; ++y)
      for (int x = 0; x < 40; ++x) ASSERT_NEAR(film.pixel(x, y).mean().y, 1.0, 1e-6);
  }
}

// A floor of black and white squares that reaches to the horizon, under an even sky.
Scene checkered_plain() {
  SceneDescription scene;
  Mesh floor = test::quad(V3f(-500, 0, 0), V3f(1000, 0, 0), V3f(0, 1000, 0));
  floor.uvs = {V2f(0, 0), V2f(1, 0), V2f(1, 1), V2f(0, 1)};
  test::add_diffuse(scene, "floor", floor, C3f(0.0f));
  constexpr float squares = 8000.0f;
  const Checkerboard board{C3f(1.0f), C3f(0.0f), {squares, 0, 0, 0, squares, 0}};
  const MaterialNode node{TexturedModel{Diffuse{}, {{0, board}}}};
  scene.materials = {one_sided("floor", MaterialSide(std::make_shared<const MaterialNode>(node)))};
  scene.environment = Environment(C3f(1.0f));
  return Scene(std::move(scene));
}

TEST(RenderImage, FootprintsTakeTheNoiseOutOfFineTexturesAndLeaveTheirMean) {
  const Scene scene = checkered_plain();
  EXPECT_TRUE(scene.has_textures());
  const PathTracer path(scene, {.max_depth = 2});
  const Camera camera({look_at({0, 0, 1}, {0, 10, 0}, {0, 0, 1}, "test"), 60.0, FovAxis::x}, 64, 64);
  const auto spread = [&](const RayCone& cone) {
    Film film(64, 64);
    render_image({.integrator = path,
                  .camera = camera,
                  .filter = box_filter(),
                  .goal = {.samples_per_pixel = 16},
                  .cone = cone},
                 film);
    const Image image = film.resolve();
    // Just below the horizon, where a pixel holds many squares.
    test::Estimate estimate;
    for (int y = 32; y < 35; ++y)
      for (int x = 0; x < 64; ++x) estimate.add(image.rgb(x, y).x);
    return estimate;
  };
  const test::Estimate points = spread({}), filtered = spread(sample_cone(camera, 64, 64, 16));
  // Samples look at a quarter of their pixel's width each, along its short axis: about .6 of the variance is
  // left.
  EXPECT_LT(filtered.variance(), 0.75 * points.variance());
  EXPECT_LT(std::abs(filtered.mean() - points.mean()), 4.0 * points.standard_error());
  EXPECT_NEAR(filtered.mean(), 0.5, 0.03);
}

TEST(RayCone, IsNarrowerWithMoreSamplesDownToAnEighth) {
  const Camera camera(description, 100, 50);
  const RayCone one = sample_cone(camera, 100, 50, 1), four = sample_cone(camera, 100, 50, 4),
                many = sample_cone(camera, 100, 50, 10000), unknown = sample_cone(camera, 100, 50, 0);
  // 100 pixels share 60 degrees; those at the edge are the narrowest.
  EXPECT_LT(one.spread, 2.0f * std::tan(pi_f / 6.0f) / 100.0f);
  EXPECT_GT(one.spread, 0.5f * 2.0f * std::tan(pi_f / 6.0f) / 100.0f);
  EXPECT_FLOAT_EQ(four.spread, one.spread / 2.0f);
  EXPECT_FLOAT_EQ(many.spread, one.spread / 8.0f);
  EXPECT_EQ(unknown.spread, many.spread);
  EXPECT_EQ(one.width, 0.0f);
  const RayCone mirrored = one.scattered(2.0f, 1e6f, true), blurred = one.scattered(2.0f, 1.0f / pi_f, false);
  EXPECT_FLOAT_EQ(mirrored.width, 2.0f * one.spread);
  EXPECT_EQ(mirrored.spread, one.spread);
  EXPECT_FLOAT_EQ(blurred.spread, 0.25f * std::sqrt(pi_f));
  EXPECT_FALSE(RayCone{}.is_open());
}

}  // namespace
}  // namespace twopass
