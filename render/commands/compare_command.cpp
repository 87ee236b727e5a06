// twopass compare: how far one picture is from another.
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "render/commands/command.h"
#include "render/core/error.h"
#include "render/image/atomic_file.h"
#include "render/image/compare.h"
#include "render/image/picture.h"
#include "render/web/compare_json.h"
#include "render/web/compare_page.h"

namespace twopass {

namespace {

struct CompareOptions {
  std::string test, reference, json_file, html_file;
  std::vector<int> crop;  // left, top, width, height
  DisplayOptions display;
  std::vector<std::string> limits;  // NAME=VALUE
};

struct Limit {
  const Measure* measure;
  double value;
};

Limit parse_limit(const std::string& text) {
  const std::string where = "--max " + text;
  const std::size_t equals = text.find('=');
  char* end = nullptr;
  const double value = equals == std::string::npos ? 0.0 : std::strtod(text.c_str() + equals + 1, &end);
  if (!end || end == text.c_str() + equals + 1 || *end != '\0' || std::isnan(value))
    throw Error(where, "not of the form NAME=VALUE", "write for example --max relmse=1e-3");
  return {&measure_of_name(text.substr(0, equals), where), value};
}

// A part of both pictures alone.
Image cropped(const Image& image, const std::vector<int>& crop, const std::string& file) {
  if (crop.empty()) return image;
  const int left = crop[0], top = crop[1], width = crop[2], height = crop[3];
  if (left < 0 || top < 0 || width < 1 || height < 1 || left > image.width - width ||
      top > image.height - height)
    throw Error("--crop", "the window reaches beyond " + file,
                "give LEFT,TOP,WIDTH,HEIGHT inside of " + std::to_string(image.width) + "x" +
                    std::to_string(image.height));
  Image part(width, height, image.channels);
  const std::size_t row = static_cast<std::size_t>(width) * image.channels.size();
  for (int y = 0; y < height; ++y)
    std::copy_n(image.pixels.begin() + static_cast<std::ptrdiff_t>(image.index(left, top + y, 0)), row,
                part.pixels.begin() + static_cast<std::ptrdiff_t>(part.index(0, y, 0)));
  return part;
}

void print(const Comparison& c) {
  for (const Measure& measure : measures()) {
    if (measure.name == "energy_ratio")
      std::printf("%-15s %.5f %.5f %.5f", "energy_ratio", c.energy_ratio.x, c.energy_ratio.y, c.energy_ratio.z);
    else
      std::printf("%-15s %-23.6g", std::string(measure.name).c_str(), measure.value(c));
    std::printf("  %s\n", std::string(measure.formula).c_str());
  }
}

// Layers beside the picture, in one line each.
void print_layer(const ComparedLayer& layer) {
  std::printf("layer %-20s relmse %.6g, mse %.6g, bias2 %.6g\n", layer.pair.name.c_str(), layer.result.relmse,
              layer.result.mse, layer.result.bias2);
}

void write_text(const std::string& path, const std::string& text) {
  write_atomically(path, std::as_bytes(std::span(text)));
}

int compare_files(const CompareOptions& options, const GlobalOptions& global) {
  std::vector<Limit> limits;
  for (const std::string& text : options.limits) limits.push_back(parse_limit(text));
  for (const std::string& file : {options.json_file, options.html_file})
    if (!file.empty()) check_writable(file);
  std::optional<DisplayTransform> display;
  if (!options.html_file.empty()) display.emplace(options.display);
  PictureSource test{options.test, {}}, reference{options.reference, {}};
  const Image test_image = cropped(read_picture(test.file, &test.metadata), options.crop, test.file);
  const Image reference_image =
      cropped(read_picture(reference.file, &reference.metadata), options.crop, reference.file);
  std::vector<ComparedLayer> layers;
  for (LayerPair& pair : common_layers(test_image, reference_image)) {
    Comparison comparison = compare(pair);
    layers.push_back({std::move(pair), std::move(comparison)});
  }
  const Comparison& result = layers.front().result;
  if (!options.json_file.empty())
    write_text(options.json_file,
               comparison_json(layers).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  if (display) write_text(options.html_file, compare_page(test, reference, layers, *display));
  if (!global.quiet) {
    std::printf("%-15s %dx%d\n", "size", result.width, result.height);
    print(result);
    for (const ComparedLayer& layer : std::span(layers).subspan(1)) print_layer(layer);
    if (display) std::printf("wrote %s\n", options.html_file.c_str());
  }
  int exit_code = 0;
  for (const Limit& limit : limits) {
    const double value = limit.measure->value(result);
    if (value <= limit.value) continue;
    std::fprintf(stderr, "%s: %s is %.6g, more than %.6g; see the measures above\n", options.test.c_str(),
                 std::string(limit.measure->name).c_str(), value, limit.value);
    exit_code = 1;
  }
  return exit_code;
}

}  // namespace

void add_compare_command(CLI::App& program, const GlobalOptions& global, Action& action) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App& command = *program.add_subcommand("compare", "Error measures of a picture against a reference");
  command.add_option("test", options->test, "Picture to judge")->required();
  command.add_option("reference", options->reference, "Picture to judge it by")->required();
  command.add_option("--json", options->json_file, "Write the measures as JSON");
  command.add_option("--html", options->html_file,
                     "Write a report to look at: one file for any browser, without network");
  command
      .add_option("--crop", options->crop,
                  "The part of both pictures to compare, LEFT,TOP,WIDTH,HEIGHT in pixels")
      ->delimiter(',')
      ->expected(4);
  command.add_option("--ocio", options->display.config,
                     "OpenColorIO configuration of the report (default: $OCIO, else built in)");
  command.add_option("--display", options->display.display, "Display of the configuration");
  command.add_option("--view", options->display.view, "View of the display");
  command
      .add_option("--max", options->limits,
                  "NAME=VALUE: exit with 1 if the measure exceeds the value (repeatable)")
      ->allow_extra_args(false);
  command.callback(
      [options, &global, &action] { action = [options, &global] { return compare_files(*options, global); }; });
}

}  // namespace twopass
