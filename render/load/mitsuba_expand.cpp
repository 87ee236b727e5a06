#include "render/load/mitsuba_expand.h"

#include <algorithm>
#include <array>
#include <set>

#include "render/core/error.h"
#include "render/image/regular_file.h"
#include "render/load/mitsuba_parameters.h"
#include "render/load/number.h"
#include "render/load/text_file.h"

namespace twopass {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t deepest_include = 15;
constexpr int most_includes = 1000;  // a handful of files that include each other many times would never end

constexpr std::array<std::string_view, 15> object_tags = {
    "bsdf",  "emitter", "film",  "integrator", "medium",  "phase",  "rfilter",   "sampler",
    "scene", "sensor",  "shape", "spectrum",   "texture", "volume", "subsurface"};
constexpr std::array<std::string_view, 13> property_tags = {
    "boolean", "float",  "integer", "point",     "ref",       "rgb",      "spectrum",
    "srgb",    "string", "vector",  "transform", "animation", "blackbody"};

double parse_version(const XmlNode& root) {
  const std::string* text = root.find("version");
  if (!text)
    throw Error(root.where(), "<scene> has no version",
                "add the attribute version=\"3.0.0\", or the file's own");
  const std::vector<std::string_view> parts = split(*text, ".");
  double version = -1.0;
  if (!parts.empty() && parts.size() <= 3) {
    const auto major = parse_integer(parts[0]);
    const auto minor = parts.size() > 1 ? parse_integer(parts[1]) : 0;
    if (major && minor && *major >= 0 && *minor >= 0 && *minor < 100)
      version = static_cast<double>(*major) + 0.01 * static_cast<double>(*minor);
  }
  if (version < 0.035 || version >= 4.0)
    throw Error(root.where(), "version '" + *text + "' is not supported", "supported: 0.4.0 to 3.x");
  return version;
}

std::string known_ids(const MitsubaTree& tree) {
  std::vector<std::string> known;
  for (const auto& [name, object] : tree.objects) known.push_back(name);
  return known.empty() ? "none" : list_some(known);
}

/// Carries the tree out of the files, one element after the other: parameters must be defined before their use.
class Expander {
 public:
  Expander(const Definitions& definitions, MitsubaTree& tree, LeftOut* left_out)
      : parameters_(definitions), tree_(tree), left_out_(left_out) {}

  void run(const fs::path& path) {
    tree_.folders.push_back(path.parent_path());
    tree_.root = open(path, nullptr);
    std::vector<XmlNode> children = std::move(tree_.root.children);
    tree_.version = parse_version(tree_.root);
    splice(std::move(children), tree_.version, tree_.root.children);
    parameters_.check_all_used();
    if (!dropped_ids_.empty()) drop_references(tree_.root);
    for (const XmlNode& child : tree_.root.children) collect_ids(child);
    for (const XmlNode& alias : aliases_) {
      if (dropped_ids_.contains(alias.get("id"))) continue;
      const auto target = tree_.objects.find(alias.get("id"));
      if (target == tree_.objects.end())
        throw Error(alias.where(), "there is no object '" + alias.get("id") + "'",
                    "known ids: " + known_ids(tree_));
      add_id(alias.get("as"), *target->second, alias);
    }
  }

 private:
  XmlNode open(const fs::path& path, const XmlNode* include) {
    std::error_code code;
    const fs::path real = fs::weakly_canonical(path, code);
    if (std::ranges::find(open_files_, real) != open_files_.end())
      throw Error(include->where(), path.string() + " includes itself", "break the circle");
    if (open_files_.size() > deepest_include)
      throw Error(include->where(), "includes are nested more than 15 deep", "flatten the files");
    if (++files_ > most_includes)
      throw Error(include->where(), "more than 1000 files are included", "flatten the files");
    open_files_.push_back(real);
    XmlNode root = read_xml(path);
    if (root.tag != "scene")
      throw Error(root.where(), "the root element is <" + root.tag + ">", "it must be <scene>");
    return root;
  }

  void splice(std::vector<XmlNode> from, double version, std::vector<XmlNode>& to) {
    for (XmlNode& node : from) {
      if (node.tag == "include")
        include(node, version, to);
      else if (!directive(node))
        add(expand(std::move(node), version), to);
    }
  }

  /// Adds an object or property, or what stands for it where it is left out.
  void add(XmlNode node, std::vector<XmlNode>& to) {
    if (left_out_ && left_out_->has_object(node)) {
      left_out_->count(node);
      if (node.tag == "bsdf" || node.tag == "texture") {
        for (auto& [name, value] : node.attributes)
          if (name == "type") value = node.tag == "bsdf" ? "diffuse" : "checkerboard";
        node.children.clear();
        if (node.tag == "texture")
          for (const char* color : {"color0", "color1"})
            node.children.push_back({"rgb", {{"name", color}, {"value", "0.5"}}, {}, node.file, node.line});
      } else {
        if (const std::string* id = node.find("id")) dropped_ids_.insert(*id);
        return;
      }
    }
    if (left_out_)
      std::erase_if(node.children, [&](const XmlNode& child) {
        if (!left_out_->has_property(node, child)) return false;
        left_out_->count(node, &child);
        return true;
      });
    to.push_back(std::move(node));
  }

  void drop_references(XmlNode& node) {
    std::erase_if(node.children, [&](const XmlNode& child) {
      const std::string* id = child.find("id");
      return child.tag == "ref" && id && dropped_ids_.contains(*id);
    });
    for (XmlNode& child : node.children) drop_references(child);
  }

  void include(XmlNode& node, double version, std::vector<XmlNode>& to) {
    replace_attributes(node);
    XmlNode root = open(find_file(tree_, node, node.get("filename")), &node);
    // An included file without a version has the version of the file around it.
    if (root.find("version")) version = parse_version(root);
    splice(std::move(root.children), version, to);
    open_files_.pop_back();
  }

  /// <default>, <path> and <alias> leave no node behind.
  bool directive(XmlNode& node) {
    if (node.tag == "default") {
      const std::string value = parameters_.replace(node.get("value"), node);
      parameters_.set_default(node.get("name"), value);
      return true;
    }
    if (node.tag == "path") {
      replace_attributes(node);
      const fs::path folder = node.file->parent_path() / node.get("value");
      std::error_code ignored;
      if (!fs::is_directory(folder, ignored))
        throw Error(node.where(), "there is no folder " + folder.string(), "correct the <path>");
      tree_.folders.push_back(folder);
      return true;
    }
    if (node.tag == "alias") {
      replace_attributes(node);
      aliases_.push_back(std::move(node));
      return true;
    }
    return false;
  }

  XmlNode expand(XmlNode node, double version) {
    replace_attributes(node);
    if (version < 2.0) upgrade(node);
    const bool known = std::ranges::find(object_tags, node.tag) != object_tags.end() ||
                       std::ranges::find(property_tags, node.tag) != property_tags.end();
    if (!known)
      throw Error(node.where(), "unknown element <" + node.tag + ">",
                  "objects: " + join_names(object_tags) + "; properties: " + join_names(property_tags));
    if (node.tag == "transform" || node.tag == "animation") {
      // Its steps are no objects; mitsuba_transform.h reads them.
      for (XmlNode& step : node.children) replace_attributes(step);
      return node;
    }
    std::vector<XmlNode> children = std::move(node.children);
    node.children.clear();
    splice(std::move(children), version, node.children);
    if (version < 2.0 && node.tag == "bsdf" && *find_or_empty(node, "type") == "diffuse")
      for (XmlNode& child : node.children) rename(child, "diffuse_reflectance", "reflectance");
    return node;
  }

  void replace_attributes(XmlNode& node) {
    for (auto& [name, value] : node.attributes) value = parameters_.replace(value, node);
  }

  static const std::string* find_or_empty(const XmlNode& node, std::string_view attribute) {
    static const std::string empty;
    const std::string* value = node.find(attribute);
    return value ? value : &empty;
  }
  static void upgrade(XmlNode& node) {
    for (auto& [name, value] : node.attributes)
      if (name == "name") value = snake_case(value);
  }
  static void rename(XmlNode& node, std::string_view from, std::string_view to) {
    for (auto& [name, value] : node.attributes)
      if (name == "name" && value == from) value = to;
  }

  void add_id(const std::string& id, const XmlNode& object, const XmlNode& place) {
    const auto [entry, is_new] = tree_.objects.emplace(id, &object);
    if (!is_new)
      throw Error(place.where(), "id '" + id + "' is used twice, first at " + entry->second->where(),
                  "give one another id");
  }
  void collect_ids(const XmlNode& node) {
    if (is_object(node))
      if (const std::string* id = node.find("id")) add_id(*id, node, node);
    for (const XmlNode& child : node.children) collect_ids(child);
  }

  Parameters parameters_;
  MitsubaTree& tree_;
  std::vector<fs::path> open_files_;
  int files_ = 0;
  std::vector<XmlNode> aliases_;
  LeftOut* left_out_;
  std::set<std::string> dropped_ids_;
};

}  // namespace

MitsubaTree read_mitsuba(const fs::path& path, const Definitions& definitions, LeftOut* left_out) {
  MitsubaTree tree;
  Expander(definitions, tree, left_out).run(path);
  return tree;
}

const XmlNode& resolve(const MitsubaTree& tree, const XmlNode& reference) {
  const std::string& id = reference.get("id");
  if (const auto found = tree.objects.find(id); found != tree.objects.end()) return *found->second;
  throw Error(reference.where(), "there is no object with the id '" + id + "'",
              "known ids: " + known_ids(tree));
}

fs::path find_file(const MitsubaTree& tree, const XmlNode& node, const std::string& name) {
  std::vector<fs::path> folders{node.file->parent_path()};
  folders.insert(folders.end(), tree.folders.begin(), tree.folders.end());
  std::vector<std::string> searched;
  for (const fs::path& folder : folders) {
    const fs::path candidate = folder / name;  // an absolute name stays itself
    std::error_code ignored;
    if (fs::exists(candidate, ignored)) {
      check_regular_file(candidate, node.where());
      return candidate;
    }
    if (std::ranges::find(searched, candidate.string()) == searched.end())
      searched.push_back(candidate.string());
  }
  // Written on a system that takes "Wood.PNG" for "wood.png", or "meshes\\a.obj" for "meshes/a.obj".
  for (const std::string& candidate : searched)
    if (const std::optional<fs::path> found = find_any_case(candidate)) {
      check_regular_file(*found, node.where());
      return *found;
    }
  throw Error(node.where(), "there is no file '" + name + "'", "searched: " + list_some(searched));
}

bool is_object(const XmlNode& node) {
  if (node.tag == "spectrum") return node.find("type") != nullptr;
  return std::ranges::find(object_tags, node.tag) != object_tags.end();
}

std::string snake_case(std::string_view name) {
  const auto is_upper = [](char c) { return c >= 'A' && c <= 'Z'; };
  std::string result;
  for (std::size_t i = 0; i < name.size(); ++i) {
    // A word begins where a capital follows a small letter; a run of capitals ("IOR") is one word.
    if (i > 0 && is_upper(name[i]) && !is_upper(name[i - 1]) && name[i - 1] != '_') result += '_';
    result += lower_case(name.substr(i, 1));
  }
  return result;
}

}  // namespace twopass
