#include "render/image/denoise.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <dlfcn.h>

#include "render/core/error.h"

namespace twopass {
namespace {

// What oidn.h declares of what is used here, of versions 1 and 2: the same but for the names of the setters.
struct Library {
  using Handle = void*;
  Handle (*new_device)(int type);
  void (*commit_device)(Handle);
  void (*release_device)(Handle);
  int (*device_error)(Handle, const char** message);
  void (*set_device_int)(Handle, const char* name, int value);
  int (*device_int)(Handle, const char* name);
  Handle (*new_filter)(Handle device, const char* type);
  void (*set_image)(Handle filter, const char* name, void* pixels, int format, std::size_t width,
                    std::size_t height, std::size_t offset, std::size_t pixel_stride, std::size_t row_stride);
  void (*set_filter_bool)(Handle filter, const char* name, bool value);
  void (*commit_filter)(Handle);
  void (*execute_filter)(Handle);
  void (*release_filter)(Handle);
};

constexpr int cpu_device = 1, format_float3 = 3;
constexpr const char* option = "--denoise";

// The function of one of the names, the newer one first.
template <class Function>
void find(Function& function, void* library, std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (void* address = ::dlsym(library, name)) {
      function = reinterpret_cast<Function>(address);
      return;
    }
  throw Error(option, std::string("the library Intel Open Image Denoise lacks ") + *names.begin(),
              "install version 1.4 or later, or leave the option out");
}

// For the life of the process: it keeps threads that must not lose their code.
const Library& library() {
  static const Library loaded = [] {
    void* handle = nullptr;
    for (const char* name : {"libOpenImageDenoise.so.2", "libOpenImageDenoise.so.1"})
      if (handle = ::dlopen(name, RTLD_NOW | RTLD_LOCAL); handle != nullptr) break;
    if (handle == nullptr)
      throw Error(
          option,
          "Intel Open Image Denoise is not installed: neither libOpenImageDenoise.so.2 nor .so.1 is found",
          "install it, name its folder in LD_LIBRARY_PATH, or leave the option out");
    Library l{};
    find(l.new_device, handle, {"oidnNewDevice"});
    find(l.commit_device, handle, {"oidnCommitDevice"});
    find(l.release_device, handle, {"oidnReleaseDevice"});
    find(l.device_error, handle, {"oidnGetDeviceError"});
    find(l.set_device_int, handle, {"oidnSetDeviceInt", "oidnSetDevice1i"});
    find(l.device_int, handle, {"oidnGetDeviceInt", "oidnGetDevice1i"});
    find(l.new_filter, handle, {"oidnNewFilter"});
    find(l.set_image, handle, {"oidnSetSharedFilterImage"});
    find(l.set_filter_bool, handle, {"oidnSetFilterBool", "oidnSetFilter1b"});
    find(l.commit_filter, handle, {"oidnCommitFilter"});
    find(l.execute_filter, handle, {"oidnExecuteFilter"});
    find(l.release_filter, handle, {"oidnReleaseFilter"});
    return l;
  }();
  return loaded;
}

// Throws the device's error; of a missing device, that of its making.
void check(Library::Handle device, const std::string& where) {
  const char* message = nullptr;
  const int code = library().device_error(device, &message);
  if (code == 0 && device != nullptr) return;
  std::string text = message != nullptr && *message != '\0' ? message : "it gives no reason";
  std::replace(text.begin(), text.end(), '\n', ',');
  throw Error(where, "Intel Open Image Denoise failed: " + text, "leave out --denoise");
}

// Three channels of an image, side by side: finite, and in the range that the library takes.
struct Plane {
  std::array<std::size_t, 3> channel{};
  std::vector<float> values;
};

Plane plane_of(const Image& image, const std::array<const char*, 3>& names, float low, float high,
               const std::string& where) {
  Plane plane;
  for (std::size_t c = 0; c < 3; ++c) {
    const int channel = image.channel(names[c]);
    if (channel < 0)
      throw Error(where, std::string("it cannot be denoised without the layer ") + names[c],
                  "render it with --denoise, or slices of it with --aov denoise");
    plane.channel[c] = static_cast<std::size_t>(channel);
  }
  plane.values.reserve(3 * image.pixel_count());
  for (std::size_t i = 0; i < image.pixels.size(); i += image.channels.size())
    for (const std::size_t channel : plane.channel) {
      const float value = image.pixels[i + channel];
      plane.values.push_back(std::isfinite(value) ? std::clamp(value, low, high) : 0.0f);
    }
  return plane;
}

}  // namespace

struct Denoiser::Impl {
  Library::Handle device = nullptr;
  std::string name;

  ~Impl() {
    if (device != nullptr) library().release_device(device);
  }

  struct Input {
    const char* name;
    std::vector<float>& pixels;
  };

  // Runs the filter on images of this size; the output may be one of the inputs.
  void run(const Image& size, std::initializer_list<Input> inputs, std::vector<float>& output,
           std::initializer_list<const char*> flags, const std::string& where) const {
    const Library& l = library();
    const auto width = static_cast<std::size_t>(size.width), height = static_cast<std::size_t>(size.height);
    constexpr std::size_t pixel = 3 * sizeof(float);
    const std::unique_ptr<void, void (*)(void*)> filter(l.new_filter(device, "RT"), [](void* f) {
      if (f != nullptr) library().release_filter(f);
    });
    check(device, where);
    const auto set = [&](const char* image, std::vector<float>& pixels) {
      l.set_image(filter.get(), image, pixels.data(), format_float3, width, height, 0, pixel, pixel * width);
    };
    for (const Input& input : inputs) set(input.name, input.pixels);
    set("output", output);
    for (const char* flag : flags) l.set_filter_bool(filter.get(), flag, true);
    l.commit_filter(filter.get());
    l.execute_filter(filter.get());
    check(device, where);
  }
};

Denoiser::Denoiser(int threads) : impl_(std::make_unique<Impl>()) {
  const Library& l = library();
  impl_->device = l.new_device(cpu_device);
  check(impl_->device, option);
  if (threads > 0) l.set_device_int(impl_->device, "numThreads", threads);
  l.commit_device(impl_->device);
  check(impl_->device, option);
  const int version = l.device_int(impl_->device, "version");
  impl_->name = "Intel Open Image Denoise " + std::to_string(version / 10000) + "." +
                std::to_string(version / 100 % 100) + "." + std::to_string(version % 100);
}

Denoiser::~Denoiser() = default;
Denoiser::Denoiser(Denoiser&&) noexcept = default;
Denoiser& Denoiser::operator=(Denoiser&&) noexcept = default;

const std::string& Denoiser::name() const { return impl_->name; }

Image Denoiser::denoised(const Image& image, const std::string& where) const {
  constexpr float most = 65504.0f;
  Plane color = plane_of(image, {"R", "G", "B"}, 0.0f, most, where);
  Plane albedo = plane_of(image, {"albedo.R", "albedo.G", "albedo.B"}, 0.0f, 1.0f, where);
  Plane normal = plane_of(image, {"N.X", "N.Y", "N.Z"}, -1.0f, 1.0f, where);
  impl_->run(image, {{"albedo", albedo.values}}, albedo.values, {}, where);
  impl_->run(image, {{"normal", normal.values}}, normal.values, {}, where);
  std::vector<float> output(color.values.size());
  impl_->run(image, {{"color", color.values}, {"albedo", albedo.values}, {"normal", normal.values}}, output,
             {"hdr", "cleanAux"}, where);

  std::vector<std::string> channels = image.channels;
  for (const char* name : {"R", "G", "B"}) channels.push_back(std::string(noisy_layer) + "." + name);
  Image result(image.width, image.height, std::move(channels));
  const std::size_t before = image.channels.size(), now = result.channels.size();
  for (std::size_t i = 0; i < image.pixel_count(); ++i) {
    std::copy_n(&image.pixels[before * i], before, &result.pixels[now * i]);
    for (std::size_t c = 0; c < 3; ++c) {
      float& value = result.pixels[now * i + color.channel[c]];
      result.pixels[now * i + before + c] = value;
      value = output[3 * i + c];
    }
  }
  return result;
}

}  // namespace twopass
