// Mitsuba XML before anything is interpreted: includes spliced in, $parameters replaced, names of old versions
// brought up to date, ids collected.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "render/load/load.h"
#include "render/load/mitsuba_document.h"
#include "render/load/notes.h"
#include "render/load/unsupported.h"

namespace twopass {

struct MitsubaTree {
  XmlNode root;                                   ///< <scene>; its children are objects and properties only
  double version = 3.0;                           ///< of the main file, major.minor
  std::vector<std::filesystem::path> folders;     ///< the main file's and those of <path>
  std::map<std::string, const XmlNode*> objects;  ///< by id or alias; they point into root
  /// What was put right in values while objects were read; for one thread at a time.
  std::unique_ptr<Notes> repairs = std::make_unique<Notes>();
  /// What is read of the scene is to lie about this point: it is taken off all that stands in the world.
  V3d origin{0.0, 0.0, 0.0};

  MitsubaTree() = default;
  MitsubaTree(MitsubaTree&&) = default;  // moving keeps the addresses of root's descendants; copying would not
  MitsubaTree& operator=(MitsubaTree&&) = default;
};

/// Reads a file and what it includes. Throws Error with file:line for a missing or unsupported version, unknown
/// or unused parameters, includes that do not exist, contain themselves or are nested more than 15 deep, and
/// ids given twice.
///
/// What `left_out` holds is counted there and left out of the tree, with all references to it; bsdfs and
/// textures are replaced by grey ones, because something needs them.
MitsubaTree read_mitsuba(const std::filesystem::path& path, const Definitions& definitions,
                         LeftOut* left_out = nullptr);

/// The object that a <ref> means. Throws Error listing known ids when there is none.
const XmlNode& resolve(const MitsubaTree& tree, const XmlNode& reference);

/// The file that an attribute or property of `node` names: relative to the file it stands in, to the main file
/// or to a <path>, exactly first, then as find_any_case does. Throws Error listing the places searched, or
/// saying what is there instead of a regular file.
std::filesystem::path find_file(const MitsubaTree& tree, const XmlNode& node, const std::string& name);

/// Whether the element is an object (it has a plugin type) rather than a plain property.
bool is_object(const XmlNode& node);

/// The name that a property of a version below 2 has today: camelCase to snake_case, intIOR to int_ior.
std::string snake_case(std::string_view name);

}  // namespace twopass
