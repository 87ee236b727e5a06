// Radiosities of cubes, plates, spheres and a mirrored room by `twopass render`, for every solver, form factor
// method and integrator.
#include "tests/truth/program_truth.h"

namespace twopass {
namespace {

const V3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), o(0.0);

class ProgramRadiosity : public test::ProgramTruth {
 protected:
  // The unit cube; its ceiling has an exitance of 1.
  static std::vector<Surface> cube(double reflectance, double of_ceiling) {
    return {{"floor", quad(o, x, y), reflectance}, {"ceiling", quad(z, y, x), of_ceiling, 1 / M_PI},
            {"left", quad(o, y, z), reflectance},  {"right", quad(x, z, y), reflectance},
            {"near", quad(o, z, x), reflectance},  {"far", quad(y, x, z), reflectance}};
  }
  struct Face {
    const char* name;
    V3d centre, normal, up;
    double truth;
  };
  // By every integrator; those that read a solution share one, which is found once for all faces.
  void expect_faces(const std::string& what, const std::vector<Surface>& scene,
                    const std::vector<Face>& faces) const {
    write_scene(scene, "", "");
    const Outcome solved = run("solve scene.xml -o s.radiosity --quiet --elements 400");
    ASSERT_EQ(solved.exit_code, 0) << solved.err;
    for (const Face& face : faces) {
      write_scene(scene, "", flat_camera(face.centre, face.normal, face.up, 1.0 / 16, 16));
      for (const std::string way : {"path", "unbiased", "twopass", "radiosity"})
        record(what + ", mean B of " + face.name + ": " + way, face.truth,
               mean(way + (way == "path" ? "" : " --solution s.radiosity"), 16, 64) * M_PI,
               way == "twopass" || way == "radiosity" ? 0.005 * face.truth : 0.0);
    }
  }
  // Of a solution, which is found once for all faces.
  void expect_solution(const std::string& what, const std::vector<Surface>& scene,
                       const std::vector<Face>& faces, const std::string& way, double bias) const {
    write_scene(scene, "", "");
    const Outcome solved = run("solve scene.xml -o s.radiosity --quiet --subdivision uniform " + way);
    ASSERT_EQ(solved.exit_code, 0) << solved.err;
    for (const Face& face : faces) {
      write_scene(scene, "", flat_camera(face.centre, face.normal, face.up, 1.0 / 16, 16));
      record(what + ", mean B of " + face.name + ": " + way, face.truth,
             mean("radiosity --solution s.radiosity", 16, 16) * M_PI, bias * face.truth);
    }
  }
};

TEST_F(ProgramRadiosity, CubeByEveryWay) {
  const std::vector<Face> faces{{"the floor", {.5, .5, 0}, z, y, .171216},
                                {"a wall", {0, .5, .5}, x, z, .181105},
                                {"the ceiling", {.5, .5, 1}, -z, y, 1.104362}};
  expect_faces("cube, rho = .5", cube(0.5, 0.5), faces);
  for (const char* solver : {"lu", "jacobi", "gauss-seidel", "progressive", "cg", "hierarchical", "stochastic"})
    expect_solution("cube, rho = .5", cube(0.5, 0.5), faces,
                    "--elements 400 --radiosity-error 0.002 --solver " + std::string(solver), 0.005);
  for (const char* method : {"exact", "point", "hemicube", "rays"})
    expect_solution("cube, rho = .5", cube(0.5, 0.5), faces,
                    "--elements 400 --form-factors " + std::string(method), 0.005);
}

TEST_F(ProgramRadiosity, CubesOfOtherReflectances) {
  expect_faces("cube, rho = .5 but for a black ceiling", cube(0.5, 0.0),
               {{"the floor", {.5, .5, 0}, z, y, .155175}, {"a wall", {0, .5, .5}, x, z, .163992}});
  expect_faces("cube, rho = .8", cube(0.8, 0.8),
               {{"the floor", {.5, .5, 0}, z, y, .66098},
                {"a wall", {0, .5, .5}, x, z, .68788},
                {"the ceiling", {.5, .5, 1}, -z, y, 1.58751}});
}

TEST_F(ProgramRadiosity, IrradianceInTheMiddleOfTheCubesFaces) {
  for (const auto& [rho, floor, wall, ceiling] :
       {std::array{.5, .39521, .35530, .18361}, {.8, .89135, .85458, .69033}})
    for (const Face& face : {Face{"floor", {.5, .5, 0}, z, y, floor}, Face{"wall", {0, .5, .5}, x, z, wall},
                             Face{"ceiling (indirect)", {.5, .5, 1}, -z, y, ceiling}}) {
      write_scene(cube(rho, rho), "", flat_camera(face.centre, face.normal, face.up, 0.01, 1));
      const double emitted = face.normal.z < 0 ? 1.0 : 0.0;
      // Near a point elements show: as many as the program takes by itself.
      for (const std::string way : {"path", "unbiased --elements 400", "twopass"})
        record("cube, rho = " + number(rho) + ", H in the middle of the " + face.name + ": " + way, face.truth,
               (mean(way, 1, 16384) * M_PI - emitted) * (1.0 / rho),
               way == "twopass" ? 0.01 * face.truth : 0.0);
    }
}

TEST_F(ProgramRadiosity, Plates) {
  const std::vector<Surface> plates{{"lower", quad(o, x, y), .5, 1 / M_PI}, {"upper", quad(z, y, x), .5}};
  expect_faces("plates at distance 1", plates,
               {{"the lower", {.5, .5, 0}, z, y, 1.0102181}, {"the upper", {.5, .5, 1}, -z, y, .1009472}});
}

TEST_F(ProgramRadiosity, PlaneMirrorDoublesTheRoom) {
  std::vector<Surface> room = cube(0.5, 0.5);
  room[2].bsdf = "<bsdf type='conductor'/>";
  expect_faces("cube with a mirror", room,
               {{"the floor", {.5, .5, 0}, z, y, .230122},
                {"the ceiling", {.5, .5, 1}, -z, y, 1.12036},
                {"the end wall", {1, .5, .5}, -x, z, .212382},
                {"a side wall", {.5, 0, .5}, y, z, .218567}});
  write_scene(room, "", flat_camera({.5, .5, 0}, z, y, 0.01, 1));
  for (const std::string way : {"path", "unbiased", "twopass"})
    record("cube with a mirror, H in the middle of the floor: " + way, .50656,
           mean(way + " --elements 400", 1, 16384) * (M_PI / 0.5), way == "twopass" ? 0.01 * .50656 : 0.0);
}

TEST_F(ProgramRadiosity, Spheres) {
  const auto sphere = [](double radius, bool inward, double reflectance, double radiance) {
    return "<shape type='sphere'><float name='radius' value='" + number(radius) +
           "'/><boolean name='flip_normals' value='" + (inward ? "true" : "false") +
           "'/><bsdf type='diffuse'><rgb name='reflectance' value='" + number(reflectance) + "'/></bsdf>" +
           (radiance > 0
                ? "<emitter type='area'><rgb name='radiance' value='" + number(radiance) + "'/></emitter>"
                : "") +
           "</shape>";
  };
  const auto camera = [](const V3d& from, const V3d& to) {
    return "<sensor type='perspective'><float name='fov' value='20'/><transform name='to_world'><lookat "
           "origin='" +
           point(from) + "' target='" + point(to) + "' up='0,0,1'/></transform></sensor>";
  };
  for (const std::string way : {"path", "unbiased", "twopass", "radiosity"}) {
    // Spheres become polyhedra for the solution.
    const double bias = way == "twopass" || way == "radiosity" ? 0.01 : 0.0;
    const auto expect = [&](const std::string& name, double truth) {
      record(name + ": " + way, truth, mean(way + " --elements 400", 8, 64) * M_PI, bias * truth);
    };
    write_scene({}, sphere(1, true, .8, 1 / M_PI), camera({.2, .3, .1}, {0, 1, 0}));
    expect("inside of a sphere, E = 1, rho = .8, B", 5.0);
    const std::string two = sphere(.5, false, .5, 1 / M_PI) + sphere(1, true, .5, 0);
    write_scene({}, two, camera({0, -.9, 0}, {0, 0, 0}));
    expect("concentric spheres, B of the inner", 10.0 / 9.0);
    write_scene({}, two, camera({0, .6, 0}, {0, 1, 0}));
    expect("concentric spheres, B of the outer", 2.0 / 9.0);
  }
}

TEST_F(ProgramRadiosity, Furnace) {
  std::vector<Surface> room = cube(0.6, 0.6);
  for (Surface& s : room) s.radiance = 0.4;
  const std::string objects =
      "<shape type='sphere'><point name='center' x='.3' y='.6' z='.3'/><float name='radius' value='.2'/>"
      "<bsdf type='dielectric'/></shape><shape type='sphere'><point name='center' x='.7' y='.6' z='.3'/>"
      "<float name='radius' value='.2'/><bsdf type='conductor'/></shape>";
  const std::string camera =
      "<sensor type='perspective'><float name='fov' value='80'/><transform name='to_world'>"
      "<lookat origin='.5,.05,.5' target='.5,1,.4' up='0,0,1'/></transform></sensor>";
  write_scene(room, objects, camera);
  for (const std::string way : {"path", "unbiased", "twopass", "radiosity"})
    record("furnace with mirror and glass, L: " + way, 1.0, mean(way + " --elements 400", 16, 16),
           way == "twopass" || way == "radiosity" ? 0.01 : 0.0);
  write_scene(room, "", camera);
  for (const int depth : {1, 2, 3, 5})
    record("furnace, paths of at most " + std::to_string(depth) + " edges: path", 1 - std::pow(0.6, depth),
           mean("path --max-depth " + std::to_string(depth), 16, 64));
}

}  // namespace
}  // namespace twopass
