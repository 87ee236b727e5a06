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
  expect_near(camera.ray({50, 50}).ray.direction, {0, 0, 1});
  // Seen along +z with +y up, +x is on the left.
  EXPECT_GT(camera.ray({0, 50}).ray.direction.x, 0.7f);
  EXPECT_GT(camera.ray({50, 0}).ray.direction.y, 0.7f);
}

TEST_F(MitsubaSensor, MatricesArePlacedAsWritten) {
  const LoadedScene loaded = sensor(
      "<transform name='to_world'><matrix value='-1 0 0 0 0 1 0 1 0 0 -1 6.8 0 0 0 1'/>"
      "</transform>");
  const Camera camera(*loaded.scene.camera, 100, 100);
  expect_near(camera.ray({50, 50}).ray.origin, {0, 1, 6.79f});  // on the near clipping plane
  expect_near(camera.ray({50, 50}).ray.direction, {0, 0, -1});
  EXPECT_GT(camera.ray({100, 50}).ray.direction.x, 0.0f);
}

TEST_F(MitsubaSensor, CamerasAreRigid) {
  expect_error([&] { sensor("<transform name='to_world'><scale value='2'/></transform>"); },
               {"scene.xml:3: the camera's transform contains a scale"});
  expect_error(
      [&] { sensor("<transform name='to_world'><matrix value='1 0.6 0 0 0.8 0 0 0 1'/></transform>"); },
      {"the camera's transform is sheared"});
}

TEST_F(MitsubaSensor, PrincipalPointAndClippingPlanes) {
  const CameraDescription camera =
      *sensor(
           "<float name='principal_point_offset_x' value='0.1'/>"
           "<float name='principal_point_offset_y' value='-0.2'/>"
           "<float name='near_clip' value='2'/><float name='far_clip' value='30'/>")
           .scene.camera;
  EXPECT_EQ(camera.principal_point_offset, V2d(0.1, -0.2));
  EXPECT_EQ(camera.near_clip, 2.0);
  EXPECT_EQ(camera.far_clip, 30.0);
  EXPECT_EQ(sensor("").scene.camera->near_clip, 1e-2) << "Mitsuba's default";
  EXPECT_EQ(sensor("").scene.camera->far_clip, 1e4);
  expect_error([&] { sensor("<float name='near_clip' value='-1'/>"); },
               {"scene.xml:3: 'near_clip' must not be negative"});
  expect_error([&] { sensor("<float name='far_clip' value='0.001'/>"); },
               {"scene.xml:3: 'far_clip' must be larger than 'near_clip'"});
}

TEST_F(MitsubaSensor, ThinLens) {
  const auto lens = [&](const std::string& body) {
    return *read("<sensor type='thinlens'>\n" + body + "</sensor>").scene.camera;
  };
  const CameraDescription camera = lens(
      "<float name='aperture_radius' value='0.25'/><float name='focus_distance' value='4'/>"
      "<float name='fov' value='30'/><transform name='to_world'><translate x='1'/></transform>");
  EXPECT_EQ(camera.projection, Projection::perspective);
  EXPECT_EQ(camera.aperture_radius, 0.25);
  EXPECT_EQ(camera.focus_distance, 4.0);
  EXPECT_EQ(camera.fov_degrees, 30.0);
  EXPECT_EQ(lens("<float name='aperture_radius' value='1'/><float name='far_clip' value='50'/>").focus_distance,
            50.0);
  EXPECT_EQ(read("<sensor type='thinlens'><float name='apertureRadius' value='1'/></sensor>", "0.6.0")
                .scene.camera->aperture_radius,
            1.0);
  expect_error([&] { lens(""); }, {"scene.xml:2: sensor 'thinlens' has no aperture_radius; add it"});
  expect_error([&] { lens("<float name='aperture_radius' value='-1'/>"); },
               {"scene.xml:3: 'aperture_radius' must not"});
  expect_error(
      [&] { lens("<float name='aperture_radius' value='1'/><float name='focus_distance' value='0'/>"); },
      {"scene.xml:3: 'focus_distance' must be above 0"});
  expect_error(
      [&] { lens("<float name='aperture_radius' value='1'/><float name='lens' value='0'/>"); },
      {"sensor 'thinlens' has no property 'lens'; its properties: ", "aperture_radius, focus_distance"});
  expect_error(
      [&] {
        lens(
            "<float name='aperture_radius' value='1'/><transform name='to_world'><scale "
            "value='2'/></transform>");
      },
      {"contains a scale"});
}

TEST_F(MitsubaSensor, Orthographic) {
  const auto orthographic = [&](const std::string& body) {
    return *read("<sensor type='orthographic'>\n" + body + "</sensor>").scene.camera;
  };
  const CameraDescription camera =
      orthographic("<transform name='to_world'><scale x='3' y='3'/><translate z='-5'/></transform>");
  EXPECT_EQ(camera.projection, Projection::orthographic);
  EXPECT_EQ(camera.to_world[0][0], 3.0);
  expect_error([&] { orthographic("<float name='fov' value='30'/>"); },
               {"scene.xml:3: sensor 'orthographic' has no property 'fov'"});
  expect_error([&] { orthographic("<transform name='to_world'><scale x='0'/></transform>"); },
               {"scene.xml:3: "});
  expect_error(
      [&] { orthographic("<transform name='to_world'><matrix value='1 0.6 0 0 0.8 0 0 0 1'/></transform>"); },
      {"the camera's transform is sheared"});
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
  expect_error([&] { film("<string name='component_format' value='float64'/>"); },
               {"component_format 'float64' is not supported; supported: float16, float32, uint32"});
  expect_error([&] { film("<string name='file_format' value='png'/>"); },
               {"file_format 'png' is not supported; supported: openexr, exr, rgbe, pfm"});
  EXPECT_TRUE(has_note(sensor("<film type='hdrfilm'><string name='file_format' value='pfm'/></film>"),
                       "scene.xml:3: file_format 'pfm': the format is what -o names"));
  EXPECT_TRUE(has_note(sensor("<film type='hdrfilm'><string name='component_format' value='uint32'/></film>"),
                       "component_format 'uint32': the picture is written as float32"));
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

TEST_F(MitsubaSensor, CropWindows) {
  const std::string size = "<integer name='width' value='320'/><integer name='height' value='240'/>\n";
  const auto integer = [](const char* name, int value) {
    return "<integer name='" + std::string(name) + "' value='" + std::to_string(value) + "'/>\n";
  };
  EXPECT_FALSE(film(size + integer("crop_offset_x", 0) + integer("crop_width", 320)).crop);
  const FileSettings settings = film(size + integer("crop_offset_x", 20) + integer("crop_offset_y", 30) +
                                     integer("crop_width", 48) + integer("crop_height", 210));
  ASSERT_TRUE(settings.crop);
  EXPECT_EQ(settings.crop->corner, V2i(20, 30));
  EXPECT_EQ(settings.crop->size, V2i(48, 210));
  EXPECT_EQ(settings.width, 320);
  // Beyond the picture, with numbers that would overflow a sum.
  expect_error([&] { film(size + integer("crop_offset_x", 320)); },
               {"scene.xml:5: the crop window begins outside of the picture; give an offset from 0 to 319"});
  expect_error([&] { film(size + integer("crop_offset_y", -1)); }, {"begins outside"});
  expect_error([&] { film(size + integer("crop_offset_x", 1)); },
               {"scene.xml:5: the crop window reaches beyond the picture; give a crop_width from 1 to 319"});
  expect_error([&] { film(size + integer("crop_height", 241)); }, {"give a crop_height from 1 to 240"});
  expect_error([&] { film(size + integer("crop_width", 2147483647)); }, {"reaches beyond"});
  expect_error([&] { film(size + integer("crop_width", 0)); }, {"reaches beyond"});
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
  EXPECT_EQ(filter("<rfilter type='catmullrom'/>").kind, FilterKind::catmullrom);
  EXPECT_EQ(filter("<rfilter type='mitchell'/>").b, 1.0f / 3.0f);
  const Filter mitchell =
      filter("<rfilter type='mitchell'><float name='B' value='0.2'/><float name='C' value='0.4'/></rfilter>");
  EXPECT_EQ(mitchell.b, 0.2f);
  EXPECT_EQ(mitchell.c, 0.4f);
  EXPECT_EQ(filter("<rfilter type='lanczos'/>").radius, 3.0f);
  EXPECT_EQ(filter("<rfilter type='lanczos'><integer name='lobes' value='2'/></rfilter>").radius, 2.0f);
  const LoadedScene old = sensor(
      "<film type='hdrfilm'><rfilter type='mitchell'><float name='B' value='0.1'/></rfilter></film>", "0.6.0");
  EXPECT_EQ(old.settings.filter.b, 0.1f);
  expect_error([&] { filter("<rfilter type='sinc'/>"); },
               {"scene.xml:4: ", "rfilter 'sinc'", "box, tent, gaussian, mitchell, catmullrom, lanczos"});
  expect_error([&] { filter("<rfilter type='tent'><float name='radius' value='0'/></rfilter>"); },
               {"'radius' must be from 0.001 to 100"});
  expect_error([&] { filter("<rfilter type='lanczos'><integer name='lobes' value='0'/></rfilter>"); },
               {"'lobes' must be from 1 to 16"});
  expect_error([&] { filter("<rfilter type='mitchell'><float name='B' value='1e9'/></rfilter>"); },
               {"'B' must be from -10 to 10"});
}

TEST_F(MitsubaSensor, OtherFilmsAndSensorsAreRefused) {
  expect_error([&] { sensor("<film type='ldrfilm'/>"); },
               {"film 'ldrfilm' is not supported", "renamed: use hdrfilm"});
  expect_error([&] { sensor("<film type='specfilm'/>"); }, {"supported films: hdrfilm"});
  for (const char* type : {"distant", "batch", "radiancemeter", "irradiancemeter", "fisheye"})
    expect_error([&] { read("<sensor type='" + std::string(type) + "'/>"); },
                 {"scene.xml:2: ", "sensor '" + std::string(type) + "'",
                  "supported sensors: perspective, thinlens, orthographic"});
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
  for (const char* type : {"volpath", "volpathmis", "ptracer", "bdpt", "stokes", "depth"}) {
    const LoadedScene other = read("<integrator type='" + std::string(type) + "'/>");
    EXPECT_FALSE(other.settings.integrator) << type;
    EXPECT_TRUE(has_note(other, "integrator '" + std::string(type) + "' is not known here")) << type;
  }
  const LoadedScene loaded = read(
      "<integrator type='sppm'><integer name='maxDepth' value='65'/>"
      "<integer name='photonCount' value='1000'/></integrator>",
      "0.6.0");
  EXPECT_FALSE(loaded.settings.integrator);
  EXPECT_EQ(loaded.settings.max_depth, 65);
  EXPECT_TRUE(has_note(loaded, "scene.xml:2: integrator 'sppm' is not known here: rendering with the default"));
}

TEST_F(MitsubaSensor, WrappersGiveWayToTheIntegratorInThem) {
  for (const char* wrapper : {"aov", "moment", "merge"}) {
    const LoadedScene loaded =
        read("<integrator type='" + std::string(wrapper) +
             "'><integrator type='path'><integer name='max_depth' value='4'/></integrator>"
             "</integrator>");
    EXPECT_EQ(loaded.settings.integrator, "path") << wrapper;
    EXPECT_EQ(loaded.settings.max_depth, 4);
    EXPECT_TRUE(loaded.notes.empty());
  }
  const LoadedScene nested = read(
      "<integrator type='aov'><string name='aovs' value='dd:depth'/>"
      "<integrator type='moment'><integrator type='direct'/><integrator "
      "type='path'/></integrator></integrator>");
  EXPECT_EQ(nested.settings.integrator, "direct");
  EXPECT_TRUE(has_note(nested, "its outputs 'dd:depth' are not written"));
  EXPECT_TRUE(has_note(nested, "'moment': of the integrators in it the first is used"));
  const LoadedScene empty = read("<integrator type='aov'/>");
  EXPECT_FALSE(empty.settings.integrator);
  EXPECT_TRUE(has_note(empty, "there is none in it"));
  expect_error([&] { read("<integrator type='aov' id='a'><ref id='a'/></integrator>"); },
               {"this <integrator> refers to itself"});
  expect_error(
      [&] {
        read(
            "<integrator type='aov'><integrator type='path'>"
            "\n<integer name='depth' value='4'/></integrator></integrator>");
      },
      {"scene.xml:3: integrator 'path' has no property 'depth'"});
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
