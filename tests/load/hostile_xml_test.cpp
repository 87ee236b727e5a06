// Files that want more than a scene may have: each is one error, soon, and never a crash.
#include "render/image/film.h"
#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

class HostileXml : public LoadTest {
 protected:
  LoadedScene read(const std::string& body) const {
    return load_xml("<scene version='3.0.0'>\n" + body + "\n</scene>");
  }
};

// "A billion laughs": entities that double ten or thirty times. They are not expanded at all.
TEST_F(HostileXml, EntitiesAreNotExpanded) {
  std::string file = "<?xml version='1.0'?><!DOCTYPE scene [<!ENTITY e0 'ha'>";
  for (int i = 1; i <= 30; ++i) {
    const std::string before = "&e" + std::to_string(i - 1) + ";";
    file += "<!ENTITY e" + std::to_string(i) + " '" + before + before + "'>";
  }
  file += "]><scene version='3.0.0'><shape type='&e30;'/></scene>";
  expect_error([&] { load_xml(file); }, {"scene.xml:1: shape '&e30;' is not supported"});
  // Nor are files read by them.
  expect_error(
      [&] {
        load_xml(
            "<!DOCTYPE scene [<!ENTITY e SYSTEM '/etc/hostname'>]><scene version='3.0.0'><shape "
            "type='&e;'/></scene>");
      },
      {"shape '&e;' is not supported"});
}

TEST_F(HostileXml, ParametersThatMultiplyAreErrors) {
  std::string body = "<default name='p0' value='xxxxxxxxxx'/>\n";
  for (int i = 1; i <= 40; ++i) {
    const std::string before = "$p" + std::to_string(i - 1) + "_";
    body +=
        "<default name='p" + std::to_string(i) + "_' value='" + (i == 1 ? "$p0$p0" : before + before) + "'/>\n";
  }
  expect_error([&] { read(body); },
               {"scene.xml:", "more than a million characters after its parameters are put in"});
}

TEST_F(HostileXml, AbsurdFilms) {
  const auto film = [&](const char* width, const char* height) {
    return read("<sensor type='perspective'><film type='hdrfilm'>\n<integer name='width' value='" +
                std::string(width) + "'/>\n<integer name='height' value='" + height + "'/></film></sensor>")
        .settings;
  };
  expect_error([&] { film("1000000000", "1000000000"); }, {"scene.xml:3: 'width' must be from 1 to 65536"});
  expect_error([&] { film("99999999999999999999", "1"); }, {"scene.xml:3: "});
  expect_error([&] { film("-1", "1"); }, {"scene.xml:3: "});
  const FileSettings large = film("65536", "65536");  // each is possible, both are not
  expect_error([&] { Film(large.width, large.height); }, {"picture: its size is 65536x65536"});
}

// Every number of a file goes through one parser; no spelling of infinity or NaN gets past it.
TEST_F(HostileXml, NumbersThatAreNoneAreErrors) {
  for (const char* number :
       {"nan", "NaN", "-nan", "inf", "-inf", "Infinity", "1e999", "-1e999", "0x10", "1,5", ""}) {
    const std::string value = std::string("value='") + number + "'/>";
    for (const std::string& body :
         {"<shape type='sphere'>\n<float name='radius' " + value + "</shape>",
          "<shape type='sphere'>\n<point name='center' x='0' y='0' z='" + number + "'/></shape>",
          "<shape type='cube'><transform name='to_world'>\n<scale " + value + "</transform></shape>",
          "<shape type='cube'><transform name='to_world'>\n<matrix value='1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 " +
              number + "'/></transform></shape>",
          "<emitter type='constant'>\n<rgb name='radiance' " + value + "</emitter>",
          "<sensor type='thinlens'>\n<float name='aperture_radius' " + value + "</sensor>"})
      expect_error([&] { read(body); }, {"scene.xml:"});
  }
}

// Finite numbers whose products are not.
TEST_F(HostileXml, NumbersThatOverflowAreErrors) {
  const std::string huge = "<scale value='1e200'/>";
  expect_error(
      [&] { read("<shape type='cube'><transform name='to_world'>" + huge + huge + "</transform></shape>"); },
      {"scene.xml:2: "});
  expect_error([&] { read("<shape type='sphere'><float name='radius' value='1e300'/></shape>"); },
               {"scene.xml:2: "});
  expect_error(
      [&] {
        read("<sensor type='perspective'><transform name='to_world'>" + huge + huge + "</transform></sensor>");
      },
      {"scene.xml:2: "});
}

TEST_F(HostileXml, NestingIsBounded) {
  std::string body;
  for (int i = 0; i < 100000; ++i) body += "<bsdf type='twosided'>";
  expect_error([&] { read(body); }, {"scene.xml:"});
  for (int i = 0; i < 100000; ++i) body += "</bsdf>";
  expect_error([&] { read(body); }, {"elements are nested more than 100 deep"});
}

TEST_F(HostileXml, EveryPrefixOfASceneIsAnErrorOrAScene) {
  const std::string scene =
      "<?xml version='1.0'?><scene version='3.0.0'><default name='w' value='4'/><sensor type='thinlens'><float "
      "name='aperture_radius' value='.1'/><film type='hdrfilm'><integer name='width' value='$w'/><rfilter "
      "type='mitchell'/></film></sensor><bsdf type='twosided' id='b'><bsdf type='diffuse'/></bsdf><shape "
      "type='cube'><ref id='b'/></shape></scene>";
  EXPECT_NO_THROW(load_xml(scene));
  for (std::size_t size = 0; size < scene.size(); ++size)
    EXPECT_NE(message_of([&] { load_xml(scene.substr(0, size)); }), "") << size;
  for (std::size_t i = 0; i < scene.size(); ++i)
    for (const char c : {'\0', '<', '\xff', '9'}) {
      std::string changed = scene;
      changed[i] = c;
      (void)message_of([&] { load_xml(changed); });  // neither a crash nor another exception
    }
}

}  // namespace
}  // namespace twopass
