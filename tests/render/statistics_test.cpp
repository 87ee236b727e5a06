#include "render/statistics.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace twopass {
namespace {

nlohmann::json written(const RenderStatistics& statistics) {
  const auto path =
      std::filesystem::temp_directory_path() / ("twopass-stats-" + std::to_string(getpid()) + ".json");
  write_statistics(path, statistics);
  std::ifstream in(path);
  const auto json = nlohmann::json::parse(in);
  std::filesystem::remove(path);
  return json;
}

TEST(Statistics, HoldsEveryFieldOfTheContract) {
  RenderStatistics s;
  s.width = 4;
  s.height = 2;
  s.samples = 80;
  s.relative_error = 0.25;
  s.radiosity.emplace();
  const auto json = written(s);
  EXPECT_EQ(json["program"]["name"], "twopass");
  for (const char* key : {"file", "triangles", "emitters", "skipped"})
    EXPECT_TRUE(json["scene"].contains(key)) << key;
  for (const char* key : {"load", "build", "radiosity", "render", "write", "total"})
    EXPECT_TRUE(json["seconds"].contains(key)) << key;
  for (const char* key : {"radiosity", "render", "total"})
    EXPECT_TRUE(json["cpu_seconds"].contains(key)) << key;
  for (const char* key : {"solver", "form_factors", "elements", "links", "iterations", "rays", "residual",
                          "error_bound", "memory_bytes"})
    EXPECT_TRUE(json["radiosity"].contains(key)) << key;
  for (const char* key :
       {"integrator", "width", "height", "spp", "samples", "rays", "shadow_rays", "escaped_rays",
        "non_finite_samples", "first_non_finite", "relative_error", "relative_error_bound", "stop_reason",
        "pixels_stopped_early", "sampler", "clamped", "bias"})
    EXPECT_TRUE(json["render"].contains(key)) << key;
  for (const char* key : {"peak_memory_bytes", "threads", "seed"}) EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_EQ(json["render"]["spp"], 10.0);
}

TEST(Statistics, HoldsTheCertificateOrNull) {
  RenderStatistics s;
  s.width = s.height = 1;
  EXPECT_TRUE(written(s)["render"]["bias"].is_null());
  s.bias = Certificate{.mean = -0.0125, .ci95 = 0.0025, .samples = 4096, .counts = {}};
  const auto bias = written(s)["render"]["bias"];
  EXPECT_EQ(bias["mean"], -0.0125);
  EXPECT_EQ(bias["ci95"], 0.0025);
  EXPECT_EQ(bias["samples"], 4096);
}

TEST(Statistics, ASkippedPassIsNullWithItsReasonAndNothingIsInfinite) {
  RenderStatistics s;
  s.width = s.height = 1;
  s.relative_error = std::numeric_limits<double>::infinity();
  s.skipped.push_back({"radiosity pass", "the scene has no light"});
  const auto json = written(s);
  EXPECT_TRUE(json["radiosity"].is_null());
  EXPECT_TRUE(json["render"]["relative_error"].is_null());
  EXPECT_EQ(json["scene"]["skipped"][0]["why"], "the scene has no light");
}

}  // namespace
}  // namespace twopass
