#include "render/image/exr_planes.h"

#include <exception>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>

#include "render/core/error.h"
#include "render/image/atomic_file.h"
#include "render/image/exr_header.h"

namespace twopass {
namespace {

namespace fs = std::filesystem;

constexpr int rows_at_once = 16;

// Keeps our own error, for which OpenEXR would have other words.
class FileStream : public Imf::OStream {
 public:
  FileStream(const fs::path& path, AtomicWriter& writer) : OStream(path.c_str()), writer_(writer) {}
  void write(const char* bytes, int count) override {
    guarded([&] { writer_.write(std::as_bytes(std::span(bytes, static_cast<std::size_t>(count)))); });
  }
  std::uint64_t tellp() override { return writer_.position(); }
  void seekp(std::uint64_t position) override {
    guarded([&] { writer_.seek(position); });
  }
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  template <class Action>
  void guarded(const Action& action) {
    rethrow();  // nothing is written behind a failure
    try {
      action();
    } catch (...) {
      failure_ = std::current_exception();
      throw;
    }
  }
  AtomicWriter& writer_;
  std::exception_ptr failure_;
};

Imf::PixelType type_of(const ExrPlane& plane) { return plane.is_float ? Imf::FLOAT : Imf::UINT; }

// Rows [y, y + rows_at_once) of all planes in memory, row by row and in each plane by plane.
class Rows {
 public:
  Rows(std::span<const ExrPlane> planes, const Imath::Box2i& window)
      : planes_(planes),
        window_(window),
        width_(static_cast<std::size_t>(window.max.x - window.min.x) + 1),
        words_(planes.size() * width_ * rows_at_once) {}
  std::span<std::uint32_t> row(int of_chunk) {
    return std::span(words_).subspan(static_cast<std::size_t>(of_chunk) * planes_.size() * width_,
                                     planes_.size() * width_);
  }
  // As OpenEXR sees them when their first row is row `y` of the picture.
  Imf::FrameBuffer frame(int y) {
    Imf::FrameBuffer frame;
    const V2i origin(window_.min.x, window_.min.y + y);
    for (std::size_t p = 0; p < planes_.size(); ++p)
      frame.insert(planes_[p].name,
                   Imf::Slice::Make(type_of(planes_[p]), words_.data() + p * width_, origin,
                                    static_cast<std::int64_t>(width_), rows_at_once, sizeof(std::uint32_t),
                                    planes_.size() * width_ * sizeof(std::uint32_t)));
    return frame;
  }

 private:
  std::span<const ExrPlane> planes_;
  Imath::Box2i window_;
  std::size_t width_;
  std::vector<std::uint32_t> words_;
};

}  // namespace

void write_exr_planes(const fs::path& path, std::span<const ExrPlane> planes, int width, int height,
                      const ExrOptions& options, const FillRow& fill, const fs::path& previous) {
  AtomicWriter writer(path);
  FileStream stream(path, writer);
  try {
    Imf::Header header = picture_header(width, height, options);
    header.compression() = Imf::NO_COMPRESSION;
    for (const ExrPlane& plane : planes) header.channels().insert(plane.name, Imf::Channel(type_of(plane)));
    Imf::OutputFile file(stream, header);
    Rows rows(planes, header.dataWindow());
    for (int y = 0; y < height; y += rows_at_once) {
      const int count = std::min(rows_at_once, height - y);
      for (int i = 0; i < count; ++i) fill(y + i, rows.row(i));
      file.setFrameBuffer(rows.frame(y));
      file.writePixels(count);
    }
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    stream.rethrow();
    throw Error(path.string(), std::string("OpenEXR cannot encode it: ") + e.what(),
                "check the names of layers and attributes");
  }
  stream.rethrow();  // the table of lines is written last, by a destructor
  writer.commit(previous);
}

struct ExrPlanesFile::Impl {
  explicit Impl(const fs::path& path_) : path(path_), file(path_.c_str()) {}
  fs::path path;
  mutable Imf::InputFile file;
  Imath::Box2i window;
  std::vector<ExrPlane> planes{};
  ExrOptions options{};
};

ExrPlanesFile::ExrPlanesFile(const fs::path& path) {
  check_is_exr(path);
  in_our_words(path, [&] {
    impl_ = std::make_unique<Impl>(path);
    const Imf::Header& header = impl_->file.header();
    impl_->window = header.dataWindow();
    impl_->options = options_of(header);
    for (auto it = header.channels().begin(); it != header.channels().end(); ++it)
      impl_->planes.push_back({it.name(), it.channel().type == Imf::FLOAT});
    // A damaged header may promise any size. What was written here is not compressed, so it cannot be smaller
    // than this.
    const double bytes = static_cast<double>(width()) * height() * static_cast<double>(planes().size()) * 4.0;
    if (!impl_->file.isComplete() ||
        (header.compression() == Imf::NO_COMPRESSION && static_cast<double>(fs::file_size(path)) < bytes))
      throw Error(path.string(), "it is incomplete, its writer was probably interrupted",
                  "write the file again");
  });
}
ExrPlanesFile::~ExrPlanesFile() = default;
ExrPlanesFile::ExrPlanesFile(ExrPlanesFile&&) noexcept = default;
ExrPlanesFile& ExrPlanesFile::operator=(ExrPlanesFile&&) noexcept = default;

int ExrPlanesFile::width() const { return impl_->window.max.x - impl_->window.min.x + 1; }
int ExrPlanesFile::height() const { return impl_->window.max.y - impl_->window.min.y + 1; }
const std::vector<ExrPlane>& ExrPlanesFile::planes() const { return impl_->planes; }
const ExrOptions& ExrPlanesFile::options() const { return impl_->options; }

void ExrPlanesFile::read(std::span<const ExrPlane> planes, const TakeRow& take) const {
  for (const ExrPlane& plane : planes)
    if (std::find(impl_->planes.begin(), impl_->planes.end(), plane) == impl_->planes.end())
      throw Error(impl_->path.string(), "it has no channel " + plane.name,
                  "give a file that this program wrote");
  Rows rows(planes, impl_->window);
  for (int y = 0; y < height(); y += rows_at_once) {
    const int count = std::min(rows_at_once, height() - y);
    in_our_words(impl_->path, [&] {
      impl_->file.setFrameBuffer(rows.frame(y));
      impl_->file.readPixels(impl_->window.min.y + y, impl_->window.min.y + y + count - 1);
    });
    for (int i = 0; i < count; ++i) take(y + i, rows.row(i));
  }
}

}  // namespace twopass
