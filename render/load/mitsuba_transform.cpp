#include "render/load/mitsuba_transform.h"

#include <algorithm>

#include "render/core/error.h"
#include "render/load/mitsuba_values.h"
#include "render/load/text_file.h"
#include "render/scene/camera.h"

namespace twopass {
namespace {

/// value="x, y, z", value="s", or any of x= y= z= with `missing` for the others.
V3d parse_components(const XmlNode& step, double missing) {
  if (step.find("value")) {
    const std::vector<double> numbers = parse_numbers_attribute(step, "value");
    if (numbers.size() == 1) return V3d(numbers[0]);
    if (numbers.size() != 3)
      throw Error(step.where(), "<" + step.tag + "> needs one or three numbers", "write value=\"x, y, z\"");
    return {numbers[0], numbers[1], numbers[2]};
  }
  const auto component = [&](std::string_view name) {
    return step.find(name) ? parse_number_attribute(step, name) : missing;
  };
  return {component("x"), component("y"), component("z")};
}

V3d parse_triple(const XmlNode& step, std::string_view attribute) {
  const std::vector<double> numbers = parse_numbers_attribute(step, attribute);
  if (numbers.size() != 3)
    throw Error(step.where(), "<" + step.tag + ">: '" + std::string(attribute) + "' needs three numbers",
                "write \"x, y, z\"");
  return {numbers[0], numbers[1], numbers[2]};
}

M44d parse_rotation(const XmlNode& step) {
  check_attributes(step, {"value", "x", "y", "z", "angle"});
  const V3d axis = parse_components(step, 0.0);
  if (!(axis.length() > 0.0)) throw Error(step.where(), "<rotate> has no axis", "give x, y or z");
  M44d matrix;
  matrix.setAxisAngle(axis, parse_number_attribute(step, "angle") * pi / 180.0);
  return matrix;
}

M44d parse_look_at(const XmlNode& step) {
  check_attributes(step, {"origin", "target", "up"});
  const V3d origin = parse_triple(step, "origin"), target = parse_triple(step, "target");
  V3d up(0.0);
  if (step.find("up")) {
    up = parse_triple(step, "up");
  } else {
    // Any direction across the view will do: the axis that the view follows least.
    const V3d view = target - origin;
    const double x = std::abs(view.x), y = std::abs(view.y), z = std::abs(view.z);
    (y <= x && y <= z ? up.y : x <= z ? up.x : up.z) = 1.0;
  }
  return look_at(origin, target, up, step.where());
}

/// 16 or 9 numbers, row by row, for column vectors as usual on paper.
M44d parse_matrix(const XmlNode& step) {
  check_attributes(step, {"value"});
  const std::vector<double> numbers = parse_numbers_attribute(step, "value");
  const int n = numbers.size() == 16 ? 4 : 3;
  if (numbers.size() != 16 && numbers.size() != 9)
    throw Error(step.where(), "<matrix> has " + std::to_string(numbers.size()) + " numbers", "give 16 or 9");
  M44d matrix;
  for (int row = 0; row < n; ++row)
    for (int column = 0; column < n; ++column)
      matrix[column][row] = numbers[static_cast<std::size_t>(row * n + column)];
  if (matrix[0][3] != 0.0 || matrix[1][3] != 0.0 || matrix[2][3] != 0.0 || matrix[3][3] != 1.0)
    throw Error(step.where(), "<matrix> is not affine", "its last row must be 0 0 0 1");
  return matrix;
}

M44d parse_step(const XmlNode& step) {
  M44d matrix;
  const std::string tag = lower_case(step.tag);  // old files write lookAt
  if (tag == "translate") {
    check_attributes(step, {"value", "x", "y", "z"});
    return matrix.setTranslation(parse_components(step, 0.0));
  }
  if (tag == "scale") {
    check_attributes(step, {"value", "x", "y", "z"});
    return matrix.setScale(parse_components(step, 1.0));
  }
  if (tag == "rotate") return parse_rotation(step);
  if (tag == "lookat") return parse_look_at(step);
  if (tag == "matrix") return parse_matrix(step);
  throw Error(step.where(), "unknown transform step <" + step.tag + ">",
              "steps: translate, scale, rotate, lookat, matrix");
}

}  // namespace

M44d parse_transform(const XmlNode& node) {
  check_attributes(node, {"name"});
  M44d product;
  for (const XmlNode& step : node.children) product = product * parse_step(step);
  for (int i = 0; i < 16; ++i)
    if (!std::isfinite(product.getValue()[i]))
      throw Error(node.where(), "the transform is not finite", "use smaller numbers");
  return product;
}

}  // namespace twopass
