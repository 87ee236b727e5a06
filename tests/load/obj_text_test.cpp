#include "render/load/obj_text.h"

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

ObjText clean(std::string_view text) {
  Notes notes;
  return clean_obj(text, "a.obj", notes);
}

TEST(ObjText, KeepsStatementsAndTheirLines) {
  const ObjText result = clean("# comment\n\n v 1 2 3\r\nvn 0 0 1\rusemtl a\n");
  EXPECT_EQ(result.text, "v 1 2 3\nvn 0 0 1\nusemtl a\n");
  EXPECT_EQ(result.lines, (std::vector<std::uint32_t>{3, 4, 5}));
}

TEST(ObjText, RemovesWhatTinyobjloaderCannotRead) {
  EXPECT_EQ(clean("\xEF\xBB\xBFv 1 2 3").text, "v 1 2 3\n");
  EXPECT_EQ(clean("f 1 2 3 # comment").text, "f 1 2 3\n");
  const ObjText joined = clean("f 1 2 \\\n3 4\nv 0 0 0");
  EXPECT_EQ(joined.text, "f 1 2  3 4\nv 0 0 0\n");
  EXPECT_EQ(joined.lines, (std::vector<std::uint32_t>{1, 3}));
}

TEST(ObjText, NamesKeepSpacesAndHashes) {
  EXPECT_EQ(clean("usemtl Material #26 \ng a b\no\n").text, "usemtl Material #26\ng a b\no \n");
  EXPECT_EQ(clean("mtllib my file.mtl\n").libraries, (std::vector<std::string>{"my file.mtl"}));
}

TEST(ObjText, IgnoresWeightsAndVertexColours) {
  EXPECT_EQ(clean("v 1 2 3 1 0.5 0.5 0.5\nvt 0.5\n").text, "v 1 2 3\nvt 0.5\n");
}

TEST(ObjText, NoticesSmoothing) {
  EXPECT_TRUE(clean("s 1\n").smoothing);
  EXPECT_FALSE(clean("s off\ns 0\n").smoothing);
}

TEST(ObjText, RefusesBadNumbers) {
  expect_error([] { clean("v 1 2 3\nv 0,5 1 2\n"); }, {"a.obj:2: '0,5' is not a finite number"});
  expect_error([] { clean("v 1 nan 2\n"); }, {"a.obj:1: 'nan'"});
  expect_error([] { clean("v 1 inf 2\n"); }, {"'inf'"});
  expect_error([] { clean("v 1 2\n"); }, {"a.obj:1: 'v' has 2 numbers"});
  expect_error([] { clean("vt\n"); }, {"a.obj:1: 'vt' has 0 numbers"});
}

TEST(ObjText, RefusesBadCorners) {
  for (const char* corner : {"0", "1/0", "1//0", "a", "1/x", "/1", "1.5", "1/2/y", "99999999999"})
    expect_error([&] { clean(std::string("\nf 1 2 ") + corner); }, {"a.obj:2: '", "is not a corner of a face"});
  expect_error([&] { clean("f 1/1/1/1 2 3"); }, {"more than three indices"});
  for (const char* corner : {"1", "-1", "1/2", "1//2", "1/2/3", "1/", "1//", "-1/-2/-3"})
    EXPECT_NO_THROW(clean(std::string("f 1 2 ") + corner)) << corner;
}

TEST(ObjText, RefusesGiantFaces) {
  std::string face = "f";
  for (int i = 0; i < 2001; ++i) face += " 1";
  expect_error([&] { clean(face); }, {"a.obj:1: a face of 2001 corners", "split it"});
}

TEST(ObjText, CountsWhatItLeavesOut) {
  Notes notes;
  clean_obj("l 1 2\nl 2 3\np 1\nf 1 2\ncstype bezier\n", "a.obj", notes);
  EXPECT_EQ(notes.lines(),
            (std::vector<std::string>{"a.obj: 2 'l' statements are left out: only polygons are read",
                                      "a.obj: 1 'p' statements are left out: only polygons are read",
                                      "a.obj: 1 faces of fewer than three corners are left out"}));
}

}  // namespace
}  // namespace twopass
