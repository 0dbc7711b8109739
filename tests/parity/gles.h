#pragma once

#include <EGL/egl.h>
#include <GLES3/gl3.h>

#include <memory>
#include <string>
#include <vector>

namespace candela::parity {

/// An OpenGL ES 3.0 context without window or surface, current on the thread that opened it, for as long as it lives.
/// Mesa's software driver unless the environment says LIBGL_ALWAYS_SOFTWARE=0.
class GlesContext {
 public:
  /// Null where no such device can be opened; `why` then says what failed.
  static std::unique_ptr<GlesContext> open(std::string& why);
  ~GlesContext();
  GlesContext(const GlesContext&) = delete;
  GlesContext& operator=(const GlesContext&) = delete;

  /// What the driver calls itself.
  std::string renderer() const;

 private:
  GlesContext(EGLDisplay display, EGLContext context) : display_(display), context_(context) {}

  EGLDisplay display_;
  EGLContext context_;
};

/// A name that the driver gave out, given back with Release(1, &name).
template <void (*Release)(GLsizei, const GLuint*)>
class GlName {
 public:
  explicit GlName(void (*make)(GLsizei, GLuint*)) { make(1, &name_); }
  ~GlName() {
    if (name_ != 0) Release(1, &name_);
  }
  GlName(GlName&& other) noexcept : name_(other.name_) { other.name_ = 0; }
  GlName(const GlName&) = delete;
  GlName& operator=(const GlName&) = delete;

  // NOLINTNEXTLINE(google-explicit-constructor): a name is a number wherever GL asks for one
  operator GLuint() const { return name_; }

 private:
  GLuint name_ = 0;
};

struct GlBuffer : GlName<glDeleteBuffers> {
  GlBuffer() : GlName(glGenBuffers) {}
};
struct GlTexture : GlName<glDeleteTextures> {
  GlTexture() : GlName(glGenTextures) {}
};
struct GlFramebuffer : GlName<glDeleteFramebuffers> {
  GlFramebuffer() : GlName(glGenFramebuffers) {}
};
struct GlRenderbuffer : GlName<glDeleteRenderbuffers> {
  GlRenderbuffer() : GlName(glGenRenderbuffers) {}
};

/// A linked program whose vertex shader does the work and hands `captured` to transform feedback; its fragment shader
/// does nothing.
class GlProgram {
 public:
  /// Throws Error with the driver's log.
  GlProgram(const std::string& vertex, const std::vector<std::string>& captured);
  ~GlProgram() { glDeleteProgram(program_); }
  GlProgram(const GlProgram&) = delete;
  GlProgram& operator=(const GlProgram&) = delete;

  GLuint id() const { return program_; }
  GLint uniform(const std::string& name) const { return glGetUniformLocation(program_, name.c_str()); }
  /// Names of the samplers that the program really reads.
  std::vector<std::string> samplers() const;

 private:
  GLuint program_;
};

/// Throws Error if GL has one pending.
void check_gl(const std::string& after);

}  // namespace candela::parity
