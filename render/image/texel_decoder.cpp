#include "render/image/texel_decoder.h"

#include <algorithm>
#include <cmath>

#include "render/core/error.h"
#include "render/image/srgb.h"

namespace twopass {

namespace {

int find(const std::vector<std::string>& channels, std::string_view name) {
  const auto found = std::ranges::find(channels, name);
  return found == channels.end() ? -1 : static_cast<int>(found - channels.begin());
}

}  // namespace

TexelDecoder::TexelDecoder(const TexelOptions& options, const std::vector<std::string>& channels,
                           bool is_integer, const std::optional<Primaries>& primaries, std::string_view where)
    : stride_(channels.size()),
      kind_(options.encoding.kind),
      gamma_(options.encoding.gamma),
      range_(options.range) {
  using Kind = TextureEncoding::Kind;
  const bool is_linear_light = kind_ == Kind::by_type && !is_integer;
  if (kind_ == Kind::by_type) kind_ = is_integer ? Kind::srgb : Kind::raw;
  const int alpha = find(channels, "A"), grey = find(channels, "Y");
  const int color[3] = {find(channels, "R"), find(channels, "G"), find(channels, "B")};
  const bool has_color = color[0] >= 0 && color[1] >= 0 && color[2] >= 0;
  const bool takes_alpha =
      options.channel == TextureChannel::alpha || (options.channel == TextureChannel::opacity && alpha >= 0);
  if (takes_alpha) {
    count_ = 1;
    picked_[0] = alpha;
    kind_ = Kind::raw;
    return;
  }
  if (!has_color && grey < 0)
    throw Error(where, "the picture has neither the channels R, G, B nor Y",
                "save the colour in the unnamed layer of the file");
  const bool is_single = options.channel == TextureChannel::red || options.channel == TextureChannel::green ||
                         options.channel == TextureChannel::blue;
  count_ = is_single || !has_color ? 1 : 3;
  if (!has_color)
    picked_[0] = grey;
  else if (is_single)
    picked_[0] = color[static_cast<int>(options.channel) - static_cast<int>(TextureChannel::red)];
  else
    std::ranges::copy(color, picked_);
  if (kind_ == Kind::color_space) {
    transform_ = std::make_shared<const ColorSpaceTransform>(options.encoding.color_space,
                                                             options.encoding.config, where);
    if (is_single)
      throw Error(where, "a single channel of a picture with a colour space is asked for",
                  "give the colour space raw, or use the whole colour");
    // What was grey need not stay it.
    count_ = 3;
    if (!has_color) picked_[1] = picked_[2] = grey;
  }
  // Grey is grey in all of them: white becomes white.
  const Primaries& rec709 = *find_interop_space(rec709_id);
  if (is_linear_light && count_ == 3 && primaries && *primaries != rec709)
    to_rec709_ = conversion(*primaries, rec709);
}

float TexelDecoder::limited(float x) const {
  if (range_ == TexelRange::any) return x;
  return range_ == TexelRange::unit ? std::clamp(x, 0.0f, 1.0f) : std::max(x, 0.0f);
}

float TexelDecoder::value(float stored) const {
  using Kind = TextureEncoding::Kind;
  if (kind_ == Kind::srgb) return limited(srgb_decode(std::max(stored, 0.0f)));
  if (kind_ == Kind::gamma) return limited(std::pow(std::max(stored, 0.0f), gamma_));
  return limited(stored);
}

std::size_t TexelDecoder::decode(const float* pixels, std::size_t count, float* values) const {
  std::size_t not_finite = 0;
  float* value_at = values;
  for (std::size_t i = 0; i < count; ++i, pixels += stride_)
    for (int c = 0; c < count_; ++c) {
      float stored = picked_[c] < 0 ? 1.0f : pixels[picked_[c]];
      if (!std::isfinite(stored)) {
        stored = 0.0f;
        ++not_finite;
      }
      *value_at++ = has_curve() ? value(stored) : stored;
    }
  if (has_curve()) return not_finite;
  if (transform_) transform_->apply({values, value_at});
  if (to_rec709_)
    for (float* rgb = values; rgb != value_at; rgb += 3) {
      const C3f color = linear_image(*to_rec709_, {rgb[0], rgb[1], rgb[2]});
      std::copy_n(&color.x, 3, rgb);
    }
  for (float& x : std::span(values, value_at)) x = std::isfinite(x) ? limited(x) : 0.0f;
  return not_finite;
}

}  // namespace twopass
