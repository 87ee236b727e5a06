// Small scene files in a folder of their own, and expectations on errors: for the tests of the loaders.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include <gtest/gtest.h>
#include <unistd.h>

#include "render/core/error.h"
#include "render/load/load.h"

namespace twopass {

/// A folder that disappears with the test.
class LoadTest : public ::testing::Test {
 protected:
  LoadTest() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              ("twopass_" + std::to_string(getpid()) + "_" + test->test_suite_name() + "_" + test->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~LoadTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  std::filesystem::path write(const std::string& name, std::string_view text) const {
    const std::filesystem::path path = folder_ / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }
  /// Loads the text as a file called scene.xml, scene.obj, scene.gltf or scene.glb.
  LoadedScene load_xml(std::string_view text, const Definitions& definitions = {}) const {
    return load_scene(write("scene.xml", text), definitions);
  }
  LoadedScene load_obj(std::string_view text) const { return load_scene(write("scene.obj", text), {}); }
  LoadedScene load_gltf(std::string_view text) const { return load_scene(write("scene.gltf", text), {}); }
  LoadedScene load_glb(std::string_view bytes) const { return load_scene(write("scene.glb", bytes), {}); }

  std::filesystem::path folder_;
};

/// The message of the Error that `action` throws; "" when it throws none.
template <class Action>
std::string message_of(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// Expects an Error whose message contains all of the parts.
template <class Action>
void expect_error(const Action& action, std::initializer_list<std::string_view> parts) {
  const std::string message = message_of(action);
  ASSERT_NE(message, "") << "nothing was thrown";
  for (const std::string_view part : parts)
    EXPECT_NE(message.find(part), std::string::npos) << "'" << part << "' is not in: " << message;
}

/// The scene's mesh of a name.
inline const Mesh& mesh_of(const LoadedScene& loaded, std::size_t shape = 0) {
  return std::get<Mesh>(loaded.scene.shapes.at(shape).geometry);
}

/// Unit normal of a triangle, by its winding.
inline V3f normal_of(const Mesh& mesh, std::size_t triangle) {
  const V3u& t = mesh.triangles.at(triangle);
  const V3f &a = mesh.positions.at(t.x), &b = mesh.positions.at(t.y), &c = mesh.positions.at(t.z);
  return (b - a).cross(c - a).normalized();
}

inline double area_of(const Mesh& mesh) {
  double area = 0.0;
  for (const V3u& t : mesh.triangles) {
    const V3d a(mesh.positions.at(t.x)), b(mesh.positions.at(t.y)), c(mesh.positions.at(t.z));
    area += 0.5 * (b - a).cross(c - a).length();
  }
  return area;
}

inline void expect_near(const V3f& a, const V3f& b, float tolerance = 1e-5f) {
  EXPECT_LE((a - b).length(), tolerance) << a << " is not " << b;
}

inline bool has_note(const LoadedScene& loaded, std::string_view part) {
  for (const std::string& note : loaded.notes)
    if (note.find(part) != std::string::npos) return true;
  return false;
}

}  // namespace twopass
