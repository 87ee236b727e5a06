// Shapes are read in parallel, meshes of the same file once: neither may show.
#include "render/core/parallel.h"
#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

class MitsubaShapeOrder : public LoadTest {
 protected:
  /// An <shape type="obj"> with further properties.
  static std::string obj(const std::string& file, const std::string& more = "") {
    return "<shape type='obj'><string name='filename' value='" + file + "'/>" + more + "</shape>\n";
  }
  LoadedScene read(const std::string& body) const {
    return load_xml("<scene version='3.0.0'>\n" + body + "</scene>");
  }
  static std::string translate(int x) {
    return std::string("<transform name='to_world'><translate x='") + std::to_string(x) + "'/></transform>";
  }
};

constexpr std::string_view triangle =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\nl 1 2\n";

TEST_F(MitsubaShapeOrder, TheFirstErrorIsTheFirstInTheFile) {
  write("a.obj", triangle);
  std::string body;
  for (int i = 0; i < 40; ++i) body += obj("a.obj", translate(i));
  for (int i = 0; i < 3; ++i) {
    const std::string name = std::string("bad") + std::to_string(i) + ".obj";
    write(name, std::string("v 0 0 0\nf 1 2 ") + std::to_string(7 + i) + "\n");
    body += obj(name) + obj("a.obj");
  }
  for (const int threads : {1, 2, 4}) {
    const ThreadLimit limit(threads);
    for (int repeat = 0; repeat < 5; ++repeat) expect_error([&] { read(body); }, {"bad0.obj:2: "});
  }
}

TEST_F(MitsubaShapeOrder, ShapesAndNotesComeInTheOrderOfTheFile) {
  std::string body;
  for (int i = 0; i < 30; ++i) {
    const std::string name = std::string("m") + std::to_string(i) + ".obj";
    write(name, std::string(triangle) + "f 1 1 2\n");
    body += obj(name, translate(i));
  }
  std::vector<std::string> notes;
  for (const int threads : {1, 3}) {
    const ThreadLimit limit(threads);
    const LoadedScene loaded = read(body);
    ASSERT_EQ(loaded.scene.shapes.size(), 30u);
    for (std::size_t i = 0; i < 30; ++i) EXPECT_EQ(mesh_of(loaded, i).positions[0].x, static_cast<float>(i));
    if (notes.empty()) notes = loaded.notes;
    EXPECT_EQ(loaded.notes, notes);
    EXPECT_TRUE(has_note(loaded, "m0.obj: 1 'l' statements"));
  }
}

TEST_F(MitsubaShapeOrder, AFileThatSeveralShapesNameIsReadOnce) {
  write("a.obj", triangle);
  const std::string as_stored = "<boolean name='flip_tex_coords' value='false'/>";
  const LoadedScene loaded =
      read(obj("a.obj", translate(1)) + obj("a.obj", as_stored) + obj("a.obj", translate(2)) +
           obj("a.obj", as_stored + translate(3)) + obj("a.obj"));
  ASSERT_EQ(loaded.scene.shapes.size(), 5u);
  const float x[] = {1, 0, 2, 3, 0}, v[] = {1, 0, 1, 0, 1};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(mesh_of(loaded, i).positions[0], V3f(x[i], 0, 0)) << i;
    EXPECT_EQ(mesh_of(loaded, i).uvs[0], V2f(0, v[i])) << i;
  }
  // The note of the reader: once for each way of reading it.
  EXPECT_TRUE(has_note(loaded, "a.obj: 1 'l' statements are left out: only polygons are read (2 times)"));
}

}  // namespace
}  // namespace twopass
