// What `twopass render` is asked for, and what becomes of it with the wishes of the scene's file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "integrators/clamp.h"
#include "render/commands/display_options.h"
#include "render/commands/layer_options.h"
#include "render/commands/long_render.h"
#include "render/commands/radiosity_options.h"
#include "render/commands/scene_options.h"

namespace twopass {

/// As on the command line.
struct RenderOptions {
  SceneOptions scene;
  std::vector<std::string> outputs;
  std::string integrator, sampler, size, stats_file, exr_type;
  std::vector<int> crop;  ///< left, top, width, height; empty: all
  SamplingGoal goal;
  std::optional<int> max_depth;
  float clamp_direct = infinity_f, clamp_indirect = infinity_f;
  std::optional<std::uint32_t> seed;
  RadiosityCommandOptions radiosity;
  std::string solution_file;
  DisplayOptions display;
  LayerOptions layers;
  bool certificate = true;
  LongRenderOptions parts;

  void add_to(CLI::App& command);
};

/// The settings of the file with the command line's put over them.
struct RenderSettings {
  IntegratorKind integrator = IntegratorKind::two_pass;
  PathLimits limits;
  int width = 0, height = 0;
  PixelWindow window;  ///< the part of it that is rendered
  SamplingGoal goal;
  SamplerKind sampler = SamplerKind::sobol;
  std::uint32_t seed = 0;
};

/// Says on the console when there is no goal to stop at but ours. Throws Error for what cannot be rendered.
RenderSettings settle(const RenderOptions& options, const FileSettings& file, const Console& console);

}  // namespace twopass
