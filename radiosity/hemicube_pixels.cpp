#include "radiosity/hemicube_pixels.h"

#include "render/core/error.h"

namespace twopass {

std::vector<HemicubePixel> hemicube_pixels(int resolution) {
  if (resolution < 2 || resolution > hemicube_max_resolution || resolution % 2 != 0)
    throw Error("hemicube", "a resolution of " + std::to_string(resolution) + " cannot be halved into pixels",
                "use an even one from 2 to " + std::to_string(hemicube_max_resolution));
  const double step = 2.0 / resolution;
  const auto centre = [&](int i) { return -1.0 + step * (i + 0.5); };
  std::vector<HemicubePixel> pixels;
  double sum = 0.0;
  const auto add = [&](const V3d& on_cube) {
    const double r2 = on_cube.length2();
    // Both cosines of a top pixel are 1 / r; those of a side pixel z / r and 1 / r.
    const double weight = on_cube.z / (r2 * r2);
    pixels.push_back({on_cube / std::sqrt(r2), weight});
    sum += weight;
  };
  for (int j = 0; j < resolution; ++j)
    for (int i = 0; i < resolution; ++i) add({centre(i), centre(j), 1.0});
  for (int j = resolution / 2; j < resolution; ++j)
    for (int i = 0; i < resolution; ++i)
      for (const double side : {-1.0, 1.0}) {
        add({side, centre(i), centre(j)});
        add({centre(i), side, centre(j)});
      }
  for (HemicubePixel& pixel : pixels) pixel.weight /= sum;
  return pixels;
}

}  // namespace twopass
