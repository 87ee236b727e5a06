#include "render/image/cryptomatte.h"

#include <bit>
#include <cmath>

#include <gtest/gtest.h>

namespace twopass {
namespace {

// Public test vectors of MurmurHash3_x86_32 with seed 0, and those of the specification's own tests.
TEST(Cryptomatte, HashesAreThoseOfThePublishedVectors) {
  EXPECT_EQ(murmur3_32(""), 0u);
  EXPECT_EQ(murmur3_32("test"), 0xba6bd213u);
  EXPECT_EQ(murmur3_32("Hello, world!"), 0xc0363e43u);
  EXPECT_EQ(murmur3_32("The quick brown fox jumps over the lazy dog"), 0x2e4ff723u);
  const std::pair<const char*, double> ids[] = {{"hello", 6.0705627102400005616e-17},
                                                {"cube", -4.08461912519e+15},
                                                {"sphere", 2.79018604383e+15},
                                                {"plane", 3.66557617593e-11},
                                                {"m\xc3\xa4"
                                                 "dchen",
                                                 6.2361298211599995797e+25}};
  for (const auto& [name, id] : ids)
    EXPECT_NEAR(cryptomatte_id(cryptomatte_hash(name)), id, 1e-10 * std::abs(id)) << name;
}

TEST(Cryptomatte, IdsAreFloatsThatSurviveFiles) {
  int flipped = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::string name = "object-" + std::to_string(i);
    const float id = cryptomatte_id(cryptomatte_hash(name));
    EXPECT_TRUE(std::isnormal(id)) << name;
    if (std::bit_cast<std::uint32_t>(id) != murmur3_32(name)) ++flipped;
  }
  EXPECT_GT(flipped, 20000 / 128 / 2) << "names that need the flip must be among them";
}

TEST(Cryptomatte, ManifestIsEscapedJson) {
  EXPECT_EQ(cryptomatte_manifest({}), "{}");
  EXPECT_EQ(cryptomatte_manifest({{"a\"\\\n", 0x12u}, {"b", 0xffffffffu}}),
            "{\"a\\\"\\\\\\u000a\":\"00000012\",\"b\":\"ffffffff\"}");
  EXPECT_EQ(cryptomatte_key("CryptoObject").size(), 7u);
}

TEST(Cryptomatte, RanksAreSortedFilteredAndBounded) {
  CryptoFilm film(1);
  // Ten samples, one of weight -1: the sum of weights is 8, its mean .8.
  for (int i = 0; i < 5; ++i) film.add(0, 7, 1.0f);
  film.add(0, 9, 1.0f);
  film.add(0, 9, 1.0f);
  film.add(0, 3, -1.0f);
  std::array<float, 12> pairs;
  film.resolve(0, 8.0, 10, pairs);
  // Coverage with the control variate: (sum w - count (.8 - 1)) / 10.
  EXPECT_EQ(std::bit_cast<std::uint32_t>(pairs[0]), 7u);
  EXPECT_FLOAT_EQ(pairs[1], (5.0f + 1.0f) / 10.0f);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(pairs[2]), 9u);
  EXPECT_FLOAT_EQ(pairs[3], (2.0f + 0.4f) / 10.0f);
  for (int i = 4; i < 12; ++i)
    EXPECT_EQ(pairs[static_cast<std::size_t>(i)], 0.0f) << "negative coverage is none";

  CryptoFilm crowded(1);
  for (std::uint32_t i = 1; i <= 1000; ++i) crowded.add(0, {i, 1, 1.0 + (i == 500 ? 50.0 : 0.0)});
  EXPECT_EQ(crowded.shares(0).size(), CryptoFilm::most_shares);
  crowded.resolve(0, 1000.0, 1000, pairs);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(pairs[0]), 500u) << "what covers most is kept";
}

}  // namespace
}  // namespace twopass
