#include "render/load/gltf_camera.h"

#include "render/core/error.h"
#include "render/load/mesh_tools.h"

namespace twopass {
namespace {

V3d row(const M44d& m, int i) { return {m[i][0], m[i][1], m[i][2]}; }

/// Throws Error unless low < value < high.
void require(double value, double low, double high, const std::string& camera, const char* name,
             const GltfDocument& document) {
  if (value > low && value < high) return;
  throw Error(document.file, "camera '" + camera + "' has " + name + " " + std::to_string(value),
              "correct the file");
}

void set_proportions(double aspect, FileSettings& settings) {
  constexpr double largest = 65536.0;
  const double width = std::round(aspect * settings.height);
  settings.width = static_cast<int>(std::clamp(width, 1.0, largest));
  // Of pictures more than a hundred times as wide as high, the height gives way.
  if (width > largest) settings.height = static_cast<int>(std::max(1.0, std::round(largest / aspect)));
}

void read_perspective(const tinygltf::PerspectiveCamera& lens, const std::string& node,
                      const GltfDocument& document, CameraDescription& camera, FileSettings& settings) {
  require(lens.yfov, 0.0, pi, node, "yfov", document);
  camera.fov_degrees = lens.yfov * 180.0 / pi;
  camera.fov_axis = FovAxis::y;
  if (lens.aspectRatio == 0.0) return;  // not given
  require(lens.aspectRatio, 0.0, 1e6, node, "aspectRatio", document);
  set_proportions(lens.aspectRatio, settings);
}

}  // namespace

GltfAxes axes_of(const GltfPlace& place, const GltfDocument& document) {
  const V3d z = row(place.to_world, 2), y = row(place.to_world, 1);
  const V3d side = y.cross(z);
  if (!(z.length() > 0.0) || !(side.length() > 1e-9 * y.length() * z.length()))
    throw Error(document.file, "node '" + name_of_node(document, place.node) + "' has no direction to look in",
                "give its transform a scale other than 0");
  GltfAxes axes;
  axes.z = z.normalized();
  axes.x = side.normalized();
  axes.y = axes.z.cross(axes.x);
  return axes;
}

std::optional<CameraDescription> read_gltf_camera(const GltfDocument& document,
                                                  const std::vector<GltfPlace>& places, FileSettings& settings,
                                                  Notes& notes) {
  std::optional<CameraDescription> result;
  std::size_t others = 0;
  for (const GltfPlace& place : places) {
    const std::string node = name_of_node(document, place.node);
    const int index = document.model.nodes[place.node].camera;
    if (index < 0) continue;
    if (result) {
      ++others;
      continue;
    }
    const tinygltf::Camera& camera =
        element_of(document.model.cameras, index, "camera", "node '" + node + "'", document);
    result.emplace();
    double half_width = 1.0;  // of what an orthographic camera sees
    if (camera.type == "perspective") {
      read_perspective(camera.perspective, node, document, *result, settings);
    } else {
      const tinygltf::OrthographicCamera& box = camera.orthographic;
      require(box.xmag, 0.0, largest_coordinate, node, "xmag", document);
      require(box.ymag, 0.0, largest_coordinate, node, "ymag", document);
      set_proportions(box.xmag / box.ymag, settings);
      result->projection = Projection::orthographic;
      half_width = box.xmag;
    }
    // glTF's cameras look along -z with +x to the right, ours along +z with +x to the left.
    const GltfAxes axes = axes_of(place, document);
    const V3d left = axes.x * -half_width, up = axes.y * half_width, forward = -axes.z,
              eye = row(place.to_world, 3);
    result->to_world = {left.x,    left.y,    left.z,    0.0, up.x,  up.y,  up.z,  0.0,
                        forward.x, forward.y, forward.z, 0.0, eye.x, eye.y, eye.z, 1.0};
  }
  if (others > 0)
    notes.add(document.file + ": the first of its " + std::to_string(others + 1) + " cameras is used");
  return result;
}

}  // namespace twopass
