// The rooms face one way: a file includes only its own room and rooms to its left (README, map of the code).
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace {

namespace fs = std::filesystem;

const fs::path root = TWOPASS_SOURCE_DIR;

// In order; a longer name stands before a shorter one that it begins with.
const std::vector<std::string> rooms{"render/core/", "render/image/", "materials/",   "render/scene/",
                                     "render/load/", "radiosity/",    "integrators/", "render/"};

// Libraries and the only places that may include them.
const std::vector<std::pair<std::string, std::string>> homes{
    {"embree3/", "render/scene/embree.h"},
    {"embree4/", "render/scene/embree.h"},
    {"render/scene/embree", "render/scene/"},
    {"tbb/", "render/core/parallel.cpp"},
    {"OpenColorIO/", "render/image/color"},
    {"OpenEXR/", "render/image/exr"},
    {"OpenImageIO/", "render/image/oiio_"},
    {"tiny_obj_loader", "render/load/"},
    {"tiny_gltf", "render/load/gltf_"},
    {"pugixml", "render/load/"},
    {"CLI/", "render/"},
    {"zlib.h", "render/core/deflate.cpp"},
};

std::size_t room_of(const std::string& path) {
  for (std::size_t i = 0; i < rooms.size(); ++i)
    if (path.starts_with(rooms[i])) return i;
  return rooms.size();
}

std::vector<fs::path> sources() {
  std::vector<fs::path> found;
  for (const char* folder : {"render", "radiosity", "integrators", "materials"})
    for (const auto& entry : fs::recursive_directory_iterator(root / folder))
      if (entry.path().extension() == ".h" || entry.path().extension() == ".cpp") found.push_back(entry.path());
  return found;
}

// Calls visit(file:line, room of the file, included path) for every include directive.
template <class Visit>
void for_each_include(Visit visit) {
  const std::regex include(R"re(\s*#\s*include\s*[<"]([^>"]+)[>"].*)re");
  for (const fs::path& file : sources()) {
    const std::string name = fs::relative(file, root).generic_string();
    std::ifstream in(file);
    std::string line;
    for (int number = 1; std::getline(in, line); ++number) {
      std::smatch match;
      if (std::regex_match(line, match, include))
        visit(name, name + ":" + std::to_string(number), match[1].str());
    }
  }
}

TEST(Layout, FilesIncludeOnlyTheirOwnRoomAndThoseToTheLeft) {
  int includes = 0;
  for_each_include([&](const std::string& file, const std::string& where, const std::string& included) {
    ++includes;
    const std::size_t to = room_of(included);
    if (to == rooms.size()) return;
    EXPECT_LE(to, room_of(file)) << where << " includes " << included;
  });
  EXPECT_GT(includes, 100);
}

TEST(Layout, EachLibraryHasOneHome) {
  for_each_include([&](const std::string& file, const std::string& where, const std::string& included) {
    for (const auto& [library, home] : homes)
      EXPECT_TRUE(!included.starts_with(library) || file.starts_with(home))
          << where << " includes " << included;
  });
}

TEST(Layout, HeadersSayWhatTheyAreForAndAreGuarded) {
  for (const fs::path& file : sources()) {
    if (file.extension() != ".h") continue;
    std::ifstream in(file);
    std::string first, all((std::istreambuf_iterator<char>(in)), {});
    first = all.substr(0, all.find('\n'));
    EXPECT_TRUE(first.starts_with("// ") && first.size() > 20) << file;
    EXPECT_NE(all.find("#pragma once"), std::string::npos) << file;
  }
}

TEST(Layout, TopLevelHoldsNothingElse) {
  const std::vector<std::string> allowed{
      "CMakeLists.txt", "CMakePresets.json", "LICENSE", "README.md", "render", "radiosity",
      "integrators",    "materials",         "scenes",  "tests",     "build"};
  for (const auto& entry : fs::directory_iterator(root)) {
    const std::string name = entry.path().filename().string();
    EXPECT_TRUE(name.starts_with('.') || std::find(allowed.begin(), allowed.end(), name) != allowed.end())
        << name;
  }
}

}  // namespace
