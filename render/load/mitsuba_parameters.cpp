#include "render/load/mitsuba_parameters.h"

#include "render/core/error.h"
#include "render/load/text_file.h"

namespace twopass {
namespace {

constexpr std::size_t longest_value = 1'000'000;

}  // namespace

void Parameters::set_default(const std::string& name, const std::string& value) {
  seen_.insert(name);
  values_.emplace(name, value);
}

std::string Parameters::replace(const std::string& text, const XmlNode& node) {
  std::string result;
  std::size_t done = 0;
  while (true) {
    const std::size_t dollar = text.find('$', done);
    result.append(text, done, dollar - done);
    if (dollar == std::string::npos) return result;
    const Found found = parameter_at(std::string_view(text).substr(dollar + 1), node);
    seen_.insert(found.name);
    result += found.value;
    // Parameters in the values of parameters: each may double what it is made of.
    if (result.size() > longest_value)
      throw Error(node.where(), "a value has more than a million characters after its parameters are put in",
                  "use fewer parameters");
    done = dollar + 1 + found.name.size();
  }
}

void Parameters::check_all_used() const {
  for (const auto& [name, value] : given_)
    if (!seen_.contains(name))
      throw Error("-D " + name, "the scene has no such parameter", "its parameters: " + list_some(seen_));
}

Parameters::Found Parameters::parameter_at(std::string_view text, const XmlNode& node) const {
  Found best;
  for (const auto& [name, value] : values_)
    if (text.starts_with(name) && name.size() > best.name.size()) best = {name, value};
  if (!best.name.empty()) return best;

  constexpr std::string_view letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";
  const std::string unknown(text.substr(0, text.find_first_not_of(letters)));
  std::set<std::string> known;
  for (const auto& [name, value] : values_) known.insert(name);
  throw Error(
      node.where(), "parameter " + in_quotes("$" + unknown) + " has no value",
      "give -D " + unknown + "=VALUE or put a <default> before it (known here: " + list_some(known) + ")");
}

}  // namespace twopass
