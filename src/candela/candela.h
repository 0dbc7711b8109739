#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "base/error.h"
#include "content/make_environment.h"
#include "image/develop.h"
#include "image/film.h"
#include "io/gltf.h"
#include "path/render.h"
#include "raster/render.h"
#include "scene/environment.h"
#include "scene/scene.h"
#include "scene/view.h"
#include "scene/visibility.h"

/// The library in three calls:
///
///     candela::Scene scene = candela::load("helmet.glb");
///     candela::Film film = candela::render(scene, {.width = 1280, .height = 720, .samples = 64});
///     candela::write_film("helmet.png", film, {});
namespace candela {

/// Loads a .gltf, a .glb or a .zip with one of them, or a built-in scene by "demo:NAME". Throws Error. Warnings go to
/// `diagnostics` when given.
/// `variant` names one of the file's material variants; empty = its default look.
Scene load(const std::string& path_or_demo, Diagnostics* diagnostics = nullptr, const std::string& variant = {});

using io::LoadOptions;
using io::Pose;

/// The same with all that loading can be told: LoadOptions::root keeps files of strangers to one folder.
Scene load(const std::string& path_or_demo, Diagnostics* diagnostics, const LoadOptions& options);

/// A scene that can be had at any moment of its animations; what does not move is read and decoded once.
class Asset {
 public:
  /// As load().
  explicit Asset(const std::string& path_or_demo, Diagnostics* diagnostics = nullptr, const std::string& variant = {});
  Asset(const std::string& path_or_demo, Diagnostics* diagnostics, const LoadOptions& options);

  /// The scene at rest, or as an animation has it. A built-in scene has no animations: naming one throws Error.
  Scene scene(const std::optional<Pose>& pose = std::nullopt);
  /// Seconds that the animations of that name last, as Pose::animation names them; 0 where nothing moves.
  double duration_s(const std::string& animation) const;
  /// Whether such an animation has a pointer to a light of EXT_lights_image_based.
  bool moves_image_light(const std::string& animation) const;
  bool is_animated() const;
  /// What it is read from: the file and all that it names; none of a built-in scene.
  std::vector<io::ReferencedFile> files() const;

 private:
  std::string name_;
  Diagnostics ignored_;
  Diagnostics* diagnostics_;
  std::shared_ptr<io::GltfFile> file_;  ///< null of a built-in scene
};

/// Whether a camera stands somewhere in the scene: is held by a node.
bool has_camera(const Scene& scene);

/// Which node's camera a user would expect to look through: the scene's first; none where there is none, or where it
/// sees nothing although there is something to see, as when a file holds the view matrix in place of its inverse, which
/// `diagnostics` then tells.
std::optional<std::size_t> default_camera(const Scene& scene, float aspect, Diagnostics* diagnostics = nullptr);

/// The view a user would expect without saying more: by default_camera, else the whole subject in three-quarter view.
View default_view(const Scene& scene, float aspect, Diagnostics* diagnostics = nullptr);

/// What the subject is framed by: world_bounds(), or a two metre cube about the origin when nothing has a mesh.
Box3 subject_bounds(const Scene& scene);

/// The light a scene wishes for, else "studio". A name for make_environment().
std::string default_environment(const Scene& scene);

/// What a scene is lit by where its user does not say: the light of its own that it brings, else default_environment.
Environment default_light(const Scene& scene, Diagnostics* diagnostics = nullptr);

/// The exposure a scene wishes for, else the one its environment is made for unless the scene's own lamps outshine it,
/// else metered from the picture.
DevelopSettings default_develop(const Scene& scene, const Environment& environment);
/// The same under default_light.
DevelopSettings default_develop(const Scene& scene);

/// Renders with default_light and default_view.
Film render(const Scene& scene, const path::Settings& settings = {});
/// One picture by the engine whose settings these are: render(scene, environment, view, settings, job, statistics).
using path::render;
using raster::render;

/// Light as it arrives at `count` places spread over a scene, path traced with `samples` per texel; lamps and suns are
/// left out, which the rasterizer draws as lights of their own. For raster::Drawer::set_probes. Throws Interrupted
/// after a stop: light from half the sides would be wrong.
std::vector<raster::Probe> bake_probes(const path::Tracer& tracer, int count, int samples, const Job& job = {});

/// "0.1.0"
const char* version();

}  // namespace candela
