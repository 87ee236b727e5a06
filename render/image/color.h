// Between named colour spaces, scene-linear pixels and displays, through OpenColorIO. The only home of that
// library.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "render/image/primaries.h"

namespace twopass {

/// Empty texts mean the default.
struct DisplayOptions {
  std::string config{};         ///< file of an OpenColorIO configuration; default $OCIO, else the built-in one
  std::string display{};        ///< default: the configuration's
  std::string view{};           ///< default: that display's
  std::string look{};           ///< looks of the configuration to apply before the view, or none
  std::string working_space{};  ///< what pixels are in, as WorkingSpace::name; default linear Rec.709
  float exposure_stops = 0.0f;  ///< radiance is multiplied by 2^stops first
};

/// The space that light is computed and pictures are stored in: linear, by name.
struct WorkingSpace {
  std::string name{};         ///< as the configuration calls it, never a role; empty: linear Rec.709
  ColorMatrix from_rec709{};  ///< of colours
  ColorMatrix to_rec709{};
  std::string interop_id{rec709_id};  ///< one of interop_spaces(); empty: it is none of them
  [[nodiscard]] bool is_rec709() const { return interop_id == rec709_id; }
};

/// Where pictures name it, if it is not linear Rec.709.
inline constexpr const char* working_space_metadata = "twopass/workingSpace";

/// The space of a configuration (as in DisplayOptions) with this name, alias or role; empty: linear Rec.709.
/// Throws Error when there is none (listing those there are), it is not linear, or the configuration does not
/// say how it relates to Rec.709.
WorkingSpace find_working_space(const std::string& name, const std::string& config);

/// A display and view of an OpenColorIO configuration, ready to apply. Immutable; may be shared by threads.
class DisplayTransform {
 public:
  /// Throws Error when the configuration cannot be read (never falls back to another one), the display, view,
  /// look or working space is unknown (listing those that exist), or the configuration does not say how it
  /// relates to Rec.709.
  explicit DisplayTransform(const DisplayOptions& options = {});
  ~DisplayTransform();
  DisplayTransform(DisplayTransform&&) noexcept;
  DisplayTransform& operator=(DisplayTransform&&) noexcept;

  /// Turns triples of the working space into display-encoded ones in [0,1], in place. Values that are not
  /// finite count as 0. REQUIRES: the size is a multiple of 3.
  void apply(std::span<float> rgb) const;

  [[nodiscard]] const std::string& display() const;
  [[nodiscard]] const std::string& view() const;
  /// "config, display, view, look, exposure" for metadata and reports.
  [[nodiscard]] const std::string& description() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// From a colour space of an OpenColorIO configuration to linear Rec.709. Immutable; may be shared by threads.
class ColorSpaceTransform {
 public:
  /// `config` as in DisplayOptions. Throws Error at `where` when the configuration does not know `color_space`
  /// (listing those that it knows) or how it relates to Rec.709.
  ColorSpaceTransform(const std::string& color_space, const std::string& config, std::string_view where);
  ~ColorSpaceTransform();

  /// Turns triples into linear Rec.709, in place. REQUIRES: the size is a multiple of 3.
  void apply(std::span<float> rgb) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace twopass
