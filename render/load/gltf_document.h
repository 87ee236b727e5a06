// A glTF file with all its bytes in memory: tinygltf's structures, and what they refer to.
//
// tinygltf 2.7 fills the structures from JSON that has been checked before: it drops members of the wrong type
// in silence, cuts whole numbers down to 32 bits, recurses as deep as the file wants and reads past the end of
// a wrong BIN chunk. Therefore the container, nesting, types and whole numbers are checked here (with
// nlohmann's JSON, which it uses, too), and buffers and images never reach it.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <tiny_gltf.h>

#include "render/load/notes.h"

namespace twopass {

/// Bytes that somebody shares: a part of the file, of another file, or of a data URI.
struct SharedBytes {
  std::shared_ptr<const std::string> owner;
  std::string_view view;
};

/// An image: bytes of an encoded picture, or a file that holds it.
struct GltfImage {
  std::string name;  ///< "image 3 'wood'", for errors
  SharedBytes bytes;
  std::filesystem::path path;  ///< empty where there are bytes
};

struct GltfDocument {
  std::string file;       ///< for errors
  tinygltf::Model model;  ///< without buffers and images; no index is checked yet
  std::vector<SharedBytes> buffers;
  std::vector<GltfImage> images;
  std::size_t size = 0;  ///< bytes of all that was read: what memory may be measured by
};

/// Reads the file and the buffers that it names; images are only located. Throws Error when it cannot be read,
/// is not glTF 2.0, or needs an extension that is not supported. Extensions that it merely uses are noted.
GltfDocument read_gltf(const std::filesystem::path& path, Notes& notes);

/// The same for the bytes of a file, whatever `path` holds.
GltfDocument parse_gltf(std::string bytes, const std::filesystem::path& path, Notes& notes);

/// The bytes of a buffer view. `user` says who wants it, for errors. Throws Error when it is not there or
/// exceeds its buffer.
SharedBytes bytes_of_view(const GltfDocument& document, int view, const std::string& user);

/// The element `index` of an array of the file. Throws Error "user refers to kind index, but ..." when there is
/// none.
template <class T>
const T& element_of(const std::vector<T>& array, int index, std::string_view kind, const std::string& user,
                    const GltfDocument& document);

[[noreturn]] void fail_element(std::size_t size, int index, std::string_view kind, const std::string& user,
                               const GltfDocument& document);

template <class T>
const T& element_of(const std::vector<T>& array, int index, std::string_view kind, const std::string& user,
                    const GltfDocument& document) {
  if (index < 0 || static_cast<std::size_t>(index) >= array.size())
    fail_element(array.size(), index, kind, user, document);
  return array[static_cast<std::size_t>(index)];
}

}  // namespace twopass
