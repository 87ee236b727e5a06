#include "render/load/gltf_values.h"

#include <cstdio>

#include "render/core/error.h"

namespace twopass {

float GltfValues::limited(double value, double high, const char* member) const {
  if (value >= 0.0 && value <= high) return static_cast<float>(value);
  const double nearest = value > high ? high : 0.0;
  char text[128];
  std::snprintf(text, sizeof text, "%s %g is rendered as %g", member, value, nearest);
  note(text);
  return static_cast<float>(nearest);
}

C3f GltfValues::color(const std::vector<double>& numbers, const char* member, double high) const {
  if (numbers.size() < 3)
    fail(std::string("has a ") + member + " of fewer than three numbers", "correct the file");
  return {limited(numbers[0], high, member), limited(numbers[1], high, member),
          limited(numbers[2], high, member)};
}

C3f GltfValues::color(const tinygltf::Value& extension, const char* member, const C3f& otherwise,
                      double high) const {
  const tinygltf::Value& value = extension.Get(member);
  if (!value.IsArray()) return otherwise;
  std::vector<double> numbers;
  for (std::size_t i = 0; i < value.ArrayLen(); ++i)
    numbers.push_back(value.Get(static_cast<int>(i)).GetNumberAsDouble());
  return color(numbers, member, high);
}

void GltfValues::fail(const std::string& what, std::string_view remedy) const {
  throw Error(document_.file, owner_ + " " + what, remedy);
}

}  // namespace twopass
