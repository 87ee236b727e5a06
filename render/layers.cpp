#include "render/layers.h"

#include "render/core/error.h"

namespace twopass {

namespace {

// Where there is no surface: as far away as Blender has it, which is finite, as EXR readers want it.
constexpr float depth_of_nothing = 1e10f;

void append(std::vector<float>& values, const V3f& v) { values.insert(values.end(), {v.x, v.y, v.z}); }

std::string name_for(CryptomatteKind kind, const SceneDescription& scene, const Shape& shape) {
  if (kind == CryptomatteKind::material) {
    const std::string& name = scene.materials[shape.material].name;
    return name.empty() ? "material-" + std::to_string(shape.material) : name;
  }
  if (kind == CryptomatteKind::asset) return shape.name.substr(0, shape.name.find_first_of("/:", 1));
  return shape.name;
}

}  // namespace

LightGroups light_groups_of(const Scene& scene) {
  LightGroups groups(scene.description());
  if (groups.size() > most_light_groups)
    throw Error(
        "--light-groups", "the scene has " + std::to_string(groups.size()) + " light groups",
        "name at most " + std::to_string(most_light_groups) + ": lights with the same light_group share one");
  return groups;
}

Layers::Layers(LayerRequest request, const Scene& scene, const CameraDescription& camera,
               const Solution* solution, const LightGroups* groups, const GroupedLight* cached)
    : request_(std::move(request)), scene_(scene), solution_(solution), groups_(groups), cached_(cached) {
  for (const Aov aov : request_.aovs) channels_.push_back(layer_of(aov).channels.size());
  const M44d& m = camera.to_world;
  eye_ = V3f(V3d(m[3][0], m[3][1], m[3][2]));
  forward_ = V3f(V3d(m[2][0], m[2][1], m[2][2]).normalized());
  for (const CryptomatteKind kind : request_.cryptomattes) {
    std::vector<std::uint32_t>& hashes = hashes_.emplace_back();
    std::map<std::string, std::uint32_t>& manifest = manifests_.emplace_back();
    for (const Shape& shape : scene.shapes()) {
      const std::string name = name_for(kind, scene.description(), shape);
      hashes.push_back(cryptomatte_hash(name));
      manifest.emplace(name, hashes.back());
    }
  }
}

FilmLayout layout_of(const LayerRequest& request, const LightGroups* groups, bool has_signed_weights) {
  FilmLayout layout;
  layout.has_signed_weights = has_signed_weights;
  for (const Aov aov : request.aovs) layout.layers.push_back(layer_of(aov));
  if (groups)
    for (const std::string& name : groups->names())
      layout.layers.push_back({"light_" + name, {"R", "G", "B"}, Reduction::mean});
  for (const CryptomatteKind kind : request.cryptomattes)
    layout.cryptomattes.emplace_back(cryptomatte_layer(kind));
  return layout;
}

std::vector<std::pair<std::string, std::string>> Layers::cryptomatte_metadata() const {
  std::vector<std::pair<std::string, std::string>> metadata;
  for (std::size_t k = 0; k < manifests_.size(); ++k) {
    const std::string name(cryptomatte_layer(request_.cryptomattes[k]));
    const std::string prefix = "cryptomatte/" + cryptomatte_key(name) + "/";
    metadata.emplace_back(prefix + "name", name);
    metadata.emplace_back(prefix + "hash", "MurmurHash3_32");
    metadata.emplace_back(prefix + "conversion", "uint32_to_float32");
    metadata.emplace_back(prefix + "manifest", cryptomatte_manifest(manifests_[k]));
  }
  return metadata;
}

C3f Layers::radiosity_at(const FirstSurface& first) const {
  if (!solution_) return C3f(0.0f);
  return first.diffuse_albedo * solution_->irradiance(first.point).total();
}

void Layers::values_of(const SampleLayers& seen, bool is_finite, std::vector<float>& values) const {
  values.clear();
  const FirstSurface& first = seen.first;
  for (std::size_t i = 0; i < request_.aovs.size(); ++i) {
    const Aov aov = request_.aovs[i];
    if (aov == Aov::samples || aov == Aov::variance) continue;
    if (aov == Aov::invalid) {
      values.push_back(is_finite ? 0.0f : 1.0f);
    } else if (static_cast<std::size_t>(aov) < light_class_count) {
      append(values, is_finite ? seen.light[static_cast<std::size_t>(aov)] : C3f(0.0f));
    } else if (!first.is_there) {
      values.insert(values.end(), channels_[i], aov == Aov::depth ? depth_of_nothing : 0.0f);
    } else {
      switch (aov) {
        case Aov::albedo:
          append(values, first.albedo);
          break;
        case Aov::shading_normal:
          append(values, first.point.shading.n);
          break;
        case Aov::geometric_normal:
          append(values, first.point.geometric_normal);
          break;
        case Aov::position:
          append(values, scene_.description().frame.to_world(first.point.position));
          break;
        case Aov::depth:
          values.push_back((first.point.position - eye_).dot(forward_) *
                           static_cast<float>(scene_.description().frame.unit));
          break;
        case Aov::uv: {
          const V2f at = scene_.texture_coordinates(first.point);
          values.insert(values.end(), {at.x, at.y});
          break;
        }
        case Aov::id:
          // From 1 on: 0 is nothing.
          values.push_back(static_cast<float>(first.point.shape + 1));
          values.push_back(static_cast<float>(scene_.shapes()[first.point.shape].material + 1));
          break;
        case Aov::element: {
          const std::uint32_t element = solution_ ? solution_->mesh().find(first.point) : no_index;
          values.push_back(element == no_index ? 0.0f : static_cast<float>(element + 1));
          break;
        }
        case Aov::radiosity:
          append(values, radiosity_at(first));
          break;
        case Aov::choice:
          values.push_back(seen.looked_up ? 1.0f : 0.0f);
          values.push_back(seen.gathered && !seen.looked_up ? 1.0f : 0.0f);
          values.push_back(seen.gathered || seen.looked_up ? 0.0f : 1.0f);
          break;
        default:  // cache
          values.push_back(seen.looked_up ? 1.0f : 0.0f);
      }
    }
  }
  for (const C3f& light : seen.groups) append(values, is_finite ? light : C3f(0.0f));
}

void Layers::Samples::prepare(std::span<PathSample> samples) {
  const std::size_t groups = layers_.groups_ ? layers_.groups_->size() : 0;
  room_.resize(samples.size());
  groups_.resize(samples.size() * groups);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    SampleLayers& room = room_[k];
    room.groups = std::span(groups_).subspan(k * groups, groups);
    room.light_groups = layers_.groups_;
    room.cached = layers_.cached_;
    samples[k].layers = &room;
  }
}

void Layers::Samples::add(std::size_t k, const PathSample& sample, float weight, float distance2, Film& film,
                          std::size_t pixel) {
  const SampleLayers& seen = room_[k];
  // As PixelBatch::add has it.
  const bool finite_weight = std::isfinite(weight);
  const C3f& radiance = sample.seen.radiance;
  const bool is_finite = twopass::is_finite(radiance) && std::isfinite(sample.seen.alpha) && finite_weight;
  layers_.values_of(seen, is_finite, values_);
  const float counted = finite_weight ? weight : 1.0f;
  film.layers().add(pixel, values_, counted, distance2);
  if (!seen.first.is_there || !is_finite) return;
  for (std::size_t c = 0; c < layers_.hashes_.size(); ++c)
    film.cryptomattes()[c].add(pixel, layers_.hashes_[c][seen.first.point.shape], counted);
}

}  // namespace twopass
