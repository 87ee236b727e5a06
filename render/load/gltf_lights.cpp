#include "render/load/gltf_lights.h"

#include "render/core/error.h"
#include "render/load/gltf_camera.h"

namespace twopass {
namespace {

class LightReader {
 public:
  LightReader(const GltfDocument& document, Notes& notes) : document_(document), notes_(notes) {}

  /// `place` says where, for a light called `name` in errors.
  PunctualLight read(const tinygltf::Light& light, const GltfPlace& place, const std::string& name) {
    const C3f strength = strength_of(light, name);
    const M44d& m = place.to_world;
    const V3d position(m[3][0], m[3][1], m[3][2]);
    // The range is a hint for programs that have to cull; light has none.
    if (light.range > 0.0) notes_.add(document_.file + ": lights shine beyond their range");
    if (light.type == "point") return PointLight{V3f(position), strength, nullptr, {}};
    const GltfAxes axes = axes_of(place, document_);
    if (light.type == "directional") return DirectionalLight{V3f(-axes.z), strength};
    if (light.type != "spot")
      fail(name, "is of type '" + light.type + "'", "there are directional, point and spot");
    return spot(light, axes, position, strength, name);
  }

 private:
  [[noreturn]] void fail(const std::string& name, const std::string& what, std::string_view remedy) const {
    throw Error(document_.file, "light '" + name + "' " + what, remedy);
  }

  C3f strength_of(const tinygltf::Light& light, const std::string& name) const {
    C3f result(1.0f);
    if (!light.color.empty() && light.color.size() != 3)
      fail(name, "has a color of " + std::to_string(light.color.size()) + " numbers", "give three");
    for (int c = 0; c < 3; ++c) {
      const double color = light.color.empty() ? 1.0 : light.color[static_cast<std::size_t>(c)];
      const double value = color * light.intensity;
      if (!(color >= 0.0 && value >= 0.0 && value <= 1e30))
        fail(name, "has a color or intensity below 0 or beyond 1e30", "correct the file");
      result[c] = static_cast<float>(value);
    }
    return result;
  }

  /// Inside of the inner cone and beyond the outer one both falloffs agree; between, ours falls linearly with
  /// the angle (L20), glTF's recommended one with the square of a linear function of its cosine.
  PunctualLight spot(const tinygltf::Light& light, const GltfAxes& axes, const V3d& position,
                     const C3f& strength, const std::string& name) {
    const double inner = light.spot.innerConeAngle, outer = light.spot.outerConeAngle;
    if (!(inner >= 0.0 && inner < outer && outer <= 0.5 * pi + 1e-6))
      fail(name, "has cones of " + std::to_string(inner) + " and " + std::to_string(outer) + " radians",
           "0 <= innerConeAngle < outerConeAngle <= pi/2");
    if (inner > 0.0 || outer < 0.5 * pi)
      notes_.add(document_.file +
                 ": between their cones, spot lights fade linearly with the angle, as Mitsuba's do");
    // Local +z is the axis of the cone; half a turn around y keeps the frame right-handed.
    const V3d x = -axes.x, y = axes.y, z = -axes.z;
    const M44d to_world(x.x, x.y, x.z, 0.0, y.x, y.y, y.z, 0.0, z.x, z.y, z.z, 0.0, position.x, position.y,
                        position.z, 1.0);
    SpotLight result;
    result.frame = light_frame(to_world);
    result.intensity = strength;
    constexpr double widest = 0.5 * pi * 0.999;  // a right angle has no tangent
    result.cutoff_angle = static_cast<float>(std::min(outer, widest));
    result.beam_width = static_cast<float>(std::min(inner, widest));
    return result;
  }

  const GltfDocument& document_;
  Notes& notes_;
};

}  // namespace

std::vector<PunctualLight> read_gltf_lights(const GltfDocument& document, const std::vector<GltfPlace>& places,
                                            Notes& notes, std::vector<std::string>& names) {
  LightReader reader(document, notes);
  std::vector<PunctualLight> result;
  for (const GltfPlace& place : places) {
    const tinygltf::Node& node = document.model.nodes[place.node];
    const auto extension = node.extensions.find("KHR_lights_punctual");
    if (extension == node.extensions.end()) continue;
    const std::string name = name_of_node(document, place.node);
    const tinygltf::Value& index = extension->second.Get("light");
    if (!index.IsInt())
      throw Error(document.file, "node '" + name + "' has a KHR_lights_punctual without a light",
                  "correct the file");
    const tinygltf::Light& light =
        element_of(document.model.lights, index.GetNumberAsInt(), "light", "node '" + name + "'", document);
    result.push_back(reader.read(light, place, name));
    names.push_back(name);
  }
  return result;
}

}  // namespace twopass
