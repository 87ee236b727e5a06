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

constexpr std::size_t picture_planes = 4;
std::vector<ExrPlane> planes_of_picture() { return {{"R", true}, {"G", true}, {"B", true}, {"A", true}}; }

// The channels of the n-th thing that a Cryptomatte found in a pixel: its hash, samples and weight.
std::string share_name(const std::string& layer, std::size_t n) {
  return "film." + layer + "." + std::to_string(n);
}

// The planes of a film with this layout, whose Cryptomattes found at most so many things in a pixel.
std::vector<ExrPlane> planes_of_film(const FilmLayout& layout, std::span<const std::size_t> most_shares,
                                     bool marks) {
  std::vector<ExrPlane> planes = planes_of_picture();
  const auto add = [&](const std::string& name) {
    planes.push_back({name + ".hi"});
    planes.push_back({name + ".lo"});
  };
  visit_numbers(static_cast<const FilmPixel&>(FilmPixel()), [&](const char* name, const auto&) { add(name); });
  for (const std::string& name : FilmLayers(0, layout.layers, layout.has_signed_weights).raw_names())
    add("film.layer." + name);
  for (std::size_t k = 0; k < layout.cryptomattes.size(); ++k)
    for (std::size_t n = 0; n < most_shares[k]; ++n) {
      const std::string name = share_name(layout.cryptomattes[k], n);
      planes.push_back({name + ".hash"});
      planes.push_back({name + ".samples"});
      add(name + ".weight");
    }
  if (marks) planes.push_back({mark_name});
  planes.push_back({"film.check"});
  return planes;
}

// Writes and reads the words of a pixel, one plane after the other.
class WordWriter {
 public:
  WordWriter(std::span<std::uint32_t> words, std::size_t width, std::size_t x)
      : words_(words), width_(width), at_(x) {}
  void put(std::uint32_t word) {
    words_[at_] = word;
    at_ += width_;
  }
  template <class Number>
  void number(const Number& value) {
    put(static_cast<std::uint32_t>(bits_of(value) >> 32));
    put(static_cast<std::uint32_t>(bits_of(value)));
  }

 private:
  std::span<std::uint32_t> words_;
  std::size_t width_, at_;
};

class WordReader {
 public:
  WordReader(std::span<const std::uint32_t> words, std::size_t width, std::size_t x)
      : words_(words), width_(width), at_(x) {}
  std::uint32_t get() {
    const std::uint32_t word = words_[at_];
    at_ += width_;
    return word;
  }
  void skip(std::size_t count) { at_ += count * width_; }
  template <class Number>
  void number(Number& value) {
    const std::uint64_t high = get();
    set_bits(value, high << 32 | get());
  }

 private:
  std::span<const std::uint32_t> words_;
  std::size_t width_, at_;
};

void write_shares(WordWriter& out, std::span<const CryptoShare> shares, std::size_t most) {
  for (std::size_t n = 0; n < most; ++n) {
    const CryptoShare share = n < shares.size() ? shares[n] : CryptoShare();
    out.put(share.hash);
    out.put(share.count);
    out.number(share.weight);
  }
}

void read_shares(WordReader& in, CryptoFilm& crypto, std::size_t pixel, std::size_t most) {
  for (std::size_t n = 0; n < most; ++n) {
    CryptoShare share;
    share.hash = in.get();
    share.count = in.get();
    in.number(share.weight);
    if (share.count > 0) crypto.add(pixel, share);  // unused places are behind the last one
  }
}

std::vector<std::size_t> most_shares(const Film& film) {
  std::vector<std::size_t> most;
  for (const CryptoFilm& crypto : film.cryptomattes()) {
    most.push_back(0);
    for (std::size_t i = 0; i < crypto.pixel_count(); ++i)
      most.back() = std::max(most.back(), crypto.shares(i).size());
  }
  return most;
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
  const std::vector<std::size_t> shares = most_shares(film);
  const std::vector<ExrPlane> planes = planes_of_film(film.layout(), shares, !marks.empty());
  const auto width = static_cast<std::size_t>(film.width());
  write_exr_planes(
      path, planes, film.width(), film.height(), options,
      [&](int y, std::span<std::uint32_t> words) {
        for (std::size_t x = 0; x < width; ++x) {
          WordWriter out(words, width, x);
          const std::size_t i = film.index(static_cast<int>(x), y);
          const FilmPixel& pixel = film.pixel(static_cast<int>(x), y);
          for (const float value : pixel.resolved())
            out.put(std::bit_cast<std::uint32_t>(std::isfinite(value) ? value : 0.0f));
          visit_numbers(pixel, [&](const char*, const auto& number) { out.number(number); });
          for (const double number : film.layers().raw(i)) out.number(number);
          for (std::size_t k = 0; k < shares.size(); ++k)
            write_shares(out, film.cryptomattes()[k].shares(i), shares[k]);
          if (!marks.empty()) out.put(marks[i]);
          out.put(check_sum(words, width, x, y));
        }
      },
      previous);
}

FilmFile::FilmFile(const fs::path& path) : path_(path), file_(path) {
  for (const ExrPlane& plane : planes_of_film({}, {}, false))
    if (!has(plane))
      throw Error(path.string(), "it is a finished picture, not a partial one",
                  "give a file of --slice or --checkpoint");
}

bool FilmFile::has(const ExrPlane& plane) const {
  return std::find(file_.planes().begin(), file_.planes().end(), plane) != file_.planes().end();
}

bool FilmFile::has_marks() const { return has({mark_name}); }

void FilmFile::merge_into(Film& film, std::vector<std::uint8_t>* marks) const {
  if (film.width() != width() || film.height() != height())
    throw Error(path_.string(),
                "its picture has " + std::to_string(width()) + "x" + std::to_string(height()) +
                    " pixels instead of " + std::to_string(film.width()) + "x" + std::to_string(film.height()),
                "merge parts of the same picture only");
  std::vector<std::size_t> shares;
  for (const std::string& name : film.layout().cryptomattes) {
    shares.push_back(0);
    while (has({share_name(name, shares.back()) + ".hash"})) ++shares.back();
  }
  const std::vector<ExrPlane> planes = planes_of_film(film.layout(), shares, has_marks());
  if (planes.size() != file_.planes().size())
    throw Error(path_.string(), "it has other layers than the picture that it is merged into",
                "merge parts of the same picture only");
  const auto size = static_cast<std::size_t>(width());
  const bool takes_marks = marks != nullptr && has_marks();
  if (takes_marks) marks->assign(size * static_cast<std::size_t>(height()), 0);
  std::vector<double> raw(film.layers().raw_count());
  file_.read(planes, [&](int y, std::span<const std::uint32_t> words) {
    for (std::size_t x = 0; x < size; ++x) {
      if (check_sum(words, size, x, y) != words[words.size() - size + x])
        throw Error(path_.string(), "it is damaged at pixel " + std::to_string(x) + ", " + std::to_string(y),
                    "render this part again");
      WordReader in(words, size, x);
      in.skip(picture_planes);
      const std::size_t i = film.index(static_cast<int>(x), y);
      FilmPixel pixel;
      visit_numbers(pixel, [&](const char*, auto& number) { in.number(number); });
      film.merge_pixel(static_cast<int>(x), y, pixel);
      for (double& number : raw) in.number(number);
      if (!raw.empty()) film.layers().merge(i, raw);
      for (std::size_t k = 0; k < shares.size(); ++k) read_shares(in, film.cryptomattes()[k], i, shares[k]);
      if (takes_marks) (*marks)[i] = static_cast<std::uint8_t>(in.get());
    }
  });
}

}  // namespace twopass
