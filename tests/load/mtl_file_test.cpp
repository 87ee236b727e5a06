#include "render/load/mtl_file.h"

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

struct Parsed {
  MtlRecord record;
  std::vector<std::string> notes;
};

Parsed parse(const std::string& body) {
  Notes notes;
  const auto records = parse_mtl("newmtl m\n" + body, "a.mtl", {"m"}, notes);
  return {records.at("m"), notes.lines()};
}
MtlMap map(const std::string& arguments) { return parse("map_Kd " + arguments).record.map_kd.value(); }

TEST(MtlFile, ReadsColoursAndNumbers) {
  const MtlRecord m =
      parse(
          "Ka 1 1 1\n\tKd 0.1 0.2 0.3 # comment\nKs 0.5\nKe 17 12 4\nTf 1 0 1\nNs 40\nNi 1.5\nillum 2\n"
          "Pr .1\nPm .2\nPs .3\nPc .4\nPcr .5\naniso .6\n")
          .record;
  EXPECT_EQ(m.name, "m");
  EXPECT_EQ(m.kd, C3f(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(m.ks, C3f(0.5f));
  EXPECT_EQ(m.ke, C3f(17, 12, 4));
  EXPECT_EQ(m.tf, C3f(1, 0, 1));
  EXPECT_EQ(m.ns, 40.0f);
  EXPECT_EQ(m.ni, 1.5f);
  EXPECT_EQ(m.illum, 2);
  EXPECT_EQ(m.pr, 0.1f);
  EXPECT_EQ(m.pm, 0.2f);
  EXPECT_EQ(m.ps, 0.3f);
  EXPECT_EQ(m.pc, 0.4f);
  EXPECT_EQ(m.pcr, 0.5f);
  EXPECT_EQ(m.aniso, 0.6f);
}

TEST(MtlFile, WhatIsNotSaidIsUnset) {
  const MtlRecord m = parse("").record;
  EXPECT_FALSE(m.kd || m.ks || m.ke || m.tf || m.ns || m.ni || m.d || m.illum || m.pr || m.map_kd || m.norm);
}

TEST(MtlFile, OpacityIsDOrElseOneMinusTr) {
  EXPECT_EQ(parse("d 0.25\n").record.d, 0.25f);
  EXPECT_EQ(parse("d -halo 0.25\n").record.d, 0.25f);
  EXPECT_EQ(parse("Tr 0.25\n").record.d, 0.75f);
  EXPECT_EQ(parse("d 1\nTr 1\n").record.d, 1.0f);
  EXPECT_EQ(parse("Tr 1\nd 1\n").record.d, 1.0f);
  EXPECT_EQ(parse("d 7\n").record.d, 1.0f);
}

TEST(MtlFile, KeywordsInAnyCase) {
  EXPECT_EQ(parse("KD 1 0 0\n").record.kd, C3f(1, 0, 0));
  EXPECT_TRUE(parse("map_kd a.png\n").record.map_kd);
  EXPECT_TRUE(parse("map_Bump a.png\n").record.map_bump);
  EXPECT_TRUE(parse("bump a.png\n").record.map_bump);
}

TEST(MtlFile, MapsKeepTheirNames) {
  EXPECT_EQ(map("wall.png").file, "wall.png");
  EXPECT_EQ(map("  my wall#1 (2).png \t").file, "my wall#1 (2).png");
  EXPECT_EQ(map("\"my wall.png\"").file, "my wall.png");
  EXPECT_EQ(map("wall.png # the wall").file, "wall.png");
  EXPECT_EQ(map("C:\\a\\b.png").file, "C:\\a\\b.png");
  EXPECT_EQ(map("-bm 1 wall -x.png").file, "wall -x.png");
  EXPECT_EQ(map("-o 1 2 3 4").file, "4");
  EXPECT_EQ(map("-o 1 2").file, "2");
  EXPECT_EQ(parse("\n\nmap_Ks a.png").record.map_ks->line, 4u);
}

TEST(MtlFile, MapOptions) {
  const MtlMap m =
      map("-o 0.5 0.25 0 -s 2 3 1 -mm -0.1 0.4 -bm 0.3 -clamp on -blendu off -imfchan G -texres 512 -boost 2 "
          "-cc on x.png");
  EXPECT_EQ(m.offset, V2f(0.5f, 0.25f));
  EXPECT_EQ(m.scale, V2f(2, 3));
  EXPECT_EQ(m.base, -0.1f);
  EXPECT_EQ(m.gain, 0.4f);
  EXPECT_EQ(m.bump, 0.3f);
  EXPECT_TRUE(m.clamp);
  EXPECT_TRUE(m.nearest);
  EXPECT_EQ(m.channel, 'g');
  EXPECT_EQ(m.file, "x.png");
  const MtlMap plain = map("-s 2 x.png");
  EXPECT_EQ(plain.scale, V2f(2, 1));
  EXPECT_EQ(plain.offset, V2f(0, 0));
  EXPECT_EQ(plain.gain, 1.0f);
  EXPECT_EQ(plain.channel, 0);
  EXPECT_FALSE(plain.clamp || plain.nearest);
}

TEST(MtlFile, RefusesMalformedNumbers) {
  expect_error([] { parse("Kd 0.5 x 1\n"); }, {"a.mtl:2: 'kd' cannot be 'x'"});
  expect_error([] { parse("\nKd -0.5 0 0\n"); }, {"a.mtl:3: 'kd' cannot be '-0.5'"});
  expect_error([] { parse("Ke nan 0 0\n"); }, {"a.mtl:2: 'ke' cannot be 'nan'"});
  expect_error([] { parse("Ke inf 0 0\n"); }, {"'inf'"});
  expect_error([] { parse("Kd 0,5 0,5 0,5\n"); }, {"'0,5'"});
  expect_error([] { parse("Kd 1 1\n"); }, {"a.mtl:2: 'kd' needs one or three numbers"});
  expect_error([] { parse("Kd\n"); }, {"a.mtl:2: 'kd' needs one or three numbers"});
  expect_error([] { parse("Ni\n"); }, {"a.mtl:2: 'ni' without a number"});
  expect_error([] { parse("d -halo\n"); }, {"a.mtl:2: 'd' without a number"});
  expect_error([] { parse("illum x\n"); }, {"a.mtl:2: 'illum' cannot be 'x'"});
  expect_error([] { parse("Kd spectral a.rfl\n"); }, {"a.mtl:2: 'kd' with 'spectral' is not supported"});
}

TEST(MtlFile, RefusesMalformedMaps) {
  expect_error([] { map(""); }, {"a.mtl:2: 'map_kd' without a file name"});
  expect_error([] { map("# x.png"); }, {"a.mtl:2: 'map_kd' without a file name"});
  expect_error([] { map("-bm x.png"); }, {"a.mtl:2: '-bm' cannot be 'x.png'", "give 1 number"});
  expect_error([] { map("-o x.png"); }, {"'-o' cannot be 'x.png'", "give 1 or more"});
  expect_error([] { map("-mm nan 1 x.png"); }, {"'-mm' cannot be 'nan'"});
  expect_error([] { map("-s 1e30 x.png"); }, {"'-s' cannot be '1e30'"});
  expect_error([] { map("-clamp maybe x.png"); }, {"'-clamp' cannot be 'maybe'", "on or off"});
  expect_error([] { map("-imfchan q x.png"); }, {"'-imfchan' cannot be 'q'"});
  expect_error([] { map("-frob x.png"); }, {"the texture option '-frob' is unknown", "-imfchan"});
}

TEST(MtlFile, OnlyWantedMaterialsAreRead) {
  Notes notes;
  const auto records =
      parse_mtl("Kd 1 1 1\nnewmtl a\nKd x\nfrob\nnewmtl my mat \r\n\tKd 1 0 0\r\nnewmtl b\nKd y", "a.mtl",
                {"my mat"}, notes);
  ASSERT_EQ(records.size(), 1u);
  EXPECT_EQ(records.at("my mat").kd, C3f(1, 0, 0));
  EXPECT_EQ(records.at("my mat").line, 5u);
  EXPECT_TRUE(notes.lines().empty());
}

TEST(MtlFile, TheFirstDefinitionCounts) {
  Notes notes;
  EXPECT_EQ(parse_mtl("newmtl a\nKd 1 0 0\nnewmtl a\nKd 0 1 0\n", "a.mtl", {"a"}, notes).at("a").kd,
            C3f(1, 0, 0));
}

TEST(MtlFile, MaterialsWithoutANameAreLeftOut) {
  const Parsed parsed = parse("Kd 1 0 0\nnewmtl \nKd x\n");
  EXPECT_EQ(parsed.record.kd, C3f(1, 0, 0));
  EXPECT_EQ(parsed.notes.size(), 1u);
}

TEST(MtlFile, CountsWhatItCannotExpress) {
  EXPECT_EQ(
      parse(
          "refl -type sphere sky.png\nrefl a.png\nanisor 0.5\nmap_Kd -t 1 a.png\nsharpness 60\nmap_Ka a.png\n")
          .notes,
      (std::vector<std::string>{
          "a.mtl: statements that our materials cannot express are left out: 1 '-t', 1 'anisor', 2 'refl'"}));
}

}  // namespace
}  // namespace twopass
