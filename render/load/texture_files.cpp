#include "render/load/texture_files.h"

#include <algorithm>

#include "render/core/error.h"
#include "render/image/regular_file.h"
#include "render/image/tiled_levels.h"

namespace twopass {

namespace {

namespace fs = std::filesystem;

const C3f pink(1.0f, 0.0f, 1.0f);
constexpr std::string_view udim_mark = "<UDIM>";

std::string with_tile_number(std::string name, std::size_t mark, int number) {
  return name.replace(mark, udim_mark.size(), std::to_string(number));
}

Bitmap moved(const Bitmap& look, int number) {
  Bitmap tile = look;
  tile.wrap_u = tile.wrap_v = TextureWrap::clamp;
  tile.to_uv.c -= static_cast<float>((number - 1001) % 10);
  tile.to_uv.f += static_cast<float>((number - 1001) / 10);
  return tile;
}

}  // namespace

fs::path find_texture_file(const std::string& name, std::span<const fs::path> folders) {
  std::error_code ignored;
  for (const fs::path& folder : folders)
    if (fs::exists(folder / name, ignored)) return folder / name;
  for (const fs::path& folder : folders)
    if (const std::optional<fs::path> found = find_any_case(folder / name)) return *found;
  return {};
}

Texture TextureFiles::load(TextureRequest request) {
  if (request.texels.encoding.kind == TextureEncoding::Kind::color_space)
    request.texels.encoding.config = options_.color_config;
  Texture texture = request.look;
  std::shared_ptr<const TextureImage>& image = std::get<Bitmap>(texture).image;
  if (!request.encoded.empty()) {
    image = shared(read_texture(request.encoded, request.texels, request.where + ": " + request.name), request);
    return texture;
  }
  if (const std::size_t mark = request.name.find(udim_mark); mark != std::string::npos)
    return load_udim(request, mark);
  const fs::path path = find_texture_file(request.name, request.folders);
  if (path.empty()) return missing(request);
  image = of_file(path, request);
  return texture;
}

Texture TextureFiles::missing(const TextureRequest& request) {
  if (options_.missing == MissingTextures::pink) {
    const std::scoped_lock lock(mutex_);
    noticed_.push_back(request.where + ": there is no texture '" + request.name + "'; it is pink");
    return pink;
  }
  std::string searched;
  for (const fs::path& folder : request.folders)
    searched += (searched.empty() ? "" : ", ") + (folder / request.name).string();
  throw Error(request.where, "there is no texture '" + request.name + "'",
              "searched: " + searched + "; --missing-textures=pink renders without it");
}

Texture TextureFiles::load_udim(const TextureRequest& request, std::size_t mark) {
  Udim udim{request.look.to_uv, {}};
  for (int number = 1001; number <= 1999; ++number) {
    const std::string name = with_tile_number(request.name, mark, number);
    std::error_code ignored;
    const auto has_it = [&](const fs::path& folder) { return fs::exists(folder / name, ignored); };
    const auto folder = std::ranges::find_if(request.folders, has_it);
    if (folder == request.folders.end()) continue;
    udim.tiles.resize(static_cast<std::size_t>(number - 1000));
    udim.tiles.back() = moved(request.look, number);
    udim.tiles.back().image = of_file(*folder / name, request);
  }
  return udim.tiles.empty() ? missing(request) : udim;
}

std::shared_ptr<const TextureImage> TextureFiles::of_file(const fs::path& path, const TextureRequest& request) {
  std::error_code ignored;
  const fs::path canonical = fs::canonical(path, ignored);
  std::shared_ptr<Entry> entry;
  {
    const std::scoped_lock lock(mutex_);
    std::shared_ptr<Entry>& known = by_path_[{canonical.string(), request.texels}];
    if (!known) known = std::make_shared<Entry>();
    entry = known;
  }
  const std::scoped_lock lock(entry->reading);
  if (entry->image) return entry->image;
  try {
    const std::size_t memory = options_.memory_megabytes << 20;
    std::size_t most = memory / 16;
    {
      const std::scoped_lock counting(mutex_);
      most = std::min(most, memory / 2 - std::min(memory / 2, resident_bytes_));
    }
    return entry->image = shared(read_texture(path, request.texels, most), request);
  } catch (const Error& error) {
    throw Error(request.where, std::string("the texture cannot be read: ") + error.what(),
                "correct the file or its name");
  }
}

std::shared_ptr<const TextureImage> TextureFiles::shared(const ReadTexture& read,
                                                         const TextureRequest& request) {
  const std::scoped_lock lock(mutex_);
  if (read.not_finite > 0)
    noticed_.push_back(request.where + ": texture '" + request.name + "' holds " +
                       std::to_string(read.not_finite) + " values that are NaN or infinite; they read as 0");
  const auto [first, last] = by_content_.equal_range(read.image->content_hash());
  for (auto known = first; known != last; ++known)
    if (known->second->has_same_texels(*read.image)) return known->second;
  by_content_.emplace(read.image->content_hash(), read.image);
  resident_bytes_ += read.image->memory();
  if (read.image->is_tiled()) {
    limit_tile_memory(static_cast<double>(options_.memory_megabytes) / 2.0);
    tiled_.push_back({request.where + ": texture '" + request.name + "'", read.image});
  }
  return read.image;
}

std::vector<TiledTexture> TextureFiles::tiled() const {
  const std::scoped_lock lock(mutex_);
  return tiled_;
}

void TextureFiles::report(Notes& notes) const {
  const std::scoped_lock lock(mutex_);
  // Threads notice in any order.
  std::vector<std::string> sorted = noticed_;
  std::ranges::sort(sorted);
  for (std::string& note : sorted) notes.add(std::move(note));
}

}  // namespace twopass
