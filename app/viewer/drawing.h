#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "image/surface_map.h"
#include "raster/sketch.h"
#include "viewer/model.h"
#include "viewer/worker.h"

namespace candela::viewer {

/// A picture as the window shows it.
struct Shown {
  std::shared_ptr<const Model> model;  ///< null of a sketch
  std::shared_ptr<const Scene> scene;  ///< as it stands in the picture
  std::uint64_t number = 0;            ///< of the look
  DisplayImage image;
  View view;               ///< that it was taken from
  float exposure = 1.0f;   ///< the factor, also where it was metered
  double seconds = 0.0;    ///< that drawing it took
  bool is_whole = false;   ///< of the window's size, in full light; else a better one follows
  bool is_sketch = false;  ///< in plain colours
};

/// What is at a pixel.
struct Picked {
  ivec2 pixel{0};
  ivec2 size{0};  ///< of the picture
  std::shared_ptr<const Scene> scene;
  SurfaceSample sample;  ///< node -1: nothing is there
  View view;
};

/// The thread that draws. It has an OpenGL context of its own, so that the window never waits for the driver. What
/// comes of it is posted.
class Drawing {
 public:
  struct Told {
    std::function<void(std::shared_ptr<const Shown>)> shown;
    std::function<void(std::string)> failed;  ///< one line
    std::function<void(std::vector<Diagnostic>)> warned;
    std::function<void(std::string)> working;  ///< at what, while it takes long; empty = no more
  };
  Drawing(Mailbox& mailbox, Told told);
  ~Drawing();
  Drawing(const Drawing&) = delete;
  Drawing& operator=(const Drawing&) = delete;

  /// A first look at a scene whose images are not read.
  void sketch(std::shared_ptr<const Scene> scene, View view, ivec2 size);
  /// The picture of a look, which replaces the one at hand. While the user is `moving` things it may be smaller than
  /// asked for; the whole one follows when nothing else is asked for in between.
  void draw(Look look, bool is_moving);
  /// The picture of a look as a film, of whatever size, and how it is developed.
  void take(Look look, std::function<void(Film, DevelopSettings)> taken);
  /// What is at a pixel of a look.
  void pick(Look look, ivec2 pixel, std::function<void(Picked)> picked);
  /// Shaders of --shaders are compiled again when they are next needed.
  void reload_shaders();
  bool is_busy() const { return worker_->is_busy(); }

 private:
  struct Prepared;
  const Scene& prepare(const Look& look, const Job& job);
  raster::Settings settings_of(const Look& look) const;
  DevelopSettings develop_of(const Look& look, const Scene& scene);
  void draw_at(const Look& look, ivec2 size, const Job& job, bool is_whole);
  ivec2 quick_size(ivec2 whole) const;
  int bands_of(ivec2 size) const;
  static void wait_for_rest(const Job& job);
  void attempt(const std::function<void()>& work);
  void tell_warnings();

  Mailbox& mailbox_;
  Told told_;

  // ----- of the thread
  std::shared_ptr<raster::Device> device_;
  std::unique_ptr<raster::Sketch> sketch_;
  std::unique_ptr<raster::Drawer> drawer_;
  std::unique_ptr<Prepared> prepared_;
  Diagnostics diagnostics_;
  std::size_t told_warnings_ = 0;
  double seconds_per_pixel_ = 4e-7;             ///< at first a guess, of a slow machine
  const raster::Drawer* drawn_once_ = nullptr;  ///< has drawn before
  std::optional<float> metered_;                ///< of the model in this light
  bool is_broken_ = false;                      ///< the shaders do not compile

  std::unique_ptr<Worker> worker_;  ///< last, so that it ends first
};

}  // namespace candela::viewer
