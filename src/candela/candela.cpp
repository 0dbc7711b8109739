#include "candela/candela.h"

#include <string_view>

#include "io/demo.h"
#include "io/gltf.h"

namespace candela {

Scene load(const std::string& path_or_demo, Diagnostics* diagnostics, const std::string& variant) {
  constexpr std::string_view kDemo = "demo:";
  if (path_or_demo.starts_with(kDemo)) {
    if (!variant.empty()) throw Error("a built-in scene has no variants", path_or_demo);
    return io::make_demo(path_or_demo.substr(kDemo.size()));
  }
  Diagnostics ignored;
  return io::load_gltf(path_or_demo, diagnostics != nullptr ? *diagnostics : ignored, {.variant = variant});
}

Box3 subject_bounds(const Scene& scene) {
  const Box3 bounds = world_bounds(scene);
  return bounds.empty() ? Box3{vec3(-1.0f), vec3(1.0f)} : bounds;
}

View default_view(const Scene& scene, float aspect) {
  // A camera is only somewhere when a node holds it.
  for (const Node& node : scene.nodes) {
    if (node.camera >= 0) return scene_camera(scene, std::to_string(node.camera), aspect);
  }
  return frame_box(subject_bounds(scene), aspect, PerspectiveCamera{}.yfov);
}

std::string default_environment(const Scene& scene) { return scene.preferred_environment.value_or("studio"); }

DevelopSettings default_develop(const Scene& scene, const Environment& environment) {
  DevelopSettings settings;
  settings.exposure = scene.preferred_exposure ? scene.preferred_exposure : environment.exposure;
  return settings;
}

DevelopSettings default_develop(const Scene& scene) {
  return default_develop(scene, make_environment(default_environment(scene)));
}

Film render(const Scene& scene, const path::Settings& settings) {
  const float aspect = static_cast<float>(settings.width) / static_cast<float>(settings.height);
  return path::render(scene, make_environment(default_environment(scene)), default_view(scene, aspect), settings);
}

const char* version() { return CANDELA_VERSION; }

}  // namespace candela
