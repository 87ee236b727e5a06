// Layers in files as other programs find them: read back by OpenEXR itself, Cryptomatte by a decoder that knows
// nothing of ours.
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

namespace {

namespace fs = std::filesystem;

// Everything in a file.
struct File {
  explicit File(const fs::path& path) : file(path.c_str()) {
    for (int p = 0; p < file.parts(); ++p) {
      const Imf::Header& header = file.header(p);
      const Imath::Box2i window = header.dataWindow();
      width = window.max.x - window.min.x + 1;
      height = window.max.y - window.min.y + 1;
      Imf::FrameBuffer frame;
      for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
        std::vector<float>& plane = planes[c.name()];
        EXPECT_TRUE(plane.empty()) << c.name() << " twice";
        plane.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
        types[c.name()] = c.channel().type;
        frame.insert(c.name(), Imf::Slice::Make(Imf::FLOAT, plane.data(), window));
      }
      Imf::InputPart part(file, p);
      part.setFrameBuffer(frame);
      part.readPixels(window.min.y, window.max.y);
    }
  }
  [[nodiscard]] const Imf::Header& header(int part = 0) const { return file.header(part); }
  [[nodiscard]] std::string text(const std::string& name) const {
    const auto* a = header().findTypedAttribute<Imf::StringAttribute>(name);
    return a ? a->value() : "";
  }
  Imf::MultiPartInputFile file;
  std::map<std::string, std::vector<float>> planes;
  std::map<std::string, Imf::PixelType> types;
  int width = 0, height = 0;
};

class LayerFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("twopass-layers-" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  int run(const std::string& arguments, std::string* error = nullptr) const {
    return call("render " + arguments, error);
  }
  int call(const std::string& arguments, std::string* error = nullptr) const {
    const fs::path err = folder_ / "stderr";
    const std::string command = "cd '" + folder_.string() + "' && '" TWOPASS_PROGRAM "' " + arguments +
                                " >/dev/null 2>'" + err.string() + "'";
    const int status = std::system(command.c_str());
    std::ifstream in(err);
    std::string text{std::istreambuf_iterator<char>(in), {}};
    if (error) *error = text;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  }
  fs::path folder_;
  const std::string box_ =
      "'" TWOPASS_SOURCE_DIR "/scenes/cornell-box-specular/scene.xml' --size 48x32 --spp 16 ";
};

constexpr const char* light_layers[] = {
    "emission",        "background",        "diffuse_direct",      "diffuse_indirect",
    "specular_direct", "specular_indirect", "transmission_direct", "transmission_indirect"};

TEST_F(LayerFiles, AllLayersWithTheirNamesTypesAndSumsByEveryIntegrator) {
  for (const std::string integrator : {"path", "twopass", "unbiased", "radiosity", "direct"}) {
    ASSERT_EQ(run(box_ + "--aov all --light-groups --exr-type float -o a.exr --integrator " + integrator), 0);
    const File file(folder_ / "a.exr");
    std::set<std::string> names;
    for (const auto& [name, plane] : file.planes) names.insert(name);
    std::set<std::string> expected{"R",
                                   "G",
                                   "B",
                                   "A",
                                   "Z",
                                   "N.X",
                                   "N.Y",
                                   "N.Z",
                                   "Ng.X",
                                   "Ng.Y",
                                   "Ng.Z",
                                   "P.X",
                                   "P.Y",
                                   "P.Z",
                                   "uv.U",
                                   "uv.V",
                                   "id.object",
                                   "id.material",
                                   "element.X",
                                   "cache.X",
                                   "samples.X",
                                   "invalid.X",
                                   "choice.lookup",
                                   "choice.gather",
                                   "choice.trace"};
    std::vector<std::string> colors{"albedo", "radiosity", "variance", "light_lamp"};
    colors.insert(colors.end(), std::begin(light_layers), std::end(light_layers));
    for (const std::string& color : colors)
      for (const char* c : {".R", ".G", ".B"}) expected.insert(color + c);
    EXPECT_EQ(names, expected) << integrator;
    EXPECT_EQ(file.types.at("id.object"), Imf::UINT);
    for (const std::string c : {"R", "G", "B"})
      for (std::size_t i = 0; i < file.planes.at(c).size(); ++i) {
        const float truth = file.planes.at(c)[i];
        float sum = 0.0f, size = 1e-6f;
        for (const char* layer : light_layers) {
          const float part = file.planes.at(layer + ("." + c))[i];
          sum += part;
          size += std::abs(part);
        }
        ASSERT_NEAR(sum, truth, 2e-6f * size) << integrator << " " << c << " pixel " << i;
        ASSERT_NEAR(file.planes.at("light_lamp." + c)[i], truth, 2e-6f * size) << integrator;
      }
    for (std::size_t i = 0; i < file.planes.at("A").size(); ++i)
      EXPECT_EQ(file.planes.at("samples.X")[i], 16.0f);
  }
}

// A picture with layers is the picture without, byte for byte, on any number of threads.
TEST_F(LayerFiles, LayersChangeNothingAndAreTheSameOnAnyNumberOfThreads) {
  ASSERT_EQ(run(box_ + "-o plain.exr"), 0);
  ASSERT_EQ(run(box_ + "--aov all --light-groups --cryptomatte all -o a.exr --threads 1"), 0);
  ASSERT_EQ(run(box_ + "--aov all --light-groups --cryptomatte all -o b.exr --threads 3"), 0);
  const File plain(folder_ / "plain.exr"), a(folder_ / "a.exr"), b(folder_ / "b.exr");
  for (const char* c : {"R", "G", "B", "A"}) EXPECT_EQ(plain.planes.at(c), a.planes.at(c)) << c;
  EXPECT_EQ(a.planes.size(), b.planes.size());
  for (const auto& [name, plane] : a.planes)
    EXPECT_EQ(std::memcmp(plane.data(), b.planes.at(name).data(), plane.size() * sizeof(float)), 0) << name;
}

TEST_F(LayerFiles, HeadersAreWhatProgramsExpect) {
  ASSERT_EQ(run(box_ + "--exr-type half --aov N,Z,light --crop 8,4,16,12 --overscan 3 -o a.exr"), 0);
  const File file(folder_ / "a.exr");
  const Imf::Header& header = file.header();
  EXPECT_EQ(file.file.parts(), 1);
  EXPECT_EQ(header.displayWindow(), Imath::Box2i({0, 0}, {47, 31}));
  EXPECT_EQ(header.dataWindow(), Imath::Box2i({5, 1}, {26, 18}));
  EXPECT_EQ(header.compression(), Imf::ZIPS_COMPRESSION);
  EXPECT_EQ(header.lineOrder(), Imf::INCREASING_Y);
  EXPECT_EQ(header.pixelAspectRatio(), 1.0f);
  EXPECT_EQ(file.types.at("R"), Imf::HALF);
  EXPECT_EQ(file.types.at("diffuse_direct.G"), Imf::HALF);
  EXPECT_EQ(file.types.at("N.Y"), Imf::FLOAT);
  EXPECT_EQ(file.types.at("Z"), Imf::FLOAT);
  EXPECT_EQ(file.text("colorInteropID"), "lin_rec709_scene");
  EXPECT_FALSE(Imf::hasChromaticities(header)) << "Rec.709 is what readers assume";
  EXPECT_TRUE(Imf::hasWorldToCamera(header) && Imf::hasWorldToNDC(header));
  for (const char* name : {"twopass/version", "twopass/integrator", "twopass/sceneFingerprint", "twopass/ocio",
                           "twopass/stopReason"})
    EXPECT_FALSE(file.text(name).empty()) << name;
  for (const char* name : {"twopass/spp", "twopass/seed", "twopass/biasMean", "twopass/biasCi95"})
    EXPECT_NE(header.find(name), header.end()) << name;
  EXPECT_EQ(header.find("twopass/seconds"), header.end()) << "equal renders are equal files";

  ASSERT_EQ(run(box_ + "--aov N,Z,light --cryptomatte object --exr-parts layer --exr-compression piz "
                       "--exr-chromaticities always --exr-seconds -o b.exr"),
            0);
  const File parts(folder_ / "b.exr");
  std::set<std::string> names;
  for (int p = 0; p < parts.file.parts(); ++p) {
    names.insert(parts.header(p).name());
    EXPECT_EQ(parts.header(p).compression(), Imf::PIZ_COMPRESSION);
  }
  EXPECT_EQ(names.size(), 1u + 8u + 2u + 3u);
  EXPECT_EQ(parts.header(0).name(), "rgba");
  EXPECT_TRUE(names.contains("Z") && names.contains("N") && names.contains("diffuse_direct"));
  EXPECT_TRUE(Imf::hasChromaticities(parts.header()));
  EXPECT_NE(parts.header().find("twopass/seconds"), parts.header().end());
  for (int p = 0; p < parts.file.parts(); ++p)
    if (const std::string name = parts.header(p).name(); name == "N" || name == "CryptoObject00") {
      EXPECT_EQ(parts.header(p).findTypedAttribute<Imf::StringAttribute>("colorInteropID")->value(), "data")
          << name;
    }
}

// Known points of the scene land in the pixels that show them, by the matrices in the file.
TEST_F(LayerFiles, PositionsProjectToTheirPixels) {
  ASSERT_EQ(run(box_ + "--aov P,Z,N --integrator direct -o a.exr"), 0);
  const File file(folder_ / "a.exr");
  const Imath::M44f& to_ndc = Imf::worldToNDC(file.header());
  const Imath::M44f& to_camera = Imf::worldToCamera(file.header());
  int seen = 0;
  for (int y = 0; y < file.height; ++y)
    for (int x = 0; x < file.width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y * file.width + x);
      if (file.planes.at("A")[i] < 1.0f) continue;
      const Imath::V3f p(file.planes.at("P.X")[i], file.planes.at("P.Y")[i], file.planes.at("P.Z")[i]);
      Imath::V3f ndc, in_camera;
      to_ndc.multVecMatrix(p, ndc);
      to_camera.multVecMatrix(p, in_camera);
      // The sample nearest to the centre of sixteen lies within a pixel and a half of it.
      EXPECT_NEAR(ndc.x * 48.0f, static_cast<float>(x) + 0.5f, 1.5f);
      EXPECT_NEAR(ndc.y * 32.0f, static_cast<float>(y) + 0.5f, 1.5f);
      EXPECT_NEAR(in_camera.z, file.planes.at("Z")[i], 1e-4f * in_camera.z);
      ++seen;
    }
  EXPECT_GT(seen, 200);
}

// --- Cryptomatte, from the specification alone ---

std::uint32_t bits_of(float value) {
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

TEST_F(LayerFiles, CryptomatteDecodesToWhatIsSeen) {
  ASSERT_EQ(run(box_ + "--cryptomatte object,material,asset --exr-type float -o a.exr --integrator direct"), 0);
  const File file(folder_ / "a.exr");
  std::set<std::string> found;
  for (auto a = file.header().begin(); a != file.header().end(); ++a) {
    const std::string attribute = a.name();
    if (!attribute.starts_with("cryptomatte/") || !attribute.ends_with("/name")) continue;
    const std::string prefix = attribute.substr(0, attribute.size() - 4), name = file.text(attribute);
    EXPECT_LE(prefix.size() - std::strlen("cryptomatte//"), 7u);
    EXPECT_EQ(file.text(prefix + "hash"), "MurmurHash3_32");
    EXPECT_EQ(file.text(prefix + "conversion"), "uint32_to_float32");
    std::map<std::uint32_t, std::string> manifest;
    const nlohmann::json named = nlohmann::json::parse(file.text(prefix + "manifest"));
    for (const auto& [thing, hash] : named.items())
      manifest[static_cast<std::uint32_t>(std::stoul(hash.get<std::string>(), nullptr, 16))] = thing;
    EXPECT_GT(manifest.size(), 3u);
    found.insert(name);
    std::set<std::string> seen;
    for (std::size_t i = 0; i < file.planes.at("A").size(); ++i) {
      float sum = 0.0f, last = 1.0f;
      for (int rank = 0; rank < 6; ++rank) {
        const std::string layer = name + "0" + std::to_string(rank / 2) + ".";
        const float id = file.planes.at(layer + "RGBA"[rank % 2 * 2])[i],
                    coverage = file.planes.at(layer + "RGBA"[rank % 2 * 2 + 1])[i];
        EXPECT_EQ(file.types.at(layer + "R"), Imf::FLOAT);
        EXPECT_LE(coverage, last) << "ranks are sorted";
        last = coverage;
        sum += coverage;
        if (coverage == 0.0f) continue;
        ASSERT_TRUE(manifest.contains(bits_of(id))) << name << " pixel " << i;
        seen.insert(manifest[bits_of(id)]);
      }
      // At most six things are in a pixel here, so they cover what there is.
      EXPECT_NEAR(sum, file.planes.at("A")[i], 1e-5f);
    }
    EXPECT_GT(seen.size(), 3u) << name;
  }
  EXPECT_EQ(found, (std::set<std::string>{"CryptoObject", "CryptoMaterial", "CryptoAsset"}));
}

TEST_F(LayerFiles, WhatCannotBeIsAnErrorBeforeAnyWork) {
  const std::pair<const char*, const char*> cases[] = {
      {"-o a.exr --aov colour", "diffuse_direct"},
      {"-o a.exr --cryptomatte faces", "asset"},
      {"-o a.png --aov N", "only .exr"},
      {"-o a.exr --aov N --exr-compression dwaa", "N.X"},
      {"-o a.exr --cryptomatte object --exr-compression pxr24", "CryptoObject00"},
      {"-o a.exr --exr-compression best", "zips"},
      {"-o a.exr --exr-parts many", "single"}};
  for (const auto& [arguments, part] : cases) {
    std::string error;
    EXPECT_EQ(run(box_ + arguments, &error), 1) << arguments;
    EXPECT_NE(error.find(part), std::string::npos) << error;
    EXPECT_FALSE(fs::exists(folder_ / "a.exr"));
  }
  EXPECT_EQ(run(box_ + "-o a.exr --aov light --exr-compression dwaa"), 0) << "colours alone may be packed so";
}

TEST_F(LayerFiles, LightGroupsAreNamedAsTheSceneSays) {
  std::ofstream(folder_ / "lamps.xml") << R"(<scene version='3.0.0'>
    <sensor type='perspective'><transform name='to_world'><lookat origin='0,0,4' target='0,0,0' up='0,1,0'/></transform>
      <film type='hdrfilm'><integer name='width' value='16'/><integer name='height' value='16'/></film></sensor>
    <shape type='rectangle'/>
    <shape type='sphere' id='bulb'><point name='center' x='0' y='0' z='2'/><float name='radius' value='.1'/>
      <emitter type='area'><rgb name='radiance' value='3'/></emitter></shape>
    <shape type='sphere'><point name='center' x='1' y='0' z='2'/><float name='radius' value='.1'/>
      <emitter type='area'><rgb name='radiance' value='5,1,1'/><string name='light_group' value='key.warm'/></emitter></shape>
    <emitter type='point'><point name='position' x='0' y='1' z='2'/></emitter>
    <emitter type='constant' id='sky'/>
  </scene>)";
  ASSERT_EQ(run("lamps.xml --spp 16 --light-groups --exr-type float --integrator path -o a.exr"), 0);
  const File file(folder_ / "a.exr");
  const std::string groups[] = {"light_bulb", "light_key_warm", "light_default", "light_sky"};
  for (std::size_t i = 0; i < file.planes.at("R").size(); ++i) {
    float sum = 0.0f;
    for (const std::string& group : groups) sum += file.planes.at(group + ".R")[i];
    EXPECT_NEAR(sum, file.planes.at("R")[i], 2e-6f * sum);
  }
  EXPECT_EQ(file.planes.size(), 4u + 3u * std::size(groups));
}

// A corner under two lamps, solved once for all pictures.
TEST_F(LayerFiles, LightGroupsAreKeptWithASolutionAndTakenFromIt) {
  std::ofstream(folder_ / "corner.xml") << R"(<scene version='3.0.0'>
    <sensor type='perspective'><transform name='to_world'><lookat origin='0,-3,3' target='0,0,0' up='0,0,1'/></transform>
      <film type='hdrfilm'><integer name='width' value='24'/><integer name='height' value='24'/></film></sensor>
    <shape type='rectangle'/>
    <shape type='rectangle'><transform name='to_world'><rotate x='1' angle='90'/><translate y='1' z='1'/></transform></shape>
    <shape type='sphere' id='bulb'><point name='center' x='-.5' y='0' z='1'/><float name='radius' value='.1'/>
      <emitter type='area'><rgb name='radiance' value='9'/></emitter></shape>
    <shape type='sphere' id='key'><point name='center' x='.5' y='0' z='1'/><float name='radius' value='.1'/>
      <emitter type='area'><rgb name='radiance' value='9,1,1'/></emitter></shape>
  </scene>)";
  ASSERT_EQ(call("solve corner.xml --light-groups --elements 300 --quiet -o kept.radiosity"), 0);
  ASSERT_EQ(call("solve corner.xml --elements 300 --quiet -o plain.radiosity"), 0);
  std::string said;
  const std::string render = "corner.xml --spp 16 --light-groups --exr-type float --solution ";
  ASSERT_EQ(run(render + "plain.radiosity -o plain.exr", &said), 0);
  EXPECT_NE(said.find("light groups: 2, each solved by itself"), std::string::npos) << said;
  ASSERT_EQ(run(render + "kept.radiosity -o kept.exr", &said), 0);
  EXPECT_NE(said.find("light groups: 2, taken from the solution's file"), std::string::npos) << said;
  const File plain(folder_ / "plain.exr"), kept(folder_ / "kept.exr");
  EXPECT_EQ(plain.planes.at("R"), kept.planes.at("R"));
  const std::vector<float>&bulb = kept.planes.at("light_bulb.R"), &key = kept.planes.at("light_key.R");
  double total = 0.0, difference = 0.0;
  for (std::size_t i = 0; i < bulb.size(); ++i) {
    EXPECT_NEAR(bulb[i] + key[i], kept.planes.at("R")[i], 2e-6f * (bulb[i] + key[i]));
    total += bulb[i];
    difference += std::abs(bulb[i] - plain.planes.at("light_bulb.R")[i]);
  }
  EXPECT_GT(total, 0.0);
  EXPECT_LT(difference, 0.01 * total);
  EXPECT_EQ(call("solve corner.xml --light-groups -o a.ply", &said), 1);
  EXPECT_NE(said.find("--light-groups: only .radiosity files keep light groups"), std::string::npos) << said;
}

}  // namespace
