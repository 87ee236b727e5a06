#include "render/load/mtl_material.h"

#include <algorithm>

#include "materials/ior.h"
#include "materials/microfacet.h"
#include "render/core/error.h"
#include "render/core/parallel.h"
#include "render/load/text_file.h"

namespace twopass {
namespace {

/// Names of materials by what had to be left out of them.
class LeftOut {
 public:
  void add(std::string reason, const std::string& material) { names_[std::move(reason)].push_back(material); }
  void add(const LeftOut& other) {
    for (const auto& [reason, names] : other.names_)
      names_[reason].insert(names_[reason].end(), names.begin(), names.end());
  }

  void report(std::string_view file, Notes& notes) const {
    for (const auto& [reason, names] : names_) {
      std::string note = std::string(file) + ": " + reason + ": ";
      constexpr std::size_t most = 4;
      for (std::size_t i = 0; i < std::min(most, names.size()); ++i) note += (i > 0 ? ", " : "") + names[i];
      if (names.size() > most) note += " and " + std::to_string(names.size() - most) + " more";
      notes.add(note);
    }
  }

 private:
  std::map<std::string, std::vector<std::string>> names_;
};

C3f root(const C3f& c) { return C3f(std::sqrt(c.x), std::sqrt(c.y), std::sqrt(c.z)); }

/// A model whose parameters may be textures.
template <class Model>
class Textured {
 public:
  explicit Textured(const Model& model) : model_(model) {}

  /// Puts a texture in place of the parameter called `name`, if there is one.
  Textured& bind(std::string_view name, std::optional<Texture> texture) {
    std::size_t number = 0;
    Model::visit_parameters(model_, [&](std::string_view parameter, auto&) {
      if (texture && parameter == name) bindings_.push_back({number, *texture});
      ++number;
    });
    return *this;
  }
  [[nodiscard]] MaterialSide side() const {
    return MaterialSide(std::make_shared<const MaterialNode>(MaterialNode{TexturedModel{model_, bindings_}}));
  }

 private:
  Model model_;
  std::vector<TextureBinding> bindings_;
};

/// One record on its way to a material.
class Converter {
 public:
  Converter(const MtlRecord& record, const std::filesystem::path& path, TextureFiles& textures)
      : m_(record), path_(path), textures_(textures) {}

  MtlMaterial convert() {
    read_colors();
    MtlMaterial result;
    emission(result);
    result.material = is_pbr() ? principled() : is_glass_ ? glass() : is_mirror() ? mirror() : opaque();
    perturb(result.material);
    if (!is_glass_) mask(result.material);
    return result;
  }

  LeftOut left_out;

 private:
  enum class Meaning { color, emission, number, opacity };

  bool is_pbr() const {
    return m_.pr || m_.pm || m_.ps || m_.pc || m_.pcr || m_.aniso || m_.map_pr || m_.map_pm || m_.map_ps;
  }
  bool is_mirror() const {
    const bool reflects = m_.illum == 3 || m_.illum == 5 || m_.illum == 8;
    return reflects && !is_black(ks_) && max_component(ks_) >= max_component(kd_);
  }
  float ns() const { return m_.ns.value_or(0.0f); }

  void note(std::string reason) { left_out.add(std::move(reason), m_.name); }

  C3f limited(const C3f& c) {
    if (max_component(c) > 1.0f) note("reflectance above 1 reduced to 1");
    return C3f(std::min(c.x, 1.0f), std::min(c.y, 1.0f), std::min(c.z, 1.0f));
  }
  /// What a texture multiplies.
  static C3f factor(const std::optional<C3f>& color) { return color && !is_black(*color) ? *color : C3f(1.0f); }

  void read_colors() {
    is_glass_ = m_.illum == 4 || m_.illum == 6 || m_.illum == 7 || m_.illum == 9;
    if (m_.map_ks)
      ks_ = limited(factor(m_.ks));
    else
      ks_ = limited(m_.ks.value_or(C3f(0.0f)));
    // Models 0 and 1 say themselves that there are no highlights.
    if (m_.illum == 0 || m_.illum == 1) ks_ = C3f(0.0f);
    if (m_.map_kd) {
      kd_ = limited(factor(m_.kd));
    } else if (m_.kd) {
      kd_ = limited(*m_.kd);
    } else if (!is_glass_ && is_black(ks_) && !m_.ke && !m_.map_ke) {
      kd_ = C3f(0.5f);
      note("no Kd: rendered with 0.5");
    }
  }

  void emission(MtlMaterial& result) {
    result.radiance = m_.ke.value_or(C3f(0.0f));
    if (!m_.map_ke) return;
    const Texture texture = *this->texture(m_.map_ke, factor(m_.ke), Meaning::emission);
    result.radiance = mean_color(texture);
    if (!is_constant(texture)) result.radiance_texture = std::make_shared<const Texture>(texture);
  }

  /// The map's texture times `factor`; nothing where there is no map.
  std::optional<Texture> texture(const std::optional<MtlMap>& map, const C3f& factor, Meaning meaning) {
    if (!map) return std::nullopt;
    TextureRequest request{.name = map->file,
                           .folders = {path_.parent_path()},
                           .where = path_.string() + ":" + std::to_string(map->line)};
    if (meaning == Meaning::number || meaning == Meaning::opacity)
      request.texels.encoding.kind = TextureEncoding::Kind::raw;
    request.texels.channel = channel(map->channel, meaning);
    request.texels.range = meaning == Meaning::emission ? TexelRange::nonnegative : TexelRange::unit;
    Bitmap& look = request.look;
    if (map->nearest) look.filter = TextureFilter::nearest;
    if (map->clamp) look.wrap_u = look.wrap_v = TextureWrap::clamp;
    // MTL's v runs up from the image's last row, ours down from its first.
    look.to_uv = {.a = map->scale.x, .c = map->offset.x, .e = -map->scale.y, .f = 1.0f - map->offset.y};
    const Texture loaded = textures_.load(request);
    if (factor == C3f(1.0f) && map->base == 0.0f && map->gain == 1.0f) return loaded;
    const float highest = meaning == Meaning::color || meaning == Meaning::opacity ? 1.0f : infinity_f;
    return scaled(
        loaded,
        {.factor = factor * map->gain, .offset = factor * map->base, .lowest = 0.0f, .highest = highest});
  }
  std::optional<Texture> number(const std::optional<MtlMap>& map, float factor = 1.0f) {
    return texture(map, C3f(factor), Meaning::number);
  }

  static TextureChannel channel(char letter, Meaning meaning) {
    if (letter == 'r') return TextureChannel::red;
    if (letter == 'g') return TextureChannel::green;
    if (letter == 'b') return TextureChannel::blue;
    if (letter == 'm') return TextureChannel::alpha;
    return meaning == Meaning::opacity && letter == 0 ? TextureChannel::opacity : TextureChannel::color;
  }

  Material both_sides(const MaterialSide& side) const { return two_sided(m_.name, side, side); }

  Material opaque() {
    if (is_black(ks_))
      return both_sides(
          Textured(Diffuse{kd_}).bind("reflectance", texture(m_.map_kd, kd_, Meaning::color)).side());
    const C3f sum = kd_ + ks_;
    if (max_component(sum) > 1.0f) {
      note("Kd + Ks above 1 reduced to 1");
      kd_ *= 1.0f / max_component(sum);
      ks_ *= 1.0f / max_component(sum);
    }
    const std::optional<Texture> base = texture(m_.map_kd, kd_, Meaning::color),
                                 gloss = texture(m_.map_ks, ks_, Meaning::color);
    if (m_.map_ns) {
      // As for colours: what is multiplied is 1 where it is not given.
      const float exponent = 0.25f * (ns() > 0.0f ? ns() : 1.0f);
      return both_sides(Textured(Phong{kd_, ks_, exponent})
                            .bind("diffuse_reflectance", base)
                            .bind("specular_reflectance", gloss)
                            .bind("exponent", number(m_.map_ns, exponent))
                            .side());
    }
    const float alpha = beckmann_alpha_of_phong(ns());
    return both_sides(Textured(Ward{kd_, ks_, alpha, alpha})
                          .bind("diffuse_reflectance", base)
                          .bind("specular_reflectance", gloss)
                          .side());
  }

  float possible_ior(float ior) {
    const float possible = std::clamp(ior, smallest_ior, largest_ior);
    if (possible != ior) note("index of refraction reduced to what a substance could have");
    return possible;
  }

  Material mirror() {
    if (!is_black(kd_)) note("mirror rendered without its Kd");
    Conductor mirror;
    mirror.specular_reflectance = ks_;
    return both_sides(
        Textured(mirror).bind("specular_reflectance", texture(m_.map_ks, ks_, Meaning::color)).side());
  }

  Material glass() {
    Dielectric outside;
    outside.eta = m_.ni.value_or(1.5f);
    if (!m_.ni) note("glass without Ni rendered with an index of refraction of 1.5");
    if (!(outside.eta > 0.0f)) {
      note("index of refraction 0 replaced by 1");
      outside.eta = 1.0f;
    }
    outside.eta = possible_ior(outside.eta);
    if (!is_black(ks_)) outside.specular_reflectance = ks_;
    const float opacity = m_.d.value_or(1.0f);
    const C3f filter = limited(m_.tf.value_or(C3f(opacity < 1.0f ? 1.0f - opacity : 1.0f)));
    outside.specular_transmittance = root(filter);
    if (opacity < 1.0f) note("partly transparent (d) rendered as clear glass");
    if (!is_black(kd_)) note("glass rendered without its Kd");
    if (m_.map_d) note("glass rendered without its map_d");
    return interface_material(m_.name, outside);
  }

  Material principled() {
    Principled model;
    model.base_color = kd_;
    model.roughness = m_.pr   ? unit_range(*m_.pr)
                      : m_.ns ? std::sqrt(beckmann_alpha_of_phong(ns()))
                              : model.roughness;
    model.metallic = unit_range(m_.pm.value_or(0.0f));
    model.sheen = unit_range(m_.ps.value_or(0.0f));
    model.clearcoat = unit_range(m_.pc.value_or(0.0f));
    model.clearcoat_gloss = 1.0f - unit_range(m_.pcr.value_or(0.0f));
    model.anisotropic = unit_range(m_.aniso.value_or(0.0f));
    // Most exporters write an index of 1 where they have none.
    if (m_.ni.value_or(1.0f) > 1.0f) model.eta = possible_ior(*m_.ni);
    if (is_glass_) model.spec_trans = m_.d.value_or(1.0f) < 1.0f ? 1.0f - *m_.d : 1.0f;
    const MaterialSide side = Textured(model)
                                  .bind("base_color", texture(m_.map_kd, kd_, Meaning::color))
                                  .bind("roughness", number(m_.map_pr))
                                  .bind("metallic", number(m_.map_pm))
                                  .bind("sheen", number(m_.map_ps))
                                  .side();
    return is_glass_ ? material_of(m_.name, side) : both_sides(side);
  }
  static float unit_range(float x) { return std::min(x, 1.0f); }

  void perturb(Material& material) {
    const std::optional<Texture> normals = number(m_.norm), height = number(m_.map_bump);
    if (normals && height) note("bump left out beside a normal map");
    for (MaterialSide& side : material.side) {
      if (normals)
        side = side_of({NormalMap{.normal = *normals, .nested = side.node()}});
      else if (height)
        side = side_of({BumpMap{.height = *height, .scale = m_.map_bump->bump, .nested = side.node()}});
    }
  }

  void mask(Material& material) {
    const float d = m_.d.value_or(1.0f);
    if (d >= 1.0f && !m_.map_d) return;
    if (d == 0.0f) note("invisible (d 0, or Tr 1)");
    const Texture opacity = texture(m_.map_d, C3f(d), Meaning::opacity).value_or(C3f(d));
    const MaterialNodePtr nothing = MaterialSide(Null{}).node();
    for (MaterialSide& side : material.side) side = side_of({Mixture{opacity, nothing, side.node()}});
  }

  static MaterialSide side_of(MaterialNode node) {
    return MaterialSide(std::make_shared<const MaterialNode>(std::move(node)));
  }

  const MtlRecord& m_;
  const std::filesystem::path& path_;
  TextureFiles& textures_;
  C3f kd_{0.0f}, ks_{0.0f};
  bool is_glass_ = false;
};

}  // namespace

MtlLibrary materials_of(const std::map<std::string, MtlRecord>& records, const std::filesystem::path& path,
                        TextureFiles& textures, Notes& notes) {
  std::vector<Converter> converters;
  for (const auto& [name, record] : records) converters.emplace_back(record, path, textures);
  std::vector<MtlMaterial> materials(records.size());
  parallel_tasks(records.size(), [&](std::size_t i) { materials[i] = converters[i].convert(); });

  MtlLibrary library;
  LeftOut left_out;
  std::size_t i = 0;
  for (const auto& [name, record] : records) {
    left_out.add(converters[i].left_out);
    library.emplace(name, std::move(materials[i++]));
  }
  left_out.report(path.string(), notes);
  return library;
}

MtlLibrary read_mtl(const std::filesystem::path& path, const std::set<std::string>& wanted,
                    TextureFiles& textures, Notes& notes) {
  return materials_of(parse_mtl(read_text_file(path), path.string(), wanted, notes), path, textures, notes);
}

}  // namespace twopass
