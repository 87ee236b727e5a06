// What a benchmark has found, and its files.
#pragma once

#include <string>
#include <vector>

#include "render/bench/pass_one.h"
#include "render/bench/series.h"

namespace twopass {

struct BenchScene {
  std::string name, file, fingerprint;
  int width = 0, height = 0;
  std::size_t triangles = 0;
  BenchReference reference;
  std::vector<BenchSeries> series;
  std::vector<PassOneResult> pass_one;
  std::vector<std::string> notes;  ///< what was left out, and why
};

struct BenchResults {
  std::string command;  ///< that the user gave
  std::string machine;  ///< processor, cores and system
  std::string versions;
  int threads = 0;
  std::vector<BenchScene> scenes;
  bool is_complete = false;
};

/// Processor, number of threads and system, in one line.
std::string machine_text(int threads);
/// Program and compiler.
std::string versions_text();

/// results.json: everything. Numbers that are not known are null.
std::string results_json(const BenchResults& results);
/// results.csv: a line for each mean over the seeds, and a heading.
std::string results_csv(const BenchResults& results);
/// pass_one.csv: a line for each solution.
std::string pass_one_csv(const BenchResults& results);

}  // namespace twopass
