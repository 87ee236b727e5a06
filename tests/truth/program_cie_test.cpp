// CIE 171:2006, sections 5.2 to 5.9 and 5.11, through the program: lm, cd and lx in all channels. The values
// are those of the closed forms; where the standard's own tables are wrong (5.7; 5.9 near the opening) ours
// follow the formula. Illuminance is measured on Lambertian surfaces of reflectance 1/2, over 2 x 2 cm around
// each point of the standard.
#include "tests/truth/program_truth.h"

namespace twopass {
namespace {

using test::Measured;

const V3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), o(0.0);

class ProgramCie : public test::ProgramTruth {
 protected:
  static constexpr double reflectance = 0.5, pitch = 0.5;
  static Surface measured(const std::string& obj) { return {"measured", obj, reflectance}; }
  static Surface black(const std::string& name, const std::string& obj) { return {name, obj, 0.0}; }

  // Illuminances at `points` points half a metre apart, in a line around `centre` from the end to which `up`
  // points.
  std::vector<Measured> line(const std::vector<Surface>& surfaces, const std::string& more, const V3d& centre,
                             const V3d& normal, const V3d& up, int points, const std::string& way,
                             int samples) const {
    write_scene(surfaces, more, flat_camera(centre, normal, up, pitch, 1, 0.04));
    std::vector<Measured> values = picture(way, 1, points, samples);
    for (Measured& value : values) value = value * (M_PI / reflectance);
    return values;
  }
  struct Readings {
    std::string name;
    std::vector<double> truth;
    double scale = 1.0;  // of illuminance to what is read
    double bias = 0.0;   // relative, of the largest
  };
  // Where nothing is seen, some is of the 2 cm around it.
  static void record_all(const Readings& readings, const std::vector<Measured>& values,
                         const std::string& way) {
    double largest = 0.0;
    for (const double truth : readings.truth) largest = std::max(largest, truth);
    for (std::size_t i = 0; i < readings.truth.size(); ++i) {
      const std::string point = readings.truth.size() > 1 ? ", point " + std::to_string(i + 1) : "";
      record(readings.name + point + ": " + way, readings.truth[i], values[i] * readings.scale,
             (readings.truth[i] == 0.0 ? 0.01 : readings.bias + curvature) * largest + rounding);
    }
  }
  // Of the printed values; and what curvature adds over 2 cm, a part of the largest.
  static constexpr double rounding = 6e-4, curvature = 1e-4;
  // Points A to F up the wall y = 0, the highest first, and G to N along the floor from that wall.
  void expect_wall(const Readings& readings, std::vector<Surface> surfaces, const std::string& more,
                   const std::string& way, int samples) const {
    surfaces.push_back(measured(quad(o, z * 3, x * 4)));
    record_all(readings, line(surfaces, more, {2, 0, 1.5}, y, z, 6, way, samples), way);
  }
  void expect_floor(const Readings& readings, std::vector<Surface> surfaces, const std::string& more,
                    const std::string& way, int samples) const {
    surfaces.push_back(measured(quad(o, x * 4, y * 4)));
    record_all(readings, line(surfaces, more, {2, 2, 0}, z, -y, 8, way, samples), way);
  }
  static std::string point_light(const std::string& intensity, const V3d& at) {
    return "<emitter type='point'><transform name='to_world'><rotate x='1' angle='180'/><translate x='" +
           number(at.x) + "' y='" + number(at.y) + "' z='" + number(at.z) + "'/></transform>" + intensity +
           "</emitter>\n";
  }
  static std::string isotropic(const V3d& at) {
    return point_light("<rgb name='intensity' value='" + number(10000 / (4 * M_PI)) + "'/>", at);
  }

  // A sky around z whose radiance is a function of the zenith angle; so bright that an open floor has 100 lx.
  template <class Radiance>
  std::string sky(Radiance radiance) const {
    constexpr int rows = 1024, columns = 8;
    double floor_lux = 0.0;
    for (int i = 0; i < 100000; ++i) {
      const double zenith = (i + 0.5) / 100000 * M_PI / 2;
      floor_lux += 2 * M_PI * radiance(zenith) * std::cos(zenith) * std::sin(zenith) * M_PI / 2 / 100000;
    }
    std::ofstream file(folder_ / "sky.pfm", std::ios::binary);
    file << "PF\n" << columns << " " << rows << "\n-1.0\n";
    for (int row = rows - 1; row >= 0; --row) {  // from the bottom up; rows run from pole to pole
      const auto value = static_cast<float>(100 / floor_lux * radiance(row / (rows - 1.0) * M_PI));
      const std::vector<float> pixels(std::size_t{3} * columns, value);
      file.write(reinterpret_cast<const char*>(pixels.data()),
                 static_cast<std::streamsize>(pixels.size() * sizeof(float)));
    }
    return "<emitter type='envmap'><string name='filename' value='sky.pfm'/><transform name='to_world'><rotate "
           "x='1' angle='90'/></transform></emitter>";
  }
  // Black walls, floor and ceiling of the 4 x 4 x 3 m room without what is named, which is measured or open.
  static std::vector<Surface> black_room(const std::string& without, const std::string& and_without = "") {
    std::vector<Surface> room{
        black("floor", quad(o, x * 4, y * 4)), black("ceiling", quad(z * 3, y * 4, x * 4)),
        black("near", quad(o, z * 3, x * 4)),  black("far", quad(y * 4, x * 4, z * 3)),
        black("left", quad(o, y * 4, z * 3)),  black("right", quad(x * 4, z * 3, y * 4))};
    std::erase_if(room, [&](const Surface& s) { return s.name == without || s.name == and_without; });
    return room;
  }
};

TEST_F(ProgramCie, PointLights_5_2) {
  std::string angles, candela;
  for (int i = 0; i <= 360; ++i) {
    angles += number(0.25 * i) + "\n";
    candela += number(1000 * std::abs(std::cos(i * M_PI / 720))) + "\n";
  }
  write("cosine.ies",
        "IESNA:LM-63-1995\nTILT=NONE\n1 1000 1 361 1 1 2 0 0 0\n1 1 100\n" + angles + "0\n" + candela);
  const std::string cosine =
      point_light("<string name='ies_file' value='cosine.ies'/><rgb name='intensity' value='1'/>", z * 3);
  const struct {
    std::string name, light;
    std::vector<std::vector<double>> truth;  // for x = 0, .5, 1, 1.5: y from x on in steps of .5
  } lights[] = {
      {"CIE 5.2, cosine luminaire",
       cosine,
       {{111.1111, 105.1863, 90.0, 71.1111}, {99.7230, 85.6633, 68.0529}, {74.3802, 59.9750}, {49.3827}}},
      {"CIE 5.2, isotropic luminaire",
       isotropic(z * 3),
       {{88.4194, 84.8592, 75.4938, 63.2678}, {81.5316, 72.7488, 61.2160}, {65.4368, 55.6810}, {48.1294}}}};
  for (const auto& light : lights)
    for (std::size_t column = 0; column < 4; ++column) {
      const double at = 0.5 * static_cast<double>(column);
      // The first point lies in the middle of the first pixel.
      for (const std::string way : {"path", "direct"})
        record_all({light.name + ", x = " + number(at), light.truth[column], 1.0, 1e-4},
                   line({measured(quad({-4, -4, 0}, x * 8, y * 8))}, light.light, {at, at + 0.75, 0}, z, -y, 4,
                        way, 64),
                   way);
    }
}

TEST_F(ProgramCie, AreaLight_5_3) {
  const std::vector<Surface> lamp{{"lamp", quad({1.5, 1.5, 3}, y, x), 0.0, 1000.0}};
  for (const std::string way : {"path", "unbiased", "twopass", "direct"}) {
    const double bias = way == "twopass" ? 0.002 : 0.0;
    expect_wall({"CIE 5.3, wall", {32.6769, 75.1939, 81.3232, 69.0606, 53.4035, 40.0019}, 1.0, bias}, lamp, "",
                way, 4096);
    expect_floor({"CIE 5.3, floor",
                  {61.4241, 79.2552, 95.6673, 105.7782, 105.7782, 95.6673, 79.2552, 61.4241},
                  1.0,
                  bias},
                 lamp, "", way, 4096);
  }
}

TEST_F(ProgramCie, FluxConservation_5_4) {
  const struct {
    V3d p, a, b;
  } walls[] = {{o, x * 4, y * 4},     {z * 3, y * 4, x * 4}, {o, z * 3, x * 4},
               {y * 4, x * 4, z * 3}, {o, y * 4, z * 3},     {x * 4, z * 3, y * 4}};
  double lumen = 0.0, variance = 0.0;
  for (const auto& wall : walls) {
    const V3d normal = wall.a.cross(wall.b).normalized(), centre = wall.p + (wall.a + wall.b) / 2.0;
    const bool is_level = std::abs(normal.z) > 0.5;
    constexpr int width = 64;
    write_scene({measured(quad(wall.p, wall.a, wall.b))}, isotropic({1, 2.5, 2.25}),
                flat_camera(centre, normal, is_level ? y : z, 4.0 / width, width));
    const int height = is_level ? 64 : 48;
    const double area = wall.a.length() * wall.b.length() / (width * height);
    for (const Measured& pixel : picture("direct", width, height, 16)) {
      const Measured flux = pixel * (M_PI / reflectance * area);
      lumen += flux.value;
      variance += flux.error * flux.error;
    }
  }
  record("CIE 5.4, flux of 10000 lm on all walls: direct", 10000.0, {lumen, std::sqrt(variance)});
}

TEST_F(ProgramCie, Glass_5_5) {
  const std::vector<Surface> lamp{{"lamp", quad({-1, -1, 2}, y * 2, x * 2), 0.0, 1.0}};
  const std::string index = "<float name='int_ior' value='1.52'/><float name='ext_ior' value='1'/></bsdf>";
  const std::string slab =
      "<shape type='cube'><transform name='to_world'><scale z='.05'/><translate z='1'/></transform>"
      "<bsdf type='dielectric'>" +
      index + "</shape>";
  const std::string pane =
      "<shape type='rectangle'><transform name='to_world'><translate z='1'/></transform>"
      "<bsdf type='thindielectric'>" +
      index + "</shape>";
  for (const auto& [name, glass] : {std::pair{"a slab", slab}, {"a thin pane", pane}})
    for (const std::string way : {"path", "twopass", "unbiased"}) {
      // Looking up from z = 0.
      write_scene(lamp, glass,
                  "<sensor type='orthographic'><transform name='to_world'><scale value='.1'/><lookat "
                  "origin='.1,.2,0' target='.1,.2,1' up='0,1,0'/></transform><film type='hdrfilm'><rfilter "
                  "type='box'/></film></sensor>");
      record(std::string("CIE 5.5, transmittance of ") + name + ", index 1.52: " + way, .918318,
             mean(way, 8, 256));
    }
}

TEST_F(ProgramCie, ReflectorOnTheFloor_5_6) {
  const std::vector<Surface> floor{{"floor", quad(o, x * 4, y * 4), 0.3}};
  const std::string sun =
      "<emitter type='directional'><vector name='direction' value='0,0,-1'/><rgb name='irradiance' "
      "value='1000'/></emitter>";
  // Sun, floor, wall, camera: not what the wall returns to the floor. The highest point, at 2.75 m, sees least.
  const std::vector<double> truth{12.9674, 16.7163, 21.6385, 27.9916, 35.9005};
  expect_wall({"CIE 5.6, wall, 100 E / (E_floor rho)", truth, 1 / 3.0}, floor, sun, "path --max-depth 3",
              65536);
  expect_wall({"CIE 5.6, wall, 100 E / (E_floor rho)", truth, 1 / 3.0}, floor, sun, "unbiased --max-depth 3",
              65536);
  expect_wall({"CIE 5.6, wall, 100 E / (E_floor rho)", truth, 1 / 3.0, 0.015}, floor, sun,
              "twopass --max-depth 3", 4096);
}

TEST_F(ProgramCie, ReflectorBehindABox_5_7) {
  const std::string box =
      quad({0, 2.5, 0}, z, x * 4) + quad({0, 2.5, 1}, x * 4, y * .2) + quad({0, 2.7, 0}, x * 4, z);
  // An evenly lit reflector is a lamp.
  std::vector<Surface> lamp{{"reflector", quad(y * 4, x * 4, z * 3), 0.0, 100 / M_PI}, black("box", box)};
  for (const std::string way : {"path", "twopass"}) {
    expect_wall({"CIE 5.7, wall, 100 E / (E_wall rho)", {16.0706, 16.3297, 15.3988, 13.3220, 10.3169, 7.0790}},
                lamp, "", way, 32768);
    expect_floor({"CIE 5.7, floor, 100 E / (E_wall rho)", {3.3823, 3.6290, 3.0130, 0.0, 0.0}}, lamp, "", way,
                 65536);
  }
}

TEST_F(ProgramCie, Interreflections_5_8) {
  const struct {
    double reflectance, truth;
  } cases[] = {{.05, 5.4825}, {.1, 11.5741},  {.2, 26.0417},  {.3, 44.6429}, {.4, 69.4444},   {.5, 104.1667},
               {.6, 156.25},  {.7, 243.0556}, {.8, 416.6667}, {.9, 937.5},   {.95, 1979.1667}};
  for (const auto& c : cases) {
    // A cube of 4 m: all of its sides have the same mean.
    const double r = c.reflectance;
    write_scene({{"floor", quad(o, x * 4, y * 4), r},
                 {"ceiling", quad(z * 4, y * 4, x * 4), r},
                 {"left", quad(o, y * 4, z * 4), r},
                 {"right", quad(x * 4, z * 4, y * 4), r},
                 {"near", quad(o, z * 4, x * 4), r},
                 {"far", quad(y * 4, x * 4, z * 4), r}},
                isotropic({2, 2, 2}), flat_camera({2, 2, 0}, z, y, 4.0 / 16, 16));
    for (const std::string way : {"path", "unbiased", "twopass", "radiosity"}) {
      if (way != "path" && r != .5 && r != .95) continue;
      const bool is_biased = way == "twopass" || way == "radiosity";
      record("CIE 5.8, rho = " + number(r) + ", mean of direct and indirect: " + way, c.truth + 104.166667,
             mean(way + " --elements 400", 16, is_biased ? 16 : 256) * (M_PI / r),
             is_biased ? 0.005 * (c.truth + 104.2) : 0.0);
    }
  }
}

TEST_F(ProgramCie, RoofOpenings_5_9) {
  const auto uniform = [](double zenith) { return zenith <= M_PI / 2 ? 1.0 : 0.0; };
  const auto overcast = [](double zenith) {
    return zenith < M_PI / 2 ? 1 + 4 * std::exp(-0.7 / std::cos(zenith)) : 0.0;
  };
  const auto traditional = [](double zenith) {
    return zenith <= M_PI / 2 ? (1 + 2 * std::cos(zenith)) / 3 : 0.0;
  };
  const struct {
    const char* name;
    double edge;
    int kind;
    std::vector<double> wall, floor;
  } cases[] = {
      {"1x1 m, uniform sky",
       1,
       5,
       {1.0401, 2.3935, 2.5886, 2.1983, 1.6999, 1.2733},
       {1.9552, 2.5228, 3.0452, 3.3670}},
      {"4x4 m, uniform sky",
       4,
       5,
       {45.1226, 35.9005, 27.9916, 21.6385, 16.7163, 12.9674},
       {26.7952, 30.9387, 33.9757, 35.5666}},
      {"1x1 m, overcast sky", 1, 1, {.457, 1.644, 2.336, 2.261, 1.876, 1.465}, {2.335, 3.110, 3.839, 4.294}},
      {"4x4 m, overcast sky",
       4,
       1,
       {35.823, 31.535, 26.791, 22.076, 17.874, 14.360},
       {31.858, 37.277, 41.249, 43.324}},
      {"1x1 m, traditional sky",
       1,
       16,
       {.564, 1.783, 2.318, 2.198, 1.821, 1.427},
       {2.289, 3.074, 3.822, 4.294}},
      {"4x4 m, traditional sky",
       4,
       16,
       {37.355, 32.144, 26.723, 21.745, 17.501, 14.032},
       {31.346, 36.739, 40.681, 42.735}}};
  for (const auto& c : cases) {
    const std::string light = c.kind == 5 ? sky(uniform) : c.kind == 1 ? sky(overcast) : sky(traditional);
    std::string frame;  // the ceiling around a small opening
    if (c.edge < 4)
      for (const auto& [p, a, b] : {std::array{V3d(0, 0, 3), y * 1.5, x * 4},
                                    {V3d(0, 2.5, 3), y * 1.5, x * 4},
                                    {V3d(0, 1.5, 3), y, x * 1.5},
                                    {V3d(2.5, 1.5, 3), y, x * 1.5}})
        frame += quad(p, a, b);
    for (const std::string way : {"path"}) {
      for (const bool on_wall : {true, false}) {
        std::vector<Surface> room = black_room("ceiling", on_wall ? "near" : "floor");
        if (!frame.empty()) room.push_back(black("ceiling", frame));
        const Readings readings{std::string("CIE 5.9, ") + c.name + (on_wall ? ", wall" : ", floor"),
                                on_wall ? c.wall : c.floor};
        // A small opening in a large sky is found by one in 30 samples.
        const int samples = c.edge < 4 ? 65536 : 4096;
        if (on_wall)
          expect_wall(readings, room, light, way, samples);
        else
          expect_floor(readings, room, light, way, samples);
      }
    }
  }
}

TEST_F(ProgramCie, FacadeOpening_5_11) {
  const std::string light = sky([](double zenith) { return zenith <= M_PI / 2 ? 1.0 : 0.3; });
  for (const std::string way : {"path"}) {
    expect_wall({"CIE 5.11, wall", {6.1828, 8.9595, 11.3445, 13.2223, 14.5624, 15.4102}},
                black_room("far", "near"), light, way, 16384);
    const std::vector<double> from_the_wall{5.7873,  7.6269,  10.1905, 13.7722,
                                            18.7391, 25.4655, 34.1479, 44.4915};
    expect_floor({"CIE 5.11, floor", from_the_wall}, black_room("far", "floor"), light, way, 16384);
    std::vector<Surface> room = black_room("far", "ceiling");
    room.push_back(measured(quad(z * 3, y * 4, x * 4)));
    record_all({"CIE 5.11, ceiling / .3", from_the_wall, 1 / 0.3},
               line(room, light, {2, 2, 3}, -z, -y, 8, way, 32768), way);
  }
}

}  // namespace
}  // namespace twopass
