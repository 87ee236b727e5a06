#include "render/load/gltf_uri.h"

#include "tests/load/gltf_writer.h"
#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

TEST(GltfUri, DataUrisHoldTheirBytes) {
  EXPECT_EQ(bytes_of_data_uri("data:application/octet-stream;base64,AAECAw==", "x"),
            std::string("\0\1\2\3", 4));
  EXPECT_EQ(bytes_of_data_uri("data:image/webp;base64,AAECAw", "x"), std::string("\0\1\2\3", 4));  // no padding
  EXPECT_EQ(bytes_of_data_uri("DATA:;base64,-_8", "x"), "\xfb\xff");
  EXPECT_EQ(bytes_of_data_uri("data:text/plain,a%20b%", "x"), "a b%");
  EXPECT_EQ(bytes_of_data_uri("data:,", "x"), "");
  EXPECT_EQ(bytes_of_data_uri("file.bin", "x"), std::nullopt);
  for (int size = 0; size < 20; ++size) {
    std::string bytes;
    for (int i = 0; i < size; ++i) bytes += static_cast<char>(37 * i + size);
    EXPECT_EQ(bytes_of_data_uri("data:a/b;base64," + GltfWriter::base64(bytes), "x"), bytes);
  }
}

TEST(GltfUri, BrokenDataUrisAreRefused) {
  expect_error([] { bytes_of_data_uri("data:x;base64", "file: buffer 0"); }, {"file: buffer 0", "no comma"});
  expect_error([] { bytes_of_data_uri("data:x;base64,AA*A", "file: buffer 0"); }, {"not base64: byte 3"});
}

TEST(GltfUri, NamesAreRelativeToTheScene) {
  EXPECT_EQ(path_of_uri("a.bin", "/scenes", "x"), "/scenes/a.bin");
  EXPECT_EQ(path_of_uri("my%20file+1.bin", "/scenes", "x"), "/scenes/my file+1.bin");
  EXPECT_EQ(path_of_uri("%C3%A9%2.png", "", "x"), "\xC3\xA9%2.png");
  EXPECT_EQ(path_of_uri("C:/a.png", "", "x"), "C:/a.png");
}

TEST(GltfUri, NothingIsFetched) {
  expect_error([] { path_of_uri("https://example.com/a.bin", "", "file: buffer 0"); },
               {"file: buffer 0", "'https://example.com/a.bin' is not a file", "'https:'", "download it"});
  expect_error([] { path_of_uri("file:///etc/passwd", "", "x"); }, {"'file:'"});
  expect_error([] { path_of_uri("", "", "x"); }, {"is not a file's name"});
  expect_error([] { path_of_uri("a%00b", "", "x"); }, {"is not a file's name"});
  const std::string message = message_of([] { path_of_uri("http:" + std::string(10000, 'x'), "", "x"); });
  EXPECT_LT(message.size(), 300u);
}

}  // namespace
}  // namespace twopass
