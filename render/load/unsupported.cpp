#include "render/load/unsupported.h"

#include <algorithm>

namespace twopass {
namespace {

struct Advice {
  std::string_view tag, type, text;
};

constexpr std::string_view curves = "convert the curves to a mesh";
constexpr std::string_view polarisation = "light is not polarised here: use an unpolarised bsdf in its place";
constexpr std::string_view media = "only surfaces scatter light here: leave the medium out";
constexpr std::string_view measured = "fit the measurement with 'principled' or 'roughconductor'";
constexpr std::string_view meters = "place a camera that looks at the surface in its place";

// An empty type is every type of the tag.
constexpr Advice advices[] = {
    {"shape", "bsplinecurve", curves},
    {"shape", "linearcurve", curves},
    {"shape", "hair", curves},
    {"shape", "sdfgrid", "convert it to a mesh"},
    {"shape", "heightfield", "convert it to a mesh"},
    {"shape", "ellipsoids", "convert them to spheres or meshes"},
    {"shape", "ellipsoidsmesh", "convert them to spheres or meshes"},
    {"shape", "blender", "export the mesh as .ply or .obj"},
    {"bsdf", "hair", "fibres are not scattered by here: use 'principled' on a mesh"},
    {"bsdf", "measured", measured},
    {"bsdf", "measured_polarized", measured},
    {"bsdf", "polarizer", polarisation},
    {"bsdf", "circular", polarisation},
    {"bsdf", "retarder", polarisation},
    {"bsdf", "pplastic", "light is not polarised here: use 'roughplastic'"},
    {"bsdf", "coating", "use 'plastic' for a coat over a diffuse base, or 'principled' with its clearcoat"},
    {"bsdf", "roughcoating",
     "use 'roughplastic' for a coat over a diffuse base, or 'principled' with its clearcoat"},
    {"bsdf", "difftrans", "use 'principledthin' with diff_trans"},
    {"bsdf", "hk", "only surfaces scatter light here: use 'principledthin'"},
    {"bsdf", "irawan", "use 'roughdiffuse' with a texture"},
    {"medium", "", media},
    {"phase", "", media},
    {"volume", "", media},
    {"subsurface", "", "only surfaces scatter light here: use 'principled' with its flatness"},
    {"texture", "volume", "bake it to a bitmap or to colours of the vertices"},
    {"texture", "wireframe", "bake it to a bitmap"},
    {"texture", "curvature", "bake it to a bitmap"},
    {"emitter", "directionalarea", "use 'area', or 'directional' for light from afar"},
    {"emitter", "timed_sunsky", "use 'sunsky' at one time"},
    {"emitter", "sky", "use 'sunsky' with a sun_scale of 0"},
    {"emitter", "sun", "use 'sunsky' with a sky_scale of 0"},
    {"emitter", "collimated", "use 'spot' with a small cutoff_angle"},
    {"sensor", "batch", "give one of its cameras"},
    {"sensor", "distant", "use 'orthographic'"},
    {"sensor", "telecentric", "use 'orthographic'"},
    {"sensor", "spherical", "render several 'perspective' views"},
    {"sensor", "radiancemeter", meters},
    {"sensor", "irradiancemeter", meters},
    {"sensor", "fluencemeter", meters},
    {"film", "specfilm", "pictures are RGB here: use hdrfilm"},
    {"film", "ldrfilm", "it was renamed: use hdrfilm, and -o FILE.png for a display-referred picture"},
    {"film", "tiledhdrfilm", "use hdrfilm"},
    {"film", "mfilm", "use hdrfilm, and -o FILE.exr"},
};

std::string plural(const std::string& tag, int count) {
  if (count == 1) return tag;
  if (tag == "property") return "properties";
  if (tag == "medium") return "media";
  return tag + "s";
}

}  // namespace

std::string Feature::name() const {
  const std::string object = type.empty() ? tag : tag + " '" + type + "'";
  return property.empty() ? object : "property '" + property + "' of " + object;
}

std::string_view advice_on(std::string_view tag, std::string_view type) {
  for (const Advice& advice : advices)
    if (advice.tag == tag && (advice.type.empty() || advice.type == type)) return advice.text;
  return "";
}

void LeftOut::add(const Unsupported& error) {
  if (!entries_.try_emplace(error.feature()).second) throw Unsupported(error);
}

bool LeftOut::has_object(const XmlNode& object) const {
  if (entries_.empty()) return false;
  const std::string* type = object.find("type");
  return entries_.contains({object.tag, type ? *type : "", ""});
}

bool LeftOut::has_property(const XmlNode& object, const XmlNode& property) const {
  if (entries_.empty()) return false;
  const std::string *type = object.find("type"), *name = property.find("name");
  return type && name && entries_.contains({object.tag, *type, *name});
}

void LeftOut::count(const XmlNode& object, const XmlNode* property) {
  const std::string* type = object.find("type");
  Count& count = entries_.at({object.tag, type ? *type : "", property ? property->get("name") : ""});
  if (count.occurrences++ == 0) count.first = (property ? *property : object).where();
}

void LeftOut::restart() {
  for (auto& [feature, count] : entries_) count.occurrences = 0;
}

std::vector<Skipped> LeftOut::list() const {
  std::vector<Skipped> list;
  for (const auto& [feature, count] : entries_) {
    if (count.occurrences == 0) continue;
    std::string what = std::to_string(count.occurrences) + " ";
    if (feature.property.empty())
      what += Feature{plural(feature.tag, count.occurrences), feature.type, ""}.name();
    else
      what += (count.occurrences == 1 ? "property '" : "properties '") + feature.property + "' of " +
              Feature{plural(feature.tag, count.occurrences), feature.type, ""}.name();
    what += (count.occurrences == 1 ? ", at " : ", the first at ") + count.first;
    const std::string_view advice = feature.property.empty() ? advice_on(feature.tag, feature.type) : "";
    std::string why = "not supported";
    if (feature.property.empty() && (feature.tag == "bsdf" || feature.tag == "texture"))
      why += ", grey in its place";
    if (!advice.empty()) why.append(": ").append(advice);
    list.push_back({what, why});
  }
  return list;
}

void unsupported_plugin(const XmlNode& object, std::span<const std::string_view> supported) {
  const std::string& type = object.get("type");
  std::string remedy = "supported " + plural(object.tag, 2) + ": " + join_names(supported);
  if (const std::string_view advice = advice_on(object.tag, type); !advice.empty())
    remedy.append("; ").append(advice);
  remedy += "; --ignore-unsupported renders what is left";
  throw Unsupported({object.tag, type, ""}, object.where(), object.tag + " '" + type + "' is not supported",
                    remedy);
}

}  // namespace twopass
