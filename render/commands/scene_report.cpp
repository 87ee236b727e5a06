#include "render/commands/scene_report.h"

#include <map>
#include <set>

#include "render/plan.h"
#include "render/scene/mesh_facts.h"

namespace twopass {

namespace {

using nlohmann::ordered_json;

constexpr int huge_texture = 8192;  // pixels along an edge

ordered_json json_of(const V3d& v) { return {v.x, v.y, v.z}; }

std::string text_of(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

// The models that a material is made of, and the images that it looks at.
struct Ingredients {
  std::map<std::string, std::size_t> models;
  std::set<std::shared_ptr<const TextureImage>> images;

  void add(const Texture& texture) {
    if (const auto* bitmap = std::get_if<Bitmap>(&texture)) images.insert(bitmap->image);
    if (const auto* udim = std::get_if<Udim>(&texture))
      for (const Bitmap& tile : udim->tiles)
        if (tile.image) images.insert(tile.image);
  }
  void add(const MaterialNode& node) {
    if (const auto* model = std::get_if<TexturedModel>(&node.kind)) {
      ++models[std::string(model_names[model->bsdf.index()])];
      for (const TextureBinding& binding : model->textures) add(binding.texture);
    } else if (const auto* mixture = std::get_if<Mixture>(&node.kind)) {
      ++models["mixture"];
      add(mixture->weight);
      add(*mixture->first);
      add(*mixture->second);
    } else if (const auto* bump = std::get_if<BumpMap>(&node.kind)) {
      ++models["bumpmap"];
      add(bump->height);
      add(*bump->nested);
    } else {
      const auto& map = std::get<NormalMap>(node.kind);
      ++models["normalmap"];
      add(map.normal);
      add(*map.nested);
    }
  }
};

std::string names_of(const std::map<std::string, std::size_t>& models) {
  std::string names;
  for (const auto& [name, count] : models) names += (names.empty() ? "" : "+") + name;
  return names;
}

// What shapes there are; the triangles of instanced meshes as often as they are seen, and once in memory.
struct ShapeCounts {
  std::size_t triangles = 0, spheres = 0, disks = 0, cylinders = 0, mesh_instances = 0, stored_triangles = 0;
  std::set<const Mesh*> shared;
};

void count(ShapeCounts& counts, const Shape& shape) {
  if (const Mesh* mesh = mesh_of(shape.geometry)) {
    const bool is_instance = std::holds_alternative<MeshInstance>(shape.geometry);
    counts.triangles += mesh->triangles.size();
    counts.mesh_instances += is_instance;
    if (!is_instance || counts.shared.insert(mesh).second) counts.stored_triangles += mesh->triangles.size();
  } else if (std::holds_alternative<Disk>(shape.geometry)) {
    ++counts.disks;
  } else if (std::holds_alternative<Cylinder>(shape.geometry)) {
    ++counts.cylinders;
  } else {
    ++counts.spheres;
  }
}

// Collects the report piece by piece; problems as they are met.
class Reporter {
 public:
  explicit Reporter(const LoadedScene& loaded)
      : loaded_(loaded), scene_(loaded.scene), bounds_(bounds_of(scene_.shapes)) {}

  ordered_json run() {
    read_shapes();
    read_materials();
    const ordered_json lights = read_lights(), camera = read_camera();
    ordered_json report = {{"shapes", scene_.shapes.size()},
                           {"triangles", all_.triangles},
                           {"stored_triangles", all_.stored_triangles},
                           {"mesh_instances", all_.mesh_instances},
                           {"spheres", all_.spheres},
                           {"disks", all_.disks},
                           {"cylinders", all_.cylinders},
                           {"materials", models_},
                           {"emitters", lights},
                           {"textures", textures_.size()},
                           {"texture_pixels", texture_pixels_},
                           {"texture_bytes", texture_bytes_},
                           {"bounds", bounds()},
                           {"camera", camera},
                           {"size", {loaded_.settings.width, loaded_.settings.height}}};
    if (loaded_.settings.crop) {
      const PixelWindow& crop = *loaded_.settings.crop;
      report["crop"] = {crop.corner.x, crop.corner.y, crop.size.x, crop.size.y};
    }
    add_plan(report);
    report["problems"] = problems_;
    report["notes"] = loaded_.notes;
    report["shapes_by_name"] = shapes_;
    report["materials_by_name"] = materials_;
    return report;
  }

 private:
  void problem(const std::string& text) { problems_.push_back(text); }

  void read_shapes() {
    used_.assign(scene_.materials.size(), 0);
    for (const Shape& shape : scene_.shapes) {
      ++used_[shape.material];
      ordered_json row = {{"name", shape.name}, {"material", scene_.materials[shape.material].name}};
      double area = 0.0;
      count(all_, shape);
      if (is_emitter(shape)) count(emitting_, shape);
      if (const auto* mesh = std::get_if<Mesh>(&shape.geometry)) {
        area = read_mesh(*mesh, shape.name, row);
      } else if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
        area = 4.0 * pi * sphere->radius * sphere->radius;
        row["kind"] = "sphere";
      } else if (const auto* disk = std::get_if<Disk>(&shape.geometry)) {
        area = area_of(*disk);
        row["kind"] = "disk";
      } else if (const auto* cylinder = std::get_if<Cylinder>(&shape.geometry)) {
        area = area_of(*cylinder);
        row["kind"] = "cylinder";
      } else {
        const std::size_t triangles = mesh_of(shape.geometry)->triangles.size();
        for (std::size_t t = 0; t < triangles; ++t) {
          const auto p = corners(shape.geometry, static_cast<std::uint32_t>(t));
          area += 0.5 * V3d(p[1] - p[0]).cross(V3d(p[2] - p[0])).length();
        }
        row["kind"] = "instance";
        row["triangles"] = triangles;
      }
      row["area"] = area;
      const double power =
          pi * area * (mean_component(shape.radiance[front]) + mean_component(shape.radiance[back]));
      area_power_ += power;
      row["power"] = power;
      shapes_.push_back(std::move(row));
    }
  }

  double read_mesh(const Mesh& mesh, const std::string& name, ordered_json& row) {
    const MeshFacts facts = facts_of(mesh);
    row["kind"] = "mesh";
    row["triangles"] = mesh.triangles.size();
    row["normals"] = !mesh.normals.empty();
    row["uvs"] = !mesh.uvs.empty();
    row["closed"] = facts.is_closed();
    row["open_edges"] = facts.open_edges;
    row["turned_edges"] = facts.turned_edges;
    row["crowded_edges"] = facts.crowded_edges;
    row["degenerate"] = facts.degenerate;
    row["duplicates"] = facts.duplicates;
    const auto look_at = [&](std::size_t n, const char* what) {
      if (n > 0) problem("shape '" + name + "': " + std::to_string(n) + " " + what);
    };
    look_at(facts.degenerate, "triangles without area");
    look_at(facts.duplicates, "triangles lie on top of others");
    look_at(facts.turned_edges, "edges between triangles that face different ways");
    if (facts.is_closed() && facts.signed_volume < 0.0)
      problem("shape '" + name + "' is closed and its front is inside: a room, or flipped");
    return facts.area;
  }

  void read_materials() {
    for (std::size_t i = 0; i < scene_.materials.size(); ++i) {
      const Material& material = scene_.materials[i];
      Ingredients side;
      side.add(*material.side[front].node());
      for (const auto& [name, count] : side.models) models_[name] += count;
      textures_.insert(side.images.begin(), side.images.end());
      const C3f albedo = material.side[front].traits().mean_diffuse_reflectance;
      materials_.push_back({{"name", material.name},
                            {"models", names_of(side.models)},
                            {"diffuse_reflectance", json_of(V3d(albedo))},
                            {"textures", side.images.size()},
                            {"shapes", used_[i]}});
      if (max_component(albedo) > 0.99f && used_[i] > 0)
        problem("material '" + material.name + "' reflects " + text_of(max_component(albedo)) +
                " of the light: nothing real does, and interiors take long");
    }
    Ingredients lamps;
    for (const Shape& shape : scene_.shapes)
      if (shape.radiance_texture) lamps.add(*shape.radiance_texture);
    textures_.insert(lamps.images.begin(), lamps.images.end());
    for (const auto& image : textures_) {
      texture_pixels_ +=
          static_cast<std::uint64_t>(image->width()) * static_cast<std::uint64_t>(image->height());
      texture_bytes_ += image->memory();
      if (std::max(image->width(), image->height()) > huge_texture)
        problem("a texture has " + std::to_string(image->width()) + "x" + std::to_string(image->height()) +
                " pixels");
    }
  }

  ordered_json read_lights() {
    std::map<std::string, std::size_t> punctual;
    double punctual_power = 0.0;
    const double radius = bounds_.isEmpty() ? 0.0 : 0.5 * static_cast<double>(bounds_.size().length());
    for (const PunctualLight& light : scene_.punctual_lights) {
      ++punctual[kind_name(light)];
      punctual_power += power(light, radius);
    }
    const C3f sky = scene_.environment.mean_radiance();
    if (!needs_of(scene_).light)
      problem("there is no light: render adds a neutral sky, or a lamp in a closed room");
    return {{"triangles", emitting_.triangles},
            {"spheres", emitting_.spheres},
            {"disks", emitting_.disks},
            {"cylinders", emitting_.cylinders},
            {"area_power", area_power_},
            {"punctual", punctual},
            {"punctual_power", punctual_power},
            {"environment", scene_.environment.kind_name()},
            {"environment_radiance", json_of(V3d(sky))}};
  }

  ordered_json bounds() {
    if (bounds_.isEmpty()) {
      problem("there is nothing to be seen: no shape has any area");
      return nullptr;
    }
    const V3d size = V3d(bounds_.max) - V3d(bounds_.min);
    const double largest = std::max({size.x, size.y, size.z});
    const V3d lowest = scene_.frame.to_world(V3d(bounds_.min)),
              highest = scene_.frame.to_world(V3d(bounds_.max));
    double farthest = 0.0;
    for (int axis = 0; axis < 3; ++axis)
      farthest = std::max({farthest, std::abs(lowest[axis]), std::abs(highest[axis])});
    if (farthest > 1e4 * largest)
      problem("it lies " + text_of(farthest) + " units from the origin and is " + text_of(largest) +
              " units large: what files hold as floats has few digits left; move it to the origin");
    return {{"min", json_of(lowest)}, {"max", json_of(highest)}, {"extent", json_of(size)}};
  }

  ordered_json read_camera() {
    if (!scene_.camera) {
      problem("there is no camera: render frames all of it, or looks around in a closed room");
      return nullptr;
    }
    const CameraDescription& camera = *scene_.camera;
    const M44d& m = camera.to_world;
    const V3d origin(m[3][0], m[3][1], m[3][2]), forward = V3d(m[2][0], m[2][1], m[2][2]).normalized();
    const bool orthographic = camera.projection == Projection::orthographic;
    const bool inside = !bounds_.isEmpty() && bounds_.intersects(V3f(origin));
    const bool sees = sees_bounds(camera);
    if (!sees)
      problem("the camera looks past everything: nothing lies in its picture between near_clip and far_clip");
    ordered_json json = {
        {"kind", orthographic                   ? "orthographic"
                 : camera.aperture_radius > 0.0 ? "thinlens"
                                                : "perspective"},
        {"position", json_of(scene_.frame.to_world(origin))},
        {"direction", json_of(forward)},
        {"inside_bounds", inside},
        {"sees_bounds", sees},
        {"near_clip", camera.near_clip},
        {"far_clip", std::isfinite(camera.far_clip) ? ordered_json(camera.far_clip) : ordered_json(nullptr)}};
    if (!orthographic) json["fov_degrees"] = camera.fov_degrees;
    if (camera.aperture_radius > 0.0) {
      json["aperture_radius"] = camera.aperture_radius;
      json["focus_distance"] = camera.focus_distance;
    }
    return json;
  }

  // Whether any of a grid of rays meets the bounds where the camera sees.
  [[nodiscard]] bool sees_bounds(const CameraDescription& description) const {
    if (bounds_.isEmpty()) return false;
    constexpr int steps = 32;
    const int width = loaded_.settings.width, height = loaded_.settings.height;
    const Camera camera(description, width, height);
    for (int i = 0; i < steps * steps; ++i) {
      const V2f pixel((static_cast<float>(i % steps) + 0.5f) / steps * static_cast<float>(width),
                      (static_cast<float>(i / steps) + 0.5f) / steps * static_cast<float>(height));
      const CameraRay seen = camera.ray(pixel);
      if (meets_bounds(seen)) return true;
    }
    return false;
  }
  [[nodiscard]] bool meets_bounds(const CameraRay& seen) const {
    double from = 0.0, to = seen.reach;
    for (int axis = 0; axis < 3; ++axis) {
      const double o = seen.ray.origin[axis], d = seen.ray.direction[axis];
      double low = (bounds_.min[axis] - o) / d, high = (bounds_.max[axis] - o) / d;
      if (d == 0.0) {
        if (o < bounds_.min[axis] || o > bounds_.max[axis]) return false;
        continue;
      }
      if (low > high) std::swap(low, high);
      from = std::max(from, low);
      to = std::min(to, high);
    }
    return from <= to;
  }

  void add_plan(ordered_json& report) const {
    const SceneNeeds needs = needs_of(scene_);
    const PathLimits limits{loaded_.settings.max_depth, loaded_.settings.rr_depth,
                            loaded_.settings.hide_emitters};
    const IntegratorKind integrator =
        loaded_.settings.integrator
            ? value_of_name<IntegratorKind>(integrator_names, *loaded_.settings.integrator, "integrator",
                                            "integrator")
            : IntegratorKind::two_pass;
    const Plan plan = plan_render(needs, integrator, limits);
    report["integrator"] = name_of_value<IntegratorKind>(integrator_names, integrator);
    report["needs"] = {{"light", needs.light},
                       {"diffuse_reflection", needs.diffuse_reflection},
                       {"specular", needs.specular},
                       {"see_through", needs.see_through},
                       {"radiosity_pass", plan.radiosity_pass}};
    ordered_json skipped = ordered_json::array();
    for (const Skipped& entry : plan.skipped) skipped.push_back({{"what", entry.what}, {"why", entry.why}});
    for (const Skipped& entry : loaded_.left_out) skipped.push_back({{"what", entry.what}, {"why", entry.why}});
    report["skipped"] = skipped;
  }

  const LoadedScene& loaded_;
  const SceneDescription& scene_;
  Box3f bounds_;
  ShapeCounts all_, emitting_;
  double area_power_ = 0.0;
  std::vector<std::size_t> used_;  // shapes by material
  std::map<std::string, std::size_t> models_;
  std::set<std::shared_ptr<const TextureImage>> textures_;
  std::uint64_t texture_pixels_ = 0, texture_bytes_ = 0;
  ordered_json problems_ = ordered_json::array(), shapes_ = ordered_json::array(),
               materials_ = ordered_json::array();
};

}  // namespace

ordered_json scene_report(const LoadedScene& loaded) { return Reporter(loaded).run(); }

}  // namespace twopass
