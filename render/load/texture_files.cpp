#include "render/load/texture_files.h"

#include <algorithm>

#include "render/core/error.h"
#include "render/load/text_file.h"

namespace twopass {

namespace {

namespace fs = std::filesystem;

const C3f pink(1.0f, 0.0f, 1.0f);

// The entry of `folder` that differs from `name` in case alone: the first by name, so that the order of the
// folder does not matter. Empty: there is none.
fs::path entry_in_any_case(const fs::path& folder, const std::string& name) {
  const std::string wanted = lower_case(name);
  fs::path best;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder.empty() ? fs::path(".") : folder, ignored)) {
    const fs::path found = entry.path().filename();
    if (lower_case(found.string()) == wanted && (best.empty() || found < best)) best = found;
  }
  return best.empty() ? best : folder / best;
}

fs::path in_any_case(const fs::path& path) {
  std::error_code ignored;
  fs::path found = path.root_path();
  for (const fs::path& part : path.relative_path()) {
    const fs::path exact = found / part;
    found = fs::exists(exact, ignored) ? exact : entry_in_any_case(found, part.string());
    if (found.empty()) return found;
  }
  return found;
}

}  // namespace

fs::path find_texture_file(const std::string& name, std::span<const fs::path> folders) {
  std::error_code ignored;
  for (const fs::path& folder : folders)
    if (fs::exists(folder / name, ignored)) return folder / name;
  std::string slashed = name;
  std::ranges::replace(slashed, '\\', '/');
  for (const fs::path& folder : folders)
    if (const fs::path found = in_any_case(folder / slashed); !found.empty()) return found;
  return {};
}

Texture TextureFiles::load(const TextureRequest& request) {
  Bitmap bitmap = request.look;
  if (!request.encoded.empty()) {
    bitmap.image =
        shared(read_texture(request.encoded, request.texels, request.where + ": " + request.name), request);
    return bitmap;
  }
  const fs::path path = find_texture_file(request.name, request.folders);
  if (path.empty()) {
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
  bitmap.image = of_file(path, request);
  return bitmap;
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
    return entry->image = shared(read_texture(path, request.texels), request);
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
  return read.image;
}

void TextureFiles::report(Notes& notes) const {
  const std::scoped_lock lock(mutex_);
  // Threads notice in any order.
  std::vector<std::string> sorted = noticed_;
  std::ranges::sort(sorted);
  for (std::string& note : sorted) notes.add(std::move(note));
}

}  // namespace twopass
