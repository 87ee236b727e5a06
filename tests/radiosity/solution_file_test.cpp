#include "radiosity/solution_file.h"

#include <cstring>

#include <gtest/gtest.h>
#include <zlib.h>

#include "radiosity/display_mesh.h"
#include "radiosity/mesh_files.h"
#include "radiosity/scene_fingerprint.h"
#include "radiosity/subdivision.h"
#include "tests/image/files.h"
#include "tests/radiosity/test_scenes.h"
#include "tests/radiosity/walls.h"

namespace twopass {
namespace {

using SolutionFile = FileTest;

RadiosityOptions few_elements(std::size_t elements) {
  RadiosityOptions options;
  options.max_elements = elements;
  options.rays_per_element = 16;
  return options;
}

// Random values on a mesh, with every field of the statistics set.
Solution invented_solution(ElementMesh mesh) {
  std::vector<Irradiance> irradiance;
  for (std::uint32_t i = 0; i < mesh.count(); ++i) {
    Sampler sampler(11, i, 0);
    const V2f a = sampler.next_2d(), b = sampler.next_2d(), c = sampler.next_2d();
    irradiance.push_back({C3f(a.x, a.y, b.x), C3f(b.y, c.x, c.y)});
  }
  RadiosityStats stats;
  stats.solver = "gauss-seidel";
  stats.form_factors = "rays";
  stats.elements = mesh.count();
  stats.links = 2;
  stats.iterations = 3;
  stats.rays = 4;
  stats.residual = 0.1;
  stats.error_bound = std::numeric_limits<double>::infinity();
  stats.closure_error = 1.0 / 3.0;
  stats.closed = true;
  stats.max_reflections = 7;
  stats.memory_bytes = 8;
  stats.notes = {"one note", "", "another"};
  return Solution(std::move(mesh), std::move(irradiance), std::move(stats));
}

void expect_equal(const Solution& a, const Solution& b) {
  ASSERT_EQ(a.mesh().count(), b.mesh().count());
  ASSERT_EQ(a.mesh().cluster_count(), b.mesh().cluster_count());
  for (std::uint32_t i = 0; i < a.mesh().count(); ++i) {
    EXPECT_EQ(a.mesh().area(i), b.mesh().area(i));
    EXPECT_EQ(a.irradiances()[i].direct, b.irradiances()[i].direct);
    EXPECT_EQ(a.irradiances()[i].indirect, b.irradiances()[i].indirect);
    ASSERT_EQ(a.mesh().patch_count(i), b.mesh().patch_count(i));
    for (std::size_t k = 0; k < a.mesh().patch_count(i); ++k)
      EXPECT_EQ(a.mesh().patch(i, k).corner, b.mesh().patch(i, k).corner);
  }
  const RadiosityStats &s = a.stats(), &t = b.stats();
  EXPECT_EQ(s.solver, t.solver);
  EXPECT_EQ(s.form_factors, t.form_factors);
  EXPECT_EQ(std::tuple(s.elements, s.links, s.iterations, s.rays, s.memory_bytes),
            std::tuple(t.elements, t.links, t.iterations, t.rays, t.memory_bytes));
  EXPECT_EQ(std::tuple(s.residual, s.error_bound, s.closure_error, s.closed, s.max_reflections),
            std::tuple(t.residual, t.error_bound, t.closure_error, t.closed, t.max_reflections));
  EXPECT_EQ(s.notes, t.notes);
}

Scene wall_and_ball() {
  SceneDescription scene;
  test::add_diffuse(scene, "ball", Sphere{V3f(0.5f, 0.5f, 1.0f), 0.25f, false}, C3f(0.5f));
  test::add_diffuse(scene, "wall", test::wall(test::even_cuts(12), 0.3f), C3f(0.5f));
  scene.materials.back() = two_sided("wall", Diffuse{C3f(0.5f)}, Diffuse{C3f(0.25f)});
  return Scene(std::move(scene));
}

TEST_F(SolutionFile, ComesBackBitForBit) {
  const Scene scene = wall_and_ball();
  for (const int splits : {0, 3}) {
    ElementMesh mesh = test::split_at_random(divide_surfaces(scene, 300), splits, 0.3f);
    ASSERT_GT(mesh.cluster_count(), 10u);
    ASSERT_GT(mesh.count() - mesh.cluster_count(), 10u);
    mesh.expose(std::vector<float>(mesh.count(), 0.7));
    const Solution solution = invented_solution(std::move(mesh));
    save_solution(file("a.radiosity"), scene, solution);
    const Solution loaded = load_solution(file("a.radiosity"), scene);
    expect_equal(solution, loaded);
    save_solution(file("b.radiosity"), scene, loaded);
    EXPECT_EQ(content_of(file("a.radiosity")), content_of(file("b.radiosity")));
    // The quad-trees are the same: points are found in the same elements.
    for (std::uint32_t k = 0; k < 500; ++k) {
      const V2f u = Sampler(2, k, 0).next_2d();
      const Ray ray{V3f(u.x, u.y, 2.0f), V3f(0, 0, -1)};
      const SurfacePoint point = scene.surface_point(ray, scene.caster().intersect(ray));
      EXPECT_EQ(solution.mesh().find(point), loaded.mesh().find(point));
      EXPECT_EQ(solution.smooth_irradiance(point).direct, loaded.smooth_irradiance(point).direct);
    }
  }
}

TEST_F(SolutionFile, LightGroupsComeBackWithTheirNames) {
  const Scene scene = wall_and_ball();
  const Solution solution = invented_solution(divide_surfaces(scene, 100));
  const std::size_t count = solution.mesh().count();
  GroupedIrradiance groups{{"key", "sky"}, {2, std::vector<Irradiance>(count, {C3f(1, 2, 3), C3f(4, 5, 6)})}};
  groups.by_group[1][count - 1].direct = C3f(7, 8, 9);
  save_solution(file("a.radiosity"), scene, solution, {}, groups);
  GroupedIrradiance loaded;
  expect_equal(solution, load_solution(file("a.radiosity"), scene, &loaded));
  EXPECT_EQ(loaded.names, groups.names);
  ASSERT_EQ(loaded.by_group.size(), 2u);
  for (std::size_t g = 0; g < 2; ++g) {
    ASSERT_EQ(loaded.by_group[g].size(), count);
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(loaded.by_group[g][i].direct, groups.by_group[g][i].direct);
      EXPECT_EQ(loaded.by_group[g][i].indirect, groups.by_group[g][i].indirect);
    }
  }
  save_solution(file("a.radiosity"), scene, solution);
  load_solution(file("a.radiosity"), scene, &loaded);
  EXPECT_TRUE(loaded.empty());
}

TEST_F(SolutionFile, ScenesWithoutElementsAreNoTrouble) {
  const Scene empty{SceneDescription{}};
  save_solution(file("a.radiosity"), empty, solve_radiosity(empty));
  EXPECT_EQ(load_solution(file("a.radiosity"), empty).mesh().count(), 0u);
}

// Of every kind of triangle and of no more than needed.
Scene small_wall() {
  SceneDescription scene;
  test::add_diffuse(scene, "wall", test::wall(test::even_cuts(2), 0.0f), C3f(0.5f));
  return Scene(std::move(scene));
}

// A file of every kind of content, as small as possible.
std::vector<std::byte> small_file(const Scene& scene) {
  const std::uint16_t divisions[] = {0, 0, 1, 3};
  const ElementMesh mesh = test::split_at_random(test::mesh_of_divisions(scene, divisions, 2), 1, 0.3f);
  const GroupedIrradiance group{{"lamp"}, {std::vector<Irradiance>(mesh.count())}};
  return solution_to_bytes(scene, invented_solution(mesh), {}, group);
}

constexpr std::byte flips[] = {std::byte{0x01}, std::byte{0x80}, std::byte{0xff}};

TEST(SolutionBytes, AnyFlippedByteIsAnError) {
  const Scene scene = small_wall();
  const std::vector<std::byte> good = small_file(scene);
  ASSERT_LT(good.size(), 4000u);
  for (std::size_t k = 0; k < good.size(); ++k)
    for (const std::byte flip : flips) {
      std::vector<std::byte> bad = good;
      bad[k] ^= flip;
      EXPECT_THROW((void)solution_from_bytes(bad, scene, "a"), Error) << k;
    }
}

TEST(SolutionBytes, AnyMissingEndIsAnErrorAndSoIsMore) {
  const Scene scene = small_wall();
  std::vector<std::byte> bytes = small_file(scene);
  for (std::size_t k = 0; k < bytes.size(); ++k)
    EXPECT_THROW((void)solution_from_bytes(std::span(bytes).first(k), scene, "a"), Error) << k;
  bytes.push_back(std::byte{0});
  EXPECT_THROW((void)solution_from_bytes(bytes, scene, "a"), Error);
}

// Forged: the checksum is right again, so that the numbers themselves have to be looked at. No crash, no giant
// allocation; whether it is an error depends on the number.
TEST(SolutionBytes, NumbersThatMakeNoSenseAreNoTrouble) {
  const Scene scene = small_wall();
  const std::vector<std::byte> good = small_file(scene);
  int errors = 0, tried = 0;
  for (std::size_t k = 48; k + 4 < good.size(); ++k)
    for (const std::byte flip : flips) {
      std::vector<std::byte> bad = good;
      bad[k] ^= flip;
      const auto crc =
          static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bad.data()), bad.size() - 4));
      std::memcpy(bad.data() + bad.size() - 4, &crc, 4);
      ++tried;
      try {
        const Solution solution = solution_from_bytes(bad, scene, "a");
        EXPECT_EQ(solution.mesh().count(), solution.irradiances().size());
        for (std::uint32_t i = 0; i < 20; ++i) {
          const V2f u = Sampler(2, i, 0).next_2d();
          const Ray ray{V3f(u.x, u.y, 2.0f), V3f(0, 0, -1)};
          const SurfacePoint point = scene.surface_point(ray, scene.caster().intersect(ray));
          EXPECT_FALSE(std::isnan(solution.smooth_irradiance(point).total().x));
        }
      } catch (const Error&) {
        ++errors;
      }
    }
  EXPECT_GT(errors, 100);
  EXPECT_LT(errors, tried);
}

TEST_F(SolutionFile, ErrorsSayWhatIsWrong) {
  const Scene scene(test::lit_cube(0.5f)), darker(test::lit_cube(0.4f));
  save_solution(file("a.radiosity"), scene, solve_radiosity(scene, few_elements(50)));
  const std::string good = content_of(file("a.radiosity"));
  const auto error_with = [&](const std::string& content, const Scene& of) {
    put(file("b.radiosity"), content);
    const std::string error = error_of([&] { (void)load_solution(file("b.radiosity"), of); });
    EXPECT_TRUE(error.starts_with(file("b.radiosity").string() + ": ")) << error;
    EXPECT_TRUE(contains(error, "; ")) << error;
    return error;
  };
  EXPECT_TRUE(contains(error_with(good, darker), "belongs to another scene"));
  EXPECT_TRUE(contains(error_with(good.substr(0, good.size() - 5), scene), "incomplete"));
  EXPECT_TRUE(contains(error_with("ply\nformat ascii 1.0\n", scene), "not a radiosity solution"));
  EXPECT_TRUE(contains(error_with("", scene), "not a radiosity solution"));
  std::string other = good;
  other[12] = 100;
  EXPECT_TRUE(contains(error_with(other, scene), "newer version"));
  other[12] = 1;
  EXPECT_TRUE(contains(error_with(other, scene), "older version"));
  std::string damaged = good;
  damaged[good.size() / 2] = static_cast<char>(~damaged[good.size() / 2]);
  EXPECT_TRUE(contains(error_with(damaged, scene), "damaged"));
  EXPECT_TRUE(
      contains(error_of([&] { (void)load_solution(file("none.radiosity"), scene); }), "there is no such file"));
  EXPECT_TRUE(contains(error_of([&] { (void)load_solution(folder(), scene); }), "this is a folder"));
}

// What there is to be seen is in the file, for whoever has not the scene.
TEST_F(SolutionFile, HoldsItsDisplay) {
  const Scene scene(test::lit_cube(0.5f));
  const Solution solution = solve_radiosity(scene, few_elements(50));
  save_solution(file("a.radiosity"), scene, solution);
  EXPECT_EQ(display_of_solution(file("a.radiosity")), glb_of(display_mesh(scene, solution), scene, "a"));
  put(file("b.radiosity"), content_of(file("a.radiosity")).substr(0, 2000));
  EXPECT_THROW((void)display_of_solution(file("b.radiosity")), Error);
}

TEST_F(SolutionFile, AFailedWriteLeavesTheOldFileAlone) {
  const Scene scene = small_wall();
  put(file("a.radiosity"), "old");
  const Solution solution = invented_solution(divide_surfaces(scene, 10));
  EXPECT_THROW(save_solution(folder() / "nowhere" / "a.radiosity", scene, solution), Error);
  save_solution(file("a.radiosity"), scene, solution);
  EXPECT_EQ(files_in_folder(), 1u);
  EXPECT_EQ(load_solution(file("a.radiosity"), scene).mesh().count(), solution.mesh().count());
}

// Replaces the model of a uniform side by a changed one.
template <class Model, class Change>
void change(MaterialSide& side, Change change_model) {
  Model model = std::get<Model>(side.uniform());
  change_model(model);
  side = model;
}

// Every number that a solution depends on changes the fingerprint; names, camera and the order of materials do
// not.
TEST(SceneFingerprint, ChangesWithWhatMattersOnly) {
  SceneDescription original = test::lit_cube(0.5f);
  original.materials.push_back(one_sided("mirror", Conductor{}));
  original.shapes[2].material = static_cast<std::uint32_t>(original.materials.size() - 1);
  original.materials.push_back(interface_material("glass", Dielectric{}));
  original.shapes.push_back({"ball", Sphere{V3f(0.5f), 0.2f, false}, 7, {}});
  const auto print = [](const SceneDescription& scene) { return scene_fingerprint(Scene(scene)); };
  const std::uint64_t expected = print(original);
  const auto changed = [&](auto change) {
    SceneDescription scene = original;
    change(scene);
    return print(scene) != expected;
  };
  EXPECT_FALSE(changed([](SceneDescription&) {}));
  EXPECT_FALSE(changed([](SceneDescription& s) { s.shapes[0].name = s.materials[0].name = "other"; }));
  EXPECT_FALSE(changed([](SceneDescription& s) { s.camera.emplace().fov_degrees = 12.0; }));
  EXPECT_FALSE(changed([](SceneDescription& s) {
    std::swap(s.materials[0], s.materials[1]);
    std::swap(s.shapes[0].material, s.shapes[1].material);
  }));
  EXPECT_TRUE(changed([](SceneDescription& s) { s.environment = Environment(C3f(0, 0, 1e-30f)); }));
  EXPECT_TRUE(changed([](SceneDescription& s) { s.punctual_lights.push_back(PointLight{}); }));
  EXPECT_TRUE(changed([](SceneDescription& s) { s.shapes[0].radiance[back].y = 1.0f; }));
  EXPECT_TRUE(
      changed([](SceneDescription& s) { std::get<Mesh>(s.shapes[3].geometry).positions[1].z += 1e-3f; }));
  EXPECT_TRUE(changed([](SceneDescription& s) {
    std::swap(std::get<Mesh>(s.shapes[3].geometry).triangles[0].x,
              std::get<Mesh>(s.shapes[3].geometry).triangles[0].y);
  }));
  EXPECT_TRUE(changed([](SceneDescription& s) { std::swap(s.shapes[0], s.shapes[1]); }));
  EXPECT_TRUE(changed([](SceneDescription& s) { s.shapes.pop_back(); }));
  EXPECT_TRUE(changed([](SceneDescription& s) {
    change<Diffuse>(s.materials[0].side[front], [](Diffuse& m) { m.reflectance.x = 0.6f; });
  }));
  EXPECT_TRUE(changed([](SceneDescription& s) {
    change<Diffuse>(s.materials[0].side[back], [](Diffuse& m) { m.reflectance.x = 0.6f; });
  }));
  EXPECT_TRUE(changed([](SceneDescription& s) {
    change<Conductor>(s.materials[6].side[front], [](Conductor& m) { m.k.z = 0.6f; });
  }));
  EXPECT_TRUE(changed([](SceneDescription& s) {
    change<Conductor>(s.materials[6].side[front], [](Conductor& m) { m.eta.x = 0.6f; });
  }));
  EXPECT_TRUE(changed([](SceneDescription& s) {
    change<Dielectric>(s.materials[7].side[front], [](Dielectric& m) { m.eta = 1.6f; });
  }));
  EXPECT_TRUE(changed([](SceneDescription& s) { std::get<Sphere>(s.shapes[6].geometry).radius = 0.3f; }));
  EXPECT_TRUE(changed([](SceneDescription& s) { std::get<Sphere>(s.shapes[6].geometry).inward = true; }));

  // Everything about the other shapes, and what is stored with meshes.
  const std::array<C3f, 2> dark{C3f(0.0f), C3f(0.0f)};
  const std::array<C3f, 3> black{C3f(0.0f), C3f(0.0f), C3f(0.0f)};
  original.shapes.push_back({"disk", Disk{}, 0, dark});
  original.shapes.push_back({"cylinder", Cylinder{}, 0, dark});
  original.shapes.push_back(
      {"copy",
       MeshInstance{std::make_shared<const Mesh>(test::quad(V3f(0.0f), V3f(1, 0, 0), V3f(0, 1, 0))), {}}, 0,
       dark});
  MeshColors colors{"vertex_color",
                    std::make_shared<const MeshColors::Values>(MeshColors::Values{{black, black}, C3f(0.0f)}),
                    {}};
  original.materials.push_back(
      one_sided("coloured", MaterialSide(std::make_shared<const MaterialNode>(
                                MaterialNode{TexturedModel{Diffuse{}, {{0, Texture(colors)}}}}))));
  original.shapes[0].material = 8;
  const std::uint64_t with_more = print(original);
  const auto changes = [&](auto change) {
    SceneDescription scene = original;
    change(scene.shapes[7 + 0].geometry, scene.shapes[8].geometry, scene.shapes[9].geometry);
    return print(scene) != with_more;
  };
  using G = Geometry;
  EXPECT_FALSE(changes([](G&, G&, G&) {}));
  EXPECT_TRUE(changes([](G& d, G&, G&) { std::get<Disk>(d).center.x = 1; }));
  EXPECT_TRUE(changes([](G& d, G&, G&) { std::get<Disk>(d).x.y = 1; }));
  EXPECT_TRUE(changes([](G& d, G&, G&) { std::get<Disk>(d).y.z = 1; }));
  EXPECT_TRUE(changes([](G& d, G&, G&) { std::get<Disk>(d).reversed = true; }));
  EXPECT_TRUE(changes([](G&, G& c, G&) { std::get<Cylinder>(c).base.x = 1; }));
  EXPECT_TRUE(changes([](G&, G& c, G&) { std::get<Cylinder>(c).radius = 2; }));
  EXPECT_TRUE(changes([](G&, G& c, G&) { std::get<Cylinder>(c).length = 2; }));
  EXPECT_TRUE(changes([](G&, G& c, G&) { std::get<Cylinder>(c).inward = true; }));
  EXPECT_TRUE(changes([](G&, G& c, G&) { std::get<Cylinder>(c).axes[1].y = -1; }));
  EXPECT_TRUE(changes([](G&, G&, G& i) { std::get<MeshInstance>(i).to_world.origin.x = 1; }));
  EXPECT_TRUE(changes([](G&, G&, G& i) { std::get<MeshInstance>(i).to_world.z.z = 2; }));
  EXPECT_TRUE(changes([](G&, G&, G& i) {
    std::get<MeshInstance>(i).mesh =
        std::make_shared<const Mesh>(test::quad(V3f(0.0f), V3f(1, 0, 0), V3f(0, 1, 1e-3f)));
  }));
  colors.values = std::make_shared<const MeshColors::Values>(
      MeshColors::Values{{black, {C3f(0, 1, 0), C3f(0.0f), C3f(0.0f)}}, C3f(0.0f)});
  original.materials[8] = with_textures(original.materials[8], [&](const Texture&) { return Texture(colors); });
  EXPECT_NE(print(original), with_more);
}

}  // namespace
}  // namespace twopass
