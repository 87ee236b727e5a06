// Intel Open Image Denoise, where it is installed: found when the program runs. The only home of that library.
#pragma once

#include <memory>
#include <string>

#include "render/image/image.h"

namespace twopass {

/// The layer that keeps what the picture was before.
inline constexpr const char* noisy_layer = "noisy";

class Denoiser {
 public:
  /// On at most so many threads; 0: as many as there are. Throws Error when the library is not installed,
  /// lacks a function or cannot start.
  explicit Denoiser(int threads = 0);
  ~Denoiser();
  Denoiser(Denoiser&&) noexcept;
  Denoiser& operator=(Denoiser&&) noexcept;

  /// "Intel Open Image Denoise 2.3.1"
  [[nodiscard]] const std::string& name() const;
  /// The image with R, G, B without noise, and what these were in noisy.R, .G, .B; all else is kept. Guided by
  /// its layers albedo and N, which are filtered first. Throws Error at `where` when it lacks one of them, or
  /// the library reports an error.
  [[nodiscard]] Image denoised(const Image& image, const std::string& where) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace twopass
