#include "denoise/oidn.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstddef>
#include <memory>

#include "base/error.h"

// The library's C interface, version 2, as its documentation has it: it is opened at run time and nothing of it is
// compiled in.

namespace candela::denoise {

namespace {

constexpr const char* kLibrary = "libOpenImageDenoise.so.2";

constexpr int kCpuDevice = 1;  // OIDN_DEVICE_TYPE_CPU: the result must not depend on whether there is a GPU
constexpr int kFloat3 = 3;     // OIDN_FORMAT_FLOAT3

struct Library {
  void* (*new_device)(int type) = nullptr;
  void (*commit_device)(void* device) = nullptr;
  int (*get_device_error)(void* device, const char** message) = nullptr;
  void (*release_device)(void* device) = nullptr;
  void* (*new_filter)(void* device, const char* type) = nullptr;
  void (*set_shared_image)(void* filter, const char* name, void* data, int format, std::size_t width,
                           std::size_t height, std::size_t offset, std::size_t pixel_stride,
                           std::size_t row_stride) = nullptr;
  void (*set_monitor)(void* filter, bool (*function)(void* data, double fraction), void* data) = nullptr;
  void (*set_bool)(void* filter, const char* name, bool value) = nullptr;
  void (*commit_filter)(void* filter) = nullptr;
  void (*execute_filter)(void* filter) = nullptr;
  void (*release_filter)(void* filter) = nullptr;
  std::string error;  ///< empty where all of them are there
};

template <class Function>
void find(void* handle, const char* name, Function& function, std::string& error) {
  function = reinterpret_cast<Function>(dlsym(handle, name));
  if (function == nullptr && error.empty()) error = fmt::format("{} has no function {}", kLibrary, name);
}

Library open_library() {
  Library library;
  void* handle = dlopen(kLibrary, RTLD_NOW | RTLD_LOCAL);  // stays open until the process ends
  if (handle == nullptr) {
    const char* why = dlerror();
    library.error = why != nullptr ? why : fmt::format("{} is not found", kLibrary);
    return library;
  }
  std::string& error = library.error;
  find(handle, "oidnNewDevice", library.new_device, error);
  find(handle, "oidnCommitDevice", library.commit_device, error);
  find(handle, "oidnGetDeviceError", library.get_device_error, error);
  find(handle, "oidnReleaseDevice", library.release_device, error);
  find(handle, "oidnNewFilter", library.new_filter, error);
  find(handle, "oidnSetSharedFilterImage", library.set_shared_image, error);
  find(handle, "oidnSetFilterProgressMonitorFunction", library.set_monitor, error);
  find(handle, "oidnSetFilterBool", library.set_bool, error);
  find(handle, "oidnCommitFilter", library.commit_filter, error);
  find(handle, "oidnExecuteFilter", library.execute_filter, error);
  find(handle, "oidnReleaseFilter", library.release_filter, error);
  return library;
}

const Library& library() {
  static const Library opened = open_library();
  return opened;
}

using Device = std::unique_ptr<void, void (*)(void*)>;

/// Empty where the device has had no error.
std::string error_of(void* device) {
  const char* message = nullptr;
  if (library().get_device_error(device, &message) == 0) return {};
  return message != nullptr ? message : "unknown error";
}

/// Of the processor. Throws Error.
Device open_device() {
  const Library& l = library();
  if (!l.error.empty()) throw Error("Open Image Denoise: " + l.error);
  Device device(l.new_device(kCpuDevice), l.release_device);
  if (!device) throw Error("Open Image Denoise: no device for this processor");
  l.commit_device(device.get());
  const std::string error = error_of(device.get());
  if (!error.empty()) throw Error("Open Image Denoise: " + error);
  return device;
}

/// False ends it.
bool report(void* data, double fraction) {
  const Job& job = *static_cast<const Job*>(data);
  job.report({.fraction = fraction, .what = "denoising"});
  return !job.is_stopped();
}

}  // namespace

std::string why_no_oidn() {
  try {
    open_device();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

Image denoise_by_oidn(const Film& film, const Job& job) {
  const Library& l = library();
  const Device device = open_device();
  const auto width = static_cast<std::size_t>(film.width()), height = static_cast<std::size_t>(film.height());
  Image color(film.width(), film.height(), 3), result(film.width(), film.height(), 3);
  for (int y = 0; y < film.height(); ++y) {
    for (int x = 0; x < film.width(); ++x) color.set_rgb(x, y, film.beauty.rgb(x, y));
  }
  Image albedo = film.features->albedo, normal = film.features->normal;
  const std::unique_ptr<void, void (*)(void*)> filter(l.new_filter(device.get(), "RT"), l.release_filter);
  const auto set = [&](const char* name, Image& image) {
    l.set_shared_image(filter.get(), name, image.pixels.data(), kFloat3, width, height, 0, 0, 0);
  };
  set("color", color);
  set("albedo", albedo);
  set("normal", normal);
  set("output", result);
  l.set_bool(filter.get(), "hdr", true);
  Job watched = job;
  l.set_monitor(filter.get(), report, &watched);
  l.commit_filter(filter.get());
  l.execute_filter(filter.get());
  if (job.is_stopped()) throw Interrupted("while denoising");
  const std::string error = error_of(device.get());
  if (!error.empty()) throw Error("Open Image Denoise: " + error);
  return result;
}

}  // namespace candela::denoise
