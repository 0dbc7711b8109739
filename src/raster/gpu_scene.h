#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "base/diagnostics.h"
#include "gl/gl.h"
#include "raster/opacity.h"
#include "raster/packing.h"
#include "raster/programs.h"
#include "scene/scene.h"
#include "shade/model.glsl.h"

namespace candela::raster {

/// One primitive in buffers of the driver.
struct GpuPrimitive {
  gl::Buffer vertices, indices;
  gl::Buffer more_uvs;  ///< beyond the first two sets; empty where the material reads none
  gl::VertexArray attributes;
  GLsizei index_count = 0;
  int material = 0;
  bool has_colors = false, has_tangents = false;
  Box3 bounds;        ///< in the mesh's space
  vec3 middle{0.0f};  ///< of them, which vertices are relative to
};

struct GpuMaterial {
  std::string name;
  std::vector<int> more_sets;  ///< numbers of the uv sets that it reads besides 0 and 1, ascending
  MaterialKey key;
  GLintptr block = 0;                            ///< its place in the buffer of all materials
  std::array<GLuint, kTextureSlots> textures{};  ///< 0 where the slot is empty
  std::array<GLuint, kTextureSlots> samplers{};
  bool is_double_sided = false;
  AlphaRange alpha;              ///< of factor and texture
  bool has_opaque_part = false;  ///< blended, and somewhere nothing shows through

  bool is_transmissive() const;
  /// Whether something may show through: what is left of BLEND where it is not opaque.
  bool is_blended() const { return key.alpha_mode == AlphaMode::blend; }
};

/// How a sampler reads: texels as they are, between them, or between them and along a pixel's footprint.
enum class Reading { nearest, isotropic, anisotropic };

/// A primitive of a node.
struct Draw {
  int primitive = 0;
  int node = 0;
  int number = 0;        ///< of the node, as people know it
  std::size_t part = 0;  ///< which primitive of the node's mesh
  bool is_mirrored = false;
  Box3 bounds;  ///< relative to the scene's origin
  vec3 center{0.0f};
};

/// Some of the triangles of a primitive, in a buffer of their own.
struct GpuTriangles {
  gl::Buffer indices;
  GLsizei index_count = 0;
};

/// A scene as the driver has it. What one moment of it shares with the next is uploaded once.
///
/// Positions are relative to an origin near the eye, subtracted in double precision, so that floats hold what is seen
/// however far from the world's own origin it is.
class GpuScene {
 public:
  /// Warns of what the driver cannot hold as it is.
  GpuScene(const Scene& scene, const shade::ShadingModel& model, Diagnostics& diagnostics);

  /// Another moment of the same scene: materials that differ, meshes that are not known to be the same.
  void set_scene(const Scene& scene, Diagnostics& diagnostics);
  /// Places the draws of the scene that was given last about another origin (world).
  void set_origin(const Scene& scene, vec3 origin);
  vec3 origin() const { return origin_; }
  /// The same transform, to positions relative to the origin.
  mat4 relative(const mat4& world_from_node) const;

  const std::vector<GpuPrimitive>& primitives() const { return primitives_; }
  const GpuMaterial& material_of(const Draw& draw) const {
    return materials_[static_cast<std::size_t>(primitives_[static_cast<std::size_t>(draw.primitive)].material)];
  }
  /// Those of one primitive and side stand beside each other.
  const std::vector<Draw>& draws() const { return draws_; }
  /// Relative to the origin.
  const Box3& bounds() const { return bounds_; }
  /// Of a draw, as the scene that was given last has them.
  const std::vector<uvec3>& triangles(const Scene& scene, std::size_t draw) const {
    const Draw& d = draws_[draw];
    return scene.meshes[static_cast<std::size_t>(scene.nodes[static_cast<std::size_t>(d.node)].mesh)]
        .primitives[d.part]
        .triangles;
  }
  /// How often textures are read along the longer side of a pixel's footprint, at most, where the driver can.
  void set_texture_anisotropy(int most);
  bool has_lobe(int lobe) const;
  bool has_scattering() const;
  std::uint64_t triangle_count() const { return triangle_count_; }

  /// Binds the block of a material, and those of its textures that the program reads.
  void bind_material(const GpuMaterial& material, const gl::Program& program) const;
  /// Draws `count` neighbours in draws(), all of one primitive and side, with the program in use.
  void draw(std::size_t first, std::size_t count = 1) const;
  /// The same with vertices of its own for each triangle, three after the other in the order of the scene that was
  /// given last: gl_VertexID tells which triangle and which corner.
  void draw_corners(const Scene& scene, std::size_t first, std::size_t count);
  /// Some triangles of one draw.
  void draw(std::size_t draw, const GpuTriangles& triangles) const;
  bool are_alike(std::size_t a, std::size_t b) const {
    return draws_[a].primitive == draws_[b].primitive && draws_[a].is_mirrored == draws_[b].is_mirrored;
  }

 private:
  /// Vertices are relative to `middle`, or without one to that of the bounds.
  GpuPrimitive upload(const Primitive& primitive, std::optional<vec3> middle = std::nullopt) const;
  void set_meshes(const Scene& scene);
  void find_attributes();
  void find_alpha_modes(const Scene& scene);
  void set_materials(const Scene& scene, Diagnostics& diagnostics);
  void keep_textures(const Scene& scene);
  AlphaRange alpha_of(const Scene& scene, const Material& material);
  void add_draws(const Scene& scene);
  void place_draws(const Scene& scene);
  void bind_draw(const GpuPrimitive& primitive, std::size_t first) const;
  GLuint texture_for(const Scene& scene, const TextureSource& source, Diagnostics& diagnostics);
  GLuint sampler_for(const Texture& texture, Reading reading);

  shade::ShadingModel model_;
  std::vector<GpuPrimitive> primitives_;
  std::map<std::size_t, GpuPrimitive> corners_;      ///< of those that draw_corners() has drawn
  std::vector<std::size_t> first_primitive_;         ///< of each mesh
  std::vector<std::shared_ptr<const void>> meshes_;  ///< identities of those that primitives_ are of
  std::vector<GpuMaterial> materials_;
  /// What materials_ and textures_ were made of.
  std::vector<Material> uploaded_materials_;
  std::vector<Texture> uploaded_textures_;
  std::vector<std::shared_ptr<const TextureImage>> images_;
  std::map<const TextureImage*, AlphaRange> alphas_;  ///< of some of images_
  gl::Buffer material_blocks_;
  gl::Buffer transforms_;  ///< world_from_object of each draw, three rows, and its node's colour
  std::map<TextureSource, gl::Texture> textures_;
  std::map<std::tuple<GLint, GLint, Reading>, gl::Sampler> samplers_;  ///< by both wraps
  int texture_anisotropy_ = 1;
  std::vector<Draw> draws_;
  Box3 bounds_;
  vec3 origin_{0.0f};
  std::uint64_t triangle_count_ = 0;
};

}  // namespace candela::raster
