// Runs the cases of a corpus without libFuzzer: replay FORMAT FOLDER.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <vector>

#include "render/load/text_file.h"
#include "tests/fuzz/fuzz_case.h"

int main(int argc, char** argv) {
  using namespace twopass;
  if (argc != 3) return 2;
  const auto* format = std::ranges::find(fuzz_format_names, argv[1], &Named<FuzzFormat>::name);
  if (format == std::end(fuzz_format_names)) return 2;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(argv[2])) files.push_back(entry.path());
  std::ranges::sort(files);
  for (const std::filesystem::path& file : files) {
    std::fprintf(stderr, "%s\n", file.filename().c_str());  // the last one, should it crash
    run_fuzz_case(format->value, read_text_file(file));
  }
  std::printf("%zu cases\n", files.size());
  return files.empty() ? 1 : 0;
}
