#include "viewer/model.h"

#include <algorithm>
#include <utility>

#include "candela/taking.h"
#include "scene/material_table.h"

namespace candela::viewer {

namespace {

void apply_edit(const MaterialEdit& edit, Material& material) {
  for (const auto& [row, value] : edit.rows) {
    const MaterialProperty& property = kMaterialProperties[row];
    for (int i = 0; i < property.member.size(); ++i) property.member.at(material, i) = value[i];
  }
  if (edit.alpha_mode) material.alpha_mode = *edit.alpha_mode;
  if (edit.double_sided) material.double_sided = *edit.double_sided;
  if (edit.unlit) material.unlit = *edit.unlit;
}

void apply_edit(const LightEdit& edit, Light& light) {
  if (edit.intensity) light.intensity = *edit.intensity;
  if (edit.color) light.color = *edit.color;
  if (edit.is_off) light.intensity = 0.0f;
}

/// The moment that a shot shows first: of what moves its beginning, unless it says otherwise.
Moment first_moment_of(const Shot& shot, bool is_animated) {
  Moment moment;
  moment.animation = shot.animation.value_or("");
  if (shot.moment_s) moment.time_s = shot.moment_s;
  if (!moment.time_s && (shot.animation || is_animated)) moment.time_s = 0.0;
  return moment;
}

}  // namespace

void Edits::apply(Scene& scene) const {
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const auto found = materials.find(number_of(scene.materials, i));
    if (found != materials.end()) apply_edit(found->second, scene.materials[i]);
  }
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const auto found = lights.find(number_of(scene.lights, i));
    if (found != lights.end()) apply_edit(found->second, scene.lights[i]);
  }
  for (Mesh& mesh : scene.meshes) {
    for (Primitive& primitive : mesh.primitives) {
      if (is_complete(scene, primitive)) continue;
      complete_primitive(scene.materials[static_cast<std::size_t>(primitive.material)], primitive);
      mesh.identity = std::make_shared<const int>(0);
    }
  }
}

Model::Model(Shot shot)
    : shot_(takeable(std::move(shot))),
      asset_(shot_.scene, &diagnostics_, shot_.load),
      info_(asset_.info()),
      is_animated_(asset_.is_animated()),
      first_moment_(first_moment_of(shot_, is_animated_)),
      extent_(Box3()) {
  first_ = unedited(first_moment_);
  extent_ = Extent(*first_);
  files_ = asset_.files();
}

double Model::duration_s(const std::string& animation) {
  const std::lock_guard lock(mutex_);
  return asset_.duration_s(animation);
}

std::vector<Diagnostic> Model::warnings() const {
  const std::lock_guard lock(mutex_);
  return diagnostics_.warnings();
}

std::shared_ptr<const Scene> Model::unedited(const Moment& moment) {
  if (read_ != nullptr && read_moment_ == moment) return read_;
  std::optional<Pose> pose;
  if (moment.time_s) pose = Pose{moment.animation, *moment.time_s};
  auto scene = std::make_shared<Scene>(asset_.scene(pose, moment.variant));
  if (shot_.falloff) set_falloff(*shot_.falloff, *scene);
  if (shot_.ground && !ground_) ground_ = ground_of(shot_, *scene);
  scene->ground = ground_;
  for (Camera& camera : scene->cameras) {
    if (shot_.ignores_planes) camera.near_plane = 0.0f, camera.far_plane = kInfinity;
  }
  for (Mesh& mesh : scene->meshes) {
    if (mesh.identity == nullptr) mesh.identity = std::make_shared<const int>(0);
  }
  read_moment_ = moment;
  read_ = std::move(scene);
  return read_;
}

std::shared_ptr<const Scene> Model::scene(const Moment& moment) {
  const std::lock_guard lock(mutex_);
  if (last_ != nullptr && last_moment_ == moment) return last_;
  Moment plain = moment;
  plain.edits = nullptr;
  std::shared_ptr<const Scene> scene = unedited(plain);
  if (moment.edits != nullptr && moment.edits->version > 0) {
    auto edited = std::make_shared<Scene>(*scene);
    moment.edits->apply(*edited);
    validate(*edited);
    scene = std::move(edited);
  }
  last_moment_ = moment;
  last_ = std::move(scene);
  return last_;
}

Environment Look::environment() const {
  Environment lit = light->environment;
  lit.rotation += rotation;
  lit.intensity *= intensity;
  return lit;
}

View view_of(const Look& look, const Scene& scene) {
  if (!look.camera_node || *look.camera_node >= scene.nodes.size()) return look.view;
  const Node& node = scene.nodes[*look.camera_node];
  return node.camera < 0 ? look.view : scene_camera(scene, node, look.aspect());
}

}  // namespace candela::viewer
