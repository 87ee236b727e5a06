#include "render/pass_one.h"

#include <gtest/gtest.h>

#include "tests/support/scenes.h"

namespace twopass {
namespace {

constexpr PixelWindow window{{0, 0}, {32, 24}};

struct Room {
  Scene scene{test::furnished_room()};
  Camera camera{{look_at({0.5, 0.05, 0.5}, {0.5, 1, 0.45}, {0, 0, 1}, "test"), 70.0, FovAxis::x},
                window.size.x,
                window.size.y};
  Plan plan = plan_render(needs_of(scene.description()), IntegratorKind::two_pass, {});
  std::vector<std::string> said;

  [[nodiscard]] PassOneJob job() const {
    return {.scene = scene,
            .plan = plan,
            .integrator = IntegratorKind::two_pass,
            .radiosity = radiosity_options(IntegratorKind::two_pass, {}, camera, window, {})};
  }
  PreparedPassOne prepare(PassOneJob job, const BiasGoal& goal) {
    said.clear();
    return prepare_within_bias(std::move(job), camera, window, {}, goal,
                               [&](const std::string& text) { said.push_back(text); });
  }
};

// A solution with a fifth too much light.
Solution brightened(const Solution& solved) {
  std::vector<Irradiance> irradiance;
  for (const Irradiance& h : solved.irradiances()) irradiance.push_back({h.direct * 1.2f, h.indirect * 1.2f});
  return Solution(solved.mesh(), std::move(irradiance), solved.stats());
}

TEST(PassOne, IsLeftAsItIsWhereItsBiasIsNotMoreThanItMayBe) {
  Room room;
  const PreparedPassOne done = room.prepare(room.job(), {.most = 0.02, .rays = 2e5});
  EXPECT_TRUE(done.solution);
  EXPECT_TRUE(done.field);
  EXPECT_FALSE(done.gathers_twice);
  EXPECT_TRUE(room.said.empty());
}

// What is read of a wrong solution is wrong; what is read one surface later is wrong by less; paths are right.
TEST(PassOne, IsReadLaterOrNotAtAllWhereItIsWrong) {
  Room room;
  const Solution right = solve_radiosity(room.scene, room.job().radiosity);
  PassOneJob job = room.job();
  job.solved = brightened(right);
  const PreparedPassOne once = room.prepare(std::move(job), {.most = 0.005, .rays = 4e5});
  EXPECT_FALSE(once.solution);
  ASSERT_EQ(room.said.size(), 2u);
  EXPECT_NE(room.said[0].find("gathering goes over one more surface"), std::string::npos);
  EXPECT_NE(room.said[1].find("without pass one"), std::string::npos);
  EXPECT_GT(once.time().cpu_seconds, 0.0);

  PassOneJob again = room.job();
  again.solved = brightened(right);
  const PreparedPassOne lenient = room.prepare(std::move(again), {.most = 0.06, .rays = 4e5});
  EXPECT_TRUE(lenient.solution);
  EXPECT_EQ(lenient.gathers_twice, room.said.size() == 1);
}

TEST(PassOne, IsSolvedAgainOnMoreElementsFirst) {
  Room room;
  // So little that only finer elements, and then nothing less than paths, will do.
  BiasGoal goal{.most = -1.0, .rays = 5e4};
  const PreparedPassOne done = room.prepare(room.job(), goal);
  EXPECT_FALSE(done.solution);
  ASSERT_EQ(room.said.size(), 4u);
  EXPECT_NE(room.said[0].find("elements instead of"), std::string::npos);
  EXPECT_NE(room.said[1].find("elements instead of"), std::string::npos);
  // There is no time for that in a render of a tenth of a microsecond.
  goal.seconds = 1e-7;
  const PreparedPassOne short_of_time = room.prepare(room.job(), goal);
  ASSERT_EQ(room.said.size(), 2u);
  EXPECT_EQ(room.said[0].find("elements instead of"), std::string::npos);
}

// A shelf through the wall of a dark room takes the light of the day outside in with it. Relative to a truth of
// 0 that is without bounds, and whatever two passes show is wrong.
TEST(PassOne, IsNotReadInADarkPlaceThatItsElementsCarryLightInto) {
  SceneDescription description = test::unit_room(C3f(0.5f), C3f(0.0f), C3f(0.5f));
  test::add_diffuse(description, "shelf", test::quad(V3f(0.6f, 0.3f, 0.2f), V3f(1, 0, 0), V3f(0, 0.5f, 0)),
                    C3f(0.8f));
  description.environment = Environment(C3f(2.0f));
  Room room{.scene = Scene(std::move(description)), .said = {}};
  const auto job = [&] {
    PassOneJob coarse = room.job();
    coarse.radiosity.max_elements = 300;
    return coarse;
  };
  const auto mean = [&](const PreparedPassOne& pass_one) {
    const auto integrator = make_integrator(IntegratorKind::two_pass, room.scene, pass_one.view(), {});
    double sum = 0.0;
    RayCounts counts;
    for (std::uint32_t k = 0; k < 4096; ++k) {
      Sampler sampler(7, 0, k);
      const V2f u = sampler.next_2d();
      std::vector<PathSample> sample{{room.camera.ray({u.x * 32.0f, u.y * 24.0f}).ray, sampler}};
      integrator->trace(sample, counts);
      sum += mean_component(sample[0].seen.radiance);
    }
    return sum / 4096;
  };
  EXPECT_GT(mean(prepare_pass_one(job())), 1e-4);
  const PreparedPassOne done = room.prepare(job(), {.rays = 5e4, .may_solve_again = false});
  EXPECT_FALSE(done.solution);
  EXPECT_EQ(mean(done), 0.0);
  ASSERT_EQ(room.said.size(), 2u);
  EXPECT_NE(room.said[0].find("where paths find hardly any"), std::string::npos);
}

// A solution that knows of no light where the picture looks has missed it, or there is none: paths need no more
// rays.
TEST(PassOne, IsLeftOutWhereItFindsNoLight) {
  Room room;
  const Solution right = solve_radiosity(room.scene, room.job().radiosity);
  PassOneJob job = room.job();
  job.solved.emplace(right.mesh(), std::vector<Irradiance>(right.mesh().count()), right.stats());
  const PreparedPassOne black = room.prepare(std::move(job), {.rays = 1e5});
  EXPECT_FALSE(black.solution);
  EXPECT_FALSE(black.field);
  EXPECT_NE(black.left_out.find("no light"), std::string::npos);
  // One element that the picture sees is enough.
  PassOneJob lit = room.job();
  std::vector<Irradiance> irradiance(right.mesh().count());
  for (std::uint32_t i = 0; i < irradiance.size(); ++i)
    if (right.mesh().root(i).shape == 5) irradiance[i].direct = C3f(1.0f);
  lit.solved.emplace(right.mesh(), irradiance, right.stats());
  EXPECT_TRUE(prepare_pass_one(std::move(lit)).solution);
}

TEST(PassOne, TheGuideIsForThePicturesRays) {
  constexpr PixelWindow picture{{0, 0}, {100, 100}};
  EXPECT_DOUBLE_EQ(rays_of({16, 0.0, 0.0}, picture, 2), 16 * 3e4);
  EXPECT_DOUBLE_EQ(rays_of({16, 0.01, 0.0}, picture, 2), 1e5);
  EXPECT_DOUBLE_EQ(rays_of({1000, 0.0, 0.1}, picture, 2), 10 * 3e4);
  EXPECT_EQ(rays_of({}, picture, 2), 0.0);
  Room room;
  room.plan = plan_render(needs_of(room.scene.description()), IntegratorKind::unbiased, {});
  const auto rays_for = [&](double picture_rays) {
    const PreparedPassOne done = prepare_pass_one({.scene = room.scene,
                                                   .plan = room.plan,
                                                   .integrator = IntegratorKind::unbiased,
                                                   .radiosity = {.max_elements = 1000},
                                                   .picture_rays = picture_rays});
    return done.guide->rays();
  };
  const std::uint64_t all = rays_for(0.0), few = rays_for(1e6);
  // Rays over mirrors aside, of which there are none, 15 %: as cells come in sizes by halves, not much less.
  EXPECT_LE(few, 150000u);
  EXPECT_GE(few, 15000u);
  EXPECT_GT(all, few);
}

TEST(PassOne, LongPicturesFindTheLightAtCornersWithMoreRays) {
  const Room room;
  const auto rays = [&](double picture_rays) {
    PassOneJob job = room.job();
    job.picture_rays = picture_rays;
    job.radiosity.max_elements = 300;
    return prepare_pass_one(std::move(job)).field->rays();
  };
  EXPECT_EQ(rays(0.0), rays(1e5));
  EXPECT_GT(rays(1e10), rays(1e5));
}

TEST(PassOne, ShortPicturesShootFewerCausticParticles) {
  SceneDescription description = test::furnished_room();
  test::add_box(description, "mirror", V3f(0.6f, 0.2f, 0.0f), V3f(0.8f, 0.4f, 0.5f),
                one_sided("mirror", Conductor{}));
  const Scene scene(std::move(description));
  const auto particles_for = [&](double picture_rays) {
    const PreparedPassOne done =
        prepare_pass_one({.scene = scene,
                          .plan = plan_render(needs_of(scene.description()), IntegratorKind::two_pass, {}),
                          .integrator = IntegratorKind::two_pass,
                          .radiosity = {.max_elements = 200},
                          .picture_rays = picture_rays});
    return static_cast<double>(done.caustics->particles());
  };
  const double all = particles_for(0.0);
  EXPECT_NEAR(all / particles_for(1e5), 16.0, 2.0) << "2^16 at least, of 2^20";
  EXPECT_EQ(particles_for(1e12), all);
}

constexpr PixelWindow picture{{0, 0}, {512, 512}};
Camera camera_of(const PixelWindow& window) {
  return {{look_at({0.5, 0.05, 0.5}, {0.5, 1, 0.45}, {0, 0, 1}, "test"), 70.0, FovAxis::x},
          window.size.x,
          window.size.y};
}

// Not below what a gathered picture needs, nor above what is worth its time.
TEST(PassOne, ElementsFollowTheErrorThatIsAskedFor) {
  const Room room;
  const Camera camera = camera_of(picture);
  const auto elements = [&](double error) {
    return element_limit(room.scene, radiosity_options(IntegratorKind::two_pass, {}, camera, picture, {},
                                                       {.relative_error = error}));
  };
  EXPECT_EQ(elements(0.0), 4096u);  // nothing is asked for
  EXPECT_EQ(elements(0.03), 4096u);
  EXPECT_EQ(elements(0.04), 3072u);
  EXPECT_EQ(elements(0.02), 6144u);
  EXPECT_EQ(elements(0.5), 2048u);
  EXPECT_EQ(elements(0.001), 8192u);
  // Small pictures have as many as they need by default, and more for less error.
  const auto elements_of_small = [&](double error) {
    return element_limit(room.scene, radiosity_options(IntegratorKind::two_pass, {}, room.camera, window, {},
                                                       {.relative_error = error}));
  };
  EXPECT_EQ(elements_of_small(0.03), 2048u);
  EXPECT_EQ(elements_of_small(0.01), 6144u);
  EXPECT_EQ(solve_radiosity(room.scene, radiosity_options(IntegratorKind::two_pass, {}, room.camera, window, {},
                                                          {.relative_error = 0.02}))
                    .mesh()
                    .count() /
                1000,
            3u);
  const SamplingGoal goal{0, 0.0, 0.02};
  EXPECT_EQ(picture_goal(goal, picture, 2, std::nullopt).relative_error, 0.02);
}

// A seventh of the time that paths would take to be as good, by the usual pace; more than usual for long ones.
TEST(PassOne, ShortPicturesHaveLessOfIt) {
  const Room room;
  const Camera camera = camera_of(picture);
  // Half of the variance is left.
  const ViewProbe probe{.variance = 0.1, .rays = 10.0, .variance_without = 0.045 / 0.95, .rays_without = 2.0};
  EXPECT_NEAR(probe.paths_of_a_sample(), 2.0, 1e-9);
  const auto elements = [&](const SamplingGoal& goal, const std::optional<ViewProbe>& seen) {
    return element_limit(room.scene, radiosity_options(IntegratorKind::two_pass, {}, camera, picture, {},
                                                       picture_goal(goal, picture, 2, seen)));
  };
  std::size_t before = 0;
  for (const int samples : {1, 2, 3, 4, 8, 64, 1024}) {
    const std::size_t n = elements({samples, 0.0, 0.0}, probe);
    EXPECT_GE(n, before);
    EXPECT_GE(n, 2048u);
    EXPECT_LE(n, 8192u);
    // A ray takes a fifth of a microsecond, an element a fifth of a millisecond.
    if (n > 2048) {
      EXPECT_LE(2e-4 * static_cast<double>(n), 0.15 * 2.0 * samples * 10.0 * 512 * 512 * 2e-7 + 2e-4);
    }
    before = n;
  }
  EXPECT_EQ(before, 8192u);
  EXPECT_EQ(elements({8, 0.0, 0.0}, probe), 4096u);
  // The error of so many samples: that of paths is the root of .05 over their number.
  EXPECT_NEAR(static_cast<double>(elements({128, 0.0, 0.0}, probe)), 4096.0 * 0.03 / std::sqrt(0.05 / 128),
              1.0);
  EXPECT_EQ(elements({1, 0.0, 0.0}, probe), 2048u);
  EXPECT_EQ(elements({3, 0.0, 0.0}, probe), 2359u);
  EXPECT_EQ(elements({1, 0.0, 0.0}, std::nullopt), 4096u);  // nothing is known
  EXPECT_EQ(elements({0, 0.0, 0.03}, probe), 4096u);
  EXPECT_EQ(elements({0, 0.0, 0.5}, probe), 2048u);
  // Two threads have twice the time.
  EXPECT_NEAR(static_cast<double>(elements({0, 2.0, 0.0}, probe)), 3000.0, 1.0);
  EXPECT_EQ(elements({0, 0.01, 0.0}, probe), 2048u);
  EXPECT_NEAR(static_cast<double>(elements({0, 6.0, 0.0}, probe)),
              4096.0 * 0.03 / std::sqrt(0.05 * 2.0 * 512 * 512 / (2.0 * 6.0 * 5e6)), 1.0);
  EXPECT_EQ(elements({0, 100.0, 0.0}, probe), 8192u);
}

// Its guide included, which is left out where it would be too coarse.
TEST(PassOne, CertificatesTakeTheirShareOfThePicture) {
  Room room;
  const PreparedPassOne done = prepare_pass_one(room.job());
  const auto biased = make_integrator(IntegratorKind::two_pass, room.scene, done.view(), {});
  for (const std::uint64_t rays : {std::uint64_t{10'000'000}, std::uint64_t{100'000'000}}) {
    const auto found = certify_picture({.scene = room.scene,
                                        .pass_one = done,
                                        .integrator = *biased,
                                        .limits = {},
                                        .camera = room.camera,
                                        .window = window,
                                        .seed = 1,
                                        .counts = {.rays = rays}});
    ASSERT_TRUE(found);
    const double spent = static_cast<double>(found->counts.rays + found->counts.shadow_rays);
    EXPECT_LT(spent, 0.055 * static_cast<double>(rays));
    EXPECT_GT(found->ci95, 0.0);
  }
}

TEST(PassOne, TheBiasThatIsAllowedFollowsTheNoiseThatIsAskedFor) {
  EXPECT_DOUBLE_EQ(bias_goal({16, 0.0, 0.0}, window, 1).most, 0.005);
  EXPECT_DOUBLE_EQ(bias_goal({0, 0.0, 0.03}, window, 1).most, 0.005);
  EXPECT_DOUBLE_EQ(bias_goal({0, 0.0, 0.012}, window, 1).most, 0.002);
  EXPECT_DOUBLE_EQ(bias_goal({0, 0.0, 1e-4}, window, 1).most, 0.001);
  EXPECT_GT(bias_goal({64, 0.0, 0.0}, window, 1).rays, bias_goal({16, 0.0, 0.0}, window, 1).rays);
  EXPECT_LT(bias_goal({64, 1e-3, 0.0}, window, 1).rays, bias_goal({64, 0.0, 0.0}, window, 1).rays);
}

}  // namespace
}  // namespace twopass
