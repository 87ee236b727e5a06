#include "tests/stress/random_scene.h"

#include <cmath>

#include "tests/stress/furnace_scenes.h"

namespace twopass::stress {

namespace {

constexpr V3f x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);

class Dice {
 public:
  explicit Dice(std::uint32_t seed) : sampler_(seed, 0, 0, SamplerKind::independent) {}
  float next() { return sampler_.next_1d(); }
  float between(float lo, float hi) { return lo + (hi - lo) * next(); }
  bool chance(float p) { return next() < p; }
  int below(int n) { return std::min(n - 1, static_cast<int>(static_cast<float>(n) * next())); }
  V3f point(float margin) {
    const float a = between(margin, 1 - margin), b = between(margin, 1 - margin);
    return {a, b, between(margin, 1 - margin)};
  }
  C3f albedo() {
    const float a = between(0.0f, 0.85f), b = between(0.0f, 0.85f);
    return {a, b, between(0.0f, 0.85f)};
  }

 private:
  Sampler sampler_;
};

Geometry any_geometry(Dice& dice) {
  const V3f p = dice.point(0.15f);
  const float size = dice.between(0.05f, 0.3f);
  switch (dice.below(5)) {
    case 0:
      return Sphere{p, 0.5f * size, false};
    case 1:
      return Disk{p, x * size, (y * dice.between(0.1f, 1.0f) + z * dice.between(-1.0f, 1.0f)) * size};
    case 2: {  // needles
      Mesh mesh;
      for (std::uint32_t k = 0; k < 30; k += 3) {
        const V3f a = dice.point(0.1f), b = dice.point(0.1f);
        mesh.positions.insert(mesh.positions.end(), {a, b, b + (dice.point(0.0f) - V3f(0.5f)) * 1e-5f});
        mesh.triangles.emplace_back(k, k + 1, k + 2);
      }
      return mesh;
    }
    case 3: {  // a tilted quad
      const V3f a = (dice.point(0.0f) - V3f(0.5f)) * size * 2.0f,
                b = (dice.point(0.0f) - V3f(0.5f)) * size * 2.0f;
      return test::quad(p, a, b);
    }
    default: {
      SceneDescription box;
      test::add_box(box, "box", p - V3f(size) * 0.5f,
                    p + V3f(size, size, dice.chance(0.3f) ? 1e-6f : size) * 0.5f, one_sided("box", Diffuse{}));
      return box.shapes[0].geometry;
    }
  }
}

void add_object(SceneDescription& scene, Dice& dice) {
  const float kind = dice.next();
  const C3f albedo = dice.albedo();
  if (kind < 0.08f) {
    const MaterialSide mirror = Conductor{};
    add_lossless(scene, "mirror", any_geometry(dice), two_sided("mirror", mirror, mirror));
  } else if (kind < 0.14f) {
    add_lossless(scene, "glass", Sphere{dice.point(0.15f), dice.between(0.03f, 0.12f), false},
                 interface_material("glass", Dielectric{}));
  } else {
    Shape& shape = test::add_diffuse(scene, "object", any_geometry(dice), albedo);
    const MaterialSide side = Diffuse{albedo};
    if (dice.chance(0.8f)) scene.materials.back() = two_sided("object", side, side);
    if (dice.chance(0.1f)) shape.radiance[front] = C3f(dice.between(0.1f, 3.0f));
  }
}

}  // namespace

SceneDescription random_scene(std::uint32_t seed) {
  Dice dice(seed);
  SceneDescription scene;
  // The walls, some of which may be missing.
  const SceneDescription room = test::unit_room(C3f(0.5f), C3f(0.0f), C3f(0.5f));
  const float missing = dice.chance(0.4f) ? 0.4f : 0.0f;
  for (std::size_t i = 0; i < room.shapes.size(); ++i) {
    if (dice.chance(missing)) continue;
    const C3f albedo = dice.albedo();
    const MaterialSide side = Diffuse{albedo};
    test::add_diffuse(scene, room.shapes[i].name, room.shapes[i].geometry, albedo);
    scene.materials.back() = two_sided("wall", side, side);
  }
  for (int k = dice.below(7); k > 0; --k) add_object(scene, dice);

  // At least one light. Lamps are not small: caustics of small lamps are found by chance, seldom.
  const bool has_sky = dice.chance(missing > 0.0f ? 0.5f : 0.1f), has_bulb = dice.chance(0.3f);
  if (has_sky) scene.environment = Environment(C3f(dice.between(0.1f, 2.0f)));
  if (has_bulb)
    scene.punctual_lights.emplace_back(PointLight{dice.point(0.3f), C3f(dice.between(0.05f, 0.5f))});
  for (int k = (has_sky || has_bulb ? 0 : 1) + dice.below(3); k > 0; --k) {
    const float edge = dice.between(0.15f, 0.4f);
    const V3f corner(dice.between(0.05f, 0.55f), dice.between(0.05f, 0.55f),
                     0.98f - 0.002f * static_cast<float>(k));
    test::add_diffuse(scene, "lamp", test::quad(corner, y * edge, x * edge), C3f(0.0f),
                      C3f(dice.between(1.0f, 10.0f)));
  }
  CameraDescription camera;
  const V3d eye(0.5, 0.04, 0.5);
  camera.to_world = look_at(eye, V3d(dice.point(0.2f)) + V3d(0, 0.3, 0), {0, 0.01, 1}, "camera");
  camera.fov_degrees = static_cast<double>(dice.between(40.0f, 100.0f));
  scene.camera = camera;
  const float factor = std::pow(10.0f, dice.between(-6.0f, 6.0f));
  return transformed(scene, factor,
                     (dice.point(0.0f) - V3f(0.5f)) * factor * std::pow(10.0f, dice.between(-1.0f, 2.0f)));
}

bool Agreement::holds() const { return fault.empty() && std::abs(difference) <= bias + 4.4 * noise; }

Agreement compare_integrators(std::uint32_t seed) {
  const SceneDescription scene = random_scene(seed);
  Agreement result;
  struct Try {
    int samples;
    std::size_t elements;
    std::uint32_t rays_per_element;
  };
  for (const Try& attempt : {Try{16, 400, 128}, Try{512, 3000, 1024}, Try{512, 0, 0}}) {
    ++result.tries;
    PictureOptions options;
    options.seed = seed + static_cast<std::uint32_t>(attempt.samples / 16);
    options.samples = attempt.samples;
    options.elements = attempt.elements;
    options.rays_per_element = attempt.rays_per_element;
    result.path = render(scene, {IntegratorKind::path}, options);
    result.two_pass = render(scene, {IntegratorKind::two_pass}, options);
    result.fault = fault_of(result.path);
    if (result.fault.empty()) result.fault = fault_of(result.two_pass);
    const double mean = std::max(result.path.mean, Agreement::darkest);
    result.difference = (result.two_pass.mean - result.path.mean) / mean;
    result.noise = std::hypot(result.path.error, result.two_pass.error) / mean;
    if (result.holds() || !result.fault.empty()) break;
  }
  return result;
}

}  // namespace twopass::stress
