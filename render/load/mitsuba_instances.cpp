#include "render/load/mitsuba_instances.h"

#include "render/core/error.h"
#include "render/load/mitsuba_properties.h"

namespace twopass {

std::vector<const XmlNode*> shapes_of_group(const XmlNode& group, const MitsubaTree& tree) {
  Properties p(group, tree);
  const std::vector<const XmlNode*> shapes = p.objects("shape");
  p.finish();
  if (shapes.empty()) throw Error(p.where(), "a shapegroup without shapes", "put the shapes into it");
  for (const XmlNode* shape : shapes) {
    const std::string& type = shape->get("type");
    if (type == "shapegroup" || type == "instance")
      throw Error(shape->where(), "a shape '" + type + "' in a shapegroup: instances are not nested",
                  "put its shapes into the group");
    Properties of_shape(*shape, tree);
    if (const std::vector<const XmlNode*> emitters = of_shape.objects("emitter"); !emitters.empty())
      throw Error(emitters.front()->where(), "an emitter in a shapegroup",
                  "shapes that emit cannot be instanced: put it outside, once for each place");
  }
  return shapes;
}

MitsubaInstance read_mitsuba_instance(const XmlNode& instance, const MitsubaTree& tree) {
  Properties p(instance, tree);
  p.stand_in_world();
  const std::vector<const XmlNode*> groups = p.objects("shape");
  if (groups.size() != 1 || groups.front()->get("type") != "shapegroup")
    throw Error(p.where(), "an instance refers to one shapegroup",
                "add <ref id=\"...\"/> with the id of a group");
  // Groups are read where the scene lists them.
  if (std::ranges::none_of(tree.root.children, [&](const XmlNode& node) { return &node == groups.front(); }))
    throw Error(groups.front()->where(), "a shapegroup inside of another object",
                "put it into the scene, with an id, and refer to it");
  const M44d to_world = p.transform("to_world");
  const std::string where = p.where("to_world");
  p.finish();
  return {groups.front(), to_world, where};
}

}  // namespace twopass
