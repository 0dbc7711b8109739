// What a driver needs at the least for shaders that fill the picture: a constant; one trilinear texture; GGX from one
// light with three textures; light from an image with six lookups (base colour, normal, roughness and metallic,
// prefiltered cube, irradiance, split-sum table) and nothing else. `bench_bare_light [WxH]` prints milliseconds per
// frame for each, the mean of 16, each finished; bench/raster.py compares the rasterizer with the last.

#include <GLES3/gl3.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <string>
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

/// Every fragment shader begins so: a sphere as large as the picture, so that every pixel has a normal and a view of
/// its own.
const char* const kHead = R"(#version 300 es
precision highp float;
in vec2 v_ndc;
uniform sampler2D base_map, normal_map, rough_map, table;
uniform samplerCube specular, diffuse;
out vec4 o_color;
struct Point {
  vec3 n, v, base;
  float rough, metallic;
};
Point point() {
  Point p;
  vec2 at = v_ndc * 0.7, uv = v_ndc * 0.5 + 0.5;
  p.base = texture(base_map, uv).rgb;
  vec3 bump = texture(normal_map, uv).xyz * 2.0 - 1.0;
  vec2 mr = texture(rough_map, uv).gb;
  p.n = normalize(vec3(at, sqrt(1.0 - min(dot(at, at), 0.99))) + 0.2 * bump);
  p.v = normalize(vec3(-at * 0.2, 1.0));
  p.rough = mr.x;
  p.metallic = mr.y;
  return p;
}
)";

constexpr std::array<const char*, 4> kMaps = {"base_map", "normal_map", "rough_map", "table"};

struct Shader {
  const char* name;
  const char* main;
};

const Shader kShaders[] = {
    {"a constant", R"(
void main() { o_color = vec4(0.5); }
)"},
    {"one trilinear texture", R"(
void main() { o_color = texture(base_map, v_ndc * 0.5 + 0.5); }
)"},
    {"GGX, one light, three textures", R"(
void main() {
  Point p = point();
  vec3 l = normalize(vec3(0.4, 0.6, 0.7)), h = normalize(p.v + l);
  float nl = max(dot(p.n, l), 0.0), nv = max(dot(p.n, p.v), 1e-3), nh = max(dot(p.n, h), 0.0);
  float a2 = p.rough * p.rough * p.rough * p.rough, t = nh * nh * (a2 - 1.0) + 1.0;
  float d = a2 / (3.14159265 * t * t);
  float g = 0.5 / (nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2) + 1e-5);
  vec3 f0 = mix(vec3(0.04), p.base, p.metallic);
  vec3 f = f0 + (1.0 - f0) * pow(1.0 - max(dot(p.v, h), 0.0), 5.0);
  o_color = vec4((d * g * f + p.base * ((1.0 - p.metallic) / 3.14159265)) * (3.0 * nl), 1.0);
}
)"},
    {"light from an image, six lookups", R"(
void main() {
  Point p = point();
  float cosine = max(dot(p.n, p.v), 1e-3);
  vec3 f0 = mix(vec3(0.04), p.base, p.metallic);
  vec2 ab = texture(table, vec2(cosine, p.rough)).xy;
  vec3 mirrored = textureLod(specular, reflect(-p.v, p.n), p.rough * 6.0).rgb;
  vec3 around = texture(diffuse, p.n).rgb;
  o_color = vec4(mirrored * (f0 * ab.x + ab.y) + around * p.base * (1.0 - p.metallic), 1.0);
}
)"},
};

gl::Texture flat_map(int size, bool srgb = false) {
  gl::Texture texture;
  std::vector<unsigned char> texels(static_cast<std::size_t>(size) * static_cast<std::size_t>(size) * 4);
  for (std::size_t i = 0; i < texels.size(); ++i) texels[i] = static_cast<unsigned char>((i * 2654435761u) >> 24);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, srgb ? GL_SRGB8_ALPHA8 : GL_RGBA8, size, size, 0, GL_RGBA, GL_UNSIGNED_BYTE,
               texels.data());
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

void print_times(int width, int height) {
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
  const std::vector<gl::Texture> maps = [] {
    std::vector<gl::Texture> all;
    all.reserve(4);
    for (int i = 0; i < 3; ++i) all.push_back(flat_map(2048, i == 0));
    all.push_back(flat_map(64));
    return all;
  }();
  const gl::Texture specular = cube_map(256), diffuse = cube_map(32);
  for (const Shader& shader : kShaders) {
    const gl::Program program(kVertex, std::string(kHead) + shader.main);
    glUseProgram(program.id());
    for (std::size_t i = 0; i < 4; ++i) program.bind(kMaps[i], GL_TEXTURE_2D, maps[i]);
    program.bind("specular", GL_TEXTURE_CUBE_MAP, specular);
    program.bind("diffuse", GL_TEXTURE_CUBE_MAP, diffuse);
    constexpr int kFrames = 16;
    std::chrono::steady_clock::time_point start;
    for (int i = 0; i <= kFrames; ++i) {
      if (i == 1) start = std::chrono::steady_clock::now();  // the first compiles
      glDrawArrays(GL_TRIANGLES, 0, 3);
      glFinish();
    }
    const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    gl::check("drawing");
    std::printf("%6.1f  %s\n", ms / kFrames, shader.name);
  }
}

}  // namespace

int main(int argc, char** argv) {
  int width = 1280, height = 720;
  if (argc > 1 && std::sscanf(argv[1], "%dx%d", &width, &height) != 2) return 2;
  try {
    print_times(width, height);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
