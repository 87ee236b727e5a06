#include "render/load/obj_file.h"

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

ObjFile parse(std::string_view text) {
  Notes notes;
  return parse_obj(text, "a.obj", notes);
}

const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

std::vector<std::string> notes_of(const std::string& statements) {
  Notes notes;
  parse_obj(square + "f 1 2 3\n" + statements, "a.obj", notes);
  return notes.lines();
}

TEST(ObjFile, ReadsPositionsAndFaces) {
  const ObjFile file = parse("# comment\n\n" + square + "f 1 2 3 4\n");
  EXPECT_EQ(file.positions.size(), 4u);
  EXPECT_EQ(file.positions[2], V3f(1, 1, 0));
  ASSERT_EQ(file.faces.size(), 1u);
  EXPECT_EQ(file.faces[0].corner_count, 4u);
  EXPECT_EQ(file.faces[0].line, 7u);
  EXPECT_EQ(file.corners[1].position, 1u);
  EXPECT_EQ(file.corners[1].uv, no_obj_index);
  EXPECT_EQ(file.corners[1].normal, no_obj_index);
}

TEST(ObjFile, ReadsTheFourFormsOfACorner) {
  const ObjFile file = parse(square + "vt 0 1\nvn 0 0 2\nf 1 2/1 3//1 4/1/1 1/ 1// 1//1\n");
  const auto& c = file.corners;
  const std::uint32_t none = no_obj_index;
  const std::vector<std::array<std::uint32_t, 3>> expected{
      {0, none, none}, {1, 0, none}, {2, none, 0}, {3, 0, 0}, {0, none, none}, {0, none, none}, {0, none, 0}};
  ASSERT_EQ(c.size(), expected.size());
  for (std::size_t i = 0; i < c.size(); ++i)
    EXPECT_EQ((std::array{c[i].position, c[i].uv, c[i].normal}), expected[i]) << i;
  EXPECT_EQ(file.normals[0], V3f(0, 0, 1));
  EXPECT_EQ(file.uvs[0], V2f(0, 1));
}

TEST(ObjFile, ReadsWhatTinyobjloaderCannot) {
  EXPECT_EQ(parse("\xEF\xBB\xBF" + square + "f 1 2 3").positions.size(), 4u);  // a byte order mark
  EXPECT_EQ(parse(square + "f 1 2 3 # comment").corners.size(), 3u);
  EXPECT_EQ(parse(square + "f 1 2 3#4").corners.size(), 3u);
  const ObjFile joined = parse(square + "f 1 2 \\\n3 4\nf 1 2 3\n");
  EXPECT_EQ(joined.faces[0].corner_count, 4u);
  EXPECT_EQ(joined.faces[1].line, 7u);
  EXPECT_EQ(parse("v 0 0 0\r\nv 1 0 0\rv 1 1 0\r\nf\t1 2\t3\r").corners.size(), 3u);
}

TEST(ObjFile, NegativeIndicesCountBackwards) {
  const ObjFile file = parse(square + "f -4 -3 -2\nv 5 5 5\nf -1 -5 -4\n");
  EXPECT_EQ(file.corners[0].position, 0u);
  EXPECT_EQ(file.corners[3].position, 4u);
  EXPECT_EQ(file.corners[4].position, 0u);
}

TEST(ObjFile, IndicesMayPointForward) { EXPECT_EQ(parse("f 1 2 3\n" + square).corners[2].position, 2u); }

TEST(ObjFile, IgnoresWeightsAndVertexColours) {
  const ObjFile file = parse("v 1 2 3 1 0.5 0.5 0.5\nvt 0.5\nvt 1 2 3\nf 1/1 1/2 1/1\n");
  EXPECT_EQ(file.positions[0], V3f(1, 2, 3));
  EXPECT_EQ(file.uvs[0], V2f(0.5f, 0.0f));
  EXPECT_EQ(file.uvs[1], V2f(1, 2));
}

TEST(ObjFile, RemembersGroupsMaterialsAndSmoothing) {
  const ObjFile file =
      parse(square +
            "f 1 2 3\no box\ns 3\nf 1 2 3\ng side a \nusemtl my mat #2\t\ns off\nf 1 2 3\no lid\ns 0\nf 1 2 3\n"
            "usemtl other\ng\ns on\nf 1 2 3\n");
  EXPECT_EQ(file.groups, (std::vector<std::string>{"", "box", "box/side a", "lid"}));
  EXPECT_EQ(file.materials, (std::vector<std::string>{"", "my mat #2", "other"}));
  std::vector<std::array<std::uint32_t, 3>> found;
  for (const ObjFace& face : file.faces) found.push_back({face.group, face.material, face.smoothing});
  EXPECT_EQ(found,
            (std::vector<std::array<std::uint32_t, 3>>{{0, 0, 0}, {1, 0, 3}, {2, 1, 0}, {3, 1, 0}, {3, 2, 1}}));
}

TEST(ObjFile, LibrariesKeepTheirSpaces) {
  EXPECT_EQ(parse("mtllib my file.mtl\nmtllib  b.mtl c.mtl \n" + square + "f 1 2 3\n").libraries,
            (std::vector<std::string>{"my file.mtl", "b.mtl c.mtl"}));
}

TEST(ObjFile, RefusesBadNumbers) {
  expect_error([] { parse("v 1 2 3\nv 0,5 1 2\n"); }, {"a.obj:2: '0,5' is not a finite number"});
  expect_error([] { parse("v 1 nan 2\n"); }, {"a.obj:1: 'nan'"});
  expect_error([] { parse("v 1 inf 2\n"); }, {"'inf'"});
  expect_error([] { parse("v 1 -Infinity 2\n"); }, {"'-Infinity'"});
  expect_error([] { parse("v 1 0x10 2\n"); }, {"'0x10'"});
  expect_error([] { parse("v 1 2\n"); }, {"a.obj:1: 'v' has 2 numbers"});
  expect_error([] { parse("vt\n"); }, {"a.obj:1: 'vt' has 0 numbers"});
  expect_error([] { parse("vn 1 2 # 3\n"); }, {"a.obj:1: 'vn' has 2 numbers"});
}

TEST(ObjFile, NumbersBeyondAFloatAreNamed) {
  expect_error([] { parse("v 0 0 0\nv 1e20 0 0\n"); }, {"a.obj:2: a coordinate is larger than 1e12"});
  expect_error([] { parse("v 0 0 0\nv 0 -1e300 0\n"); }, {"a.obj:2: a coordinate is larger than 1e12"});
  expect_error([] { parse("vn 1e39 0 0\n"); }, {"a.obj:1: a normal is too large"});
  expect_error([] { parse("vt 1e39 0\n"); }, {"a.obj:1: a texture coordinate is too large"});
  EXPECT_EQ(parse("v 1e-60 1 1\n" + square + "f 1 2 3\n").positions[0], V3f(0, 1, 1));
}

TEST(ObjFile, NormalsWithoutLengthAreNone) {
  const ObjFile file = parse(square + "vn 0 0 0\nvn 1e-30 0 0\nvn 1e30 0 0\nf 1//1 2//2 3//3\n");
  EXPECT_EQ(file.corners[0].normal, no_obj_index);
  EXPECT_EQ(file.normals[file.corners[1].normal], V3f(1, 0, 0));
  EXPECT_EQ(file.normals[file.corners[2].normal], V3f(1, 0, 0));
}

TEST(ObjFile, RefusesBadCorners) {
  for (const char* corner :
       {"0", "1/0", "1//0", "a", "1/x", "/1", "1.5", "1/2/y", "99999999999", "-0", "+-1", "1\\"})
    expect_error([&] { parse(std::string("\nf 1 2 ") + corner + " 3"); },
                 {"a.obj:2: '" + std::string(corner) + "' is not a corner of a face"});
  expect_error([] { parse("f 1/1/1/1 2 3"); }, {"'1/1/1/1' has more than three indices"});
}

TEST(ObjFile, RefusesIndicesThatLeadNowhere) {
  expect_error([&] { parse(square + "f 1 2 5\n"); }, {"a.obj:5: position 5 does not exist: there are 4"});
  expect_error([&] { parse(square + "f 1 2 -5\n"); }, {"a.obj:5: index -5 points before the first of 4"});
  expect_error([&] { parse(square + "f 1 2 -2147483648\n"); }, {"points before the first"});
  expect_error([&] { parse(square + "f 1/1 2/1 3/1\n"); }, {"a.obj:5: texture coordinate 1 does not exist"});
  expect_error([&] { parse(square + "f 1//1 2//1 3//1\n"); }, {"a.obj:5: normal 1 does not exist"});
  expect_error([&] { parse(square + "vn 0 0 1\nf 1//-1 2//-2 3//1\n"); }, {"a.obj:6: index -2 points before"});
}

TEST(ObjFile, RefusesGiantFacesAndNames) {
  std::string face = "f";
  for (int i = 0; i < 2001; ++i) face += " 1";
  expect_error([&] { parse(face); }, {"a.obj:1: a face of 2001 corners", "split it"});
  expect_error([&] { parse("v 0 0 0\no " + std::string(1001, 'x')); }, {"a.obj:2: a name of 1001 characters"});
}

TEST(ObjFile, RefusesUnknownSmoothingGroups) {
  expect_error([] { parse("s x\n"); }, {"a.obj:1: 'x' is not a smoothing group"});
  expect_error([] { parse("s -1\n"); }, {"a.obj:1: '-1' is not a smoothing group"});
}

TEST(ObjFile, CountsWhatItLeavesOut) {
  EXPECT_EQ(notes_of("l 1 2\nl 2 3\np 1\nf 1 2\ncstype bezier\n"),
            (std::vector<std::string>{"a.obj: 2 'l' statements are left out: only polygons are read",
                                      "a.obj: 1 'p' statements are left out: only polygons are read",
                                      "a.obj: 1 faces of fewer than three corners are left out"}));
}

TEST(ObjFile, RefusesUtf16) {
  expect_error([] { parse("\xFF\xFEv"); }, {"a.obj: this is text in UTF-16"});
  expect_error([] { parse(std::string_view("\xFE\xFF\0v", 4)); }, {"a.obj: this is text in UTF-16"});
}

TEST(ObjFile, RefusesFilesWithoutFaces) {
  expect_error([&] { parse(square); }, {"a.obj: there is no face in this file"});
  expect_error([&] { parse(""); }, {"there is no face"});
  expect_error([&] { parse("<html><body>not found</body></html>"); }, {"there is no face"});
  expect_error([&] { parse(std::string_view("\0\0\0v\0", 5)); }, {"it holds zero bytes"});
}

using ObjFileOnDisk = LoadTest;

TEST_F(ObjFileOnDisk, RefusesWhatIsNoFile) {
  Notes notes;
  expect_error([&] { read_obj(folder_, notes); }, {"this is a folder"});
  expect_error([&] { read_obj("/dev/zero", notes); }, {"this is not a regular file"});
  expect_error([&] { read_obj(folder_ / "none.obj", notes); }, {"there is no such file"});
}

}  // namespace
}  // namespace twopass
