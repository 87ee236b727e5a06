#include "render/image/exr.h"

#include <cstring>
#include <set>
#include <span>
#include <string_view>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTestFile.h>

#include "render/core/error.h"
#include "render/image/atomic_file.h"
#include "render/image/exr_header.h"
#include "render/image/regular_file.h"

namespace twopass {
namespace {

namespace fs = std::filesystem;

constexpr float largest_half = 65504.0f;

// A file in memory, so that the disk sees only whole pictures.
class MemoryStream : public Imf::OStream {
 public:
  MemoryStream() : OStream("memory") {}
  void write(const char* bytes, int count) override {
    const std::size_t end = position_ + static_cast<std::size_t>(count);
    if (end > bytes_.size()) bytes_.resize(end);
    std::memcpy(bytes_.data() + position_, bytes, static_cast<std::size_t>(count));
    position_ = end;
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = position; }
  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
  std::size_t position_ = 0;
};

struct ChannelName {
  std::string_view layer;   // empty for the unnamed layer
  std::string_view suffix;  // what follows the last dot
};

ChannelName split(std::string_view name) {
  const std::size_t dot = name.rfind('.');
  if (dot == std::string_view::npos) return {{}, name};
  return {name.substr(0, dot), name.substr(dot + 1)};
}

void insert_metadata(Imf::Header& header, const ExrMetadata& metadata) {
  for (const auto& [name, value] : metadata) {
    if (const auto* text = std::get_if<std::string>(&value)) header.insert(name, Imf::StringAttribute(*text));
    if (const auto* number = std::get_if<float>(&value)) header.insert(name, Imf::FloatAttribute(*number));
    if (const auto* number = std::get_if<int>(&value)) header.insert(name, Imf::IntAttribute(*number));
  }
}

ExrMetadata metadata_of(const Imf::Header& header) {
  ExrMetadata metadata;
  for (auto it = header.begin(); it != header.end(); ++it) {
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&it.attribute()))
      metadata.emplace_back(it.name(), text->value());
    if (const auto* number = dynamic_cast<const Imf::FloatAttribute*>(&it.attribute()))
      metadata.emplace_back(it.name(), number->value());
    if (const auto* number = dynamic_cast<const Imf::IntAttribute*>(&it.attribute()))
      metadata.emplace_back(it.name(), number->value());
  }
  return metadata;
}

Imf::PixelType type_of_channel(std::string_view name, const ExrOptions& options) {
  const auto [layer, suffix] = split(name);
  const bool is_color = suffix == "R" || suffix == "G" || suffix == "B" || suffix == "A";
  const bool is_data_layer =
      std::find(options.float_layers.begin(), options.float_layers.end(), layer) != options.float_layers.end();
  return is_color && !is_data_layer && options.pixel_type == PixelType::half ? Imf::HALF : Imf::FLOAT;
}

void check_channels(const fs::path& path, const Image& image) {
  std::set<std::string_view> seen;
  for (const std::string& name : image.channels)
    if (name.empty() || !seen.insert(name).second)
      throw Error(path.string(),
                  "the channel name '" + name + "' is " + (name.empty() ? "empty" : "used twice"),
                  "give every layer its own name");
  if (image.pixels.empty())
    throw Error(path.string(), "the picture has no pixels", "render at least one pixel");
}

Imf::Header make_header(const Image& image, const ExrOptions& options) {
  Imf::Header header = picture_header(image.width, image.height, options);
  for (const std::string& name : image.channels)
    header.channels().insert(name, Imf::Channel(type_of_channel(name, options)));
  return header;
}

// The pixels as they may be written: finite, and within the range of the channel's type.
std::vector<float> writable_pixels(const Image& image, const ExrOptions& options) {
  const std::size_t channels = image.channels.size();
  std::vector<float> limits(channels);
  for (std::size_t c = 0; c < channels; ++c)
    limits[c] = type_of_channel(image.channels[c], options) == Imf::HALF ? largest_half
                                                                         : std::numeric_limits<float>::max();
  std::vector<float> pixels = image.pixels;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const float limit = limits[i % channels];
    pixels[i] = std::isfinite(pixels[i]) ? std::clamp(pixels[i], -limit, limit) : 0.0f;
  }
  return pixels;
}

// Slices address pixels by their coordinates in the file, whose data window need not begin at zero.
Imf::Slice slice_of(Imf::PixelType type, char* first, const Imath::Box2i& window, std::size_t pixel_bytes) {
  const auto width = static_cast<std::size_t>(window.size().x) + 1;
  return Imf::Slice::Make(type, first, window, pixel_bytes, pixel_bytes * width);
}

std::vector<half> halves_of_channel(const std::vector<float>& pixels, std::size_t channel,
                                    std::size_t channels) {
  std::vector<half> result;
  result.reserve(pixels.size() / channels);
  for (std::size_t i = channel; i < pixels.size(); i += channels) result.emplace_back(pixels[i]);
  return result;
}

void encode(Imf::OStream& stream, const Image& image, const ExrOptions& options) {
  const Imf::Header header = make_header(image, options);
  std::vector<float> pixels = writable_pixels(image, options);
  const std::size_t channels = image.channels.size();
  std::vector<std::vector<half>> half_planes(channels);  // the library writes a type as it stands in memory
  Imf::FrameBuffer frame;
  for (std::size_t c = 0; c < channels; ++c) {
    if (type_of_channel(image.channels[c], options) == Imf::HALF) {
      half_planes[c] = halves_of_channel(pixels, c, channels);
      frame.insert(image.channels[c], slice_of(Imf::HALF, reinterpret_cast<char*>(half_planes[c].data()),
                                               header.dataWindow(), sizeof(half)));
    } else {
      frame.insert(image.channels[c], slice_of(Imf::FLOAT, reinterpret_cast<char*>(pixels.data() + c),
                                               header.dataWindow(), channels * sizeof(float)));
    }
  }
  Imf::OutputFile file(stream, header);
  file.setFrameBuffer(frame);
  file.writePixels(image.height);
}

// R, G, B, A, then the others as the file orders them (by name).
std::vector<std::string> ordered_channels(const fs::path& path, const Imf::ChannelList& list) {
  std::vector<std::string> names;
  for (const char* first : {"R", "G", "B", "A"})
    if (list.findChannel(first) != nullptr) names.emplace_back(first);
  const std::size_t colors = names.size();
  for (auto it = list.begin(); it != list.end(); ++it) {
    if (it.channel().xSampling != 1 || it.channel().ySampling != 1)
      throw Error(path.string(), std::string("its channel ") + it.name() + " is subsampled",
                  "save it with the channels R, G, B at full size");
    if (std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(colors), it.name()) ==
        names.begin() + static_cast<std::ptrdiff_t>(colors))
      names.emplace_back(it.name());
  }
  return names;
}

Image empty_image(const fs::path& path, const Imf::Header& header) {
  const Imath::Box2i window = header.dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  std::vector<std::string> channels = ordered_channels(path, header.channels());
  // A damaged header may promise any size; four gigabytes of floats are more than any honest picture here.
  constexpr std::int64_t most_values = std::int64_t{1} << 30;
  if (width < 1 || height < 1 || channels.empty() ||
      width > most_values / height / static_cast<std::int64_t>(channels.size()))
    throw Error(path.string(),
                "it has " + std::to_string(channels.size()) + " channels of " + std::to_string(width) + "x" +
                    std::to_string(height) + " pixels",
                "give a picture with pixels, of at most " + std::to_string(most_values) + " values");
  return {static_cast<int>(width), static_cast<int>(height), std::move(channels)};
}

Image read_first_part(const fs::path& path, ExrMetadata* metadata) {
  Imf::MultiPartInputFile file(path.c_str());
  const Imf::Header& header = file.header(0);
  if (header.hasType() && Imf::isDeepData(header.type()))
    throw Error(path.string(), "it holds deep data", "flatten it first");
  // Asked before any memory is taken: a writer that was killed leaves the table of lines unfinished.
  if (!file.partComplete(0))
    throw Error(path.string(), "it is incomplete, its writer was probably interrupted", "write the file again");
  Image image = empty_image(path, header);
  const std::size_t channels = image.channels.size();
  Imf::FrameBuffer frame;
  for (std::size_t c = 0; c < channels; ++c)
    frame.insert(image.channels[c], slice_of(Imf::FLOAT, reinterpret_cast<char*>(image.pixels.data() + c),
                                             header.dataWindow(), channels * sizeof(float)));
  Imf::InputPart part(file, 0);
  part.setFrameBuffer(frame);
  part.readPixels(header.dataWindow().min.y, header.dataWindow().max.y);
  if (metadata != nullptr) *metadata = options_of(header).metadata;
  return image;
}

}  // namespace

Imf::Header picture_header(int width, int height, const ExrOptions& options) {
  const V2i corner = options.data_offset;
  const V2i frame = options.display_size.value_or(V2i(width, height));
  const Imath::Box2i display(V2i(0, 0), frame - V2i(1, 1));
  const Imath::Box2i data(corner, corner + V2i(width - 1, height - 1));
  Imf::Header header(display, data, 1.0f, V2f(0.0f, 0.0f), 1.0f, Imf::INCREASING_Y, Imf::ZIPS_COMPRESSION);
  // The tag of the Color Interop Forum; chromaticities are left out because Rec.709 is what readers assume.
  header.insert("colorInteropID", Imf::StringAttribute("lin_rec709_scene"));
  insert_metadata(header, options.metadata);
  return header;
}

ExrOptions options_of(const Imf::Header& header) {
  ExrOptions options;
  options.metadata = metadata_of(header);
  options.data_offset = header.dataWindow().min;
  options.display_size = header.displayWindow().max + V2i(1, 1);
  return options;
}

void check_is_exr(const fs::path& path) {
  check_regular_file(path);
  if (!Imf::isOpenExrFile(path.c_str())) throw Error(path.string(), "it is no OpenEXR file", "check the file");
}

void write_exr(const fs::path& path, const Image& image, const ExrOptions& options) {
  check_channels(path, image);
  MemoryStream stream;
  try {
    encode(stream, image, options);
  } catch (const std::exception& e) {
    throw Error(path.string(), std::string("OpenEXR cannot encode it: ") + e.what(),
                "check the names of layers and attributes");
  }
  write_atomically(path, stream.bytes());
}

V2i exr_size(const fs::path& path) {
  check_is_exr(path);
  return in_our_words(path, [&] {
    const Image image = empty_image(path, Imf::MultiPartInputFile(path.c_str()).header(0));
    return V2i(image.width, image.height);
  });
}

Image read_exr(const fs::path& path, ExrMetadata* metadata) {
  check_is_exr(path);
  return in_our_words(path, [&] { return read_first_part(path, metadata); });
}

}  // namespace twopass
