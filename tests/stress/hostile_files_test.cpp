// Files with values that no scene should have, through the program: a finite picture or one clear error.
#include <nlohmann/json.hpp>

#include "render/image/picture.h"
#include "tests/program/program.h"

namespace twopass {
namespace {

class HostileFiles : public Program {
 protected:
  // A picture without a value that is not finite, and statistics that say so; its mean radiance.
  double expect_picture(const std::string& scene, const std::string& integrator, const std::string& more = "") {
    SCOPED_TRACE(scene + " by " + integrator);
    const Outcome result =
        run("render " + scene + " -o a.exr --exr-type float --stats s.json --spp 8 --integrator " + integrator +
            " --size 8x8 --elements 200 " + more);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    if (result.exit_code != 0) return 0.0;
    notes_ = result.err;
    const auto stats = nlohmann::json::parse(read(folder_ / "s.json"));
    EXPECT_EQ(stats["render"]["non_finite_samples"], 0);
    EXPECT_TRUE(stats["render"]["first_non_finite"].is_null());
    EXPECT_LT(stats["peak_memory_bytes"], 1e9);
    double sum = 0.0;
    for (const C3f& c : rgb_pixels(read_picture(folder_ / "a.exr"))) {
      EXPECT_TRUE(std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z));
      sum += static_cast<double>(c.x + c.y + c.z) / (3.0 * 64.0);
    }
    return sum;
  }
  // One line `where: what; what to do`.
  void expect_error(const std::string& scene, const std::string& part) {
    const Outcome result = run("render " + scene + " -o a.exr --spp 1 --quiet");
    EXPECT_EQ(result.exit_code, 1) << scene << result.err;
    EXPECT_NE(result.err.find(part), std::string::npos) << scene << ": " << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << scene << ": " << result.err;
  }
  // A ball of the material under an even sky, and whatever else.
  void write_ball(const std::string& name, const std::string& material, const std::string& emitter = "") const {
    write(
        name,
        "<scene version='3.0.0'><sensor type='perspective'><transform name='to_world'>"
        "<lookat origin='0,-3,0' target='0,0,0' up='0,0,1'/></transform><float name='fov' value='30'/></sensor>"
        "<shape type='sphere'>" +
            material + "</shape>" + (emitter.empty() ? std::string("<emitter type='constant'/>") : emitter) +
            "</scene>");
  }
  // A picture of 2 x 3 pixels, all 1 but for two.
  void write_pfm(const std::string& name, float first, float second) const {
    std::ofstream file(folder_ / name, std::ios::binary);
    file << "PF\n2 3\n-1.0\n";
    float values[18];
    std::fill_n(values, 18, 1.0f);
    values[0] = first;
    values[10] = second;
    file.write(reinterpret_cast<const char*>(values), sizeof values);
  }
  void write_obj(const std::string& name, const std::string& more) const {
    write(name, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n" + more + "f 1 2 3 4\n");
  }

  std::string notes_;
  static constexpr const char* integrators[] = {"path", "twopass", "unbiased", "radiosity", "direct"};
};

TEST_F(HostileFiles, NumbersThatAreNotFinite) {
  write_obj("nan.obj", "v nan 0 0\n");
  write_obj("infinite.obj", "v 1 -inf 0\n");
  write_obj("overflow.obj", "v 1 1e39 0\n");
  write_obj("normal.obj", "vn nan 0 1\n");
  write_obj("uv.obj", "vt 0 inf\n");
  for (const char* name : {"nan.obj", "infinite.obj", "overflow.obj", "normal.obj", "uv.obj"})
    expect_error(name, std::string(name) + ":5: ");
  write_ball("albedo.xml", "<bsdf type='diffuse'><rgb name='reflectance' value='nan,1,1'/></bsdf>");
  write_ball("radiance.xml", "<emitter type='area'><rgb name='radiance' value='1,inf,1'/></emitter>");
  write_ball("roughness.xml", "<bsdf type='roughconductor'><float name='alpha' value='nan'/></bsdf>");
  write_ball("index.xml", "<bsdf type='dielectric'><float name='int_ior' value='inf'/></bsdf>");
  for (const char* name : {"albedo.xml", "radiance.xml", "roughness.xml", "index.xml"})
    expect_error(name, std::string(name) + ":1: ");
}

TEST_F(HostileFiles, EmptyScenesAndSingleTriangles) {
  write("empty.obj", "");
  expect_error("empty.obj", "empty.obj: ");
  write("nothing.xml", "<scene version='3.0.0'/>");
  write("flat.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n");
  write("one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  write("normals.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 0\nvn 0 0 -1\nvn 1 0 0\nf 1//1 2//2 3//3\n");
  for (const char* integrator : integrators) {
    EXPECT_NEAR(expect_picture("nothing.xml", integrator, "--sky 2,2,2"), 2.0, 1e-5);
    for (const char* name : {"one.obj", "normals.obj"}) expect_picture(name, integrator, "--sky 2,2,2");
  }
  run("render flat.obj -o a.exr --spp 1 --sky 1,1,1");  // exit codes 0 and 1 are both sane; a signal is not
  EXPECT_LE(run("render flat.obj -o a.exr --spp 1 --sky 1,1,1").exit_code, 1);
}

TEST_F(HostileFiles, ReflectancesAboveOne) {
  write("bright.mtl", "newmtl bright\nKd 1.5 2 1e30\n");
  write_obj("bright.obj", "mtllib bright.mtl\nusemtl bright\n");
  for (const char* integrator : {"path", "twopass"}) {
    EXPECT_NEAR(expect_picture("bright.obj", integrator, "--sky 1,1,1"), 1.0, 0.01);
    EXPECT_NE(notes_.find("reflectance above 1 reduced to 1"), std::string::npos) << notes_;
  }
  write_ball("bright.xml", "<bsdf type='diffuse'><rgb name='reflectance' value='1.5,1,1'/></bsdf>");
  EXPECT_NEAR(expect_picture("bright.xml", "path", "--sky 1,1,1"), 1.0, 0.01);
  EXPECT_NE(notes_.find("'reflectance' above 1 reduced to 1"), std::string::npos) << notes_;
}

TEST_F(HostileFiles, TexturesAndEnvironmentMaps) {
  const float infinite = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  write_pfm("nan.pfm", nan, nan);
  write_pfm("infinite.pfm", infinite, -infinite);
  write_pfm("negative.pfm", -1.0f, -1e30f);
  write_pfm("huge.pfm", 1e12f, 1e38f);
  for (const std::string name : {"nan", "infinite", "negative", "huge"}) {
    const std::string file = "<string name='filename' value='" + name + ".pfm'/>";
    write_ball("albedo.xml",
               "<bsdf type='diffuse'><texture type='bitmap' name='reflectance'>" + file + "</texture></bsdf>");
    write_ball("lamp.xml",
               "<emitter type='area'><texture type='bitmap' name='radiance'>" + file + "</texture></emitter>");
    write_ball("sky.xml", "<bsdf type='diffuse'/>", "<emitter type='envmap'>" + file + "</emitter>");
    for (const char* integrator : {"path", "twopass", "unbiased"}) {
      EXPECT_LE(expect_picture("albedo.xml", integrator), 1.01) << name;
      expect_picture("lamp.xml", integrator);
      expect_picture("sky.xml", integrator);
    }
  }
}

// A smooth ball of any index in an even sky is invisible; rough and coated ones lose some light.
TEST_F(HostileFiles, IndicesAndRoughnessAtTheEndsOfTheirRanges) {
  for (const std::string index : {"1e30", "1e-30"}) {
    write_ball("index.xml", "<bsdf type='roughplastic'><float name='int_ior' value='" + index + "'/></bsdf>");
    expect_error("index.xml", "index.xml:1: an index of refraction that no substance has");
  }
  for (const std::string index : {"0.001", "1", "1.000001", "10", "1000"}) {
    const std::string values =
        "<float name='int_ior' value='" + index + "'/><float name='ext_ior' value='1'/></bsdf>";
    write_ball("glass.xml", "<bsdf type='dielectric'>" + values);
    write_ball("plastic.xml", "<bsdf type='plastic'>" + values);
    write_ball("rough_plastic.xml", "<bsdf type='roughplastic'>" + values);
    for (const char* integrator : {"path", "twopass"}) {
      // With an index of 10 most light goes around inside, and roulette ends paths: 1.3e-3 is its noise.
      if (index != "1000" && index != "0.001") {
        EXPECT_NEAR(expect_picture("glass.xml", integrator), 1.0, 4e-3) << index;
      }
      for (const char* name : {"plastic.xml", "rough_plastic.xml"})
        EXPECT_LE(expect_picture(name, integrator), 1.02) << name << index;
    }
  }
  for (const std::string alpha : {"0", "1e-8", "1e-4"}) {
    write_ball("metal.xml", "<bsdf type='roughconductor'><float name='alpha' value='" + alpha + "'/></bsdf>");
    write_ball("ground.xml", "<bsdf type='roughdielectric'><float name='alpha' value='" + alpha + "'/></bsdf>");
    EXPECT_NEAR(expect_picture("metal.xml", "path"), 1.0, 0.01) << alpha;
    EXPECT_NEAR(expect_picture("ground.xml", "path"), 1.0, 0.03) << alpha;
  }
}

TEST_F(HostileFiles, ThinPictures) {
  write_ball("ball.xml", "<bsdf type='diffuse'/>");
  for (const char* size : {"1x1", "20000x16"})
    EXPECT_EQ(run("render ball.xml -o a.exr -o a.png --spp 1 --size " + std::string(size)).exit_code, 0)
        << size;
}

}  // namespace
}  // namespace twopass
