// twopass info: what is in a scene, what it needs, and what will be skipped.
#include <cstdio>
#include <set>

#include <nlohmann/json.hpp>

#include "render/commands/command.h"
#include "render/commands/scene_options.h"
#include "render/core/parallel.h"
#include "render/plan.h"

namespace twopass {

namespace {

using nlohmann::ordered_json;

struct InfoOptions {
  SceneOptions scene;
  bool json = false;
};

// Counts a material's models, and what changes them.
void count_models(std::map<std::string, std::size_t>& models, const MaterialNode& node) {
  if (const auto* model = std::get_if<TexturedModel>(&node.kind)) {
    ++models[std::string(model_names[model->bsdf.index()])];
  } else if (const auto* mixture = std::get_if<Mixture>(&node.kind)) {
    ++models["mixture"];
    count_models(models, *mixture->first);
    count_models(models, *mixture->second);
  } else if (const auto* bump = std::get_if<BumpMap>(&node.kind)) {
    ++models["bumpmap"];
    count_models(models, *bump->nested);
  } else {
    ++models["normalmap"];
    count_models(models, *std::get<NormalMap>(node.kind).nested);
  }
}

// What shapes there are; the triangles of instanced meshes as often as they are seen, and once in memory.
struct ShapeCounts {
  std::size_t triangles = 0, spheres = 0, disks = 0, cylinders = 0, mesh_instances = 0, stored_triangles = 0;
  std::set<const Mesh*> shared;
};

void count_shape(ShapeCounts& counts, const Shape& shape) {
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

ordered_json describe(const LoadedScene& loaded) {
  const SceneDescription& scene = loaded.scene;
  ShapeCounts all, emitting;
  for (const Shape& shape : scene.shapes) {
    count_shape(all, shape);
    if (is_emitter(shape)) count_shape(emitting, shape);
  }
  std::map<std::string, std::size_t> models;
  for (const Material& material : scene.materials) count_models(models, *material.side[front].node());
  const Box3f box = bounds_of(scene.shapes);
  ordered_json bounds = nullptr;
  if (!box.isEmpty())
    bounds = {{"min", {box.min.x, box.min.y, box.min.z}}, {"max", {box.max.x, box.max.y, box.max.z}}};

  std::map<std::string, std::size_t> punctual;
  for (const PunctualLight& light : scene.punctual_lights) ++punctual[kind_name(light)];

  const SceneNeeds needs = needs_of(scene);
  const PathLimits limits{loaded.settings.max_depth, loaded.settings.rr_depth, loaded.settings.hide_emitters};
  const IntegratorKind integrator =
      loaded.settings.integrator ? value_of_name<IntegratorKind>(integrator_names, *loaded.settings.integrator,
                                                                 "integrator", "integrator")
                                 : IntegratorKind::two_pass;
  const Plan plan = plan_render(needs, integrator, limits);
  ordered_json skipped = ordered_json::array();
  for (const Skipped& entry : plan.skipped) skipped.push_back({{"what", entry.what}, {"why", entry.why}});
  return {{"shapes", scene.shapes.size()},
          {"triangles", all.triangles},
          {"stored_triangles", all.stored_triangles},
          {"mesh_instances", all.mesh_instances},
          {"spheres", all.spheres},
          {"disks", all.disks},
          {"cylinders", all.cylinders},
          {"materials", models},
          {"emitters",
           {{"triangles", emitting.triangles},
            {"spheres", emitting.spheres},
            {"disks", emitting.disks},
            {"cylinders", emitting.cylinders},
            {"punctual", punctual},
            {"environment", scene.environment.kind_name()}}},
          {"textures", 0},
          {"bounds", bounds},
          {"size", {loaded.settings.width, loaded.settings.height}},
          {"integrator", name_of_value<IntegratorKind>(integrator_names, integrator)},
          {"needs",
           {{"light", needs.light},
            {"diffuse_reflection", needs.diffuse_reflection},
            {"specular", needs.specular},
            {"see_through", needs.see_through},
            {"radiosity_pass", plan.radiosity_pass}}},
          {"skipped", skipped}};
}

void print(const ordered_json& value, int indent) {
  for (const auto& [key, entry] : value.items()) {
    if (entry.is_object()) {
      std::printf("%*s%s\n", indent, "", key.c_str());
      print(entry, indent + 2);
    } else if (key == "skipped") {
      for (const ordered_json& skipped : entry)
        std::printf("%*sskipped: %s, because %s\n", indent, "", skipped["what"].get<std::string>().c_str(),
                    skipped["why"].get<std::string>().c_str());
    } else {
      const std::string text = entry.is_string() ? entry.get<std::string>() : entry.dump();
      std::printf("%*s%-*s %s\n", indent, "", 20 - indent, key.c_str(), text.c_str());
    }
  }
}

int info(const InfoOptions& options, const GlobalOptions& global) {
  const ThreadLimit limit(global.threads);
  const ordered_json description = describe(options.scene.load(global.console(), SceneOptions::Framing::none));
  if (options.json)
    std::printf("%s\n", description.dump(2).c_str());
  else
    print(description, 0);
  return 0;
}

}  // namespace

void add_info_command(CLI::App& program, const GlobalOptions& global, Action& action) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App& command =
      *program.add_subcommand("info", "What is in a scene, what it needs, what will be skipped and why");
  options->scene.add_to(command);
  command.add_flag("--json", options->json, "Print JSON");
  command.callback(
      [options, &global, &action] { action = [options, &global] { return info(*options, global); }; });
}

}  // namespace twopass
