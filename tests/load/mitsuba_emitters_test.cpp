#include "render/load/mitsuba_emitters.h"

#include "render/image/exr.h"
#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

class MitsubaEmitters : public LoadTest {
 protected:
  LoadedScene read(const std::string& body) const {
    return load_xml("<scene version='3.0.0'>\n" + body + "\n</scene>");
  }
  template <class Light>
  Light light(const std::string& body) const {
    return std::get<Light>(read(body).scene.punctual_lights.at(0));
  }
  void write_picture(const std::string& name, int width, int height, float value) const {
    Image image(width, height, {"R", "G", "B"});
    std::fill(image.pixels.begin(), image.pixels.end(), value);
    write_exr(folder_ / name, image);
  }
};

TEST_F(MitsubaEmitters, Point) {
  const auto point = light<PointLight>(
      "<emitter type='point'><point name='position' x='1' y='2' z='3'/><rgb name='intensity' value='4 5 6'/>"
      "<float name='sampling_weight' value='3'/></emitter>");
  EXPECT_EQ(point.position, V3f(1, 2, 3));
  EXPECT_EQ(point.intensity, C3f(4, 5, 6));
  EXPECT_EQ(light<PointLight>(
                "<emitter type='point'><transform name='to_world'><translate x='7'/></transform></emitter>")
                .position,
            V3f(7, 0, 0));
  EXPECT_EQ(read("<emitter type='point'/><emitter type='point'/>").scene.punctual_lights.size(), 2u);
  expect_error(
      [&] {
        read(
            "<emitter type='point'>\n<point name='position' value='1'/><transform name='to_world'/></emitter>");
      },
      {"scene.xml:3: both 'position' and 'to_world'"});
  expect_error([&] { read("<emitter type='point'>\n<float name='cutoff_angle' value='1'/></emitter>"); },
               {"scene.xml:3: emitter 'point' has no property 'cutoff_angle'"});
}

TEST_F(MitsubaEmitters, PointWithAProfile) {
  write("lamp.ies", "IESNA91\nTILT=NONE\n1 1000 1 2 1 1 2 0 0 0\n1 1 100\n0 90\n0\n100 0\n");
  const auto lamp = light<PointLight>(
      "<emitter type='point'><string name='ies_file' value='lamp.ies'/>"
      "<transform name='to_world'><lookat origin='0,3,0' target='0,0,0' up='0,0,1'/></transform></emitter>");
  EXPECT_NEAR(illumination(lamp, V3f(0, 1, 0)).irradiance.x, 25.0f, 1e-4f);
  EXPECT_EQ(illumination(lamp, V3f(0, 4, 0)).irradiance.x, 0.0f);
  expect_error([&] { read("<emitter type='point'>\n<string name='ies_file' value='none.ies'/></emitter>"); },
               {"scene.xml:3: there is no file 'none.ies'"});
  write("bad.ies", "IESNA91\nTILT=NONE\n1 1000 1 0");
  expect_error([&] { read("<emitter type='point'><string name='ies_file' value='bad.ies'/></emitter>"); },
               {"bad.ies:3: the number of vertical angles"});
}

TEST_F(MitsubaEmitters, Spot) {
  const auto spot = light<SpotLight>(
      "<emitter type='spot'><rgb name='intensity' value='9'/><transform name='to_world'>"
      "<lookat origin='0,0,3' target='0,0,0' up='0,1,0'/></transform></emitter>");
  EXPECT_NEAR(spot.cutoff_angle, 20.0f * pi_f / 180.0f, 1e-6f);
  EXPECT_NEAR(spot.beam_width, 15.0f * pi_f / 180.0f, 1e-6f);
  EXPECT_NEAR(illumination(spot, V3f(0.0f)).irradiance.x, 1.0f, 1e-6f);
  write_picture("p.exr", 2, 2, 3.0f);
  const auto textured = light<SpotLight>(
      "<emitter type='spot'><texture type='bitmap' name='texture'><string name='filename' value='p.exr'/>"
      "<boolean name='raw' value='true'/></texture></emitter>");
  EXPECT_EQ(mean_color(*textured.texture), C3f(3.0f));
  expect_error([&] { read("<emitter type='spot'>\n<float name='cutoff_angle' value='90'/></emitter>"); },
               {"scene.xml:3: 'cutoff_angle' must be above 0 and below 90"});
  expect_error([&] { read("<emitter type='spot'>\n<float name='beam_width' value='21'/></emitter>"); },
               {"scene.xml:3: 'beam_width' must be from 0 to 'cutoff_angle'"});
  expect_error([&] { read("<emitter type='spot'>\n<texture type='wood' name='texture'/></emitter>"); },
               {"scene.xml:3: texture 'wood' is not supported", "bitmap"});
  expect_error(
      [&] { read("<emitter type='spot'><transform name='to_world'>\n<scale x='0'/></transform></emitter>"); },
      {"flattens space"});
}

TEST_F(MitsubaEmitters, Directional) {
  const auto sun = light<DirectionalLight>(
      "<emitter type='directional'><rgb name='irradiance' value='1 2 3'/><vector name='direction' "
      "value='0,0,-5'/></emitter>");
  EXPECT_EQ(sun.direction, V3f(0, 0, -1));
  EXPECT_EQ(sun.irradiance, C3f(1, 2, 3));
  EXPECT_EQ(light<DirectionalLight>("<emitter type='directional'/>").direction, V3f(0, 0, 1));
  expect_near(light<DirectionalLight>(
                  "<emitter type='directional'><transform name='to_world'><rotate y='1' angle='90'/>"
                  "</transform></emitter>")
                  .direction,
              V3f(1, 0, 0));
  expect_error([&] { read("<emitter type='directional'>\n<vector name='direction' value='0'/></emitter>"); },
               {"scene.xml:3: a direction of no length"});
}

TEST_F(MitsubaEmitters, Projector) {
  write_picture("p.exr", 4, 2, 0.5f);
  const std::string texture =
      "<texture type='bitmap' name='irradiance'><string name='filename' value='p.exr'/></texture>";
  const auto projector =
      light<twopass::Projector>("<emitter type='projector'>" + texture +
                                "<float name='scale' value='2'/><float name='fov' value='90'/></emitter>");
  EXPECT_NEAR(projector.tan_half_fov, 1.0f, 1e-6f);
  EXPECT_NEAR(illumination(projector, V3f(0, 0, 2)).irradiance.x, pi_f / 4, 1e-6f);
  EXPECT_NEAR(light<twopass::Projector>("<emitter type='projector'>" + texture +
                                        "<float name='fov' value='90'/>"
                                        "<string name='fov_axis' value='y'/></emitter>")
                  .tan_half_fov,
              2.0f, 1e-6f);
  EXPECT_EQ(*light<twopass::Projector>(
                "<emitter type='projector'><rgb name='irradiance' value='7'/><float name='fov' value='45'/>"
                "</emitter>")
                .texture,
            Texture(C3f(7.0f)));
  expect_error([&] { read("<emitter type='projector'/>"); }, {"scene.xml:2: emitter 'projector' has no 'fov'"});
}

TEST_F(MitsubaEmitters, EnvironmentMap) {
  write_picture("sky.exr", 8, 4, 0.5f);
  const Environment environment = read(
                                      "<emitter type='envmap'><string name='filename' value='sky.exr'/><float "
                                      "name='scale' value='3'/></emitter>")
                                      .scene.environment;
  EXPECT_STREQ(environment.kind_name(), "envmap");
  EXPECT_NEAR(environment.radiance(V3f(0, 1, 0)).x, 1.5f, 1e-5f);
  expect_error([&] { read("<emitter type='envmap'/>"); }, {"scene.xml:2: emitter 'envmap' has no 'filename'"});
  expect_error(
      [&] {
        read(
            "<emitter type='envmap'><string name='filename' value='sky.exr'/>\n<transform name='to_world'>"
            "<scale x='2'/></transform></emitter>");
      },
      {"scene.xml:3: the surroundings' transform is not a rotation"});
  write_picture("dot.exr", 1, 1, 0.5f);
  expect_error([&] { read("<emitter type='envmap'><string name='filename' value='dot.exr'/></emitter>"); },
               {"dot.exr: an environment map has at least 2x3 pixels"});
}

TEST_F(MitsubaEmitters, SunSky) {
  const Environment environment =
      read(
          "<emitter type='sunsky'><vector name='sun_direction' x='-.4' y='.35' z='-.6'/>"
          "<transform name='to_world'><rotate x='1' angle='-90'/></transform></emitter>")
          .scene.environment;
  EXPECT_STREQ(environment.kind_name(), "sunsky");
  EXPECT_GT(environment.radiance(unit(V3f(-0.4f, 0.35f, -0.6f))).x, 1e4f);
  EXPECT_GT(environment.radiance(V3f(0, 1, 0)).z, 0.01f);
  EXPECT_EQ(environment.radiance(V3f(0, -1, 0)), C3f(0.0f));
  // A summer afternoon in Tokyo, as it is by default.
  EXPECT_FALSE(read("<emitter type='sunsky'/>").scene.environment.is_black());
  EXPECT_TRUE(
      read("<emitter type='sunsky'><float name='hour' value='0'/></emitter>").scene.environment.is_black());
  expect_error(
      [&] {
        read(
            "<emitter type='sunsky'><vector name='sun_direction' value='0,0,1'/>\n<float name='hour' "
            "value='3'/></emitter>");
      },
      {"scene.xml:3: both 'sun_direction' and 'hour'"});
  expect_error([&] { read("<emitter type='sunsky'>\n<float name='turbidity' value='11'/></emitter>"); },
               {"scene.xml:3: 'turbidity' must be from 1 to 10"});
  expect_error([&] { read("<emitter type='sunsky'>\n<integer name='month' value='13'/></emitter>"); },
               {"there is no such day"});
}

TEST_F(MitsubaEmitters, OneEnvironmentOnly) {
  expect_error([&] { read("<emitter type='constant'/>\n<emitter type='sunsky'/>"); },
               {"scene.xml:3: a second environment, the first is 'constant' at", "scene.xml:2"});
  expect_error(
      [&] { read("<emitter type='moon'/>"); },
      {"emitter 'moon' is not supported", "constant, directional, envmap, point, projector, spot, sunsky"});
}

}  // namespace
}  // namespace twopass
