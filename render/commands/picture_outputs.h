// The pictures that a command writes, each in the format of its name.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "render/image/color.h"
#include "render/image/denoise.h"
#include "render/image/exr.h"
#include "render/image/image.h"

namespace twopass {

/// Where pictures say how many pixels there are around what was asked for.
inline constexpr const char* overscan_metadata = "twopass/overscan";

/// Adds --denoise.
void add_denoise_option(CLI::App& command, bool& denoise);

class PictureOutputs {
 public:
  /// For use before any work: throws Error when one of them cannot be written, or seen as asked for.
  PictureOutputs(std::vector<std::string> paths, DisplayOptions display);

  [[nodiscard]] const std::vector<std::string>& paths() const { return paths_; }
  /// Lets noise be taken out of the pictures, on at most so many threads (0: all). Throws Error where that is
  /// not possible.
  void set_denoiser(int threads) { denoiser_.emplace(threads); }
  /// What the pixels are in, where that is known only later: as DisplayOptions::working_space. Throws Error.
  void set_working_space(const std::string& name);
  /// Which OpenColorIO configuration there is, and what it was asked for.
  [[nodiscard]] std::string color_text() const;
  /// Writes all of them, even when one cannot be written or denoised: then throws its Error. Those that are
  /// display-referred are without the overscan of `exr`. `write_other` may write a file in another way; then
  /// it returns true.
  void write(const Image& image, const ExrOptions& exr,
             const std::function<bool(const std::string& path)>& write_other = {}) const;

 private:
  void write_all(const Image& image, const ExrOptions& exr,
                 const std::function<bool(const std::string& path)>& write_other) const;

  std::vector<std::string> paths_;
  DisplayOptions options_;
  std::optional<DisplayTransform> display_;  // where a path needs one
  std::optional<Denoiser> denoiser_;
};

}  // namespace twopass
