#include "render/load/mitsuba_sensor.h"

#include <array>
#include <cstdio>

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
  const FilterKind kind = plugin_of_type<FilterKind>(filter_names(), node);
  Properties p(node, tree);
  const auto number = [&](std::string_view name, double otherwise, double least, double most) {
    const double value = p.number(name).value_or(otherwise);
    if (!(value >= least && value <= most)) {
      char text[80];
      std::snprintf(text, sizeof text, "' must be from %g to %g", least, most);
      throw Error(p.where(name), "'" + std::string(name) + text, "correct it");
    }
    return static_cast<float>(value);
  };
  const auto length = [&](std::string_view name, double otherwise) {
    return number(name, otherwise, 1e-3, 100.0);  // pixels
  };
  Filter filter;
  switch (kind) {
    case FilterKind::box:
      filter = box_filter(length("radius", 0.5));
      break;
    case FilterKind::tent:
      filter = tent_filter(length("radius", 1.0));
      break;
    case FilterKind::gaussian:
      filter = gaussian_filter(length("stddev", 0.5));
      break;
    case FilterKind::mitchell: {
      // Versions below 2 write b and c; upgrading makes all names lower case.
      const std::string_view b = p.has("b") ? "b" : "B", c = p.has("c") ? "c" : "C";
      filter = mitchell_filter(number(b, 1.0 / 3.0, -10.0, 10.0), number(c, 1.0 / 3.0, -10.0, 10.0));
      break;
    }
    case FilterKind::catmullrom:
      filter = catmullrom_filter();
      break;
    case FilterKind::lanczos: {
      const int lobes = p.integer("lobes").value_or(3);
      if (lobes < 1 || lobes > 16) throw Error(p.where("lobes"), "'lobes' must be from 1 to 16", "correct it");
      filter = lanczos_filter(lobes);
      break;
    }
  }
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

std::optional<PixelWindow> read_crop(Properties& p, int width, int height) {
  PixelWindow crop;
  crop.corner = {p.integer("crop_offset_x").value_or(0), p.integer("crop_offset_y").value_or(0)};
  crop.size = {p.integer("crop_width").value_or(width), p.integer("crop_height").value_or(height)};
  const auto check = [&](const char* offset_name, const char* size_name, int offset, int size, int whole) {
    if (offset < 0 || offset >= whole)
      throw Error(p.where(offset_name), "the crop window begins outside of the picture",
                  "give an offset from 0 to " + std::to_string(whole - 1));
    if (size < 1 || size > whole - offset)
      throw Error(p.where(p.has(size_name) ? size_name : offset_name),
                  "the crop window reaches beyond the picture",
                  "give a " + std::string(size_name) + " from 1 to " + std::to_string(whole - offset));
  };
  check("crop_offset_x", "crop_width", crop.corner.x, crop.size.x, width);
  check("crop_offset_y", "crop_height", crop.corner.y, crop.size.y, height);
  if (crop.size == V2i(width, height)) return std::nullopt;
  return crop;
}

void read_film(const XmlNode& node, const MitsubaTree& tree, FileSettings& settings, Notes& notes) {
  require_one_of(std::array<std::string_view, 1>{"hdrfilm"}, node);
  Properties p(node, tree);
  settings.width = read_extent(p, "width", settings.width);
  settings.height = read_extent(p, "height", settings.height);
  settings.crop = read_crop(p, settings.width, settings.height);
  // Wishes about the file: its format is what -o says, and its channels are ours.
  accept_text(p, "file_format", {"openexr", "exr", "rgbe", "pfm"});
  accept_text(p, "component_format", {"float16", "float32", "uint32"});
  accept_text(p, "pixel_format", {"rgb", "rgba", "luminance", "luminance_alpha", "xyz", "xyza"});
  if (const auto format = p.text("component_format")) settings.half = *format == "float16";
  const auto note = [&](std::string_view name, std::initializer_list<std::string_view> honoured,
                        const char* what) {
    const std::optional<std::string> wish = p.text(name);
    if (wish && std::ranges::find(honoured, *wish) == honoured.end())
      notes.add(p.where(name) + ": " + std::string(name) + " '" + *wish + "': " + what);
  };
  note("file_format", {"openexr", "exr"}, "the format is what -o names");
  note("component_format", {"float16", "float32"}, "the picture is written as float32");
  note("pixel_format", {"rgb", "rgba"}, "the picture is written as RGB and alpha");
  // Our pixels always have samples from beyond the border, which is what sample_border asks for; the rest is of
  // other variants of the program and of the old one.
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

/// Orthographic cameras may be scaled along their axes.
void check_not_sheared(const M44d& m, const std::string& where) {
  V3d rows[3];
  for (int i = 0; i < 3; ++i) {
    rows[i] = V3d(m[i][0], m[i][1], m[i][2]);
    if (!(rows[i].length() > 0.0))
      throw Error(where, "the camera's transform is singular", "scale by numbers above 0");
    rows[i].normalize();
  }
  for (int i = 0; i < 3; ++i)
    if (!(std::abs(rows[i].dot(rows[(i + 1) % 3])) <= 1e-3))
      throw Error(where, "the camera's transform is sheared", "use rotations, translations and scales");
}

void read_clipping(Properties& p, CameraDescription& camera) {
  camera.near_clip = p.number("near_clip").value_or(1e-2);
  camera.far_clip = p.number("far_clip").value_or(1e4);
  if (!(camera.near_clip >= 0.0))
    throw Error(p.where("near_clip"), "'near_clip' must not be negative", "correct it");
  if (!(camera.far_clip > camera.near_clip))
    throw Error(p.where(p.has("far_clip") ? "far_clip" : "near_clip"),
                "'far_clip' must be larger than 'near_clip'", "correct one of them");
}

void read_lens(Properties& p, CameraDescription& camera) {
  const std::optional<double> radius = p.number("aperture_radius");
  if (!radius)
    throw Error(p.where(), "sensor 'thinlens' has no aperture_radius",
                "add it: <float name=\"aperture_radius\" .../>");
  if (!(*radius >= 0.0))
    throw Error(p.where("aperture_radius"), "'aperture_radius' must not be negative", "correct it");
  camera.aperture_radius = *radius;
  camera.focus_distance = p.number("focus_distance").value_or(camera.far_clip);
  if (!(camera.focus_distance > 0.0))
    throw Error(p.where("focus_distance"), "'focus_distance' must be above 0", "correct it");
}

}  // namespace

CameraDescription read_mitsuba_sensor(const XmlNode& node, const MitsubaTree& tree, FileSettings& settings,
                                      Notes& notes) {
  require_one_of(std::array<std::string_view, 3>{"perspective", "thinlens", "orthographic"}, node);
  Properties p(node, tree);
  p.stand_in_world();
  CameraDescription camera;
  camera.to_world = p.transform("to_world");
  read_clipping(p, camera);
  if (p.type() == "orthographic") {
    camera.projection = Projection::orthographic;
    check_not_sheared(camera.to_world, p.where("to_world"));
  } else {
    check_rigid(camera.to_world, p.where("to_world"));
    read_field_of_view(p, camera);
  }
  if (p.type() == "thinlens") read_lens(p, camera);
  if (p.type() == "perspective") {
    camera.principal_point_offset = {p.number("principal_point_offset_x").value_or(0.0),
                                     p.number("principal_point_offset_y").value_or(0.0)};
  }
  // Without a lens everything is sharp, and nothing moves.
  p.ignore({"focus_distance", "shutter_open", "shutter_close"});
  if (const XmlNode* film = p.object_of("film")) read_film(*film, tree, settings, notes);
  if (const XmlNode* sampler = p.object_of("sampler")) read_sampler(*sampler, tree, settings, notes);
  p.finish();
  return camera;
}

namespace {

/// The integrator inside of those that only add outputs to it; nullptr where there is none.
const XmlNode* unwrap(const XmlNode& node, const MitsubaTree& tree, Notes& notes) {
  constexpr std::string_view wrappers[] = {"aov", "merge", "moment"};
  const XmlNode* inner = &node;
  while (std::ranges::find(wrappers, inner->get("type")) != std::end(wrappers)) {
    Properties p(*inner, tree);
    const std::vector<const XmlNode*> nested = p.objects("integrator");
    const std::string what = inner->where() + ": integrator '" + p.type() + "': ";
    if (const auto aovs = p.text("aovs")) notes.add(what + "its outputs '" + *aovs + "' are not written");
    if (nested.size() > 1) notes.add(what + "of the integrators in it the first is used");
    p.ignore_rest();
    if (nested.empty()) {
      notes.add(what + "there is none in it: rendering with the default");
      return nullptr;
    }
    inner = nested.front();
  }
  return inner;
}

}  // namespace

void read_mitsuba_integrator(const XmlNode& outer, const MitsubaTree& tree, FileSettings& settings,
                             Notes& notes) {
  constexpr std::array<std::string_view, 5> ours = {"twopass", "unbiased", "path", "radiosity", "direct"};
  const XmlNode* node = unwrap(outer, tree, notes);
  if (!node) return;
  Properties p(*node, tree);
  const std::string& type = p.type();
  const bool is_ours = std::ranges::find(ours, type) != ours.end();
  if (is_ours)
    settings.integrator = type;
  else
    notes.add(node->where() + ": integrator '" + type +
              "' is not known here: rendering with the default (--integrator chooses another)");

  settings.max_depth = p.integer("max_depth").value_or(settings.max_depth);
  if (settings.max_depth < -1)
    throw Error(p.where("max_depth"), "'max_depth' must be -1 (unlimited) or more", "correct it");
  settings.rr_depth = p.integer("rr_depth").value_or(settings.rr_depth);
  if (settings.rr_depth < 1) throw Error(p.where("rr_depth"), "'rr_depth' must be at least 1", "correct it");
  settings.hide_emitters = p.boolean("hide_emitters", settings.hide_emitters);
  p.ignore({"block_size", "samples_per_pass", "timeout", "strict_normals", "shading_samples", "emitter_samples",
            "bsdf_samples"});
  // Somebody else's integrator has properties that we cannot know.
  if (!is_ours) p.ignore_rest();
  p.finish();
}

}  // namespace twopass
