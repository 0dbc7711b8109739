#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "image/film.h"
#include "image/job.h"
#include "raster/image_light.h"
#include "raster/quantity.h"
#include "scene/scene.h"
#include "scene/view.h"
#include "shade/model.glsl.h"

/// The real-time renderer: OpenGL ES 3.0, on a GPU or on a processor, without a window.
namespace candela::raster {

struct Settings {
  int width = 1280;
  int height = 720;
  int frames = 1;  ///< of a still, each jittered within the pixel and over the lens; their mean is the picture
  int msaa = 4;    ///< samples per pixel of each frame: 1, 2, 4 or what the driver has
  /// Widens highlights by how the normal turns within a pixel. What one sample per pixel needs; the less, the more
  /// frames there are.
  bool specular_antialiasing = true;
  /// How far away surfaces occlude what comes from the environment, over the diagonal of the scene; 0 = they do not.
  float occlusion_radius = 0.0f;
  Background background = Background::environment;
  /// Of another background: glass shows the environment behind it all the same.
  bool environment_in_glass = false;
  Ambient ambient = Ambient::baked;
  /// Shadows that soften with the distance from what casts them: of suns and area lights by their own size, of points
  /// and spots by `light_radius`.
  bool has_soft_shadows = false;
  float light_radius = 0.0f;            ///< metres
  Quantity quantity = Quantity::light;  ///< shown in place of all light; then without a background
  int most_textures = 0;                ///< that a shader reads at once; 0: what the driver has. The least of any is 16
  int shown_light = 0;                  ///< of Quantity::one_light, the strongest is 0
  std::set<Layer> layers{};
  std::filesystem::path cache{};  ///< folder of baked environments; empty = none is kept
  std::string shader_folder{};    ///< read instead of the shaders in the program; empty = those

  bool operator==(const Settings&) const = default;
};

struct Statistics {
  std::string driver;
  bool interrupted = false;  ///< by Job::stop, with frames left
  bool is_light_cached = false;
  double open_s = 0.0;    ///< the context; this and what follows count where it was done, for the first of several
  double light_s = 0.0;   ///< baking or reading the environment, beside what follows
  double upload_s = 0.0;  ///< scene and environment to the driver
  double shadow_s = 0.0;
  double compile_s = 0.0;  ///< the first frame, which nobody sees
  double frame_s = 0.0;    ///< all frames, reading back included
  double draw_s = 0.0;     ///< of that until the driver has finished drawing
  int frames = 0;          ///< of all pictures
  int programs = 0;
  std::uint64_t triangles = 0;
  std::uint64_t draws = 0;
  std::uint64_t non_finite_pixels = 0;  ///< must be 0; each is black in the picture
};

/// Adds one picture to several: times and counts are sums, the scene is that of the last.
void add_work(const Statistics& picture, Statistics& all);

/// Throws Error where this build is without the rasterizer, as all that draws does.
void check_built();

/// What one frame of a picture shows where things move: the scene that is drawn at another moment, with as many
/// materials and the IES profiles of that.
struct Moment {
  std::shared_ptr<const Scene> scene;
  View view;
};
using MomentOf = std::function<Moment(int frame)>;

/// An OpenGL context, and the environment that was baked last: many scenes pay for them once. To be used on the thread
/// that made it, where there may be several.
class Device {
 public:
  /// Throws Error where there is no OpenGL.
  Device();
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

 private:
  friend class Drawer;
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// A scene under its light, made ready to be drawn: uploaded, its light baked, its programs compiled. Pictures of the
/// same settings share all of it. To be used on the thread of its device.
class Drawer {
 public:
  /// Without a device it opens one of its own. Throws Error for a scene that validate() refuses, and without OpenGL.
  Drawer(std::shared_ptr<const Scene> scene, const Environment& environment,
         const shade::ShadingModel& shading = shade::shading_model_candela(), std::shared_ptr<Device> device = nullptr);
  Drawer(Scene scene, const Environment& environment,
         const shade::ShadingModel& shading = shade::shading_model_candela(), std::shared_ptr<Device> device = nullptr);
  ~Drawer();
  Drawer(const Drawer&) = delete;
  Drawer& operator=(const Drawer&) = delete;

  /// Light within the scene, which stands in for light from far away on every surface: that of the nearest probe. For
  /// what is drawn from here on; none: the environment's.
  void set_probes(std::vector<Probe> probes);
  /// Another moment of the same scene, as Moment::scene.
  void set_scene(std::shared_ptr<const Scene> scene);

  /// The picture that a view has: the mean of its frames, after a stop of those so far, at least of one. Throws Error
  /// for settings and views that make no sense, and where the driver refuses a shader or runs out of memory.
  Film render(const View& view, const Settings& settings, const Job& job = {}, Statistics* statistics = nullptr);
  /// The same where each frame shows another moment. The last one stays.
  Film render(const MomentOf& moment, const Settings& settings, const Job& job = {}, Statistics* statistics = nullptr);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// One picture by a Drawer of its own. `scene` is not copied. Throws Error.
Film render(const Scene& scene, const Environment& environment, const View& view, const Settings& settings,
            const Job& job = {}, Statistics* statistics = nullptr);

/// Most bytes of main memory that the picture takes while it is drawn by a processor.
std::uint64_t picture_bytes(const Settings& settings);

}  // namespace candela::raster
