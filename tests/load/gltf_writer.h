// Writes tiny glTF files for tests: JSON to be changed at will, and bytes behind it.
#pragma once

#include <cstring>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace twopass {

class GltfWriter {
 public:
  using json = nlohmann::json;

  json document{{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", json::array()}}}}};
  std::string bytes;

  /// Adds an element to a top-level array; returns its index.
  std::size_t add(const char* array, json element) {
    document[array].push_back(std::move(element));
    return document[array].size() - 1;
  }
  /// Adds a buffer view of these values.
  template <class T>
  std::size_t add_view(const std::vector<T>& values, std::size_t stride = 0) {
    bytes.resize((bytes.size() + 3) / 4 * 4);
    json view{{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", values.size() * sizeof(T)}};
    if (stride > 0) view["byteStride"] = stride;
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    return add("bufferViews", std::move(view));
  }
  /// Adds an accessor of tightly packed values.
  template <class T>
  std::size_t add_accessor(const char* type, int components, const std::vector<T>& values) {
    return add("accessors", {{"bufferView", add_view(values)},
                             {"componentType", component_type(T{})},
                             {"count", values.size() / static_cast<std::size_t>(components)},
                             {"type", type}});
  }
  std::size_t add_vec3(const std::vector<float>& values) { return add_accessor("VEC3", 3, values); }
  std::size_t add_vec2(const std::vector<float>& values) { return add_accessor("VEC2", 2, values); }
  /// Adds a mesh of one primitive, and returns its index.
  std::size_t add_mesh(json primitive, const char* name = "mesh") {
    return add("meshes", {{"name", name}, {"primitives", json::array({std::move(primitive)})}});
  }
  /// Adds a node to the scene.
  std::size_t add_root(json node) {
    const std::size_t index = add("nodes", std::move(node));
    document["scenes"][0]["nodes"].push_back(index);
    return index;
  }
  /// A triangle in the plane z = 0, counter-clockwise, hanging in the scene; returns the index of its mesh.
  std::size_t add_triangle() {
    const std::size_t mesh =
        add_mesh({{"attributes", {{"POSITION", add_vec3({0, 0, 0, 1, 0, 0, 0, 1, 0})}}}}, "triangle");
    add_root({{"mesh", mesh}});
    return mesh;
  }
  json& primitive(std::size_t mesh = 0) { return document["meshes"][mesh]["primitives"][0]; }

  /// The .gltf with its bytes in a data URI.
  [[nodiscard]] std::string gltf() const {
    json result = document;
    if (!bytes.empty() && !result.contains("buffers"))
      result["buffers"] = {
          {{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}}};
    return result.dump();
  }
  /// The .glb.
  [[nodiscard]] std::string glb() const {
    json with_buffer = document;
    if (!bytes.empty() && !with_buffer.contains("buffers"))
      with_buffer["buffers"] = {{{"byteLength", bytes.size()}}};
    std::string text = with_buffer.dump(), binary = bytes;
    text.resize((text.size() + 3) / 4 * 4, ' ');
    binary.resize((binary.size() + 3) / 4 * 4, '\0');
    std::string result = "glTF" + number(2) + number(28 + text.size() + binary.size());
    result += number(text.size()) + "JSON" + text;
    result += number(binary.size()) + std::string("BIN\0", 4) + binary;
    return result;
  }

  static std::string number(std::size_t value) {
    std::string result;
    for (int i = 0; i < 4; ++i) result += static_cast<char>(value >> (8 * i) & 0xff);
    return result;
  }
  static std::string base64(const std::string& data) {
    constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string result;
    for (std::size_t i = 0; i < data.size(); i += 3) {
      unsigned bits = 0;
      for (std::size_t k = 0; k < 3; ++k)
        bits = bits << 8 | (i + k < data.size() ? static_cast<unsigned char>(data[i + k]) : 0u);
      for (std::size_t k = 0; k < 4; ++k)
        result += i + k > data.size() ? '=' : digits[bits >> (18 - 6 * k) & 63];
    }
    return result;
  }

 private:
  static int component_type(std::int8_t) { return 5120; }
  static int component_type(std::uint8_t) { return 5121; }
  static int component_type(std::int16_t) { return 5122; }
  static int component_type(std::uint16_t) { return 5123; }
  static int component_type(std::uint32_t) { return 5125; }
  static int component_type(float) { return 5126; }
};

}  // namespace twopass
