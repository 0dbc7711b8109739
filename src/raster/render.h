#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "image/film.h"
#include "raster/image_light.h"
#include "raster/quantity.h"
#include "scene/scene.h"
#include "scene/view.h"
#include "shade/model.glsl.h"

/// The real-time renderer: OpenGL ES 3.0, on a GPU or on a processor, without a window.
namespace candela::raster {

enum class Background { environment, transparent };

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
  shade::ShadingModel shading = shade::shading_model_candela();
  std::set<Layer> layers{};
  std::filesystem::path cache{};  ///< folder of baked environments; empty = none is kept
  std::string shader_folder{};    ///< read instead of the shaders in the program; empty = those
};

struct Progress {
  std::size_t picture = 0;  ///< that is drawn
  std::size_t pictures = 1;
  int frame = 0;          ///< of that picture: drawn so far
  double fraction = 0.0;  ///< of the work
  double seconds = 0.0;   ///< since the first frame began
};

struct Callbacks {
  std::function<void(const Progress&)> progress;  ///< called from the drawing thread, some times a second at most
  /// Set to end early: the picture at hand is the mean of its frames so far, at least of one; no other is begun.
  const std::atomic<bool>* stop = nullptr;
};

struct Statistics {
  std::string driver;
  bool interrupted = false;  ///< by `Callbacks::stop`, with frames or pictures left
  bool is_light_cached = false;
  double open_s = 0.0;    ///< the context
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

/// What one frame of a picture shows where things move: `scene` must be the scene that is drawn at another moment, with
/// as many materials and the IES profiles of that, and live until the next moment is asked for.
struct Moment {
  const Scene* scene = nullptr;
  View view;
};
using MomentOf = std::function<Moment(std::size_t picture, int frame)>;

/// An OpenGL context, and the environment that was baked last: many pictures pay for them once. To be used on the
/// thread that made it.
class Session {
 public:
  /// Throws Error where there is no OpenGL.
  Session();
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Light within a scene, which stands in for light from far away on every surface: that of the nearest probe. For the
  /// scenes drawn from here on; none: the environment's.
  void set_probes(std::vector<Probe> probes);

  /// Draws `scene` under `environment` from each of `views`, uploading and compiling once, and hands each picture to
  /// `take` with the index of its view. Where there is a `moment`, each frame shows what it says. Throws Error where
  /// the driver refuses a shader or runs out of memory.
  void draw(const Scene& scene, const Environment& environment, const std::vector<View>& views,
            const Settings& settings, Diagnostics& diagnostics, const std::function<void(std::size_t, Film)>& take,
            Statistics* statistics = nullptr, const MomentOf& moment = {}, const Callbacks& callbacks = {});

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// One picture, by a Session of its own. Throws Error.
Film render(const Scene& scene, const Environment& environment, const View& view, const Settings& settings,
            Diagnostics& diagnostics, Statistics* statistics = nullptr, const Callbacks& callbacks = {});

/// Most bytes of main memory that the picture takes while it is drawn by a processor.
std::uint64_t picture_bytes(const Settings& settings);

}  // namespace candela::raster
