// The images that scenes name: found, read once however often they are used, and made into textures. The same
// for every scene format.
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "materials/texture.h"
#include "render/core/names.h"
#include "render/image/read_texture.h"
#include "render/load/notes.h"

namespace twopass {

/// What becomes of a texture whose file is not there.
enum class MissingTextures { error, pink };
inline constexpr Named<MissingTextures> missing_textures_names[] = {
    {"error", MissingTextures::error},
    {"pink", MissingTextures::pink},
};

struct TextureOptions {
  MissingTextures missing = MissingTextures::error;
  /// Images of up to a sixteenth of it stay in memory, together up to half of it; the rest is read tile by tile
  /// through a cache, which may take the other half.
  std::size_t memory_megabytes = 1024;
  /// File of the OpenColorIO configuration that knows their colour spaces, as in DisplayOptions.
  std::string color_config{};
};

/// An image that is read while the picture is rendered: what is wrong with it shows only then.
struct TiledTexture {
  std::string name;  ///< file:line that asks, and the file
  std::shared_ptr<const TextureImage> image;
};

/// A texture as a scene asks for it.
struct TextureRequest {
  std::string name;                              ///< of the file as the scene writes it; may hold <UDIM>
  std::vector<std::filesystem::path> folders{};  ///< where relative names are looked for, in this order
  std::span<const std::byte> encoded{};  ///< an image inside of the scene's file: then `name` is for messages
  std::string where;                     ///< file:line that asks, or the file: for messages
  TexelOptions texels{};                 ///< what its values mean
  Bitmap look{};                         ///< how it lies on surfaces: everything but the image
};

/// Thread-safe.
class TextureFiles {
 public:
  explicit TextureFiles(const TextureOptions& options) : options_(options) {}

  /// The texture. Images of the same file and meaning are shared, and so are those of other files with the same
  /// texels. Throws Error naming the file and who asked for it when it is not there (unless missing ones are
  /// pink), is not a regular file, or cannot be read.
  Texture load(TextureRequest request);
  /// Those that are read while rendering.
  [[nodiscard]] std::vector<TiledTexture> tiled() const;
  /// Adds what was noticed.
  void report(Notes& notes) const;

 private:
  using Key = std::pair<std::string, TexelOptions>;  // canonical path
  Texture missing(const TextureRequest& request);
  Texture load_udim(const TextureRequest& request, std::size_t mark);
  std::shared_ptr<const TextureImage> of_file(const std::filesystem::path& path, const TextureRequest& request);
  std::shared_ptr<const TextureImage> shared(const ReadTexture& read, const TextureRequest& request);

  struct Entry {
    std::mutex reading;
    std::shared_ptr<const TextureImage> image;
  };
  TextureOptions options_;
  mutable std::mutex mutex_;
  std::map<Key, std::shared_ptr<Entry>> by_path_;
  std::multimap<std::uint64_t, std::shared_ptr<const TextureImage>> by_content_;
  std::size_t resident_bytes_ = 0;
  std::vector<TiledTexture> tiled_;
  std::vector<std::string> noticed_;
};

/// The path of the first file called `name` in `folders`; an absolute name stays itself. Where there is none of
/// that very name, back-slashes count as slashes and upper and lower case as the same. Empty: there is none.
std::filesystem::path find_texture_file(const std::string& name,
                                        std::span<const std::filesystem::path> folders);

}  // namespace twopass
