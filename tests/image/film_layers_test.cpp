#include "render/image/film_layers.h"

#include <random>

#include <gtest/gtest.h>

#include "render/image/film.h"

namespace twopass {
namespace {

const std::vector<FilmLayer> rgb_and_data{{"red_part", {"R", "G", "B"}, Reduction::mean},
                                          {"rest", {"R", "G", "B"}, Reduction::mean},
                                          {"", {"Z"}, Reduction::nearest},
                                          {"invalid", {"X"}, Reduction::total},
                                          {"samples", {"X"}, Reduction::samples},
                                          {"variance", {"R", "G", "B"}, Reduction::variance}};

struct Sample {
  C3f radiance, part;
  float weight, distance2;
};

std::vector<Sample> random_samples(int count, bool signed_weights) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> u;
  std::vector<Sample> samples;
  for (int i = 0; i < count; ++i) {
    Sample s{
        {u(random), 10.0f * u(random), 0.0f}, {}, signed_weights && u(random) < 0.3f ? -1.0f : 1.0f, u(random)};
    s.part = s.radiance * u(random);
    samples.push_back(s);
  }
  return samples;
}

void add(Film& film, std::span<const Sample> samples) {
  PixelBatch batch;
  for (const Sample& s : samples) {
    batch.add(s.radiance, 1.0f, s.weight);
    const C3f rest = s.radiance - s.part;
    film.layers().add(
        0, std::array{s.part.x, s.part.y, s.part.z, rest.x, rest.y, rest.z, s.distance2 * 7.0f, 1.0f}, s.weight,
        s.distance2);
  }
  film.add_pixel(0, 0, batch);
}

float value(const Film& film, const std::string& channel) {
  const Image image = film.resolve_all();
  return image.at(0, 0, image.channel(channel));
}

TEST(FilmLayers, PartsOfThePictureSumToItWithEveryKindOfFilter) {
  for (const bool signed_weights : {false, true}) {
    Film film(1, 1, {rgb_and_data, {}, signed_weights});
    const std::vector<Sample> samples = random_samples(1000, signed_weights);
    add(film, std::span(samples).first(300));
    add(film, std::span(samples).subspan(300));
    for (const char* channel : {"R", "G", "B"}) {
      const float sum =
          value(film, std::string("red_part.") + channel) + value(film, std::string("rest.") + channel);
      EXPECT_NEAR(sum, value(film, channel), 1e-6f * value(film, channel)) << signed_weights << channel;
    }
  }
}

TEST(FilmLayers, DataOfTheNearestSampleTotalsAndWhatIsDerived) {
  Film film(1, 1, {rgb_and_data, {}, false});
  const std::vector<Sample> samples = random_samples(64, false);
  add(film, std::span(samples).first(32));
  add(film, std::span(samples).subspan(32));
  float nearest = infinity_f;
  for (const Sample& s : samples) nearest = std::min(nearest, s.distance2);
  EXPECT_FLOAT_EQ(value(film, "Z"), nearest * 7.0f);
  EXPECT_EQ(value(film, "invalid.X"), 64.0f);
  EXPECT_EQ(value(film, "samples.X"), 64.0f);
  const FilmPixel& pixel = film.pixel(0, 0);
  EXPECT_FLOAT_EQ(value(film, "variance.G"), static_cast<float>(pixel.spread.y / 1.0 / 64.0));
  EXPECT_GT(value(film, "variance.G"), 0.0f);
}

TEST(FilmLayers, MergedIsAsIfRenderedAtOnceAndRestoredIsTheSameBits) {
  const std::vector<Sample> samples = random_samples(100, true);
  const FilmLayout layout{rgb_and_data, {"CryptoObject"}, true};
  Film whole(1, 1, layout), first(1, 1, layout), second(1, 1, layout), restored(1, 1, layout);
  add(whole, samples);
  add(first, std::span(samples).first(60));
  add(second, std::span(samples).subspan(60));
  first.cryptomattes()[0].add(0, 5, 1.0f);
  second.cryptomattes()[0].add(0, 5, 2.0f);
  second.cryptomattes()[0].add(0, 6, 1.0f);
  second.merge(first);
  for (std::size_t k = 0; k < whole.layers().raw_count(); ++k)
    EXPECT_NEAR(second.layers().raw(0)[k], whole.layers().raw(0)[k], 1e-12 * std::abs(whole.layers().raw(0)[k]))
        << whole.layers().raw_names()[k];
  std::map<std::uint32_t, double> weights;
  for (const CryptoShare& share : second.cryptomattes()[0].shares(0)) weights[share.hash] = share.weight;
  EXPECT_EQ(weights, (std::map<std::uint32_t, double>{{5, 3.0}, {6, 1.0}}));

  EXPECT_EQ(whole.layers().raw_names().size(), whole.layers().raw_count());
  restored.merge_pixel(0, 0, whole.pixel(0, 0));
  std::copy_n(whole.layers().raw(0).begin(), whole.layers().raw_count(), restored.layers().raw(0).begin());
  EXPECT_EQ(restored.resolve_all().pixels, whole.resolve_all().pixels);
  Film other(1, 1);
  EXPECT_ANY_THROW(other.merge(whole));
}

TEST(FilmLayers, WithoutLayersThereIsThePictureAndNothingElse) {
  Film film(2, 2);
  EXPECT_EQ(film.resolve_all().channels, film.resolve().channels);
  EXPECT_EQ(FilmLayout{}.bytes_per_pixel(), sizeof(FilmPixel));
  EXPECT_EQ((FilmLayout{rgb_and_data, {}, true}.bytes_per_pixel()),
            sizeof(FilmPixel) + 8 * (2 * 6 + 1 + 1 + 1));
}

}  // namespace
}  // namespace twopass
