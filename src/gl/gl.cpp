#include "gl/gl.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <mutex>

#include "base/error.h"

namespace candela::gl {
namespace {

std::string hex(unsigned number) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "0x%04x", number);
  return text.data();
}

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

GLuint compile(GLenum kind, const std::string& source) {
  const GLuint shader = glCreateShader(kind);
  const char* text = source.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good != 0) return shader;
  GLint length = 0;
  glGetShaderiv(shader, GL_INFO_LOG_LENGTH, &length);
  std::string log(static_cast<std::size_t>(length) + 1, '\0');
  glGetShaderInfoLog(shader, length + 1, &length, log.data());
  log.resize(static_cast<std::size_t>(length));
  glDeleteShader(shader);
  throw Error(log, kind == GL_VERTEX_SHADER ? "vertex" : "fragment");
}

std::vector<std::string> sampler_names(GLuint program) {
  std::vector<std::string> names;
  GLint count = 0;
  glGetProgramiv(program, GL_ACTIVE_UNIFORMS, &count);
  for (GLuint i = 0; i < static_cast<GLuint>(count); ++i) {
    std::array<char, 256> name{};
    GLint size = 0;
    GLenum type = 0;
    glGetActiveUniform(program, i, static_cast<GLsizei>(name.size()), nullptr, &size, &type, name.data());
    const bool is_sampler = type == GL_SAMPLER_2D || type == GL_SAMPLER_3D || type == GL_SAMPLER_2D_ARRAY ||
                            type == GL_SAMPLER_CUBE || type == GL_SAMPLER_2D_SHADOW ||
                            type == GL_SAMPLER_2D_ARRAY_SHADOW;
    if (is_sampler) names.emplace_back(name.data());
  }
  return names;
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

std::string Context::renderer() {
  const auto text = [](GLenum what) { return std::string(reinterpret_cast<const char*>(glGetString(what))); };
  return text(GL_RENDERER) + ", " + text(GL_VERSION);
}

bool has_extension(const char* name) {
  GLint count = 0;
  glGetIntegerv(GL_NUM_EXTENSIONS, &count);
  for (GLuint i = 0; i < static_cast<GLuint>(count); ++i) {
    if (std::strcmp(reinterpret_cast<const char*>(glGetStringi(GL_EXTENSIONS, i)), name) == 0) return true;
  }
  return false;
}

Program::Program(const std::string& vertex, const std::string& fragment, const std::vector<std::string>& captured)
    : program_(glCreateProgram()) {
  try {
    for (const auto& [kind, source] : {std::pair<GLenum, const std::string&>(GL_VERTEX_SHADER, vertex),
                                       std::pair<GLenum, const std::string&>(GL_FRAGMENT_SHADER, fragment)}) {
      const GLuint shader = compile(kind, source);
      glAttachShader(program_, shader);
      glDeleteShader(shader);  // it lives on as long as the program
    }
    std::vector<const char*> names;
    names.reserve(captured.size());
    for (const std::string& name : captured) names.push_back(name.c_str());
    if (!names.empty()) {
      glTransformFeedbackVaryings(program_, static_cast<GLsizei>(names.size()), names.data(), GL_INTERLEAVED_ATTRIBS);
    }
    glLinkProgram(program_);
    GLint good = 0;
    glGetProgramiv(program_, GL_LINK_STATUS, &good);
    if (good == 0) {
      std::array<char, 4096> log{};
      glGetProgramInfoLog(program_, static_cast<GLsizei>(log.size()), nullptr, log.data());
      throw Error(log.data(), "link");
    }
    glUseProgram(program_);
    for (const std::string& name : sampler_names(program_)) {
      const auto unit = static_cast<GLuint>(samplers_.size());
      glUniform1i(uniform(name), static_cast<GLint>(unit));
      samplers_[name] = unit;
    }
  } catch (...) {
    glDeleteProgram(program_);
    throw;
  }
}

void Program::bind(std::string_view sampler, GLenum target, GLuint texture, GLuint sampler_object) const {
  const auto entry = samplers_.find(sampler);
  if (entry == samplers_.end()) return;
  glActiveTexture(GL_TEXTURE0 + entry->second);
  glBindTexture(target, texture);
  glBindSampler(entry->second, sampler_object);
}

GLint Program::uniform(const std::string& name) const {
  const auto [entry, is_new] = uniforms_.try_emplace(name, -1);
  if (is_new) entry->second = glGetUniformLocation(program_, name.c_str());
  return entry->second;
}

void Program::bind_block(const char* name, GLuint binding) const {
  const GLuint index = glGetUniformBlockIndex(program_, name);
  if (index != GL_INVALID_INDEX) glUniformBlockBinding(program_, index, binding);
}

void check(const std::string& after) {
  const GLenum error = glGetError();
  if (error == GL_OUT_OF_MEMORY) throw Error("the graphics memory does not suffice", after);
  if (error != GL_NO_ERROR) throw Error("OpenGL error " + hex(error), after);
}

}  // namespace candela::gl
