#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "image/develop.h"
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
  int frames = 1;  ///< per picture, each jittered within the pixel and over the lens; the picture is their mean
  int msaa = 4;    ///< samples per pixel of each frame: 1, 2, 4 or what the driver has
  /// How often a texture is read along the longer side of a pixel's footprint, at most; 0: 8 times on a GPU, once by a
  /// driver in software. Mesa's takes any number above 1 as 16, draws half as fast then and blurs what is magnified.
  int texture_anisotropy = 0;
  /// Widens highlights by the variation of the normal within a pixel. One sample per pixel needs this; it lessens with
  /// more frames.
  bool specular_antialiasing = true;
  /// Up to which distance surfaces occlude the environment, relative to the scene's diagonal; 0 = they do not.
  float occlusion_radius = 0.0f;
  Background background = Background::environment;
  /// With another background: glass still shows the environment behind it.
  bool environment_in_glass = false;
  Ambient ambient = Ambient::baked;
  /// Shadows soften with the distance from the occluder: those of suns and area lights by their own size, those of
  /// point and spot lights by `light_radius`.
  bool has_soft_shadows = false;
  float light_radius = 0.0f;            ///< metres
  bool has_shadows = true;              ///< false: lamps shine through everything
  Quantity quantity = Quantity::light;  ///< shown in place of all light; then without a background
  int most_textures = 0;                ///< that a shader reads at once; 0: the driver's limit. The minimum is 16
  int shown_light = 0;                  ///< for Quantity::one_light; the strongest is 0
  std::set<Layer> layers{};
  std::set<MatteKind>
      mattes{};            ///< Film::mattes has these: means over the frames, and over as many more as make sixteen
  bool has_masks = false;  ///< Film::masks
  std::filesystem::path cache{};  ///< folder of baked environments; empty = none are kept
  std::string shader_folder{};    ///< with shaders to use instead of the built-in ones; empty = built-in

  bool operator==(const Settings&) const = default;
};

struct Statistics {
  std::string driver;
  bool interrupted = false;  ///< by Job::stop, with frames left
  bool is_light_cached = false;
  double open_s = 0.0;    ///< the context; each of these times counts in the first picture that needed the step
  double light_s = 0.0;   ///< baking or reading the environment, in parallel with the following
  double upload_s = 0.0;  ///< scene and environment to the driver
  double shadow_s = 0.0;
  double compile_s = 0.0;  ///< the first frame, which is discarded
  double frame_s = 0.0;    ///< all frames, reading back included
  double draw_s = 0.0;     ///< the part of that until the driver has finished drawing
  int frames = 0;          ///< of all pictures
  int programs = 0;
  std::uint64_t triangles = 0;
  std::uint64_t draws = 0;
  std::uint64_t non_finite_pixels = 0;  ///< must be 0; each is black in the picture
};

/// Adds the statistics of one picture: times and counts are summed, those of the scene are the last picture's.
void add_work(const Statistics& picture, Statistics& all);

/// Throws Error where this build is without the rasterizer, as all that draws does.
void check_built();

/// The content of one frame of a moving picture: the drawn scene at another moment, with the same number of materials
/// and the same IES profiles.
struct Moment {
  std::shared_ptr<const Scene> scene;
  View view;
};
using MomentOf = std::function<Moment(int frame)>;

/// An OpenGL context, and the environment that was baked last: many scenes can share them. To be used only on the
/// thread that made it, which may have several.
class Device {
 public:
  /// Throws Error without OpenGL.
  Device();
  /// On the OpenGL ES 3.0 context that is current, a window's for example. It must stay current while the device, or
  /// any Drawer of it, is used or deleted.
  static std::shared_ptr<Device> of_current_context();
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

 private:
  friend class Drawer;
  friend class Sketch;
  struct Parts;
  explicit Device(std::unique_ptr<Parts> parts);
  /// Makes its context the current one. Throws Error where another thread has it.
  void use() const;
  std::unique_ptr<Parts> parts_;
};

/// A scene with its light, prepared for drawing: uploaded, its light baked, its programs compiled. Pictures with the
/// same settings, but for their size, share all of it. To be used only on the thread of its device.
class Drawer {
 public:
  /// Without a device it opens its own. Throws Error for a scene that validate() refuses, and without OpenGL.
  Drawer(std::shared_ptr<const Scene> scene, const Environment& environment,
         const shade::ShadingModel& shading = shade::shading_model_candela(), std::shared_ptr<Device> device = nullptr);
  Drawer(Scene scene, const Environment& environment,
         const shade::ShadingModel& shading = shade::shading_model_candela(), std::shared_ptr<Device> device = nullptr);
  ~Drawer();
  Drawer(const Drawer&) = delete;
  Drawer& operator=(const Drawer&) = delete;

  /// Light within the scene, which replaces distant light on every surface by that of the nearest probe, in the
  /// pictures drawn from now on. None: the environment's light.
  void set_probes(std::vector<Probe> probes);
  /// Another moment of the same scene, as Moment::scene.
  void set_scene(std::shared_ptr<const Scene> scene);
  /// Another environment in what is drawn from now on; `light` is what bake_light_of() made of it. Nothing is compiled
  /// or uploaded anew but that. Before the first picture it stands for the constructor's environment, which is then not
  /// baked.
  void set_environment(const Environment& environment, BakedLight light);
  /// The environment with another rotation and intensity, without baking: its baked light is turned and multiplied.
  void turn_environment(float rotation, float intensity);

  /// The picture of a view: the mean of its frames; after a stop, of those so far, at least one. Throws Error for
  /// invalid settings and views, and if the driver rejects a shader or runs out of memory.
  Film render(const View& view, const Settings& settings, const Job& job = {}, Statistics* statistics = nullptr);
  /// The same with another moment in each frame. The scene of the last one stays.
  Film render(const MomentOf& moment, const Settings& settings, const Job& job = {}, Statistics* statistics = nullptr);

  // ----- one frame after the other, as a window needs them
  /// Draws one frame of a view, through the middle of pixels and lens, and leaves it with the driver until something
  /// else is drawn. Throws Error as render(); what was drawn before stays then. Warnings go to the job. After a stop of
  /// the job it throws Interrupted, looked for while light is baked and, in `bands` of long frames, between these;
  /// there is no frame then.
  void draw_frame(const View& view, const Settings& settings, const Job& job = {}, int bands = 1);
  /// Shows the frame in the framebuffer of a window of `size` pixels, which has the device's context. Throws Error
  /// where none was drawn, as read_frame().
  void present(ivec2 size, float exposure, ToneCurve tone_curve);
  /// The same as a picture of the frame's size.
  DisplayImage read_shown(float exposure, ToneCurve tone_curve);
  /// What is at the centre of each pixel of a view, in the size of the last frame.
  SurfaceMap read_surfaces(const View& view);
  /// The frame as a picture, without layers.
  Film read_frame();
  /// Compiles the shaders of Settings::shader_folder again when they are next needed.
  void reload_shaders();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// The light of an environment as a Drawer of the scene has it, for Drawer::set_environment: on any thread. Throws
/// Interrupted where the StopScope of the caller says so.
BakedLight bake_light_of(const Scene& scene, const Environment& environment, const std::filesystem::path& cache);

/// One picture by a temporary Drawer. `scene` is not copied. Throws Error.
Film render(const Scene& scene, const Environment& environment, const View& view, const Settings& settings,
            const Job& job = {}, Statistics* statistics = nullptr);

/// Most bytes of main memory that the picture takes while a software driver draws it.
std::uint64_t picture_bytes(const Settings& settings);

}  // namespace candela::raster
