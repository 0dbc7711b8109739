#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <tuple>
#include <vector>

#include "io/gltf.h"
#include "io/gltf_accessor.h"
#include "io/gltf_image_light.h"
#include "io/gltf_material.h"
#include "io/gltf_mesh.h"
#include "io/gltf_nodes.h"
#include "io/gltf_pointer.h"
#include "io/gltf_warnings.h"

namespace candela::io {

/// What one node shows: a mesh of the file with its weights, and, where skinned, the node whose skin moves it.
using MeshKey = std::tuple<std::size_t, std::vector<float>, std::optional<std::size_t>>;

/// A mesh, and what the materials of its primitives wanted when it was read.
struct KeptMesh {
  Mesh mesh;
  std::vector<VertexNeeds> needs;
  std::vector<std::size_t> sources;  ///< which of the file's primitives each of the mesh is
};

/// What one scene of a file leaves to the next.
struct Kept {
  std::map<int, std::shared_ptr<const TextureImage>> images;  ///< by the file's index
  std::set<int> lost_images;                                  ///< that could not be read
  std::map<MeshKey, KeptMesh> meshes;                         ///< without a skin: the same wherever the nodes are
  std::vector<std::optional<Material>> materials;             ///< by the file's index, as they stand at rest
  KeptPanoramas panoramas;
  bool has_variants = false;  ///< that are asked for: meshes stay for the next to wear
};

/// Makes one scene of an open file, at rest or at a moment of its animations. What it collects and reads is in
/// gltf_loader.cpp, what stands where in gltf_placement.cpp.
class Loader {
 public:
  Loader(GltfDocument& document, const UriReader& uris, GltfBuffers& buffers, const LoadOptions& options,
         std::size_t file_bytes, Diagnostics& diagnostics)
      : document_(document),
        root_(document.root()),
        uris_(uris),
        options_(options),
        warnings_(diagnostics),
        buffers_(buffers),
        reader_(root_, buffers_, file_bytes, warnings_) {}

  /// With `kept` what is there is not read again, and what may serve again is put there.
  Scene load(const FileInfo& info, const std::optional<Pose>& pose, Kept* kept);

 private:
  /// A mesh, and what another thread that has read it had to say.
  struct ReadMesh {
    Mesh mesh = {};
    std::vector<std::size_t> sources = {};  ///< KeptMesh::sources
    Diagnostics diagnostics = {};
    std::size_t ignored = 0;
  };

  void collect_meshes();
  void collect_materials(const MovedDocument& moved, Kept* kept);
  void outline_meshes(MeshReader& reader);
  std::vector<JsonView> draco_views() const;
  void read_meshes_and_images(Kept* kept);
  void read_meshes(Kept* kept);
  bool prepare_meshes();
  std::vector<std::optional<ReadMesh>> read_meshes_at_once(const MeshReader& reader,
                                                           const std::vector<std::optional<Mesh>>& known);
  void take_images(Kept& kept);
  void plan_images();
  void lose_image(std::size_t image, const Error& cause);
  std::optional<Mesh> find_mesh(const MeshReader& reader, const MeshKey& key, Kept* kept) const;
  void keep_mesh(const MeshReader& reader, const MeshKey& key, std::vector<std::size_t> sources, Mesh& mesh,
                 Kept* kept) const;
  ReadMesh read_mesh(MeshReader& reader, const MeshKey& key, std::map<std::size_t, std::vector<mat4>>& skins);
  void place_nodes();
  void read_cameras_and_lights();
  void place_mesh(std::size_t file_index, int mesh, const Box3& box, int scene_node, Node& node,
                  std::vector<Node>& appended);
  void place_area_light(std::size_t file_index, std::vector<Node>& appended);
  void check_extent(const mat4& world_from_mesh, std::size_t file_index, const Box3& box) const;
  void check_scale(const mat4& world_from_mesh, std::size_t file_index);

  GltfDocument& document_;
  JsonView root_;
  const UriReader& uris_;
  const LoadOptions& options_;
  Warnings warnings_;
  GltfBuffers& buffers_;
  AccessorReader reader_;
  FileScene file_;
  std::optional<Variant> variant_;
  std::map<MeshKey, std::size_t> mesh_of_key_;            ///< ordered, and so are the scene's meshes
  std::map<std::size_t, Mesh> outlines_;                  ///< of those that are not unpacked
  std::vector<std::optional<std::size_t>> mesh_of_node_;  ///< of the file
  std::map<std::size_t, int> camera_of_file_, light_of_file_, ies_light_of_node_;
  std::map<std::size_t, int> mesh_of_area_light_;
  MaterialSet materials_;
  std::vector<Reduction> reductions_;                    ///< by image
  std::vector<std::vector<std::size_t>> image_batches_;  ///< of images to be decoded, one after the other
  bool is_animated_ = false;                             ///< the file: there may be other moments
  bool is_posed_ = false;                                ///< by an animation, which may hide things by a scale of 0
  Scene scene_;
};

}  // namespace candela::io
