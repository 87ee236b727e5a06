#include "render/image/color.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string_view>
#include <vector>

#include <OpenColorIO/OpenColorIO.h>

#include "render/core/error.h"
#include "render/image/color_config.h"

namespace ocio = OCIO_NAMESPACE;

namespace twopass {
namespace {

constexpr float largest_half = 65504.0f;

struct NamedConfig {
  ocio::ConstConfigRcPtr config;
  std::string name;    // for messages and metadata
  std::string origin;  // the option or variable that chose it
};

NamedConfig built_in() {
  std::istringstream text{std::string(builtin_ocio_config())};
  return {ocio::Config::CreateFromStream(text), "built-in", "built-in"};
}

// The user's word first, then the environment's, then ours. A chosen configuration that cannot be read is an
// error: falling back would silently change the look of every frame.
NamedConfig load_config(const std::string& path) {
  const char* environment = std::getenv("OCIO");
  const bool explicitly = !path.empty();
  const std::string file = explicitly ? path : environment != nullptr ? environment : "";
  // The library's own name for a default configuration; versions before 2.2 contain none, so ours stands in.
  if (file.empty() || (file == "ocio://default" && OCIO_VERSION_HEX < 0x02020000)) return built_in();
  const std::string origin = explicitly ? "--ocio" : "$OCIO";
  try {
    NamedConfig named{ocio::Config::CreateFromFile(file.c_str()), file, origin};
    named.config->validate();
    return named;
  } catch (const ocio::Exception& e) {
    throw Error(
        origin + " " + file, std::string("the OpenColorIO configuration cannot be used: ") + e.what(),
        explicitly ? "give the name of a valid configuration" : "correct $OCIO, unset it or give --ocio");
  }
}

std::vector<std::string> displays_of(const ocio::Config& config) {
  std::vector<std::string> names;
  for (int i = 0; i < config.getNumDisplays(); ++i) names.emplace_back(config.getDisplay(i));
  return names;
}

std::vector<std::string> views_of(const ocio::Config& config, const std::string& display) {
  std::vector<std::string> names;
  for (int i = 0; i < config.getNumViews(display.c_str()); ++i)
    names.emplace_back(config.getView(display.c_str(), i));
  return names;
}

// `wanted`, or the default when it is empty; an error that lists `known` when it is not among them.
std::string choose(const std::string& wanted, const char* fallback, const std::vector<std::string>& known,
                   const std::string& option, const std::string& config) {
  const std::string name = wanted.empty() ? fallback : wanted;
  if (std::find(known.begin(), known.end(), name) != known.end()) return name;
  std::vector<std::string_view> views(known.begin(), known.end());
  throw Error(option, "the OpenColorIO configuration " + config + " has no '" + name + "'",
              known.empty() ? "choose another configuration" : "use one of: " + join_names(views));
}

// The name of linear Rec.709 in a configuration, or empty. Those of the Color Interop Forum, the ASWF,
// ACES 1.0.3 to 1.2 and Blender; lookup ignores case and knows aliases.
std::string linear_rec709_of(const ocio::Config& config) {
  constexpr std::array<const char*, 9> usual{
      "lin_rec709_scene",        "lin_rec709_srgb",  "lin_rec709",
      "Linear Rec.709 (sRGB)",   "Linear Rec.709",   "Utility - Linear - Rec.709",
      "Utility - Linear - sRGB", "Linear - Rec.709", "lin_srgb"};
  for (const char* name : usual)
    if (config.getColorSpace(name) != nullptr) return name;
  return {};
}

void append_builtin(ocio::GroupTransform& group, const char* style, ocio::TransformDirection direction) {
  const ocio::BuiltinTransformRcPtr transform = ocio::BuiltinTransform::Create();
  transform->setStyle(style);
  transform->setDirection(direction);
  group.appendTransform(transform);
}

// The space through which a configuration is reached that does not name linear Rec.709: ACES2065-1.
const char* interchange_of(const NamedConfig& named) {
  if (!named.config->hasRole(ocio::ROLE_INTERCHANGE_SCENE))
    throw Error(named.origin + " " + named.name,
                "it neither names linear Rec.709 (lin_rec709_scene) nor has the role aces_interchange",
                "add the role to the configuration or choose another one");
  return ocio::ROLE_INTERCHANGE_SCENE;
}

// From our pixels to the display: the space they are in, by name or through ACES2065-1, then looks, then the
// view.
ocio::ConstTransformRcPtr make_transform(const NamedConfig& named, const std::string& display,
                                         const std::string& view, const DisplayOptions& options) {
  const ocio::GroupTransformRcPtr group = ocio::GroupTransform::Create();
  std::string source = options.working_space.empty() ? linear_rec709_of(*named.config) : options.working_space;
  if (source.empty()) {
    source = interchange_of(named);
    append_builtin(*group, "UTILITY - ACES-AP1_to_LINEAR-REC709_BFD", ocio::TRANSFORM_DIR_INVERSE);
    append_builtin(*group, "ACEScg_to_ACES2065-1", ocio::TRANSFORM_DIR_FORWARD);
  }
  if (!options.look.empty()) {
    const ocio::LookTransformRcPtr look = ocio::LookTransform::Create();
    look->setSrc(source.c_str());
    look->setDst(source.c_str());
    look->setLooks(options.look.c_str());
    group->appendTransform(look);
  }
  const ocio::DisplayViewTransformRcPtr to_display = ocio::DisplayViewTransform::Create();
  to_display->setSrc(source.c_str());
  to_display->setDisplay(display.c_str());
  to_display->setView(view.c_str());
  group->appendTransform(to_display);
  return group;
}

// The way back: from a named space to our pixels.
ocio::ConstTransformRcPtr make_input_transform(const NamedConfig& named, const std::string& color_space) {
  const ocio::GroupTransformRcPtr group = ocio::GroupTransform::Create();
  const std::string rec709 = linear_rec709_of(*named.config);
  const ocio::ColorSpaceTransformRcPtr transform = ocio::ColorSpaceTransform::Create();
  transform->setSrc(color_space.c_str());
  transform->setDst(rec709.empty() ? interchange_of(named) : rec709.c_str());
  group->appendTransform(transform);
  if (rec709.empty()) {
    append_builtin(*group, "ACEScg_to_ACES2065-1", ocio::TRANSFORM_DIR_INVERSE);
    append_builtin(*group, "UTILITY - ACES-AP1_to_LINEAR-REC709_BFD", ocio::TRANSFORM_DIR_FORWARD);
  }
  return group;
}

std::string describe(const NamedConfig& named, const std::string& display, const std::string& view,
                     const DisplayOptions& options) {
  std::ostringstream text;
  text << "config " << named.name << ", display " << display << ", view " << view;
  if (!options.look.empty()) text << ", look " << options.look;
  if (!options.working_space.empty()) text << ", working space " << options.working_space;
  text << ", exposure " << options.exposure_stops;
  return text.str();
}

std::vector<std::string> looks_of(const ocio::Config& config) {
  std::vector<std::string> names;
  for (int i = 0; i < config.getNumLooks(); ++i) names.emplace_back(config.getLookNameByIndex(i));
  return names;
}

std::vector<std::string> color_spaces_of(const ocio::Config& config) {
  std::vector<std::string> names;
  for (int i = 0; i < config.getNumColorSpaces(); ++i) names.emplace_back(config.getColorSpaceNameByIndex(i));
  return names;
}

// Throws when a configuration has no space of this name, alias or role.
void check_color_space(const NamedConfig& named, const std::string& name, std::string_view where,
                       std::string_view remedy) {
  if (named.config->getColorSpace(name.c_str()) != nullptr) return;
  const std::vector<std::string> known = color_spaces_of(*named.config);
  const std::vector<std::string_view> views(known.begin(), known.end());
  throw Error(where,
              "the OpenColorIO configuration " + named.name + " has no colour space '" + name +
                  "', nor such an alias or role",
              "use one of: " + join_names(views) + std::string(remedy));
}

C3f through(const ocio::ConstCPUProcessorRcPtr& processor, const C3f& color) {
  float rgb[3] = {color.x, color.y, color.z};
  processor->applyRGB(rgb);
  return {rgb[0], rgb[1], rgb[2]};
}

// The matrix of a transform; throws when it is not linear.
ColorMatrix matrix_of(const ocio::ConstCPUProcessorRcPtr& processor, const std::string& space) {
  const ColorMatrix matrix{{through(processor, C3f(1.0f, 0.0f, 0.0f)),
                            through(processor, C3f(0.0f, 1.0f, 0.0f)),
                            through(processor, C3f(0.0f, 0.0f, 1.0f))}};
  for (const C3f& color : {C3f(0.18f), C3f(0.02f, 0.3f, 0.7f), C3f(40.0f, 4.0f, 16.0f)}) {
    const C3f expected = matrix.image[0] * color.x + matrix.image[1] * color.y + matrix.image[2] * color.z;
    const C3f found = through(processor, color);
    for (int c = 0; c < 3; ++c)
      if (!(std::abs(found[c] - expected[c]) <= 1e-4f * max_component(color)))
        throw Error("--working-space", "the colour space '" + space + "' is not linear",
                    "give a scene-linear one, such as ACEScg");
  }
  return matrix;
}

// One value that is not finite would turn its whole pixel into NaN in the ACES views, and huge ones wrap to
// black.
float sanitized(float value) {
  return std::isfinite(value) ? std::clamp(value, -largest_half, largest_half) : 0.0f;
}

}  // namespace

WorkingSpace find_working_space(const std::string& name, const std::string& config) {
  if (name.empty()) return {};
  const NamedConfig named = load_config(config);
  check_color_space(named, name, "--working-space", "; or choose another configuration with --ocio");
  const ocio::ConstColorSpaceRcPtr found = named.config->getColorSpace(name.c_str());
  if (found->isData())
    throw Error("--working-space", "the colour space '" + name + "' is for data, not for light",
                "give a scene-linear one, such as ACEScg");
  try {
    const ocio::ConstTransformRcPtr to_rec709 = make_input_transform(named, name);
    const auto processor = [&](ocio::TransformDirection direction) {
      return named.config->getProcessor(to_rec709, direction)->getDefaultCPUProcessor();
    };
    WorkingSpace space{found->getName(),
                       matrix_of(processor(ocio::TRANSFORM_DIR_INVERSE), name),
                       matrix_of(processor(ocio::TRANSFORM_DIR_FORWARD), name),
                       {}};
    space.interop_id = interop_id_of(space.from_rec709);
    return space;
  } catch (const ocio::Exception& e) {
    throw Error("--working-space " + name, "it cannot be used: " + std::string(e.what()),
                "check the configuration and the files it refers to");
  }
}

struct DisplayTransform::Impl {
  ocio::ConstCPUProcessorRcPtr processor;
  float scale = 1.0f;
  std::string display;
  std::string view;
  std::string description;
};

DisplayTransform::DisplayTransform(const DisplayOptions& options) : impl_(std::make_unique<Impl>()) {
  // 2^126 is the largest power whose inverse is still a normal number.
  if (!(std::abs(options.exposure_stops) <= 126.0f))
    throw Error("--exposure", "it is " + std::to_string(options.exposure_stops) + " stops",
                "give a number between -126 and 126");
  impl_->scale = std::exp2(options.exposure_stops);
  const NamedConfig named = load_config(options.config);
  const ocio::Config& config = *named.config;
  impl_->display =
      choose(options.display, config.getDefaultDisplay(), displays_of(config), "--display", named.name);
  impl_->view = choose(options.view, config.getDefaultView(impl_->display.c_str()),
                       views_of(config, impl_->display), "--view", named.name);
  if (!options.look.empty()) choose(options.look, "", looks_of(config), "--look", named.name);
  if (!options.working_space.empty()) check_color_space(named, options.working_space, "--working-space", "");
  impl_->description = describe(named, impl_->display, impl_->view, options);
  try {
    const ocio::ConstTransformRcPtr transform = make_transform(named, impl_->display, impl_->view, options);
    impl_->processor = config.getProcessor(transform)->getDefaultCPUProcessor();
  } catch (const ocio::Exception& e) {
    throw Error(named.origin + " " + named.name,
                "display '" + impl_->display + "', view '" + impl_->view + "' cannot be used: " + e.what(),
                "check the configuration and the files it refers to");
  }
}

DisplayTransform::~DisplayTransform() = default;
DisplayTransform::DisplayTransform(DisplayTransform&&) noexcept = default;
DisplayTransform& DisplayTransform::operator=(DisplayTransform&&) noexcept = default;

void DisplayTransform::apply(std::span<float> rgb) const {
  assert(rgb.size() % 3 == 0);
  if (rgb.empty()) return;
  for (float& value : rgb) value = sanitized(sanitized(value) * impl_->scale);
  ocio::PackedImageDesc pixels(rgb.data(), static_cast<long>(rgb.size() / 3), 1, 3);
  impl_->processor->apply(pixels);
  for (float& value : rgb) value = std::isfinite(value) ? std::clamp(value, 0.0f, 1.0f) : 0.0f;
}

struct ColorSpaceTransform::Impl {
  ocio::ConstCPUProcessorRcPtr processor;
};

ColorSpaceTransform::ColorSpaceTransform(const std::string& color_space, const std::string& config,
                                         std::string_view where)
    : impl_(std::make_unique<Impl>()) {
  const NamedConfig named = load_config(config);
  check_color_space(named, color_space, where, "; or choose another configuration with $OCIO");
  try {
    impl_->processor =
        named.config->getProcessor(make_input_transform(named, color_space))->getDefaultCPUProcessor();
  } catch (const ocio::Exception& e) {
    throw Error(where,
                "the colour space '" + color_space + "' of " + named.name + " cannot be used: " + e.what(),
                "check the configuration and the files it refers to");
  }
}

ColorSpaceTransform::~ColorSpaceTransform() = default;

void ColorSpaceTransform::apply(std::span<float> rgb) const {
  assert(rgb.size() % 3 == 0);
  if (rgb.empty()) return;
  ocio::PackedImageDesc pixels(rgb.data(), static_cast<long>(rgb.size() / 3), 1, 3);
  impl_->processor->apply(pixels);
}

const std::string& DisplayTransform::display() const { return impl_->display; }
const std::string& DisplayTransform::view() const { return impl_->view; }
const std::string& DisplayTransform::description() const { return impl_->description; }

}  // namespace twopass
