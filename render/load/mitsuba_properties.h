// The properties of one Mitsuba plugin, read by name; whatever nobody asked for is an error, because it is a
// typo or a feature that we lack.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/core/names.h"
#include "render/core/types.h"
#include "render/load/mitsuba_expand.h"
#include "render/load/mitsuba_values.h"
#include "render/load/unsupported.h"

namespace twopass {

/// Getters throw Error with file:line for properties of the wrong type or with malformed values.
class Properties {
 public:
  /// Throws when a property is given twice or the object has no type. REQUIRES: both arguments outlive this.
  Properties(const XmlNode& object, const MitsubaTree& tree);

  [[nodiscard]] const std::string& type() const { return object_.get("type"); }
  /// "file:line" of the object.
  [[nodiscard]] std::string where() const { return object_.where(); }
  /// "file:line" of a property, or of the object when it is not given.
  [[nodiscard]] std::string where(std::string_view name) const;
  [[nodiscard]] const XmlNode& object() const { return object_; }
  /// The object's id, or else `otherwise`.
  [[nodiscard]] std::string id_or(std::string otherwise) const;

  [[nodiscard]] bool has(std::string_view name) const;
  std::optional<double> number(std::string_view name);
  std::optional<int> integer(std::string_view name);
  std::optional<std::string> text(std::string_view name);
  bool boolean(std::string_view name, bool otherwise);
  V3d point(std::string_view name, const V3d& otherwise);
  M44d transform(std::string_view name);  ///< identity when not given
  /// Of an object that stands in the scene, not in a group: its to_world leads to coordinates about the tree's
  /// origin from now on.
  void stand_in_world() { stands_in_world_ = true; }
  std::optional<C3f> color(std::string_view name, ColorUse use);
  /// The element behind a property of one of several types (tags); nullptr when not given.
  const XmlNode* element(std::string_view name, std::initializer_list<std::string_view> tags);
  /// Accepts properties that cannot change our pictures.
  void ignore(std::initializer_list<std::string_view> names);
  /// Accepts every property and object that was not read.
  void ignore_rest();

  /// Nested or referenced objects of a kind ("bsdf"), in order.
  std::vector<const XmlNode*> objects(std::string_view tag);
  /// The only nested or referenced object of a kind, or nullptr. Throws when there are several.
  const XmlNode* object_of(std::string_view tag);

  /// Throws for the first property or object that was not read, listing those that were asked for.
  void finish() const;

 private:
  struct Entry {
    const XmlNode* node;    // as written: its line is the one to complain about
    const XmlNode* target;  // the referenced object, or node itself
    std::string name;
    bool read;
  };
  Entry* find(std::string_view name);
  /// "it takes: bsdf", for errors.
  [[nodiscard]] std::string it_takes() const;

  const XmlNode& object_;
  const MitsubaTree& tree_;
  std::vector<Entry> entries_;
  bool stands_in_world_ = false;
  std::vector<std::string> asked_, asked_tags_;
};

/// The entry of `table` for the object's type. Throws unsupported_plugin.
template <class T>
const T& plugin_of_type(std::span<const Named<T>> table, const XmlNode& object) {
  std::vector<std::string_view> names;
  for (const Named<T>& entry : table) {
    if (entry.name == object.get("type")) return entry.value;
    names.push_back(entry.name);
  }
  unsupported_plugin(object, names);
}

}  // namespace twopass
