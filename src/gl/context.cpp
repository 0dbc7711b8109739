#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <mutex>

#include "base/error.h"
#include "gl/gl.h"
#include "gl/hex.h"

// Contexts without a window, by EGL.
namespace candela::gl {
namespace {

bool contains_word(const char* all, const char* name) {
  if (all == nullptr) return false;
  const std::string padded = " " + std::string(all) + " ";
  return padded.find(" " + std::string(name) + " ") != std::string::npos;
}

// The list is that of EGL without a display, or null before EGL 1.5.
bool has_client_extension(const char* name) {
  return contains_word(eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS), name);
}

struct Candidate {
  std::string what;
  EGLDisplay display = EGL_NO_DISPLAY;
};

/// A GPU before a processor: devices come first where there is a driver of its own, then Mesa, then whatever the
/// default display may be.
std::vector<Candidate> candidates() {
  std::vector<Candidate> all;
  const auto query_devices = reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
  const auto device_string =
      reinterpret_cast<PFNEGLQUERYDEVICESTRINGEXTPROC>(eglGetProcAddress("eglQueryDeviceStringEXT"));
  const char* software = std::getenv("LIBGL_ALWAYS_SOFTWARE");
  const bool is_software = software != nullptr && std::strcmp(software, "0") != 0;
  if (!is_software && has_client_extension("EGL_EXT_platform_device") && query_devices != nullptr &&
      device_string != nullptr) {
    std::array<EGLDeviceEXT, 16> devices{};
    EGLint count = 0;
    query_devices(static_cast<EGLint>(devices.size()), devices.data(), &count);
    for (EGLint i = 0; i < count; ++i) {
      const EGLDeviceEXT device = devices[static_cast<std::size_t>(i)];
      // Mesa's software device says so, and the surfaceless platform is its simpler door.
      if (contains_word(device_string(device, EGL_EXTENSIONS), "EGL_MESA_device_software")) continue;
      all.push_back(
          {"EGL device " + std::to_string(i), eglGetPlatformDisplay(EGL_PLATFORM_DEVICE_EXT, device, nullptr)});
    }
  }
  if (has_client_extension("EGL_MESA_platform_surfaceless")) {
    all.push_back(
        {"Mesa surfaceless", eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr)});
  }
  if (all.empty()) all.push_back({"default display", eglGetDisplay(EGL_DEFAULT_DISPLAY)});
  return all;
}

/// Contexts of a display that are open. EGL gives the whole process one display, and ends it for all at once.
int& users_of(EGLDisplay display) {
  static std::map<EGLDisplay, int> users;
  return users[display];
}
std::mutex& users_mutex() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

std::unique_ptr<Context> Context::open() {
  const std::lock_guard lock(users_mutex());
  std::string tried;
  for (const Candidate& candidate : candidates()) {
    std::string failure;
    if (candidate.display == EGL_NO_DISPLAY || eglInitialize(candidate.display, nullptr, nullptr) == EGL_FALSE) {
      failure = "no display (" + hex(static_cast<unsigned>(eglGetError())) + ")";
    } else {
      eglBindAPI(EGL_OPENGL_ES_API);
      const std::array<EGLint, 5> attributes = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 0, EGL_NONE};
      const EGLContext context =
          eglCreateContext(candidate.display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
      if (context != EGL_NO_CONTEXT &&
          eglMakeCurrent(candidate.display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE) {
        ++users_of(candidate.display);
        return std::unique_ptr<Context>(new Context(candidate.display, context));
      }
      failure = "no OpenGL ES 3.0 (" + hex(static_cast<unsigned>(eglGetError())) + ")";
      if (context != EGL_NO_CONTEXT) eglDestroyContext(candidate.display, context);
      if (users_of(candidate.display) == 0) eglTerminate(candidate.display);
    }
    tried += (tried.empty() ? "" : ", ") + candidate.what + ": " + failure;
  }
  throw Error("no usable OpenGL: " + tried + "; without a GPU install Mesa's software driver: libegl1 libgl1-mesa-dri");
}

Context::~Context() {
  const std::lock_guard lock(users_mutex());
  if (eglGetCurrentContext() == context_) eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
  if (--users_of(display_) == 0) eglTerminate(display_);
}

bool Context::make_current() {
  return eglGetCurrentContext() == context_ ||
         eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_TRUE;
}

}  // namespace candela::gl
