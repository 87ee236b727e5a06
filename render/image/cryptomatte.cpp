#include "render/image/cryptomatte.h"

#include <algorithm>
#include <bit>
#include <cstdio>

namespace twopass {

namespace {

std::uint32_t mixed(std::uint32_t block) {
  block *= 0xcc9e2d51u;
  block = std::rotl(block, 15);
  return block * 0x1b873593u;
}

std::string hex(std::uint32_t value) {
  char text[9];
  std::snprintf(text, sizeof text, "%08x", value);
  return text;
}

// RFC 8259, section 7.
void append_json_string(std::string& json, std::string_view text) {
  json += '"';
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      json += '\\';
      json += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      char escape[7];
      std::snprintf(escape, sizeof escape, "\\u%04x", static_cast<unsigned>(c));
      json += escape;
    } else {
      json += c;
    }
  }
  json += '"';
}

}  // namespace

std::uint32_t murmur3_32(std::string_view text) {
  const auto byte = [&](std::size_t i) { return std::uint32_t{static_cast<unsigned char>(text[i])}; };
  std::uint32_t hash = 0;
  std::size_t i = 0;
  for (; i + 4 <= text.size(); i += 4) {
    hash ^= mixed(byte(i) | byte(i + 1) << 8 | byte(i + 2) << 16 | byte(i + 3) << 24);
    hash = std::rotl(hash, 13) * 5 + 0xe6546b64u;
  }
  std::uint32_t tail = 0;
  for (std::size_t k = text.size(); k > i; --k) tail = tail << 8 | byte(k - 1);
  hash ^= mixed(tail);
  hash ^= static_cast<std::uint32_t>(text.size());
  hash = (hash ^ hash >> 16) * 0x85ebca6bu;
  hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
  return hash ^ hash >> 16;
}

std::uint32_t cryptomatte_hash(std::string_view name) {
  const std::uint32_t hash = murmur3_32(name), exponent = hash >> 23 & 255;
  return exponent == 0 || exponent == 255 ? hash ^ 1u << 23 : hash;
}

float cryptomatte_id(std::uint32_t hash) { return std::bit_cast<float>(hash); }

std::string cryptomatte_key(std::string_view layer) { return hex(murmur3_32(layer)).substr(0, 7); }

std::string cryptomatte_manifest(const std::map<std::string, std::uint32_t>& names) {
  std::string json = "{";
  for (const auto& [name, hash] : names) {
    if (json.size() > 1) json += ',';
    append_json_string(json, name);
    json += ":\"" + hex(hash) + '"';
  }
  return json + "}";
}

void CryptoFilm::add(std::size_t pixel, const CryptoShare& share) {
  std::vector<CryptoShare>& shares = pixels_[pixel];
  for (CryptoShare& known : shares)
    if (known.hash == share.hash) {
      known.count += share.count;
      known.weight += share.weight;
      return;
    }
  if (shares.size() >= most_shares)
    shares.erase(std::min_element(shares.begin(), shares.end(), [](const CryptoShare& a, const CryptoShare& b) {
      return a.weight != b.weight ? a.weight < b.weight : a.hash < b.hash;
    }));
  shares.push_back(share);
}

void CryptoFilm::resolve(std::size_t pixel, double weight, std::uint64_t samples,
                         std::span<float> pairs) const {
  std::fill(pairs.begin(), pairs.end(), 0.0f);
  if (samples == 0) return;
  const double n = static_cast<double>(samples), excess = weight / n - 1.0;
  std::vector<std::pair<float, std::uint32_t>> ranks;
  for (const CryptoShare& share : pixels_[pixel]) {
    // The estimator of FilmPixel::mean, of a value that is 1 where the thing is seen.
    const double coverage = (share.weight - share.count * excess) / n;
    if (coverage > 0.0) ranks.emplace_back(static_cast<float>(std::min(coverage, 1.0)), share.hash);
  }
  std::sort(ranks.begin(), ranks.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : a.second < b.second;
  });
  for (std::size_t i = 0; i < std::min(ranks.size(), pairs.size() / 2); ++i) {
    pairs[2 * i] = cryptomatte_id(ranks[i].second);
    pairs[2 * i + 1] = ranks[i].first;
  }
}

}  // namespace twopass
