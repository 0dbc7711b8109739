#include "gl/gl.h"

#include <array>
#include <cstring>

#include "base/error.h"
#include "gl/hex.h"

namespace candela::gl {
namespace {

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

}  // namespace

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

bool is_software() {
  const std::string renderer(reinterpret_cast<const char*>(glGetString(GL_RENDERER)));
  for (const char* name : {"llvmpipe", "softpipe", "SwiftShader"}) {
    if (renderer.find(name) != std::string::npos) return true;
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
