// twopass info: what is in a scene, what it needs, and what will be skipped.
#include <algorithm>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "render/commands/command.h"
#include "render/commands/display_options.h"
#include "render/commands/scene_options.h"
#include "render/commands/scene_report.h"
#include "render/core/parallel.h"
#include "render/scene/centred_scene.h"
#include "render/view_probe.h"

namespace twopass {

namespace {

using nlohmann::ordered_json;

struct InfoOptions {
  SceneOptions scene;
  std::string config;
  bool json = false;
};

std::string text(const ordered_json& value) {
  if (value.is_string()) return printable(value.get<std::string>());
  if (value.is_number_float()) {
    char number[32];
    std::snprintf(number, sizeof number, "%.5g", value.get<double>());
    return number;
  }
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_null()) return "none";
  if (value.is_array()) {
    std::string joined;
    for (const ordered_json& entry : value) joined += (joined.empty() ? "" : " ") + text(entry);
    return joined;
  }
  return value.dump();
}

void print(const ordered_json& value, int indent) {
  for (const auto& [key, entry] : value.items()) {
    if (entry.is_object()) {
      if (!entry.empty()) std::printf("%*s%s\n", indent, "", key.c_str());
      print(entry, indent + 2);
    } else if (key == "skipped") {
      for (const ordered_json& skipped : entry)
        std::printf("%*sskipped: %s, because %s\n", indent, "", text(skipped["what"]).c_str(),
                    text(skipped["why"]).c_str());
    } else if (key == "problems") {
      for (const ordered_json& problem : entry)
        std::printf("%*slook at: %s\n", indent, "", text(problem).c_str());
    } else {
      std::printf("%*s%-*s %s\n", indent, "", 24 - indent, key.c_str(), text(entry).c_str());
    }
  }
}

// A row for each, a column for each of the keys that any of them has.
void print_table(const char* title, const ordered_json& rows) {
  std::vector<std::string> keys;
  for (const ordered_json& row : rows)
    for (const auto& [key, value] : row.items())
      if (std::ranges::find(keys, key) == keys.end()) keys.push_back(key);
  std::vector<std::size_t> widths;
  for (const std::string& key : keys) {
    std::size_t width = key.size();
    for (const ordered_json& row : rows)
      if (row.contains(key)) width = std::max(width, text(row[key]).size());
    widths.push_back(width);
  }
  std::printf("\n%s\n", title);
  const auto line = [&](const auto& cell) {
    for (std::size_t i = 0; i < keys.size(); ++i)
      std::printf(i == 0 ? "  %-*s" : "  %*s", static_cast<int>(widths[i]), cell(keys[i]).c_str());
    std::printf("\n");
  };
  line([](const std::string& key) { return key; });
  for (const ordered_json& row : rows)
    line([&](const std::string& key) { return row.contains(key) ? text(row[key]) : std::string("-"); });
}

// What the view of the scene's camera says of pass one.
void add_view(ordered_json& report, LoadedScene loaded) {
  Plan plan;
  plan.radiosity_pass = report["needs"]["radiosity_pass"];
  if (!plan.radiosity_pass || !loaded.scene.camera) return;
  const auto integrator = value_of_name<IntegratorKind>(
      integrator_names, report["integrator"].get<std::string>(), "integrator", "integrator");
  const FileSettings& file = loaded.settings;
  const Scene scene(centred(std::move(loaded.scene)));
  const Camera camera(*scene.description().camera, file.width, file.height);
  fit_to_view(plan, integrator, scene, camera, {{0, 0}, {file.width, file.height}},
              {file.max_depth, file.rr_depth, file.hide_emitters}, file.seed.value_or(0));
  report["needs"]["radiosity_pass"] = plan.radiosity_pass;
  for (const Skipped& entry : plan.skipped)
    report["skipped"].push_back({{"what", entry.what}, {"why", entry.why}});
}

int info(const InfoOptions& options, const GlobalOptions& global) {
  const ThreadLimit limit(global.threads);
  LoadedScene loaded = options.scene.load(global.console(), SceneOptions::Additions::none, options.config);
  ordered_json report = scene_report(loaded);
  add_view(report, std::move(loaded));
  if (options.json) {
    // Names come from files, which may hold anything.
    std::printf("%s\n", report.dump(2, ' ', false, ordered_json::error_handler_t::replace).c_str());
    return 0;
  }
  const ordered_json shapes = report["shapes_by_name"], materials = report["materials_by_name"];
  report.erase("shapes_by_name");
  report.erase("materials_by_name");
  report.erase("notes");  // the console has them
  print(report, 0);
  if (!global.verbose) return 0;
  print_table("shapes", shapes);
  print_table("materials", materials);
  return 0;
}

}  // namespace

void add_info_command(CLI::App& program, const GlobalOptions& global, Action& action) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App& command =
      *program.add_subcommand("info", "What is in a scene, what it needs, what will be skipped and why");
  options->scene.add_to(command);
  add_ocio_option(command, options->config);
  command.add_flag("--json", options->json, "Print JSON");
  command.callback(
      [options, &global, &action] { action = [options, &global] { return info(*options, global); }; });
}

}  // namespace twopass
