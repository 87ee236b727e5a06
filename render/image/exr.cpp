#include "render/image/exr.h"

#include <cstring>
#include <set>
#include <span>
#include <string_view>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
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

bool is_among(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool is_color(std::string_view name, const ExrOptions& options) {
  const auto [layer, suffix] = split(name);
  return (suffix == "R" || suffix == "G" || suffix == "B" || suffix == "A") &&
         !is_among(options.float_layers, layer);
}

Imf::PixelType type_of_channel(std::string_view name, const ExrOptions& options) {
  if (is_among(options.integer_layers, split(name).layer)) return Imf::UINT;
  return is_color(name, options) && options.pixel_type == PixelType::half ? Imf::HALF : Imf::FLOAT;
}

Imf::Chromaticities chromaticities_of(const Primaries& p) { return {p.red, p.green, p.blue, p.white}; }

// What the colours of a file are in; none: it does not say.
std::optional<Primaries> primaries_of(const Imf::Header& header) {
  const auto* id = header.findTypedAttribute<Imf::StringAttribute>("colorInteropID");
  if (id == nullptr) return std::nullopt;
  if (const Primaries* known = find_interop_space(id->value())) return *known;
  if (id->value() != unknown_space || !Imf::hasChromaticities(header)) return std::nullopt;
  const Imf::Chromaticities& c = Imf::chromaticities(header);
  return Primaries{c.red, c.green, c.blue, c.white};
}

Imf::Compression compression_of(ExrCompression compression) {
  switch (compression) {
    case ExrCompression::none:
      return Imf::NO_COMPRESSION;
    case ExrCompression::rle:
      return Imf::RLE_COMPRESSION;
    case ExrCompression::zip:
      return Imf::ZIP_COMPRESSION;
    case ExrCompression::piz:
      return Imf::PIZ_COMPRESSION;
    case ExrCompression::pxr24:
      return Imf::PXR24_COMPRESSION;
    case ExrCompression::b44:
      return Imf::B44_COMPRESSION;
    case ExrCompression::b44a:
      return Imf::B44A_COMPRESSION;
    case ExrCompression::dwaa:
      return Imf::DWAA_COMPRESSION;
    case ExrCompression::dwab:
      return Imf::DWAB_COMPRESSION;
    case ExrCompression::zips:
      break;
  }
  return Imf::ZIPS_COMPRESSION;
}

// The channels of one part.
struct Part {
  std::string name;
  std::vector<std::size_t> channels;  // of the image
  bool has_color = false;
};

std::vector<Part> parts_of(const Image& image, const ExrOptions& options) {
  std::vector<Part> parts;
  for (std::size_t c = 0; c < image.channels.size(); ++c) {
    const std::string& channel = image.channels[c];
    const bool has_color = is_color(channel, options);
    std::string name(split(channel).layer);
    if (name.empty()) name = has_color ? "rgba" : channel;
    if (options.parts == ExrParts::single) name = "";
    auto part = std::find_if(parts.begin(), parts.end(), [&](const Part& p) { return p.name == name; });
    if (part == parts.end()) part = parts.insert(parts.end(), {name, {}, false});
    part->channels.push_back(c);
    part->has_color = part->has_color || has_color;
  }
  return parts;
}

Imf::Header make_header(const Image& image, const Part& part, const ExrOptions& options) {
  Imf::Header header = picture_header(image.width, image.height, options, part.has_color);
  if (!part.name.empty()) {
    header.setName(part.name);
    header.setType(Imf::SCANLINEIMAGE);
  }
  for (const std::size_t c : part.channels)
    header.channels().insert(image.channels[c], Imf::Channel(type_of_channel(image.channels[c], options)));
  return header;
}

// Slices address pixels by their coordinates in the file, whose data window need not begin at zero.
Imf::Slice slice_of(Imf::PixelType type, char* first, const Imath::Box2i& window, std::size_t pixel_bytes) {
  const auto width = static_cast<std::size_t>(window.size().x) + 1;
  return Imf::Slice::Make(type, first, window, pixel_bytes, pixel_bytes * width);
}

// A channel as the file has it, the way it stands in memory: values that may be written, finite and within the
// range of their type.
template <class Value, class Convert>
std::vector<char> plane_of(const Image& image, std::size_t channel, float low, float high,
                           const Convert& convert) {
  std::vector<char> plane(image.pixel_count() * sizeof(Value));
  const std::size_t stride = image.channels.size();
  for (std::size_t i = 0; i < image.pixel_count(); ++i) {
    const float value = image.pixels[i * stride + channel];
    const Value written = convert(std::isfinite(value) ? std::clamp(value, low, high) : 0.0f);
    std::memcpy(&plane[i * sizeof(Value)], &written, sizeof(Value));
  }
  return plane;
}

std::vector<char> plane_of(const Image& image, std::size_t channel, Imf::PixelType type) {
  constexpr float most = std::numeric_limits<float>::max();
  if (type == Imf::HALF)
    return plane_of<half>(image, channel, -largest_half, largest_half, [](float x) { return half(x); });
  if (type == Imf::UINT)
    return plane_of<std::uint32_t>(image, channel, 0.0f, 0x1p24f,
                                   [](float x) { return static_cast<std::uint32_t>(std::lround(x)); });
  return plane_of<float>(image, channel, -most, most, [](float x) { return x; });
}

// Writes one part: to an OutputFile or an OutputPart.
template <class Output>
void write_part(Output& output, const Image& image, const Part& part, const ExrOptions& options) {
  std::vector<std::vector<char>> planes;
  Imf::FrameBuffer frame;
  for (const std::size_t c : part.channels) {
    const Imf::PixelType type = type_of_channel(image.channels[c], options);
    planes.push_back(plane_of(image, c, type));
    frame.insert(image.channels[c], slice_of(type, planes.back().data(), output.header().dataWindow(),
                                             type == Imf::HALF ? sizeof(half) : sizeof(float)));
  }
  output.setFrameBuffer(frame);
  output.writePixels(image.height);
}

void encode(Imf::OStream& stream, const Image& image, const ExrOptions& options) {
  const std::vector<Part> parts = parts_of(image, options);
  std::vector<Imf::Header> headers;
  for (const Part& part : parts) headers.push_back(make_header(image, part, options));
  if (options.parts == ExrParts::single) {
    Imf::OutputFile file(stream, headers.front());
    return write_part(file, image, parts.front(), options);
  }
  Imf::MultiPartOutputFile file(stream, headers.data(), static_cast<int>(headers.size()));
  for (std::size_t i = 0; i < parts.size(); ++i) {
    Imf::OutputPart output(file, static_cast<int>(i));
    write_part(output, image, parts[i], options);
  }
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

// A damaged header may promise any size; four gigabytes of floats are more than any honest picture here.
void check_values(const fs::path& path, std::int64_t width, std::int64_t height, std::size_t channels) {
  constexpr std::int64_t most_values = std::int64_t{1} << 30;
  if (width < 1 || height < 1 || channels == 0 ||
      width > most_values / height / static_cast<std::int64_t>(channels))
    throw Error(path.string(),
                "it has " + std::to_string(channels) + " channels of " + std::to_string(width) + "x" +
                    std::to_string(height) + " pixels",
                "give a picture with pixels, of at most " + std::to_string(most_values) + " values");
}

Image empty_image(const fs::path& path, const Imf::Header& header) {
  const Imath::Box2i window = header.dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  std::vector<std::string> channels = ordered_channels(path, header.channels());
  check_values(path, width, height, channels.size());
  return {static_cast<int>(width), static_cast<int>(height), std::move(channels)};
}

bool is_deep(const Imf::Header& header) { return header.hasType() && Imf::isDeepData(header.type()); }

Image read_part(const fs::path& path, Imf::MultiPartInputFile& file, int number) {
  const Imf::Header& header = file.header(number);
  // Asked before any memory is taken: a writer that was killed leaves the table of lines unfinished.
  if (!file.partComplete(number))
    throw Error(path.string(), "it is incomplete, its writer was probably interrupted", "write the file again");
  Image image = empty_image(path, header);
  const std::size_t channels = image.channels.size();
  Imf::FrameBuffer frame;
  for (std::size_t c = 0; c < channels; ++c)
    frame.insert(image.channels[c], slice_of(Imf::FLOAT, reinterpret_cast<char*>(image.pixels.data() + c),
                                             header.dataWindow(), channels * sizeof(float)));
  Imf::InputPart part(file, number);
  part.setFrameBuffer(frame);
  part.readPixels(header.dataWindow().min.y, header.dataWindow().max.y);
  return image;
}

// The channels of all flat parts in the first one's window.
Image joined(const fs::path& path, Imf::MultiPartInputFile& file, Image first) {
  const V2i corner = file.header(0).dataWindow().min;
  for (int p = 1; p < file.parts(); ++p) {
    const Imf::Header& header = file.header(p);
    if (is_deep(header)) continue;
    Image part = read_part(path, file, p);
    for (std::string& name : part.channels)
      if (first.channel(name) >= 0) name = header.name() + "." + name;  // views, and layers without prefixes
    std::vector<std::string> channels = first.channels;
    channels.insert(channels.end(), part.channels.begin(), part.channels.end());
    check_values(path, first.width, first.height, channels.size());
    Image both(first.width, first.height, std::move(channels));
    const V2i shift = corner - header.dataWindow().min;
    for (int y = 0; y < both.height; ++y)
      for (int x = 0; x < both.width; ++x) {
        float* to = &both.pixels[both.index(x, y, 0)];
        to = std::copy_n(&first.pixels[first.index(x, y, 0)], first.channels.size(), to);
        const int from_x = x + shift.x, from_y = y + shift.y;
        if (from_x >= 0 && from_x < part.width && from_y >= 0 && from_y < part.height)
          std::copy_n(&part.pixels[part.index(from_x, from_y, 0)], part.channels.size(), to);
      }
    first = std::move(both);
  }
  return first;
}

}  // namespace

Imf::Header picture_header(int width, int height, const ExrOptions& options, bool has_color) {
  const V2i corner = options.data_offset;
  const V2i frame = options.display_size.value_or(V2i(width, height));
  const Imath::Box2i display(V2i(0, 0), frame - V2i(1, 1));
  const Imath::Box2i data(corner, corner + V2i(width - 1, height - 1));
  Imf::Header header(display, data, 1.0f, V2f(0.0f, 0.0f), 1.0f, Imf::INCREASING_Y,
                     compression_of(options.compression));
  // The tag of the Color Interop Forum.
  header.insert("colorInteropID", Imf::StringAttribute(has_color ? options.color_space : "data"));
  const bool writes_chromaticities =
      options.chromaticities == ExrChromaticities::always ||
      (options.chromaticities == ExrChromaticities::automatic && options.color_space != rec709_id);
  const Primaries* known = find_interop_space(options.color_space);
  if (known == nullptr && options.primaries) known = &*options.primaries;
  if (has_color && writes_chromaticities && known != nullptr)
    Imf::addChromaticities(header, chromaticities_of(*known));
  if (options.world_to_camera) Imf::addWorldToCamera(header, *options.world_to_camera);
  if (options.world_to_ndc) Imf::addWorldToNDC(header, *options.world_to_ndc);
  insert_metadata(header, options.metadata);
  return header;
}

ExrOptions options_of(const Imf::Header& header) {
  ExrOptions options;
  options.metadata = metadata_of(header);
  if (const auto* space = header.findTypedAttribute<Imf::StringAttribute>("colorInteropID"))
    options.color_space = space->value();
  if (options.color_space == unknown_space) options.primaries = primaries_of(header);
  if (Imf::hasWorldToCamera(header)) options.world_to_camera = Imf::worldToCamera(header);
  if (Imf::hasWorldToNDC(header)) options.world_to_ndc = Imf::worldToNDC(header);
  options.data_offset = header.dataWindow().min;
  options.display_size = header.displayWindow().max + V2i(1, 1);
  return options;
}

void check_is_exr(const fs::path& path) {
  check_regular_file(path);
  if (!Imf::isOpenExrFile(path.c_str())) throw Error(path.string(), "it is no OpenEXR file", "check the file");
}

void check_exr(const fs::path& path, const std::vector<std::string>& channels, const ExrOptions& options) {
  std::set<std::string_view> seen;
  for (const std::string& name : channels)
    if (name.empty() || !seen.insert(name).second)
      throw Error(path.string(),
                  "the channel name '" + name + "' is " + (name.empty() ? "empty" : "used twice"),
                  "give every layer its own name");
  if (options.compression >= ExrCompression::pxr24)
    for (const std::string& name : channels)
      if (!is_color(name, options))
        throw Error(path.string(),
                    "the compression " +
                        std::string(name_of_value<ExrCompression>(exr_compression_names, options.compression)) +
                        " would change the data in channel '" + name + "'",
                    "use it for colours alone, or none, rle, zips, zip or piz");
  if (options.color_space != unknown_space && find_interop_space(options.color_space) == nullptr) {
    std::vector<std::string_view> names{unknown_space};
    for (const auto& [name, primaries] : interop_spaces()) names.push_back(name);
    throw Error(path.string(), "unknown colour space '" + options.color_space + "'",
                "use one of: " + join_names(names));
  }
}

void write_exr(const fs::path& path, const Image& image, const ExrOptions& options) {
  check_exr(path, image.channels, options);
  if (image.pixels.empty())
    throw Error(path.string(), "the picture has no pixels", "render at least one pixel");
  MemoryStream stream;
  try {
    encode(stream, image, options);
  } catch (const std::exception& e) {
    throw Error(path.string(), std::string("OpenEXR cannot encode it: ") + e.what(),
                "check the names of layers and attributes");
  }
  write_atomically(path, stream.bytes());
}

ExrFacts exr_facts(const fs::path& path) {
  check_is_exr(path);
  return in_our_words(path, [&] {
    const Imf::MultiPartInputFile file(path.c_str());
    const Image image = empty_image(path, file.header(0));
    return ExrFacts{V2i(image.width, image.height), primaries_of(file.header(0))};
  });
}

Image read_exr(const fs::path& path, ExrMetadata* metadata, std::optional<Primaries>* primaries) {
  check_is_exr(path);
  return in_our_words(path, [&] {
    Imf::MultiPartInputFile file(path.c_str());
    const Imf::Header& header = file.header(0);
    if (is_deep(header)) throw Error(path.string(), "it holds deep data", "flatten it first");
    if (metadata != nullptr) *metadata = metadata_of(header);
    if (primaries != nullptr) *primaries = primaries_of(header);
    return joined(path, file, read_part(path, file, 0));
  });
}

}  // namespace twopass
