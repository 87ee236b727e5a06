#include "radiosity/scene_fingerprint.h"

#include <bit>

#include "render/core/sampler.h"

namespace twopass {

namespace {

class Hash {
 public:
  void add(std::uint64_t word) { state_ = hash_word(state_ * 0x9e3779b97f4a7c15u + word + 1); }
  void add(float x) { add(std::uint64_t{std::bit_cast<std::uint32_t>(x)}); }
  void add(const V3f& v) {
    add(std::uint64_t{std::bit_cast<std::uint32_t>(v.x)} << 32 | std::bit_cast<std::uint32_t>(v.y));
    add(v.z);
  }
  void add(const V3u& v) {
    add(std::uint64_t{v.x} << 32 | v.y);
    add(std::uint64_t{v.z});
  }
  [[nodiscard]] std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0;
};

// What decides how a model scatters: all its parameters.
template <class Model>
void add_model(Hash& hash, const Model& model) {
  Model::visit_parameters(model, [&](std::string_view, const auto& value) {
    using Value = std::remove_cvref_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, float> || std::is_base_of_v<V3f, Value>)
      hash.add(value);
    else
      hash.add(static_cast<std::uint64_t>(value));  // a choice
  });
}

void add_geometry(Hash& hash, const Mesh& mesh) {
  hash.add(std::uint64_t{mesh.positions.size()});
  for (const V3f& p : mesh.positions) hash.add(p);
  hash.add(std::uint64_t{mesh.normals.size()});
  for (const V3f& n : mesh.normals) hash.add(n);
  hash.add(std::uint64_t{mesh.triangles.size()});
  for (const V3u& t : mesh.triangles) hash.add(t);
}
void add_geometry(Hash& hash, const Sphere& sphere) {
  hash.add(sphere.center);
  hash.add(sphere.radius);
  hash.add(std::uint64_t{sphere.inward});
}

}  // namespace

std::uint64_t scene_fingerprint(const Scene& scene) {
  Hash hash;
  hash.add(std::uint64_t{scene.shapes().size()});
  for (const Shape& shape : scene.shapes()) {
    hash.add(std::uint64_t{shape.geometry.index()});
    std::visit([&](const auto& geometry) { add_geometry(hash, geometry); }, shape.geometry);
    for (const Bsdf& bsdf : scene.description().materials[shape.material].side) {
      hash.add(std::uint64_t{bsdf.index()});
      std::visit([&](const auto& model) { add_model(hash, model); }, bsdf);
    }
    for (const C3f& radiance : shape.radiance) hash.add(radiance);
  }
  hash.add(scene.sky());
  return hash.value();
}

}  // namespace twopass
