#include "render/core/deflate.h"

#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <zlib.h>

namespace twopass {
namespace {

std::vector<std::byte> compressed(const std::string& text) {
  uLongf size = compressBound(text.size());
  std::vector<std::byte> result(size);
  compress(reinterpret_cast<Bytef*>(result.data()), &size, reinterpret_cast<const Bytef*>(text.data()),
           text.size());
  result.resize(size);
  return result;
}

TEST(Deflate, GivesBackWhatWasCompressedPieceByPiece) {
  std::string text;
  for (int i = 0; i < 10000; ++i) text += std::to_string(i * i);
  std::vector<std::byte> data = compressed(text);
  data.push_back(std::byte{77});  // what follows is not looked at
  Inflater inflater(data);
  std::string read(text.size(), ' ');
  const auto bytes = std::as_writable_bytes(std::span(read));
  EXPECT_TRUE(inflater.read(bytes.first(1)));
  EXPECT_TRUE(inflater.read({}));
  EXPECT_TRUE(inflater.read(bytes.subspan(1)));
  EXPECT_EQ(read, text);
  std::byte more;
  EXPECT_FALSE(inflater.read(std::span(&more, 1)));
}

TEST(Deflate, NoticesDamageAndMissingEnds) {
  const std::string text(5000, 'x');
  std::vector<std::byte> data = compressed(text + "different");
  std::string read(text.size() + 9, ' ');
  for (const std::size_t kept : {std::size_t{0}, std::size_t{1}, data.size() / 2, data.size() - 8})
    EXPECT_FALSE(Inflater(std::span(data).first(kept)).read(std::as_writable_bytes(std::span(read)))) << kept;
  data[0] = std::byte{0};
  EXPECT_FALSE(Inflater(data).read(std::as_writable_bytes(std::span(read))));
}

TEST(Deflate, NothingGrowsMoreThanItsLargestRatio) {
  const std::string zeros(1 << 22, '\0');
  EXPECT_LE(zeros.size(), compressed(zeros).size() * Inflater::largest_ratio);
}

TEST(Deflate, ChecksumIsTheStandardOne) {
  const std::string text = "123456789";
  EXPECT_EQ(crc32_of(std::as_bytes(std::span(text))), 0xcbf43926u);
  EXPECT_EQ(crc32_of({}), 0u);
}

}  // namespace
}  // namespace twopass
