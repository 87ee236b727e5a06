#include "render/load/mitsuba_properties.h"

#include <algorithm>
#include <limits>

#include "render/core/error.h"
#include "render/load/mitsuba_transform.h"

namespace twopass {
namespace {

std::string join(const std::vector<std::string>& names) {
  return join_names(std::vector<std::string_view>(names.begin(), names.end()));
}

/// <spectrum type="..."> inside another object: those that are one colour in RGB.
C3f color_of_spectrum_object(const XmlNode& object, const MitsubaTree& tree, ColorUse use) {
  Properties properties(object, tree);
  const std::string& type = properties.type();
  C3f color(1.0f);
  // A plain colour, no object: objects could refer to each other in a circle.
  const auto plain_color = [&] {
    const XmlNode* node = properties.element("color", {"rgb", "srgb", "float"});
    return node ? parse_color(*node, use, *tree.repairs) : C3f(1.0f);
  };
  if (type == "d65") {
    // D65 is the white of the working space, so its shape is (1, 1, 1).
    color = plain_color() * static_cast<float>(properties.number("scale").value_or(1.0));
  } else if (type == "uniform") {
    color = C3f(static_cast<float>(properties.number("value").value_or(1.0)));
    properties.ignore({"wavelength_min", "wavelength_max"});
  } else if (type == "srgb") {
    color = plain_color();
    properties.ignore({"unbounded"});
  } else {
    constexpr std::string_view supported[] = {"d65", "srgb", "uniform"};
    unsupported_plugin(object, supported);
  }
  properties.finish();
  return in_range(C3d(color), object, use, *tree.repairs);
}

}  // namespace

Properties::Properties(const XmlNode& object, const MitsubaTree& tree) : object_(object), tree_(tree) {
  check_attributes(object, {"type", "id", "name", "version"});
  if (!object.find("type"))
    throw Error(object.where(), "<" + object.tag + "> has no attribute 'type'", "add it");
  for (const XmlNode& child : object.children) {
    Entry entry{&child, &child, "", false};
    if (const std::string* name = child.find("name")) entry.name = *name;
    if (child.tag == "ref") {
      check_attributes(child, {"id", "name"});
      entry.target = &resolve(tree, child);
    }
    const bool is_property = child.tag != "ref" && !is_object(child);
    if (is_property) {
      if (entry.name.empty()) throw Error(child.where(), "<" + child.tag + "> has no name", "add name=\"...\"");
      if (find(entry.name))
        throw Error(child.where(), "property '" + entry.name + "' is given twice", "remove one");
    }
    entries_.push_back(std::move(entry));
  }
}

Properties::Entry* Properties::find(std::string_view name) {
  const auto found =
      std::ranges::find_if(entries_, [&](const Entry& e) { return !e.name.empty() && e.name == name; });
  return found == entries_.end() ? nullptr : &*found;
}

const XmlNode* Properties::element(std::string_view name, std::initializer_list<std::string_view> tags) {
  if (std::ranges::find(asked_, name) == asked_.end()) asked_.emplace_back(name);
  Entry* entry = find(name);
  if (!entry) return nullptr;
  entry->read = true;
  if (tags.size() > 0 && std::ranges::find(tags, entry->target->tag) == tags.end())
    throw Error(entry->node->where(),
                "property '" + std::string(name) + "' cannot be a <" + entry->target->tag + ">",
                "use: " + join_names({tags.begin(), tags.size()}));
  return entry->target;
}

std::string Properties::where(std::string_view name) const {
  for (const Entry& entry : entries_)
    if (entry.name == name) return entry.node->where();
  return where();
}

std::string Properties::id_or(std::string otherwise) const {
  if (const std::string* id = object_.find("id")) return *id;
  return otherwise;
}

bool Properties::has(std::string_view name) const {
  return !name.empty() && std::ranges::find(entries_, name, &Entry::name) != entries_.end();
}

std::optional<double> Properties::number(std::string_view name) {
  const XmlNode* node = element(name, {"float", "integer"});
  if (!node) return std::nullopt;
  check_attributes(*node, {"name", "value"});
  return parse_number_attribute(*node, "value");
}

std::optional<int> Properties::integer(std::string_view name) {
  const XmlNode* node = element(name, {"integer"});
  if (!node) return std::nullopt;
  const long long value = parse_integer_value(*node);
  if (value < std::numeric_limits<int>::min() || value > std::numeric_limits<int>::max())
    throw Error(node->where(), "'" + std::string(name) + "' is out of range", "use a smaller number");
  return static_cast<int>(value);
}

std::optional<std::string> Properties::text(std::string_view name) {
  const XmlNode* node = element(name, {"string"});
  if (!node) return std::nullopt;
  check_attributes(*node, {"name", "value"});
  return node->get("value");
}

bool Properties::boolean(std::string_view name, bool otherwise) {
  const XmlNode* node = element(name, {"boolean"});
  return node ? parse_boolean(*node) : otherwise;
}

V3d Properties::point(std::string_view name, const V3d& otherwise) {
  const XmlNode* node = element(name, {"point", "vector"});
  return node ? parse_vector(*node) : otherwise;
}

M44d Properties::transform(std::string_view name) {
  const XmlNode* node = element(name, {"transform"});
  M44d matrix = node ? parse_transform(*node) : M44d();
  if (stands_in_world_ && name == "to_world")
    for (int axis = 0; axis < 3; ++axis) matrix[3][axis] -= tree_.origin[axis];
  return matrix;
}

std::optional<C3f> Properties::color(std::string_view name, ColorUse use) {
  const XmlNode* node = element(name, {});
  if (!node) return std::nullopt;
  if (node->tag == "texture")
    throw Unsupported({object_.tag, type(), std::string(name)}, where(name),
                      "texture '" + node->get("type") + "' is not supported", "give a colour: <rgb>");
  if (node->tag == "spectrum" && is_object(*node)) return color_of_spectrum_object(*node, tree_, use);
  return parse_color(*node, use, *tree_.repairs);
}

void Properties::ignore(std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names)
    if (Entry* entry = find(name)) entry->read = true;
}

void Properties::ignore_rest() {
  for (Entry& entry : entries_) entry.read = true;
}

std::vector<const XmlNode*> Properties::objects(std::string_view tag) {
  asked_tags_.emplace_back(tag);
  std::vector<const XmlNode*> found;
  for (Entry& entry : entries_)
    if (is_object(*entry.target) && entry.target->tag == tag) {
      entry.read = true;
      found.push_back(entry.target);
    }
  return found;
}

const XmlNode* Properties::object_of(std::string_view tag) {
  const std::vector<const XmlNode*> found = objects(tag);
  if (found.size() > 1)
    throw Error(found[1]->where(),
                "a second <" + std::string(tag) + "> in " + object_.tag + " '" + type() + "'", "give one");
  return found.empty() ? nullptr : found[0];
}

void Properties::finish() const {
  const std::string self = object_.tag + " '" + type() + "'";
  for (const Entry& entry : entries_) {
    if (entry.read) continue;
    const XmlNode& target = *entry.target;
    const std::string where = entry.node->where();
    // Media have names, but what is wrong is not the name.
    const std::string* kind = target.find("type");
    const std::string_view advice = advice_on(target.tag, "");
    if (is_object(target) && !advice.empty())
      throw Unsupported(
          {target.tag, kind ? *kind : "", ""}, where,
          "a <" + target.tag + "> inside " + self + " is not supported",
          it_takes().append("; ").append(advice).append("; --ignore-unsupported renders what is left"));
    if (is_object(target) && entry.name.empty())
      throw Error(where, "a <" + target.tag + "> inside " + self + " is not supported", it_takes());
    throw Unsupported({object_.tag, type(), entry.name}, where, self + " has no property '" + entry.name + "'",
                      "its properties: " + (asked_.empty() ? "none" : join(asked_)));
  }
}

std::string Properties::it_takes() const {
  return "it takes: " + (asked_tags_.empty() ? "nothing" : join(asked_tags_));
}

}  // namespace twopass
