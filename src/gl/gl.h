#pragma once

#include <GLES3/gl3.h>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

/// OpenGL ES 3.0, what WebGL 2 has too. Every call needs a Context that is current on the calling thread.
namespace candela::gl {

/// An OpenGL ES 3.0 context without window or surface, current on the thread that opened it until another one is.
class Context {
 public:
  /// Tries the surfaceless platform of Mesa, the EGL devices of the machine's drivers, and EGL's default display.
  /// Throws Error that says what was tried, what failed and which package helps.
  static std::unique_ptr<Context> open();
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  /// Again, where another one was opened since. False where another thread has it.
  bool make_current();

  /// What the driver of the current one calls itself.
  static std::string renderer();

 private:
  Context(void* display, void* context) : display_(display), context_(context) {}

  void* display_;  // of EGL, whose header stays in context.cpp
  void* context_;
};

/// Whether the driver names an extension, e.g. "GL_EXT_color_buffer_float".
bool has_extension(const char* name);

/// Whether the driver is one of those that draw on the processor: Mesa's or SwiftShader.
bool is_software();

/// A name that the driver gave out, given back with Release(1, &name).
template <void (*Make)(GLsizei, GLuint*), void (*Release)(GLsizei, const GLuint*)>
class Name {
 public:
  Name() { Make(1, &name_); }
  ~Name() {
    if (name_ != 0) Release(1, &name_);
  }
  Name(Name&& other) noexcept : name_(other.name_) { other.name_ = 0; }
  Name& operator=(Name&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  Name(const Name&) = delete;
  Name& operator=(const Name&) = delete;

  // NOLINTNEXTLINE(google-explicit-constructor): a name is a number wherever GL asks for one
  operator GLuint() const { return name_; }

 private:
  GLuint name_ = 0;
};

using Buffer = Name<glGenBuffers, glDeleteBuffers>;
using Texture = Name<glGenTextures, glDeleteTextures>;
using Framebuffer = Name<glGenFramebuffers, glDeleteFramebuffers>;
using Renderbuffer = Name<glGenRenderbuffers, glDeleteRenderbuffers>;
using VertexArray = Name<glGenVertexArrays, glDeleteVertexArrays>;
using Sampler = Name<glGenSamplers, glDeleteSamplers>;

/// A linked program.
class Program {
 public:
  /// `captured` are outputs of the vertex shader for transform feedback, interleaved. Throws Error with the driver's
  /// log; its `where` is "vertex", "fragment" or "link". It is in use afterwards.
  Program(const std::string& vertex, const std::string& fragment, const std::vector<std::string>& captured = {});
  ~Program() { glDeleteProgram(program_); }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  GLuint id() const { return program_; }
  /// -1 for one that the program does not read, as glUniform takes it.
  GLint uniform(const std::string& name) const;
  /// Samplers that the program really reads, each with a texture unit of its own from 0 on.
  const std::map<std::string, GLuint, std::less<>>& samplers() const { return samplers_; }
  /// Binds a texture, and a sampler object or none, to where a sampler reads it; nothing where the program has no such.
  void bind(std::string_view sampler, GLenum target, GLuint texture, GLuint sampler_object = 0) const;
  /// Joins a uniform block to a binding point, where the program has it.
  void bind_block(const char* name, GLuint binding) const;

 private:
  GLuint program_;
  mutable std::map<std::string, GLint> uniforms_;
  std::map<std::string, GLuint, std::less<>> samplers_;
};

/// Throws Error if GL has one pending; out of memory in words.
void check(const std::string& after);

}  // namespace candela::gl
