#include "render/image/film_file.h"

#include <bit>

#include "render/core/error.h"
#include "render/core/sampler.h"

namespace twopass {
namespace {

namespace fs = std::filesystem;

constexpr const char* mark_name = "film.mark";

// Calls visit(name, number) for everything that a pixel holds: the one list of it.
template <class Pixel, class Visit>
void visit_numbers(Pixel& pixel, const Visit& visit) {
  const auto color = [&](const char* red, const char* green, const char* blue, auto& c) {
    visit(red, c.x);
    visit(green, c.y);
    visit(blue, c.z);
  };
  color("film.sum.R", "film.sum.G", "film.sum.B", pixel.sum);
  color("film.plain.R", "film.plain.G", "film.plain.B", pixel.plain);
  color("film.spread.R", "film.spread.G", "film.spread.B", pixel.spread);
  visit("film.alpha", pixel.alpha);
  visit("film.plainAlpha", pixel.plain_alpha);
  visit("film.weight", pixel.weight);
  visit("film.samples", pixel.samples);
  visit("film.batches", pixel.batches);
}

template <class Number>
std::uint64_t bits_of(const Number& number) {
  if constexpr (std::is_same_v<Number, double>)
    return std::bit_cast<std::uint64_t>(number);
  else
    return number;
}

template <class Number>
void set_bits(Number& number, std::uint64_t bits) {
  if constexpr (std::is_same_v<Number, double>)
    number = std::bit_cast<double>(bits);
  else
    number = static_cast<Number>(bits);
}

std::vector<ExrPlane> planes_of_film(bool marks) {
  std::vector<ExrPlane> planes{{"R", true}, {"G", true}, {"B", true}, {"A", true}};
  visit_numbers(static_cast<const FilmPixel&>(FilmPixel()), [&](const char* name, const auto&) {
    planes.push_back({std::string(name) + ".hi"});
    planes.push_back({std::string(name) + ".lo"});
  });
  if (marks) planes.push_back({mark_name});
  planes.push_back({"film.check"});
  return planes;
}

// A hash of all words of a pixel but the last, and of where it is.
std::uint32_t check_sum(std::span<const std::uint32_t> words, std::size_t width, std::size_t x, int y) {
  std::uint64_t state = hash_words(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
  for (std::size_t i = x; i + width < words.size(); i += width)
    state = (std::rotl(state, 23) ^ words[i]) * 0x9e3779b97f4a7c15u;
  return static_cast<std::uint32_t>(hash_word(state) >> 32);
}

}  // namespace

void write_film(const fs::path& path, const Film& film, std::span<const std::uint8_t> marks,
                const ExrOptions& options, const fs::path& previous) {
  const std::vector<ExrPlane> planes = planes_of_film(!marks.empty());
  const auto width = static_cast<std::size_t>(film.width());
  write_exr_planes(
      path, planes, film.width(), film.height(), options,
      [&](int y, std::span<std::uint32_t> words) {
        for (std::size_t x = 0; x < width; ++x) {
          std::size_t at = x;
          const auto put = [&](std::uint32_t word) {
            words[at] = word;
            at += width;
          };
          const FilmPixel& pixel = film.pixel(static_cast<int>(x), y);
          for (const float value : pixel.resolved())
            put(std::bit_cast<std::uint32_t>(std::isfinite(value) ? value : 0.0f));
          visit_numbers(pixel, [&](const char*, const auto& number) {
            put(static_cast<std::uint32_t>(bits_of(number) >> 32));
            put(static_cast<std::uint32_t>(bits_of(number)));
          });
          if (!marks.empty()) put(marks[static_cast<std::size_t>(y) * width + x]);
          put(check_sum(words, width, x, y));
        }
      },
      previous);
}

FilmFile::FilmFile(const fs::path& path) : path_(path), file_(path) {
  for (const ExrPlane& plane : planes_of_film(false))
    if (std::find(file_.planes().begin(), file_.planes().end(), plane) == file_.planes().end())
      throw Error(path.string(), "it is a finished picture, not a partial one",
                  "give a file of --slice or --checkpoint");
}

bool FilmFile::has_marks() const {
  return std::find(file_.planes().begin(), file_.planes().end(), ExrPlane{mark_name}) != file_.planes().end();
}

void FilmFile::merge_into(Film& film, std::vector<std::uint8_t>* marks) const {
  if (film.width() != width() || film.height() != height())
    throw Error(path_.string(),
                "its picture has " + std::to_string(width()) + "x" + std::to_string(height()) +
                    " pixels instead of " + std::to_string(film.width()) + "x" + std::to_string(film.height()),
                "merge parts of the same picture only");
  const bool with_marks = has_marks();
  const auto size = static_cast<std::size_t>(width());
  if (marks != nullptr && with_marks) marks->assign(size * static_cast<std::size_t>(height()), 0);
  file_.read(planes_of_film(with_marks), [&](int y, std::span<const std::uint32_t> words) {
    for (std::size_t x = 0; x < size; ++x) {
      if (check_sum(words, size, x, y) != words[words.size() - size + x])
        throw Error(path_.string(), "it is damaged at pixel " + std::to_string(x) + ", " + std::to_string(y),
                    "render this part again");
      std::size_t at = x + 4 * size;
      const auto next = [&] {
        const std::uint64_t word = words[at];
        at += size;
        return word;
      };
      FilmPixel pixel;
      visit_numbers(pixel, [&](const char*, auto& number) {
        const std::uint64_t high = next();
        set_bits(number, high << 32 | next());
      });
      if (marks != nullptr && with_marks)
        (*marks)[static_cast<std::size_t>(y) * size + x] = static_cast<std::uint8_t>(next());
      film.merge_pixel(static_cast<int>(x), y, pixel);
    }
  });
}

}  // namespace twopass
