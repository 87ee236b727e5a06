#include "render/image/film.h"

#include <cassert>
#include <numeric>
#include <string>

#include "render/core/error.h"
#include "render/core/memory.h"
#include "render/core/parallel.h"
#include "render/image/compare.h"

namespace twopass {
namespace {

// Channels of a Cryptomatte.
constexpr std::size_t crypto_values = 2 * cryptomatte_levels;
constexpr std::int64_t most_pixels = std::int64_t{1} << 30;

C3d per_channel_square(const C3d& c) { return {c.x * c.x, c.y * c.y, c.z * c.z}; }

template <class Body>
void for_each_row(std::size_t rows, const Body& body) {
  constexpr std::size_t grain = 8;
  parallel_for(rows, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) body(static_cast<int>(y));
  });
}

}  // namespace

C3d FilmPixel::mean() const {
  if (samples == 0) return {0.0, 0.0, 0.0};
  const double n = static_cast<double>(samples), excess = weight / n - 1.0;
  if (excess == 0.0) return sum / n;  // also keeps an overflown sum from becoming NaN
  return C3d(sum - plain * excess) / n;
}

double FilmPixel::mean_alpha() const {
  if (samples == 0) return 0.0;
  const double n = static_cast<double>(samples);
  return std::clamp((alpha - plain_alpha * (weight / n - 1.0)) / n, 0.0, 1.0);
}

std::array<float, 4> FilmPixel::resolved() const {
  const C3d color = mean();
  return {static_cast<float>(color.x), static_cast<float>(color.y), static_cast<float>(color.z),
          static_cast<float>(mean_alpha())};
}

PixelNoise FilmPixel::noise() const {
  // A batch of n samples has a mean of variance s^2/n, hence s^2 = spread / (batches - 1).
  PixelNoise noise{mean(), spread / (batches - 1.0), {}};
  for (int c = 0; c < 3; ++c)
    noise.certain[c] = noise.mean[c] - 2.0 * std::sqrt(noise.variance[c] / static_cast<double>(samples));
  return noise;
}

double PixelNoise::relative(const Around& around) const {
  const double each = around.count > 0 ? 1.0 / around.count : 0.0;
  double total = 0.0;
  for (int c = 0; c < 3; ++c) {
    double believed = mean[c];
    if (around.count > 0) believed = std::min(believed, std::max(certain[c], around.sum[c] * each));
    total += variance[c] / (believed * believed + relmse_epsilon);
  }
  // Radiances near the end of double's range could overflow to inf/inf.
  return std::isnan(total) ? std::numeric_limits<double>::infinity() : total / 3.0;
}

void FilmPixel::merge(const FilmPixel& other) {
  if (other.samples == 0) return;
  if (samples == 0) {
    *this = other;
    return;
  }
  const double n = static_cast<double>(samples), m = static_cast<double>(other.samples);
  spread += other.spread + per_channel_square(other.mean() - mean()) * (n * m / (n + m));
  sum += other.sum;
  plain += other.plain;
  alpha += other.alpha;
  plain_alpha += other.plain_alpha;
  weight += other.weight;
  samples += other.samples;
  batches += other.batches;
}

bool PixelBatch::add(const C3f& radiance, float alpha, float weight) {
  sums_.batches = 1;
  ++sums_.samples;
  const bool finite = is_finite(radiance) && std::isfinite(alpha) && std::isfinite(weight);
  // The sample was taken, so its weight counts even if its value cannot.
  sums_.weight += std::isfinite(weight) ? weight : 1.0;
  if (!finite) return false;
  sums_.sum += C3d(radiance) * static_cast<double>(weight);
  sums_.plain += C3d(radiance);
  sums_.alpha += static_cast<double>(alpha) * weight;
  sums_.plain_alpha += alpha;
  return true;
}

std::vector<std::string> FilmLayout::channels() const {
  std::vector<std::string> channels{"R", "G", "B", "A"};
  for (const FilmLayer& layer : layers)
    for (std::size_t c = 0; c < layer.channels.size(); ++c) channels.push_back(channel_name(layer, c));
  for (const std::string& name : cryptomattes)
    for (std::size_t c = 0; c < crypto_values; ++c)
      channels.push_back(name + "0" + std::to_string(c / 4) + "." + std::string(1, "RGBA"[c % 4]));
  return channels;
}

std::size_t FilmLayout::bytes_per_pixel() const {
  return sizeof(FilmPixel) + FilmLayers::bytes_per_pixel(layers, has_signed_weights) +
         cryptomattes.size() * sizeof(std::vector<CryptoShare>);
}

Film::Film(int width, int height, FilmLayout layout)
    : width_(width), height_(height), layout_(std::move(layout)) {
  check(width, height, layout_);
  pixels_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  layers_ = FilmLayers(pixels_.size(), layout_.layers, layout_.has_signed_weights);
  cryptomattes_.assign(layout_.cryptomattes.size(), CryptoFilm(pixels_.size()));
}

void Film::check(int width, int height, const FilmLayout& layout) {
  if (width < 1 || height < 1 || static_cast<std::int64_t>(width) * height > most_pixels)
    throw Error("picture", "its size is " + std::to_string(width) + "x" + std::to_string(height),
                "choose a size of at least 1x1 and at most " + std::to_string(most_pixels) + " pixels");
  // The system would promise the memory, and end the program when it is used.
  const double bytes = bytes_to_render(width, height, layout);
  if (bytes > memory_limit_bytes())
    throw Error("picture",
                std::to_string(width) + "x" + std::to_string(height) + " pixels need " +
                    std::to_string(static_cast<int>(std::ceil(bytes / 1e9))) + " GB of memory, there are " +
                    std::to_string(static_cast<int>(memory_limit_bytes() / 1e9)),
                "choose a smaller size or fewer layers, or render it in parts (--crop)");
}

double Film::bytes_to_render(int width, int height, const FilmLayout& layout) {
  // The sums, and what the estimate of noise takes beside them. Writing the picture takes less: its floats
  // twice, its halves twice, 48 bytes.
  const double each = static_cast<double>(layout.bytes_per_pixel() + sizeof(C3d) + sizeof(Around));
  return each * width * height;
}

std::size_t Film::index(int x, int y) const {
  assert(x >= 0 && x < width_ && y >= 0 && y < height_);
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
}

void Film::merge(const Film& other) {
  if (other.width_ != width_ || other.height_ != height_)
    throw Error("merge",
                "the films are " + std::to_string(width_) + "x" + std::to_string(height_) + " and " +
                    std::to_string(other.width_) + "x" + std::to_string(other.height_),
                "merge parts of the same picture only");
  if (other.layers_.raw_names() != layers_.raw_names() || other.layout_.cryptomattes != layout_.cryptomattes)
    throw Error("merge", "the films have different layers", "merge parts of the same picture only");
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    pixels_[i].merge(other.pixels_[i]);
    if (!layers_.empty()) layers_.merge(i, other.layers_.raw(i));
    for (std::size_t k = 0; k < cryptomattes_.size(); ++k)
      for (const CryptoShare& share : other.cryptomattes_[k].shares(i)) cryptomattes_[k].add(i, share);
  }
}

std::uint64_t Film::samples() const {
  return std::accumulate(pixels_.begin(), pixels_.end(), std::uint64_t{0},
                         [](std::uint64_t n, const FilmPixel& pixel) { return n + pixel.samples; });
}

Image Film::resolve() const {
  Image image(width_, height_, {"R", "G", "B", "A"});
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    const std::array<float, 4> rgba = pixels_[i].resolved();
    std::copy(rgba.begin(), rgba.end(), &image.pixels[4 * i]);
  }
  return image;
}

Image Film::resolve_all() const {
  const Image picture = resolve();
  if (layers_.empty() && cryptomattes_.empty()) return picture;
  Image image(width_, height_, layout_.channels());
  const std::size_t stride = image.channels.size();
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    const FilmPixel& pixel = pixels_[i];
    const std::span<float> out = std::span(image.pixels).subspan(stride * i, stride);
    std::copy_n(&picture.pixels[4 * i], 4, out.begin());
    PixelTotals totals{pixel.weight, pixel.samples};
    if (pixel.batches >= 2)
      totals.variance = pixel.spread / ((pixel.batches - 1.0) * static_cast<double>(pixel.samples));
    layers_.resolve(i, totals, out.subspan(4));
    for (std::size_t k = 0; k < cryptomattes_.size(); ++k)
      cryptomattes_[k].resolve(i, pixel.weight, pixel.samples,
                               out.subspan(4 + layers_.channel_count() + k * crypto_values, crypto_values));
  }
  return image;
}

std::vector<Around> Film::surroundings() const {
  constexpr int r = around_radius;
  std::vector<Around> surroundings(pixels_.size());
  constexpr std::size_t band = 32;
  parallel_for(static_cast<std::size_t>(height_), band, [&](std::size_t begin, std::size_t end) {
    // The rows of a band and those around it; sums along rows first, then of rows.
    const int first = std::max(static_cast<int>(begin) - r, 0),
              last = std::min(static_cast<int>(end) + r, height_);
    const auto columns = static_cast<std::size_t>(width_);
    std::vector<Around> own(columns * static_cast<std::size_t>(last - first)), in_row(own.size());
    const auto at = [&](int x, int y) {
      return static_cast<std::size_t>(y - first) * columns + static_cast<std::size_t>(x);
    };
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < width_; ++x)
        if (const FilmPixel& p = pixel(x, y); p.samples > 0) own[at(x, y)] = {p.mean(), 1};
      for (int x = 0; x < width_; ++x)
        for (int i = std::max(x - r, 0); i <= std::min(x + r, width_ - 1); ++i)
          in_row[at(x, y)] += own[at(i, y)];
    }
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < width_; ++x) {
        Around& around = surroundings[index(x, y)];
        for (int j = std::max(y - r, 0); j <= std::min(y + r, height_ - 1); ++j)
          if (j != y) around += in_row[at(x, j)];
        // Without itself, which subtracting it from a sum would not be where it is a million times brighter.
        for (int i = std::max(x - r, 0); i <= std::min(x + r, width_ - 1); ++i)
          if (i != x) around += own[at(i, y)];
      }
  });
  return surroundings;
}

NoiseEstimate Film::noise() const {
  constexpr double unknown = std::numeric_limits<double>::infinity();
  const std::vector<Around> around = surroundings();
  struct Row {
    double sum = 0.0, squares = 0.0, sampled = 0.0;
    bool is_known = true;
  };
  std::vector<Row> rows(static_cast<std::size_t>(height_));
  for_each_row(rows.size(), [&](int y) {
    Row& row = rows[static_cast<std::size_t>(y)];
    for (int x = 0; x < width_; ++x) {
      const FilmPixel& at = pixel(x, y);
      if (at.samples == 0) continue;
      if (at.batches < 2) {
        row.is_known = false;
        return;
      }
      const double relmse = at.noise().relative(around[index(x, y)]) / static_cast<double>(at.samples);
      row.sum += relmse;
      row.squares += relmse * relmse;
      row.sampled += 1.0;
    }
  });
  Row all;
  for (const Row& row : rows) {
    all.sum += row.sum;
    all.squares += row.squares;
    all.sampled += row.sampled;
    all.is_known = all.is_known && row.is_known;
  }
  if (!all.is_known || all.sampled == 0.0 || !std::isfinite(all.squares)) return {unknown, 0.0};
  const double mean = all.sum / all.sampled;
  return {mean, std::sqrt(std::max(0.0, all.squares / all.sampled - mean * mean) / all.sampled)};
}

}  // namespace twopass
