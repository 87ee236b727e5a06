// Stands in for Intel Open Image Denoise: the functions of oidn.h that the program may call, with a filter that
// can be computed by hand, and a log of what it was asked for in the file $FAKE_OIDN_LOG. $FAKE_OIDN_FAIL names
// a function after which there is an error. Built once with the names of version 2, once with those of
// version 1.
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <set>
#include <string>

namespace {

struct Picture {
  char* pixels;
  std::size_t width, height, pixel_stride, row_stride;
  float* at(std::size_t x, std::size_t y) const {
    return reinterpret_cast<float*>(pixels + y * row_stride + x * pixel_stride);
  }
};

struct Filter {
  std::map<std::string, Picture> images;
  std::set<std::string> flags;
  bool committed = false;
};

struct Device {
  bool committed = false;
  std::string error;
};
Device the_device;

void log(const std::string& line) {
  const char* path = std::getenv("FAKE_OIDN_LOG");
  if (path == nullptr) return;
  if (std::FILE* file = std::fopen(path, "a")) {
    std::fprintf(file, "%s\n", line.c_str());
    std::fclose(file);
  }
}

void fail_if_asked(const char* function) {
  const char* name = std::getenv("FAKE_OIDN_FAIL");
  if (name != nullptr && std::strcmp(name, function) == 0)
    the_device.error = std::string("the fake failed in\n") + function;
}

void set_flag(void* filter, const char* name, bool value) {
  log(std::string("flag ") + name + (value ? " on" : " off"));
  if (value) static_cast<Filter*>(filter)->flags.insert(name);
}

void set_number(const char* name, int value) {
  if (the_device.committed) the_device.error = "parameters after commit";
  log(std::string("device ") + name + " " + std::to_string(value));
}

int number(const char* name) { return std::strcmp(name, "version") == 0 ? FAKE_OIDN_VERSION : -1; }

}  // namespace

extern "C" {

void* oidnNewDevice(int type) {
  log("new device " + std::to_string(type));
  const char* name = std::getenv("FAKE_OIDN_FAIL");
  if (name == nullptr || std::strcmp(name, "oidnNewDevice") != 0) return &the_device;
  the_device.error = "no such processor";
  return nullptr;
}
void oidnCommitDevice(void*) {
  the_device.committed = true;
  fail_if_asked("oidnCommitDevice");
}
void oidnReleaseDevice(void*) { log("release device"); }
int oidnGetDeviceError(void*, const char** message) {
  static std::string told;
  told = the_device.error;
  the_device.error.clear();
  if (told.empty()) return 0;
  *message = told.c_str();
  return 1;
}
void* oidnNewFilter(void* device, const char* type) {
  log(std::string("new filter ") + type);
  if (device != &the_device || !the_device.committed) the_device.error = "the device is not committed";
  return new Filter;
}
void oidnSetSharedFilterImage(void* filter, const char* name, void* pixels, int format, std::size_t width,
                              std::size_t height, std::size_t offset, std::size_t pixel_stride,
                              std::size_t row_stride) {
  char line[200];
  std::snprintf(line, sizeof line, "image %s format %d %zux%zu offset %zu strides %zu %zu", name, format, width,
                height, offset, pixel_stride, row_stride);
  log(line);
  static_cast<Filter*>(filter)->images[name] = {static_cast<char*>(pixels) + offset, width, height,
                                                pixel_stride, row_stride};
}
void oidnCommitFilter(void* filter) { static_cast<Filter*>(filter)->committed = true; }

// An image of data alone: half of it. A picture: color / 2 + albedo / 4 + normal / 8.
void oidnExecuteFilter(void* filter) {
  Filter& f = *static_cast<Filter*>(filter);
  log("execute");
  if (!f.committed) the_device.error = "the filter is not committed";
  fail_if_asked("oidnExecuteFilter");
  const Picture& out = f.images.at("output");
  const bool is_color = f.images.contains("color");
  if (is_color && (!f.flags.contains("hdr") || !f.flags.contains("cleanAux")))
    the_device.error = "flags are missing";
  for (std::size_t y = 0; y < out.height; ++y)
    for (std::size_t x = 0; x < out.width; ++x)
      for (int c = 0; c < 3; ++c) {
        const auto value = [&](const char* name) { return f.images.at(name).at(x, y)[c]; };
        float result;
        if (is_color)
          result = 0.5f * value("color") + 0.25f * value("albedo") + 0.125f * value("normal");
        else
          result = 0.5f * value(f.images.contains("albedo") ? "albedo" : "normal");
        out.at(x, y)[c] = result;
      }
}
void oidnReleaseFilter(void* filter) {
  delete static_cast<Filter*>(filter);
  log("release filter");
}

#if FAKE_OIDN_VERSION >= 20000
void oidnSetFilterBool(void* filter, const char* name, bool value) { set_flag(filter, name, value); }
void oidnSetDeviceInt(void*, const char* name, int value) { set_number(name, value); }
int oidnGetDeviceInt(void*, const char* name) { return number(name); }
#else
void oidnSetFilter1b(void* filter, const char* name, bool value) { set_flag(filter, name, value); }
void oidnSetDevice1i(void*, const char* name, int value) { set_number(name, value); }
int oidnGetDevice1i(void*, const char* name) { return number(name); }
#endif
}
