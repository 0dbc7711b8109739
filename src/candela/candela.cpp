#include "candela/candela.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "io/demo.h"

namespace candela {

namespace {

constexpr std::string_view kDemo = "demo:";

}  // namespace

Asset::Asset(const std::string& path_or_demo, Diagnostics* diagnostics, const std::string& variant)
    : name_(path_or_demo), diagnostics_(diagnostics) {
  if (!name_.starts_with(kDemo)) {
    file_ = std::make_shared<io::GltfFile>(name_, diagnostics_ != nullptr ? *diagnostics_ : ignored_,
                                           io::LoadOptions{.variant = variant});
  } else if (!variant.empty()) {
    throw Error("a built-in scene has no variants", name_);
  }
}

Scene Asset::scene(const std::optional<Pose>& pose) {
  if (file_ != nullptr) {
    // What is odd about a file is said once, not at every moment.
    Diagnostics* diagnostics = std::exchange(diagnostics_, nullptr);
    return file_->scene(diagnostics != nullptr ? *diagnostics : ignored_, pose);
  }
  if (pose && !pose->animation.empty()) throw Error("a built-in scene has no animations", name_);
  return io::make_demo(name_.substr(kDemo.size()));
}

bool Asset::is_animated() const { return file_ != nullptr && !file_->info().animations.empty(); }

double Asset::duration_s(const std::string& animation) const {
  double longest = 0.0;
  if (file_ == nullptr) return longest;
  for (const std::size_t index : file_->find_animations(animation)) {
    longest = std::max<double>(longest, file_->info().animations[index].duration_s);
  }
  return longest;
}

Scene load(const std::string& path_or_demo, Diagnostics* diagnostics, const std::string& variant) {
  return Asset(path_or_demo, diagnostics, variant).scene();
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
