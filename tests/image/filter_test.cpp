#include "render/image/filter.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <ostream>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace twopass {

// How GoogleTest names a parameter.
void PrintTo(const Filter& filter, std::ostream* out) {
  *out << name_of_value(filter_names(), filter.kind) << " of radius " << filter.radius;
}

namespace {

// The kernels' moments and distributions by integration of filter_value, which the closed forms below check
// itself.
double integrate(const std::function<double(double)>& f, double low, double high) {
  constexpr int steps = 20000;  // Simpson
  const double h = (high - low) / steps;
  double sum = f(low) + f(high);
  for (int i = 1; i < steps; ++i) sum += f(low + i * h) * (i % 2 == 1 ? 4.0 : 2.0);
  return sum * h / 3.0;
}

double along_x(const Filter& filter, double x) { return filter_value(filter, {static_cast<float>(x), 0.0f}); }

class FilterTest : public ::testing::TestWithParam<Filter> {};

INSTANTIATE_TEST_SUITE_P(Kinds, FilterTest,
                         ::testing::Values(box_filter(), tent_filter(), gaussian_filter(), box_filter(2.0f),
                                           tent_filter(0.25f), gaussian_filter(1.3f)),
                         [](const auto& kind) {
                           return std::string(name_of_value(filter_names(), kind.param.kind)) +
                                  std::to_string(kind.index);
                         });

TEST_P(FilterTest, DensityIntegratesToOne) {
  const Filter& filter = GetParam();
  const double r = filter.radius;
  // Separable: the integral over the plane is that along x times that along y, over the value at the origin.
  const auto pdf = [&](double x, double y) {
    return static_cast<double>(filter_pdf(filter, {static_cast<float>(x), static_cast<float>(y)}));
  };
  const double along = integrate([&](double x) { return pdf(x, 0.0); }, -r, r);
  EXPECT_NEAR(along * along / pdf(0.0, 0.0), 1.0, 1e-5);
  EXPECT_EQ(pdf(1.001 * r, 0.0), 0.0);
  EXPECT_EQ(pdf(0.0, -1.001 * r), 0.0);
}

TEST_P(FilterTest, SamplesStayInsideAndReachTheBorders) {
  const Filter& filter = GetParam();
  const float last = std::nextafter(1.0f, 0.0f);
  for (const float u : {0.0f, 1e-7f, 0.25f, 0.5f, 0.75f, last}) {
    const V2f offset = sample_filter(filter, {u, last - u}).offset;
    EXPECT_LE(std::abs(offset.x), filter.radius);
    EXPECT_LE(std::abs(offset.y), filter.radius);
  }
  EXPECT_NEAR(sample_filter(filter, {0.0f, 0.5f}).offset.x, -filter.radius, 1e-6f * filter.radius);
  EXPECT_NEAR(sample_filter(filter, {0.5f, 0.5f}).offset.x, 0.0f, 1e-6f * filter.radius);
  EXPECT_EQ(sample_filter(filter, {0.3f, 0.8f}).weight, 1.0f);
}

// Inversion is deterministic: P(x(u)) must be u, and this without any statistics.
TEST_P(FilterTest, SamplingInvertsTheDistributionFunction) {
  const Filter& filter = GetParam();
  const double total = integrate([&](double x) { return along_x(filter, x); }, -filter.radius, filter.radius);
  for (int i = 1; i < 40; ++i) {
    const float u = static_cast<float>(i) / 40.0f;
    const double x = sample_filter(filter, {u, 0.5f}).offset.x;
    const double p = integrate([&](double t) { return along_x(filter, t); }, -filter.radius, x) / total;
    EXPECT_NEAR(p, u, 2e-6) << "u = " << u;
  }
}

// Largest distance between the distribution of samples and that of the kernel (Kolmogorov, Smirnov).
double ks_distance(const Filter& sampled, const Filter& kernel, int count) {
  std::mt19937 generator(7);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  std::vector<double> x;
  for (int i = 0; i < count; ++i) {
    const V2f u(std::min(uniform(generator), 0.99999994f), std::min(uniform(generator), 0.99999994f));
    x.push_back(sample_filter(sampled, u).offset.x);
  }
  std::sort(x.begin(), x.end());
  const double total = integrate([&](double t) { return along_x(kernel, t); }, -kernel.radius, kernel.radius);
  double p = 0.0, from = -kernel.radius, largest = 0.0;
  for (int i = 0; i < count; ++i) {
    const double to = std::clamp<double>(x[static_cast<std::size_t>(i)], -kernel.radius, kernel.radius);
    p += 0.5 * (along_x(kernel, from) + along_x(kernel, to)) * (to - from) / total;
    from = to;
    largest = std::max({largest, std::abs(p - i / static_cast<double>(count)),
                        std::abs(p - (i + 1) / static_cast<double>(count))});
  }
  return largest;
}

// Level 0.001: the distance times sqrt(n) exceeds 1.949 with that probability if the sampling is right.
constexpr int ks_samples = 100000;
const double ks_limit = 1.949 / std::sqrt(ks_samples);

TEST_P(FilterTest, SamplesFollowTheKernel) {
  EXPECT_LT(ks_distance(GetParam(), GetParam(), ks_samples), ks_limit);
}

TEST(Filter, TheTestSeesAWrongKernel) {
  EXPECT_GT(ks_distance(gaussian_filter(0.52f), gaussian_filter(0.5f), ks_samples), ks_limit);
  EXPECT_GT(ks_distance(tent_filter(1.0f), gaussian_filter(0.4f), ks_samples), ks_limit);
}

TEST(Filter, Variances) {
  const auto variance = [](const Filter& filter) {
    double sum = 0.0;
    constexpr int count = 20000;  // stratified: the mean over the midpoints of equal probabilities
    for (int i = 0; i < count; ++i) {
      const double x = sample_filter(filter, {(static_cast<float>(i) + 0.5f) / count, 0.5f}).offset.x;
      sum += x * x / count;
    }
    return sum;
  };
  EXPECT_NEAR(variance(box_filter(0.5f)), 1.0 / 12.0, 1e-6);
  EXPECT_NEAR(variance(tent_filter(1.0f)), 1.0 / 6.0, 1e-5);
  // s^2 (I2 - c a^3/3) / (I0 - c a), a = 4, c = exp(-8), with the truncated Gaussian's own moments.
  const double c = std::exp(-8.0), i0 = std::sqrt(pi / 2.0) * std::erf(4.0 / std::sqrt(2.0));
  const double expected = 0.25 * (i0 - 4.0 * c - c * 64.0 / 3.0) / (i0 - 4.0 * c);
  EXPECT_NEAR(variance(gaussian_filter(0.5f)), expected, 1e-5);
}

TEST(Filter, ValuesAreMitsubas) {
  EXPECT_FLOAT_EQ(filter_value(gaussian_filter(0.5f), {0.5f, 0.0f}),
                  static_cast<float>((std::exp(-0.5) - std::exp(-8.0)) * (1.0 - std::exp(-8.0))));
  EXPECT_EQ(filter_value(gaussian_filter(0.5f), {2.0f, 0.0f}), 0.0f);
  EXPECT_FLOAT_EQ(filter_value(tent_filter(), {0.25f, -0.5f}), 0.375f);
  EXPECT_EQ(filter_value(box_filter(), {0.4f, -0.4f}), 1.0f);
}

TEST(Filter, NamesAndBadLengths) {
  EXPECT_EQ(filter_of_name("tent", "--filter").radius, 1.0f);
  EXPECT_EQ(filter_of_name("gaussian", "--filter").radius, 2.0f);
  EXPECT_EQ(filter_of_name("box", "--filter").radius, 0.5f);
  EXPECT_THROW((void)filter_of_name("sinc", "--filter"), Error);
  for (const float bad : {0.0f, -1.0f, NAN, INFINITY}) {
    EXPECT_THROW((void)box_filter(bad), Error);
    EXPECT_THROW((void)tent_filter(bad), Error);
    EXPECT_THROW((void)gaussian_filter(bad), Error);
  }
}

// Kernels with negative lobes.
class SignedFilterTest : public ::testing::TestWithParam<Filter> {};

INSTANTIATE_TEST_SUITE_P(Kinds, SignedFilterTest,
                         ::testing::Values(mitchell_filter(), mitchell_filter(0.0f, 1.0f), catmullrom_filter(),
                                           lanczos_filter(), lanczos_filter(2), lanczos_filter(1)),
                         [](const auto& kind) {
                           return std::string(name_of_value(filter_names(), kind.param.kind)) +
                                  std::to_string(kind.index);
                         });

TEST_P(SignedFilterTest, DensityIntegratesToOneAndCoversTheKernel) {
  const Filter& filter = GetParam();
  const auto steps = static_cast<int>(filter.radius * 512.0f);
  double along = 0.0;  // the density is constant in each step: its middle is exact
  for (int i = -steps; i < steps; ++i) {
    const V2f middle((static_cast<float>(i) + 0.5f) / 512.0f, 0.25f);
    along += filter_pdf(filter, middle) / 512.0;
    if (filter_value(filter, middle) != 0.0f) EXPECT_GT(filter_pdf(filter, middle), 0.0f);
  }
  const V2f reference(0.25f, 0.25f);
  const double across = std::sqrt(static_cast<double>(filter_pdf(filter, reference)));  // the marginal at 0.25
  EXPECT_NEAR(along / across, 1.0, 1e-4);
  EXPECT_EQ(filter_pdf(filter, {1.001f * filter.radius, 0.0f}), 0.0f);
}

// The expectation of weight * g(offset) is the filtered g, for whichever g; by a fine grid of u, without
// statistics.
TEST_P(SignedFilterTest, WeightedSamplesIntegrateTheKernel) {
  const Filter& filter = GetParam();
  const double total = integrate([&](double x) { return along_x(filter, x); }, -filter.radius, filter.radius);
  const std::function<double(double)> functions[] = {[](double) { return 1.0; }, [](double x) { return x * x; },
                                                     [](double x) { return std::cos(2.0 * x + 0.5); },
                                                     [](double x) { return x > 0.7 ? 1.0 : 0.0; }};
  constexpr int grid = 1 << 16;
  for (const auto& g : functions) {
    double sum = 0.0, one = 0.0;
    for (int i = 0; i < grid; ++i)
      for (const float v : {0.03f, 0.31f, 0.5f, 0.77f}) {
        const FilterSample sample = sample_filter(filter, {(static_cast<float>(i) + 0.5f) / grid, v});
        // Along x alone: the weight along y, which depends on v alone, is divided out.
        const FilterSample middle = sample_filter(filter, {0.5f, v});
        const double along_y = middle.weight / sample_filter(filter, {0.5f, 0.5f}).weight;
        sum += sample.weight / along_y * g(sample.offset.x);
        one += sample.weight / along_y;
      }
    const double expected =
        integrate([&](double x) { return along_x(filter, x) * g(x); }, -filter.radius, filter.radius) / total;
    EXPECT_NEAR(sum / one, expected, 1e-3);
  }
}

// Weights are products of one along x and one along y; in the middle both are the same.
TEST_P(SignedFilterTest, WeightsAreOneOnAverage) {
  const Filter& filter = GetParam();
  const double middle = std::sqrt(static_cast<double>(sample_filter(filter, {0.5f, 0.5f}).weight));
  constexpr int grid = 1 << 16;
  double sum = 0.0, least = 0.0, most = 0.0;
  for (int i = 0; i < grid; ++i) {
    const FilterSample sample = sample_filter(filter, {(static_cast<float>(i) + 0.5f) / grid, 0.5f});
    ASSERT_LE(std::abs(sample.offset.x), filter.radius);
    const double along = sample.weight / middle;
    sum += along;
    least = std::min(least, along);
    most = std::max(most, along);
  }
  EXPECT_NEAR(sum / grid, 1.0, 1e-3);
  EXPECT_LT(most, 4.0) << "drawn by magnitude, so that no weight is much larger than others";
  if (filter.radius > 1.0f) EXPECT_LT(least, -1.0);
}

TEST(Filter, CubicsAreThoseOfMitchellAndNetravali) {
  const Filter mitchell = mitchell_filter(), catmull_rom = catmullrom_filter();
  const double peak = std::sqrt(static_cast<double>(filter_value(mitchell, {0.0f, 0.0f})));
  EXPECT_NEAR(peak, 8.0 / 9.0, 1e-6);
  EXPECT_NEAR(along_x(mitchell, 1.0) / peak, 1.0 / 18.0, 1e-6);
  EXPECT_NEAR(filter_value(catmull_rom, {0.0f, 0.0f}), 1.0, 1e-6);
  EXPECT_NEAR(along_x(catmull_rom, 1.0), 0.0, 1e-6);
  EXPECT_NEAR(along_x(catmull_rom, 1.5), -1.0 / 16.0, 1e-6);
  EXPECT_EQ(along_x(catmull_rom, 2.01), 0.0);
  // Shifted by whole pixels they add up to one, everywhere.
  for (const Filter& filter : {mitchell, catmull_rom, mitchell_filter(0.7f, -0.3f)}) {
    const double at_zero = std::sqrt(static_cast<double>(filter_value(filter, {0.0f, 0.0f})));
    for (const double x : {0.0, 0.2, 0.5, 0.9})
      EXPECT_NEAR((along_x(filter, x) + along_x(filter, x - 1.0) + along_x(filter, x + 1.0) +
                   along_x(filter, x - 2.0)) /
                      at_zero,
                  1.0, 1e-5);
  }
}

TEST(Filter, LanczosVanishesAtWholePixels) {
  const Filter filter = lanczos_filter(3);
  EXPECT_NEAR(along_x(filter, 0.0), 1.0, 1e-6);
  for (const double x : {1.0, 2.0, 3.0}) EXPECT_NEAR(along_x(filter, x), 0.0, 1e-6);
  // sinc(1.5) sinc(0.5) = (-2 / (3 pi)) (2 / pi).
  EXPECT_NEAR(along_x(filter, 1.5), -4.0 / (3.0 * pi * pi), 1e-6);
}

TEST(Filter, ImpossibleParametersAreErrors) {
  EXPECT_THROW(lanczos_filter(0), Error);
  EXPECT_THROW(lanczos_filter(17), Error);
  EXPECT_THROW(mitchell_filter(NAN, 0.0f), Error);
  EXPECT_THROW(mitchell_filter(0.0f, 11.0f), Error);
}

}  // namespace
}  // namespace twopass
