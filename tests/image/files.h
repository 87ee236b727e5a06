// A folder of its own for each test, and small helpers on files and pictures.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "render/core/error.h"
#include "render/image/image.h"

namespace twopass {

/// A 2x1 RGBA PNG written by hand: (255, 128, 0, 128) and (1, 2, 3, 0).
inline constexpr unsigned char png_rgba[] = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44,
    0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x08, 0x06, 0x00, 0x00, 0x00, 0xf4,
    0x22, 0x7f, 0x8a, 0x00, 0x00, 0x00, 0x11, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0xf8,
    0xdf, 0xc0, 0xd0, 0xc0, 0xc8, 0xc4, 0xcc, 0x00, 0x00, 0x0e, 0x11, 0x02, 0x06, 0x9e, 0x1a,
    0xaf, 0x6f, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

class FileTest : public ::testing::Test {
 protected:
  FileTest()
      : folder_(std::filesystem::path(::testing::TempDir()) /
                (std::string("twopass_") + ::testing::UnitTest::GetInstance()->current_test_info()->name() +
                 "_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~FileTest() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] std::size_t files_in_folder() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder_), std::filesystem::directory_iterator()));
  }

 private:
  std::filesystem::path folder_;
};

inline std::string content_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

inline void put(const std::filesystem::path& path, std::string_view content) {
  std::ofstream(path, std::ios::binary) << content;
}

/// Uniform random values in [low, high), the same for the same seed.
inline Image random_image(int width, int height, std::vector<std::string> channels, float low, float high,
                          unsigned seed = 1) {
  Image image(width, height, std::move(channels));
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> value(low, high);
  for (float& v : image.pixels) v = value(generator);
  return image;
}

/// The message of the Error that `action` throws; a failure and an empty text when it throws none.
template <class Action>
std::string error_of(Action&& action) {
  try {
    action();
  } catch (const Error& e) {
    return e.what();
  }
  ADD_FAILURE() << "no Error was thrown";
  return {};
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace twopass
