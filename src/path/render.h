#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <variant>

#include "image/film.h"
#include "scene/scene.h"
#include "scene/view.h"
#include "shade/model.glsl.h"

namespace candela::path {

enum class PixelFilter { box, gaussian, blackman_harris };
enum class Integrator {
  full,    ///< next-event estimation with multiple importance sampling
  minimal  ///< samples the material only: same mean, more noise; the reading ladder and the test oracle
};

/// What a camera ray sees that hits nothing, or nothing but glass that it passes. A plain colour is `transparent` with
/// DevelopSettings::background.
enum class Background { environment, transparent };

struct Settings {
  int width = 1280;
  int height = 720;
  int samples = 64;                      ///< per pixel; with a stop below, the most a pixel may take
  std::optional<double> time_limit_s{};  ///< stop after about this long
  std::optional<float> noise{};          ///< stop a pixel when its estimated relative error is below this, e.g. 0.01
  int bounces = 8;                       ///< scattering events after the first hit is 1: `1` is direct light only
  std::uint32_t seed = 0;
  PixelFilter filter = PixelFilter::box;
  float filter_radius = 0.0f;  ///< pixels; 0 = the filter's own: box 0.5, Gaussian 1.5, Blackman–Harris 1.5
  Integrator integrator = Integrator::full;
  Background background = Background::environment;
  /// Of another background: glass shows the environment behind it all the same.
  bool environment_in_glass = false;
  /// False: what camera rays see is lit by lamps and suns, but they are not in the picture (for probes, beside which
  /// lamps light on their own).
  bool sees_lamps = true;
  shade::ShadingModel shading = shade::shading_model_candela();
  std::set<Layer> layers{};
};

struct Progress {
  double fraction = 0.0;      ///< of the work, estimated when a time or noise stop is set
  double seconds = 0.0;       ///< since rendering began
  double mean_samples = 0.0;  ///< per pixel so far
  double samples_per_second = 0.0;
  std::optional<double> remaining_s;
};

/// How near a picture came to Settings::noise.
struct NoiseReached {
  double share_above = 0.0;  ///< of the pixels whose estimated relative error is above it
  float worst = 0.0f;        ///< error of any pixel; infinite where a pixel has one sample
};

struct Statistics {
  double build_s = 0.0;  ///< acceleration structure and light tables
  double render_s = 0.0;
  std::uint64_t samples = 0;  ///< camera samples
  std::uint64_t camera_rays = 0;
  std::uint64_t bounce_rays = 0;
  std::uint64_t shadow_rays = 0;
  std::uint64_t non_finite_samples = 0;  ///< must be 0; each was left out of the picture
  std::uint64_t triangles = 0;           ///< stored once per mesh
  std::uint64_t instances = 0;
  double mean_samples_per_pixel = 0.0;
  bool interrupted = false;           ///< stopped by `Callbacks::stop`
  bool timed_out = false;             ///< stopped by `Settings::time_limit_s`
  std::optional<NoiseReached> noise;  ///< where a target was set
};

struct Callbacks {
  std::function<void(const Progress&)> progress;  ///< called from one thread, a few times a second
  /// Called from one thread with the picture so far, every `partial_interval_s` on renders longer than that.
  std::function<void(Film)> partial;
  double partial_interval_s = 5.0;
  const std::atomic<bool>* stop = nullptr;  ///< set to end early with what there is
};

/// Most bytes that the picture takes while it is rendered, the film in the caller's hands included; the scene comes to
/// that.
std::uint64_t picture_bytes(const Settings& settings);

/// Renders `scene` under `environment`. The result depends on the arguments alone, never on the number of threads
/// (with a time limit it depends on how many passes fitted).
Film render(const Scene& scene, const Environment& environment, const View& view, const Settings& settings,
            Statistics* statistics = nullptr, const Callbacks& callbacks = {});

}  // namespace candela::path
