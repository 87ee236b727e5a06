// The module twopass_oiio.so: encodes and decodes pictures with OpenImageIO behind a C interface.
#include "render/image/oiio_module.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <sys/mman.h>
#include <unistd.h>

#include "render/image/oiio_failure.h"

namespace {

void report_text(TwopassSink report, void* context, const std::string& text) {
  report(context, text.data(), text.size());
}

OIIO::ImageSpec spec_for(const TwopassRaster& raster) {
  OIIO::ImageSpec spec(raster.width, raster.height, 3,
                       raster.bits == 16 ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  // Left to itself OpenImageIO stamps the hour, and identical pictures would give different files.
  spec.attribute("DateTime", "1970:01:01 00:00:00");
  spec.attribute("Software", "twopass");
  const bool is_jpeg = std::string(raster.format).starts_with("jp");
  spec.attribute("Compression", is_jpeg ? "jpeg:95" : "zip");
  if (is_jpeg) spec.attribute("jpeg:subsampling", "4:4:4");
  return spec;
}

// A file in memory: no disk can be full, and what reaches the disk is written by one function for all formats.
// A real descriptor instead of OpenImageIO's own IOProxy, through which its TIFF writer before 2.5.13 makes
// broken files (OpenImageIO pull request 4300).
class MemoryFile {
 public:
  MemoryFile() : descriptor_(::memfd_create("picture", MFD_CLOEXEC)) {
    if (descriptor_ < 0) fail("no memory for the encoded picture");
  }
  ~MemoryFile() { ::close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }
  [[nodiscard]] std::vector<unsigned char> content() const {
    std::vector<unsigned char> bytes(static_cast<std::size_t>(::lseek(descriptor_, 0, SEEK_END)));
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t got =
          ::pread(descriptor_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(done));
      if (got <= 0) fail("the encoded picture cannot be read back");
      done += static_cast<std::size_t>(got);
    }
    return bytes;
  }

 private:
  int descriptor_;
};

std::vector<unsigned char> encode(const TwopassRaster& raster) {
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(raster.format);
  if (!output) fail(OIIO::geterror());
  const MemoryFile file;
  const OIIO::TypeDesc type = raster.bits == 16 ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::UINT8;
  const bool done = output->open(file.path(), spec_for(raster)) && output->write_image(type, raster.samples) &&
                    output->close();
  // PNG's writer may return true after a failure; only the message tells.
  const std::string message = output->geterror();
  if (!done || !message.empty()) fail(message);
  return file.content();
}

std::string names_of_channels(const OIIO::ImageSpec& spec) {
  static const char* const usual[] = {"Y", "Y\nA", "R\nG\nB", "R\nG\nB\nA"};
  // Formats without names of their own invent some ("channel0"); their order is what matters.
  if (spec.nchannels <= 4) return usual[spec.nchannels - 1];
  std::string names;
  for (const std::string& name : spec.channelnames) names += (names.empty() ? "" : "\n") + name;
  return names;
}

void decode(const char* path, TwopassAllocate allocate, void* context) {
  OIIO::ImageSpec hints;
  hints.attribute("oiio:UnassociatedAlpha", 1);
  const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path, &hints);
  if (!input) fail(OIIO::geterror());
  const OIIO::ImageSpec& spec = input->spec();
  if (spec.deep || spec.nchannels < 1) fail("it holds no flat picture");
  const std::string names = names_of_channels(spec);
  const bool is_integer = !spec.format.is_floating_point();
  const TwopassPicture picture{spec.width, spec.height, spec.nchannels,      names.c_str(), is_integer ? 1 : 0,
                               0,          0,           twopass_sample_float};
  float* pixels = allocate(context, &picture);
  if (pixels == nullptr) fail("its size is refused");
  const bool done = input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, pixels);
  const std::string message = input->geterror();
  if (!done) fail(message);
}

// The name of a picture in memory: by its extension OpenImageIO finds the reader.
const char* name_of_encoded(const unsigned char* bytes, std::size_t size) {
  const auto starts_with = [&](std::string_view magic, std::size_t at = 0) {
    return size >= at + magic.size() && std::memcmp(bytes + at, magic.data(), magic.size()) == 0;
  };
  if (starts_with("\x89PNG")) return "embedded.png";
  if (starts_with("\xff\xd8\xff")) return "embedded.jpg";
  if (starts_with("RIFF") && starts_with("WEBP", 8)) return "embedded.webp";
  fail("it is neither PNG, JPEG nor WebP");
}

void stream(const TwopassSource& source, const TwopassRowSink& sink) {
  OIIO::ImageSpec hints;
  hints.attribute("oiio:UnassociatedAlpha", 1);
  const auto* bytes = static_cast<const unsigned char*>(source.bytes);
  OIIO::Filesystem::IOMemReader memory(bytes, source.size);
  // With hints, the argument of `open` for it is not looked at.
  OIIO::Filesystem::IOProxy* const proxy = &memory;
  if (bytes) hints.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  const std::unique_ptr<OIIO::ImageInput> input =
      OIIO::ImageInput::open(bytes ? name_of_encoded(bytes, source.size) : source.path, &hints);
  if (!input) fail(OIIO::geterror());
  const OIIO::ImageSpec spec = input->spec();
  if (spec.deep || spec.nchannels < 1) fail("it holds no flat picture");
  const bool is_byte = spec.format == OIIO::TypeDesc::UINT8 && spec.channelformats.empty();
  const std::string names = names_of_channels(spec);
  const TwopassPicture picture{spec.width,
                               spec.height,
                               spec.nchannels,
                               names.c_str(),
                               spec.format.is_floating_point() ? 0 : 1,
                               spec.format == OIIO::TypeDesc::HALF ? 1 : 0,
                               spec.tile_width > 0 ? 1 : 0,
                               is_byte ? twopass_sample_byte : twopass_sample_float};
  if (!sink.begin(sink.context, &picture)) fail("its size is refused");
  const int strip = spec.tile_width > 0 ? spec.tile_height : 64;
  const OIIO::TypeDesc type = is_byte ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::FLOAT;
  std::vector<unsigned char> samples(type.size() * static_cast<std::size_t>(spec.nchannels) *
                                     static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(strip));
  for (int y = 0; y < spec.height; y += strip) {
    const int count = std::min(strip, spec.height - y), first = spec.y + y;
    const bool done = spec.tile_width > 0
                          ? input->read_tiles(0, 0, spec.x, spec.x + spec.width, first, first + count, spec.z,
                                              spec.z + 1, 0, spec.nchannels, type, samples.data())
                          : input->read_scanlines(0, 0, first, first + count, spec.z, 0, spec.nchannels, type,
                                                  samples.data());
    if (!done) fail(input->geterror());
    sink.rows(sink.context, y, count, samples.data());
  }
}

}  // namespace

extern "C" {

int twopass_oiio_stream(const TwopassSource* source, const TwopassRowSink* sink, TwopassSink report) {
  try {
    stream(*source, *sink);
    return 1;
  } catch (const std::exception& e) {
    report_text(report, sink->context, e.what());
    return 0;
  }
}

int twopass_oiio_encode(const TwopassRaster* raster, TwopassSink sink, TwopassSink report, void* context) {
  try {
    const std::vector<unsigned char> bytes = encode(*raster);
    sink(context, bytes.data(), bytes.size());
    return 1;
  } catch (const std::exception& e) {
    report_text(report, context, e.what());
    return 0;
  }
}

int twopass_oiio_decode(const char* path, TwopassAllocate allocate, TwopassSink report, void* context) {
  try {
    decode(path, allocate, context);
    return 1;
  } catch (const std::exception& e) {
    report_text(report, context, e.what());
    return 0;
  }
}
}
