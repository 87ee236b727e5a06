#include "tests/fuzz/fuzz_case.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <unistd.h>

#include "render/core/error.h"
#include "render/image/exr.h"
#include "render/load/load.h"
#include "tests/fuzz/heap_meter.h"

namespace twopass {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void complain(const std::string& what) {
  std::fprintf(stderr, "fuzz case: %s\n", what.c_str());
  std::abort();
}
void require(bool holds, const char* what) {
  if (!holds) complain(what);
}

void write_file(const fs::path& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// The scene files of PLY and serialized meshes.
constexpr std::string_view ply_scene =
    R"(<scene version="3.0.0"><shape type="ply"><string name="filename" value="mesh.ply"/></shape></scene>)";
constexpr std::string_view serialized_scenes[] = {
    R"(<scene version="3.0.0"><shape type="serialized"><string name="filename" value="mesh.serialized"/></shape></scene>)",
    R"(<scene version="3.0.0"><shape type="serialized"><string name="filename" value="mesh.serialized"/><integer name="shape_index" value="1"/></shape></scene>)",
};

/// A folder that disappears with the process, with the files that scenes may name.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("twopass_fuzz_" + std::to_string(getpid()))) {
    fs::create_directories(path_);
    write_file(path_ / "mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
    write_file(path_ / "mesh.ply",
               "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
               "property float vertex_color_r\nproperty float vertex_color_g\nproperty float vertex_color_b\n"
               "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
               "0 0 0 1 0 0\n1 0 0 0 1 0\n0 1 0 0 0 1\n3 0 1 2\n");
    write_file(path_ / "light.ies",
               "IESNA91\nTILT=NONE\n1 1000 1 3 1 1 1 0.1 0.1 0.1\n1 1 50\n0 45 90\n0\n100 80 0\n");
    Image picture(4, 2, {"R", "G", "B"});
    write_exr(path_ / "picture.exr", picture);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// The files that `bytes` stand for, in `folder`; the scene file of them first. REQUIRES: not `serialized`.
fs::path write_scene(FuzzFormat format, std::string_view bytes, const fs::path& folder) {
  const std::size_t end = std::min(bytes.find('\0'), bytes.size());
  const std::string_view first = bytes.substr(0, end), second = bytes.substr(std::min(end + 1, bytes.size()));
  switch (format) {
    case FuzzFormat::xml:
      write_file(folder / "part.xml", second);
      write_file(folder / "scene.xml", first);
      return folder / "scene.xml";
    case FuzzFormat::obj:
      write_file(folder / "scene.mtl", second);
      write_file(folder / "scene.obj", first);
      return folder / "scene.obj";
    case FuzzFormat::gltf: {
      const bool is_binary = bytes.starts_with("glTF");
      const fs::path file = folder / (is_binary ? "scene.glb" : "scene.gltf");
      write_file(folder / "data.bin", is_binary ? "" : second);
      write_file(file, is_binary ? bytes : first);
      return file;
    }
    case FuzzFormat::ply:
    case FuzzFormat::serialized:
      break;
  }
  write_file(folder / (format == FuzzFormat::ply ? "mesh.ply" : "mesh.serialized"), bytes);
  return folder / "scene.xml";
}

void check_mesh(const Mesh& mesh) {
  const std::size_t count = mesh.positions.size();
  require(mesh.normals.empty() || mesh.normals.size() == count, "as many normals as positions");
  require(mesh.uvs.empty() || mesh.uvs.size() == count, "as many texture coordinates as positions");
  for (const V3u& t : mesh.triangles) require(t.x < count && t.y < count && t.z < count, "indices in range");
  for (const V3f& p : mesh.positions) require(is_finite(p), "finite positions");
  for (const V3f& n : mesh.normals)
    require(is_finite(n) && (std::abs(n.length() - 1.0f) < 1e-3f || n == V3f(0.0f)), "unit normals");
  for (const V2f& uv : mesh.uvs) require(is_finite(uv), "finite texture coordinates");
  for (const MeshAttribute& attribute : mesh.attributes) {
    require(attribute.values.size() == (attribute.is_of_faces() ? mesh.triangles.size() : count),
            "attributes for all");
    for (const C3f& value : attribute.values) require(is_finite(value), "finite attributes");
  }
}

void check_description(const SceneDescription& scene) {
  require(scene.shapes.empty() || !scene.materials.empty(), "materials");
  for (const Shape& shape : scene.shapes) {
    require(shape.material < scene.materials.size(), "materials in range");
    require(is_finite(shape.radiance[front]) && is_finite(shape.radiance[back]), "finite radiance");
    if (const auto* mesh = std::get_if<Mesh>(&shape.geometry)) check_mesh(*mesh);
    if (const auto* instance = std::get_if<MeshInstance>(&shape.geometry)) check_mesh(*instance->mesh);
  }
  const Box3f bounds = bounds_of(scene.shapes);
  require(bounds.isEmpty() || (is_finite(bounds.min) && is_finite(bounds.max)), "finite bounds");
}

/// Looks at the first shapes from in front: normals, textures and materials are used.
void cast_rays(const Scene& scene) {
  constexpr std::size_t most = 8;
  for (std::size_t s = 0; s < std::min(most, scene.shapes().size()); ++s) {
    const Box3f box = bounds_of(scene.shapes().subspan(s, 1));
    const V3f target = box.center(), size = box.size();
    for (const V3f& side : {V3f(0.3f, 0.2f, 1.0f), V3f(-1.0f, 0.4f, -0.5f)}) {
      const V3f direction = unit(-side);
      const Ray ray{target - direction * (size.length() + 1.0f), direction};
      const Hit hit = scene.caster().intersect(ray);
      if (hit.escaped()) continue;
      SurfacePoint point = scene.surface_point(ray, hit);
      require(is_finite(point.position), "finite points");
      require(is_finite(scene.emitted_radiance(point)), "finite emission");
      Bsdf storage{Diffuse{C3f(0.0f)}};
      scene.resolve(point, direction, storage, [] { return 0.5f; });
      require(is_finite(point.shading.n), "finite shading normals");
    }
  }
}

void check_message(const std::string& message) {
  const std::size_t what = message.find(": "), remedy = message.rfind("; ");
  require(what != std::string::npos && remedy != std::string::npos && what < remedy,
          ("an error of the form where: what; what to do, not " + message).c_str());
}

void load_and_check(const fs::path& path) {
  try {
    LoadedScene loaded = load_scene(path, {}, {.memory_megabytes = 16}, true);
    check_description(loaded.scene);
    if (!loaded.scene.shapes.empty()) cast_rays(Scene(std::move(loaded.scene)));
  } catch (const Error& error) {
    check_message(error.what());
  }
}

}  // namespace

std::size_t memory_allowance(FuzzFormat format, std::size_t size) {
  // What a scene takes whatever its files hold, and for each byte of them. Deflated bytes become up to 1032.
  const std::size_t fixed = 64 << 20, times = format == FuzzFormat::serialized ? 8000 : 400;
  return fixed + times * size;
}

void run_fuzz_case(FuzzFormat format, std::string_view bytes) {
  static const Folder folder;
  reset_heap_peak();
  if (format == FuzzFormat::serialized) {
    write_file(folder.path() / "mesh.serialized", bytes);
    for (const std::string_view scene : serialized_scenes) {
      write_file(folder.path() / "scene.xml", scene);
      load_and_check(folder.path() / "scene.xml");
    }
  } else {
    if (format == FuzzFormat::ply) write_file(folder.path() / "scene.xml", ply_scene);
    load_and_check(write_scene(format, bytes, folder.path()));
  }
  const std::size_t most = memory_allowance(format, bytes.size());
  if (heap_growth() > most)
    complain(std::to_string(bytes.size()) + " bytes took " + std::to_string(heap_growth()) +
             " bytes of memory, more than " + std::to_string(most));
}

}  // namespace twopass
