#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "io/gltf_accessor.h"
#include "io/gltf_nodes.h"
#include "scene/material_table.h"
#include "scene/scene.h"

namespace candela::io {

/// Metres; coordinates whose cross products and squared distances still fit in a float with room to spare.
inline constexpr float kLargestCoordinate = 1e9f;

/// How one node shows a mesh.
struct MeshPose {
  std::vector<float> weights;  ///< of the morph targets; missing ones count 0
  std::vector<mat4> joints;    ///< world from bind pose, one per joint of the skin; empty = not skinned
};

/// World-from-bind matrices of a skin (glTF 2.0 §3.7.3.1), checked and counted.
std::vector<mat4> read_skin(const JsonView& skin, const std::vector<FileNode>& nodes, AccessorReader& reader);

/// One of the file's KHR_materials_variants.
struct Variant {
  std::size_t index = 0;
  std::size_t count = 0;  ///< how many there are
};

/// The file's index of the material that a primitive wears under `variant`; none = glTF's default.
std::optional<std::size_t> material_of_primitive(const JsonView& primitive, std::size_t material_count,
                                                 const std::optional<Variant>& variant);

/// How a primitive's indices become triangles, glTF 2.0 §3.7.2.1 (4 a list, 5 a strip, 6 a fan). What Draco data holds
/// is a list, also of a primitive that was a strip before it was compressed.
std::uint64_t mode_of_primitive(const JsonView& primitive);

/// "TEXCOORD_n"
std::string uv_set_name(std::size_t set);

/// What a material wants of the vertices that wear it: the same geometry serves materials that want the same.
struct VertexNeeds {
  std::array<int, kTextureSlots> uv_sets{};  ///< -1: none
  bool has_tangents = false;
  std::array<vec2, 2> tangent_space{};  ///< how the texture that tangents follow is turned and stretched

  bool operator==(const VertexNeeds&) const = default;
};

/// Turns primitives into triangles as the scene promises them.
class MeshReader {
 public:
  /// `materials` are the scene's; `material_of_file` maps the file's indices to them, `default_material` stands in.
  MeshReader(AccessorReader& reader, Warnings& warnings, std::span<const Material> materials,
             std::span<const int> material_of_file, int default_material, std::optional<Variant> variant)
      : reader_(reader),
        warnings_(warnings),
        materials_(materials),
        material_of_file_(material_of_file),
        default_material_(default_material),
        variant_(variant) {}

  /// The same for another thread.
  MeshReader(const MeshReader& other, AccessorReader& reader, Warnings& warnings)
      : MeshReader(reader, warnings, other.materials_, other.material_of_file_, other.default_material_,
                   other.variant_) {}

  /// `sources`: which of the file's primitives each of the mesh is.
  Mesh read(const JsonView& json, int file_index, const MeshPose& pose, std::vector<std::size_t>* sources = nullptr);

  /// The mesh as its accessors describe it, of stand-ins; empty where only unpacking it would show all that is counted
  /// or measured. Tangents that are to be made are such a thing: they split vertices.
  std::optional<Mesh> read_outline(const JsonView& json, int file_index, const JsonView& root, GltfBuffers& buffers);

  /// What each of the file's primitives of a mesh wears, -1 where it is not read.
  std::vector<int> materials(const JsonView& json) const;
  /// Of the materials of each primitive of a mesh.
  std::vector<VertexNeeds> needs(const JsonView& json) const;

  /// Says once how many primitives were points or lines, of this reader and of those that were added.
  void report_ignored(const JsonView& root);
  void add_ignored(std::size_t count) { ignored_ += count; }
  std::size_t ignored() const { return ignored_; }

 private:
  std::optional<Primitive> read_primitive(const JsonView& json, const MeshPose& pose);
  std::vector<uvec3> read_triangles(const JsonView& json, std::uint64_t mode, std::size_t vertex_count);
  /// Of uv sets the first two, and those that the material reads.
  Primitive read_vertices(const JsonView& attributes, const Accessor& positions, const Selection& selection,
                          int material);
  std::vector<vec4> read_colors(const JsonView& attributes, std::size_t vertex_count, const Selection& selection,
                                float alpha);
  void apply_morph(const JsonView& json, const std::vector<float>& weights, std::size_t vertex_count,
                   const Selection& selection, Primitive& primitive);
  void apply_skin(const JsonView& attributes, const std::vector<mat4>& joints, std::size_t vertex_count,
                  const Selection& selection, Primitive& primitive);
  template <class V>
  std::vector<V> read_attribute(const JsonView& attributes, const char* name, const char* type,
                                std::size_t vertex_count, const Selection& selection);
  void finish_normals(const JsonView& json, Primitive& primitive);
  void finish_tangents(const JsonView& json, Primitive& primitive);
  void fill_missing_uvs(const JsonView& json, Primitive& primitive);
  void warn_of_missing_uvs(const JsonView& json, const Material& material, int uv_set);
  void note_unread_colors(const JsonView& reference);
  int material_of(const JsonView& primitive) const;
  bool makes_tangents(const JsonView& primitive) const;

  AccessorReader& reader_;
  Warnings& warnings_;
  std::span<const Material> materials_;
  std::span<const int> material_of_file_;
  int default_material_;
  std::optional<Variant> variant_;
  std::size_t ignored_ = 0;
};

}  // namespace candela::io
