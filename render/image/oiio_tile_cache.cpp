// The module's half that reads pictures tile by tile through OpenImageIO's cache.
#include <algorithm>
#include <atomic>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/imageio.h>

#include "render/image/oiio_failure.h"
#include "render/image/oiio_module.h"

namespace {

using OIIO::ImageCache;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

constexpr const char* converter_attribute = "twopass:converter";
constexpr const char* path_attribute = "twopass:path";

// A file whose pixels are what the converter makes of them: the cache holds, and averages, linear values.
class ConvertedInput final : public OIIO::ImageInput {
 public:
  static ImageInput* create() { return new ConvertedInput; }
  const char* format_name() const override { return "twopass"; }
  int supports(OIIO::string_view) const override { return 0; }

  bool open(const std::string&, ImageSpec&) override { return false; }
  bool open(const std::string&, ImageSpec& spec, const ImageSpec& config) override {
    const OIIO::ParamValue* converter = config.find_attribute(converter_attribute, TypeDesc::PTR);
    if (!converter) return false;
    converter_ = *static_cast<const TwopassTexelConverter* const*>(converter->data());
    ImageSpec hints;
    hints.attribute("oiio:UnassociatedAlpha", 1);
    file_ = ImageInput::open(std::string(config.get_string_attribute(path_attribute)), &hints);
    if (!file_) {
      errorfmt("{}", OIIO::geterror());
      return false;
    }
    describe();
    spec = m_spec;
    return true;
  }
  bool close() override {
    if (file_) file_->close();
    file_.reset();
    return true;
  }
  int current_subimage() const override { return file_ ? file_->current_subimage() : 0; }
  int current_miplevel() const override { return file_ ? file_->current_miplevel() : 0; }
  bool seek_subimage(int subimage, int miplevel) override {
    if (!file_ || subimage != 0 || !file_->seek_subimage(0, miplevel)) return false;
    describe();
    return true;
  }
  bool read_native_scanline(int subimage, int miplevel, int y, int z, void* data) override {
    lock_guard lock(*this);
    if (!seek_subimage(subimage, miplevel)) return false;
    stored_.resize(static_cast<std::size_t>(m_spec.width) * static_cast<std::size_t>(file_->spec().nchannels));
    if (!file_->read_scanline(y, z, TypeDesc::FLOAT, stored_.data())) return fail();
    convert(static_cast<std::size_t>(m_spec.width), data);
    return true;
  }
  bool read_native_tile(int subimage, int miplevel, int x, int y, int z, void* data) override {
    lock_guard lock(*this);
    if (!seek_subimage(subimage, miplevel)) return false;
    const auto pixels = static_cast<std::size_t>(m_spec.tile_pixels());
    stored_.resize(pixels * static_cast<std::size_t>(file_->spec().nchannels));
    if (!file_->read_tile(x, y, z, TypeDesc::FLOAT, stored_.data())) return fail();
    convert(pixels, data);
    return true;
  }

 private:
  bool fail() {
    errorfmt("{}", file_->geterror());
    return false;
  }
  void describe() {
    const ImageSpec& spec = file_->spec();
    m_spec = ImageSpec(spec.width, spec.height, converter_->channels,
                       converter_->as_half ? TypeDesc::HALF : TypeDesc::FLOAT);
    m_spec.x = spec.x;
    m_spec.y = spec.y;
    m_spec.full_x = spec.x;
    m_spec.full_y = spec.y;
    m_spec.full_width = spec.width;
    m_spec.full_height = spec.height;
    m_spec.tile_width = spec.tile_width;
    m_spec.tile_height = spec.tile_height;
    m_spec.tile_depth = spec.tile_depth;
  }
  void convert(std::size_t pixels, void* data) {
    const auto count = pixels * static_cast<std::size_t>(converter_->channels);
    if (!converter_->as_half) {
      converter_->convert(converter_->context, stored_.data(), pixels, static_cast<float*>(data));
      return;
    }
    values_.resize(count);
    converter_->convert(converter_->context, stored_.data(), pixels, values_.data());
    OIIO::convert_types(TypeDesc::FLOAT, values_.data(), TypeDesc::HALF, data, static_cast<int>(count));
  }

  const TwopassTexelConverter* converter_ = nullptr;
  std::unique_ptr<ImageInput> file_;
  std::vector<float> stored_, values_;
};

ImageCache& cache() {
  static ImageCache* const shared = [] {
    ImageCache* created = ImageCache::create(false);
    created->attribute("autotile", 64);
    created->attribute("automip", 1);
    created->attribute("accept_untiled", 1);
    created->attribute("accept_unmipped", 1);
    created->attribute("failure_retries", 0);
    return created;
  }();
  return *shared;
}

struct CachedImage {
  ImageCache::ImageHandle* handle;
  int x, y;  // of the first pixel
};

void open_tiles(const char* path, const TwopassTexelConverter* converter, TwopassTiledPicture& picture) {
  // One file may hold several textures: each reading of it has a name of its own.
  static std::atomic<int> count{0};
  const OIIO::ustring name(std::string(path) + "#" + std::to_string(count++));
  ImageSpec config;
  config.attribute(converter_attribute, TypeDesc::PTR, &converter);
  config.attribute(path_attribute, path);
  if (!cache().add_file(name, ConvertedInput::create, &config)) fail(cache().geterror());
  ImageCache::ImageHandle* handle = cache().get_image_handle(name);
  if (!handle || !cache().good(handle)) fail(cache().geterror());
  int levels = 0;
  if (!cache().get_image_info(handle, nullptr, 0, 0, OIIO::ustring("miplevels"), TypeDesc::INT, &levels))
    fail(cache().geterror());
  picture.level_count = std::min(levels, 32);
  for (int i = 0; i < picture.level_count; ++i) {
    const ImageSpec* spec = cache().imagespec(handle, nullptr, 0, i);
    if (!spec) fail(cache().geterror());
    picture.widths[i] = spec->width;
    picture.heights[i] = spec->height;
    picture.tile_widths[i] = spec->tile_width;
    picture.tile_heights[i] = spec->tile_height;
  }
  const ImageSpec* finest = cache().imagespec(handle, nullptr, 0, 0);
  // For as long as the cache, which keeps its handles until the program ends.
  static std::mutex mutex;
  static std::deque<CachedImage> images;
  const std::lock_guard lock(mutex);
  picture.image = &images.emplace_back(CachedImage{handle, finest->x, finest->y});
}

}  // namespace

extern "C" {

void twopass_oiio_tile_cache_limit(double megabytes) {
  cache().attribute("max_memory_MB", static_cast<float>(megabytes));
}

int twopass_oiio_open_tiles(const char* path, const TwopassTexelConverter* converter,
                            TwopassTiledPicture* picture, TwopassSink report, void* context) {
  try {
    open_tiles(path, converter, *picture);
    return 1;
  } catch (const std::exception& e) {
    const std::string text = e.what();
    report(context, text.data(), text.size());
    return 0;
  }
}

int twopass_oiio_tile(void* image, int level, int x, int y, TwopassTile* tile) {
  const CachedImage& cached = *static_cast<const CachedImage*>(image);
  const bool is_finest = level == 0;
  tile->tile = cache().get_tile(cached.handle, nullptr, 0, level, x + (is_finest ? cached.x : 0),
                                y + (is_finest ? cached.y : 0), 0);
  if (tile->tile == nullptr) {
    (void)cache().geterror();  // or it would be printed at the end
    return 0;
  }
  TypeDesc type;
  tile->pixels = cache().tile_pixels(static_cast<ImageCache::Tile*>(tile->tile), type);
  return tile->pixels ? 1 : 0;
}

void twopass_oiio_release_tile(void* tile) { cache().release_tile(static_cast<ImageCache::Tile*>(tile)); }
}
