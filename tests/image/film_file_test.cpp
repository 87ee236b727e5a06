#include "render/image/film_file.h"

#include <bit>
#include <cstring>

#include "render/image/picture.h"
#include "tests/image/files.h"

namespace twopass {
namespace {

using FilmFiles = FileTest;

// Numbers that only an exact file keeps: sums with all their bits, huge and tiny ones, negative ones.
Film random_film(int width, int height, unsigned seed) {
  Film film(width, height);
  std::mt19937_64 random(seed);
  const auto number = [&] {
    return std::ldexp(static_cast<double>(random() >> 11) * (random() % 2 == 0 ? 1.0 : -1.0),
                      -60 + static_cast<int>(random() % 40));
  };
  const auto color = [&] { return C3d(number(), number(), number()); };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      FilmPixel pixel;
      pixel.sum = color();
      pixel.plain = color();
      pixel.spread = color();
      pixel.alpha = number();
      pixel.plain_alpha = number();
      pixel.weight = number();
      pixel.samples = random() % 5 == 0 ? (std::uint64_t{1} << 40) + random() % 1000 : random() % 1000;
      pixel.batches = static_cast<std::uint32_t>(random());
      film.merge_pixel(x, y, pixel);
    }
  return film;
}

bool same_bits(const FilmPixel& a, const FilmPixel& b) {
  const auto bits = [](const FilmPixel& p) {
    std::vector<std::uint64_t> all;
    for (const C3d& c : {p.sum, p.plain, p.spread})
      for (const double x : {c.x, c.y, c.z}) all.push_back(std::bit_cast<std::uint64_t>(x));
    for (const double x : {p.alpha, p.plain_alpha, p.weight}) all.push_back(std::bit_cast<std::uint64_t>(x));
    all.push_back(p.samples);
    all.push_back(p.batches);
    return all;
  };
  return bits(a) == bits(b);
}

void expect_same(const Film& a, const Film& b) {
  ASSERT_EQ(a.width(), b.width());
  ASSERT_EQ(a.height(), b.height());
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x) ASSERT_TRUE(same_bits(a.pixel(x, y), b.pixel(x, y))) << x << ' ' << y;
}

TEST_F(FilmFiles, KeepEveryBitOfEveryNumber) {
  for (const auto& [width, height] : {std::pair{1, 1}, {5, 3}, {16, 16}, {33, 50}}) {
    const Film film = random_film(width, height, 1);
    std::vector<std::uint8_t> marks(static_cast<std::size_t>(width * height)), read;
    for (std::size_t i = 0; i < marks.size(); ++i) marks[i] = static_cast<std::uint8_t>(7 * i);
    ExrOptions options;
    options.metadata = {{"twopass/seed", 7}, {"twopass/integrator", std::string("path")}};
    options.data_offset = {10, 20};
    options.display_size = V2i(200, 100);
    write_film(file("a.exr"), film, marks, options);
    const FilmFile stored(file("a.exr"));
    Film again(width, height);
    stored.merge_into(again, &read);
    expect_same(film, again);
    EXPECT_EQ(read, marks);
    EXPECT_EQ(stored.options().data_offset, V2i(10, 20));
    EXPECT_EQ(stored.options().display_size, V2i(200, 100));
    const auto& metadata = stored.options().metadata;
    EXPECT_NE(std::find(metadata.begin(), metadata.end(), options.metadata[0]), metadata.end());
    EXPECT_NE(std::find(metadata.begin(), metadata.end(), options.metadata[1]), metadata.end());
  }
}

TEST_F(FilmFiles, AreOrdinaryPicturesToo) {
  const Film film = random_film(20, 17, 2);
  write_film(file("a.exr"), film, {}, {});
  const Image seen = read_picture(file("a.exr")), resolved = film.resolve();
  for (int y = 0; y < 17; ++y)
    for (int x = 0; x < 20; ++x)
      for (int c = 0; c < 4; ++c) ASSERT_EQ(seen.at(x, y, c), resolved.at(x, y, c));
  EXPECT_FALSE(FilmFile(file("a.exr")).has_marks());
}

TEST_F(FilmFiles, AddToWhatAFilmHolds) {
  const Film a = random_film(9, 9, 3), b = random_film(9, 9, 4);
  write_film(file("b.exr"), b, {}, {});
  Film sum = a, expected = a;
  expected.merge(b);
  FilmFile(file("b.exr")).merge_into(sum);
  expect_same(sum, expected);
  Film other(9, 8);
  EXPECT_TRUE(contains(error_of([&] { FilmFile(file("b.exr")).merge_into(other); }), "9x9"));
}

TEST_F(FilmFiles, DamageIsSeen) {
  const Film film = random_film(40, 40, 5);
  write_film(file("a.exr"), film, {}, {});
  const std::string good = content_of(file("a.exr"));
  // Anything missing at the end.
  for (const std::size_t kept :
       {std::size_t{0}, std::size_t{3}, std::size_t{100}, good.size() / 2, good.size() - 1}) {
    put(file("a.exr"), good.substr(0, kept));
    EXPECT_FALSE(error_of([&] {
                   Film again(40, 40);
                   FilmFile(file("a.exr")).merge_into(again);
                 }).empty())
        << kept;
  }
  // A bit of the pixels, anywhere: either an error, or a bit that means nothing, such as the number of a line.
  std::mt19937 random(6);
  int seen = 0;
  for (int i = 0; i < 200; ++i) {
    std::string bad = good;
    const std::size_t at = good.size() / 4 + random() % (good.size() - good.size() / 4);
    bad[at] = static_cast<char>(bad[at] ^ (1 << random() % 8));
    put(file("a.exr"), bad);
    Film again(40, 40);
    try {
      FilmFile(file("a.exr")).merge_into(again);
    } catch (const Error&) {
      ++seen;
      continue;
    }
    expect_same(film, again);
  }
  EXPECT_GT(seen, 190);
}

TEST_F(FilmFiles, FinishedPicturesAndOtherFilesAreRefused) {
  write_exr(file("a.exr"), random_image(4, 4, {"R", "G", "B", "A"}, 0, 1));
  EXPECT_TRUE(contains(error_of([&] { FilmFile(file("a.exr")); }), "finished picture"));
  put(file("b.exr"), "no picture at all");
  EXPECT_TRUE(contains(error_of([&] { FilmFile(file("b.exr")); }), "no OpenEXR"));
  EXPECT_FALSE(error_of([&] { FilmFile(file("c.exr")); }).empty());
}

}  // namespace
}  // namespace twopass
