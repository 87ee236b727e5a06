#include "render/image/read_texture.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <optional>

#include <Imath/half.h>

#include "render/core/error.h"
#include "render/image/exr.h"
#include "render/image/oiio_loader.h"
#include "render/image/regular_file.h"
#include "render/image/tiled_levels.h"

namespace twopass {

namespace {

namespace fs = std::filesystem;

std::vector<std::string> split_lines(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

// Takes the rows of a picture and makes the finest level of them.
class LevelWriter {
 public:
  LevelWriter(const TexelOptions& options, const std::optional<Primaries>& primaries, std::string_view where)
      : options_(options), primaries_(primaries), where_(where) {}

  void begin(int width, int height, const std::vector<std::string>& channels, bool is_integer, bool is_half,
             bool is_byte) {
    constexpr std::int64_t most_texels = std::int64_t{1} << 31;
    if (width < 1 || height < 1) throw Error(where_, "a picture without pixels", "give another one");
    if (width > most_texels / height)
      throw Error(where_, "a picture of " + std::to_string(width) + " x " + std::to_string(height) + " pixels",
                  "make it smaller");
    decoder_.emplace(options_, channels, is_integer, primaries_, where_);
    stride_ = channels.size();
    takes_bytes_ = is_byte;
    const bool has_table = is_byte && decoder_->has_curve();
    as_half_ = is_byte || is_half;
    if (has_table)
      for (int code = 0; code < 256; ++code)
        values_of_codes_.push_back(decoder_->value(static_cast<float>(code) / 255.0f));
    level_ = {width,
              height,
              has_table ? TexelFormat::byte
              : is_half ? TexelFormat::half
                        : TexelFormat::single,
              {}};
    const std::size_t size = level_.format == TexelFormat::byte   ? 1
                             : level_.format == TexelFormat::half ? 2
                                                                  : 4;
    row_bytes_ = size * static_cast<std::size_t>(width) * static_cast<std::size_t>(decoder_->channels());
  }
  /// Bytes that the texture will take, all levels.
  [[nodiscard]] std::size_t size() const {
    const std::size_t finest = row_bytes_ * static_cast<std::size_t>(level_.height);
    return finest + finest * (level_.format == TexelFormat::byte ? 2 : 1) / 3;
  }
  void allocate() { level_.bytes.resize(row_bytes_ * static_cast<std::size_t>(level_.height)); }
  /// The same picture, read when it is looked at.
  [[nodiscard]] ReadTexture tiled(const fs::path& path) const {
    return {
        std::make_shared<const TextureImage>(std::make_unique<const TiledLevels>(path, *decoder_, as_half_)),
        0};
  }

  void rows(int first, int count, const void* samples) {
    std::byte* to = level_.bytes.data() + static_cast<std::size_t>(first) * row_bytes_;
    const auto pixels = static_cast<std::size_t>(level_.width) * static_cast<std::size_t>(count);
    if (level_.format == TexelFormat::byte) return pick(static_cast<const std::byte*>(samples), pixels, to);
    if (takes_bytes_) {
      const auto* bytes = static_cast<const unsigned char*>(samples);
      stored_.resize(pixels * stride_);
      for (std::size_t i = 0; i < stored_.size(); ++i) stored_[i] = static_cast<float>(bytes[i]) / 255.0f;
      samples = stored_.data();
    }
    values_.resize(pixels * static_cast<std::size_t>(decoder_->channels()));
    not_finite_ += decoder_->decode(static_cast<const float*>(samples), pixels, values_.data());
    if (level_.format == TexelFormat::single) {
      std::memcpy(to, values_.data(), values_.size() * sizeof(float));
      return;
    }
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const Imath::half value(std::clamp(values_[i], -65504.0f, 65504.0f));
      std::memcpy(to + 2 * i, &value, 2);
    }
  }

  ReadTexture finish() {
    return {std::make_shared<const TextureImage>(std::move(level_), decoder_->channels(),
                                                 std::move(values_of_codes_)),
            not_finite_};
  }

 private:
  // Bytes stay the codes that they are.
  void pick(const std::byte* samples, std::size_t pixels, std::byte* to) const {
    const int count = decoder_->channels();
    const int* picked = decoder_->picked();
    for (std::size_t i = 0; i < pixels; ++i, samples += stride_)
      for (int c = 0; c < count; ++c) *to++ = picked[c] < 0 ? std::byte{255} : samples[picked[c]];
  }

  TexelOptions options_;
  std::optional<Primaries> primaries_;
  std::string where_;
  std::optional<TexelDecoder> decoder_;
  std::size_t stride_ = 0, row_bytes_ = 0, not_finite_ = 0;
  bool takes_bytes_ = false, as_half_ = false;
  TexelLevel level_;
  std::vector<float> values_of_codes_, stored_, values_;
};

// Between the module, through which no exception may pass, and the writer.
struct Reception {
  LevelWriter writer;
  std::size_t most_bytes;
  bool wants_tiles = false;
  std::string problem{};
  std::exception_ptr error{};

  static int begin(void* self, const TwopassPicture* p) {
    auto& reception = *static_cast<Reception*>(self);
    try {
      reception.writer.begin(p->width, p->height, split_lines(p->channels), p->is_integer != 0, p->is_half != 0,
                             p->sample_type == twopass_sample_byte);
      constexpr std::int64_t few_texels = std::int64_t{1} << 20;
      const bool is_limited = reception.most_bytes != std::numeric_limits<std::size_t>::max();
      const bool is_large_and_tiled = p->is_tiled != 0 && std::int64_t{p->width} * p->height > few_texels;
      reception.wants_tiles =
          reception.writer.size() > reception.most_bytes || (is_limited && is_large_and_tiled);
      if (reception.wants_tiles) return 0;
      reception.writer.allocate();
      return 1;
    } catch (...) {
      reception.error = std::current_exception();
      return 0;
    }
  }
  static void rows(void* self, int first, int count, const void* samples) {
    auto& reception = *static_cast<Reception*>(self);
    if (reception.error) return;
    try {
      reception.writer.rows(first, count, samples);
    } catch (...) {
      reception.error = std::current_exception();
    }
  }
  static void report(void* self, const void* text, std::size_t size) {
    std::string& problem = static_cast<Reception*>(self)->problem;
    problem.assign(static_cast<const char*>(text), size);
    std::ranges::replace(problem, '\n', ',');  // an error is one line
  }
};

ReadTexture read_source(const TwopassSource& source, const TexelOptions& options,
                        const std::optional<Primaries>& primaries, std::string_view where,
                        std::size_t most_bytes) {
  Reception reception{LevelWriter(options, primaries, where), most_bytes};
  const TwopassRowSink sink{&reception, Reception::begin, Reception::rows};
  const bool done = oiio_module().stream(&source, &sink, Reception::report) != 0;
  if (reception.error) std::rethrow_exception(reception.error);
  if (reception.wants_tiles) return reception.writer.tiled(source.path);
  if (!done) throw Error(where, "it cannot be read: " + reception.problem, "convert it to .png or .exr");
  return reception.writer.finish();
}

// OpenEXR alone does not need OpenImageIO, which takes long to load.
ReadTexture read_exr_texture(const fs::path& path, const TexelOptions& options,
                             const std::optional<Primaries>& primaries) {
  Image image = read_exr(path);
  LevelWriter writer(options, primaries, path.string());
  writer.begin(image.width, image.height, image.channels, false, false, false);
  writer.allocate();
  writer.rows(0, image.height, image.pixels.data());
  image = {};
  return writer.finish();
}

bool is_exr(const fs::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".exr";
}

}  // namespace

ReadTexture read_texture(const fs::path& path, const TexelOptions& options, std::size_t most_bytes) {
  check_regular_file(path);
  std::optional<Primaries> primaries;
  if (is_exr(path)) {
    const ExrFacts facts = exr_facts(path);
    primaries = facts.primaries;
    // As floats of three channels, all levels.
    const std::uint64_t bytes =
        16 * static_cast<std::uint64_t>(facts.size.x) * static_cast<std::uint64_t>(facts.size.y);
    if (bytes < most_bytes) return read_exr_texture(path, options, primaries);
  }
  return read_source({path.c_str(), nullptr, 0}, options, primaries, path.string(), most_bytes);
}

ReadTexture read_texture(std::span<const std::byte> encoded, const TexelOptions& options,
                         std::string_view where) {
  if (encoded.empty()) throw Error(where, "a picture of no bytes", "give another one");
  return read_source({nullptr, encoded.data(), encoded.size()}, options, {}, where,
                     std::numeric_limits<std::size_t>::max());
}

}  // namespace twopass
