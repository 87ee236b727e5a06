// Numbers of glTF's materials and extensions, checked.
#pragma once

#include <string>

#include "render/core/types.h"
#include "render/load/gltf_document.h"
#include "render/load/notes.h"

namespace twopass {

/// Reads the members of one object of a file: a material or one of its extensions.
class GltfValues {
 public:
  /// `owner`: "material 'x'", for errors. REQUIRES: the arguments outlive this.
  GltfValues(const GltfDocument& document, const std::string& owner, Notes& notes)
      : document_(document), owner_(owner), notes_(notes) {}

  /// The members of an extension, or null.
  static const tinygltf::Value* extension(const tinygltf::ExtensionMap& extensions, const std::string& name) {
    const auto found = extensions.find(name);
    return found == extensions.end() ? nullptr : &found->second;
  }

  /// A number of an extension, within [low, high]: values beyond are moved there, with a note.
  [[nodiscard]] float number(const tinygltf::Value& extension, const char* member, double otherwise,
                             double high = 1.0) const {
    const tinygltf::Value& value = extension.Get(member);
    return limited(value.IsNumber() ? value.GetNumberAsDouble() : otherwise, high, member);
  }
  /// Three numbers of an extension, as above.
  [[nodiscard]] C3f color(const tinygltf::Value& extension, const char* member, const C3f& otherwise,
                          double high) const;
  /// The first three of an array of the file, as above.
  [[nodiscard]] C3f color(const std::vector<double>& numbers, const char* member, double high = 1.0) const;
  /// `value` within [0, high], else with a note.
  [[nodiscard]] float limited(double value, double high, const char* member) const;

  [[noreturn]] void fail(const std::string& what, std::string_view remedy) const;
  void note(const std::string& what) const { notes_.add(document_.file + ": " + owner_ + ": " + what); }

 private:
  const GltfDocument& document_;
  const std::string& owner_;
  Notes& notes_;
};

}  // namespace twopass
