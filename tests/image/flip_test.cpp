#include "render/image/flip.h"

#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "render/image/flip_planes.h"

namespace twopass {
namespace {

using Pixels = std::vector<C3f>;

Pixels uniform(int count, const C3f& color) { return Pixels(static_cast<std::size_t>(count), color); }

Pixels noise(int count, float scale, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> value(0.0f, scale);
  Pixels pixels;
  for (int i = 0; i < count; ++i) pixels.emplace_back(value(generator), value(generator), value(generator));
  return pixels;
}

// --- LDR-FLIP by its definition: 2-D kernels, summed in the plane, in double ---

struct Definition {
  int width, height;
  double ppd = 3840.0 * pi / 180.0;  // pixels per degree, for one pixel per 0.7/3840 m at 0.7 m

  using Kernel2d = std::function<double(int x, int y)>;

  // The kernel's sum is divided out, or (signed kernels) positive and negative parts are made to sum to +1 and
  // -1.
  [[nodiscard]] std::vector<double> filter(const std::vector<double>& in, int radius, const Kernel2d& kernel,
                                           bool is_signed) const {
    double positive = 0.0, negative = 0.0;
    for (int y = -radius; y <= radius; ++y)
      for (int x = -radius; x <= radius; ++x) (kernel(x, y) > 0.0 ? positive : negative) += kernel(x, y);
    std::vector<double> out;
    for (int py = 0; py < height; ++py)
      for (int px = 0; px < width; ++px) {
        double sum = 0.0;
        for (int y = -radius; y <= radius; ++y)
          for (int x = -radius; x <= radius; ++x) {
            const double k = kernel(x, y);
            const int qx = std::clamp(px + x, 0, width - 1), qy = std::clamp(py + y, 0, height - 1);
            sum += k / (!is_signed || k > 0.0 ? positive : -negative) *
                   in[static_cast<std::size_t>(qy * width + qx)];
          }
        out.push_back(sum);
      }
    return out;
  }

  [[nodiscard]] Kernel2d csf(double a1, double b1, double a2, double b2) const {
    return [=, this](int x, int y) {
      const double d2 = (x * x + y * y) / (ppd * ppd);
      return a1 * std::sqrt(pi / b1) * std::exp(-pi * pi * d2 / b1) +
             a2 * std::sqrt(pi / b2) * std::exp(-pi * pi * d2 / b2);
    };
  }

  struct Eye {
    Pixels lab;
    std::vector<double> edge, point;
  };

  [[nodiscard]] Eye see(const Pixels& pixels) const {
    std::vector<double> y, cx, cz, relative;
    for (const C3f& p : pixels) {
      const C3f c = linear_to_ycxcz(p);
      y.push_back(c.x);
      cx.push_back(c.y);
      cz.push_back(c.z);
      relative.push_back((c.x + 16.0) / 116.0);
    }
    const int radius = static_cast<int>(std::ceil(3.0 * std::sqrt(0.04 / (2.0 * pi * pi)) * ppd));
    y = filter(y, radius, csf(1.0, 0.0047, 0.0, 1e-5), false);
    cx = filter(cx, radius, csf(1.0, 0.0053, 0.0, 1e-5), false);
    cz = filter(cz, radius, csf(34.1, 0.04, 13.5, 0.025), false);
    Eye eye;
    for (std::size_t i = 0; i < y.size(); ++i) {
      const C3f rgb =
          ycxcz_to_linear({static_cast<float>(y[i]), static_cast<float>(cx[i]), static_cast<float>(cz[i])});
      eye.lab.push_back(linear_to_hunt_lab(
          {std::clamp(rgb.x, 0.0f, 1.0f), std::clamp(rgb.y, 0.0f, 1.0f), std::clamp(rgb.z, 0.0f, 1.0f)}));
    }
    const double sd = 0.5 * 0.082 * ppd;
    const auto gauss = [sd](int x, int v) { return std::exp(-(x * x + v * v) / (2.0 * sd * sd)); };
    const auto strength = [&](const Kernel2d& kernel) {
      const int r = static_cast<int>(std::ceil(3.0 * sd));
      const std::vector<double> h = filter(relative, r, kernel, true);
      const std::vector<double> v = filter(
          relative, r, [&](int a, int b) { return kernel(b, a); }, true);
      std::vector<double> length;
      for (std::size_t i = 0; i < h.size(); ++i) length.push_back(std::hypot(h[i], v[i]));
      return length;
    };
    eye.edge = strength([&](int a, int b) { return -a * gauss(a, b); });
    eye.point = strength([&](int a, int b) { return (a * a / (sd * sd) - 1.0) * gauss(a, b); });
    return eye;
  }

  [[nodiscard]] std::vector<double> error(const Pixels& test, const Pixels& reference) const {
    const Eye t = see(test), r = see(reference);
    const double largest =
        std::pow(hyab(linear_to_hunt_lab({0.0f, 1.0f, 0.0f}), linear_to_hunt_lab({0.0f, 0.0f, 1.0f})), 0.7);
    std::vector<double> result;
    for (std::size_t i = 0; i < test.size(); ++i) {
      const double e = std::pow(hyab(t.lab[i], r.lab[i]), 0.7), knee = 0.4 * largest;
      const double color = e < knee ? 0.95 * e / knee : 0.95 + 0.05 * (e - knee) / (largest - knee);
      const double feature = std::sqrt(
          std::max(std::abs(t.edge[i] - r.edge[i]), std::abs(t.point[i] - r.point[i])) / std::sqrt(2.0));
      result.push_back(std::pow(color, 1.0 - feature));
    }
    return result;
  }
};

TEST(Flip, FollowsItsDefinition) {
  const int width = 37, height = 70;  // two strips of rows
  const Pixels reference = noise(width * height, 1.0f, 1);
  Pixels test = reference;
  std::mt19937 generator(4);
  for (C3f& p : test)
    if (generator() % 3 == 0) p = C3f(p.z, p.x, p.y);
  const Flip flip = ldr_flip(test, reference, width, height);
  const std::vector<double> expected = Definition{width, height}.error(test, reference);
  double mean = 0.0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    // The 0.7th power is steep near zero: rounding of 1e-6 may show as 1e-4.
    EXPECT_NEAR(flip.map[i], expected[i], 5e-4) << i;
    mean += expected[i] / static_cast<double>(expected.size());
  }
  EXPECT_NEAR(flip.mean, mean, 2e-5);
  EXPECT_GT(flip.mean, 0.05);
}

TEST(Flip, EqualPicturesDoNotDiffer) {
  const Pixels a = noise(50 * 40, 1.0f, 2);
  EXPECT_EQ(ldr_flip(a, a, 50, 40).mean, 0.0);
  EXPECT_EQ(hdr_flip(a, a, 50, 40).mean, 0.0);
}

// Lightness differs by 100, chroma not at all, and there are no features: e = 100^0.7. The largest difference,
// from CIELAB tables of green (87.73, -86.18, 83.18) and blue (32.30, 79.19, -107.86): |dL| + |d(0.01 L (a,
// b))|.
TEST(Flip, BlackAndWhite) {
  const double a = 0.8773 * -86.18 - 0.3230 * 79.19, b = 0.8773 * 83.18 + 0.3230 * 107.86;
  const double largest = std::pow(87.73 - 32.30 + std::hypot(a, b), 0.7), knee = 0.4 * largest;
  const double expected = 0.95 + 0.05 * (std::pow(100.0, 0.7) - knee) / (largest - knee);
  const Pixels black = uniform(30 * 30, {0.0f, 0.0f, 0.0f}), white = uniform(30 * 30, {1.0f, 1.0f, 1.0f});
  EXPECT_NEAR(ldr_flip(black, white, 30, 30).mean, expected, 1e-4);
  EXPECT_NEAR(ldr_flip(white, black, 30, 30).mean, expected, 1e-4);
  EXPECT_GT(expected, 0.96);
}

TEST(Flip, GreenAndBlueDifferMost) {
  const Pixels green = uniform(400, {0.0f, 1.0f, 0.0f}), blue = uniform(400, {0.0f, 0.0f, 1.0f});
  EXPECT_NEAR(ldr_flip(green, blue, 20, 20).mean, 1.0, 1e-4);
}

TEST(Flip, LdrIsSymmetric) {
  const Pixels a = noise(40 * 40, 1.0f, 5), b = noise(40 * 40, 1.0f, 6);
  const Flip ab = ldr_flip(a, b, 40, 40), ba = ldr_flip(b, a, 40, 40);
  EXPECT_EQ(ab.map, ba.map);
}

TEST(Flip, MirroredPicturesGiveTheMirroredMap) {
  const int w = 45, h = 130;
  Pixels a = noise(w * h, 1.0f, 7), b = noise(w * h, 1.0f, 8);
  Flip before = ldr_flip(a, b, w, h);
  std::reverse(a.begin(), a.end());
  std::reverse(b.begin(), b.end());
  Flip after = ldr_flip(a, b, w, h);
  std::reverse(after.map.begin(), after.map.end());
  for (std::size_t i = 0; i < before.map.size(); ++i) EXPECT_NEAR(before.map[i], after.map[i], 2e-4f);
}

TEST(Flip, ExposuresComeFromTheReference) {
  // Half the pixels 1, half 16 (one more of 1 makes it the median): four stops apart.
  Pixels reference = uniform(101, {1.0f, 1.0f, 1.0f});
  std::fill_n(reference.begin(), 50, C3f(16.0f, 16.0f, 16.0f));
  const Flip flip = hdr_flip(reference, reference, 101, 1);
  EXPECT_NEAR(flip.stop_stops - flip.start_stops, 4.0f, 1e-4f);
  EXPECT_EQ(flip.exposures, 4);
  // The curve (0.9036 x^2 + 0.018 x) / (0.8748 x^2 + 0.354 x + 0.14) reaches 0.85 at the exposed median.
  const double x = std::exp2(flip.stop_stops);
  EXPECT_NEAR((0.9036 * x * x + 0.018 * x) / (0.8748 * x * x + 0.354 * x + 0.14), 0.85, 1e-5);
}

TEST(Flip, HdrDoesNotDependOnTheUnitOfRadiance) {
  const Pixels a = noise(30 * 30, 5.0f, 9), b = noise(30 * 30, 5.0f, 10);
  Pixels a1000 = a, b1000 = b;
  for (C3f& c : a1000) c *= 1024.0f;
  for (C3f& c : b1000) c *= 1024.0f;
  EXPECT_NEAR(hdr_flip(a, b, 30, 30).mean, hdr_flip(a1000, b1000, 30, 30).mean, 1e-5);
}

TEST(Flip, HdrOfExtremePicturesIsFinite) {
  const Pixels black = uniform(100, {0.0f, 0.0f, 0.0f}), huge = uniform(100, {3e38f, 3e38f, 3e38f});
  Pixels mostly_black = black;
  mostly_black[7] = C3f(1e-30f, 0.0f, 0.0f);
  mostly_black[8] = C3f(1e30f, -1e30f, 5.0f);
  for (const Pixels& t : {black, huge, mostly_black})
    for (const Pixels& r : {black, huge, mostly_black}) {
      const Flip flip = hdr_flip(t, r, 10, 10);
      for (const float e : flip.map) EXPECT_TRUE(e >= 0.0f && e <= 1.0f) << e;
    }
  EXPECT_EQ(hdr_flip(black, black, 10, 10).exposures, 1);
  EXPECT_GT(hdr_flip(huge, black, 10, 10).mean, 0.9);
}

TEST(Flip, PicturesSmallerThanTheKernels) {
  const Pixels a = noise(2, 1.0f, 1), b = noise(2, 1.0f, 2);
  EXPECT_GT(ldr_flip(a, b, 2, 1).mean, 0.0);
  EXPECT_GT(ldr_flip(a, b, 1, 2).mean, 0.0);
}

}  // namespace
}  // namespace twopass
