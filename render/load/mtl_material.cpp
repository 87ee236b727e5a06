#include "render/load/mtl_material.h"

#include <algorithm>
#include <sstream>
#include <vector>

#include <tiny_obj_loader.h>

#include "render/core/error.h"
#include "render/load/number.h"
#include "render/load/obj_text.h"
#include "render/load/text_file.h"

namespace twopass {
namespace {

/// tinyobjloader cannot tell "absent" from 0 (or 1): each material starts with these, which no file can contain
/// because negative numbers are refused.
constexpr std::string_view absent = "Kd -1 -1 -1\nTf -1 -1 -1\nNi -1\nillum -1\n";

/// MTL text with one value on each numeric line, checked, and the marks of absence behind each newmtl.
class Cleaner {
 public:
  explicit Cleaner(std::string_view file) : file_(file) {}

  std::string clean(std::string_view text) {
    LineReader reader(without_byte_order_mark(text));
    std::string line;
    while (reader.next(line)) {
      number_ = reader.number();
      const std::vector<std::string_view> tokens = split(line, " \t");
      if (!tokens.empty() && tokens[0][0] != '#') statement(line, tokens);
    }
    return std::move(result_);
  }

 private:
  [[noreturn]] void fail(const std::string& what, std::string_view remedy) const {
    throw Error(std::string(file_) + ":" + std::to_string(number_), what, remedy);
  }

  void statement(std::string_view line, std::vector<std::string_view> tokens) {
    const std::string_view key = tokens[0];
    if (key == "newmtl") {
      std::string_view name = line.substr(line.find(key) + key.size());
      while (!name.empty() && (name.front() == ' ' || name.front() == '\t')) name.remove_prefix(1);
      while (!name.empty() && (name.back() == ' ' || name.back() == '\t')) name.remove_suffix(1);
      if (name.empty()) fail("'newmtl' without a name", "name the material");
      inside_ = true;
      result_.append("newmtl ").append(name).append("\n").append(absent);
      return;
    }
    if (!inside_) return;
    tokens.erase(std::find_if(tokens.begin(), tokens.end(), [](auto token) { return token[0] == '#'; }),
                 tokens.end());
    if (key == "Ka" || key == "Kd" || key == "Ks" || key == "Ke" || key == "Tf" || key == "Kt")
      color(key, tokens);
    else if (key == "d" || key == "Tr" || key == "Ni" || key == "Ns" || key == "illum")
      scalar(key, tokens);
    else
      result_.append(line).append("\n");
  }

  void color(std::string_view key, const std::vector<std::string_view>& tokens) {
    if (tokens.size() > 1 && (tokens[1] == "spectral" || tokens[1] == "xyz"))
      fail(in_quotes(key) + " with " + in_quotes(tokens[1]) + " is not supported", "give red, green and blue");
    if (tokens.size() != 2 && tokens.size() < 4)
      fail(in_quotes(key) + " needs one or three numbers", "give red, green and blue");
    result_.append(key);
    for (std::size_t i = 1; i <= 3; ++i) append_number(key, tokens[tokens.size() == 2 ? 1 : i]);
    result_ += '\n';
  }

  void scalar(std::string_view key, std::vector<std::string_view>& tokens) {
    if (key == "d") std::erase(tokens, "-halo");
    if (tokens.size() < 2) fail(in_quotes(key) + " without a number", "give one");
    result_.append(key);
    append_number(key, tokens[1]);
    result_ += '\n';
  }

  void append_number(std::string_view key, std::string_view token) {
    const std::optional<double> value = parse_number(token);
    if (!value || *value < 0.0 || *value > 1e30)
      fail(in_quotes(key) + " cannot be " + in_quotes(token), "give a number from 0 to 1e30");
    result_.append(" ").append(token);
  }

  std::string_view file_;
  std::string result_;
  std::uint32_t number_ = 0;
  bool inside_ = false;
};

/// Names of materials by what had to be left out of them.
class LeftOut {
 public:
  void add(std::string reason, const std::string& material) { names_[std::move(reason)].push_back(material); }

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

C3f color_of(const tinyobj::real_t* values) {
  return C3f(static_cast<float>(values[0]), static_cast<float>(values[1]), static_cast<float>(values[2]));
}

C3f clamp_reflectance(const C3f& c, const std::string& name, LeftOut& left_out) {
  if (max_component(c) > 1.0f) left_out.add("reflectance above 1 reduced to 1", name);
  return C3f(std::min(c.x, 1.0f), std::min(c.y, 1.0f), std::min(c.z, 1.0f));
}

bool has_texture(const tinyobj::material_t& m) {
  return !m.diffuse_texname.empty() || !m.specular_texname.empty() || !m.specular_highlight_texname.empty() ||
         !m.bump_texname.empty() || !m.displacement_texname.empty() || !m.alpha_texname.empty() ||
         !m.reflection_texname.empty() || !m.emissive_texname.empty() || !m.normal_texname.empty() ||
         !m.roughness_texname.empty() || !m.metallic_texname.empty();
}

Material glass(const tinyobj::material_t& m, const C3f& ks, LeftOut& left_out) {
  Dielectric outside;
  outside.eta = static_cast<float>(m.ior);
  if (m.ior < 0.0f) {
    // Glass by its illumination model refracts; a see-through sheet made by `d` alone does not.
    outside.eta = m.illum >= 4 ? 1.5f : 1.0f;
    if (m.illum >= 4) left_out.add("glass without Ni rendered with an index of refraction of 1.5", m.name);
  }
  if (!(outside.eta > 0.0f)) {
    left_out.add("index of refraction 0 replaced by 1", m.name);
    outside.eta = 1.0f;
  }
  if (!is_black(ks)) outside.specular_reflectance = ks;
  C3f filter = color_of(m.transmittance);
  if (filter.x < 0.0f) filter = C3f(m.dissolve < 1.0f ? 1.0f - static_cast<float>(m.dissolve) : 1.0f);
  filter = clamp_reflectance(filter, m.name, left_out);
  outside.specular_transmittance = C3f(std::sqrt(filter.x), std::sqrt(filter.y), std::sqrt(filter.z));
  if (m.dissolve < 1.0f) left_out.add("partly transparent (d) rendered as clear glass", m.name);
  return interface_material(m.name, outside);
}

MtlMaterial convert(const tinyobj::material_t& m, LeftOut& left_out) {
  MtlMaterial result;
  result.radiance = color_of(m.emission);
  const C3f ks = clamp_reflectance(color_of(m.specular), m.name, left_out);
  C3f kd = color_of(m.diffuse);
  const bool is_glass = m.illum == 4 || m.illum == 6 || m.illum == 7 || m.illum == 9 || m.dissolve < 1.0f;
  const bool reflects = m.illum == 3 || m.illum == 5 || m.illum == 8;
  if (kd.x < 0.0f) {
    const bool needs_none = is_glass || reflects || !is_black(result.radiance);
    kd = C3f(needs_none ? 0.0f : 0.5f);
    if (!needs_none) left_out.add("no Kd: rendered with 0.5", m.name);
  }
  kd = clamp_reflectance(kd, m.name, left_out);
  if (has_texture(m)) left_out.add("textures are not supported, plain colours used", m.name);
  if (m.roughness > 0.0f || m.metallic > 0.0f || m.sheen > 0.0f || m.clearcoat_thickness > 0.0f)
    left_out.add("the PBR extension is left out", m.name);

  if (is_glass) {
    result.material = glass(m, ks, left_out);
    if (!is_black(kd)) left_out.add("glass rendered without its Kd", m.name);
  } else if (reflects && !is_black(ks) && max_component(ks) >= max_component(kd)) {
    Conductor mirror;
    mirror.specular_reflectance = ks;
    result.material = two_sided(m.name, mirror, mirror);
    if (!is_black(kd)) left_out.add("mirror rendered without its Kd", m.name);
  } else {
    result.material = two_sided(m.name, Diffuse{kd}, Diffuse{kd});
    // Models 0 and 1 say themselves that there are no highlights.
    if (!is_black(ks) && m.illum != 0 && m.illum != 1) left_out.add("highlights (Ks, Ns) are left out", m.name);
  }
  return result;
}

}  // namespace

MtlLibrary parse_mtl(std::string_view text, std::string_view file, const std::set<std::string>& wanted,
                     Notes& notes) {
  std::istringstream stream(Cleaner(file).clean(text));
  std::map<std::string, int> index;
  std::vector<tinyobj::material_t> parsed;
  std::string warning, error;
  tinyobj::LoadMtl(&index, &parsed, &stream, &warning, &error);
  MtlLibrary library;
  LeftOut left_out;
  for (const auto& [name, i] : index)
    if (wanted.contains(name)) library.emplace(name, convert(parsed[static_cast<std::size_t>(i)], left_out));
  left_out.report(file, notes);
  return library;
}

MtlLibrary read_mtl(const std::filesystem::path& path, const std::set<std::string>& wanted, Notes& notes) {
  return parse_mtl(read_text_file(path), path.string(), wanted, notes);
}

}  // namespace twopass
