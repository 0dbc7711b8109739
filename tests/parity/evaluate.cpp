#include "parity/evaluate.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <sstream>

#include "base/error.h"
#include "gl/gl.h"
#include "gl/shader_text.h"

namespace candela::parity {
namespace {

constexpr int kRowTexels = 1024;  // of the texture of inputs; ES 3.0 promises a width of 2048
constexpr int kPassFloats = 60;   // outputs of a program; ES 3.0 promises 15 vectors of varyings

int texels_for(int floats) { return (floats + 3) / 4; }

std::string output_name(int vector) { return "parity_output_" + std::to_string(vector); }

/// main() for the outputs from `first` on, `floats` of them. Inputs come from a texture, whole texels for each vertex,
/// as there may be more of them than a vertex has attributes. All indices are constants, which keeps the driver quick.
std::string vertex_main(const Function& function, int first, int floats) {
  std::ostringstream text;
  const int texels = texels_for(function.input_size);
  const int vectors = texels_for(floats);
  text << "uniform highp sampler2D parity_inputs;\n";
  for (int i = 0; i < vectors; ++i) text << "out highp vec4 " << output_name(i) << ";\n";
  text << "void main() {\n  float x[" << 4 * std::max(1, texels) << "];\n";
  text << "  float y[" << function.output.size << "];\n  int texel = gl_VertexID * " << texels << ";\n  vec4 t;\n";
  for (int i = 0; i < texels; ++i) {
    text << "  t = texelFetch(parity_inputs, ivec2(texel % " << kRowTexels << ", texel / " << kRowTexels << "), 0);\n";
    for (int j = 0; j < 4; ++j) text << "  x[" << 4 * i + j << "] = t[" << j << "];\n";
    text << "  ++texel;\n";
  }
  text << function.glsl;
  for (int i = 0; i < vectors; ++i) {
    text << "  " << output_name(i) << " = vec4(0.0f);\n";
    for (int j = 4 * i; j < std::min(4 * i + 4, floats); ++j) {
      text << "  " << output_name(i) << "[" << j % 4 << "] = y[" << first + j << "];\n";
    }
  }
  text << "  gl_Position = vec4(0.0f);\n}\n";
  return text.str();
}

/// What vertex_main reads: each input padded to whole texels.
gl::Texture upload_inputs(const Function& function, const std::vector<float>& inputs) {
  const auto size = static_cast<std::size_t>(function.input_size);
  const auto stride = static_cast<std::size_t>(4 * texels_for(function.input_size));
  const std::size_t row = std::size_t{4} * kRowTexels;
  const std::size_t count = size == 0 ? 0 : inputs.size() / size;
  const std::size_t height = std::max<std::size_t>(1, (count * stride + row - 1) / row);
  std::vector<float> texels(height * row);
  for (std::size_t i = 0; i < count; ++i) std::copy_n(inputs.data() + i * size, size, texels.data() + i * stride);
  return upload({.uniform = "parity_inputs",
                 .target = GL_TEXTURE_2D,
                 .width = kRowTexels,
                 .height = static_cast<int>(height),
                 .channels = 4,
                 .texels = std::move(texels)});
}

/// Every sampler that the program reads gets its texels.
std::vector<gl::Texture> bind_textures(const gl::Program& program, const Function& function,
                                       const std::vector<float>& inputs, const std::vector<Table>& known) {
  std::vector<gl::Texture> textures;
  for (const auto& sampler : program.samplers()) {
    const std::string& name = sampler.first;
    const auto table = std::find_if(known.begin(), known.end(), [&](const Table& t) { return t.uniform == name; });
    if (name != "parity_inputs" && table == known.end()) {
      throw Error("the shared text reads a sampler without a row in tests/parity/tables.cpp", name);
    }
    glActiveTexture(GL_TEXTURE0 + sampler.second);
    textures.push_back(name == "parity_inputs" ? upload_inputs(function, inputs) : upload(*table));
  }
  return textures;
}

/// Without a surface the default framebuffer is undefined, and drawing to it an error even where nothing is drawn.
class IdleFramebuffer {
 public:
  IdleFramebuffer() {
    glBindRenderbuffer(GL_RENDERBUFFER, color_);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, 1, 1);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color_);
  }

 private:
  gl::Renderbuffer color_;
  gl::Framebuffer framebuffer_;
};

/// Every vertex's outputs, whole vec4s, `floats` for each vertex.
std::vector<float> draw(std::size_t count, std::size_t floats) {
  const auto bytes = static_cast<GLsizeiptr>(count * floats * sizeof(float));
  const IdleFramebuffer framebuffer;
  const gl::Buffer buffer;
  glEnable(GL_RASTERIZER_DISCARD);
  glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffer);
  glBufferData(GL_TRANSFORM_FEEDBACK_BUFFER, bytes, nullptr, GL_STREAM_READ);
  glBeginTransformFeedback(GL_POINTS);
  glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(count));
  glEndTransformFeedback();
  gl::check("draw");
  const void* mapped = glMapBufferRange(GL_TRANSFORM_FEEDBACK_BUFFER, 0, bytes, GL_MAP_READ_BIT);
  if (mapped == nullptr) throw Error("cannot map the results");
  const auto* first = static_cast<const float*>(mapped);
  std::vector<float> result(first, first + count * floats);
  glUnmapBuffer(GL_TRANSFORM_FEEDBACK_BUFFER);
  return result;
}

/// The vertex shader does the work.
constexpr const char* kIdleFragment = "#version 300 es\nvoid main() {}\n";

std::unique_ptr<gl::Program> make_program(const Function& function, int first, int floats,
                                          const Alteration& alteration) {
  gl::ShaderText source(gl::read_from_folder(CANDELA_SOURCE_DIR "/src"));
  source.add_header(function.header);
  if (!alteration.from.empty()) source.replace(alteration.from, alteration.to);
  source.add_text("main() of " + function.name, vertex_main(function, first, floats));
  std::vector<std::string> captured;
  captured.reserve(static_cast<std::size_t>(texels_for(floats)));
  for (int i = 0; i < texels_for(floats); ++i) captured.push_back(output_name(i));
  try {
    return std::make_unique<gl::Program>(source.text(), kIdleFragment, captured);
  } catch (const Error& error) {
    throw Error(source.explain(error.message()), function.name);
  }
}

std::size_t count_of(const Function& function, const std::vector<float>& inputs) {
  return function.input_size == 0 ? 1 : inputs.size() / static_cast<std::size_t>(function.input_size);
}

}  // namespace

std::vector<float> evaluate_cpp(const Function& function, const std::vector<float>& inputs) {
  const std::size_t count = count_of(function, inputs);
  const auto stride = static_cast<std::size_t>(function.output.size);
  std::vector<float> outputs(count * stride);
  for (std::size_t i = 0; i < count; ++i) {
    function.call(inputs.data() + i * static_cast<std::size_t>(function.input_size), outputs.data() + i * stride);
  }
  return outputs;
}

std::vector<float> evaluate_glsl(const Function& function, const std::vector<float>& inputs,
                                 const Alteration& alteration, const std::vector<Table>& textures) {
  const std::size_t count = count_of(function, inputs);
  const auto stride = static_cast<std::size_t>(function.output.size);
  std::vector<float> outputs(count * stride);
  // A program for each part of the outputs that transform feedback can hold.
  for (int first = 0; first < function.output.size; first += kPassFloats) {
    const int floats = std::min(kPassFloats, function.output.size - first);
    const std::unique_ptr<gl::Program> program = make_program(function, first, floats, alteration);
    glUseProgram(program->id());
    const std::vector<gl::Texture> bound = bind_textures(*program, function, inputs, textures);
    const auto captured = static_cast<std::size_t>(4 * texels_for(floats));
    const std::vector<float> part = draw(count, captured);
    for (std::size_t i = 0; i < count; ++i) {
      std::copy_n(part.data() + i * captured, static_cast<std::size_t>(floats),
                  outputs.data() + i * stride + static_cast<std::size_t>(first));
    }
  }
  return outputs;
}

}  // namespace candela::parity
