// Films in files, to the last bit: what a render has sampled so far, to be continued or merged with other parts
// of it. Viewers see an ordinary picture (R, G, B, A as floats) beside the sums.
#pragma once

#include <filesystem>
#include <span>

#include "render/image/exr_planes.h"
#include "render/image/film.h"

namespace twopass {

/// Writes the film as OpenEXR, uncompressed: the picture, and for each number of FilmPixel the channels NAME.hi
/// and NAME.lo, the halves of its 64 bits; `marks`, if not empty a byte for each pixel, as `film.mark`; and a
/// check sum of every pixel. 16 rows at a time, atomically; what was there is kept as `previous` unless that is
/// empty. Throws Error.
void write_film(const std::filesystem::path& path, const Film& film, std::span<const std::uint8_t> marks,
                const ExrOptions& options, const std::filesystem::path& previous = {});

/// A file of write_film.
class FilmFile {
 public:
  /// Reads the header. Throws Error when the file cannot be read, is not whole, or is none of write_film.
  explicit FilmFile(const std::filesystem::path& path);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] int width() const { return file_.width(); }
  [[nodiscard]] int height() const { return file_.height(); }
  [[nodiscard]] const ExrOptions& options() const { return file_.options(); }
  [[nodiscard]] bool has_marks() const;
  /// Adds what the file holds to the film. With `marks`, also replaces those, which are left alone where the
  /// file has none. Throws Error when the film has another size or other layers, and when the file is damaged;
  /// the film is then of no use.
  void merge_into(Film& film, std::vector<std::uint8_t>* marks = nullptr) const;

 private:
  [[nodiscard]] bool has(const ExrPlane& plane) const;
  std::filesystem::path path_;
  ExrPlanesFile file_;
};

}  // namespace twopass
