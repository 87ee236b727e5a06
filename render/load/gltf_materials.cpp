#include "render/load/gltf_materials.h"

#include "render/core/error.h"
#include "render/load/gltf_values.h"

namespace twopass {
namespace {

constexpr double largest_radiance = 1e30;

std::size_t parameter_called(std::string_view name) {
  std::size_t number = 0, result = 0;
  Principled any;
  Principled::visit_parameters(any, [&](std::string_view parameter, const auto&) {
    if (parameter == name) result = number;
    ++number;
  });
  return result;
}

/// Where nothing is seen and light goes straight on.
MaterialSide hole() { return MaterialSide(Null{}); }

MaterialSide with_opacity(const MaterialSide& side, const Texture& opacity) {
  return MaterialSide(
      std::make_shared<const MaterialNode>(MaterialNode{Mixture{opacity, hole().node(), side.node()}}));
}

/// Reads one material.
class MaterialReader {
 public:
  MaterialReader(const tinygltf::Material& material, const GltfVertexData& vertices, const std::string& owner,
                 const GltfDocument& document, GltfTextures& textures, Notes& notes)
      : m_(material),
        pbr_(material.pbrMetallicRoughness),
        vertices_(vertices),
        owner_(owner),
        document_(document),
        textures_(textures),
        values_(document, owner_, notes) {}

  Material read(GltfSurface& surface) {
    const bool is_unlit = extension("KHR_materials_unlit") != nullptr;
    Material material = is_unlit ? unlit(surface) : lit(surface);
    material.name = m_.name;
    cut_out(material);
    surface.uv_set = std::max(uv_set_, 0);
    return material;
  }

 private:
  [[nodiscard]] const tinygltf::Value* extension(const char* name) const {
    return GltfValues::extension(m_.extensions, name);
  }
  template <class Info>
  GltfTextureUse use_of(const Info& info) const {
    return texture_use(info.index, info.texCoord, info.extensions, owner_, document_);
  }

  /// The texture times a factor, or the factor alone.
  Texture times(const C3f& factor, const GltfTextureUse& use, GltfTexels texels) {
    if (use.index < 0) return factor;
    note_uv_set(use);
    return textures_.load(use, texels, TexelScale{factor}, owner_);
  }

  /// A shape has one set of texture coordinates: that of the first texture.
  void note_uv_set(const GltfTextureUse& use) {
    if (uv_set_ < 0) uv_set_ = use.uv_set;
    if (uv_set_ != use.uv_set || use.uv_set > 1)
      values_.note("all its textures use TEXCOORD_" + std::to_string(std::min(uv_set_, 1)));
  }

  void bind(const char* parameter, Texture texture) {
    if (const C3f* constant = std::get_if<C3f>(&texture)) {
      std::size_t number = 0;
      const std::size_t wanted = parameter_called(parameter);
      Principled::visit_parameters(model_, [&](std::string_view, auto& value) {
        if (number++ == wanted) assign(value, *constant);
      });
    } else {
      bindings_.push_back({parameter_called(parameter), std::move(texture)});
    }
  }
  static void assign(C3f& parameter, const C3f& value) { parameter = value; }
  static void assign(float& parameter, const C3f& value) { parameter = value.x; }
  static void assign(bool&, const C3f&) {}

  Texture base_color() {
    const C3f factor = values_.color(pbr_.baseColorFactor, "baseColorFactor");
    const GltfTextureUse use = use_of(pbr_.baseColorTexture);
    if (!vertices_.colors) return times(factor, use, GltfTexels::color);
    if (use.index < 0) return MeshColors{gltf_vertex_colors, nullptr, TexelScale{factor}};
    values_.note("vertex colours are left out where the base colour has a texture");
    return times(factor, use, GltfTexels::color);
  }

  void read_metallic_roughness() {
    const GltfTextureUse use = use_of(pbr_.metallicRoughnessTexture);
    const float metallic = values_.limited(pbr_.metallicFactor, 1.0, "metallicFactor"),
                roughness = values_.limited(pbr_.roughnessFactor, 1.0, "roughnessFactor");
    bind("metallic", times(C3f(metallic), use, GltfTexels::blue));
    bind("roughness", times(C3f(roughness), use, GltfTexels::green));
  }

  /// The reflectance at normal incidence follows from the index; KHR_materials_specular scales it, which is
  /// another index. Its colours are averaged: principled has no coloured plastic of any colour but its base's.
  void read_specular() {
    double ior = 1.5;
    if (const auto* e = extension("KHR_materials_ior")) {
      const tinygltf::Value& value = e->Get("ior");
      if (value.IsNumber()) ior = value.GetNumberAsDouble();
      if (!((ior >= 1.0 && ior <= 100.0) || ior == 0.0))
        values_.fail("has an index of refraction (ior) of " + std::to_string(ior), "it must be at least 1");
      if (ior == 0.0) {
        values_.note("ior 0 (everything is reflected) is rendered as 1.5");
        ior = 1.5;
      }
    }
    double f0 = (ior - 1.0) * (ior - 1.0) / ((ior + 1.0) * (ior + 1.0));
    if (const auto* e = extension("KHR_materials_specular")) {
      const C3f tint = values_.color(*e, "specularColorFactor", C3f(1.0f), 1e3);
      if (tint.x != tint.y || tint.y != tint.z) values_.note("specularColorFactor is rendered as its mean");
      if (e->Has("specularTexture") || e->Has("specularColorTexture"))
        values_.note("the textures of KHR_materials_specular are left out");
      f0 *= static_cast<double>(values_.number(*e, "specularFactor", 1.0)) *
            static_cast<double>(mean_component(tint));
    }
    const double root = std::sqrt(std::min(f0, 0.9));
    // Without any step in the index principled has no facets, not even of metal.
    model_.eta = static_cast<float>(std::max((1.0 + root) / (1.0 - root), 1.001));
  }

  void read_transmission() {
    const auto* e = extension("KHR_materials_transmission");
    if (!e) return;
    const GltfTextureUse use = texture_use(*e, "transmissionTexture", owner_, document_);
    bind("spec_trans", times(C3f(values_.number(*e, "transmissionFactor", 0.0)), use, GltfTexels::red));
  }

  /// The coat's width runs from 0.1 to 0.001 with the gloss (M22), glTF's is the square of its roughness.
  void read_clearcoat() {
    const auto* e = extension("KHR_materials_clearcoat");
    if (!e) return;
    const GltfTextureUse use = texture_use(*e, "clearcoatTexture", owner_, document_);
    const float factor = values_.number(*e, "clearcoatFactor", 0.0);
    if (factor == 0.0f) return;
    bind("clearcoat", times(C3f(factor), use, GltfTexels::red));
    const float roughness = values_.number(*e, "clearcoatRoughnessFactor", 0.0);
    const float alpha = roughness * roughness;
    model_.clearcoat_gloss = std::clamp((0.1f - alpha) / (0.1f - 0.001f), 0.0f, 1.0f);
    if (alpha > 0.1f) values_.note("clearcoatRoughnessFactor above 0.316 is rendered as 0.316");
    if (e->Has("clearcoatRoughnessTexture") || e->Has("clearcoatNormalTexture"))
      values_.note("clearcoatRoughnessTexture and clearcoatNormalTexture are left out");
  }

  MaterialSide with_normal_map(const MaterialSide& side) {
    const tinygltf::NormalTextureInfo& info = m_.normalTexture;
    const GltfTextureUse use = use_of(info);
    if (use.index < 0) return side;
    note_uv_set(use);
    if (!(std::abs(info.scale) <= 1e6))
      values_.fail("has a normalTexture.scale beyond 1e6", "correct the file");
    // Normals are (2 c - 1) (s, s, 1): of colours s c + (1 - s) / 2. Green is up, against v; where texture
    // coordinates are mirrored, our frame has its second axis the other way round.
    const auto s = static_cast<float>(info.scale);
    const float t = vertices_.mirrored ? -s : s;
    const TexelScale scale{C3f(s, t, 1.0f), C3f(0.5f - 0.5f * s, 0.5f - 0.5f * t, 0.0f)};
    const Texture normal = textures_.load(use, GltfTexels::normal, scale, owner_);
    return MaterialSide(std::make_shared<const MaterialNode>(MaterialNode{NormalMap{normal, {}, side.node()}}));
  }

  Material lit(GltfSurface& surface) {
    bind("base_color", base_color());
    read_metallic_roughness();
    read_specular();
    read_transmission();
    read_clearcoat();
    const bool transmits = extension("KHR_materials_transmission") != nullptr;
    const MaterialSide side = with_normal_map(MaterialSide(
        std::make_shared<const MaterialNode>(MaterialNode{TexturedModel{model_, std::move(bindings_)}})));
    float strength = 1.0f;
    if (const auto* e = extension("KHR_materials_emissive_strength"))
      strength = values_.number(*e, "emissiveStrength", 1.0, largest_radiance);
    const C3f factor = values_.color(m_.emissiveFactor, "emissiveFactor", largest_radiance) * strength;
    emit(times(factor, is_black(factor) ? GltfTextureUse{} : use_of(m_.emissiveTexture), GltfTexels::color),
         surface);
    return transmits ? material_of({}, side) : two_sided({}, side, side);
  }

  /// Shows its colour whatever light falls on it: it emits that, and reflects nothing. Backs of sheets that are
  /// not doubleSided are not there, as in a viewer: our own radiosity solutions have a sheet for each side.
  Material unlit(GltfSurface& surface) {
    emit(base_color(), surface);
    const Diffuse black{C3f(0.0f)};
    return two_sided({}, black, m_.doubleSided ? MaterialSide(black) : hole());
  }

  void emit(const Texture& radiance, GltfSurface& surface) {
    surface.radiance[front] = mean_color(radiance);
    surface.both_sides_emit = m_.doubleSided;
    if (is_constant(radiance)) return;
    surface.radiance_texture = std::make_shared<const Texture>(radiance);
    if (m_.doubleSided) values_.note("its back emits the mean of what its front does");
  }

  void cut_out(Material& material) {
    if (m_.alphaMode == "OPAQUE") return;
    const bool is_mask = m_.alphaMode == "MASK";
    if (!is_mask && m_.alphaMode != "BLEND")
      values_.fail("has alphaMode '" + m_.alphaMode + "'", "use one of: OPAQUE, MASK, BLEND");
    if (pbr_.baseColorFactor.size() != 4)
      values_.fail("has a baseColorFactor without alpha", "correct the file");
    const float factor = values_.limited(pbr_.baseColorFactor[3], 1.0, "baseColorFactor alpha");
    const GltfTextureUse use = use_of(pbr_.baseColorTexture);
    TexelScale scale{C3f(factor)};
    if (is_mask) {
      if (!(std::abs(m_.alphaCutoff) <= 1e6)) values_.fail("has an alphaCutoff beyond 1e6", "correct the file");
      // alpha >= cutoff as a slope so steep that no picture tells it from a step.
      constexpr float steep = 1e4f;
      const auto cutoff = static_cast<float>(m_.alphaCutoff);
      scale = {C3f(factor * steep), C3f(1.0f - cutoff * steep), 0.0f, 1.0f};
      if (use.index < 0) scale = {C3f(factor >= cutoff ? 1.0f : 0.0f)};
    }
    Texture opacity = scale.factor;
    if (use.index >= 0) {
      note_uv_set(use);
      opacity = textures_.load(use, GltfTexels::alpha, scale, owner_);
    }
    if (const C3f* constant = std::get_if<C3f>(&opacity); constant && constant->x >= 1.0f) return;
    for (MaterialSide& side : material.side) side = with_opacity(side, opacity);
  }

  const tinygltf::Material& m_;
  const tinygltf::PbrMetallicRoughness& pbr_;
  const GltfVertexData vertices_;
  const std::string owner_;
  const GltfDocument& document_;
  GltfTextures& textures_;
  GltfValues values_;
  Principled model_;
  std::vector<TextureBinding> bindings_;
  int uv_set_ = -1;  // none yet
};

}  // namespace

const GltfSurface& GltfMaterials::of(int index, const GltfVertexData& vertices, const std::string& user) {
  const auto [entry, is_new] = made_.try_emplace({index, vertices});
  GltfSurface& surface = entry->second;
  if (!is_new) return surface;
  tinygltf::Material standard;
  standard.name = "default";
  standard.emissiveFactor = {0.0, 0.0, 0.0};
  const tinygltf::Material& material =
      index < 0 ? standard : element_of(document_.model.materials, index, "material", user, document_);
  const std::string name = material.name.empty() ? std::to_string(index) : "'" + material.name + "'";
  surface.material = static_cast<std::uint32_t>(scene_.materials.size());
  scene_.materials.push_back(
      MaterialReader(material, vertices, "material " + name, document_, textures_, notes_).read(surface));
  return surface;
}

}  // namespace twopass
