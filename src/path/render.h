#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "image/develop.h"
#include "image/film.h"
#include "image/job.h"
#include "scene/scene.h"
#include "scene/view.h"
#include "shade/model.glsl.h"

namespace candela::path {

enum class PixelFilter { box, gaussian, blackman_harris };
/// Three estimators of the same expected value, from the fastest to the shortest; see integrator.h.
enum class Integrator {
  full,     ///< next-event estimation with multiple importance sampling
  minimal,  ///< samples the material only: same mean, more noise; the test oracle
  surfaces  ///< the same for scenes without bodies; others are an Error
};
/// "full", "minimal" or "surfaces".
const char* integrator_name(Integrator integrator);

/// Per pixel: what parts of a picture are multiples of.
inline constexpr int kSamplesOfBlock = 16;

struct Settings {
  int width = 1280;
  int height = 720;
  int samples = 64;  ///< per pixel; with a limit below, the most that a pixel may take
  /// Number of the first one: a part of a picture has those from here on, before `samples`. A multiple of
  /// kSamplesOfBlock; without a noise target.
  int first_sample = 0;
  std::optional<double> time_limit_s{};  ///< stop after about this long
  /// Stop a pixel when the standard error of what a display shows of it is estimated below this: Shown::error(), from 0
  /// (black) to 1 (white), after the exposure and tone curve of `develop`; e.g. 0.01 is 2.6 code values of 255.
  std::optional<float> noise{};
  DevelopSettings develop{};  ///< for `noise` alone; an empty exposure is metered from the picture so far
  int bounces = 8;            ///< surfaces that scatter along a path; 1 is direct light only
  std::uint32_t seed = 0;
  PixelFilter filter = PixelFilter::box;
  float filter_radius = 0.0f;  ///< pixels; 0 = the filter's own: box 0.5, Gaussian 1.5, Blackman–Harris 1.5
  Integrator integrator = Integrator::full;
  /// Largest channel of what one sample may bring as indirect light: radiance that was turned again after its first
  /// surface that is neither mirror nor clear glass. Takes light away: not the truth. Integrator::full only.
  std::optional<float> clamp{};
  Background background = Background::environment;
  /// With another background: glass still shows the environment behind it.
  bool environment_in_glass = false;
  /// False: lamps and suns light the scene but are not visible to camera rays (for probes, where lamps are separate
  /// lights).
  bool sees_lamps = true;
  /// False: camera rays that miss the scene see the environment that lights it, not its backdrop.
  bool sees_backdrop = true;
  std::set<Layer> layers{};
  std::set<MatteKind> mattes{};  ///< Film::mattes has these; lens and motion blur soften them
  bool has_masks = false;        ///< Film::masks
  /// The film has what a denoiser asks for; pictures of Job::partial do not. Integrator::full only.
  bool has_features = false;
};

/// How close a picture came to Settings::noise.
struct NoiseReached {
  double share_above = 0.0;  ///< of the pixels whose estimated error is above it
  float worst = 0.0f;        ///< largest error of a pixel, of the display's range; infinite if a pixel has one sample
};

struct Statistics {
  double build_s = 0.0;  ///< of the tracers that were made for it
  double render_s = 0.0;
  std::uint64_t samples = 0;         ///< camera samples
  std::uint64_t spared_samples = 0;  ///< saved in pixels that show only a smooth background
  std::uint64_t camera_rays = 0;
  std::uint64_t bounce_rays = 0;
  std::uint64_t shadow_rays = 0;
  std::uint64_t non_finite_samples = 0;  ///< must be 0; each was left out of the picture
  std::uint64_t triangles = 0;           ///< stored once per mesh
  std::uint64_t instances = 0;
  double mean_samples_per_pixel = 0.0;  ///< spared ones count
  bool interrupted = false;             ///< stopped by Job::stop
  bool timed_out = false;               ///< stopped by Settings::time_limit_s
  std::optional<NoiseReached> noise;    ///< where a target was set
};

/// Throws Error where this build is without the path tracer, as all that traces does.
void check_built();

/// Most bytes that the picture takes while it is rendered, including the film returned to the caller, without the
/// scene.
std::uint64_t picture_bytes(const Settings& settings);

struct PreparedEnvironment;
class Accumulator;

/// The light from infinitely far away, prepared for tracing: tracers of several scenes can share it.
class FarLight {
 public:
  explicit FarLight(const Environment& environment);

 private:
  friend class Tracer;
  std::shared_ptr<const PreparedEnvironment> prepared_;
};

struct DirectLight;
struct PixelSurface;
struct PixelEstimate;
struct PixelPathSettings;

/// A scene with its light, prepared for tracing: acceleration structure, light tables, materials with their textures.
/// Several threads may render pictures of it at once.
class Tracer {
 public:
  /// Throws Error for a scene that validate() refuses.
  Tracer(std::shared_ptr<const Scene> scene, const Environment& environment,
         const shade::ShadingModel& shading = shade::shading_model_candela());
  Tracer(Scene scene, const Environment& environment,
         const shade::ShadingModel& shading = shade::shading_model_candela());
  Tracer(std::shared_ptr<const Scene> scene, const FarLight& light,
         const shade::ShadingModel& shading = shade::shading_model_candela());
  /// The scene of `before`, or one with the same meshes, materials, textures, ground and nodes that hold meshes, under
  /// other light: what was built of these serves again. `before` may render meanwhile.
  Tracer(const Tracer& before, std::shared_ptr<const Scene> scene, const FarLight& light);
  /// Goes on with a scene that has other materials, textures and lights, and is otherwise the same, under other light.
  /// False, and nothing has changed, where what was built depends on what is different, or a picture of it is being
  /// made. Throws Error as the constructors.
  bool take_materials(const std::shared_ptr<const Scene>& scene, const FarLight& light,
                      const shade::ShadingModel& shading);

  /// The picture of a view. The result depends only on the arguments, never on the number of threads (with a time limit
  /// it depends on how many passes fitted). Throws Error for invalid settings and views.
  Film render(const View& view, const Settings& settings, const Job& job = {}, Statistics* statistics = nullptr) const;

  const Scene& scene() const;
  double build_s() const;  ///< time it took to construct, without a FarLight that was there

 private:
  friend class Picture;
  friend DirectLight trace_direct_light(const Tracer&, const View&, const Settings&, const Job&);
  friend std::optional<PixelSurface> find_pixel_surface(const Tracer&, const View&, ivec2, ivec2);
  friend PixelEstimate trace_pixel(const Tracer&, const View&, const Settings&, ivec2, const PixelPathSettings&,
                                   const Job&);
  struct Parts;
  std::shared_ptr<const Parts> parts_;
};

/// A picture that can be continued with more samples. Keeps alive what its tracer holds.
class Picture {
 public:
  /// Throws Error as Tracer::render does.
  Picture(const Tracer& tracer, const View& view, const Settings& settings);
  ~Picture();
  Picture(const Picture&) = delete;
  Picture& operator=(const Picture&) = delete;

  /// Traces until every pixel has `samples`, or as many as Settings::noise requires; existing samples count, also those
  /// of a stopped pass. The picture is the same as from one call with as many samples. Settings::time_limit_s applies
  /// to each call; Settings::samples is ignored. What a callback of the job throws arrives here, and the picture can be
  /// continued; after std::bad_alloc it cannot.
  void trace(int samples, const Job& job = {});

  /// The picture so far.
  Film film() const;
  Statistics statistics() const;

  /// What has been sampled so far, which can be added to that of other parts.
  const Accumulator& sums() const;
  /// Whether samples tell what background they let through: what an Accumulator has to know beside the settings.
  bool has_through() const;
  /// All that a picture of the same scene, view and settings needs to go on from here, and going on from there, in
  /// place of what was sampled. For one machine's order of bytes. Throws Error where they are not of such a picture.
  std::vector<std::byte> state() const;
  void set_state(std::span<const std::byte> bytes);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// One picture by a temporary Tracer. `scene` is not copied. Throws Error.
Film render(const Scene& scene, const Environment& environment, const View& view, const Settings& settings,
            const Job& job = {}, Statistics* statistics = nullptr);

}  // namespace candela::path
