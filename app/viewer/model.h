#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "candela/shot.h"

/// What a window shows, and in what light: what is loaded, and what of it a user has changed.
namespace candela::viewer {

/// What of a material a user has changed.
struct MaterialEdit {
  std::map<std::size_t, vec3> rows;  ///< by the row of kMaterialProperties; numbers are in x
  std::optional<AlphaMode> alpha_mode = {};
  std::optional<bool> double_sided = {}, unlit = {};
};

/// What of a lamp.
struct LightEdit {
  bool is_off = false;
  std::optional<float> intensity = {};
  std::optional<vec3> color = {};
};

/// By the numbers that people know, which variants and moments of one file have in common.
struct Edits {
  std::map<int, MaterialEdit> materials;
  std::map<int, LightEdit> lights;
  std::uint64_t version = 0;  ///< another one with every change

  void apply(Scene& scene) const;
};

/// Which look of a model, and when.
struct Moment {
  std::optional<std::string> variant = {};
  std::string animation = {};         ///< as Pose::animation names it
  std::optional<double> time_s = {};  ///< empty: at rest
  std::shared_ptr<const Edits> edits = {};

  bool operator==(const Moment& other) const {
    return variant == other.variant && animation == other.animation && time_s == other.time_s && edits == other.edits;
  }
};

/// A model that is open. For any number of threads, which read it one after the other.
class Model {
 public:
  /// Opens the file that the shot names and reads its scene. Throws Error, and Interrupted where the caller's StopScope
  /// says so.
  explicit Model(Shot shot);

  const Shot& shot() const { return shot_; }
  const std::string& name() const { return shot_.scene; }
  const io::FileInfo& info() const { return info_; }
  const std::vector<io::ReferencedFile>& files() const { return files_; }
  /// As the shot has it; what is framed, so that what moves does not move the camera.
  const std::shared_ptr<const Scene>& first() const { return first_; }
  const Extent& extent() const { return extent_; }
  /// The moment that the shot names.
  const Moment& first_moment() const { return first_moment_; }
  bool is_animated() const { return is_animated_; }
  double duration_s(const std::string& animation);
  /// What reading it, and other moments of it, has warned of.
  std::vector<Diagnostic> warnings() const;

  /// The scene as it stands then, with what its material reads of its meshes. Throws Error.
  std::shared_ptr<const Scene> scene(const Moment& moment);

 private:
  std::shared_ptr<const Scene> unedited(const Moment& moment);

  Shot shot_;
  Diagnostics diagnostics_;
  Asset asset_;
  io::FileInfo info_;
  bool is_animated_ = false;
  std::optional<Ground> ground_;
  Moment first_moment_;
  std::shared_ptr<const Scene> first_;
  Extent extent_;
  std::vector<io::ReferencedFile> files_;

  mutable std::mutex mutex_;  ///< of all that follows, the file and the warnings
  Moment last_moment_;        ///< with edits
  std::shared_ptr<const Scene> last_;
  Moment read_moment_;  ///< without
  std::shared_ptr<const Scene> read_;
};

/// Light from far away, with what the rasterizer makes of it.
struct FarLight {
  std::string name;         ///< for make_environment(); empty = the model's own
  Environment environment;  ///< as it is before a user turns it or changes its intensity
  raster::BakedLight baked;
  bool is_plain = false;  ///< stands in until the real one is baked
};

/// Everything that a picture depends on.
struct Look {
  std::shared_ptr<Model> model;
  Moment moment;
  std::shared_ptr<const FarLight> light;
  float rotation = 0.0f;   ///< added to the environment's own, radians
  float intensity = 1.0f;  ///< times its own
  View view;
  std::optional<std::size_t> camera_node;  ///< of the scene, in place of `view`
  Shot shot;                      ///< of which counts what both engines draw with; its size is that of the picture
  std::optional<float> exposure;  ///< empty: metered
  std::uint64_t number = 0;       ///< which one it is

  /// The environment as it lights the picture.
  Environment environment() const;
  float aspect() const { return static_cast<float>(shot.size.x) / static_cast<float>(shot.size.y); }
};

/// Where the picture of a look is taken from, in its scene. Throws Error where a camera of it has no direction.
View view_of(const Look& look, const Scene& scene);

}  // namespace candela::viewer
