// The arithmetic of the benchmark: what it says of errors, times, bias and noise.
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "render/bench/results.h"
#include "render/web/bench_page.h"
#include "render/web/log_plot.h"

namespace twopass {
namespace {

constexpr int width = 48, height = 40;

BenchReference reference_of_ones(double own_deviation, unsigned seed) {
  BenchReference reference;
  reference.picture = Image(width, height, {"R", "G", "B"});
  std::mt19937 generator(seed);
  std::normal_distribution<double> noise;
  for (float& v : reference.picture.pixels) v = static_cast<float>(1.0 + own_deviation * noise(generator));
  reference.variance.assign(reference.picture.pixel_count(),
                            C3f(static_cast<float>(own_deviation * own_deviation)));
  estimate_own_error(reference);
  return reference;
}

Image noisy(double mean, double deviation, unsigned seed) {
  Image image(width, height, {"R", "G", "B"});
  std::mt19937 generator(seed);
  std::normal_distribution<double> value(mean, deviation);
  for (float& v : image.pixels) v = static_cast<float>(value(generator));
  return image;
}

TEST(BenchSeries, TheReferencesOwnErrorIsTakenOff) {
  const BenchReference reference = reference_of_ones(0.05, 1);
  EXPECT_NEAR(reference.relmse, 0.05 * 0.05 / 1.01, 1e-4);
  EXPECT_NEAR(reference.mse, 0.05 * 0.05, 1e-6);
  SeriesCollector collector("scene", "method", reference);
  collector.begin_run(0);
  const BenchPoint& point = collector.add({.samples_per_pixel = 1}, noisy(1.0, 1e-9, 2));
  // 5760 values: what is taken off is known to 2 %.
  EXPECT_NEAR(point.relmse, 0.0, 0.1 * reference.relmse) << "the picture is the truth";
  EXPECT_NEAR(point.mse, 0.0, 0.1 * reference.mse);
}

TEST(BenchSeries, TellsBiasFromVariance) {
  // Little noise: relMSE's weights are the reference's, so that its noise and that of its weights are one.
  const BenchReference reference = reference_of_ones(0.01, 999);
  SeriesCollector collector("scene", "method", reference);
  constexpr int runs = 6;
  for (unsigned run = 0; run < runs; ++run) {
    collector.begin_run(run);
    for (int samples = 1; samples <= 4; samples *= 2)
      collector.add({.samples_per_pixel = samples,
                     .time = {1.0 * samples, 2.0 * samples},
                     .pass_one = {0.5, 0.5},
                     .rays = 100u * static_cast<unsigned>(samples)},
                    noisy(1.1, 0.2 / std::sqrt(samples), 100 * run + static_cast<unsigned>(samples)));
    collector.end_run(1000 + run);
  }
  const BenchSeries series = collector.finish();
  ASSERT_EQ(series.points.size(), 3u);
  for (const SeriesPoint& p : series.points) {
    const double variance = 0.04 / p.samples_per_pixel;
    EXPECT_EQ(p.runs, runs);
    EXPECT_DOUBLE_EQ(p.time.seconds, p.samples_per_pixel);
    EXPECT_EQ(p.rays, 100u * static_cast<unsigned>(p.samples_per_pixel));
    // 5760 values a run: a variance is known to 2 %.
    EXPECT_NEAR(p.mse, 0.01 + variance, 0.002);
    EXPECT_NEAR(p.variance * 1.01, variance, 0.05 * variance);
    EXPECT_NEAR(p.bias2 * 1.01, 0.01, 0.0008);
    EXPECT_NEAR(p.energy_ratio.x, 1.1, 0.01);
    EXPECT_NEAR(p.bias2 + p.variance, p.relmse, 0.02 * p.relmse) << "the parts add up";
  }
  EXPECT_EQ(series.runs[5].memory_bytes, 1005u);
  EXPECT_EQ(series.difference.size(), reference.picture.pixel_count());
}

TEST(BenchSeries, WithoutBiasThereIsNone) {
  const BenchReference reference = reference_of_ones(0.0, 1);
  SeriesCollector collector("scene", "method", reference);
  for (unsigned run = 0; run < 4; ++run) {
    collector.begin_run(run);
    collector.add({.samples_per_pixel = 1}, noisy(1.0, 0.3, 7 + run));
    collector.end_run(0);
  }
  const SeriesPoint p = collector.finish().points.at(0);
  EXPECT_NEAR(p.bias2, 0.0, 0.03 * p.relmse);
}

TEST(BenchSeries, OneRunHasNoVarianceAndRunsThatWereCutShortDoNotCount) {
  const BenchReference reference = reference_of_ones(0.0, 1);
  SeriesCollector collector("scene", "method", reference);
  collector.begin_run(0);
  collector.add({.samples_per_pixel = 1}, noisy(1.0, 0.1, 1));
  collector.add({.samples_per_pixel = 2}, noisy(1.0, 0.1, 2));
  collector.end_run(0);
  EXPECT_EQ(collector.last_samples(), 2);
  EXPECT_FALSE(std::isfinite(collector.finish().points.at(0).variance));
  collector.begin_run(1);
  collector.add({.samples_per_pixel = 1}, noisy(1.0, 0.1, 3));
  collector.end_run(0);
  EXPECT_EQ(collector.finish().points.size(), 1u);
}

TEST(TimeToError, LiesOnTheStraightLineOfLogarithms) {
  std::vector<SeriesPoint> points(3);
  for (std::size_t i = 0; i < 3; ++i) {
    points[i].time.cpu_seconds = std::pow(4.0, static_cast<double>(i));
    points[i].relmse = 1.0 / points[i].time.cpu_seconds;
  }
  EXPECT_NEAR(time_to_error(points, 0.5), 2.0, 1e-12);
  EXPECT_NEAR(time_to_error(points, 1.0 / 16.0), 16.0, 1e-12);
  EXPECT_EQ(time_to_error(points, 2.0), 1.0) << "it was there from the beginning";
  EXPECT_FALSE(std::isfinite(time_to_error(points, 0.01)));
  EXPECT_FALSE(std::isfinite(time_to_error({}, 1.0)));
}

BenchResults some_results() {
  BenchResults results;
  results.command = "twopass bench";
  BenchScene scene;
  scene.name = "a,\"b\"<script>";
  scene.width = width;
  scene.height = height;
  scene.reference = reference_of_ones(0.01, 1);
  for (const char* method : {"path", "twopass"}) {
    SeriesCollector collector(scene.name, method, scene.reference);
    for (unsigned run = 0; run < 2; ++run) {
      collector.begin_run(run);
      for (int samples = 1; samples <= 8; samples *= 2)
        collector.add({.samples_per_pixel = samples, .time = {0.1 * samples, 0.2 * samples}},
                      noisy(1.0, (method[0] == 'p' ? 0.4 : 0.2) / std::sqrt(samples),
                            static_cast<unsigned>(samples) + run));
      collector.end_run(0);
    }
    scene.series.push_back(collector.finish());
  }
  results.scenes.push_back(std::move(scene));
  return results;
}

TEST(BenchResults, JsonAndCsvHoldEveryPoint) {
  const BenchResults results = some_results();
  const auto json = nlohmann::json::parse(results_json(results));
  const auto& series = json["scenes"][0]["series"];
  ASSERT_EQ(series.size(), 2u);
  EXPECT_EQ(series[0]["points"].size(), 4u);
  EXPECT_EQ(series[0]["runs"].size(), 2u);
  for (const char* key : {"relmse", "mse", "smape", "flip", "bias2", "variance", "energy_ratio", "rays",
                          "seconds", "cpu_seconds", "pass_one_share"})
    EXPECT_TRUE(series[1]["points"][3].contains(key)) << key;
  const std::string csv = results_csv(results);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 8);
  EXPECT_NE(csv.find("\"a,\"\"b\"\"<script>\",path,2,1,"), std::string::npos) << csv;
}

TEST(BenchPage, IsOneFileWithPlotsPicturesAndRatios) {
  const std::string page = bench_page(some_results(), DisplayTransform());
  EXPECT_EQ(page.find("<script>"), std::string::npos) << "names are escaped, and it needs no script";
  for (const char* part :
       {"<svg role=\"img\"", "data:image/png;base64,", "slope -1", "Time to error", "relMSE"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  EXPECT_EQ(page.find("http://"), std::string::npos);
  EXPECT_EQ(page.find("https://"), std::string::npos);
}

TEST(LogPlot, LeavesOutWhatHasNoLogarithm) {
  const std::string svg =
      log_plot_svg({"x", "y", "test", {{"line", {{1.0, 10.0}, {10.0, 1.0}, {100.0, -1.0}}}}});
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  std::size_t marks = 0;
  for (std::size_t at = 0; (at = svg.find("<circle", at)) != std::string::npos; ++at) ++marks;
  EXPECT_EQ(marks, 2u);
  EXPECT_NE(log_plot_svg({"x", "y", "test", {}}).find("Nothing"), std::string::npos);
}

}  // namespace
}  // namespace twopass
