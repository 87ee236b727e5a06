// twopass compare: how far one picture is from another.
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "render/commands/command.h"
#include "render/core/error.h"
#include "render/image/atomic_file.h"
#include "render/image/compare.h"
#include "render/image/picture.h"

namespace twopass {

namespace {

struct CompareOptions {
  std::string test, reference, json_file;
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

nlohmann::ordered_json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

void write_json(const std::string& path, const Comparison& c) {
  nlohmann::ordered_json json;
  for (const Measure& measure : measures()) json[std::string(measure.name)] = number_or_null(measure.value(c));
  json["energy_ratio"] = {number_or_null(c.energy_ratio.x), number_or_null(c.energy_ratio.y),
                          number_or_null(c.energy_ratio.z)};
  json["non_finite"] = c.non_finite;
  json["size"] = {c.width, c.height};
  const std::string text = json.dump(2) + "\n";
  write_atomically(path, std::as_bytes(std::span(text)));
}

void print(const Comparison& c) {
  std::printf("%-15s %dx%d\n", "size", c.width, c.height);
  for (const Measure& measure : measures()) {
    if (measure.name == "energy_ratio")
      std::printf("%-15s %.5f %.5f %.5f", "energy_ratio", c.energy_ratio.x, c.energy_ratio.y, c.energy_ratio.z);
    else
      std::printf("%-15s %-23.6g", std::string(measure.name).c_str(), measure.value(c));
    std::printf("  %s\n", std::string(measure.formula).c_str());
  }
}

int compare_files(const CompareOptions& options, const GlobalOptions& global) {
  std::vector<Limit> limits;
  for (const std::string& text : options.limits) limits.push_back(parse_limit(text));
  if (!options.json_file.empty()) check_writable(options.json_file);
  const Comparison result = compare(read_picture(options.test), read_picture(options.reference));
  if (!options.json_file.empty()) write_json(options.json_file, result);
  if (!global.quiet) print(result);
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
  command
      .add_option("--max", options->limits,
                  "NAME=VALUE: exit with 1 if the measure exceeds the value (repeatable)")
      ->allow_extra_args(false);
  command.callback(
      [options, &global, &action] { action = [options, &global] { return compare_files(*options, global); }; });
}

}  // namespace twopass
