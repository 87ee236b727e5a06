#include "render/load/mitsuba_references.h"

#include <unordered_map>

#include "render/core/error.h"

namespace twopass {
namespace {

constexpr int deepest = 100;
constexpr double most_objects = 1e4;

class ReferenceChecker {
 public:
  explicit ReferenceChecker(const MitsubaTree& tree) : tree_(tree) {}

  /// Objects in `node`, itself included, with references written out.
  double count(const XmlNode& node, int depth) {
    const auto [entry, is_new] = counts_.try_emplace(&node, unfinished);
    if (!is_new) {
      if (entry->second == unfinished)
        throw Error(node.where(), "this <" + node.tag + "> refers to itself", "break the circle");
      return entry->second;
    }
    if (depth > deepest)
      throw Error(node.where(), "objects are nested more than 100 deep by references", "flatten them");
    double sum = 1.0;
    for (const XmlNode& child : node.children) {
      if (child.tag == "ref")
        sum += count(resolve(tree_, child), depth + 1);
      else if (is_object(child))
        sum += count(child, depth + 1);
    }
    // Groups of shapes are read once each, however large.
    if (sum > most_objects && node.tag != "shape" && node.tag != "scene")
      throw Error(node.where(), "this <" + node.tag + "> holds more than 10000 objects by its references",
                  "refer to fewer");
    return counts_[&node] = sum;
  }

 private:
  static constexpr double unfinished = -1.0;
  const MitsubaTree& tree_;
  std::unordered_map<const XmlNode*, double> counts_;
};

}  // namespace

void check_references(const MitsubaTree& tree) {
  ReferenceChecker checker(tree);
  for (const XmlNode& node : tree.root.children)
    if (is_object(node)) checker.count(node, 1);
}

}  // namespace twopass
