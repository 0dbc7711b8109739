// What image-based light costs at the least: a picture-filling shader with six lookups (base colour, normal, roughness
// and metallic, prefiltered cube, irradiance, split-sum table) and nothing else. `bench_bare_light [WxH]` prints
// milliseconds per frame, the least of ten, finished; bench/raster.py compares the rasterizer with it.

#include <GLES3/gl3.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <vector>

#include "base/error.h"
#include "gl/gl.h"

namespace {

using namespace candela;

const char* const kVertex = R"(#version 300 es
out vec2 v_ndc;
void main() {
  v_ndc = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(v_ndc, 0.5, 1.0);
}
)";

const char* const kFragment = R"(#version 300 es
precision highp float;
in vec2 v_ndc;
uniform sampler2D base_map, normal_map, rough_map, table;
uniform samplerCube specular, diffuse;
out vec4 o_color;
void main() {
  // A sphere as large as the picture, so that every pixel has a normal and a view of its own.
  vec2 p = v_ndc * 0.7;
  vec3 n = vec3(p, sqrt(1.0 - min(dot(p, p), 0.99)));
  vec2 uv = v_ndc * 0.5 + 0.5;
  vec3 base = texture(base_map, uv).rgb;
  vec3 bump = texture(normal_map, uv).xyz * 2.0 - 1.0;
  vec2 mr = texture(rough_map, uv).gb;
  n = normalize(n + 0.2 * bump);
  vec3 v = normalize(vec3(-p * 0.2, 1.0));
  float cosine = max(dot(n, v), 1e-3);
  vec3 f0 = mix(vec3(0.04), base, mr.y);
  vec2 ab = texture(table, vec2(cosine, mr.x)).xy;
  vec3 mirrored = textureLod(specular, reflect(-v, n), mr.x * 6.0).rgb;
  vec3 around = texture(diffuse, n).rgb;
  o_color = vec4(mirrored * (f0 * ab.x + ab.y) + around * base * (1.0 - mr.y), 1.0);
}
)";

gl::Texture flat_map(int size) {
  gl::Texture texture;
  std::vector<unsigned char> texels(static_cast<std::size_t>(size) * static_cast<std::size_t>(size) * 4);
  for (std::size_t i = 0; i < texels.size(); ++i) texels[i] = static_cast<unsigned char>((i * 2654435761u) >> 24);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, size, size, 0, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
  glGenerateMipmap(GL_TEXTURE_2D);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  return texture;
}

gl::Texture cube_map(int size) {
  gl::Texture texture;
  const std::vector<float> texels(static_cast<std::size_t>(size) * static_cast<std::size_t>(size) * 4, 0.5f);
  glBindTexture(GL_TEXTURE_CUBE_MAP, texture);
  for (GLenum face = 0; face < 6; ++face) {
    glTexImage2D(GL_TEXTURE_CUBE_MAP_POSITIVE_X + face, 0, GL_RGBA16F, size, size, 0, GL_RGBA, GL_FLOAT, texels.data());
  }
  glGenerateMipmap(GL_TEXTURE_CUBE_MAP);
  glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  return texture;
}

double frame_ms(int width, int height) {
  const auto context = gl::Context::open();
  const gl::Renderbuffer color;
  const gl::Framebuffer framebuffer;
  glBindRenderbuffer(GL_RENDERBUFFER, color);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA16F, width, height);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color);
  glViewport(0, 0, width, height);
  const gl::VertexArray nothing;
  glBindVertexArray(nothing);
  const gl::Program program(kVertex, kFragment);
  glUseProgram(program.id());
  const std::vector<gl::Texture> maps = [] {
    std::vector<gl::Texture> all;
    all.reserve(4);
    for (int i = 0; i < 3; ++i) all.push_back(flat_map(2048));
    all.push_back(flat_map(64));
    return all;
  }();
  const gl::Texture specular = cube_map(256), diffuse = cube_map(32);
  GLint unit = 0;
  for (const char* name : {"base_map", "normal_map", "rough_map", "table"}) {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
    glBindTexture(GL_TEXTURE_2D, maps[static_cast<std::size_t>(unit)]);
    glUniform1i(program.uniform(name), unit++);
  }
  for (const auto& [name, texture] : {std::pair<const char*, GLuint>("specular", specular), {"diffuse", diffuse}}) {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
    glBindTexture(GL_TEXTURE_CUBE_MAP, texture);
    glUniform1i(program.uniform(name), unit++);
  }
  double least = 1e9;
  for (int i = 0; i < 11; ++i) {
    const auto start = std::chrono::steady_clock::now();
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glFinish();
    const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    if (i > 0) least = std::min(least, ms);  // the first compiles
  }
  gl::check("drawing");
  return least;
}

}  // namespace

int main(int argc, char** argv) {
  int width = 1280, height = 720;
  if (argc > 1 && std::sscanf(argv[1], "%dx%d", &width, &height) != 2) return 2;
  try {
    std::printf("%.1f\n", frame_ms(width, height));
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
