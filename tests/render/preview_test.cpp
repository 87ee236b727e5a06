#include "render/preview/preview.h"

#include <chrono>

#include <gtest/gtest.h>

#include "render/core/error.h"
#include "render/preview/connection.h"
#include "render/preview/tev_packets.h"
#include "tests/support/viewer.h"

namespace twopass {
namespace {

using test::ViewedPicture;
using test::Viewer;

std::string hex(const std::vector<std::byte>& bytes) {
  std::string text;
  char digits[3];
  for (const std::byte byte : bytes) {
    std::snprintf(digits, sizeof digits, "%02x", static_cast<unsigned>(byte));
    text += digits;
  }
  return text;
}

const std::vector<std::string> rgb{"R", "G", "B"};

TEST(TevPackets, HaveTheBytesOfTheProtocol) {
  EXPECT_EQ(hex(create_image_packet("img", {4, 2}, rgb, true)),
            "1c0000000401696d670004000000020000000300000052004700"
            "4200");
  EXPECT_EQ(hex(close_image_packet("img")), "0900000002696d6700");
  const std::vector<float> pixels{1, 2, 3, 4, 5, 6};
  const std::vector<std::byte> update = update_image_packet("img", rgb, {2, 1}, {2, 1}, pixels);
  EXPECT_EQ(update.size(), 108u);
  EXPECT_EQ(hex(update),
            "6c0000000600696d67000300000052004700420002000000010000000200000001000000"
            "000000000000000001000000000000000200000000000000"
            "030000000000000003000000000000000300000000000000"
            "0000803f0000004000004040000080400000a0400000c040");
}

TEST(TevPackets, LongNamesAndManyChannelsArriveWhole) {
  const std::string name(3000, 'n');
  std::vector<std::string> channels;
  for (int i = 0; i < 200; ++i) channels.push_back("a rather long name of a layer " + std::to_string(i) + ".R");
  const std::vector<std::byte> create = create_image_packet(name, {1, 1}, channels, false),
                               update = update_image_packet(name, channels, {0, 0}, {1, 1},
                                                            std::vector<float>(200, 0.5f));
  std::map<std::string, ViewedPicture> pictures;
  for (const auto& packet : {create, update}) {
    std::vector<char> bytes(packet.size() - 4);
    std::memcpy(bytes.data(), packet.data() + 4, bytes.size());
    test::apply_packet(bytes, pictures);
  }
  EXPECT_EQ(pictures.at(name).channels, channels);
  EXPECT_EQ(pictures.at(name).planes[199][0], 0.5f);
}

TEST(Address, IsHostAndPort) {
  EXPECT_EQ(parse_address("localhost:14158", "--preview").port, "14158");
  EXPECT_EQ(parse_address("[::1]:80", "--preview").host, "::1");
  for (const char* text :
       {"", "localhost", ":1", "localhost:", "localhost:0", "localhost:65536", "localhost:http", "a:-1"})
    EXPECT_THROW(parse_address(text, "--preview"), Error) << text;
}

void fill(Film& film, float value) {
  for (int y = 0; y < film.height(); ++y)
    for (int x = 0; x < film.width(); ++x) {
      PixelBatch batch;
      batch.add(C3f(value + static_cast<float>(x), static_cast<float>(y), 0.25f), 0.5f);
      film.add_pixel(x, y, batch);
    }
}

bool shows(const ViewedPicture& seen, const Film& film) {
  const Image image = film.resolve();
  if (seen.width != image.width || seen.height != image.height || seen.channels != image.channels) return false;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < 4; ++c)
        if (seen.planes[static_cast<std::size_t>(c)][static_cast<std::size_t>(y * image.width + x)] !=
            image.at(x, y, c))
          return false;
  return true;
}

const auto silent = [](const std::string&) {};

TEST(Preview, ShowsWhatTheFileWillHold) {
  Viewer viewer;
  Film film(300, 150);
  {
    Preview preview(viewer.address(), "a.exr", 300, 150, silent);
    fill(film, 1.0f);
    preview.update(film, {0, 0}, {300, 150});
    EXPECT_TRUE(
        viewer.wait([&](const auto& all) { return all.contains("a.exr") && shows(all.at("a.exr"), film); }));
    // A tile that lies across four blocks.
    fill(film, 5.0f);
    preview.update(film, {120, 120}, {20, 20});
    preview.update(film, {0, 0}, {300, 150});
  }
  EXPECT_TRUE(viewer.wait([&](const auto& all) { return shows(all.at("a.exr"), film); })) << "the last update";
  EXPECT_EQ(viewer.pictures().at("a.exr").creations, 1);
  EXPECT_EQ(viewer.error(), "");
}

TEST(Preview, ConvertsToWhatViewersTake) {
  Viewer viewer;
  Film film(3, 2);
  fill(film, 1.0f);
  const ColorMatrix matrix{{C3f(1.5f, -0.25f, 0.0f), C3f(-0.5f, 1.25f, 0.5f), C3f(0.0f, 0.0f, 0.5f)}};
  Preview(viewer.address(), "a.exr", 3, 2, silent, matrix).update(film, {0, 0}, {3, 2});
  // Pixel (2,1): 3, 1, .25 with alpha .5.
  EXPECT_TRUE(viewer.wait([&](const auto& all) {
    if (!all.contains("a.exr") || all.at("a.exr").updates == 0) return false;
    const auto& planes = all.at("a.exr").planes;
    return planes[0][5] == 4.0f && planes[1][5] == 0.5f && planes[2][5] == 0.625f && planes[3][5] == 0.5f;
  }));
}

TEST(Preview, AVeryShortRenderIsShownToo) {
  Viewer viewer;
  Film film(10, 10);
  fill(film, 1.0f);
  Preview(viewer.address(), "a.exr", 10, 10, silent).update(film, {0, 0}, {10, 10});
  EXPECT_TRUE(
      viewer.wait([&](const auto& all) { return all.contains("a.exr") && shows(all.at("a.exr"), film); }));
}

TEST(Preview, SendsTheWholePictureToAViewerThatComesBack) {
  auto viewer = std::make_unique<Viewer>();
  const int port = viewer->port();
  Film film(200, 100);
  fill(film, 1.0f);
  Preview preview(viewer->address(), "a.exr", 200, 100, silent);
  preview.update(film, {0, 0}, {200, 100});
  EXPECT_TRUE(
      viewer->wait([&](const auto& all) { return all.contains("a.exr") && shows(all.at("a.exr"), film); }));
  viewer->stop();
  fill(film, 3.0f);
  preview.update(film, {0, 0}, {100, 100});  // what is sent now meets nobody
  std::this_thread::sleep_for(std::chrono::milliseconds(600));
  viewer = std::make_unique<Viewer>(port);
  preview.update(film, {100, 0}, {100, 100});
  EXPECT_TRUE(
      viewer->wait([&](const auto& all) { return all.contains("a.exr") && shows(all.at("a.exr"), film); }));
  EXPECT_EQ(viewer->error(), "");
}

// Seconds that a thousand updates and the end take.
double seconds_with(const std::string& address, const std::function<void(const std::string&)>& note) {
  Film film(512, 512);
  fill(film, 1.0f);
  const auto start = std::chrono::steady_clock::now();
  double updates = 0.0;
  {
    Preview preview(address, "a.exr", 512, 512, note);
    for (int i = 0; i < 1000; ++i) {
      preview.update(film, {16 * (i % 32), 0}, {16, 16});
      if (i % 250 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    updates = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  // If an update waited for the viewer, a thousand would take minutes.
  EXPECT_LT(updates, 20.0) << "nobody waits for the viewer";
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

TEST(Preview, NobodyWaitsForAViewerThatIsStuck) {
  Viewer stuck(0, false);
  EXPECT_LT(seconds_with(stuck.address(), silent), 30.0);
}

TEST(Preview, NobodyWaitsForAViewerThatIsNotThere) {
  int port = 0;
  {
    Viewer gone;
    port = gone.port();
  }
  std::atomic<int> notes{0};
  EXPECT_LT(seconds_with("127.0.0.1:" + std::to_string(port), [&](const std::string&) { ++notes; }), 30.0);
  EXPECT_EQ(notes, 1) << "it is said once";
}

}  // namespace
}  // namespace twopass
