// A scene as the benchmark renders it: small, through a box filter, which adds least to what the light itself
// varies.
#pragma once

#include <filesystem>
#include <string>

#include "render/load/load.h"
#include "render/plan.h"

namespace twopass {

struct BenchSubject {
  /// The picture keeps its proportions, `longer_side` pixels long. Throws Error without a light. REQUIRES: a
  /// camera.
  BenchSubject(const std::filesystem::path& file, LoadedScene loaded, int longer_side);

  std::string name;  ///< of the file, or of its folder where the file is called scene
  std::filesystem::path file;
  PathLimits limits;
  int width = 0, height = 0;
  SceneNeeds needs;
  CameraDescription camera_description;
  Camera camera;
  Scene scene;
  RayCone cone;

  /// Of everything that the converged picture depends on: scene, camera, size, limits. 16 hexadecimal digits.
  [[nodiscard]] std::string fingerprint() const;
};

/// The scenes to be measured if none are named: every folder of scenes/ with a scene.xml, by name. The folder
/// is that of the sources, or share/twopass/scenes of the installed program. Throws Error if there is none.
std::vector<std::filesystem::path> gallery_scenes();

}  // namespace twopass
