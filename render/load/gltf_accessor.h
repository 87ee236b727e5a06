// A glTF accessor as an array of numbers: strides, integers, sparse replacements; every byte checked
// beforehand.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/load/gltf_document.h"

namespace twopass {

/// Reads elements where they lie; nothing is copied. Elements are numbers or vectors of 2 to 4 of them.
class GltfAccessor {
 public:
  /// `user` says who refers to it, for errors. Throws Error when the accessor is not there or reaches beyond
  /// its bytes, has matrices, or is empty; also for more than 65536 elements, and more than the file has bytes,
  /// that no buffer holds. REQUIRES: the document outlives this.
  GltfAccessor(const GltfDocument& document, int index, const std::string& user);

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] int components() const { return components_; }
  /// Component c of element i; normalised integers in [0, 1] or [-1, 1]; floats as they are, NaN and infinity
  /// among them. REQUIRES: i < count(), c < components().
  [[nodiscard]] float number(std::size_t i, int c) const;
  /// Element i of an accessor of unsigned integers. REQUIRES: is_index().
  [[nodiscard]] std::uint32_t index(std::size_t i) const;
  /// Single unsigned integers of 8, 16 or 32 bits.
  [[nodiscard]] bool is_index() const;
  /// "accessor 3 (POSITION of mesh 'x')"
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  // An array of elements in a buffer.
  struct Strided {
    const char* first = nullptr;  // null: zeros
    std::size_t stride = 0;
  };
  [[nodiscard]] Strided strided(const GltfDocument& document, int view, std::size_t offset, std::size_t count,
                                std::size_t element_size, bool may_be_spaced) const;
  void read_sparse(const GltfDocument& document, const tinygltf::Accessor& accessor);
  [[nodiscard]] const char* element(std::size_t i) const;
  [[noreturn]] void fail(const GltfDocument& document, const std::string& what) const;

  std::string name_;
  int component_type_ = 0, components_ = 0;
  bool normalized_ = false;
  std::size_t count_ = 0;
  Strided dense_;
  std::vector<std::uint32_t> replaced_;  // sorted; element replaced_[k] is element k of replacements_
  Strided replacements_;
};

}  // namespace twopass
