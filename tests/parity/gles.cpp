#include "parity/gles.h"

#include <EGL/eglext.h>

#include <array>
#include <cstdlib>
#include <cstring>

#include "base/error.h"

namespace candela::parity {
namespace {

std::string hex(unsigned number) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "0x%04x", number);
  return text.data();
}

// The list is that of EGL without a display, or null before EGL 1.5.
bool has_client_extension(const char* name) {
  const char* all = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  return all != nullptr && std::strstr(all, name) != nullptr;
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
  throw Error(log);
}

constexpr const char* kIdleFragment = "#version 300 es\nvoid main() {}\n";

}  // namespace

std::unique_ptr<GlesContext> GlesContext::open(std::string& why) {
  // What the environment already says stays. The disk cache would only leave files behind.
  setenv("LIBGL_ALWAYS_SOFTWARE", "1", 0);
  setenv("MESA_SHADER_CACHE_DISABLE", "true", 0);
  // Each program runs once: code that is optimised takes longer to compile than it saves.
  setenv("GALLIVM_PERF", "nopt", 0);
  // Vertices are shaded on this thread; the idle threads of the rasterizer only alarm ThreadSanitizer.
  setenv("LP_NUM_THREADS", "0", 0);

  if (!has_client_extension("EGL_MESA_platform_surfaceless")) {
    why = "EGL has no EGL_MESA_platform_surfaceless";
    return nullptr;
  }
  const EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) == EGL_FALSE) {
    why = "no EGL display (" + hex(static_cast<unsigned>(eglGetError())) + ")";
    return nullptr;
  }
  eglBindAPI(EGL_OPENGL_ES_API);
  const std::array<EGLint, 5> attributes = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 0, EGL_NONE};
  const EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
  if (context == EGL_NO_CONTEXT || eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_FALSE) {
    why = "no OpenGL ES 3.0 context (" + hex(static_cast<unsigned>(eglGetError())) + ")";
    if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
    eglTerminate(display);
    return nullptr;
  }
  return std::unique_ptr<GlesContext>(new GlesContext(display, context));
}

GlesContext::~GlesContext() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
  eglTerminate(display_);
}

std::string GlesContext::renderer() const {
  const auto text = [](GLenum what) { return std::string(reinterpret_cast<const char*>(glGetString(what))); };
  return text(GL_RENDERER) + ", " + text(GL_VERSION);
}

GlProgram::GlProgram(const std::string& vertex, const std::vector<std::string>& captured)
    : program_(glCreateProgram()) {
  try {
    for (const auto& [kind, source] : {std::pair<GLenum, std::string>(GL_VERTEX_SHADER, vertex),
                                       std::pair<GLenum, std::string>(GL_FRAGMENT_SHADER, kIdleFragment)}) {
      const GLuint shader = compile(kind, source);
      glAttachShader(program_, shader);
      glDeleteShader(shader);  // it lives on as long as the program
    }
    std::vector<const char*> names;
    names.reserve(captured.size());
    for (const std::string& name : captured) names.push_back(name.c_str());
    glTransformFeedbackVaryings(program_, static_cast<GLsizei>(names.size()), names.data(), GL_INTERLEAVED_ATTRIBS);
    glLinkProgram(program_);
    GLint good = 0;
    glGetProgramiv(program_, GL_LINK_STATUS, &good);
    if (good == 0) {
      std::array<char, 4096> log{};
      glGetProgramInfoLog(program_, static_cast<GLsizei>(log.size()), nullptr, log.data());
      throw Error(log.data(), "link");
    }
  } catch (...) {
    glDeleteProgram(program_);
    throw;
  }
}

std::vector<std::string> GlProgram::samplers() const {
  std::vector<std::string> names;
  GLint count = 0;
  glGetProgramiv(program_, GL_ACTIVE_UNIFORMS, &count);
  for (GLuint i = 0; i < static_cast<GLuint>(count); ++i) {
    std::array<char, 256> name{};
    GLint size = 0;
    GLenum type = 0;
    glGetActiveUniform(program_, i, static_cast<GLsizei>(name.size()), nullptr, &size, &type, name.data());
    if (type == GL_SAMPLER_2D || type == GL_SAMPLER_3D || type == GL_SAMPLER_2D_ARRAY || type == GL_SAMPLER_CUBE) {
      names.emplace_back(name.data());
    }
  }
  return names;
}

void check_gl(const std::string& after) {
  const GLenum error = glGetError();
  if (error != GL_NO_ERROR) throw Error("OpenGL error " + hex(error), after);
}

}  // namespace candela::parity
