#include "render/load/mitsuba_sensor.h"

#include <array>

#include "render/core/error.h"
#include "render/load/mitsuba_properties.h"
#include "render/load/number.h"

namespace twopass {
namespace {

template <std::size_t N>
void require_one_of(const std::array<std::string_view, N>& known, const XmlNode& node) {
  for (const std::string_view name : known)
    if (name == node.get("type")) return;
  unsupported_plugin(node, known);
}

Filter read_filter(const XmlNode& node, const MitsubaTree& tree) {
  constexpr Named<FilterKind> kinds[] = {
      {"box", FilterKind::box}, {"tent", FilterKind::tent}, {"gaussian", FilterKind::gaussian}};
  const FilterKind kind = plugin_of_type<FilterKind>(kinds, node);
  Properties p(node, tree);
  const auto length = [&](std::string_view name, double otherwise) {
    const double value = p.number(name).value_or(otherwise);
    if (!(value > 0.0) || value > 100.0)
      throw Error(p.where(name), "'" + std::string(name) + "' must be above 0 and at most 100 pixels",
                  "correct it");
    return static_cast<float>(value);
  };
  Filter filter;
  if (kind == FilterKind::box) filter = box_filter(length("radius", 0.5));
  if (kind == FilterKind::tent) filter = tent_filter(length("radius", 1.0));
  if (kind == FilterKind::gaussian) filter = gaussian_filter(length("stddev", 0.5));
  p.finish();
  return filter;
}

int read_extent(Properties& p, std::string_view name, int otherwise) {
  const int value = p.integer(name).value_or(otherwise);
  if (value < 1 || value > 65536)
    throw Error(p.where(name), "'" + std::string(name) + "' must be from 1 to 65536", "correct it");
  return value;
}

/// Throws unless the property is absent or has one of the values.
void accept_text(Properties& p, std::string_view name, std::initializer_list<std::string_view> values) {
  const std::optional<std::string> given = p.text(name);
  if (!given || std::ranges::find(values, *given) != values.end()) return;
  throw Error(p.where(name), std::string(name) + " '" + *given + "' is not supported",
              "supported: " + join_names({values.begin(), values.size()}));
}

void read_film(const XmlNode& node, const MitsubaTree& tree, FileSettings& settings, Notes& notes) {
  require_one_of(std::array<std::string_view, 1>{"hdrfilm"}, node);
  Properties p(node, tree);
  settings.width = read_extent(p, "width", settings.width);
  settings.height = read_extent(p, "height", settings.height);
  const bool is_cropped = p.integer("crop_offset_x").value_or(0) != 0 ||
                          p.integer("crop_offset_y").value_or(0) != 0 ||
                          p.integer("crop_width").value_or(settings.width) != settings.width ||
                          p.integer("crop_height").value_or(settings.height) != settings.height;
  if (is_cropped) throw Error(p.where(), "a cropped film is not supported", "remove the crop_ properties");
  accept_text(p, "file_format", {"openexr", "exr"});
  accept_text(p, "component_format", {"float16", "float32"});
  if (const auto format = p.text("component_format")) settings.half = *format == "float16";
  accept_text(p, "pixel_format", {"rgb", "rgba", "luminance", "luminance_alpha", "xyz", "xyza"});
  if (const auto format = p.text("pixel_format"); format && *format != "rgb" && *format != "rgba")
    notes.add(p.where("pixel_format") + ": pixel_format '" + *format + "': the picture is written as RGB");
  // What remains concerns borders that our filtering does not need, and the old program's files.
  p.ignore({"sample_border", "compensate", "banner", "attach_log", "high_quality_edges", "gamma"});
  if (const XmlNode* filter = p.object_of("rfilter")) settings.filter = read_filter(*filter, tree);
  p.finish();
}

void read_sampler(const XmlNode& node, const MitsubaTree& tree, FileSettings& settings, Notes& notes) {
  require_one_of(std::array<std::string_view, 9>{"independent", "stratified", "multijitter", "orthogonal",
                                                 "ldsampler", "halton", "hammersley", "sobol", "padded_sobol"},
                 node);
  Properties p(node, tree);
  if (p.type() != "independent")
    notes.add(node.where() + ": sampler '" + p.type() +
              "': ours is used instead, with its sample count and seed (--sampler chooses another)");
  if (const auto count = p.integer("sample_count")) {
    if (*count < 1) throw Error(p.where("sample_count"), "'sample_count' must be at least 1", "correct it");
    settings.samples_per_pixel = *count;
  }
  if (const auto seed = p.integer("seed")) settings.seed = static_cast<std::uint32_t>(*seed);
  p.ignore({"jitter", "strength", "scramble", "dimension"});
  p.finish();
}

/// "50mm" on 36 x 24 mm film, along the diagonal.
double fov_of_focal_length(const std::string& text, const Properties& p) {
  std::string_view number = text;
  if (number.ends_with("mm")) number.remove_suffix(2);
  while (number.ends_with(' ')) number.remove_suffix(1);
  const auto length = parse_number(number);
  if (!length || !(*length > 0.0))
    throw Error(p.where("focal_length"), "'" + text + "' is not a focal length", "write e.g. \"50mm\"");
  return 2.0 * std::atan(std::hypot(36.0, 24.0) / (2.0 * *length)) * 180.0 / pi;
}

void read_field_of_view(Properties& p, CameraDescription& camera) {
  const std::optional<double> fov = p.number("fov");
  const std::optional<std::string> focal_length = p.text("focal_length"), axis = p.text("fov_axis");
  if (fov && focal_length)
    throw Error(p.where("fov"), "both 'fov' and 'focal_length' are given", "give one of them");
  if (fov) {
    if (!(*fov > 0.0 && *fov < 180.0))
      throw Error(p.where("fov"), "'fov' must lie between 0 and 180 degrees", "correct it");
    camera.fov_degrees = *fov;
    camera.fov_axis = FovAxis::x;
    if (axis) camera.fov_axis = value_of_name<FovAxis>(fov_axis_names, *axis, p.where("fov_axis"), "fov_axis");
    return;
  }
  if (axis) throw Error(p.where("fov_axis"), "'fov_axis' without 'fov'", "give fov, or remove it");
  camera.fov_degrees = fov_of_focal_length(focal_length.value_or("50mm"), p);
  camera.fov_axis = FovAxis::diagonal;
}

void check_rigid(const M44d& m, const std::string& where) {
  const V3d r0(m[0][0], m[0][1], m[0][2]), r1(m[1][0], m[1][1], m[1][2]), r2(m[2][0], m[2][1], m[2][2]);
  constexpr double tolerance = 1e-3;  // exporters write few digits
  for (const V3d& row : {r0, r1, r2})
    if (!(std::abs(row.length() - 1.0) <= tolerance))
      throw Error(where, "the camera's transform contains a scale",
                  "remove it: it would change the field of view");
  if (!(std::abs(r0.dot(r1)) <= tolerance && std::abs(r1.dot(r2)) <= tolerance &&
        std::abs(r2.dot(r0)) <= tolerance))
    throw Error(where, "the camera's transform is sheared", "use rotations and translations");
}

}  // namespace

CameraDescription read_mitsuba_sensor(const XmlNode& node, const MitsubaTree& tree, FileSettings& settings,
                                      ClipPlanes& clip, Notes& notes) {
  require_one_of(std::array<std::string_view, 1>{"perspective"}, node);
  Properties p(node, tree);
  CameraDescription camera;
  camera.to_world = p.transform("to_world");
  check_rigid(camera.to_world, p.where("to_world"));
  read_field_of_view(p, camera);
  for (const std::string_view name : {"principal_point_offset_x", "principal_point_offset_y"})
    if (p.number(name).value_or(0.0) != 0.0)
      throw Error(p.where(name), "'" + std::string(name) + "' other than 0 is not supported", "set it to 0");
  clip.near = p.number("near_clip").value_or(0.0);
  clip.far = p.number("far_clip").value_or(infinity_f);
  clip.where = p.where(p.has("far_clip") ? "far_clip" : "near_clip");
  // A pinhole is sharp at all distances, and nothing moves.
  p.ignore({"focus_distance", "shutter_open", "shutter_close"});
  if (const XmlNode* film = p.object_of("film")) read_film(*film, tree, settings, notes);
  if (const XmlNode* sampler = p.object_of("sampler")) read_sampler(*sampler, tree, settings, notes);
  p.finish();
  return camera;
}

void read_mitsuba_integrator(const XmlNode& node, const MitsubaTree& tree, FileSettings& settings,
                             Notes& notes) {
  constexpr std::array<std::string_view, 5> ours = {"twopass", "unbiased", "path", "radiosity", "direct"};
  Properties p(node, tree);
  const std::string& type = p.type();
  const bool is_ours = std::ranges::find(ours, type) != ours.end();
  const bool is_volumetric = type == "volpath" || type == "volpathmis";
  if (is_ours)
    settings.integrator = type;
  else if (is_volumetric)
    settings.integrator = "path";  // media are refused, and without media these are path tracers
  else
    notes.add(node.where() + ": integrator '" + type + "' is unknown: rendering with the default");

  settings.max_depth = p.integer("max_depth").value_or(settings.max_depth);
  if (settings.max_depth < -1)
    throw Error(p.where("max_depth"), "'max_depth' must be -1 (unlimited) or more", "correct it");
  settings.rr_depth = p.integer("rr_depth").value_or(settings.rr_depth);
  if (settings.rr_depth < 1) throw Error(p.where("rr_depth"), "'rr_depth' must be at least 1", "correct it");
  settings.hide_emitters = p.boolean("hide_emitters", settings.hide_emitters);
  p.ignore({"block_size", "samples_per_pass", "timeout", "strict_normals", "use_spectral_mis",
            "shading_samples", "emitter_samples", "bsdf_samples"});
  // Somebody else's integrator has properties that we cannot know.
  if (!is_ours && !is_volumetric) p.ignore_rest();
  p.finish();
}

}  // namespace twopass
