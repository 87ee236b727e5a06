// twopass form-factors: the diffuse exchange between the scene's named shapes.
#include <cstdio>

#include <nlohmann/json.hpp>

#include "radiosity/form_factor_table.h"
#include "render/commands/command.h"
#include "render/commands/scene_options.h"
#include "render/core/parallel.h"

namespace twopass {

namespace {

struct FormFactorsOptions {
  SceneOptions scene;
  std::string method = "auto";
  FormFactorOptions factors;
  bool no_occlusion = false, json = false;
};

void print_json(const FormFactorTable& table) {
  nlohmann::ordered_json shapes = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < table.names.size(); ++i)
    shapes.push_back({{"name", table.names[i]}, {"area", table.areas[i]}});
  const nlohmann::ordered_json json = {
      {"shapes", shapes},
      {"F", table.F},
      {"method", name_of_value<FormFactorMethod>(form_factor_method_names, table.method)},
      {"closure_error", table.closure_error}};
  std::printf("%s\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace).c_str());
}

// Names across and down, the area in front, the sum at the end of each row.
void print_table(const FormFactorTable& table) {
  int width = 10;
  for (const std::string& name : table.names) width = std::clamp(static_cast<int>(name.size()), width, 24);
  std::printf("%-*.*s %10s", width, width, "from \\ to", "area");
  for (const std::string& name : table.names) std::printf(" %*.*s", width, width, name.c_str());
  std::printf(" %10s\n", "sum");
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    std::printf("%-*.*s %10.4g", width, width, table.names[i].c_str(), table.areas[i]);
    double sum = 0.0;
    for (const double f : table.F[i]) {
      std::printf(" %*.6f", width, f);
      sum += f;
    }
    std::printf(" %10.6f\n", sum);
  }
  std::printf("method %s, closure error %.2g\n",
              std::string(name_of_value<FormFactorMethod>(form_factor_method_names, table.method)).c_str(),
              table.closure_error);
}

int form_factors(FormFactorsOptions options, const GlobalOptions& global) {
  const ThreadLimit limit(global.threads);
  options.factors.method = value_of_name<FormFactorMethod>(form_factor_method_names, options.method, "--method",
                                                           "form factor method");
  options.factors.occlusion = !options.no_occlusion;
  const Scene scene(options.scene.load(global.console(), SceneOptions::Framing::none).scene);
  const FormFactorTable table = form_factor_table(scene, options.factors);
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
  command.add_option("--method", options->method, "auto, exact, point or rays");
  command.add_option("--rays", options->factors.rays, "Rays from each shape, for the method rays")
      ->check(CLI::Range(1, 1 << 30));
  command.add_option("--seed", options->factors.seed, "Seed of all random numbers");
  command.add_flag("--no-occlusion", options->no_occlusion, "Shapes do not hide each other");
  command.add_flag("--json", options->json, "Print JSON");
  command.callback(
      [options, &global, &action] { action = [options, &global] { return form_factors(*options, global); }; });
}

}  // namespace twopass
