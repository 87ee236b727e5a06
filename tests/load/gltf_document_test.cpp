#include "render/load/gltf_document.h"

#include <sys/stat.h>

#include "tests/load/gltf_writer.h"
#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

class GltfDocumentTest : public LoadTest {
 protected:
  GltfDocument read(const std::string& text) {
    notes_ = Notes();
    return read_gltf(write("scene.gltf", text), notes_);
  }
  void refused(const GltfWriter& writer, std::initializer_list<std::string_view> parts) {
    expect_error([&] { read(writer.gltf()); }, parts);
  }
  static GltfWriter with_buffer(nlohmann::json buffer) {
    GltfWriter w;
    w.document["buffers"] = nlohmann::json::array({std::move(buffer)});
    return w;
  }
  Notes notes_;
};

TEST_F(GltfDocumentTest, BuffersOfAllKinds) {
  write("data/my file.bin", "0123456789");
  const GltfDocument external = read(with_buffer({{"uri", "data/my%20file.bin"}, {"byteLength", 4}}).gltf());
  EXPECT_EQ(external.buffers.at(0).view, "0123");  // files may be longer
  EXPECT_GT(external.size, 10u);
  EXPECT_EQ(read(with_buffer({{"uri", "DATA\\My%20File.bin"}, {"byteLength", 4}}).gltf()).buffers[0].view,
            "0123");
  EXPECT_EQ(read(with_buffer({{"uri", "data:;base64,YWJj"}, {"byteLength", 3}}).gltf()).buffers[0].view, "abc");
  GltfWriter w;
  w.bytes = "abcdef";
  EXPECT_EQ(read_gltf(write("scene.glb", w.glb()), notes_).buffers.at(0).view, "abcdef");
}

TEST_F(GltfDocumentTest, BuffersThatAreNotThereAreRefused) {
  refused(with_buffer({{"uri", "none.bin"}, {"byteLength", 4}}),
          {"scene.gltf: buffer 0: ", "none.bin", "no such file"});
  refused(with_buffer({{"uri", "."}, {"byteLength", 4}}), {"buffer 0", "folder"});
  refused(with_buffer({{"uri", "http://x.org/a.bin"}, {"byteLength", 4}}), {"buffer 0", "nothing is fetched"});
  refused(with_buffer({{"uri", "data:;base64,YWJj"}, {"byteLength", 4}}), {"has 3 bytes instead of 4"});
  refused(with_buffer({{"byteLength", 4}}), {"has no uri, and there is no binary chunk"});
  refused(with_buffer({{"uri", "a.bin"}}), {"has no byteLength"});
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  refused(with_buffer({{"uri", "pipe"}, {"byteLength", 4}}), {"not a regular file"});
}

TEST_F(GltfDocumentTest, VersionsAndExtensions) {
  GltfWriter w;
  w.document["asset"]["version"] = "1.0";
  refused(w, {"scene.gltf: is of glTF version '1.0'", "convert"});
  w.document.erase("asset");
  refused(w, {"has no asset.version"});
  GltfWriter extended;
  extended.document["extensionsUsed"] = {"KHR_materials_ior", "VENDOR_a", "VENDOR_b"};
  read(extended.gltf());
  EXPECT_EQ(notes_.lines(),
            std::vector<std::string>{(folder_ / "scene.gltf").string() +
                                     ": extensions that are not supported are left out: VENDOR_a, VENDOR_b"});
  extended.document["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  refused(extended, {"requires the extension 'KHR_draco_mesh_compression'", "supported: KHR_lights_punctual"});
}

TEST_F(GltfDocumentTest, ImagesAreLocated) {
  GltfWriter w;
  w.add_view(std::vector<std::uint8_t>{1, 2, 3});
  w.add("images", {{"bufferView", 0}, {"mimeType", "image/png"}});
  w.add("images", {{"uri", "wood%20dark.png"}, {"name", "wood"}});
  w.add("images", {{"uri", "data:image/png;base64,YWJj"}});
  const GltfDocument document = read(w.gltf());
  EXPECT_EQ(document.images.at(0).bytes.view, "\1\2\3");
  EXPECT_EQ(document.images.at(1).path, folder_ / "wood dark.png");
  EXPECT_NE(document.images.at(1).name.find("image 1 'wood'"), std::string::npos);
  EXPECT_EQ(document.images.at(2).bytes.view, "abc");
  w.document["images"][0]["bufferView"] = 9;
  refused(w, {"image 0 refers to buffer view 9"});
  w.document["images"][0] = nlohmann::json::object();
  refused(w, {"image 0: has neither uri nor bufferView"});
}

}  // namespace
}  // namespace twopass
