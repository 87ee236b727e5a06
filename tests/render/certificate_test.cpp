#include "render/certificate.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "integrators/make_integrator.h"
#include "radiosity/solution.h"
#include "render/core/interrupt.h"
#include "render/core/parallel.h"
#include "tests/support/scenes.h"
#include "tests/support/statistics.h"

namespace twopass {
namespace {

constexpr int width = 16, height = 12;

const CameraDescription view{look_at({0.5, 0.05, 0.5}, {0.5, 1, 0.45}, {0, 0, 1}, "test"), 70.0, FovAxis::x};

// A room below a bright ceiling, and a solution of it on large elements with a fifth too much light.
struct CoarseRoom {
  Scene scene;
  Solution solution;
  Camera camera{view, width, height};
  std::unique_ptr<Integrator> two_pass, unbiased, path;

  CoarseRoom() : scene(description()), solution(brightened(solve_radiosity(scene, coarse()))) {
    two_pass = make_integrator(IntegratorKind::two_pass, scene, {&solution}, {});
    unbiased = make_integrator(IntegratorKind::unbiased, scene, {&solution}, {});
    path = make_integrator(IntegratorKind::path, scene, {}, {});
  }
  static SceneDescription description() {
    SceneDescription scene = test::unit_room(C3f(0.7f, 0.6f, 0.5f), C3f(1.0f), C3f(0.5f));
    test::add_box(scene, "box", V3f(0.2f, 0.5f, 0.0f), V3f(0.45f, 0.75f, 0.4f),
                  one_sided("box", Diffuse{C3f(0.6f)}));
    return scene;
  }
  static RadiosityOptions coarse() {
    RadiosityOptions options;
    options.max_elements = 600;
    options.subdivision = Subdivision::uniform;
    return options;
  }
  static Solution brightened(const Solution& solved) {
    std::vector<Irradiance> irradiance;
    for (const Irradiance& h : solved.irradiances()) irradiance.push_back({h.direct * 1.2f, h.indirect * 1.2f});
    return Solution(solved.mesh(), std::move(irradiance), solved.stats());
  }
  [[nodiscard]] CertificateJob job(const Integrator& biased, std::uint32_t seed, double most_rays = 0.0) const {
    return {.biased = biased,
            .unbiased = *unbiased,
            .camera = camera,
            .width = width,
            .height = height,
            .seed = seed,
            .most_rays = most_rays};
  }
  // The mean over the picture, from batches of Sobol points over picture and paths.
  [[nodiscard]] test::Estimate mean(const Integrator& integrator, std::uint32_t seed,
                                    std::uint32_t samples) const {
    constexpr std::uint32_t batches = 32;
    test::Estimate estimate;
    RayCounts counts;
    for (std::uint32_t batch = 0; batch < batches; ++batch) {
      double sum = 0.0;
      std::vector<PathSample> traced;
      for (std::uint32_t i = 0; i < samples / batches; ++i) {
        Sampler sampler(seed, batch, i);
        const V2f u = sampler.next_2d();
        traced.push_back({camera.ray({u.x * width, u.y * height}).ray, sampler});
      }
      integrator.trace(traced, counts);
      for (const PathSample& sample : traced) sum += mean_component(sample.seen.radiance);
      estimate.add(sum / (samples / batches));
    }
    return estimate;
  }
};

TEST(Certificate, ItsIntervalHoldsTheBiasAsOftenAsItSays) {
  const CoarseRoom room;
  const test::Estimate biased = room.mean(*room.two_pass, 101, 1 << 18),
                       truth = room.mean(*room.path, 102, 1 << 20);
  const double bias = biased.mean() / truth.mean() - 1.0;
  const double error =
      std::hypot(biased.standard_error() / biased.mean(), truth.standard_error() / truth.mean());
  constexpr int seeds = 100;
  int held = 0;
  double widths = 0.0;
  for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
    const std::optional<Certificate> certificate = certify(room.job(*room.two_pass, seed));
    ASSERT_TRUE(certificate);
    EXPECT_EQ(certificate->samples, 2048u);
    if (std::abs(certificate->mean - bias) <= certificate->ci95) ++held;
    widths += certificate->ci95 / seeds;
  }
  // The bias is there, and certificates tell it from none; the reference is good enough to judge them by.
  EXPECT_GT(std::abs(bias), widths);
  EXPECT_LT(error, 0.15 * widths);
  // Of 100 intervals of 95 % fewer than 87 hold the truth once in 2000.
  EXPECT_GE(held, 87) << "bias " << bias << " +- " << error << ", mean half width " << widths;
  RecordProperty("held", held);
}

TEST(Certificate, OfAnIntegratorWithoutBiasItHoldsZero) {
  const CoarseRoom room;
  int held = 0, beyond = 0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const std::optional<Certificate> certificate = certify(room.job(*room.path, seed));
    ASSERT_TRUE(certificate);
    if (std::abs(certificate->mean) <= certificate->ci95) ++held;
    if (certificate->is_certainly_beyond(0.0)) ++beyond;
  }
  EXPECT_GE(held, 15);  // fewer: once in 3000
  EXPECT_LE(beyond, 5);
}

// Where the truth is well known, what is certain is what the interval says.
TEST(Certificate, IsCertainOfWhatLiesOutsideOfItsInterval) {
  const CoarseRoom room;
  const std::optional<Certificate> found = certify(room.job(*room.two_pass, 3, 1e6));
  ASSERT_TRUE(found);
  ASSERT_GT(found->mean, 4.0 * found->ci95);
  EXPECT_TRUE(found->is_certainly_beyond(found->mean - 1.1 * found->ci95));
  EXPECT_FALSE(found->is_certainly_beyond(found->mean - 0.9 * found->ci95));
  Certificate dark = *found;
  for (Certificate::Batch& batch : dark.of_batch) std::swap(batch.biased, batch.unbiased);
  EXPECT_TRUE(dark.is_certainly_beyond(0.9 * found->mean / (1.0 + found->mean)));  // too dark
  EXPECT_FALSE(dark.is_certainly_beyond(found->mean));
}

// Estimates of a truth of 0 scatter around it, so that a quotient says nothing.
TEST(Certificate, IsCertainThatLightInTheDarkIsWrong) {
  Certificate certificate;
  for (int b = 0; b < 32; ++b) certificate.of_batch.push_back({1.0 + 0.01 * b, b % 2 == 0 ? 0.4 : -0.4});
  EXPECT_TRUE(certificate.is_certainly_beyond(0.5));
  // As far as the truth is known: here it may be as bright.
  for (Certificate::Batch& batch : certificate.of_batch) batch.unbiased *= 20.0;
  EXPECT_FALSE(certificate.is_certainly_beyond(0.5));
  for (Certificate::Batch& batch : certificate.of_batch) batch.unbiased = 0.0;
  EXPECT_TRUE(certificate.is_certainly_beyond(1e6));
}

TEST(Certificate, TakesTheRaysItMayAndStopsWhenItIsGoodEnough) {
  const CoarseRoom room;
  CertificateJob job = room.job(*room.two_pass, 1, 2e5);
  job.close_enough = 1e-6;
  const std::optional<Certificate> long_one = certify(job);
  ASSERT_TRUE(long_one);
  const double rays = static_cast<double>(long_one->counts.rays + long_one->counts.shadow_rays);
  EXPECT_NEAR(rays / 2e5, 1.0, 0.1);
  job.close_enough = 1e-2;
  const std::optional<Certificate> short_one = certify(job);
  ASSERT_TRUE(short_one);
  EXPECT_LT(short_one->samples, long_one->samples);
  EXPECT_LT(long_one->ci95, short_one->ci95);
}

TEST(Certificate, IsTheSameOnAnyNumberOfThreads) {
  const CoarseRoom room;
  std::vector<Certificate> certificates;
  for (const int threads : {1, 3}) {
    const ThreadLimit limit(threads);
    CertificateJob job = room.job(*room.two_pass, 1, 1e5);
    job.elements = room.solution.mesh().count();
    certificates.push_back(certify(job).value());
  }
  for (std::size_t i = 0; i < room.solution.mesh().count(); ++i) {
    EXPECT_EQ(certificates[0].of_element[i].error, certificates[1].of_element[i].error);
    EXPECT_EQ(certificates[0].of_element[i].carried, certificates[1].of_element[i].carried);
  }
  EXPECT_EQ(certificates[0].mean, certificates[1].mean);
  EXPECT_EQ(certificates[0].ci95, certificates[1].ci95);
}

// What paths find wrong with the elements adds up to what the picture has too much (I20).
TEST(Certificate, TheErrorsOfTheElementsAddUpToTheBias) {
  const CoarseRoom room;
  CertificateJob job = room.job(*room.two_pass, 5, 2e6);
  job.close_enough = 1e-6;
  job.elements = room.solution.mesh().count();
  const std::optional<Certificate> found = certify(job);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->of_element.size(), job.elements);
  ElementError sum;
  for (const ElementError& error : found->of_element) {
    sum.error += error.error;
    sum.squares += error.squares;
    sum.reads += error.reads;
  }
  EXPECT_GT(sum.reads, found->samples / 4);
  EXPECT_NEAR(sum.error, found->mean, 1.1 * found->ci95 + 2.0 * std::sqrt(sum.squares));
  // There is something to add up.
  EXPECT_GT(std::abs(sum.error), 4.0 * std::sqrt(sum.squares));
  job.elements = 0;
  EXPECT_TRUE(certify(job)->of_element.empty());
  EXPECT_EQ(certify(job)->mean, found->mean);
}

// Only what leaves one wall is wrong: by a third of what is read there.
TEST(Certificate, KnowsTheElementsThatAreWrong) {
  CoarseRoom room;
  const Solution right = solve_radiosity(room.scene, CoarseRoom::coarse());
  constexpr std::uint32_t wrong_wall = 5;  // far
  std::vector<Irradiance> irradiance(right.irradiances().begin(), right.irradiances().end());
  std::vector<bool> is_wrong(right.mesh().count());
  for (std::uint32_t i = 0; i < right.mesh().count(); ++i) {
    is_wrong[i] = right.mesh().root(i).shape == wrong_wall;
    if (is_wrong[i]) irradiance[i] = {irradiance[i].direct * 1.5f, irradiance[i].indirect * 1.5f};
  }
  const Solution solution(right.mesh(), irradiance, right.stats());
  const auto two_pass = make_integrator(IntegratorKind::two_pass, room.scene, {&solution}, {});
  room.unbiased = make_integrator(IntegratorKind::unbiased, room.scene, {&solution}, {});
  CertificateJob job = room.job(*two_pass, 7, 1e6);
  job.close_enough = 1e-6;
  job.elements = solution.mesh().count();
  const std::vector<ElementError> errors = certify(job).value().of_element;
  ElementError wrong, others;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    ElementError& sum = is_wrong[i] ? wrong : others;
    sum.carried += errors[i].carried;
    sum.error += errors[i].error;
    sum.squares += errors[i].squares;
  }
  EXPECT_NEAR(wrong.error / wrong.carried, 1.0 / 3.0, 0.05);
  // What they read of the wall is too much, so that they look too dark themselves, by less.
  EXPECT_LT(others.error, 0.0);
  EXPECT_GT(others.error / others.carried, -0.1);
  // Told apart from noise and from where elements merely have contrast.
  const std::vector<double> guilt = guilt_of(solution.mesh(), solution.irradiances(), errors);
  double of_wrong = 0.0, all = 0.0;
  for (std::size_t i = 0; i < guilt.size(); ++i) {
    if (is_wrong[i]) of_wrong += guilt[i];
    all += guilt[i];
  }
  EXPECT_GT(of_wrong, 0.5 * all);
  // So that most cuts are there.
  const std::vector<std::uint8_t> cuts = cuts_for(guilt, 0.0, guilt.size() + 120);
  int cut_wrong = 0, cut = 0;
  for (std::size_t i = 0; i < guilt.size(); ++i) {
    cut += cuts[i] > 0;
    cut_wrong += cuts[i] > 0 && is_wrong[i];
  }
  EXPECT_GT(cut, 4);
  EXPECT_GE(5 * cut_wrong, 4 * cut);
}

// Black but for a lamp: all samples agree, of which nothing follows.
TEST(Certificate, ThereIsNoneWhereHardlyAnySampleReadsTheSolution) {
  SceneDescription description;
  test::add_diffuse(description, "lamp", test::quad(V3f(0.4f, 0.9f, 0.4f), V3f(0.2f, 0, 0), V3f(0, 0, 0.2f)),
                    C3f(0.0f), C3f(10.0f));
  const Scene scene(std::move(description));
  const auto path = make_integrator(IntegratorKind::path, scene, {}, {});
  const Camera camera(view, width, height);
  EXPECT_FALSE(certify({.biased = *path,
                        .unbiased = *path,
                        .camera = camera,
                        .width = width,
                        .height = height,
                        .most_rays = 1e5}));
}

TEST(Certificate, ThereIsNoneOfABlackPictureOrAfterAnInterrupt) {
  SceneDescription dark = test::unit_room(C3f(0.5f), C3f(0.0f), C3f(0.5f));
  const Scene scene(std::move(dark));
  const auto path = make_integrator(IntegratorKind::path, scene, {}, {});
  const Camera camera(view, width, height);
  EXPECT_FALSE(
      certify({.biased = *path, .unbiased = *path, .camera = camera, .width = width, .height = height}));
  const CoarseRoom room;
  interrupt_requested() = true;
  const auto interrupted = certify(room.job(*room.two_pass, 1));
  interrupt_requested() = false;
  EXPECT_FALSE(interrupted);
}

}  // namespace
}  // namespace twopass
