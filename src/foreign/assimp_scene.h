#pragma once

#include <assimp/scene.h>

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "foreign/draft.h"
#include "foreign/formats.h"
#include "foreign/units.h"

namespace candela::foreign {

/// Turns what Assimp read into a glTF: nodes, meshes, skins, morph targets, cameras and lights.
class SceneWriter {
 public:
  /// `material` gives the glTF material of a mesh, -1 = none; without
  /// `has_normals` those of the file are not believed, and faces are flat.
  SceneWriter(const aiScene& scene, Draft& draft, std::vector<int> material_of_mesh, Units units, bool has_normals)
      : scene_(scene),
        draft_(draft),
        material_of_mesh_(std::move(material_of_mesh)),
        units_(units),
        has_normals_(has_normals) {}

  /// Everything; the file's root is called `root_name`.
  void write(const std::string& root_name);

 private:
  int write_node(const aiNode& node);
  void write_transform(const aiNode& source, nlohmann::json& node) const;
  void write_meshes(const aiNode& source, std::size_t node);
  int mesh(const std::vector<unsigned>& parts);
  nlohmann::json primitive(unsigned index);
  void write_targets(const aiMesh& mesh, nlohmann::json& primitive);
  void write_influences(const aiMesh& mesh, nlohmann::json& attributes);
  void write_skins();
  void write_cameras();
  void write_lights();
  void write_animations();
  void write_channels(const aiNodeAnim& channel, double ticks_per_second, double start, nlohmann::json& animation);
  void write_weights(const aiMeshMorphAnim& channel, double ticks_per_second, double start, nlohmann::json& animation);
  void add_child(std::size_t parent, std::size_t child);
  std::size_t holder_of(const std::string& name, const mat4& node_from_held, const std::string& label);
  int find_node(const std::string& name) const;

  const aiScene& scene_;
  Draft& draft_;
  std::vector<int> material_of_mesh_;
  Units units_;
  bool has_normals_;
  std::map<std::string, std::size_t> node_of_name_;
  std::set<std::string> animated_;  ///< names of nodes
  std::map<std::vector<unsigned>, int> meshes_;
  std::map<unsigned, nlohmann::json> primitives_;
  std::vector<std::pair<std::size_t, unsigned>> skinned_;                 ///< node and mesh
  std::multimap<std::string, std::pair<std::size_t, unsigned>> morphed_;  ///< by the names of node and mesh
  std::size_t undrawn_ = 0;                                               ///< points and lines
};

}  // namespace candela::foreign
