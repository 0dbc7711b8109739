#include "candela/candela.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "content/demo.h"
#include "io/texture_budget.h"
#include "path/capture.h"
#include "scene/brightness.h"

namespace candela {

namespace {

constexpr std::string_view kDemo = "demo:";

}  // namespace

Asset::Asset(const std::string& path_or_demo, Diagnostics* diagnostics, const std::string& variant)
    : Asset(path_or_demo, diagnostics, LoadOptions{.variant = variant}) {}

Asset::Asset(const std::string& path_or_demo, Diagnostics* diagnostics, const LoadOptions& options)
    : name_(path_or_demo), options_(options), diagnostics_(diagnostics), is_built_in_(name_.starts_with(kDemo)) {
  if (!is_built_in_) {
    Diagnostics& told = diagnostics_ != nullptr ? *diagnostics_ : ignored_;
    file_ = std::make_shared<io::GltfFile>(name_, told, options_, &info_);
  } else if (!options.variant.empty()) {
    throw Error("a built-in scene has no variants", name_);
  } else if (!options.scene.empty()) {
    throw Error("a built-in scene is one scene, of which none can be chosen", name_);
  } else if (!options.measures.empty()) {
    throw Error("a built-in scene is in metres with +y up", name_);
  }
}

io::GltfFile& Asset::file() {
  if (file_ == nullptr) file_ = std::make_shared<io::GltfFile>(name_, ignored_, options_);
  return *file_;
}

void Asset::release() { file_.reset(); }

Scene Asset::scene(const std::optional<Pose>& pose, const std::optional<std::string>& variant) {
  if (!is_built_in_) {
    // What is odd about a file is said once, not at every moment.
    Diagnostics* diagnostics = std::exchange(diagnostics_, nullptr);
    return file().scene(diagnostics != nullptr ? *diagnostics : ignored_, pose, variant);
  }
  if (variant) throw Error("a built-in scene has no variants", name_);
  if (pose && !pose->animation.empty()) throw Error("a built-in scene has no animations", name_);
  Scene scene = content::make_demo(name_.substr(kDemo.size()));
  if (options_.texture_memory > 0) {
    Diagnostics* diagnostics = std::exchange(diagnostics_, nullptr);
    io::fit_textures(scene, {options_.texture_memory, options_.counts_texture_levels},
                     diagnostics != nullptr ? *diagnostics : ignored_, name_);
  }
  return scene;
}

bool Asset::is_animated() const { return !info_.animations.empty(); }

std::vector<io::ReferencedFile> Asset::files() const { return info_.files; }

double Asset::duration_s(const std::string& animation) {
  double longest = 0.0;
  if (is_built_in_) return longest;
  for (const std::size_t index : file().find_animations(animation)) {
    longest = std::max<double>(longest, info_.animations[index].duration_s);
  }
  return longest;
}

bool Asset::moves_image_light(const std::string& animation) {
  if (is_built_in_) return false;
  for (const std::size_t index : file().find_animations(animation)) {
    for (const std::string& pointer : info_.animations[index].pointers) {
      if (pointer.starts_with("/extensions/EXT_lights_image_based/")) return true;
    }
  }
  return false;
}

Scene load(const std::string& path_or_demo, Diagnostics* diagnostics, const std::string& variant) {
  return Asset(path_or_demo, diagnostics, variant).scene();
}

Scene load(const std::string& path_or_demo, Diagnostics* diagnostics, const LoadOptions& options) {
  return Asset(path_or_demo, diagnostics, options).scene();
}

Box3 subject_bounds(const Scene& scene) {
  const Box3 bounds = world_bounds(scene);
  return bounds.empty() ? Box3{vec3(-1.0f), vec3(1.0f)} : bounds;
}

bool has_camera(const Scene& scene) {
  return std::any_of(scene.nodes.begin(), scene.nodes.end(), [](const Node& n) { return n.camera >= 0; });
}

std::optional<std::size_t> default_camera(const Scene& scene, float aspect, Diagnostics* diagnostics) {
  const auto found =
      std::find_if(scene.nodes.begin(), scene.nodes.end(), [](const Node& node) { return node.camera >= 0; });
  if (found == scene.nodes.end()) return std::nullopt;
  const auto index = static_cast<std::size_t>(found - scene.nodes.begin());
  // Where nothing has a triangle every camera looks at the sky.
  if (world_bounds(scene).empty()) return index;
  std::string fault = "sees nothing of the scene";
  try {
    if (sees_something(scene, scene_camera(scene, *found, aspect))) return index;
  } catch (const Error& error) {
    fault = "cannot be looked through (" + error.message() + ")";
  }
  if (diagnostics != nullptr) {
    const auto camera = static_cast<std::size_t>(found->camera);
    const std::string& name = scene.cameras[camera].name;
    diagnostics->warn("the camera " + std::to_string(number_of(scene.cameras, camera)) +
                          (name.empty() ? "" : " '" + name + "'") + " " + fault + "; the whole scene is framed instead",
                      scene.name);
  }
  return std::nullopt;
}

View default_view(const Scene& scene, float aspect, Diagnostics* diagnostics) {
  if (const auto node = default_camera(scene, aspect, diagnostics)) {
    return scene_camera(scene, scene.nodes[*node], aspect);
  }
  const Extent extent(scene);
  return frame(extent, {.orbit = default_orbit(scene, extent.bounds()), .aspect = aspect});
}

std::string default_environment(const Scene& scene) { return scene.preferred_environment.value_or("studio"); }

Environment default_light(const Scene& scene, Diagnostics* diagnostics) {
  if (scene.image_light) return scene.image_light->environment;
  return make_environment(default_environment(scene), diagnostics);
}

DevelopSettings default_develop(const Scene& scene, const Environment& environment) {
  DevelopSettings settings;
  settings.exposure = scene.preferred_exposure;
  if (!settings.exposure && environment.exposure && !outshines(scene, environment)) {
    settings.exposure = environment.exposure;
  }
  return settings;
}

DevelopSettings default_develop(const Scene& scene) { return default_develop(scene, default_light(scene)); }

Film render(const Scene& scene, const path::Settings& settings) {
  const float aspect = static_cast<float>(settings.width) / static_cast<float>(settings.height);
  return path::render(scene, default_light(scene), default_view(scene, aspect), settings);
}

namespace {

/// The middles of `count` boxes of about the same size that fill `bounds`: the longest is halved, again and again.
std::vector<vec3> spread(const Box3& bounds, int count) {
  std::vector<Box3> boxes = {bounds};
  while (static_cast<int>(boxes.size()) < count) {
    const auto longest = std::max_element(boxes.begin(), boxes.end(), [](const Box3& a, const Box3& b) {
      return max_component(a.size()) < max_component(b.size());
    });
    const vec3 size = longest->size();
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    Box3 upper = *longest;
    longest->upper[axis] = upper.lower[axis] = longest->center()[axis];
    boxes.push_back(upper);
  }
  std::vector<vec3> middles;
  middles.reserve(boxes.size());
  for (const Box3& box : boxes) middles.push_back(box.center());
  return middles;
}

}  // namespace

std::vector<raster::Probe> bake_probes(const path::Tracer& tracer, int count, int samples, const Job& job) {
  constexpr int kSize = 64;
  std::vector<raster::Probe> probes;
  if (count <= 0) return probes;
  const Scene& scene = tracer.scene();
  const Box3 bounds = subject_bounds(scene);
  path::Settings settings;
  settings.samples = samples;
  settings.sees_lamps = false;
  const JobParts parts(job, static_cast<std::size_t>(count));
  for (const vec3& position : spread(bounds, count)) {
    const std::string what = "tracing probe " + std::to_string(probes.size() + 1) + " of " + std::to_string(count);
    const Cubemap seen =
        path::capture_environment(tracer, position, kSize, settings, parts.part(probes.size(), what + ", "));
    probes.push_back({position, bounds, raster::bake_light(seen.levels[0], raster::uses_sheen(scene))});
  }
  return probes;
}

const char* version() { return CANDELA_VERSION; }

}  // namespace candela
