#include "render/load/mitsuba_emitters.h"

#include "render/core/error.h"
#include "render/image/picture.h"
#include "render/load/ies_file.h"
#include "render/load/mitsuba_properties.h"

namespace twopass {
namespace {

using Emitter = std::variant<PunctualLight, Environment>;

struct Context {
  const MitsubaTree& tree;
  MitsubaTextures& textures;
};

C3f color_or(Properties& p, std::string_view name, const C3f& otherwise) {
  return p.color(name, ColorUse::emission).value_or(otherwise);
}

float number_within(Properties& p, std::string_view name, double otherwise, double low, double high,
                    const std::string& range) {
  const double value = p.number(name).value_or(otherwise);
  if (!(value >= low && value <= high))
    throw Error(p.where(name), "'" + std::string(name) + "' must be " + range, "correct it");
  return static_cast<float>(value);
}

float scale_of(Properties& p, std::string_view name) {
  return number_within(p, name, 1.0, 0.0, 1e30, "0 or more");
}

/// A transform that can be undone.
M44d invertible_transform(Properties& p) {
  const M44d m = p.transform("to_world");
  const double determinant =
      V3d(m[0][0], m[0][1], m[0][2]).cross(V3d(m[1][0], m[1][1], m[1][2])).dot(V3d(m[2][0], m[2][1], m[2][2]));
  if (!(std::abs(determinant) > 0.0) || !std::isfinite(1.0 / determinant))
    throw Error(p.where("to_world"), "the transform flattens space", "remove the scale by zero");
  return m;
}

/// A transform that keeps angles, for directions.
M44d rotation(Properties& p) {
  const M44d m = invertible_transform(p);
  V3d axis[3];
  for (int i = 0; i < 3; ++i) axis[i] = V3d(m[i][0], m[i][1], m[i][2]);
  const double length = axis[0].length();
  constexpr double tolerance = 1e-3;  // exporters write few digits
  for (int i = 0; i < 3; ++i)
    if (!(std::abs(axis[i].length() - length) <= tolerance * length) ||
        !(std::abs(axis[i].dot(axis[(i + 1) % 3])) <= tolerance * length * length))
      throw Error(p.where("to_world"), "the surroundings' transform is not a rotation",
                  "remove the shear, or make its scale the same on all axes");
  return m;
}

std::filesystem::path file_of(Properties& p, const MitsubaTree& tree, std::string_view name) {
  const XmlNode* node = p.element(name, {"string"});
  if (!node)
    throw Error(p.where(), p.object().tag + " '" + p.type() + "' has no '" + std::string(name) + "'",
                "name the file");
  return find_file(tree, *node, node->get("value"));
}

Emitter read_point(Properties& p, const Context& context) {
  if (p.has("position") && p.has("to_world"))
    throw Error(p.where("position"), "both 'position' and 'to_world' are given", "give one of them");
  PointLight light;
  light.intensity = color_or(p, "intensity", C3f(1.0f));
  light.frame = light_frame(invertible_transform(p));
  light.position =
      p.has("position") ? V3f(p.point("position", V3d(0.0)) - context.tree.origin) : light.frame.position;
  if (p.has("ies_file"))
    light.profile = std::make_shared<const IesProfile>(read_ies(file_of(p, context.tree, "ies_file")));
  return light;
}

Emitter read_spot(Properties& p, const Context& context) {
  SpotLight light;
  light.intensity = color_or(p, "intensity", C3f(1.0f));
  const double cutoff = number_within(p, "cutoff_angle", 20.0, 1e-6, 89.999, "above 0 and below 90 degrees");
  const double beam = number_within(p, "beam_width", 0.75 * cutoff, 0.0, cutoff, "from 0 to 'cutoff_angle'");
  light.cutoff_angle = static_cast<float>(cutoff * pi / 180.0);
  light.beam_width = static_cast<float>(beam * pi / 180.0);
  light.frame = light_frame(invertible_transform(p));
  if (const XmlNode* texture = p.element("texture", {"texture"}))
    light.texture = std::make_shared<const Texture>(context.textures.of(*texture, ColorUse::emission));
  return light;
}

Emitter read_directional(Properties& p, const Context&) {
  if (p.has("direction") && p.has("to_world"))
    throw Error(p.where("direction"), "both 'direction' and 'to_world' are given", "give one of them");
  DirectionalLight light;
  light.irradiance = color_or(p, "irradiance", C3f(1.0f));
  const V3d forward(light_frame(invertible_transform(p)).forward);
  const V3d direction = p.point("direction", forward);
  if (!(direction.length() > 0.0)) throw Error(p.where("direction"), "a direction of no length", "correct it");
  light.direction = V3f(direction.normalized());
  return light;
}

/// Tangent of half the horizontal field of view of a picture, by Mitsuba's conventions for cameras.
float tan_half_fov(Properties& p, double aspect) {
  const std::optional<double> fov = p.number("fov");
  if (!fov) throw Error(p.where(), "emitter 'projector' has no 'fov'", "give it, in degrees");
  if (!(*fov > 0.0 && *fov < 180.0))
    throw Error(p.where("fov"), "'fov' must lie between 0 and 180 degrees", "correct it");
  const std::string name = p.text("fov_axis").value_or("x");
  FovAxis axis = value_of_name<FovAxis>(fov_axis_names, name, p.where("fov_axis"), "fov_axis");
  if (axis == FovAxis::smaller) axis = aspect <= 1.0 ? FovAxis::x : FovAxis::y;
  if (axis == FovAxis::larger) axis = aspect > 1.0 ? FovAxis::x : FovAxis::y;
  const double half = std::tan(*fov * pi / 360.0);
  if (axis == FovAxis::y) return static_cast<float>(half * aspect);
  if (axis == FovAxis::diagonal) return static_cast<float>(half * aspect / std::hypot(aspect, 1.0));
  return static_cast<float>(half);
}

Emitter read_projector(Properties& p, const Context& context) {
  Projector light;
  light.texture = std::make_shared<const Texture>(
      context.textures.property(p, "irradiance", ColorUse::emission).value_or(C3f(1.0f)));
  light.scale = scale_of(p, "scale");
  light.tan_half_fov = tan_half_fov(p, static_cast<double>(aspect_of(*light.texture)));
  light.frame = light_frame(invertible_transform(p));
  return light;
}

Emitter read_constant(Properties& p, const Context&) {
  p.ignore({"to_world"});  // the same from all directions
  return Environment(color_or(p, "radiance", C3f(1.0f)));
}

Emitter read_envmap(Properties& p, const Context& context) {
  EnvironmentMapOptions options;
  options.scale = scale_of(p, "scale");
  options.to_world = rotation(p);
  options.mis_compensation = p.boolean("mis_compensation", false);
  return read_environment_map(file_of(p, context.tree, "filename"), options);
}

/// The sun's direction in the frame of the sky, from place and time.
V3d read_sun_time(Properties& p) {
  SunTime time;
  for (const auto& [name, value] : {std::pair{"latitude", &time.latitude},
                                    {"longitude", &time.longitude},
                                    {"timezone", &time.timezone},
                                    {"hour", &time.hour},
                                    {"minute", &time.minute},
                                    {"second", &time.second}})
    *value = number_within(p, name, *value, -1e6, 1e6, "a number");
  for (const auto& [name, value] : {std::pair{"year", &time.year}, {"month", &time.month}, {"day", &time.day}})
    *value = p.integer(name).value_or(*value);
  if (time.year < 1000 || time.year > 9999 || time.month < 1 || time.month > 12 || time.day < 1 ||
      time.day > 31)
    throw Error(p.where("day"), "there is no such day", "correct year, month or day");
  return sun_direction(time);
}

Emitter read_sunsky(Properties& p, const Context&) {
  SunSkyOptions options;
  options.turbidity = number_within(p, "turbidity", 3.0, 1.0, 10.0, "from 1 to 10");
  options.albedo = p.color("albedo", ColorUse::reflectance).value_or(C3f(0.3f));
  options.sun_scale = scale_of(p, "sun_scale");
  options.sky_scale = scale_of(p, "sky_scale");
  options.sun_aperture = number_within(p, "sun_aperture", 0.5358, 1e-3, 179.0, "above 0 and below 180 degrees");
  options.complex_sun = p.boolean("complex_sun", false);
  options.to_world = rotation(p);
  if (p.has("sun_direction")) {
    for (const char* name :
         {"latitude", "longitude", "timezone", "year", "month", "day", "hour", "minute", "second"})
      if (p.has(name))
        throw Error(p.where(name), std::string("both 'sun_direction' and '") + name + "' are given",
                    "give the direction, or place and time");
    options.sun_direction = p.point("sun_direction", V3d(0.0));
    if (!(options.sun_direction.length() > 0.0))
      throw Error(p.where("sun_direction"), "a direction of no length", "correct it");
  } else {
    options.to_world.multDirMatrix(read_sun_time(p), options.sun_direction);
  }
  return Environment(std::make_shared<const SunSky>(options));
}

using Reader = Emitter (*)(Properties&, const Context&);

constexpr Named<Reader> readers[] = {
    {"constant", read_constant}, {"directional", read_directional}, {"envmap", read_envmap},
    {"point", read_point},       {"projector", read_projector},     {"spot", read_spot},
    {"sunsky", read_sunsky},
};

}  // namespace

Emitter read_mitsuba_emitter(const XmlNode& node, const MitsubaTree& tree, MitsubaTextures& textures) {
  const Reader reader = plugin_of_type<Reader>(readers, node);
  Properties p(node, tree);
  p.stand_in_world();
  Emitter emitter = reader(p, {tree, textures});
  p.ignore({"sampling_weight", "light_group"});  // how often a light is chosen does not change what it does
  p.finish();
  return emitter;
}

std::string light_group_of(const XmlNode& node, const MitsubaTree& tree) {
  Properties p(node, tree);
  return p.text("light_group").value_or(p.id_or(""));
}

Environment read_environment_map(const std::filesystem::path& path, const EnvironmentMapOptions& options) {
  return Environment(std::make_shared<const EnvironmentMap>(read_picture(path), options, path.string()));
}

}  // namespace twopass
