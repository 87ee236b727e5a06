#include "render/load/gltf_accessor.h"

#include <algorithm>
#include <cstring>

#include "render/core/error.h"

namespace twopass {
namespace {

std::size_t size_of_component(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      return 0;
  }
}

int components_of(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR:
      return 1;
    case TINYGLTF_TYPE_VEC2:
      return 2;
    case TINYGLTF_TYPE_VEC3:
      return 3;
    case TINYGLTF_TYPE_VEC4:
      return 4;
    default:
      return 0;
  }
}

/// Little-endian, as this machine is, and not aligned.
template <class T>
T read(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

/// An unsigned integer of one of the types that indices may have.
std::uint32_t read_index(const char* bytes, int type) {
  if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) return read<std::uint8_t>(bytes);
  if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) return read<std::uint16_t>(bytes);
  return read<std::uint32_t>(bytes);
}

bool is_index_type(int type) {
  return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
         type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

}  // namespace

void GltfAccessor::fail(const GltfDocument& document, const std::string& what) const {
  throw Error(document.file, name_ + " " + what, "correct the file");
}

GltfAccessor::GltfAccessor(const GltfDocument& document, int index, const std::string& user)
    : name_("accessor " + std::to_string(index) + " (" + user + ")") {
  const tinygltf::Accessor& accessor = element_of(document.model.accessors, index, "accessor", user, document);
  component_type_ = accessor.componentType;
  components_ = components_of(accessor.type);
  normalized_ = accessor.normalized;
  count_ = accessor.count;
  const std::size_t component_size = size_of_component(component_type_);
  if (components_ == 0) fail(document, "is made of matrices");
  if (component_size == 0) fail(document, "has components of type " + std::to_string(component_type_));
  if (count_ == 0) fail(document, "is empty");
  const std::size_t element_size = component_size * static_cast<std::size_t>(components_);
  if (accessor.bufferView >= 0)
    dense_ = strided(document, accessor.bufferView, accessor.byteOffset, count_, element_size, true);
  else if (count_ > std::max<std::size_t>(65536, document.size))
    fail(document, "has " + std::to_string(count_) + " elements, but no buffer view");
  if (accessor.sparse.isSparse) read_sparse(document, accessor);
}

GltfAccessor::Strided GltfAccessor::strided(const GltfDocument& document, int view, std::size_t offset,
                                            std::size_t count, std::size_t element_size,
                                            bool may_be_spaced) const {
  const std::string_view bytes = bytes_of_view(document, view, name_).view;
  const std::size_t given = document.model.bufferViews[static_cast<std::size_t>(view)].byteStride;
  const std::size_t stride = may_be_spaced && given > 0 ? given : element_size;
  if (stride < element_size)
    fail(document,
         "has elements of " + std::to_string(element_size) + " bytes at a stride of " + std::to_string(stride));
  // Without products that might overflow: count - 1 strides and one element after the offset.
  if (offset > bytes.size() || element_size > bytes.size() - offset ||
      (count - 1) > (bytes.size() - offset - element_size) / stride)
    fail(document, "needs more than the " + std::to_string(bytes.size()) + " bytes of buffer view " +
                       std::to_string(view));
  return {bytes.data() + offset, stride};
}

void GltfAccessor::read_sparse(const GltfDocument& document, const tinygltf::Accessor& accessor) {
  const auto& sparse = accessor.sparse;
  if (sparse.count < 1) fail(document, "replaces no element (sparse.count)");
  const auto count = static_cast<std::size_t>(sparse.count);
  if (count > count_) fail(document, "replaces more elements than it has (sparse.count)");
  if (!is_index_type(sparse.indices.componentType))
    fail(document, "has sparse indices of type " + std::to_string(sparse.indices.componentType));
  const Strided indices =
      strided(document, sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset), count,
              size_of_component(sparse.indices.componentType), false);
  replacements_ =
      strided(document, sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset), count,
              size_of_component(component_type_) * static_cast<std::size_t>(components_), false);
  replaced_.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    replaced_[k] = read_index(indices.first + k * indices.stride, sparse.indices.componentType);
    if (replaced_[k] >= count_) fail(document, "replaces an element that it does not have (sparse.indices)");
    if (k > 0 && replaced_[k] <= replaced_[k - 1]) fail(document, "has sparse indices that do not increase");
  }
}

const char* GltfAccessor::element(std::size_t i) const {
  if (!replaced_.empty()) {
    const auto found = std::ranges::lower_bound(replaced_, i);
    if (found != replaced_.end() && *found == i)
      return replacements_.first + static_cast<std::size_t>(found - replaced_.begin()) * replacements_.stride;
  }
  return dense_.first ? dense_.first + i * dense_.stride : nullptr;
}

float GltfAccessor::number(std::size_t i, int c) const {
  const char* bytes = element(i);
  if (!bytes) return 0.0f;
  bytes += size_of_component(component_type_) * static_cast<std::size_t>(c);
  const auto integer = [&](auto value, float largest) {
    // Section 3.11 of the specification: -128 means -1 as -127 does.
    return normalized_ ? std::max(static_cast<float>(value) / largest, -1.0f) : static_cast<float>(value);
  };
  switch (component_type_) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return integer(read<std::int8_t>(bytes), 127.0f);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return integer(read<std::uint8_t>(bytes), 255.0f);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return integer(read<std::int16_t>(bytes), 32767.0f);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return integer(read<std::uint16_t>(bytes), 65535.0f);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return integer(read<std::uint32_t>(bytes), 4294967295.0f);
    default:
      return read<float>(bytes);
  }
}

bool GltfAccessor::is_index() const { return components_ == 1 && is_index_type(component_type_); }

std::uint32_t GltfAccessor::index(std::size_t i) const {
  const char* bytes = element(i);
  return bytes ? read_index(bytes, component_type_) : 0;
}

}  // namespace twopass
