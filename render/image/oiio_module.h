// The C interface between raster_file and the module twopass_oiio.so, the only code that knows OpenImageIO.
// Nothing throws across it: a function returns 1 for success, or 0 after describing the failure through
// `report`.
#pragma once

#include <cstddef>
#include <cstdint>

extern "C" {

/// Takes a text or bytes out of the module; `context` is the caller's.
using TwopassSink = void (*)(void* context, const void* bytes, std::size_t size);

/// Integers to encode. `format` is a file extension without dot; samples are RGB, 8 or 16 bits as `bits` says.
struct TwopassRaster {
  const char* format;
  int width;
  int height;
  int bits;
  const void* samples;
};

/// What the module tells of a picture before it asks for memory. `channels` are names separated by '\n'.
struct TwopassPicture {
  int width;
  int height;
  int channel_count;
  const char* channels;
  int is_integer;
};

/// Where the picture's width * height * channel_count floats shall go, or null to refuse it.
using TwopassAllocate = float* (*)(void* context, const TwopassPicture* picture);

/// `twopass_oiio_encode`: gives the encoded file to `sink`.
using TwopassOiioEncode = int (*)(const TwopassRaster* raster, TwopassSink sink, TwopassSink report,
                                  void* context);
/// `twopass_oiio_decode`: reads the file, integers scaled to [0,1], alpha not multiplied in.
using TwopassOiioDecode = int (*)(const char* path, TwopassAllocate allocate, TwopassSink report,
                                  void* context);
}
