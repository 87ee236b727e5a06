#include "render/load/mitsuba_document.h"

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

using MitsubaDocument = LoadTest;

TEST_F(MitsubaDocument, KeepsTagsAttributesAndLines) {
  const XmlNode root = read_xml(write(
      "a.xml", "<?xml version='1.0'?>\n<!-- comment\n -->\n<scene a='1'>\n  <b/>\n\n<c d='&lt;'/></scene>"));
  EXPECT_EQ(root.tag, "scene");
  EXPECT_EQ(root.line, 4u);
  EXPECT_EQ(root.get("a"), "1");
  EXPECT_EQ(root.find("x"), nullptr);
  ASSERT_EQ(root.children.size(), 2u);
  EXPECT_EQ(root.children[0].line, 5u);
  EXPECT_EQ(root.children[1].line, 7u);
  EXPECT_EQ(root.children[1].get("d"), "<");
  EXPECT_EQ(root.children[1].where(), (folder_ / "a.xml:7").string());
}

TEST_F(MitsubaDocument, AcceptsAByteOrderMark) {
  EXPECT_EQ(read_xml(write("a.xml", "\xEF\xBB\xBF<scene>\n<a/></scene>")).children[0].line, 2u);
}

TEST_F(MitsubaDocument, RefusesMalformedFiles) {
  expect_error([&] { read_xml(write("a.xml", "<scene>\n<a>\n</scene>")); }, {"a.xml:3: not well-formed XML"});
  expect_error([&] { read_xml(write("a.xml", "")); }, {"a.xml:1: not well-formed XML"});
  expect_error([&] { read_xml(write("a.xml", "<scene a='1' a='2'/>")); },
               {"a.xml:1: attribute 'a' is given twice"});
  expect_error([&] { read_xml(write("a.xml", "<scene>\n<a/>text</scene>")); },
               {"a.xml:2: there is text between the elements"});
  expect_error([&] { static_cast<void>(read_xml(write("a.xml", "<scene/>")).get("version")); },
               {"a.xml:1: <scene> has no attribute 'version'"});
}

TEST_F(MitsubaDocument, RefusesDeepNesting) {
  std::string text;
  for (int i = 0; i < 100000; ++i) text += "<scene>";
  for (int i = 0; i < 100000; ++i) text += "</scene>";
  expect_error([&] { read_xml(write("a.xml", text)); }, {"nested more than 100 deep"});
}

}  // namespace
}  // namespace twopass
