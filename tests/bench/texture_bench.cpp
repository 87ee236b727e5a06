// CPU time of a texture look-up: images in memory, tiles from the cache, with footprints and without.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <random>

#include "materials/texture.h"
#include "render/core/error.h"
#include "render/image/read_texture.h"

namespace twopass {
namespace {

double cpu_seconds() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Points of a walk over the texture, as neighbouring paths look at it, or anywhere.
std::vector<V2f> points(bool is_walk) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  std::vector<V2f> result(1 << 18);
  V2f at(0.5f, 0.5f);
  for (V2f& p : result) {
    const V2f u(uniform(generator), uniform(generator));
    at += (u - V2f(0.5f)) * 0.01f;
    p = is_walk ? at : u;
  }
  return result;
}

void measure(const char* name, const Texture& texture, float footprint) {
  for (const bool is_walk : {true, false}) {
    const std::vector<V2f> uvs = points(is_walk);
    std::vector<double> seconds;
    C3f sum(0.0f);
    for (int repetition = 0; repetition < 7; ++repetition) {
      const double start = cpu_seconds();
      for (const V2f& uv : uvs) sum += color_at(texture, {uv, V2f(footprint)});
      seconds.push_back(cpu_seconds() - start);
    }
    std::ranges::nth_element(seconds, seconds.begin() + 3);
    std::printf("%-28s footprint %-8g %-8s %7.1f ns   (mean %.4f)\n", name, static_cast<double>(footprint),
                is_walk ? "walk" : "anywhere", 1e9 * seconds[3] / static_cast<double>(uvs.size()),
                static_cast<double>(sum.x) / (7.0 * static_cast<double>(uvs.size())));
  }
}

}  // namespace
}  // namespace twopass

int main(int count, char** arguments) {
  using namespace twopass;
  if (count != 2) {
    std::fprintf(stderr, "usage: texture_bench PICTURE\n");
    return 2;
  }
  try {
    const Bitmap whole{read_texture(arguments[1], {}).image}, tiled{read_texture(arguments[1], {}, 1).image};
    for (const float footprint : {0.0f, 4e-3f}) {
      measure("in memory", whole, footprint);
      measure("by tiles", tiled, footprint);
    }
    measure("checkerboard", Checkerboard{}, 0.0f);
    measure("checkerboard", Checkerboard{}, 0.1f);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
