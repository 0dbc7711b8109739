#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "foreign/measures.h"
#include "scene/scene.h"

namespace candela::io {

struct LoadOptions {
  /// False: images carry only width and height (their pixels stay empty), which is fast; such a scene fails validate().
  bool decode_images = true;
  /// Name of the KHR_materials_variants variant to wear; empty = the materials that the primitives name themselves. A
  /// name that the file has not is an Error that lists those it has.
  std::string variant = {};
  /// False: an unknown required extension is a warning, to look into files that cannot be rendered.
  bool refuse_unknown_required = true;
  /// A folder in which the file and everything it names must lie, all links resolved; what leads out of it is an Error.
  /// Empty = wherever the names lead.
  std::filesystem::path root = {};
  /// A name or an index of the file's scenes; empty = its default scene (else its first, else all root nodes). One that
  /// the file has not is an Error that lists those it has.
  std::string scene = {};
  /// The unit and the upward axis of an OBJ, an STL or a PLY, which say neither; of any other file it is an Error.
  foreign::Measures measures = {};
  /// False: a packed mesh (Draco, meshopt) is not unpacked where its accessors say what it holds, but is a box: that
  /// which they claim it spans, with as many vertices and triangles as they claim, to be counted and measured at once.
  /// So are meshes that no node turns off the axes, no weight and no skin moves, that have bounds, and whose material
  /// asks for no tangents that the file has not; all others are read. Damage in what is not unpacked goes unseen, and
  /// such a scene fails validate().
  bool unpack_geometry = true;
  /// Most bytes that the materials' images may take; 0 = as many as they have. The largest are halved, each texel the
  /// mean of those that it replaces, in linear light where they are colours, until all fit, which is one warning. While
  /// they are read, one more is there at its full size. An Error where even one texel of each is too much.
  std::uint64_t texture_memory = 0;
  /// True: it is what the rasterizer keeps of them that has to fit, with all smaller levels.
  bool counts_texture_levels = false;
};

/// A moment of an animation.
struct Pose {
  /// A name or an index; "all" plays every one together; empty = the first, or none where the file has none. A name
  /// that the file has not is an Error that lists those it has.
  std::string animation = {};
  double time_s = 0.0;  ///< since its start; beyond its end it stays there
};

struct AnimationInfo {
  std::string name;
  float duration_s = 0.0f;
  int channels = 0;
  std::vector<std::string> pointers;  ///< what KHR_animation_pointer moves, as the file names it
};

/// A file that a scene is made of.
struct ReferencedFile {
  std::filesystem::path path;
  std::string place;  ///< the JSON pointer of what names it, after a #; empty of the .gltf or .glb itself
};

/// What a file says about itself and the scene does not keep.
struct FileInfo {
  std::string format = "glTF";  ///< what the file is: the others are read as the glTF that is made of them
  std::string generator;
  std::string version;
  std::string copyright;
  std::vector<std::string> extensions_used;
  std::vector<std::string> extensions_required;
  std::vector<std::string> extensions_ignored;  ///< used, but not supported
  std::vector<std::string> extensions_unseen;   ///< used and not read, because they change no pixel
  std::vector<std::string> variants;            ///< names of KHR_materials_variants
  std::vector<std::string> extensions_missing;  ///< required, but not supported
  std::vector<AnimationInfo> animations;
  std::vector<std::string> scenes;  ///< their names, empty where a scene has none
  std::size_t scene = 0;            ///< the one that is read, of scenes
  int skins = 0;
  std::size_t file_bytes = 0;  ///< of the .gltf or .glb itself
  std::string archive_entry;   ///< its name in the .zip that holds it; empty where it is a file of its own
  /// All that it names, whether the scene needs them or not, whether they are there or not; first the file itself.
  std::vector<ReferencedFile> files;
};

/// FileInfo::files without reading more than the document. Throws Error where it is none, and where it lies outside of
/// `root` (LoadOptions::root).
std::vector<ReferencedFile> files_of_gltf(const std::filesystem::path& path, const std::filesystem::path& root = {});

/// Loads a .gltf or .glb, a file of another format (foreign/formats.h), or the one of them that a .zip holds, which
/// reads nothing outside of the .zip; told apart by their content. Every number is checked before it is used; on bad
/// input throws Error whose `where` is the file and, where there is one, the JSON pointer. An unknown required
/// extension is an Error that names it; unknown optional ones and recoverable oddities go to `diagnostics`, as notes
/// where they change no pixel. The result passes validate().
///
/// An image that is missing or damaged is a warning; textures of it are as if the file had none, so that the factors
/// beside them count alone, but what an emissive texture should say glows is dark: a factor is the brightest that the
/// texture may make it, and would make the whole surface a lamp.
///
/// The scene is the file's default one, or LoadOptions::scene. It holds what that scene uses and
/// nothing else, renumbered without gaps in the file's order: other nodes, meshes, materials, images, cameras and
/// lights are neither read nor decoded. Morph targets and skins are applied as the nodes stand (a mesh
/// appears once per pose); a skinned mesh, whose node's own transform glTF ignores, moves to a root node of the same
/// name and number after the file's nodes; so do the instances of EXT_mesh_gpu_instancing, as children, with their
/// _COLOR_0 as Node::color; the IES light of a node that has a punctual one too becomes its child there, and
/// a lamp of EXT_lights_area a root node there with a mesh and a material of its own (Material::is_lamp). Triangles
/// without an area and vertices without a triangle are dropped. What KHR_node_visibility hides is left out: its nodes
/// stand, with their cameras, but hold nothing else; it is read where an animation may show it. Every uv set that a
/// primitive's material reads is present, as zeros where the file has none. Coordinates stay within 1e9 metres.
///
/// Everything is as the file has it at rest; GltfFile has it at any moment of its animations.
Scene load_gltf(const std::filesystem::path& path, Diagnostics& diagnostics);
Scene load_gltf(const std::filesystem::path& path, Diagnostics& diagnostics, const LoadOptions& options,
                FileInfo* info = nullptr);

/// The same from memory (GLB or JSON text), for tests and fuzzing; `base_folder` resolves external files, empty =
/// refuse them.
Scene load_gltf(std::span<const std::byte> bytes, const std::filesystem::path& base_folder, Diagnostics& diagnostics);
Scene load_gltf(std::span<const std::byte> bytes, const std::filesystem::path& base_folder, Diagnostics& diagnostics,
                const LoadOptions& options, FileInfo* info = nullptr);

/// A file kept open: its scene at any moment. What does not move is read and decoded once, meshes of a file
/// without animations for each scene.
class GltfFile {
 public:
  /// As load_gltf(); says in `info` what is known before the scene is read.
  GltfFile(const std::filesystem::path& path, Diagnostics& diagnostics, const LoadOptions& options = {},
           FileInfo* info = nullptr);
  GltfFile(std::vector<std::byte> bytes, const std::filesystem::path& base_folder, std::string label,
           Diagnostics& diagnostics, const LoadOptions& options = {}, FileInfo* info = nullptr);
  ~GltfFile();
  GltfFile(const GltfFile&) = delete;
  GltfFile& operator=(const GltfFile&) = delete;

  const FileInfo& info() const;
  /// Indices into info().animations of what Pose::animation names; throws Error as there.
  std::vector<std::size_t> find_animations(const std::string& name) const;
  /// The scene as it stands, or as an animation has it. Two scenes of one file have the same nodes of the file,
  /// materials, cameras and lights, whose numbers differ where an animation moves them; images too, unless a material
  /// at a moment does not read one; meshes differ where they are skinned or morphed, or where a texture turns that
  /// tangents follow; what nodes hold, where they are hidden.
  /// With `variant` it wears that one in place of LoadOptions::variant.
  Scene scene(Diagnostics& diagnostics, const std::optional<Pose>& pose = std::nullopt,
              const std::optional<std::string>& variant = std::nullopt);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace candela::io
