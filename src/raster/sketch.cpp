#include "raster/sketch.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "gl/gl.h"
#include "raster/camera.h"
#include "raster/targets.h"

namespace candela::raster {

namespace {

constexpr const char* kVertex = R"(#version 300 es
precision highp float;
uniform mat4 clip_from_mesh;
uniform mat4 camera_from_mesh;
layout(location = 0) in vec3 a_position;
layout(location = 1) in vec3 a_normal;
out vec3 v_position;
out vec3 v_normal;
void main() {
  v_position = (camera_from_mesh * vec4(a_position, 1.0)).xyz;
  v_normal = mat3(camera_from_mesh) * a_normal;
  gl_Position = clip_from_mesh * vec4(a_position, 1.0);
}
)";

// The lamp is at the eye; a little comes from all around.
constexpr const char* kFragment = R"(#version 300 es
precision highp float;
uniform vec3 color;
uniform float is_perspective;
in vec3 v_position;
in vec3 v_normal;
layout(location = 0) out vec4 o_color;
void main() {
  vec3 wo = normalize(mix(vec3(0.0, 0.0, 1.0), -v_position, is_perspective));
  vec3 shown = color * (0.2 + 0.8 * abs(dot(normalize(v_normal), wo)));
  o_color = vec4(pow(clamp(shown, 0.0, 1.0), vec3(1.0 / 2.2)), 1.0);
}
)";

constexpr vec3 kBackground{0.2f, 0.21f, 0.23f};  // sRGB

/// One part of a mesh with the driver.
struct SketchPart {
  gl::Buffer vertices, indices;
  gl::VertexArray attributes;
  GLsizei index_count = 0;
  vec3 color{0.0f};
};

void upload(const Primitive& primitive, SketchPart& part) {
  std::vector<vec3> vertices;
  vertices.reserve(2 * primitive.positions.size());
  for (std::size_t i = 0; i < primitive.positions.size(); ++i) {
    vertices.push_back(primitive.positions[i]);
    vertices.push_back(primitive.normals[i]);
  }
  part.index_count = static_cast<GLsizei>(3 * primitive.triangles.size());
  glBindVertexArray(part.attributes);
  glBindBuffer(GL_ARRAY_BUFFER, part.vertices);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(vec3)), vertices.data(),
               GL_STATIC_DRAW);
  for (const GLuint i : {0u, 1u}) {
    glEnableVertexAttribArray(i);
    // NOLINTNEXTLINE(performance-no-int-to-ptr): an offset, as OpenGL has it
    const auto* place = reinterpret_cast<const void*>(i * sizeof(vec3));
    glVertexAttribPointer(i, 3, GL_FLOAT, GL_FALSE, 2 * sizeof(vec3), place);
  }
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, part.indices);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(primitive.triangles.size() * sizeof(uvec3)),
               primitive.triangles.data(), GL_STATIC_DRAW);
  glBindVertexArray(0);
}

/// What the eye can tell of a material without its textures.
vec3 plain_color(const Material& material) { return glm::min(material.base_color + material.emission, vec3(1.0f)); }

/// How near and how far the corners of a box are along a view.
DepthRange range_of(const Box3& bounds, const mat4& camera_from_world, bool is_perspective) {
  DepthRange range{kInfinity, -kInfinity};
  for (int i = 0; i < 8; ++i) {
    const vec3 corner((i & 1) != 0 ? bounds.upper.x : bounds.lower.x, (i & 2) != 0 ? bounds.upper.y : bounds.lower.y,
                      (i & 4) != 0 ? bounds.upper.z : bounds.lower.z);
    const float depth = -transform_point(camera_from_world, corner).z;
    range.near = std::min(range.near, depth);
    range.far = std::max(range.far, depth);
  }
  // Of what surrounds the eye a depth of 24 bits cannot tell more.
  constexpr float kLeastShare = 1e-4f;
  if (!(range.far > 0.0f) || !std::isfinite(range.far)) return {};
  if (is_perspective) range.near = std::max(0.99f * range.near, kLeastShare * range.far);
  if (range.far <= range.near) range.far = range.near + 1.0f;
  return range;
}

}  // namespace

class Sketch::Impl {
 public:
  Impl(const Scene& scene, std::shared_ptr<Device> device) : device_(std::move(device)), bounds_(world_bounds(scene)) {
    device_->use();
    program_ = std::make_unique<gl::Program>(kVertex, kFragment);
    for (const Mesh& mesh : scene.meshes) {
      first_part_.push_back(parts_.size());
      for (const Primitive& primitive : mesh.primitives) {
        SketchPart& part = parts_.emplace_back();
        upload(primitive, part);
        part.color = plain_color(scene.materials[static_cast<std::size_t>(primitive.material)]);
      }
    }
    first_part_.push_back(parts_.size());
    for (const Node& node : scene.nodes) {
      if (node.mesh >= 0) placed_.push_back({static_cast<std::size_t>(node.mesh), node.world_from_node});
    }
    gl::check("uploading the scene");
  }
  ~Impl() {
    // What the driver holds is given back to its own context.
    device_->use();
    parts_.clear();
    program_.reset();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  DisplayImage draw(const View& view, ivec2 size) {
    device_->use();
    const gl::Framebuffer framebuffer;
    const gl::Renderbuffer color, depth;
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glBindRenderbuffer(GL_RENDERBUFFER, color);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, size.x, size.y);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color);
    glBindRenderbuffer(GL_RENDERBUFFER, depth);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, size.x, size.y);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth);
    check_framebuffer("a picture of bytes");
    glViewport(0, 0, size.x, size.y);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glClearColor(kBackground.x, kBackground.y, kBackground.z, 1.0f);
    glClearDepthf(1.0f);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    draw_parts(view, size);
    gl::check("drawing a sketch");
    return read_bytes(size.x, size.y);
  }

 private:
  struct Placed {
    std::size_t mesh;
    mat4 world_from_mesh;
  };

  void draw_parts(const View& view, ivec2 size) const {
    const mat4 camera_from_world = glm::inverse(view.world_from_camera);
    const bool is_perspective = std::holds_alternative<PerspectiveCamera>(view.projection);
    const FrameCamera camera = frame_camera(view, size.x, size.y, range_of(bounds_, camera_from_world, is_perspective));
    glUseProgram(program_->id());
    glUniform1f(program_->uniform("is_perspective"), is_perspective ? 1.0f : 0.0f);
    for (const Placed& placed : placed_) {
      const mat4 camera_from_mesh = camera_from_world * placed.world_from_mesh;
      const mat4 clip_from_mesh = camera.clip_from_camera * camera_from_mesh;
      glUniformMatrix4fv(program_->uniform("camera_from_mesh"), 1, GL_FALSE, &camera_from_mesh[0].x);
      glUniformMatrix4fv(program_->uniform("clip_from_mesh"), 1, GL_FALSE, &clip_from_mesh[0].x);
      for (std::size_t p = first_part_[placed.mesh]; p < first_part_[placed.mesh + 1]; ++p) {
        glUniform3fv(program_->uniform("color"), 1, &parts_[p].color.x);
        glBindVertexArray(parts_[p].attributes);
        glDrawElements(GL_TRIANGLES, parts_[p].index_count, GL_UNSIGNED_INT, nullptr);
      }
    }
    glBindVertexArray(0);
  }

  std::shared_ptr<Device> device_;
  Box3 bounds_;
  std::unique_ptr<gl::Program> program_;
  std::vector<SketchPart> parts_;
  std::vector<std::size_t> first_part_;  ///< of each mesh, and their number
  std::vector<Placed> placed_;
};

Sketch::Sketch(const Scene& scene, std::shared_ptr<Device> device)
    : impl_(std::make_unique<Impl>(scene, std::move(device))) {}

Sketch::~Sketch() = default;

DisplayImage Sketch::draw(const View& view, ivec2 size) { return impl_->draw(view, size); }

}  // namespace candela::raster
