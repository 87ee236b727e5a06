#include "render/commands/picture_outputs.h"

#include <algorithm>
#include <cstdlib>
#include <exception>

#include "render/core/error.h"
#include "render/image/picture.h"

namespace twopass {
namespace {

int overscan_of(const ExrOptions& exr) {
  for (const auto& [name, value] : exr.metadata)
    if (const int* pixels = std::get_if<int>(&value); pixels && name == overscan_metadata) return *pixels;
  return 0;
}

// What is within a border of that many pixels; all, where nothing would be.
Image without_border(const Image& image, int border) {
  if (border <= 0 || 2 * border >= std::min(image.width, image.height)) return image;
  Image inner(image.width - 2 * border, image.height - 2 * border, image.channels);
  for (int y = 0; y < inner.height; ++y)
    std::copy_n(&image.pixels[image.index(border, y + border, 0)],
                static_cast<std::size_t>(inner.width) * image.channels.size(),
                &inner.pixels[inner.index(0, y, 0)]);
  return inner;
}

}  // namespace

void add_denoise_option(CLI::App& command, bool& denoise) {
  command.add_flag("--denoise", denoise,
                   "Take noise out of the picture with Intel Open Image Denoise, where that is installed; .exr "
                   "files keep the noisy picture in the layer noisy, beside albedo and N");
}

PictureOutputs::PictureOutputs(std::vector<std::string> paths, DisplayOptions display)
    : paths_(std::move(paths)), options_(std::move(display)) {
  for (const std::string& path : paths_) {
    check_picture_path(path);
    if (is_display_referred(path) && !display_) display_.emplace(options_);
  }
}

void PictureOutputs::set_working_space(const std::string& name) {
  options_.working_space = name;
  if (display_) display_.emplace(options_);
}

std::string PictureOutputs::color_text() const {
  if (display_) return display_->description();
  if (!options_.config.empty()) return options_.config;
  const char* variable = std::getenv("OCIO");
  return variable && *variable ? variable : "built-in";
}

void PictureOutputs::write(const Image& image, const ExrOptions& exr,
                           const std::function<bool(const std::string& path)>& write_other) const {
  if (!denoiser_ || paths_.empty()) return write_all(image, exr, write_other);
  ExrOptions options = exr;
  options.metadata.emplace_back("twopass/denoiser", denoiser_->name());
  std::optional<Image> denoised;
  try {
    denoised = denoiser_->denoised(image, paths_.front());
  } catch (const Error&) {
    write_all(image, exr, write_other);  // better noisy than lost
    throw;
  }
  write_all(*denoised, options, write_other);
}

void PictureOutputs::write_all(const Image& image, const ExrOptions& exr,
                               const std::function<bool(const std::string& path)>& write_other) const {
  ExrOptions inner = exr;
  const int border = overscan_of(exr);
  inner.data_offset += V2i(border, border);
  std::exception_ptr failure;
  for (const std::string& path : paths_) try {
      if (write_other && write_other(path)) continue;
      if (is_display_referred(path))
        write_picture(path, without_border(image, border), &*display_, inner);
      else
        write_picture(path, image, nullptr, exr);
    } catch (const Error&) {
      if (!failure) failure = std::current_exception();
    }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace twopass
