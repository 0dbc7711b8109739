#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "path/medium.h"
#include "path/texture.h"
#include "scene/material_table.h"
#include "scene/scene.h"
#include "shade/surface_params.glsl.h"

namespace candela::path {

/// Slots that every surface may fill, whose texels are located together before the first is read.
inline constexpr std::array<std::size_t, 6> kBaseTextures = {
    texture_slot_index(&Material::base_color_texture), texture_slot_index(&Material::metallic_roughness_texture),
    texture_slot_index(&Material::normal_texture),     texture_slot_index(&Material::emissive_texture),
    texture_slot_index(&Material::specular_texture),   texture_slot_index(&Material::specular_color_texture)};

/// A material with its textures resolved.
struct MaterialData {
  Material factors;
  shade::SurfaceParams params;                        ///< the factors, as the surface takes them
  std::array<TextureReader, kTextureSlots> textures;  ///< by the rows of kTextureRows
  Medium medium;
  bool needs_opacity = false;   ///< mask or blend that can let light through
  bool is_clear_sheet = false;  ///< may let shadow rays straight through
  bool has_medium = false;      ///< bounds a body that light can enter
  bool needs_tangents = false;
  bool is_emissive = false;
  bool has_one_footprint = false;  ///< kBaseTextures have texels at the same places

  MaterialData(const Scene& scene, const Material& material, const shade::ShadingModel& model);

  /// texture<&Material::normal_texture>()
  template <TextureSlot Material::*kSlot>
  const TextureReader& texture() const {
    return textures[texture_slot_index(kSlot)];
  }
  bool has_scatter_texture() const {
    return bool(texture<&Material::scatter_strength_texture>()) ||
           bool(texture<&Material::multiscatter_color_texture>());
  }
};

/// What a bounce reads of a vertex, packed so that it costs one cache line.
struct ShadeVertex {
  vec3 position;
  vec3 normal;
  vec2 uv0;
};

/// One primitive as the path tracer stores it; in world space when it is placed once. What is the same there as in the
/// scene is the scene's own array.
struct MeshData {
  std::vector<ShadeVertex> vertices;
  std::span<const uvec3> triangles;
  std::span<const vec4> tangents;
  std::span<const vec2> uv1;
  std::vector<std::pair<int, std::span<const vec2>>> more_uvs;  ///< further sets, by number
  std::span<const vec4> colors;
  const MaterialData* material = nullptr;
  bool is_mirrored = false;  ///< in world space, by a node of negative determinant: the winding is reversed
  int divisions = 1;         ///< of each side of the scene's triangles, see displaced()

  /// Without such a set the first serves.
  vec2 uv(const uvec3& t, vec3 b, int set) const;
  vec4 color(const uvec3& t, vec3 b) const;
  /// Base colour alpha after the alpha mode: 0 or 1 for masks. `t` a triangle, `b` barycentric weights.
  float opacity(const uvec3& t, vec3 b) const;

  // What the arrays above show where they are not the scene's.
  Primitive own;  ///< of a material with a height texture, and of the ground
  std::vector<vec4> own_tangents;
  std::vector<vec4> own_colors;
};

/// A primitive of a node: which data, and how it stands in the world.
struct Placement {
  const MeshData* mesh = nullptr;
  mat4 world_from_object{1.0f};
  mat3 world_from_normal{1.0f};  ///< inverse transpose
  bool is_world = false;         ///< the mesh already is in world space
  bool is_mirrored = false;      ///< negative determinant: the winding is reversed
  int node = -1;
  int primitive = 0;          ///< of the node's mesh
  int body = 0;               ///< the body that its faces bound, see find_bodies; 0 = none
  vec3 color{1.0f};           ///< multiplies the base colour; the node's opacity is in its mesh
  int first_light = -1;       ///< index of triangle 0 among the emissive triangles
  bool is_ground = false;     ///< of Scene::ground
  bool shares_plane = false;  ///< with another surface, see Geometry::in_front
};

struct Hit {
  int placement = -1;  ///< -1 = nothing
  std::uint32_t triangle = 0;
  float t = kInfinity;
  float u = 0.0f, v = 0.0f;
  std::uint32_t seed = 0;  ///< what decided along its ray whether blended surfaces are there

  explicit operator bool() const { return placement >= 0; }
};

struct Ray {
  vec3 origin;
  vec3 direction;
  float t_min = 0.0f;
  float t_max = kInfinity;
};

/// A body that light can enter. Its faces may belong to several materials, primitives and nodes.
struct Body {
  bool is_open = false;  ///< some edge has no face on its other side
  Box3 bounds;
};

/// Sixteen camera rays, traced together.
struct RayPacket {
  static constexpr int kSize = 16;
  Ray rays[kSize];
  std::uint32_t seeds[kSize];
  bool active[kSize];
};

/// Everything that rays can hit: Embree's tree, and the data to shade a hit. Meshes used by many nodes are stored once.
class Geometry {
 public:
  /// Keeps no copy of what it can read in `scene`, which must outlive it. All coordinates are relative to `origin`.
  explicit Geometry(const Scene& scene, const shade::ShadingModel& model = shade::shading_model_candela(),
                    vec3 origin = vec3(0.0f));
  ~Geometry();
  Geometry(const Geometry&) = delete;
  Geometry& operator=(const Geometry&) = delete;

  /// Gives it the materials of a scene that is otherwise the same. False, and nothing has changed, where what is built
  /// depends on what is different: relief, bodies, tangents, what rays may pass. No ray may be under way.
  bool set_materials(const Scene& scene, const shade::ShadingModel& model);

  /// Closest hit. Alpha is a stochastic decision per surface, drawn from `seed`: accepted hits are opaque.
  Hit intersect(const Ray& ray, std::uint32_t seed) const;
  void intersect(const RayPacket& packet, Hit (&hits)[RayPacket::kSize]) const;

  /// The closest hit that the eye sees: the backs that it looks through are not there, see is_culled_back.
  Hit intersect_visible(const Ray& ray, std::uint32_t seed) const;
  /// The first surface of the layers: as the eye sees it, and of opacity at least ½. No chance is in it, and no ground.
  Hit first_surface(const Ray& ray) const;
  /// All surfaces along the ray that first_surface() might find, were nothing before them, in no order.
  std::vector<Hit> all_surfaces(const Ray& ray) const;
  /// The closest hit on another surface than any of `passed`, which the same ray has met. See is_one_surface.
  Hit intersect_beyond(const Ray& ray, std::uint32_t seed, std::span<const Hit> passed) const;
  /// All faces of bodies along the ray, in no order.
  std::vector<Hit> find_boundaries(const Ray& ray) const;

  /// A hit by Embree's numbers, without its distance.
  Hit hit(unsigned instance, unsigned geometry, unsigned triangle, float u, float v) const;

  /// Fraction of light that passes along the segment: 0, 1, or the product of 1 - opacity of blended surfaces and of
  /// what smooth sheets let straight through.
  vec3 transmittance(const Ray& ray) const;
  /// The same of one surface.
  vec3 transmittance(const Hit& hit, vec3 direction) const;
  /// The same of all that is in front of `hit` in its plane, on the side of the unit normal `n`.
  vec3 transmittance_over(const Hit& hit, vec3 n, vec3 direction) const;

  const Placement& placement(int index) const { return placements_[static_cast<std::size_t>(index)]; }
  std::vector<Placement>& placements() { return placements_; }
  const std::vector<Placement>& placements() const { return placements_; }
  const Box3& bounds() const { return bounds_; }
  /// Where in the world its coordinates begin.
  vec3 origin() const { return origin_; }
  /// Whether light can enter bodies.
  bool has_media() const { return has_media_; }
  /// That of the scene, or null.
  const Ground* ground() const { return ground_ ? &*ground_ : nullptr; }
  /// Whether some surface is there by chance.
  bool has_blends() const { return has_blends_; }
  /// By Placement::body; the first stands for none.
  const std::vector<Body>& bodies() const { return bodies_; }
  std::uint64_t triangle_count() const { return triangle_count_; }
  std::uint64_t instance_count() const { return instance_count_; }

 private:
  struct Impl;
  struct Query;
  void find_kinds();
  void find_shared_planes();
  void add_ground(const Scene& scene, const shade::ShadingModel& model, unsigned id);
  Hit intersect(const Ray& ray, Query& query) const;
  /// Of the surfaces that lie in one plane where the ray has met one, the same for every ray: what Embree finds of them
  /// is up to rounding.
  Hit in_front(const Hit& met, const Ray& ray, Query& query) const;
  /// The other surfaces in the plane of a hit, whose unit normal is `n`, at its place.
  std::vector<Hit> in_plane_with(const Hit& hit, vec3 n) const;
  std::vector<Hit> collect(const Ray& ray, Query& query) const;

  std::unique_ptr<Impl> impl_;
  std::deque<MaterialData> materials_;  ///< meshes point to them
  std::vector<std::unique_ptr<MeshData>> meshes_;
  std::vector<Placement> placements_;
  vec3 origin_;
  Box3 bounds_;
  std::vector<Body> bodies_;
  std::optional<Ground> ground_;
  bool has_media_ = false;
  bool has_blends_ = false;
  std::uint64_t triangle_count_ = 0;
  std::uint64_t instance_count_ = 0;
};

/// World-space corners of a triangle.
struct TrianglePositions {
  vec3 p0, p1, p2;

  vec3 at(float u, float v) const { return p0 * (1.0f - u - v) + p1 * u + p2 * v; }
};
TrianglePositions triangle_positions(const Placement& placement, std::uint32_t triangle);

}  // namespace candela::path
