// Form factors of the closed forms by `twopass form-factors`, for each method that can compute them.
#include "tests/truth/program_truth.h"

namespace twopass {
namespace {

const V3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);

class ProgramFormFactors : public test::ProgramTruth {
 protected:
  // F[from][to] of scene.* by a method.
  double factor(const std::string& scene, const std::string& method, std::size_t from = 0,
                std::size_t to = 1) const {
    const Outcome result = run("form-factors " + scene + " --json --quiet --method " + method);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    if (result.exit_code != 0) return -1.0;
    return nlohmann::json::parse(result.out)["F"][from][to].get<double>();
  }
};

struct Pair {
  const char* name;
  V3d p, a, b, q, c, d;  // two parallelograms
  double truth;
  bool is_far;  // elements of a tenth are small enough for methods that look from single points
};

TEST_F(ProgramFormFactors, UnitSquares) {
  const auto leaning = [](double degrees) {
    return V3d(std::cos(degrees * M_PI / 180), 0, std::sin(degrees * M_PI / 180));
  };
  const V3d o(0.0);
  const Pair pairs[] = {{"parallel, distance .01", o, x, y, z * .01, y, x, .98041660292597327, false},
                        {"parallel, distance .1", o, x, y, z * .1, y, x, .82699452239725658, false},
                        {"parallel, distance .5", o, x, y, z * .5, y, x, .41525328357714674, true},
                        {"parallel, distance 1", o, x, y, z, y, x, .19982489569838738, true},
                        {"parallel, distance 2", o, x, y, z * 2, y, x, .068589588818552448, true},
                        {"parallel, distance 5", o, x, y, z * 5, y, x, .012403977313245102, true},
                        {"parallel, distance 10", o, x, y, z * 10, y, x, .0031620568387576016, true},
                        {"parallel, distance 100", o, x, y, z * 100, y, x, 3.1828866732829196e-5, true},
                        {"parallel, distance 1, offset 1", o, x, y, z + x, y, x, .086050489152327335, true},
                        {"perpendicular, common edge", o, x, y, o, y, z, .20004377607540315, false},
                        {"perpendicular, gap 1", x, x, y, o, y, z, .032808826719958734, true},
                        {"perpendicular, common vertex", o, x, y, y, y, z, .040592230101558543, false},
                        {"common edge, 10 degrees", o, x, y, o, y, leaning(10), .849606124962847171, false},
                        {"common edge, 30 degrees", o, x, y, o, y, leaning(30), .619028323090803253, false},
                        {"common edge, 60 degrees", o, x, y, o, y, leaning(60), .370905321150051436, false}};
  for (const Pair& pair : pairs)
    for (const std::string method : {"exact", "rays", "point", "hemicube"}) {
      const bool by_points = method == "point" || method == "hemicube";
      // A hemicube of 64 pixels sees squares at a distance of 5 as a few of them.
      if (by_points && (!pair.is_far || (method == "hemicube" && pair.truth < 0.02))) continue;
      const int n = by_points ? 10 : 1;
      write("a.obj", "g a\n" + quad(pair.p, pair.a, pair.b, n) + "g b\n" + quad(pair.q, pair.c, pair.d, n));
      // Corners are rounded to floats, which a gap of .01 shows; hemicubes have pixels.
      const double tolerance = method == "hemicube" ? 0.03
                               : method == "point"  ? 0.01
                               : pair.truth > 0.9   ? 2e-6
                                                    : 1e-6;
      record(std::string("F, unit squares ") + pair.name + ": " + method, pair.truth,
             {factor("a.obj", method == "rays" ? "rays --rays 10000" : method)}, tolerance * pair.truth);
    }
}

TEST_F(ProgramFormFactors, Tetrahedron) {
  write("t.obj",
        "v 1 1 1\nv 1 -1 -1\nv -1 1 -1\nv -1 -1 1\ng a\nf 1 3 2\ng b\nf 1 2 4\ng c\nf 1 4 3\ng d\nf 2 3 4\n");
  for (const std::string method : {"exact", "rays --rays 10000"})
    record("F, faces of a regular tetrahedron: " + method, 1.0 / 3.0, {factor("t.obj", method)});
}

// A patch of a thousandth stands for a point.
TEST_F(ProgramFormFactors, PointToSquare) {
  const struct {
    const char* name;
    V3d at, p, a, b;
    double truth;
  } cases[] = {{"point under a corner of a parallel unit square", V3d(0.0), z, y, x, .138531605994893},
               {"point under its centre", V3d(.5, .5, 0), z, y, x, .23945647046077354},
               {"centre of a cube's floor to a wall", V3d(.5, .5, 0), V3d(0.0), y, z, .19013588238480662},
               {"point at distance 1 below the corner of a perpendicular square", V3d(1, 0, 0), V3d(0.0), y, z,
                .055734197002553502}};
  for (const auto& c : cases)
    for (const std::string method : {"exact"}) {
      write("p.obj",
            "g point\n" + quad(c.at - (x + y) * 5e-4, x * 1e-3, y * 1e-3) + "g square\n" + quad(c.p, c.a, c.b));
      record(std::string("F, ") + c.name + ": " + method, c.truth, {factor("p.obj", method)}, 2e-4 * c.truth);
    }
}

// Curved shapes, by rays alone. Disks face each other.
TEST_F(ProgramFormFactors, DisksAndSpheres) {
  const auto disk = [](const std::string& id, double radius, double height, bool down) {
    return "<shape type='disk' id='" + id + "'><boolean name='flip_normals' value='" +
           (down ? "true" : "false") + "'/><transform name='to_world'><scale value='" + number(radius) +
           "'/><translate z='" + number(height) + "'/></transform></shape>";
  };
  const auto sphere = [](const std::string& id, double radius, bool inward, double height = 0.0) {
    return "<shape type='sphere' id='" + id + "'><float name='radius' value='" + number(radius) +
           "'/><point name='center' x='0' y='0' z='" + number(height) +
           "'/><boolean name='flip_normals' value='" + (inward ? "true" : "false") + "'/></shape>";
  };
  const auto scene = [&](const std::string& shapes) {
    write("s.xml", "<scene version='3.0.0'>" + shapes + "</scene>");
  };
  const std::string rays = "rays --rays 300000";
  // A share of that many rays; by low discrepancy better than that.
  const auto by_rays = [&](double truth, std::size_t from = 0, std::size_t to = 1) {
    return test::Measured{factor("s.xml", rays, from, to), std::sqrt(truth * (1 - truth) / 3e5)};
  };
  for (const auto& [r1, r2, h, truth] : {std::array{1.0, 1.0, 1.0, .3819660112501051518},
                                         {1.0, 2.0, 1.0, .76393202250021030359},
                                         {1.0, 0.5, 2.0, .048058983988962156}}) {
    scene(disk("a", r1, 0, false) + disk("b", r2, h, true));
    record("F, coaxial disks " + number(r1) + ", " + number(r2) + ", distance " + number(h) + ": rays", truth,
           by_rays(truth));
  }
  scene(disk("a", 1e-3, 0, false) + disk("b", 1, 1, true));
  record("F, element to a coaxial disk, r = h: rays", 0.5, by_rays(0.5));
  scene(disk("a", 1e-3, 0, false) + sphere("b", 1, false, 2));
  record("F, element to a sphere, R = 1 at distance 2: rays", 0.25, by_rays(0.25));
  scene(sphere("inner", 0.5, false) + sphere("outer", 1, true));
  record("F12, concentric spheres .5 in 1: rays", 1.0, {factor("s.xml", rays, 0, 1)});
  record("F21, concentric spheres: rays", 0.25, by_rays(0.25, 1, 0));
  record("F22, concentric spheres: rays", 0.75, by_rays(0.75, 1, 1));
}

}  // namespace
}  // namespace twopass
