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
#include "scene/framing.h"
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

/// The same with all options of loading: LoadOptions::root confines untrusted files to one folder.
Scene load(const std::string& path_or_demo, Diagnostics* diagnostics, const LoadOptions& options);

/// A file whose scene is available at any moment of its animations; what does not move is read and decoded once.
class Asset {
 public:
  /// As load().
  explicit Asset(const std::string& path_or_demo, Diagnostics* diagnostics = nullptr, const std::string& variant = {});
  Asset(const std::string& path_or_demo, Diagnostics* diagnostics, const LoadOptions& options);

  /// The scene at rest, or in the given pose of an animation. A built-in scene has no animations: naming one throws
  /// Error.
  /// `variant` wears another one than LoadOptions::variant. A built-in scene has none: naming one throws Error.
  Scene scene(const std::optional<Pose>& pose = std::nullopt, const std::optional<std::string>& variant = std::nullopt);
  /// Duration of the animations of that name, as Pose::animation names them; 0 if nothing moves.
  double duration_s(const std::string& animation);
  /// Whether such an animation moves a light of EXT_lights_image_based by a pointer.
  bool moves_image_light(const std::string& animation);
  bool is_animated() const;
  /// What the file says of itself; of a built-in scene nothing.
  const io::FileInfo& info() const { return info_; }
  /// The files that it is read from: the file itself and all that it names; none for a built-in scene.
  std::vector<io::ReferencedFile> files() const;
  /// Gives back what only another scene needs, above all the file's bytes. What needs them reads the file again.
  void release();

 private:
  io::GltfFile& file();

  std::string name_;
  LoadOptions options_;
  Diagnostics ignored_;
  Diagnostics* diagnostics_;
  bool is_built_in_;
  std::shared_ptr<io::GltfFile> file_;  ///< null for a built-in scene, and after release()
  io::FileInfo info_;
};

/// Whether the scene has a camera that a node refers to.
bool has_camera(const Scene& scene);

/// The node whose camera a user would expect: that of the scene's first camera. None if there is none, or if it sees
/// nothing although there is something to see, as when a file holds the view matrix in place of its inverse; this is
/// reported to `diagnostics`.
std::optional<std::size_t> default_camera(const Scene& scene, float aspect, Diagnostics* diagnostics = nullptr);

/// The view a user would expect by default: that of default_camera, else the whole subject from default_orbit().
View default_view(const Scene& scene, float aspect, Diagnostics* diagnostics = nullptr);

/// The box that frames the subject: world_bounds(), or a two metre cube about the origin if nothing has a mesh.
Box3 subject_bounds(const Scene& scene);

/// The environment that a scene asks for, else "studio". A name for make_environment().
std::string default_environment(const Scene& scene);

/// The light of a scene if none is chosen: its own image-based light, else default_environment.
Environment default_light(const Scene& scene, Diagnostics* diagnostics = nullptr);

/// The exposure that a scene asks for, else the one its environment is made for unless the scene's own lamps outshine
/// it, else metered from the picture.
DevelopSettings default_develop(const Scene& scene, const Environment& environment);
/// The same under default_light.
DevelopSettings default_develop(const Scene& scene);

/// Renders with default_light and default_view.
Film render(const Scene& scene, const path::Settings& settings = {});
/// One picture by the engine of the given settings: render(scene, environment, view, settings, job, statistics).
using path::render;
using raster::render;

/// The light that arrives at `count` places distributed over a scene, path traced with `samples` per texel, without
/// lamps and suns, which the rasterizer draws as separate lights. For raster::Drawer::set_probes. Throws Interrupted
/// after a stop: light from half the sides would be wrong.
std::vector<raster::Probe> bake_probes(const path::Tracer& tracer, int count, int samples, const Job& job = {});

/// "0.1.0"
const char* version();

}  // namespace candela
