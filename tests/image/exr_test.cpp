#include "render/image/exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfStringAttribute.h>

#include "tests/image/files.h"

namespace twopass {
namespace {

using Exr = FileTest;

TEST_F(Exr, FloatsReturnBitByBit) {
  const Image image = random_image(7, 5, {"R", "G", "B", "A", "Z", "albedo.R", "n.X"}, -1e30f, 1e30f);
  write_exr(file("a.exr"), image, {.pixel_type = PixelType::float_});
  const Image back = read_exr(file("a.exr"));
  EXPECT_EQ(back.width, 7);
  EXPECT_EQ(back.height, 5);
  EXPECT_EQ(back.channels, image.channels) << "R, G, B, A first, the others by name";
  EXPECT_EQ(back.pixels, image.pixels);
}

TEST_F(Exr, HalvesAreRoundedToElevenBits) {
  const Image image = random_image(9, 4, {"R", "G", "B"}, 0.0f, 10.0f);
  write_exr(file("a.exr"), image);
  const Image back = read_exr(file("a.exr"));
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    EXPECT_EQ(back.pixels[i], static_cast<float>(Imath::half(image.pixels[i])));
}

TEST_F(Exr, WhatCannotBeStoredIsClampedOrZero) {
  Image image(5, 1, {"R", "Z"});
  const float infinity = std::numeric_limits<float>::infinity();
  image.pixels = {NAN, NAN, infinity, infinity, -infinity, 1.0f, 1e6f, 1e6f, -1e6f, -1e6f};
  write_exr(file("a.exr"), image);
  EXPECT_EQ(read_exr(file("a.exr")).pixels,
            (std::vector<float>{0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 1.0f, 65504.0f, 1e6f, -65504.0f, -1e6f}));
}

TEST_F(Exr, ColorIsHalfAndDataIsFloat) {
  const Image image = random_image(2, 2, {"R", "albedo.G", "crypto00.R", "Z", "normal.Y", "A"}, 0.0f, 1.0f);
  write_exr(file("a.exr"), image, {.float_layers = {"crypto00"}});
  const Imf::InputFile in(file("a.exr").c_str());
  const Imf::ChannelList& channels = in.header().channels();
  for (const char* name : {"R", "albedo.G", "A"}) EXPECT_EQ(channels[name].type, Imf::HALF) << name;
  for (const char* name : {"crypto00.R", "Z", "normal.Y"}) EXPECT_EQ(channels[name].type, Imf::FLOAT) << name;
}

TEST_F(Exr, HeaderIsWhatCompositorsExpect) {
  ExrOptions options;
  options.data_offset = {10, 20};
  options.display_size = V2i(64, 48);
  write_exr(file("a.exr"), random_image(8, 4, {"R", "G", "B", "A"}, 0.0f, 1.0f), options);
  const Imf::InputFile in(file("a.exr").c_str());
  const Imf::Header& header = in.header();
  EXPECT_EQ(header.compression(), Imf::ZIPS_COMPRESSION);
  EXPECT_EQ(header.lineOrder(), Imf::INCREASING_Y);
  EXPECT_EQ(header.displayWindow(), Imath::Box2i(V2i(0, 0), V2i(63, 47)));
  EXPECT_EQ(header.dataWindow(), Imath::Box2i(V2i(10, 20), V2i(17, 23)));
  EXPECT_EQ(header.pixelAspectRatio(), 1.0f);
  EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("colorInteropID").value(), "lin_rec709_scene");
  EXPECT_TRUE(header.find("chromaticities") == header.end());
  EXPECT_EQ(read_exr(file("a.exr")).width, 8);
}

TEST_F(Exr, MetadataReturns) {
  ExrOptions options;
  options.metadata = {{"twopass/spp", 64},
                      {"twopass/integrator", std::string("twopass")},
                      {"twopass/a_name_of_more_than_31_characters", 0.5f}};
  write_exr(file("a.exr"), random_image(2, 2, {"R", "G", "B"}, 0.0f, 1.0f), options);
  ExrMetadata metadata;
  (void)read_exr(file("a.exr"), &metadata);
  for (const auto& entry : options.metadata)
    EXPECT_NE(std::find(metadata.begin(), metadata.end(), entry), metadata.end()) << entry.first;
}

TEST_F(Exr, SamePictureSameBytes) {
  const Image image = random_image(16, 16, {"R", "G", "B", "A"}, 0.0f, 1.0f);
  write_exr(file("a.exr"), image);
  write_exr(file("b.exr"), image);
  EXPECT_EQ(content_of(file("a.exr")), content_of(file("b.exr")));
}

TEST_F(Exr, BadNamesAreErrors) {
  EXPECT_TRUE(contains(error_of([&] { write_exr(file("a.exr"), Image(1, 1, {"R", "R"})); }), "used twice"));
  EXPECT_TRUE(contains(error_of([&] { write_exr(file("a.exr"), Image(1, 1, {""})); }), "empty"));
  EXPECT_TRUE(contains(error_of([&] { write_exr(file("a.exr"), Image(0, 0, {"R"})); }), "no pixels"));
  EXPECT_EQ(files_in_folder(), 0u);
}

TEST_F(Exr, MissingAndForeignFilesAreErrors) {
  EXPECT_TRUE(contains(error_of([&] { (void)read_exr(file("none.exr")); }), "no such file"));
  EXPECT_TRUE(contains(error_of([&] { (void)read_exr(folder()); }), "folder"));
  put(file("text.exr"), "this is no picture");
  EXPECT_TRUE(contains(error_of([&] { (void)read_exr(file("text.exr")); }), "no OpenEXR"));
  put(file("empty.exr"), "");
  EXPECT_TRUE(contains(error_of([&] { (void)read_exr(file("empty.exr")); }), "no OpenEXR"));
}

TEST_F(Exr, TruncatedAnywhereIsAnError) {
  write_exr(file("a.exr"), random_image(16, 16, {"R", "G", "B", "A"}, 0.0f, 1.0f));
  const std::string whole = content_of(file("a.exr"));
  for (std::size_t size = 0; size < whole.size(); size += 1 + whole.size() / 97) {
    put(file("cut.exr"), whole.substr(0, size));
    EXPECT_THROW((void)read_exr(file("cut.exr")), Error) << size << " of " << whole.size() << " bytes";
  }
}

TEST_F(Exr, DamagedBytesNeverCrash) {
  write_exr(file("a.exr"), random_image(8, 8, {"R", "G", "B"}, 0.0f, 1.0f));
  const std::string whole = content_of(file("a.exr"));
  std::mt19937 generator(11);
  int errors = 0;
  for (int i = 0; i < 400; ++i) {
    std::string damaged = whole;
    for (int k = 0; k < 3; ++k) damaged[generator() % damaged.size()] = static_cast<char>(generator());
    put(file("bad.exr"), damaged);
    try {
      (void)read_exr(file("bad.exr"));
    } catch (const Error&) {
      ++errors;
    }
  }
  EXPECT_GT(errors, 0);
}

// Writes pixels 1, 2, 3 ... of one channel into the data window of each part.
void write_parts(const std::string& path, const std::vector<std::pair<std::string, Imath::Box2i>>& parts,
                 const std::vector<std::string>& channels) {
  std::vector<Imf::Header> headers;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    Imf::Header header(Imath::Box2i({0, 0}, {1, 1}), parts[i].second);
    header.setName(parts[i].first);
    header.setType(Imf::SCANLINEIMAGE);
    header.channels().insert(channels[i], Imf::Channel(Imf::FLOAT));
    headers.push_back(header);
  }
  Imf::MultiPartOutputFile out(path.c_str(), headers.data(), static_cast<int>(headers.size()));
  float value = 0.0f;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Imath::Box2i& window = headers[i].dataWindow();
    std::vector<float> values(static_cast<std::size_t>((window.size().x + 1) * (window.size().y + 1)));
    for (float& v : values) v = ++value;
    Imf::FrameBuffer frame;
    frame.insert(channels[i], Imf::Slice::Make(Imf::FLOAT, values.data(), window));
    Imf::OutputPart output(out, static_cast<int>(i));
    output.setFrameBuffer(frame);
    output.writePixels(window.size().y + 1);
  }
}

TEST_F(Exr, LayersOfAllPartsAreRead) {
  const Imath::Box2i all({0, 0}, {1, 1});
  write_parts(file("parts.exr").string(), {{"first", all}, {"second", all}, {"third", all}}, {"Y", "a.Z", "Y"});
  const Image image = read_exr(file("parts.exr"));
  EXPECT_EQ(image.channels, (std::vector<std::string>{"Y", "a.Z", "third.Y"}));
  EXPECT_EQ(image.pixels, (std::vector<float>{1, 5, 9, 2, 6, 10, 3, 7, 11, 4, 8, 12}));
}

TEST_F(Exr, PartsWithOtherWindowsArePutInPlace) {
  write_parts(file("parts.exr").string(), {{"a", {{0, 0}, {1, 1}}}, {"b", {{1, -1}, {2, 0}}}}, {"Y", "b.Y"});
  const Image image = read_exr(file("parts.exr"));
  // The lower left pixel of b is the upper right one of a.
  EXPECT_EQ(image.pixels, (std::vector<float>{1, 0, 2, 7, 3, 0, 4, 0}));
}

TEST_F(Exr, SubsampledChromaIsAnError) {
  {
    Imf::RgbaOutputFile out(file("yc.exr").c_str(), 4, 4, Imf::WRITE_YC);
    const std::vector<Imf::Rgba> pixels(16, Imf::Rgba(1.0f, 0.5f, 0.25f));
    out.setFrameBuffer(pixels.data(), 1, 4);
    out.writePixels(4);
  }
  EXPECT_TRUE(contains(error_of([&] { (void)read_exr(file("yc.exr")); }), "subsampled"));
}

}  // namespace
}  // namespace twopass
