#include "render/load/load.h"

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

using Load = LoadTest;

constexpr std::string_view triangle = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";

TEST_F(Load, ChoosesByExtensionInAnyCase) {
  EXPECT_EQ(load_scene(write("a.OBJ", triangle), {}).scene.shapes.size(), 1u);
  EXPECT_EQ(
      load_scene(write("a.Xml", "<scene version='3.0.0'><shape type='cube'/></scene>"), {}).scene.shapes.size(),
      1u);
}

TEST_F(Load, RefusesUnknownFormats) {
  expect_error([&] { load_scene(write("a.blend", ""), {}); },
               {"a.blend: unknown scene format '.blend'", ".xml (Mitsuba 0.4 to 3.x), .obj (Wavefront)"});
}

TEST_F(Load, RefusesWhatIsNoFile) {
  expect_error([&] { load_scene(folder_ / "none.obj", {}); }, {"none.obj: there is no such file"});
  expect_error([&] { load_scene(folder_ / "none.xml", {}); }, {"none.xml: there is no such file"});
  std::filesystem::create_directories(folder_ / "folder.obj");
  expect_error([&] { load_scene(folder_ / "folder.obj", {}); }, {"this is a folder"});
  expect_error([&] { load_scene(folder_, {}); }, {"this is a folder"});
  std::filesystem::create_symlink("/dev/zero", folder_ / "device.obj");
  expect_error([&] { load_scene(folder_ / "device.obj", {}); }, {"this is not a regular file"});
}

TEST_F(Load, ObjFilesHaveNoParameters) {
  expect_error(
      [&] {
        load_scene(write("a.obj", triangle), {{"spp", "4"}});
      },
      {"-D spp: only Mitsuba's scenes have parameters"});
}

}  // namespace
}  // namespace twopass
