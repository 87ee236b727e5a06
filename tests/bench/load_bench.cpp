// What loading an OBJ file costs: from the file to a SceneDescription, against tinyobjloader's ObjReader on the
// same file, which stops at arrays. CPU time of all threads, in turns.
//   load_bench [FILE.obj [REPETITIONS]]      without a file: a generated sphere of half a million triangles
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <vector>

#include <tiny_obj_loader.h>

#include "render/core/error.h"
#include "render/load/load.h"

namespace {

/// A sphere with texture coordinates and normals, as exporters write them.
void write_sphere(const std::filesystem::path& path) {
  constexpr int rings = 500, segments = 500;
  std::ofstream out(path);
  out << std::fixed;
  for (int r = 0; r <= rings; ++r)
    for (int s = 0; s <= segments; ++s) {
      const double theta = M_PI * r / rings, phi = 2.0 * M_PI * s / segments;
      const double x = std::sin(theta) * std::cos(phi), y = std::cos(theta),
                   z = std::sin(theta) * std::sin(phi);
      out << "v " << x << ' ' << y << ' ' << z << "\nvt " << s / double(segments) << ' ' << r / double(rings)
          << "\nvn " << x << ' ' << y << ' ' << z << '\n';
    }
  const auto corner = [&](int r, int s) {
    const int i = r * (segments + 1) + s + 1;
    out << ' ' << i << '/' << i << '/' << i;
  };
  for (int r = 0; r < rings; ++r)
    for (int s = 0; s < segments; ++s) {
      out << 'f';
      corner(r, s);
      corner(r, s + 1);
      corner(r + 1, s + 1);
      out << "\nf";
      corner(r, s);
      corner(r + 1, s + 1);
      corner(r + 1, s);
      out << '\n';
    }
}

template <class Work>
double cpu_seconds(const Work& work) {
  const std::clock_t begin = std::clock();
  work();
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

int run(std::filesystem::path path, int repetitions) {
  const bool is_generated = path.empty();
  if (is_generated) {
    path = std::filesystem::temp_directory_path() / "twopass_load_bench.obj";
    write_sphere(path);
  }
  std::vector<double> theirs, ours, ratios;
  for (int i = 0; i < repetitions; ++i) {
    theirs.push_back(cpu_seconds([&] {
      tinyobj::ObjReader reader;
      if (!reader.ParseFromFile(path.string())) throw std::runtime_error(reader.Error());
    }));
    ours.push_back(cpu_seconds([&] { twopass::load_scene(path, {}); }));
    ratios.push_back(ours.back() / theirs.back());
  }
  std::printf("%s, %.1f MB, medians of %d:\n  tinyobjloader %.3f s, ours %.3f s, ratio of a pair %.2f\n",
              path.filename().c_str(), static_cast<double>(std::filesystem::file_size(path)) / 1e6, repetitions,
              median(theirs), median(ours), median(ratios));
  if (is_generated) std::filesystem::remove(path);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc > 1 ? argv[1] : "", argc > 2 ? std::max(1, std::atoi(argv[2])) : 7);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
