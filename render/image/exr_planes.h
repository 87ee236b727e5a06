// Planes of 32-bit words in OpenEXR files, exactly and a few rows at a time, so that they may be larger than
// memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "render/image/exr.h"

namespace twopass {

struct ExrPlane {
  std::string name;       ///< of the channel
  bool is_float = false;  ///< the words are the bits of floats; else of unsigned integers

  friend bool operator==(const ExrPlane&, const ExrPlane&) = default;
};

/// Fills, or takes, one row of all planes: plane p's word of pixel x is words[p * width + x].
using FillRow = std::function<void(int y, std::span<std::uint32_t> words)>;
using TakeRow = std::function<void(int y, std::span<const std::uint32_t> words)>;

/// Writes one part of scan lines, uncompressed, tagged as write_exr does; of the options, the metadata and the
/// place in the full frame count. `fill` is called for each row in order, from 0. Atomic; what was there is
/// kept as `previous` unless that is empty. Throws Error.
void write_exr_planes(const std::filesystem::path& path, std::span<const ExrPlane> planes, int width,
                      int height, const ExrOptions& options, const FillRow& fill,
                      const std::filesystem::path& previous = {});

/// A file of write_exr_planes, open for reading.
class ExrPlanesFile {
 public:
  /// Reads the header. Throws Error when the file is missing, not a regular file, no OpenEXR, or not whole.
  explicit ExrPlanesFile(const std::filesystem::path& path);
  ~ExrPlanesFile();
  ExrPlanesFile(ExrPlanesFile&&) noexcept;
  ExrPlanesFile& operator=(ExrPlanesFile&&) noexcept;

  [[nodiscard]] int width() const;
  [[nodiscard]] int height() const;
  /// In the order of the file, which is that of the names.
  [[nodiscard]] const std::vector<ExrPlane>& planes() const;
  /// The metadata and the place in the full frame.
  [[nodiscard]] const ExrOptions& options() const;
  /// Reads all rows in order; planes in the order that is asked for. Throws Error when one is missing or the
  /// file is damaged.
  void read(std::span<const ExrPlane> planes, const TakeRow& take) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace twopass
