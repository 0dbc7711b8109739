#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <memory>
#include <string>

#include "base/error.h"
#include "gl/gl.h"
#include "unit/gl/gl_fixture.h"

namespace candela {
namespace {

using unit_gl_program = test::WithGl;  // NOLINT(readability-identifier-naming): as its suite

const std::string kHead = "#version 300 es\nprecision highp float;\n";
const std::string kVertex = kHead + "void main() { gl_Position = vec4(0.0); }\n";
const std::string kFragment = kHead + "out vec4 color;\nvoid main() { color = vec4(1.0); }\n";

/// Where a program that a driver refuses says that it is wrong.
std::string fault_of(const std::string& vertex, const std::string& fragment) {
  try {
    const gl::Program program(vertex, fragment);
  } catch (const Error& error) {
    EXPECT_FALSE(error.message().empty()) << "the driver's log";
    return error.where();
  }
  return "nowhere";
}

TEST_F(unit_gl_program, a_refusal_says_which_shader_is_wrong) {
  EXPECT_EQ(fault_of(kVertex, kFragment), "nowhere");
  EXPECT_EQ(fault_of(kHead + "void main() { wrong }\n", kFragment), "vertex");
  EXPECT_EQ(fault_of(kVertex, kHead + "void main() { wrong }\n"), "fragment");
  // Each is right by itself: nobody writes what the fragment reads.
  EXPECT_EQ(fault_of(kVertex, kHead + "in vec4 lost;\nout vec4 color;\nvoid main() { color = lost; }\n"), "link");
}

TEST_F(unit_gl_program, each_sampler_that_is_read_has_a_unit_of_its_own) {
  const gl::Program program(kVertex, kHead +
                                         "uniform sampler2D first, second, unread;\nuniform highp samplerCube sides;\n"
                                         "out vec4 color;\nvoid main() { color = texture(first, vec2(0.0)) + "
                                         "texture(second, vec2(0.0)) + texture(sides, vec3(1.0)); }\n");
  ASSERT_EQ(program.samplers().size(), 3u);
  std::array<bool, 3> taken{};
  for (const auto& [name, unit] : program.samplers()) {
    EXPECT_NE(name, "unread");
    ASSERT_LT(unit, taken.size());
    EXPECT_FALSE(taken[unit]) << name;
    taken[unit] = true;
    GLint bound = -1;
    glGetUniformiv(program.id(), program.uniform(name), &bound);
    EXPECT_EQ(bound, static_cast<GLint>(unit)) << name;
  }
  gl::Texture texture;
  program.bind("second", GL_TEXTURE_2D, texture);
  program.bind("unread", GL_TEXTURE_2D, texture);  // nothing, and no error
  GLint there = 0;
  glActiveTexture(GL_TEXTURE0 + program.samplers().find("second")->second);
  glGetIntegerv(GL_TEXTURE_BINDING_2D, &there);
  EXPECT_EQ(static_cast<GLuint>(there), static_cast<GLuint>(texture));
  EXPECT_NO_THROW(gl::check("binding"));
}

TEST_F(unit_gl_program, what_it_does_not_read_has_no_place) {
  const gl::Program program(kVertex,
                            kHead +
                                "uniform vec4 tint, unread;\nlayout(std140) uniform Numbers { vec4 number; };\n"
                                "out vec4 color;\nvoid main() { color = tint + number; }\n");
  EXPECT_GE(program.uniform("tint"), 0);
  EXPECT_EQ(program.uniform("unread"), -1);
  program.bind_block("Numbers", 2);
  program.bind_block("Absent", 3);
  GLint binding = 0;
  glGetActiveUniformBlockiv(program.id(), glGetUniformBlockIndex(program.id(), "Numbers"), GL_UNIFORM_BLOCK_BINDING,
                            &binding);
  EXPECT_EQ(binding, 2);
  EXPECT_NO_THROW(gl::check("blocks"));
}

TEST_F(unit_gl_program, outputs_of_the_vertex_shader_can_be_captured) {
  const gl::Program program(kHead +
                                "out float twice;\nout float square;\nvoid main() { float i = float(gl_VertexID); "
                                "twice = 2.0 * i; square = i * i; gl_Position = vec4(0.0); }\n",
                            kFragment, {"twice", "square"});
  constexpr std::size_t kCount = 4;
  constexpr auto kBytes = static_cast<GLsizeiptr>(2 * kCount * sizeof(float));
  const gl::Buffer buffer;
  glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffer);
  glBufferData(GL_TRANSFORM_FEEDBACK_BUFFER, kBytes, nullptr, GL_STATIC_READ);
  // Nothing is drawn, but without a window there is nothing to draw into.
  const gl::Renderbuffer color;
  glBindRenderbuffer(GL_RENDERBUFFER, color);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, 1, 1);
  const gl::Framebuffer framebuffer;
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color);
  glEnable(GL_RASTERIZER_DISCARD);
  glBeginTransformFeedback(GL_POINTS);
  glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(kCount));
  glEndTransformFeedback();
  gl::check("capturing");
  const auto* found =
      static_cast<const float*>(glMapBufferRange(GL_TRANSFORM_FEEDBACK_BUFFER, 0, kBytes, GL_MAP_READ_BIT));
  ASSERT_NE(found, nullptr);
  for (std::size_t i = 0; i < kCount; ++i) {
    EXPECT_EQ(found[2 * i], 2.0f * static_cast<float>(i));
    EXPECT_EQ(found[2 * i + 1], static_cast<float>(i * i));
  }
}

TEST_F(unit_gl_program, an_error_of_opengl_is_told_once_with_what_was_done) {
  glEnable(0xffff);
  try {
    gl::check("turning on what there is not");
    ADD_FAILURE() << "nothing was told";
  } catch (const Error& error) {
    EXPECT_EQ(error.where(), "turning on what there is not");
    EXPECT_NE(error.message().find("500"), std::string::npos) << error.message();  // GL_INVALID_ENUM
  }
  EXPECT_NO_THROW(gl::check("nothing"));
}

TEST_F(unit_gl_program, a_name_is_given_back_once_by_whoever_has_it_last) {
  GLuint name = 0;
  {
    gl::Texture first;
    name = first;
    glBindTexture(GL_TEXTURE_2D, first);  // only then it is one
    gl::Texture second;
    second = std::move(first);
    EXPECT_EQ(static_cast<GLuint>(second), name);
    { const gl::Texture third = std::move(second); }
    EXPECT_EQ(glIsTexture(name), GL_FALSE);
  }
  EXPECT_NO_THROW(gl::check("giving back"));
}

TEST_F(unit_gl_program, a_context_can_be_current_again) {
  glClearColor(0.25f, 0.0f, 0.0f, 0.0f);
  const auto red = [] {
    std::array<float, 4> color{};
    glGetFloatv(GL_COLOR_CLEAR_VALUE, color.data());
    return color[0];
  };
  const std::unique_ptr<gl::Context> other = gl::Context::open();
  EXPECT_EQ(red(), 0.0f) << "the one that was opened last is current";
  EXPECT_TRUE(context_->make_current());
  EXPECT_EQ(red(), 0.25f);
  EXPECT_FALSE(gl::Context::renderer().empty());
}

}  // namespace
}  // namespace candela
