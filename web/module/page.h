#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "candela/bake.h"
#include "candela/candela.h"
#include "candela/verdict.h"

/// The renderer as a page in a browser uses it.
namespace candela::web {

/// From where the subject is seen. What is not given is as the file's own camera has it, or as default_orbit() does.
struct Sight {
  std::optional<float> azimuth{};         ///< radians, as Orbit
  std::optional<float> elevation{};       ///< radians
  std::optional<float> distance_scale{};  ///< of the distance from where all of it is seen
  std::optional<float> distance{};        ///< metres, in place of it

  bool is_given() const { return azimuth || elevation || distance_scale || distance; }
};

/// What a picture shows beside the scene.
struct Look {
  ivec2 size{1};
  Sight sight;
  std::optional<float> exposure{};  ///< factor; empty = as the scene and its environment ask for, else metered
  bool is_metered = false;          ///< the exposure is metered in any case
  ToneCurve tone_curve = ToneCurve::pbr_neutral;
};

/// A scene that is drawn on a canvas, whose context is current all the time. Everything throws Error, and leaves what
/// was shown before.
class Page {
 public:
  /// Replaces the scene, at rest.
  void load(const std::string& path, const std::string& variant);
  /// A name for make_environment(); empty = what the scene asks for.
  void set_environment(const std::string& name);
  void set_variant(const std::string& variant);
  /// A moment of an animation; nothing where there is none = at rest.
  void set_pose(const std::optional<Pose>& pose);

  /// One frame on the canvas.
  void draw(const Look& look);
  /// A picture that is the mean of so many frames, each jittered within its pixels.
  DisplayImage picture(const Look& look, int frames);
  /// The sight of the last frame in numbers, to go on from.
  Orbit orbit() const { return orbit_; }

  Verdict verdict() const;
  /// Writes what the environment is baked to into a folder.
  BakeResult bake(const std::filesystem::path& folder, BakeOrder order) const;

  bool is_loaded() const { return scene_ != nullptr; }
  const io::FileInfo& info() const { return asset_->info(); }
  const Scene& scene() const { return *scene_; }
  /// What was odd about the file and its light, since this was last asked for.
  std::vector<std::string> take_warnings();
  /// The canvas has lost all that was drawn with: it is made again.
  void forget_drawing();

 private:
  raster::Drawer& drawer();
  raster::Settings settings(ivec2 size) const;
  View view(const Look& look);
  float exposure(const Look& look, const Film& film) const;

  Diagnostics diagnostics_;
  std::size_t told_ = 0;  ///< of its warnings
  std::string path_;
  std::optional<Asset> asset_;
  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const Scene> at_rest_;  ///< is what is framed: what moves shall not move the camera
  std::optional<Extent> extent_;          ///< of it
  /// The node of the file's own, found once: whether it sees anything takes long to find out.
  std::optional<std::size_t> camera_;
  std::string environment_name_;
  std::optional<Environment> environment_;
  DevelopSettings develop_;
  std::optional<float> metered_;  ///< of this scene in this light
  std::shared_ptr<raster::Device> device_;
  std::unique_ptr<raster::Drawer> drawer_;
  View framed_;
  float framed_aspect_ = 0.0f;
  Orbit orbit_;
};

}  // namespace candela::web
