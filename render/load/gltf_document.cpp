#include "render/load/gltf_document.h"

#include <algorithm>
#include <set>

#include "render/core/error.h"
#include "render/image/regular_file.h"
#include "render/load/gltf_container.h"
#include "render/load/gltf_json.h"
#include "render/load/gltf_uri.h"

namespace twopass {
namespace {

using nlohmann::json;

void check_version(const json& document, const std::string& file) {
  const std::string version = document.value("asset", json::object()).value("version", "");
  if (!version.starts_with("2."))
    throw Error(file, version.empty() ? "has no asset.version" : "is of glTF version '" + version + "'",
                "only glTF 2.0 is supported: convert it");
}

std::vector<std::string> texts(const json& document, const char* name) {
  std::vector<std::string> result;
  for (const json& item : document.value(name, json::array()))
    if (item.is_string())
      result.emplace_back(item.get_ref<const std::string&>().c_str());  // up to a character 0
  return result;
}

void check_extensions(const json& document, const std::string& file, Notes& notes) {
  for (const std::string& name : texts(document, "extensionsRequired"))
    if (!is_supported_gltf_extension(name))
      throw Error(file, "requires the extension '" + name + "', which is not supported",
                  "export without it; supported: " + join_names(gltf_extensions));
  std::string unknown;
  constexpr std::size_t longest = 1000;
  for (const std::string& name : texts(document, "extensionsUsed"))
    if (!is_supported_gltf_extension(name) && unknown.size() + name.size() < longest)
      unknown += (unknown.empty() ? "" : ", ") + name;
  if (!unknown.empty()) notes.add(file + ": extensions that are not supported are left out: " + unknown);
}

/// The member as an array; takes it out of the document.
json take(json& document, const char* name) {
  json result = document.value(name, json::array());
  document.erase(name);
  return result;
}

class Reader {
 public:
  Reader(const std::filesystem::path& path, GltfDocument& document)
      : folder_(path.parent_path()), document_(document) {}

  void read_buffers(const json& buffers, const std::optional<SharedBytes>& binary) {
    for (const json& buffer : buffers) {
      const std::string where = document_.file + ": buffer " + std::to_string(document_.buffers.size());
      if (!buffer.contains("byteLength")) throw Error(where, "has no byteLength", "correct the file");
      const auto length = buffer["byteLength"].get<std::size_t>();
      SharedBytes bytes;
      if (buffer.contains("uri"))
        bytes = bytes_of_uri(buffer["uri"].get<std::string>(), where);
      else if (binary && document_.buffers.empty())
        bytes = *binary;
      else
        throw Error(where, "has no uri, and there is no binary chunk for it", "correct the file");
      if (length > bytes.view.size())
        throw Error(where,
                    "has " + std::to_string(bytes.view.size()) + " bytes instead of " + std::to_string(length),
                    "export or download the scene again");
      bytes.view = bytes.view.substr(0, length);
      document_.buffers.push_back(std::move(bytes));
    }
  }

  void locate_images(const json& images) {
    for (const json& image : images) {
      GltfImage result;
      result.name = "image " + std::to_string(document_.images.size());
      if (const std::string name = image.value("name", ""); !name.empty()) result.name += " '" + name + "'";
      const std::string where = document_.file + ": " + result.name;
      if (image.contains("uri")) {
        const auto uri = image["uri"].get<std::string>();
        if (std::optional<std::string> data = bytes_of_data_uri(uri, where))
          result.bytes = shared(std::move(*data));
        else
          result.path = path_of_uri(uri, folder_, where);
      } else if (image.contains("bufferView")) {
        const int view = image["bufferView"].get<int>();
        result.bytes = bytes_of_view(document_, view, result.name);
      } else {
        throw Error(where, "has neither uri nor bufferView", "correct the file");
      }
      document_.images.push_back(std::move(result));
    }
  }

 private:
  static SharedBytes shared(std::string bytes) {
    auto owner = std::make_shared<const std::string>(std::move(bytes));
    return {owner, *owner};
  }

  SharedBytes bytes_of_uri(const std::string& uri, const std::string& where) {
    if (std::optional<std::string> data = bytes_of_data_uri(uri, where)) return shared(std::move(*data));
    const std::filesystem::path path = path_of_uri(uri, folder_, where);
    // A file that many buffers name is read once.
    const auto known = files_.find(path);
    if (known != files_.end()) return known->second;
    std::string bytes = read_regular_file(find_any_case(path).value_or(path), where);
    document_.size += bytes.size();
    return files_[path] = shared(std::move(bytes));
  }

  std::filesystem::path folder_;
  GltfDocument& document_;
  std::map<std::filesystem::path, SharedBytes> files_;
};

/// tinygltf's structures of a document that has neither buffers nor images.
tinygltf::Model model_of(const json& document, const std::string& file) {
  tinygltf::Model model;
  tinygltf::TinyGLTF parser;
  std::string error, warning;
  const std::string text = document.dump();
  const bool good = parser.LoadASCIIFromString(&model, &error, &warning, text.c_str(),
                                               static_cast<unsigned>(text.size()), "", tinygltf::NO_REQUIRE);
  std::ranges::replace(error, '\n', ' ');
  while (error.ends_with(' ') || error.ends_with('.')) error.pop_back();
  if (!good || !error.empty())
    throw Error(file, "not valid glTF: " + (error.empty() ? "cannot be parsed" : error), "correct the file");
  return model;
}

}  // namespace

void fail_element(std::size_t size, int index, std::string_view kind, const std::string& user,
                  const GltfDocument& document) {
  throw Error(document.file,
              user + " refers to " + std::string(kind) + " " + std::to_string(index) + ", but there are only " +
                  std::to_string(size),
              "correct the file");
}

SharedBytes bytes_of_view(const GltfDocument& document, int index, const std::string& user) {
  const tinygltf::BufferView& view =
      element_of(document.model.bufferViews, index, "buffer view", user, document);
  const std::string name = "buffer view " + std::to_string(index);
  const SharedBytes& buffer = element_of(document.buffers, view.buffer, "buffer", name, document);
  if (view.byteOffset > buffer.view.size() || view.byteLength > buffer.view.size() - view.byteOffset)
    throw Error(document.file,
                name + " ends at byte " + std::to_string(view.byteOffset + view.byteLength) + " of buffer " +
                    std::to_string(view.buffer) + ", which has " + std::to_string(buffer.view.size()),
                "correct the file");
  return {buffer.owner, buffer.view.substr(view.byteOffset, view.byteLength)};
}

GltfDocument parse_gltf(std::string bytes, const std::filesystem::path& path, Notes& notes) {
  GltfDocument result;
  result.file = path.string();
  result.size = bytes.size();
  const auto owner = std::make_shared<const std::string>(std::move(bytes));
  const GltfChunks chunks = split_gltf(*owner, result.file);
  json document = parse_gltf_json(chunks.json, result.file);
  check_version(document, result.file);
  check_extensions(document, result.file, notes);
  const json buffers = take(document, "buffers"), images = take(document, "images");
  result.model = model_of(document, result.file);
  Reader reader(path, result);
  std::optional<SharedBytes> binary;
  if (chunks.binary) binary = SharedBytes{owner, *chunks.binary};
  reader.read_buffers(buffers, binary);
  reader.locate_images(images);
  return result;
}

GltfDocument read_gltf(const std::filesystem::path& path, Notes& notes) {
  return parse_gltf(read_regular_file(path), path, notes);
}

}  // namespace twopass
