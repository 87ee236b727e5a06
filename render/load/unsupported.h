// What a Mitsuba file asks for and we lack: the error that names it, and the list of what is left out where the
// user wants to see the rest (--ignore-unsupported).
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/core/error.h"
#include "render/load/load.h"
#include "render/load/mitsuba_document.h"

namespace twopass {

/// A kind of object, or a property of that kind.
struct Feature {
  std::string tag, type;  ///< of the object: "shape", "sdfgrid"; the type may be empty
  std::string property;   ///< empty: the object as a whole

  auto operator<=>(const Feature&) const = default;
  /// "shape 'sdfgrid'", or "property 'x' of shape 'cube'".
  [[nodiscard]] std::string name() const;
};

/// The Error for a feature that we lack: `where: what; what to do`.
class Unsupported : public Error {
 public:
  Unsupported(Feature feature, std::string_view where, std::string_view what, std::string_view remedy)
      : Error(where, what, remedy), feature_(std::move(feature)) {}
  [[nodiscard]] const Feature& feature() const { return feature_; }

 private:
  Feature feature_;
};

/// Features that are left out while a file is read.
class LeftOut {
 public:
  /// Leaves out the feature from now on. Throws the error itself when it already was, to no avail.
  void add(const Unsupported& error);
  [[nodiscard]] bool empty() const { return entries_.empty(); }
  /// Whether the object is of a kind that is left out.
  [[nodiscard]] bool has_object(const XmlNode& object) const;
  [[nodiscard]] bool has_property(const XmlNode& object, const XmlNode& property) const;
  /// Counts an occurrence.
  void count(const XmlNode& object, const XmlNode* property = nullptr);
  /// Counts anew: the file is read again.
  void restart();
  /// For each feature: "3 shapes 'sdfgrid', the first at scene.xml:7", and why.
  [[nodiscard]] std::vector<Skipped> list() const;

 private:
  struct Count {
    int occurrences = 0;
    std::string first;  // file:line
  };
  std::map<Feature, Count> entries_;
};

/// Throws the error for an object of a type that we lack: "shape 'sdfgrid' is not supported; supported shapes:
/// ...; convert it to a mesh ...".
[[noreturn]] void unsupported_plugin(const XmlNode& object, std::span<const std::string_view> supported);

/// What to use instead of an object that we lack, as a clause; empty where we have no advice.
std::string_view advice_on(std::string_view tag, std::string_view type);

}  // namespace twopass
