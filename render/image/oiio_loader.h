// Opens the module twopass_oiio.so, on first use: OpenImageIO takes 0.2 s to load.
#pragma once

#include "render/image/oiio_module.h"

namespace twopass {

/// The functions of the module.
struct OiioModule {
  TwopassOiioEncode encode;
  TwopassOiioDecode decode;
  TwopassOiioStream stream;
  TwopassOiioTileCacheLimit tile_cache_limit;
  TwopassOiioOpenTiles open_tiles;
  TwopassOiioTile tile;
  TwopassOiioReleaseTile release_tile;
};

/// The module, loaded once and for the life of the process. Throws Error when it is not there. Thread-safe.
const OiioModule& oiio_module();

}  // namespace twopass
