#include "render/image/oiio_loader.h"

#include <filesystem>
#include <string>
#include <system_error>

#include <dlfcn.h>

#include "render/core/error.h"

namespace twopass {
namespace {

namespace fs = std::filesystem;

constexpr const char* module_name = "twopass_oiio.so";

// Beside the program (build folder) or in lib/twopass of the prefix (installed).
fs::path find_module() {
  std::error_code ignored;
  const fs::path folder = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  for (const fs::path& place : {folder / module_name, folder.parent_path() / "lib" / "twopass" / module_name})
    if (fs::exists(place, ignored)) return place;
  throw Error(module_name,
              "the module for PNG, JPEG and TIFF is neither in " + folder.string() + " nor in " +
                  (folder.parent_path() / "lib" / "twopass").string(),
              "build the target twopass_oiio or install the program, or use .exr");
}

template <class Function>
void set(Function& function, void* library, const char* name, const fs::path& path) {
  void* address = ::dlsym(library, name);
  if (address == nullptr)
    throw Error(path.string(), std::string("it lacks ") + name, "build the program and its module together");
  function = reinterpret_cast<Function>(address);
}

}  // namespace

const OiioModule& oiio_module() {
  // For the life of the process: OpenImageIO keeps threads that must not lose their code.
  static const OiioModule loaded = [] {
    const fs::path path = find_module();
    void* library = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr)
      throw Error(path.string(), std::string("it cannot be loaded: ") + ::dlerror(),
                  "install OpenImageIO, or use .exr");
    OiioModule module;
    set(module.encode, library, "twopass_oiio_encode", path);
    set(module.decode, library, "twopass_oiio_decode", path);
    set(module.stream, library, "twopass_oiio_stream", path);
    set(module.tile_cache_limit, library, "twopass_oiio_tile_cache_limit", path);
    set(module.open_tiles, library, "twopass_oiio_open_tiles", path);
    set(module.tile, library, "twopass_oiio_tile", path);
    set(module.release_tile, library, "twopass_oiio_release_tile", path);
    return module;
  }();
  return loaded;
}

}  // namespace twopass
