// Stored samples of a picture to the values that textures hold: which channels, which curve, which range.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/image/color.h"
#include "render/image/primaries.h"

namespace twopass {

/// How stored values become linear light of Rec.709, or stay the data that they are.
struct TextureEncoding {
  enum class Kind {
    by_type,      ///< sRGB's curve where stored as integers, else linear in the primaries that the file names
    raw,          ///< as they are: normals, roughness, heights
    srgb,         ///< sRGB's curve
    gamma,        ///< value^gamma
    color_space,  ///< of an OpenColorIO configuration
  };
  Kind kind = Kind::by_type;
  float gamma = 1.0f;
  std::string color_space{};
  std::string config{};  ///< file of that configuration, as in DisplayOptions
  auto operator<=>(const TextureEncoding&) const = default;
};

/// What is taken of each pixel. Alpha is never decoded, and 1 where the picture has none.
enum class TextureChannel {
  color,  ///< R, G, B, or the grey that there is
  red,    ///< one channel, as a grey
  green,
  blue,
  alpha,
  opacity,  ///< alpha where the picture has it, else as `color`
};

/// Values outside are moved to its ends; those that are not finite become 0.
enum class TexelRange { any, nonnegative, unit };

struct TexelOptions {
  TextureEncoding encoding{};
  TextureChannel channel = TextureChannel::color;
  TexelRange range = TexelRange::any;
  auto operator<=>(const TexelOptions&) const = default;
};

class TexelDecoder {
 public:
  /// For pictures with these channels, whose linear colours are in `primaries`, if they say so; `where` names
  /// the picture in errors. Throws Error when it lacks the channel, or OpenColorIO the colour space.
  TexelDecoder(const TexelOptions& options, const std::vector<std::string>& channels, bool is_integer,
               const std::optional<Primaries>& primaries, std::string_view where);

  /// Channels of the result: 1 or 3.
  [[nodiscard]] int channels() const { return count_; }
  /// Numbers of the picture's channels that the result is made of, first to last.
  [[nodiscard]] const int* picked() const { return picked_; }
  /// Whether each channel of the result depends on its own channel alone, by the same curve: then 8 bits need
  /// only a table of 256 values.
  [[nodiscard]] bool has_curve() const { return !transform_ && !to_rec709_; }
  /// The curve. REQUIRES: has_curve().
  [[nodiscard]] float value(float stored) const;
  /// Decodes `count` pixels of the picture into `count` * channels() values. Returns how many were not finite.
  std::size_t decode(const float* pixels, std::size_t count, float* values) const;

 private:
  [[nodiscard]] float limited(float x) const;

  std::size_t stride_;
  int count_ = 3;
  int picked_[3] = {0, 0, 0};  // -1: 1
  TextureEncoding::Kind kind_;
  float gamma_;
  TexelRange range_;
  std::shared_ptr<const ColorSpaceTransform> transform_;
  std::optional<ColorMatrix> to_rec709_;
};

}  // namespace twopass
