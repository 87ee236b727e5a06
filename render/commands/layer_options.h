// The options of layers and of the files that hold them.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "render/image/exr.h"
#include "render/layers.h"

namespace twopass {

struct LayerOptions {
  std::string aovs, cryptomattes, compression = "zips", parts = "single", chromaticities = "auto";
  bool light_groups = false, seconds = false, denoise = false;
  int overscan = 0;  ///< pixels around the picture

  void add_to(CLI::App& command);
  /// With those that a denoiser needs. Throws Error for names that are none.
  [[nodiscard]] LayerRequest request() const;
  /// For use before rendering: throws Error when no output can hold what is asked for.
  void check(const LayerRequest& request, const std::vector<std::string>& outputs, const ExrOptions& exr) const;
  /// Fills in how layers are written. Throws Error for names that are none.
  void settle(const LayerRequest& request, ExrOptions& exr) const;
};

}  // namespace twopass
