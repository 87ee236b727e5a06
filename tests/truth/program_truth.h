// Exact values through the program: scene files in, statistics and pictures out, a table of the errors.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "render/core/types.h"
#include "render/image/layers.h"
#include "render/image/picture.h"
#include "tests/program/program.h"

namespace twopass::test {

/// A value and the standard error that it was measured with, 0 where nothing is left to chance.
struct Measured {
  double value = 0.0, error = 0.0;
  Measured operator*(double factor) const { return {value * factor, error * std::abs(factor)}; }
  Measured operator-(double offset) const { return {value - offset, error}; }
};

/// A test that writes small scenes and reads what the program makes of them.
class ProgramTruth : public Program {
 protected:
  /// `ours` is the truth within its own noise (5 standard errors, but at most 2 %: errors by the scatter of
  /// samples are generous where those are of low discrepancy) and `bias`, which is what the method is known to
  /// be off by, and the rounding of the printed value. With TWOPASS_TRUTH_TABLE=FILE in the environment also
  /// appends the value to a Markdown table.
  static void record(const std::string& name, double truth, const Measured& ours, double bias = 0.0) {
    const double noise = std::min(5.0 * ours.error, 0.02 * std::abs(truth));
    EXPECT_NEAR(ours.value, truth, noise + bias + 1e-5 * std::abs(truth)) << name;
    const char* file = std::getenv("TWOPASS_TRUTH_TABLE");
    std::FILE* table = file != nullptr ? std::fopen(file, "a") : nullptr;
    if (table == nullptr) return;
    std::fprintf(table, "| %s | %.7g | %.7g | ", name.c_str(), truth, ours.value);
    if (truth != 0.0) std::fprintf(table, "%+.1e", ours.value / truth - 1.0);
    if (truth != 0.0 && ours.error > 0.0) std::fprintf(table, " +- %.0e", ours.error / std::abs(truth));
    std::fprintf(table, " |\n");
    std::fclose(table);
  }

  /// The quad p, p + a, p + a + b, p + b, facing a x b, as n x n faces, in the OBJ text of a group.
  static std::string quad(const V3d& p, const V3d& a, const V3d& b, int n = 1) {
    std::string text;
    char line[120];
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const V3d v = p + a * (static_cast<double>(i) / n) + b * (static_cast<double>(j) / n);
        std::snprintf(line, sizeof line, "v %.9g %.9g %.9g\n", v.x, v.y, v.z);
        text += line;
      }
    const int all = (n + 1) * (n + 1);
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const int k = j * (n + 1) + i - all;  // relative to the end
        std::snprintf(line, sizeof line, "f %d %d %d %d\n", k, k + 1, k + n + 2, k + n + 1);
        text += line;
      }
    return text;
  }

  struct Surface {
    std::string name, obj;  ///< of a file of its own
    double reflectance = 0.0;
    double radiance = 0.0;  ///< emitted, W/(m2 sr)
    std::string bsdf{};     ///< in place of a diffuse one
  };
  /// Writes scene.xml: the surfaces, what is given besides, and a camera.
  void write_scene(const std::vector<Surface>& surfaces, const std::string& more,
                   const std::string& camera) const {
    std::string text = "<scene version='3.0.0'>\n" + camera + more;
    for (const Surface& s : surfaces) {
      write(s.name + ".obj", s.obj);
      text += "<shape type='obj'><string name='filename' value='" + s.name + ".obj'/>" +
              (s.bsdf.empty() ? "<bsdf type='diffuse'><rgb name='reflectance' value='" + number(s.reflectance) +
                                    "'/></bsdf>"
                              : s.bsdf);
      if (s.radiance > 0.0)
        text += "<emitter type='area'><rgb name='radiance' value='" + number(s.radiance) + "'/></emitter>";
      text += "</shape>\n";
    }
    write("scene.xml", text + "</scene>\n");
  }
  static std::string number(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.9g", value);
    return text;
  }
  static std::string point(const V3d& p) { return number(p.x) + "," + number(p.y) + "," + number(p.z); }

  /// An orthographic camera a hundredth in front of `centre`, looking at it along -normal; a pixel is `pitch`
  /// wide, and shows the middle `part` of it. The picture's columns run along `up`, the last row first.
  static std::string flat_camera(const V3d& centre, const V3d& normal, const V3d& up, double pitch, int width,
                                 double part = 1.0) {
    const std::string scale = number(pitch * width / 2);
    return "<sensor type='orthographic'><float name='near_clip' value='0'/><transform name='to_world'><scale "
           "x='" +
           scale + "' y='" + scale + "'/><lookat origin='" + point(centre + normal * 0.01) + "' target='" +
           point(centre) + "' up='" + point(up) +
           "'/></transform><film type='hdrfilm'><rfilter type='box'><float name='radius' value='" +
           number(part / 2) + "'/></rfilter></film></sensor>\n";
  }

  /// Renders scene.xml and returns the red channel, row by row.
  std::vector<Measured> picture(const std::string& integrator, int width, int height, int samples,
                                const std::string& more = "") const {
    const Outcome result =
        run("render scene.xml -o a.exr --exr-type float --quiet --no-certificate --aov variance --integrator " +
            integrator + " --size " + std::to_string(width) + "x" + std::to_string(height) + " --spp " +
            std::to_string(samples) + " " + more);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    std::vector<Measured> red(static_cast<std::size_t>(width * height), Measured{-1.0, 0.0});
    if (result.exit_code != 0) return red;
    const Image image = read_picture(folder_ / "a.exr");
    const std::vector<Layer> layers = layers_of(image);
    const auto variance =
        std::ranges::find_if(layers, [](const Layer& layer) { return layer.name == "variance"; });
    EXPECT_TRUE(variance != layers.end());
    const std::vector<C3f> values = layer_pixels(image, layers.front()),
                           variances = layer_pixels(image, *variance);
    for (std::size_t i = 0; i < red.size(); ++i)
      red[i] = {static_cast<double>(values[i].x), std::sqrt(static_cast<double>(variances[i].x))};
    return red;
  }
  /// Of all pixels of a square picture.
  Measured mean(const std::string& integrator, int size, int samples, const std::string& more = "") const {
    Measured result;
    double variance = 0.0;
    const double pixels = size * size;
    for (const Measured& pixel : picture(integrator, size, size, samples, more)) {
      result.value += pixel.value / pixels;
      variance += pixel.error * pixel.error / (pixels * pixels);
    }
    result.error = std::sqrt(variance);
    return result;
  }
};

}  // namespace twopass::test
