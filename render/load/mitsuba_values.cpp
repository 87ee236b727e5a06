#include "render/load/mitsuba_values.h"

#include <algorithm>

#include "render/core/error.h"
#include "render/load/number.h"
#include "render/load/spectrum.h"
#include "render/load/text_file.h"

namespace twopass {
namespace {

constexpr std::string_view separators = " ,\t\r\n";

[[noreturn]] void not_a_number(const XmlNode& node, std::string_view text) {
  throw Error(node.where(), "<" + node.tag + ">: " + in_quotes(text) + " is not a finite number",
              "write e.g. 0.5");
}

/// "#rrggbb" as three numbers in [0, 1].
std::vector<double> parse_hexadecimal(const XmlNode& node, std::string_view text) {
  const auto digit = [&](char c) {
    const std::size_t value = std::string_view("0123456789abcdef").find(lower_case({&c, 1}));
    if (value == std::string_view::npos)
      throw Error(node.where(), in_quotes(text) + " is not a colour", "write #rrggbb or three numbers");
    return static_cast<double>(value);
  };
  if (text.size() != 7)
    throw Error(node.where(), in_quotes(text) + " is not a colour", "write #rrggbb or three numbers");
  std::vector<double> rgb;
  for (std::size_t i = 1; i < 7; i += 2) rgb.push_back((16.0 * digit(text[i]) + digit(text[i + 1])) / 255.0);
  return rgb;
}

C3d parse_rgb(const XmlNode& node) {
  check_attributes(node, {"name", "value"});
  const std::string& text = node.get("value");
  const std::vector<double> numbers =
      text.starts_with('#') ? parse_hexadecimal(node, text) : parse_numbers_attribute(node, "value");
  if (numbers.size() == 1) return C3d(numbers[0]);
  if (numbers.size() != 3)
    throw Error(node.where(), "<" + node.tag + "> has " + std::to_string(numbers.size()) + " numbers",
                "give one or three");
  return {numbers[0], numbers[1], numbers[2]};
}

/// The display's encoding undone (IEC 61966-2-1).
double linear_of_srgb(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

/// "wavelength:value, ..." in ascending order.
SampledSpectrum parse_samples(const XmlNode& node, const std::vector<std::string_view>& tokens) {
  SampledSpectrum spectrum;
  for (const std::string_view token : tokens) {
    const std::size_t colon = token.find(':');
    if (colon == std::string_view::npos)
      throw Error(node.where(), "<spectrum>: " + in_quotes(token) + " has no wavelength",
                  "write one number, or wavelength:value pairs in nanometres such as 400:0.1, 700:0.5");
    const auto wavelength = parse_number(token.substr(0, colon)), value = parse_number(token.substr(colon + 1));
    if (!wavelength || !value) not_a_number(node, token);
    if (!spectrum.wavelengths.empty() && *wavelength <= spectrum.wavelengths.back())
      throw Error(node.where(), "<spectrum>: wavelengths do not ascend at " + in_quotes(token), "sort them");
    spectrum.wavelengths.push_back(*wavelength);
    spectrum.values.push_back(*value);
  }
  return spectrum;
}

C3d parse_spectrum(const XmlNode& node, ColorUse use) {
  check_attributes(node, {"name", "value", "filename", "intent"});
  if (node.find("filename"))
    throw Error(node.where(), "spectra in files are not supported", "write wavelength:value pairs into value");
  const std::vector<std::string_view> tokens = split(node.get("value"), separators);
  if (tokens.size() == 1 && tokens[0].find(':') == std::string_view::npos) {
    const auto value = parse_number(tokens[0]);
    if (!value) not_a_number(node, tokens[0]);
    return use == ColorUse::emission ? emission_of_uniform_spectrum(*value) : C3d(*value);
  }
  const SampledSpectrum spectrum = parse_samples(node, tokens);
  if (spectrum.values.size() < 2)
    throw Error(node.where(), "<spectrum> has fewer than two wavelengths", "give at least two");
  C3d color = use == ColorUse::emission ? emission_of_spectrum(spectrum) : reflectance_of_spectrum(spectrum);
  // Saturated spectra lie outside Rec.709; Mitsuba clamps them, too.
  for (int i = 0; i < 3; ++i) {
    color[i] = std::max(color[i], 0.0);
    if (use == ColorUse::reflectance) color[i] = std::min(color[i], 1.0);
  }
  return color;
}

}  // namespace

void check_attributes(const XmlNode& node, std::initializer_list<std::string_view> known) {
  for (const auto& [name, value] : node.attributes)
    if (std::ranges::find(known, name) == known.end())
      throw Error(node.where(), "<" + node.tag + "> does not know the attribute " + in_quotes(name),
                  "its attributes: " + join_names({known.begin(), known.size()}));
}

double parse_number_attribute(const XmlNode& node, std::string_view attribute) {
  const std::vector<std::string_view> tokens = split(node.get(attribute), " \t\r\n");
  const auto value = tokens.size() == 1 ? parse_number(tokens[0]) : std::nullopt;
  if (!value) not_a_number(node, node.get(attribute));
  return *value;
}

std::vector<double> parse_numbers_attribute(const XmlNode& node, std::string_view attribute) {
  std::vector<double> numbers;
  for (const std::string_view token : split(node.get(attribute), separators)) {
    const auto value = parse_number(token);
    if (!value) not_a_number(node, token);
    numbers.push_back(*value);
  }
  return numbers;
}

V3d parse_vector(const XmlNode& node) {
  check_attributes(node, {"name", "value", "x", "y", "z"});
  if (!node.find("value"))
    return {parse_number_attribute(node, "x"), parse_number_attribute(node, "y"),
            parse_number_attribute(node, "z")};
  const std::vector<double> numbers = parse_numbers_attribute(node, "value");
  if (numbers.size() == 1) return V3d(numbers[0]);
  if (numbers.size() != 3 || node.find("x") || node.find("y") || node.find("z"))
    throw Error(node.where(), "<" + node.tag + "> needs one or three numbers",
                "write value=\"x, y, z\" or x= y= z=");
  return {numbers[0], numbers[1], numbers[2]};
}

bool parse_boolean(const XmlNode& node) {
  check_attributes(node, {"name", "value"});
  const std::string value = lower_case(node.get("value"));
  if (value == "true") return true;
  if (value == "false") return false;
  throw Error(node.where(), "<boolean>: " + in_quotes(node.get("value")) + " is neither",
              "write true or false");
}

long long parse_integer_value(const XmlNode& node) {
  check_attributes(node, {"name", "value"});
  const std::vector<std::string_view> tokens = split(node.get("value"), " \t\r\n");
  const auto value = tokens.size() == 1 ? parse_integer(tokens[0]) : std::nullopt;
  if (!value)
    throw Error(node.where(), "<integer>: " + in_quotes(node.get("value")) + " is not a whole number",
                "write e.g. 16");
  return *value;
}

C3f in_range(const C3d& color, const XmlNode& node, ColorUse use, Notes& notes) {
  C3f result;
  bool is_reduced = false;
  for (int i = 0; i < 3; ++i) {
    if (!(color[i] >= 0.0 && color[i] <= 1e30))
      throw Error(node.where(),
                  use == ColorUse::reflectance ? "a negative or huge reflectance" : "a negative or huge colour",
                  "correct it");
    // Surfaces cannot reflect more than they receive.
    is_reduced = is_reduced || (use == ColorUse::reflectance && color[i] > 1.0);
    result[i] = static_cast<float>(use == ColorUse::reflectance ? std::min(color[i], 1.0) : color[i]);
  }
  if (is_reduced) {
    const std::string* name = node.find("name");
    notes.add(node.file->string() + ": " + (name ? in_quotes(*name) : "a reflectance") +
              " above 1 reduced to 1");
  }
  return result;
}

C3f parse_color(const XmlNode& node, ColorUse use, Notes& notes) {
  C3d color(0.0);
  if (node.tag == "rgb") {
    color = parse_rgb(node);
  } else if (node.tag == "srgb") {
    color = parse_rgb(node);
    for (int i = 0; i < 3; ++i) color[i] = linear_of_srgb(color[i]);
  } else if (node.tag == "spectrum") {
    color = parse_spectrum(node, use);
  } else if (node.tag == "float" || node.tag == "integer") {
    check_attributes(node, {"name", "value"});
    color = C3d(parse_number_attribute(node, "value"));
  } else {
    throw Error(node.where(), "<" + node.tag + "> is not a colour", "use <rgb>, <spectrum> or <float>");
  }
  return in_range(color, node, use, notes);
}

}  // namespace twopass
