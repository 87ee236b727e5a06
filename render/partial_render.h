// Partial pictures: what a render, or a share of one, has sampled so far, in a file that can be continued and
// merged with others. One kind of file is checkpoint, slice and merged part.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "render/image/film_file.h"
#include "render/render_image.h"

namespace twopass {

/// What all parts of one render have in common; parts that differ in it are of different pictures.
struct RenderIdentity {
  std::string version;   ///< of the program
  std::string scene;     ///< fingerprint
  std::string solution;  ///< fingerprint of the radiosity solution; empty where none is read
  std::vector<std::pair<std::string, std::string>> settings;  ///< names and values, for messages too

  friend bool operator==(const RenderIdentity&, const RenderIdentity&) = default;
};

/// What is in a partial picture beside its film.
struct PartialRender {
  RenderIdentity identity;
  std::vector<SampleRange> ranges;  ///< numbers of samples that its pixels have, at most; ascending, apart
  std::uint32_t all_samples = 0;    ///< of a pixel in all parts; 0: not known in advance
  int footprint_samples = 0;        ///< of a pixel, for which textures are filtered
  bool can_resume = true;           ///< `state` says how to go on
  RenderState state{};
};

/// Throws Error at `where`, naming the first difference, unless both belong to one render.
void check_same_render(const RenderIdentity& part, const std::string& where, const RenderIdentity& other,
                       const std::string& other_where);

/// The ranges of both, with neighbours joined. Throws Error at `where` when they overlap.
std::vector<SampleRange> joined_ranges(const std::vector<SampleRange>& a, const std::vector<SampleRange>& b,
                                       const std::string& where);
/// "0 to 7 and 16 to 23"
std::string ranges_text(const std::vector<SampleRange>& ranges);

/// Writes film and description. The options are those of a finished picture, and kept. What was there is kept
/// as `previous` unless that is empty. Throws Error.
void save_partial(const std::filesystem::path& path, const Film& film, const PartialRender& part,
                  const ExrOptions& options, const std::filesystem::path& previous = {});

/// A file of save_partial.
class PartialFile {
 public:
  /// Reads all but the film. Throws Error when the file cannot be read or is no partial picture of this
  /// program.
  explicit PartialFile(const std::filesystem::path& path);

  [[nodiscard]] const PartialRender& part() const { return part_; }
  [[nodiscard]] int width() const { return film_.width(); }
  [[nodiscard]] int height() const { return film_.height(); }
  /// What its film keeps beside the picture.
  [[nodiscard]] const FilmLayout& layout() const { return layout_; }
  /// Those of a finished picture.
  [[nodiscard]] const ExrOptions& options() const { return options_; }
  /// Adds its film to another of this layout, and with `plan` says where its render stood. Throws Error.
  void merge_into(Film& film, PlanState* plan = nullptr) const;

 private:
  FilmFile film_;
  PartialRender part_;
  FilmLayout layout_;
  ExrOptions options_;
};

}  // namespace twopass
