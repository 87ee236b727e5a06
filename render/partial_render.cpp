#include "render/partial_render.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "render/core/error.h"
#include "render/core/names.h"

namespace twopass {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* attribute = "twopass/partial";
constexpr int format = 2;

json json_of_plan(const PlanState& plan) {
  return {
      {"in_pass", plan.in_pass},     {"before", plan.before},
      {"after", plan.after},         {"error", std::isfinite(plan.error) ? json(plan.error) : json(nullptr)},
      {"step", plan.step},           {"pilot_samples", plan.pilot_samples},
      {"shares_of", plan.shares_of}, {"variances", plan.variances}};
}

PlanState plan_of_json(const json& j) {
  PlanState plan{.in_pass = j.at("in_pass"),
                 .before = j.at("before"),
                 .after = j.at("after"),
                 .step = j.at("step"),
                 .pilot_samples = j.at("pilot_samples"),
                 .variances = j.at("variances").get<std::vector<double>>(),
                 .shares_of = j.at("shares_of")};
  if (!j.at("error").is_null()) plan.error = j.at("error");
  return plan;
}

constexpr Named<PixelType> pixel_type_names[] = {{"half", PixelType::half}, {"float", PixelType::float_}};
constexpr Named<Reduction> reduction_names[] = {{"mean", Reduction::mean},
                                                {"total", Reduction::total},
                                                {"nearest", Reduction::nearest},
                                                {"samples", Reduction::samples},
                                                {"variance", Reduction::variance}};

template <class T>
std::string name(std::span<const Named<T>> names, T value) {
  return std::string(name_of_value<T>(names, value));
}
template <class T>
void read(std::span<const Named<T>> names, const json& j, T& value) {
  value = value_of_name<T>(names, j.get<std::string>(), attribute, "name");
}

json json_of_layout(const FilmLayout& layout) {
  json layers = json::array();
  for (const FilmLayer& layer : layout.layers)
    layers.push_back({layer.name, layer.channels, name<Reduction>(reduction_names, layer.reduction)});
  return {
      {"layers", layers}, {"cryptomattes", layout.cryptomattes}, {"signed_weights", layout.has_signed_weights}};
}

FilmLayout layout_of_json(const json& j) {
  FilmLayout layout;
  for (const json& layer : j.at("layers")) {
    layout.layers.push_back({layer.at(0), layer.at(1).get<std::vector<std::string>>(), Reduction::mean});
    read<Reduction>(reduction_names, layer.at(2), layout.layers.back().reduction);
  }
  layout.cryptomattes = j.at("cryptomattes").get<std::vector<std::string>>();
  layout.has_signed_weights = j.at("signed_weights");
  return layout;
}

// What of them does not stand in the header.
json json_of_options(const ExrOptions& options) {
  return {{"pixels", name<PixelType>(pixel_type_names, options.pixel_type)},
          {"compression", name<ExrCompression>(exr_compression_names, options.compression)},
          {"parts", name<ExrParts>(exr_parts_names, options.parts)},
          {"chromaticities", name<ExrChromaticities>(exr_chromaticities_names, options.chromaticities)},
          {"color_space", options.color_space},
          {"float_layers", options.float_layers},
          {"integer_layers", options.integer_layers}};
}

void options_of_json(const json& j, ExrOptions& options) {
  read<PixelType>(pixel_type_names, j.at("pixels"), options.pixel_type);
  read<ExrCompression>(exr_compression_names, j.at("compression"), options.compression);
  read<ExrParts>(exr_parts_names, j.at("parts"), options.parts);
  read<ExrChromaticities>(exr_chromaticities_names, j.at("chromaticities"), options.chromaticities);
  options.color_space = j.at("color_space");
  options.float_layers = j.at("float_layers").get<std::vector<std::string>>();
  options.integer_layers = j.at("integer_layers").get<std::vector<std::string>>();
}

std::string text_of(const PartialRender& part, const FilmLayout& layout, const ExrOptions& options) {
  json ranges = json::array(), settings = json::array();
  for (const SampleRange& range : part.ranges) ranges.push_back({range.begin, range.end});
  for (const auto& [name, value] : part.identity.settings) settings.push_back({name, value});
  const RenderCosts& costs = part.state.costs;
  const json j = {{"format", format},
                  {"version", part.identity.version},
                  {"scene", part.identity.scene},
                  {"solution", part.identity.solution},
                  {"settings", settings},
                  {"ranges", ranges},
                  {"all_samples", part.all_samples},
                  {"footprint_samples", part.footprint_samples},
                  {"layout", json_of_layout(layout)},
                  {"options", json_of_options(options)},
                  {"rays", costs.counts.rays},
                  {"shadow_rays", costs.counts.shadow_rays},
                  {"escaped_rays", costs.counts.escaped_rays},
                  {"non_finite_samples", costs.non_finite_samples},
                  {"plan", part.can_resume ? json_of_plan(part.state.plan) : json(nullptr)}};
  return j.dump(-1, ' ', false, json::error_handler_t::replace);
}

PartialRender part_of_json(const json& j) {
  if (j.at("format") != format) throw std::runtime_error("another format");
  PartialRender part;
  part.identity = {j.at("version"), j.at("scene"), j.at("solution"), {}};
  for (const json& setting : j.at("settings"))
    part.identity.settings.emplace_back(setting.at(0), setting.at(1));
  for (const json& range : j.at("ranges")) {
    part.ranges.push_back({range.at(0), range.at(1)});
    if (part.ranges.back().begin > part.ranges.back().end) throw std::runtime_error("a range that is none");
  }
  part.all_samples = j.at("all_samples");
  part.footprint_samples = j.at("footprint_samples");
  part.state.costs = {{j.at("rays"), j.at("shadow_rays"), j.at("escaped_rays")}, j.at("non_finite_samples")};
  part.can_resume = !j.at("plan").is_null();
  if (part.can_resume) part.state.plan = plan_of_json(j.at("plan"));
  return part;
}

}  // namespace

void check_same_render(const RenderIdentity& part, const std::string& where, const RenderIdentity& other,
                       const std::string& other_where) {
  const auto refuse = [&](const std::string& what, const std::string& remedy) {
    throw Error(where, what, remedy);
  };
  if (part.version != other.version)
    refuse("it was made by version " + part.version + ", " + other_where + " by " + other.version,
           "make all parts of a render with the same program");
  if (part.scene != other.scene)
    refuse("it is a picture of another scene than " + other_where, "give parts of one render only");
  for (std::size_t i = 0; i < std::max(part.settings.size(), other.settings.size()); ++i) {
    const bool differ = i >= part.settings.size() || i >= other.settings.size();
    if (differ || part.settings[i].first != other.settings[i].first)
      refuse("its settings are not those of " + other_where, "give parts of one render only");
    const auto& [name, value] = part.settings[i];
    if (value != other.settings[i].second)
      refuse("its " + name + " is " + value + ", that of " + other_where + " is " + other.settings[i].second,
             "render all parts with the same settings");
  }
  if (part.solution != other.solution)
    refuse("it was made from another radiosity solution than " + other_where,
           "solve once (twopass solve) and give the file to all parts (--solution)");
}

std::vector<SampleRange> joined_ranges(const std::vector<SampleRange>& a, const std::vector<SampleRange>& b,
                                       const std::string& where) {
  std::vector<SampleRange> all = a, joined;
  all.insert(all.end(), b.begin(), b.end());
  std::sort(all.begin(), all.end(), [](const SampleRange& x, const SampleRange& y) {
    return x.begin != y.begin ? x.begin < y.begin : x.end < y.end;
  });
  for (const SampleRange& range : all) {
    if (range.begin == range.end) continue;
    if (joined.empty() || range.begin > joined.back().end) {
      joined.push_back(range);
    } else if (range.begin == joined.back().end) {
      joined.back().end = range.end;
    } else {
      const std::uint32_t last = std::min(range.end, joined.back().end);
      throw Error(where,
                  "its samples " + ranges_text({{range.begin, last}}) + " are in another of the parts, too",
                  "give each part once, of slices that do not overlap");
    }
  }
  return joined;
}

std::string ranges_text(const std::vector<SampleRange>& ranges) {
  std::string text;
  for (const SampleRange& range : ranges)
    text +=
        (text.empty() ? "" : " and ") + std::to_string(range.begin) + " to " + std::to_string(range.end - 1);
  return text;
}

void save_partial(const fs::path& path, const Film& film, const PartialRender& part, const ExrOptions& options,
                  const fs::path& previous) {
  ExrOptions with_part = options;
  with_part.metadata.emplace_back(attribute, text_of(part, film.layout(), options));
  write_film(path, film, part.can_resume ? part.state.plan.levels : std::vector<std::uint8_t>(), with_part,
             previous);
}

PartialFile::PartialFile(const fs::path& path) : film_(path), options_(film_.options()) {
  const auto is_part = [](const auto& entry) { return entry.first == attribute; };
  const auto found = std::find_if(options_.metadata.begin(), options_.metadata.end(), is_part);
  try {
    if (found == options_.metadata.end()) throw std::runtime_error("no description");
    const json j = json::parse(std::get<std::string>(found->second));
    part_ = part_of_json(j);
    layout_ = layout_of_json(j.at("layout"));
    options_of_json(j.at("options"), options_);
    if (film_.has_marks() != !part_.state.plan.variances.empty() ||
        (film_.has_marks() && part_.state.plan.variances.size() != SampleShares::level_count()))
      throw std::runtime_error("a plan that is not whole");
  } catch (const std::exception& e) {
    throw Error(path.string(), std::string("its description cannot be read (") + e.what() + ")",
                "render this part again, with the same version of the program");
  }
  options_.metadata.erase(found);
}

void PartialFile::merge_into(Film& film, PlanState* plan) const {
  if (plan != nullptr) *plan = part_.state.plan;
  film_.merge_into(film, plan != nullptr ? &plan->levels : nullptr);
  if (plan == nullptr) return;
  for (const std::uint8_t level : plan->levels)
    if (level >= SampleShares::level_count())
      throw Error(film_.path().string(), "its plan is damaged", "render this part again");
}

}  // namespace twopass
