#include "render/load/gltf_json.h"

#include <algorithm>
#include <cmath>

#include "render/core/error.h"
#include "render/load/text_file.h"

namespace twopass {
namespace {

using nlohmann::json;

/// What a member may be; several bits: any of them.
enum Kind : unsigned {
  whole = 1,
  number = 2,
  text = 4,
  flag = 8,
  object = 16,
  numbers = 32,
  wholes = 64,
  objects = 128,
};

struct Member {
  std::string_view name;
  unsigned kinds;
};

// Members of the specification's objects by their names alone, which mean one thing wherever they stand; those
// whose names do not are decided in kinds_of.
constexpr Member members[] = {
    {"accessors", objects},
    {"alphaCutoff", number},
    {"alphaMode", text},
    {"aspectRatio", number},
    {"asset", object},
    {"attributes", object},
    {"baseColorFactor", numbers},
    {"buffer", whole},
    {"bufferView", whole},
    {"bufferViews", objects},
    {"buffers", objects},
    {"byteLength", whole},
    {"byteOffset", whole},
    {"byteStride", whole},
    {"camera", whole},
    {"cameras", objects},
    {"children", wholes},
    {"clearcoatFactor", number},
    {"clearcoatRoughnessFactor", number},
    {"color", numbers},
    {"componentType", whole},
    {"count", whole},
    {"doubleSided", flag},
    {"emissiveFactor", numbers},
    {"emissiveStrength", number},
    {"extensions", object},
    {"images", objects},
    {"index", whole},
    {"indices", whole | object},
    {"innerConeAngle", number},
    {"intensity", number},
    {"ior", number},
    {"light", whole},
    {"lights", objects},
    {"magFilter", whole},
    {"material", whole},
    {"materials", objects},
    {"matrix", numbers},
    {"mesh", whole},
    {"meshes", objects},
    {"metallicFactor", number},
    {"mimeType", text},
    {"minFilter", whole},
    {"mode", whole},
    {"name", text},
    {"nodes", wholes},
    {"normalized", flag},
    {"offset", numbers},
    {"orthographic", object},
    {"outerConeAngle", number},
    {"pbrMetallicRoughness", object},
    {"perspective", object},
    {"primitives", objects},
    {"range", number},
    {"rotation", number | numbers},
    {"roughnessFactor", number},
    {"sampler", whole},
    {"samplers", objects},
    {"scale", number | numbers},
    {"scene", whole},
    {"scenes", objects},
    {"skin", whole},
    {"source", whole},
    {"sparse", object},
    {"specularColorFactor", numbers},
    {"specularFactor", number},
    {"spot", object},
    {"strength", number},
    {"texCoord", whole},
    {"textures", objects},
    {"translation", numbers},
    {"transmissionFactor", number},
    {"type", text},
    {"uri", text},
    {"values", object},
    {"version", text},
    {"weights", numbers},
    {"wrapS", whole},
    {"wrapT", whole},
    {"xmag", number},
    {"yfov", number},
    {"ymag", number},
    {"zfar", number},
    {"znear", number},
};
static_assert(std::ranges::is_sorted(members, {}, &Member::name));

// What the loader looks at; animations, skins and whatever else stands beside are dropped.
constexpr std::string_view top_level[] = {
    "accessors",          "asset",          "bufferViews", "buffers",   "cameras", "extensions",
    "extensionsRequired", "extensionsUsed", "images",      "materials", "meshes",  "nodes",
    "samplers",           "scene",          "scenes",      "textures",
};

/// 0: unknown, anything goes.
unsigned kinds_of(std::string_view name, std::string_view parent) {
  if (parent == "attributes") return whole;
  if (parent == "extensions") return object;
  if (parent.empty() && name == "nodes") return objects;
  if (name.ends_with("Texture")) return object;
  const auto* found = std::ranges::lower_bound(members, name, {}, &Member::name);
  return found != std::end(members) && found->name == name ? found->kinds : 0;
}

std::string describe(unsigned kinds) {
  constexpr std::pair<Kind, std::string_view> descriptions[] = {
      {whole, "a whole number"},
      {number, "a number"},
      {text, "a text"},
      {flag, "true or false"},
      {object, "an object"},
      {numbers, "an array of numbers"},
      {wholes, "an array of whole numbers"},
      {objects, "an array of objects"},
  };
  std::string result;
  for (const auto& [kind, description] : descriptions)
    if (kinds & kind) result.append(result.empty() ? "" : " or ").append(description);
  return result;
}

/// Whether brackets outside of strings are nested deeper. (The parser's own callback would tell, but looks at
/// all elements of an array whenever one of them ends.)
bool is_deeper_than(int most, std::string_view text) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > most) return true;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return false;
}

class Checker {
 public:
  explicit Checker(std::string_view file) : file_(file) {}

  /// Checks and cleans an object; `parent` is the name of the member that holds it, "" for the document.
  void check_object(json& value, std::string_view parent, const std::string& path) {
    value.erase("extras");
    if (parent == "extensions")
      for (auto it = value.begin(); it != value.end();)
        it = is_supported_gltf_extension(it.key()) ? std::next(it) : value.erase(it);
    for (auto it = value.begin(); it != value.end(); ++it) {
      const std::string& name = it.key();
      const std::string member = path.empty() ? name : path + "." + name;
      if (const unsigned kinds = kinds_of(name, parent)) check_kind(it.value(), kinds, name, member);
      check_inside(it.value(), name, member);
    }
  }

 private:
  [[noreturn]] void fail(const std::string& path, const std::string& what, std::string_view remedy) const {
    throw Error(file_, "'" + path + "' " + what, remedy);
  }

  void check_inside(json& value, std::string_view name, const std::string& path) {
    if (value.is_object()) check_object(value, name, path);
    if (!value.is_array()) return;
    std::size_t index = 0;
    for (json& item : value) {
      // Arrays of plain numbers are most of a large file.
      if (item.is_structured()) check_inside(item, name, path + "[" + std::to_string(index) + "]");
      ++index;
    }
    // tinygltf cuts down to 32 bits what is written without a point.
    for (json& item : value) make_real(item);
  }

  static void make_real(json& value) {
    constexpr double limit = 0x1p31;
    if (value.is_number_integer() && !(std::abs(value.get<double>()) < limit)) value = value.get<double>();
  }

  void check_kind(json& value, unsigned kinds, std::string_view name, const std::string& path) {
    const auto all = [&](auto&& is_right) { return value.is_array() && std::ranges::all_of(value, is_right); };
    const bool right = (kinds & whole && value.is_number()) || (kinds & number && value.is_number()) ||
                       (kinds & text && value.is_string()) || (kinds & flag && value.is_boolean()) ||
                       (kinds & object && value.is_object()) ||
                       (kinds & (numbers | wholes) && all([](const json& item) { return item.is_number(); })) ||
                       (kinds & objects && all([](const json& item) { return item.is_object(); }));
    if (!right) fail(path, "is not " + describe(kinds), "correct the file");
    if (value.is_string() && value.get_ref<const std::string&>().find('\0') != std::string::npos)
      fail(path, "has a character 0", "correct the file");  // messages would end there
    if (kinds & whole && value.is_number()) make_whole(value, name, path);
    if (kinds & number) make_real(value);
    if (kinds & wholes)
      for (json& item : value) make_whole(item, name, path);
  }

  void make_whole(json& value, std::string_view name, const std::string& path) {
    const bool counts_bytes = name == "byteLength" || name == "byteOffset";
    const double limit = counts_bytes ? 0x1p53 : 0x1p31, v = value.get<double>();
    if (!(v >= 0.0 && v < limit) || v != std::floor(v))
      fail(path, "is " + value.dump() + ", not a whole number from 0 to " + (counts_bytes ? "2^53" : "2^31"),
           "correct the file");
    value = static_cast<std::uint64_t>(v);
  }

  std::string_view file_;
};

}  // namespace

bool is_supported_gltf_extension(std::string_view name) {
  return std::ranges::find(gltf_extensions, name) != std::end(gltf_extensions);
}

json parse_gltf_json(std::string_view text, std::string_view file) {
  if (is_deeper_than(64, text))
    throw Error(file, "its JSON is nested deeper than 64 levels", "no glTF needs that: correct the file");
  json document;
  try {
    document = json::parse(text);
  } catch (const json::exception& error) {
    // "[json.exception.parse_error.101] parse error at line 1, column 2: ..."
    const std::string_view message = error.what();
    throw Error(file,
                "not JSON: " + std::string(message.substr(std::min(message.find(']') + 2, message.size()))),
                "give a glTF 2.0 file, .gltf or .glb");
  }
  if (!document.is_object()) throw Error(file, "not a JSON object", "give a glTF 2.0 file, .gltf or .glb");
  for (auto it = document.begin(); it != document.end();)
    it = std::ranges::find(top_level, it.key()) != std::end(top_level) ? std::next(it) : document.erase(it);
  Checker(file).check_object(document, "", "");
  for (const json& mesh : document.value("meshes", json::array()))
    for (const json& primitive : mesh.value("primitives", json::array()))
      if (!primitive.contains("attributes"))
        throw Error(file, "mesh '" + mesh.value("name", "") + "' has a primitive without attributes",
                    "correct the file");
  return document;
}

}  // namespace twopass
