// The C interface of the module twopass_oiio.so, the only code that knows OpenImageIO.
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

/// How the samples of a picture are handed over.
enum TwopassSampleType { twopass_sample_byte, twopass_sample_float };

/// What the module tells of a picture before it asks for memory. `channels` are names separated by '\n'.
struct TwopassPicture {
  int width;
  int height;
  int channel_count;
  const char* channels;
  int is_integer;
  int is_half;      ///< stored as half floats
  int is_tiled;     ///< parts of it can be read alone
  int sample_type;  ///< TwopassSampleType
};

/// A picture to read: the file `path`; or `size` encoded bytes in memory, if `bytes` is not null.
struct TwopassSource {
  const char* path;
  const void* bytes;
  std::size_t size;
};

/// Takes a picture piece by piece. `begin` comes first; returning 0 it refuses the rest. Then `rows` comes with
/// `count` rows from `first` on, from top to bottom; the samples are interleaved.
struct TwopassRowSink {
  void* context;
  int (*begin)(void* context, const TwopassPicture* picture);
  void (*rows)(void* context, int first, int count, const void* samples);
};

/// Where the picture's width * height * channel_count floats shall go, or null to refuse it.
using TwopassAllocate = float* (*)(void* context, const TwopassPicture* picture);

/// `twopass_oiio_encode`: gives the encoded file to `sink`.
using TwopassOiioEncode = int (*)(const TwopassRaster* raster, TwopassSink sink, TwopassSink report,
                                  void* context);
/// `twopass_oiio_decode`: reads the file, integers scaled to [0,1], alpha not multiplied in.
using TwopassOiioDecode = int (*)(const char* path, TwopassAllocate allocate, TwopassSink report,
                                  void* context);
/// `twopass_oiio_stream`: reads a picture in strips, so that it is never in memory twice. Bytes stay bytes, all
/// other samples become floats, integers scaled to [0,1]; alpha not multiplied in. `report` gets the sink's
/// context.
using TwopassOiioStream = int (*)(const TwopassSource* source, const TwopassRowSink* sink, TwopassSink report);

/// Makes the values that a texture holds of `count` pixels of a picture. Called by any thread.
struct TwopassTexelConverter {
  void* context;
  void (*convert)(void* context, const float* pixels, std::size_t count, float* values);
  int channels;  ///< of the values
  int as_half;   ///< the cache keeps half floats, else floats
};

/// A picture in the tile cache. `levels` have sizes as in TextureImage, whether the file has them or not.
struct TwopassTiledPicture {
  void* image;
  int level_count;
  int widths[32], heights[32];
  int tile_widths[32], tile_heights[32];
};

/// A tile that stays in memory until it is released. Rows of `tile_width` pixels, half floats or floats.
struct TwopassTile {
  void* tile;
  const void* pixels;
};

/// `twopass_oiio_tile_cache_limit`: the most memory that tiles may take, in MB.
using TwopassOiioTileCacheLimit = void (*)(double megabytes);
/// `twopass_oiio_open_tiles`: opens a file for reading tile by tile. `converter` must live as long as the
/// process.
using TwopassOiioOpenTiles = int (*)(const char* path, const TwopassTexelConverter* converter,
                                     TwopassTiledPicture* picture, TwopassSink report, void* context);
/// `twopass_oiio_tile`: the tile that holds pixel (x, y) of a level. 0: it cannot be read.
using TwopassOiioTile = int (*)(void* image, int level, int x, int y, TwopassTile* tile);
/// `twopass_oiio_release_tile`.
using TwopassOiioReleaseTile = void (*)(void* tile);
}
