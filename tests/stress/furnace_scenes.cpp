#include "tests/stress/furnace_scenes.h"

#include "materials/rough_conductor.h"
#include "materials/rough_dielectric.h"
#include "render/core/sampler.h"

namespace twopass::stress {

namespace {

constexpr V3f x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);

Mesh boxed(const V3f& lo, const V3f& hi) {
  SceneDescription scene;
  test::add_box(scene, "box", lo, hi, one_sided("box", Diffuse{}));
  return std::get<Mesh>(scene.shapes[0].geometry);
}

Mesh inside_out(Mesh mesh) {
  for (V3u& t : mesh.triangles) std::swap(t.y, t.z);
  return mesh;
}

// A room whose floor is cut as given.
SceneDescription room_without_floor(const C3f& albedo) {
  SceneDescription scene = test::unit_room(C3f(0.0f), C3f(0.0f), C3f(0.0f));
  SceneDescription result;
  result.environment = Environment(C3f(furnace_radiance));
  for (std::size_t i = 1; i < scene.shapes.size(); ++i)
    add_furnace(result, scene.shapes[i].name, scene.shapes[i].geometry, albedo);
  return result;
}

// `count` triangles anywhere in the unit cube; the last two thirds of them needles and specks.
Mesh soup(int count, std::uint32_t seed) {
  Mesh mesh;
  for (int k = 0; k < count; ++k) {
    Sampler sampler(seed, static_cast<std::uint32_t>(k), 0, SamplerKind::independent);
    const auto point = [&] {
      const V2f xy = sampler.next_2d();
      return V3f(xy.x, xy.y, sampler.next_1d());
    };
    const V3f a = point(), b = point(), c = point();
    const float size = k % 3 == 0 ? 1.0f : std::pow(10.0f, -6.0f * sampler.next_1d());
    const auto i = static_cast<std::uint32_t>(3 * k);
    mesh.positions.insert(mesh.positions.end(), {a, k % 3 == 1 ? b : a + (b - a) * size, a + (c - a) * size});
    mesh.triangles.emplace_back(i, i + 1, i + 2);
  }
  return mesh;
}

CameraDescription camera_at(const V3d& eye, const V3d& target) {
  CameraDescription camera;
  camera.to_world = look_at(eye, target, {0.1, 0.2, 1.0}, "camera");
  camera.fov_degrees = 100.0;
  return camera;
}

}  // namespace

Shape& add_furnace(SceneDescription& scene, const std::string& name, Geometry geometry, const C3f& albedo) {
  Shape& shape = test::add_diffuse(scene, name, std::move(geometry), albedo);
  const MaterialSide side = Diffuse{albedo};
  scene.materials.back() = two_sided(name, side, side);
  shape.radiance = {(C3f(1.0f) - albedo) * furnace_radiance, (C3f(1.0f) - albedo) * furnace_radiance};
  return shape;
}

Shape& add_lossless(SceneDescription& scene, const std::string& name, Geometry geometry,
                    const Material& material) {
  Shape& shape = test::add_diffuse(scene, name, std::move(geometry), C3f(0.0f));
  scene.materials.back() = material;
  return shape;
}

SceneDescription furnished_furnace(float above_floor) {
  SceneDescription scene = room_without_floor(C3f(0.5f, 0.6f, 0.4f));
  add_furnace(scene, "floor", test::quad(V3f(0.0f), x, y), C3f(0.7f));
  add_furnace(scene, "low", boxed(V3f(0.1f, 0.6f, above_floor), V3f(0.4f, 0.9f, 0.3f)), C3f(0.2f));
  add_furnace(scene, "tall", boxed(V3f(0.6f, 0.65f, above_floor), V3f(0.8f, 0.85f, 0.7f)), C3f(0.8f));
  add_furnace(scene, "ball", Sphere{V3f(0.25f, 0.75f, 0.5f), 0.15f, false}, C3f(0.6f));
  return scene;
}

SceneDescription triangle_soup(std::uint32_t seed) {
  SceneDescription scene;
  scene.environment = Environment(C3f(furnace_radiance));
  add_furnace(scene, "soup", soup(60, seed), C3f(0.4f, 0.5f, 0.6f));
  add_furnace(scene, "more soup", soup(60, seed + 10), C3f(0.9f));
  return scene;
}

FurnaceScene duplicate_faces() {
  FurnaceScene result{"duplicates", furnished_furnace()};
  const Mesh low = boxed(V3f(0.1f, 0.6f, 0.0f), V3f(0.4f, 0.9f, 0.3f));
  add_furnace(result.scene, "again", low, C3f(0.9f));
  add_furnace(result.scene, "and again", low, C3f(0.1f));
  add_furnace(result.scene, "inside out", inside_out(low), C3f(0.5f));
  return result;
}

std::vector<FurnaceScene> broken_geometry() {
  std::vector<FurnaceScene> all;
  // Without a reference to its elements: they move.
  const auto room = [&](const std::string& name, std::initializer_list<std::pair<Geometry, float>> more) {
    SceneDescription scene = furnished_furnace();
    for (const auto& [geometry, albedo] : more) add_furnace(scene, name, geometry, C3f(albedo));
    all.push_back({name, std::move(scene)});
  };
  room("sound", {});

  Mesh slivers, none;
  for (std::uint32_t k = 0; k < 60; k += 3) {
    const float at = 0.02f + 0.015f * static_cast<float>(k);
    slivers.positions.insert(slivers.positions.end(),
                             {V3f(0.05f, at, 0.35f), V3f(0.95f, at, 0.4f), V3f(0.95f, at + 1e-6f, 0.4f)});
    slivers.triangles.emplace_back(k, k + 1, k + 2);
  }
  room("slivers", {{slivers, 0.7f}});
  none.positions = {V3f(0.5f), V3f(0.5f), V3f(0.5f), V3f(0.25f), V3f(0.75f)};
  none.triangles = {{0, 1, 2}, {0, 0, 1}, {3, 0, 4}, {3, 3, 3}};
  room("triangles_without_area", {{none, 0.7f}});
  Mesh nothing;
  room("mesh_without_triangles", {{nothing, 0.3f}});
  const Mesh neighbour = boxed(V3f(0.4f, 0.6f, 0.0f), V3f(0.5f, 0.9f, 0.3f)),
             on_top = boxed(V3f(0.1f, 0.6f, 0.3f), V3f(0.3f, 0.8f, 0.35f));
  room("coincident_faces", {{neighbour, 0.9f}, {on_top, 0.3f}});
  room("interpenetrating", {{boxed(V3f(0.3f, 0.5f, -0.2f), V3f(0.7f, 0.8f, 0.5f)), 0.3f},
                            {Sphere{V3f(0.5f, 1.0f, 0.3f), 0.4f, false}, 0.8f},
                            {boxed(V3f(0.55f, 0.6f, 0.2f), V3f(1.3f, 0.7f, 0.6f)), 0.9f}});
  room("inside_out", {{inside_out(boxed(V3f(0.45f, 0.7f, 0.2f), V3f(0.55f, 0.8f, 0.4f))), 0.8f},
                      {Sphere{V3f(0.5f, 0.6f, 0.8f), 0.1f, true}, 0.4f}});

  // Edges in the middle of which other triangles' corners lie.
  SceneDescription t_junctions = room_without_floor(C3f(0.5f));
  Mesh floor;
  for (int k = 0; k < 7; ++k) {
    const float left = static_cast<float>(k) / 7.0f, right = static_cast<float>(k + 1) / 7.0f;
    const auto i = static_cast<std::uint32_t>(floor.positions.size());
    floor.positions.insert(floor.positions.end(), {V3f(left, 0, 0), V3f(right, 0, 0), V3f(0.3f, 0.4f, 0)});
    floor.triangles.emplace_back(i, i + 1, i + 2);
  }
  const auto base = static_cast<std::uint32_t>(floor.positions.size());
  floor.positions.insert(floor.positions.end(),
                         {V3f(0, 0, 0), V3f(1, 0, 0), V3f(1, 1, 0), V3f(0, 1, 0), V3f(0.3f, 0.4f, 0)});
  floor.triangles.emplace_back(base + 1, base + 2, base + 4);
  floor.triangles.emplace_back(base + 2, base + 3, base + 4);
  floor.triangles.emplace_back(base + 3, base, base + 4);
  add_furnace(t_junctions, "floor", floor, C3f(0.6f));
  all.push_back({"t_junctions", t_junctions});

  SceneDescription open = furnished_furnace();
  open.shapes.erase(open.shapes.begin(), open.shapes.begin() + 2);
  all.push_back({"open_meshes", open});

  SceneDescription gaps = room_without_floor(C3f(0.5f));
  add_furnace(gaps, "floor", test::quad(V3f(1e-7f, 1e-7f, 0.0f), x * (1.0f - 2e-7f), y * (1.0f - 2e-7f)),
              C3f(0.6f));
  const Mesh board = test::quad(V3f(0.1f, 0.6f, 0.1f), x * 0.8f, y * 0.3f);
  add_furnace(gaps, "board", board, C3f(0.9f));
  Mesh above = board, below = board;
  for (V3f& p : above.positions) p.z = std::nextafter(0.1f, 1.0f);
  for (V3f& p : below.positions) p.z = 0.1f - 1e-7f;
  add_furnace(gaps, "above", above, C3f(0.1f));
  add_furnace(gaps, "below", inside_out(below), C3f(0.5f));
  all.push_back({"gaps_of_1e_7", gaps});

  for (const std::uint32_t seed : {1u, 2u, 3u})
    all.push_back({"soup_" + std::to_string(seed), triangle_soup(seed)});

  SceneDescription huge;
  huge.environment = Environment(C3f(furnace_radiance));
  add_furnace(huge, "plain", test::quad(V3f(-5e5f, -5e5f, 0.0f), x * 1e6f, y * 1e6f), C3f(0.7f));
  add_furnace(huge, "box", boxed(V3f(-0.5f, 2.0f, 0.0f), V3f(0.5f, 3.0f, 1.0f)), C3f(0.3f));
  huge.camera = camera_at({0, 0, 1}, {0, 1, 0.8});
  all.push_back({"a_box_on_a_plain_of_a_million", huge});

  SceneDescription one;
  one.environment = Environment(C3f(furnace_radiance));
  Mesh triangle;
  triangle.positions = {V3f(0.0f), x, V3f(0.3f, 1.0f, 0.5f)};
  triangle.triangles = {{0, 1, 2}};
  add_furnace(one, "one", triangle, C3f(0.5f));
  one.camera = camera_at({0.4, 0.3, 2}, {0.4, 0.3, 0});
  all.push_back({"one_triangle", one});

  SceneDescription empty;
  empty.environment = Environment(C3f(furnace_radiance));
  all.push_back({"empty", empty});

  // Shading normals of zero length, and opposite ones: the true normal counts, on its own side.
  for (const bool is_zero : {true, false}) {
    SceneDescription scene = furnished_furnace();
    for (Shape& shape : scene.shapes) {
      auto* mesh = std::get_if<Mesh>(&shape.geometry);
      if (mesh == nullptr) continue;
      // Corners of their own for each triangle, so that each has its normal.
      Mesh split;
      for (const V3u& t : mesh->triangles) {
        const V3f p[3] = {mesh->positions[t.x], mesh->positions[t.y], mesh->positions[t.z]};
        const V3f normal = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
        const auto i = static_cast<std::uint32_t>(split.positions.size());
        split.positions.insert(split.positions.end(), {p[0], p[1], p[2]});
        split.normals.insert(split.normals.end(), 3, is_zero ? V3f(0.0f) : -normal);
        split.triangles.emplace_back(i, i + 1, i + 2);
      }
      *mesh = split;
    }
    all.push_back({is_zero ? "normals_of_length_zero" : "opposite_normals", scene});
  }

  // A thousand lamps, most of them tiny.
  SceneDescription lamps = furnished_furnace();
  for (int k = 0; k < 1000; ++k) {
    Sampler sampler(5, static_cast<std::uint32_t>(k), 0, SamplerKind::independent);
    const V2f xy = sampler.next_2d(), zs = sampler.next_2d();
    const float size = 0.02f * std::pow(10.0f, -3.0f * zs.y);
    add_furnace(lamps, "lamp", test::quad(V3f(xy.x, xy.y, zs.x) * 0.97f, x * size, z * size), C3f(0.0f));
  }
  all.push_back({"thousand_lamps", lamps});

  SceneDescription touching = furnished_furnace();
  add_furnace(touching, "in the wall", test::quad(V3f(0.2f, 1.0f, 0.2f), x * 0.3f, z * 0.3f), C3f(0.0f));
  add_furnace(touching, "on the floor", boxed(V3f(0.45f, 0.5f, 0.0f), V3f(0.55f, 0.6f, 0.1f)), C3f(0.0f));
  add_furnace(touching, "bulb", Sphere{V3f(0.5f, 0.5f, 0.95f), 0.05f, false}, C3f(0.0f));
  all.push_back({"lamps_that_touch_walls", touching});

  SceneDescription black;
  black.environment = Environment(C3f(furnace_radiance));
  for (const Shape& shape : furnished_furnace().shapes)
    add_furnace(black, shape.name, shape.geometry, C3f(0.0f));
  all.push_back({"everything_black", black});
  return all;
}

std::vector<FurnaceScene> misplaced_cameras() {
  const std::pair<const char*, CameraDescription> cameras[] = {
      {"inside_a_wall", camera_at({0.5, 1.0, 0.5}, {0.5, 2.0, 0.5})},
      {"in_a_wall_looking_along_it", camera_at({0.5, 1.0, 0.5}, {0.7, 1.0, 0.6})},
      {"on_the_floor", camera_at({0.5, 0.5, 0.0}, {0.5, 1.0, 0.0})},
      {"on_an_edge", camera_at({1.0, 0.5, 0.0}, {0.5, 0.7, 0.3})},
      {"in_a_corner", camera_at({0.0, 0.0, 0.0}, {0.5, 0.7, 0.3})},
      {"aimed_at_a_corner", camera_at({0.5, 0.5, 0.5}, {0.0, 1.0, 0.0})},
      {"inside_a_box_that_shines", camera_at({0.7, 0.75, 0.3}, {0.1, 0.8, 0.3})},
      {"inside_a_ball", camera_at({0.25, 0.75, 0.5}, {0.6, 0.8, 0.3})},
      {"on_a_ball", camera_at({0.25, 0.6, 0.5}, {0.6, 0.8, 0.3})},
      {"outside", camera_at({-3, -5, 2}, {0.5, 0.5, 0.5})},
      {"far_away", camera_at({-3e5, -5e5, 2e5}, {0.5, 0.5, 0.5})},
  };
  std::vector<FurnaceScene> all;
  for (const auto& [name, camera] : cameras) {
    all.push_back({name, furnished_furnace()});
    all.back().scene.camera = camera;
  }
  all.back().scene.camera->fov_degrees = 2e-4;
  return all;
}

std::vector<FurnaceScene> extreme_materials() {
  std::vector<FurnaceScene> all;
  const auto add = [&](const std::string& name, const Material& material) {
    // Inside of glass of index n a furnace has the radiance n^2: a floor that glass stands on, which looks into
    // it where the two coincide, would have to emit that.
    SceneDescription scene = furnished_furnace(0.01f);
    for (const std::size_t i : {6u, 7u, 8u}) {  // low and tall box, ball: the floor is the sixth of the walls
      scene.materials[scene.shapes[i].material] = material;
      scene.shapes[i].radiance = {C3f(0.0f), C3f(0.0f)};
    }
    all.push_back({name, std::move(scene)});
  };
  const MaterialSide mirror = Conductor{}, white = Diffuse{C3f(1.0f)}, nearly_white = Diffuse{C3f(0.999f)};
  add("mirrors", two_sided("mirror", mirror, mirror));
  add("white", two_sided("white", white, white));
  for (const auto& [name, eta] :
       {std::pair{"1", 1.0f}, {"1_plus_1e_6", 1.0f + 1e-6f}, {"10", 10.0f}, {"a_tenth", 0.1f}, {"1_5", 1.5f}})
    add(std::string("index_") + name, interface_material("glass", Dielectric{eta}));
  for (const auto& [name, alpha] : {std::pair{"0", 0.0f}, {"1e_8", 1e-8f}, {"1e_5", 1e-5f}}) {
    RoughConductor metal;
    metal.alpha_u = metal.alpha_v = alpha;
    add(std::string("metal_of_roughness_") + name,
        two_sided("metal", MaterialSide(metal), MaterialSide(metal)));
    RoughDielectric glass;
    glass.alpha_u = glass.alpha_v = alpha;
    add(std::string("glass_of_roughness_") + name, material_of("glass", MaterialSide(glass)));
  }
  // Nothing but glass, walls too, which are panes in air; and nothing but white walls around one lamp.
  SceneDescription glass;
  glass.environment = Environment(C3f(furnace_radiance));
  std::vector<Geometry> panes;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool is_low : {true, false}) {
      V3f lo(0.0f), hi(1.0f);
      lo[axis] = is_low ? -0.03f : 1.01f;
      hi[axis] = lo[axis] + 0.02f;
      panes.emplace_back(boxed(lo, hi));
    }
  const SceneDescription furniture = furnished_furnace(0.01f);
  for (const std::size_t i : {6u, 7u, 8u}) panes.push_back(furniture.shapes[i].geometry);
  for (const Geometry& geometry : panes)
    add_lossless(glass, "pane", geometry, interface_material("glass", Dielectric{}));
  all.push_back({"everything_glass", glass});
  SceneDescription bright;
  bright.environment = Environment(C3f(furnace_radiance));
  for (const Shape& shape : furnished_furnace().shapes)
    add_furnace(bright, shape.name, shape.geometry, shape.name == "ceiling" ? C3f(0.0f) : C3f(0.999f));
  all.push_back({"albedo_999", bright});
  return all;
}

SceneDescription transformed(SceneDescription scene, float factor, const V3f& offset) {
  for (Shape& shape : scene.shapes) {
    if (auto* mesh = std::get_if<Mesh>(&shape.geometry)) {
      for (V3f& p : mesh->positions) p = p * factor + offset;
    } else if (auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
      sphere->center = sphere->center * factor + offset;
      sphere->radius *= factor;
    }
  }
  for (PunctualLight& light : scene.punctual_lights)
    if (auto* point = std::get_if<PointLight>(&light)) {
      point->position = point->position * factor + offset;
      point->intensity *= factor * factor;
    }
  if (scene.camera)
    for (int axis = 0; axis < 3; ++axis)
      scene.camera->to_world[3][axis] =
          scene.camera->to_world[3][axis] * static_cast<double>(factor) + static_cast<double>(offset[axis]);
  return scene;
}

}  // namespace twopass::stress
