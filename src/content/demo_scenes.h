#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "content/demo.h"
#include "content/patterns.h"
#include "content/shapes.h"
#include "scene/scene.h"

namespace candela::content {

Scene make_spheres();
Scene make_materials();
Scene make_cornell();
Scene make_furnace();
Scene make_relief();
/// What stands on no ground of its own.
Scene make_product();
/// A row of balls by its name, "row-…"; none = no such row.
std::optional<Scene> make_row(const std::string& name);
std::vector<DemoInfo> row_demos();

/// Puts a scene together part by part.
class SceneBuilder {
 public:
  explicit SceneBuilder(std::string name) { scene_.name = std::move(name); }

  int material(Material material);
  TextureSlot texture(const std::string& name, TexturePointer image, vec2 repeat = vec2(1.0f));
  /// Tangents are kept only where the material needs them: with a normal texture or anisotropy.
  int mesh(const std::string& name, Primitive primitive, int material);
  int node(const std::string& name, int mesh, const mat4& parent_from_node = mat4(1.0f), int parent = -1);
  /// A camera node at `eye` looking at `target`, both in the parent's space; sharp at `focus`.
  void camera(vec3 eye, vec3 target, float yfov_deg, float aspect, int parent = -1, float f_number = 0.0f,
              vec3 focus = vec3(0.0f));

  Scene finish(const std::string& environment, float exposure);

  Scene& scene() { return scene_; }

 private:
  Scene scene_;
};

mat4 translation(vec3 offset);
mat4 rotation_y(float angle_deg);
mat4 rotation_x(float angle_deg);
mat4 rotation_z(float angle_deg);
mat4 scaling(float factor);

}  // namespace candela::content
