#include "render/load/mitsuba_sensor.h"

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

class MitsubaSensor : public LoadTest {
 protected:
  LoadedScene read(const std::string& body, const std::string& version = "3.0.0") const {
    return load_xml("<scene version='" + version + "'>\n" + body + "\n</scene>");
  }
  LoadedScene sensor(const std::string& body, const std::string& version = "3.0.0") const {
    return read("<sensor type='perspective'>\n" + body + "</sensor>", version);
  }
  FileSettings film(const std::string& body) const {
    return sensor("<film type='hdrfilm'>\n" + body + "</film>").settings;
  }
  FileSettings integrator(const std::string& type, const std::string& body = "") const {
    return read("<integrator type='" + type + "'>\n" + body + "</integrator>").settings;
  }
};

TEST_F(MitsubaSensor, NoSensorNoCamera) {
  const LoadedScene loaded = read("");
  EXPECT_FALSE(loaded.scene.camera);
  EXPECT_EQ(loaded.settings.width, 768);
  EXPECT_EQ(loaded.settings.height, 576);
  EXPECT_EQ(loaded.settings.filter.kind, FilterKind::gaussian);
  EXPECT_FALSE(loaded.settings.half);
  EXPECT_FALSE(loaded.settings.integrator);
  EXPECT_FALSE(loaded.settings.samples_per_pixel);
  EXPECT_EQ(loaded.settings.max_depth, -1);
  EXPECT_EQ(loaded.settings.rr_depth, 5);
}

TEST_F(MitsubaSensor, FieldOfViewAlongEveryAxis) {
  EXPECT_EQ(sensor("<float name='fov' value='40'/>").scene.camera->fov_axis, FovAxis::x);
  for (const auto& [name, axis] : fov_axis_names) {
    const LoadedScene loaded =
        sensor("<float name='fov' value='40'/><string name='fov_axis' value='" + std::string(name) + "'/>");
    EXPECT_EQ(loaded.scene.camera->fov_axis, axis);
    EXPECT_EQ(loaded.scene.camera->fov_degrees, 40.0);
  }
  expect_error([&] { sensor("<float name='fov' value='40'/>\n<string name='fov_axis' value='z'/>"); },
               {"scene.xml:4: unknown fov_axis 'z'", "x, y, diagonal, smaller, larger"});
  for (const char* fov : {"0", "180", "-5"})
    expect_error([&] { sensor("<float name='fov' value='" + std::string(fov) + "'/>"); },
                 {"scene.xml:3: 'fov' must lie between 0 and 180"});
}

TEST_F(MitsubaSensor, FocalLengthOnTheDiagonal) {
  // 35 mm film has a diagonal of 43.267 mm: 2 atan(43.267 / 100) = 46.793 degrees.
  EXPECT_NEAR(sensor("").scene.camera->fov_degrees, 46.793, 1e-3);
  EXPECT_EQ(sensor("").scene.camera->fov_axis, FovAxis::diagonal);
  EXPECT_NEAR(sensor("<string name='focal_length' value='50mm'/>").scene.camera->fov_degrees, 46.793, 1e-3);
  EXPECT_NEAR(sensor("<string name='focalLength' value='25 mm'/>", "0.6.0").scene.camera->fov_degrees, 81.744,
              1e-2);
  expect_error([&] { sensor("<string name='focal_length' value='long'/>"); }, {"'long' is not a focal length"});
  expect_error([&] { sensor("<string name='focal_length' value='50mm'/><float name='fov' value='40'/>"); },
               {"both 'fov' and 'focal_length'"});
}

TEST_F(MitsubaSensor, LooksAlongZWithXToTheLeft) {
  const LoadedScene loaded = sensor(
      "<transform name='toWorld'><lookAt origin='0 0 -5' target='0 0 0' up='0 1 0'/>"
      "</transform><float name='fov' value='90'/>",
      "0.6.0");
  const Camera camera(*loaded.scene.camera, 100, 100);
  expect_near(camera.ray({50, 50}).direction, {0, 0, 1});
  // Seen along +z with +y up, +x is on the left.
  EXPECT_GT(camera.ray({0, 50}).direction.x, 0.7f);
  EXPECT_GT(camera.ray({50, 0}).direction.y, 0.7f);
}

TEST_F(MitsubaSensor, MatricesArePlacedAsWritten) {
  const LoadedScene loaded = sensor(
      "<transform name='to_world'><matrix value='-1 0 0 0 0 1 0 1 0 0 -1 6.8 0 0 0 1'/>"
      "</transform>");
  const Camera camera(*loaded.scene.camera, 100, 100);
  expect_near(camera.ray({50, 50}).origin, {0, 1, 6.8f});
  expect_near(camera.ray({50, 50}).direction, {0, 0, -1});
  EXPECT_GT(camera.ray({100, 50}).direction.x, 0.0f);
}

TEST_F(MitsubaSensor, CamerasAreRigid) {
  expect_error([&] { sensor("<transform name='to_world'><scale value='2'/></transform>"); },
               {"scene.xml:3: the camera's transform contains a scale"});
  expect_error(
      [&] { sensor("<transform name='to_world'><matrix value='1 0.6 0 0 0.8 0 0 0 1'/></transform>"); },
      {"the camera's transform is sheared"});
}

TEST_F(MitsubaSensor, RefusesPrincipalPoints) {
  EXPECT_NO_THROW(sensor("<float name='principal_point_offset_x' value='0'/>"));
  expect_error([&] { sensor("<float name='principal_point_offset_y' value='0.1'/>"); },
               {"'principal_point_offset_y' other than 0 is not supported"});
}

TEST_F(MitsubaSensor, FilmSize) {
  const FileSettings settings = film("<integer name='width' value='320'/><integer name='height' value='240'/>");
  EXPECT_EQ(settings.width, 320);
  EXPECT_EQ(settings.height, 240);
  for (const char* width : {"0", "-4", "100000"})
    expect_error([&] { film("<integer name='width' value='" + std::string(width) + "'/>"); },
                 {"scene.xml:4: 'width' must be from 1 to 65536"});
}

TEST_F(MitsubaSensor, FilmFormats) {
  EXPECT_EQ(film("<string name='component_format' value='float16'/>").half, true);
  EXPECT_EQ(film("<string name='component_format' value='float32'/>").half, false);
  expect_error([&] { film("<string name='component_format' value='uint32'/>"); },
               {"component_format 'uint32' is not supported; supported: float16, float32"});
  expect_error([&] { film("<string name='file_format' value='pfm'/>"); },
               {"file_format 'pfm' is not supported"});
  expect_error([&] { film("<string name='pixel_format' value='rbg'/>"); },
               {"pixel_format 'rbg' is not supported"});
  EXPECT_NO_THROW(
      film("<string name='file_format' value='exr'/><string name='pixel_format' value='rgba'/>"
           "<boolean name='banner' value='false'/><float name='gamma' value='2.2'/>"
           "<boolean name='sample_border' value='true'/><boolean name='compensate' value='true'/>"));
  EXPECT_TRUE(has_note(sensor("<film type='hdrfilm'><string name='pixel_format' value='luminance'/></film>"),
                       "pixel_format 'luminance'"));
  expect_error([&] { film("<integer name='widht' value='1'/>"); },
               {"scene.xml:4: film 'hdrfilm' has no property 'widht'; its properties: width, height,"});
}

TEST_F(MitsubaSensor, CropsMustBeTheWholePicture) {
  const std::string size = "<integer name='width' value='320'/><integer name='height' value='240'/>";
  EXPECT_NO_THROW(
      film(size + "<integer name='crop_offset_x' value='0'/><integer name='crop_width' value='320'/>"));
  expect_error([&] { film(size + "<integer name='crop_offset_x' value='8'/>"); },
               {"a cropped film is not supported"});
  expect_error([&] { film(size + "<integer name='crop_height' value='8'/>"); },
               {"a cropped film is not supported"});
}

TEST_F(MitsubaSensor, Filters) {
  const auto filter = [&](const std::string& xml) { return film(xml).filter; };
  EXPECT_EQ(filter("<rfilter type='box'/>").kind, FilterKind::box);
  EXPECT_EQ(filter("<rfilter type='box'/>").radius, 0.5f);
  EXPECT_EQ(filter("<rfilter type='tent'/>").kind, FilterKind::tent);
  EXPECT_EQ(filter("<rfilter type='tent'/>").radius, 1.0f);
  EXPECT_EQ(filter("<rfilter type='tent'><float name='radius' value='2'/></rfilter>").radius, 2.0f);
  EXPECT_EQ(filter("<rfilter type='gaussian'/>").stddev, 0.5f);
  EXPECT_EQ(filter("<rfilter type='gaussian'><float name='stddev' value='0.25'/></rfilter>").stddev, 0.25f);
  expect_error([&] { filter("<rfilter type='lanczos'/>"); },
               {"scene.xml:4: rfilter 'lanczos' is not supported; supported rfilters: box, tent, gaussian"});
  expect_error([&] { filter("<rfilter type='tent'><float name='radius' value='0'/></rfilter>"); },
               {"'radius' must be above 0"});
}

TEST_F(MitsubaSensor, OtherFilmsAndSensorsAreRefused) {
  expect_error([&] { sensor("<film type='ldrfilm'/>"); },
               {"film 'ldrfilm' is not supported", "renamed: use hdrfilm"});
  expect_error([&] { sensor("<film type='specfilm'/>"); }, {"supported films: hdrfilm"});
  expect_error([&] { read("<sensor type='thinlens'/>"); },
               {"scene.xml:2: sensor 'thinlens' is not supported; supported sensors: perspective"});
}

TEST_F(MitsubaSensor, SamplersGiveCountAndSeed) {
  const LoadedScene loaded = sensor(
      "<sampler type='independent'><integer name='sample_count' value='64'/>"
      "<integer name='seed' value='7'/></sampler>");
  EXPECT_EQ(loaded.settings.samples_per_pixel, 64);
  EXPECT_EQ(loaded.settings.seed, 7u);
  EXPECT_TRUE(loaded.notes.empty());
  for (const char* type : {"stratified", "multijitter", "orthogonal", "ldsampler", "sobol", "halton"})
    EXPECT_TRUE(has_note(sensor("<sampler type='" + std::string(type) + "'/>"), "ours is used instead"));
  EXPECT_EQ(sensor("<sampler type='ldsampler'><integer name='sampleCount' value='9'/></sampler>", "0.6.0")
                .settings.samples_per_pixel,
            9);
  expect_error([&] { sensor("<sampler type='magic'/>"); }, {"sampler 'magic' is not supported", "independent"});
  expect_error(
      [&] { sensor("<sampler type='independent'><integer name='sample_count' value='0'/></sampler>"); },
      {"'sample_count' must be at least 1"});
}

TEST_F(MitsubaSensor, OurIntegratorsAreTakenByName) {
  for (const char* type : {"twopass", "unbiased", "path", "radiosity", "direct"})
    EXPECT_EQ(integrator(type).integrator, type);
  EXPECT_EQ(integrator("volpath").integrator, "path");
  const FileSettings settings = integrator("path",
                                           "<integer name='max_depth' value='7'/>"
                                           "<integer name='rr_depth' value='3'/>"
                                           "<boolean name='hide_emitters' value='true'/>"
                                           "<integer name='block_size' value='32'/>");
  EXPECT_EQ(settings.max_depth, 7);
  EXPECT_EQ(settings.rr_depth, 3);
  EXPECT_TRUE(settings.hide_emitters);
}

TEST_F(MitsubaSensor, OtherIntegratorsAreNoted) {
  const LoadedScene loaded = read(
      "<integrator type='sppm'><integer name='maxDepth' value='65'/>"
      "<integer name='photonCount' value='1000'/></integrator>",
      "0.6.0");
  EXPECT_FALSE(loaded.settings.integrator);
  EXPECT_EQ(loaded.settings.max_depth, 65);
  EXPECT_TRUE(has_note(loaded, "scene.xml:2: integrator 'sppm' is unknown: rendering with the default"));
}

TEST_F(MitsubaSensor, IntegratorPropertiesAreChecked) {
  expect_error(
      [&] { integrator("path", "<integer name='maxdepth' value='7'/>"); },
      {"scene.xml:3: integrator 'path' has no property 'maxdepth'", "max_depth, rr_depth, hide_emitters"});
  expect_error([&] { integrator("path", "<integer name='max_depth' value='-2'/>"); },
               {"'max_depth' must be -1"});
  expect_error([&] { integrator("path", "<integer name='rr_depth' value='0'/>"); },
               {"'rr_depth' must be at least 1"});
  expect_error([&] { read("<integrator type='path'/>\n<integrator type='path'/>"); },
               {"scene.xml:3: a second integrator, the first is at", "scene.xml:2"});
}

}  // namespace
}  // namespace twopass
