// twopass form-factors: the diffuse exchange between the scene's named shapes.
#include <algorithm>
#include <cstdio>
#include <numeric>

#include <nlohmann/json.hpp>

#include "radiosity/form_factor_table.h"
#include "render/commands/command.h"
#include "render/commands/display_options.h"
#include "render/commands/scene_options.h"
#include "render/core/parallel.h"

namespace twopass {

namespace {

struct FormFactorsOptions {
  SceneOptions scene;
  std::string config;
  std::string method = "auto";
  FormFactorOptions factors;
  bool no_occlusion = false, json = false;
};

std::string name_of(FormFactorMethod method) {
  return std::string(name_of_value<FormFactorMethod>(form_factor_method_names, method));
}

void print_json(const FormFactorTable& table) {
  nlohmann::ordered_json shapes = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < table.names.size(); ++i)
    shapes.push_back({{"name", table.names[i]}, {"area", table.areas[i]}});
  const nlohmann::ordered_json json = {{"shapes", shapes},
                                       {"F", table.F},
                                       {"method", name_of(table.method)},
                                       {"closed", table.closed},
                                       {"closure_error", table.closure_error},
                                       {"closure_error_before", table.closure_error_before},
                                       {"degenerate_triangles", table.degenerate_triangles}};
  std::printf("%s\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace).c_str());
}

// Characters as a terminal shows them: bytes that continue a character in UTF-8 take no place.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}
std::string fitted(const std::string& name, std::size_t width) {
  std::string text = printable(name);
  if (width_of(text) > width) {
    while (width_of(text) > width - 3) text.pop_back();
    text += "...";
  }
  return text.append(width - width_of(text), ' ');
}

// Six decimals, or two digits of what is too small for them; an exact zero is short.
std::string factor_text(double f) {
  char text[32];
  std::snprintf(text, sizeof text, f == 0.0 ? "%.0f" : f < 1e-3 ? "%.2e" : "%.6f", f);
  return text;
}

// Rows have a number, a name and an area, columns the number alone; so many at a time that lines stay short.
void print_table(const FormFactorTable& table) {
  constexpr std::size_t columns_at_once = 8, longest_name = 28;
  const std::size_t shapes = table.names.size();
  std::size_t width = 9;
  for (const std::string& name : table.names) width = std::max(width, std::min(longest_name, width_of(name)));
  for (std::size_t first = 0; first < shapes; first += columns_at_once) {
    const std::size_t end = std::min(shapes, first + columns_at_once);
    std::printf("%s%4s %s %10s", first > 0 ? "\n" : "", "", fitted("from \\ to", width).c_str(), "area");
    for (std::size_t j = first; j < end; ++j) std::printf(" %9zu", j + 1);
    std::printf(end == shapes ? "       sum\n" : "\n");
    for (std::size_t i = 0; i < shapes; ++i) {
      std::printf("%4zu %s %10.4g", i + 1, fitted(table.names[i], width).c_str(), table.areas[i]);
      for (std::size_t j = first; j < end; ++j) std::printf(" %9s", factor_text(table.F[i][j]).c_str());
      if (end == shapes) std::printf(" %9.6f", std::accumulate(table.F[i].begin(), table.F[i].end(), 0.0));
      std::printf("\n");
    }
  }
  std::printf("method %s; ", name_of(table.method).c_str());
  if (table.closed)
    std::printf("closed, closure error %.2g (%.2g before enforcement)\n", table.closure_error,
                table.closure_error_before);
  else
    std::printf("not closed: up to %.4g of a shape's light goes elsewhere\n", table.closure_error);
}

int form_factors(FormFactorsOptions options, const GlobalOptions& global) {
  const ThreadLimit limit(global.threads);
  options.factors.method = value_of_name<FormFactorMethod>(form_factor_method_names, options.method, "--method",
                                                           "form factor method");
  options.factors.occlusion = !options.no_occlusion;
  const Scene scene(options.scene.load(global.console(), SceneOptions::Additions::none, options.config).scene);
  const FormFactorTable table = form_factor_table(scene, options.factors);
  for (const std::string& note : table.notes) global.console().note(note);
  if (options.json)
    print_json(table);
  else
    print_table(table);
  return 0;
}

}  // namespace

void add_form_factors_command(CLI::App& program, const GlobalOptions& global, Action& action) {
  auto options = std::make_shared<FormFactorsOptions>();
  CLI::App& command =
      *program.add_subcommand("form-factors", "Area-to-area form factors between the scene's named shapes");
  options->scene.add_to(command);
  add_ocio_option(command, options->config);
  command.add_option("--method", options->method, "auto, exact, point, hemicube or rays");
  command.add_option("--rays", options->factors.rays, "Rays from each shape, for the method rays")
      ->check(CLI::Range(1, 1 << 30));
  command
      .add_option("--hemicube-resolution", options->factors.hemicube_resolution,
                  "Pixels along the edge of a hemicube, for the method hemicube: even, 2 to 4096")
      ->check(CLI::Range(2, largest_hemicube_resolution));
  command.add_option("--seed", options->factors.seed, "Seed of all random numbers");
  command.add_flag("--no-occlusion", options->no_occlusion, "Shapes do not hide each other");
  command.add_flag("--json", options->json, "Print JSON");
  command.callback(
      [options, &global, &action] { action = [options, &global] { return form_factors(*options, global); }; });
}

}  // namespace twopass
