#include "raster/render.h"

#include <fmt/format.h>

#include <chrono>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/diagnostics.h"
#include "base/error.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "candela/candela.h"
#include "cli/interrupt.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/render_outputs.h"
#include "cli/render_statistics.h"
#include "cli/values.h"
#include "cli/verbs.h"
#include "image/image_file.h"
#include "path/statistics.h"
#include "raster/image_light.h"

namespace candela::cli {

namespace fs = std::filesystem;

namespace {

class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

/// Everything that is known before the first ray.
struct Job {
  explicit Job(Asset opened) : asset(std::move(opened)) {}

  Asset asset;
  bool is_moving = false;                  ///< an animation is shown
  std::vector<double> moments_s;           ///< of each picture, from the animation's start
  std::optional<std::size_t> camera_node;  ///< the scene's own camera that is looked through for want of another
  bool has_own_camera = false;             ///< which may move
  Scene scene;                             ///< of the first picture
  Environment environment;
  std::vector<View> views;
  DevelopSettings develop;
  std::string camera;  ///< in words, for the EXR header
};

raster::Settings raster_settings(const RenderOptions& o) {
  raster::Settings settings;
  settings.width = o.settings.width;
  settings.height = o.settings.height;
  settings.frames = o.settings.samples;
  settings.msaa = o.msaa;
  settings.background = o.settings.background == path::Background::transparent ? raster::Background::transparent
                                                                               : raster::Background::environment;
  settings.environment_in_glass = o.settings.environment_in_glass;
  settings.shading = o.settings.shading;
  settings.layers = o.settings.layers;
  settings.occlusion_radius = o.occlusion_radius;
  settings.quantity = o.quantity;
  settings.shown_light = o.shown_light;
  if (o.keeps_cache) settings.cache = raster::default_cache();
  settings.shader_folder = o.shader_folder;
  settings.ambient = o.ambient;
  settings.has_soft_shadows = o.has_soft_shadows;
  settings.light_radius = o.light_radius;
  return settings;
}

/// A picture that cannot be held is refused here, not by the system in the middle of the work.
void check_memory(const RenderOptions& o) {
  std::uint64_t writing = 0;
  for (const std::string& output : o.outputs)
    writing = std::max(writing, writing_bytes(output, o.size.x, o.size.y, o.settings.layers));
  const std::uint64_t drawing =
      o.engine == Engine::raster ? raster::picture_bytes(raster_settings(o)) : path::picture_bytes(o.settings);
  require_memory(drawing + writing, available_memory(), fmt::format("a picture of {}x{}", o.size.x, o.size.y),
                 "--size");
}

std::string vec3_text(vec3 v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }

/// Which camera of the scene is looked through where no option says it, and a word on cameras and framings that show
/// nothing.
std::optional<std::size_t> choose_camera(const RenderOptions& o, const Scene& scene, Diagnostics& diagnostics) {
  const float aspect = static_cast<float>(o.size.x) / static_cast<float>(o.size.y);
  std::optional<std::size_t> node;
  const auto emptiness = find_emptiness(scene);
  const bool is_empty = emptiness && world_bounds(scene).empty();
  if (o.camera) {
    if (!is_empty && !sees_something(scene, scene_camera(scene, *o.camera, aspect))) {
      diagnostics.warn(fmt::format("the camera {} sees nothing of the scene", *o.camera), o.scene);
    }
  } else if (!o.eye && !o.orbit) {
    node = default_camera(scene, aspect, &diagnostics);
  }
  const bool is_framed = !o.camera && !o.eye && !node;
  if (emptiness && (is_empty || is_framed)) diagnostics.warn(emptiness->message, o.scene);
  return node;
}

View choose_view(const RenderOptions& o, const Scene& scene, std::optional<std::size_t> camera_node,
                 std::string& description) {
  const float aspect = static_cast<float>(o.size.x) / static_cast<float>(o.size.y);
  const float yfov = o.fov.value_or(PerspectiveCamera{}.yfov);
  if (o.eye) {
    const vec3 target = o.target.value_or(subject_bounds(scene).center());
    if (*o.eye == target) throw Error("the camera is where it looks at", "--eye");
    description = "eye " + vec3_text(*o.eye) + " target " + vec3_text(target);
    return look_at(*o.eye, target, yfov);
  }
  if (o.orbit) {
    description =
        fmt::format("orbit {},{},{}", degrees(o.orbit->azimuth), degrees(o.orbit->elevation), o.orbit->distance_scale);
    return frame_box(subject_bounds(scene), aspect, yfov, *o.orbit);
  }
  description = o.camera ? "camera " + *o.camera : "default";
  if (!o.camera && !camera_node) return frame_box(subject_bounds(scene), aspect, yfov);
  View view =
      o.camera ? scene_camera(scene, *o.camera, aspect) : scene_camera(scene, scene.nodes[*camera_node], aspect);
  if (!o.fov) return view;
  auto* perspective = std::get_if<PerspectiveCamera>(&view.projection);
  if (perspective == nullptr) throw Error("the scene's camera is orthographic and has no field of view", "--fov");
  perspective->yfov = *o.fov;
  return view;
}

void set_lens(const RenderOptions& o, const Scene& scene, View& view) {
  if (o.vignetting > 0.0f && !std::holds_alternative<PerspectiveCamera>(view.projection)) {
    throw Error("an orthographic camera has no lens", "--vignetting");
  }
  view.lens.vignetting = o.vignetting;
  if (o.f_number) {
    const auto* perspective = std::get_if<PerspectiveCamera>(&view.projection);
    if (perspective == nullptr) throw Error("an orthographic camera has no lens", "--f-number");
    view.lens.radius = aperture_radius(*o.f_number, perspective->yfov);
  }
  if (view.lens.radius <= 0.0f) {
    if (o.blades > 0) throw Error("without an aperture has no effect: give --f-number", "--blades");
    if (o.focus_given) throw Error("without an aperture has no effect: give --f-number", "--focus-distance");
    return;
  }
  view.lens.blades = o.blades;
  if (!o.f_number && !o.focus_given) return;  // the scene's own camera, focused by its author
  if (o.focus_distance) {
    view.lens.focus_distance = *o.focus_distance;
    return;
  }
  const vec3 subject = o.target.value_or(subject_bounds(scene).center());
  const float distance = -transform_point(glm::inverse(view.world_from_camera), subject).z;
  if (!(distance > 0.0f)) throw Error("the subject is behind the camera: give --focus-distance", "--f-number");
  view.lens.focus_distance = distance;
}

void set_falloff(const FalloffChoice& choice, Scene& scene) {
  for (Light& light : scene.lights) {
    light.falloff = choice.kind;
    if (choice.polynomial) light.polynomial = *choice.polynomial;
  }
}

/// `view` turned about the vertical axis through `center` by equal steps.
std::vector<View> all_around(const View& view, vec3 center, int count) {
  std::vector<View> views;
  for (int i = 0; i < count; ++i) {
    const float angle = 2.0f * kPi * static_cast<float>(i) / static_cast<float>(count);
    const mat4 turn = glm::mat4_cast(glm::angleAxis(angle, vec3(0, 1, 0)));
    mat4 there(1.0f), back(1.0f);
    there[3] = vec4(center, 1.0f), back[3] = vec4(-center, 1.0f);
    views.push_back(view);
    views.back().world_from_camera = there * turn * back * view.world_from_camera;
  }
  return views;
}

/// What several scenes of one run share.
struct Shared {
  struct Loaded {
    Environment environment;
    Diagnostics diagnostics;  ///< each scene hears of them
  };
  std::map<std::string, Loaded> environments;  ///< by name or path
  std::unique_ptr<raster::Session> session;    ///< opened when the first picture needs it

  const Environment& environment(const std::string& name, Diagnostics& diagnostics) {
    auto found = environments.find(name);
    if (found == environments.end()) {
      Loaded loaded;
      loaded.environment = make_environment(name, &loaded.diagnostics);
      found = environments.emplace(name, std::move(loaded)).first;
    }
    for (const Diagnostic& warning : found->second.diagnostics.warnings())
      diagnostics.warn(warning.message, warning.where);
    return found->second.environment;
  }
  raster::Session& raster(int threads) {
    // Mesa's processor driver has threads of its own.
    if (session == nullptr && threads > 0) setenv("LP_NUM_THREADS", std::to_string(threads).c_str(), 0);
    if (session == nullptr) session = std::make_unique<raster::Session>();
    return *session;
  }
};

/// The scene at a moment of its animation, or at rest.
Scene scene_at(const RenderOptions& o, Job& job, double moment_s) {
  std::optional<Pose> pose;
  if (job.is_moving) pose = Pose{o.animation.value_or(""), moment_s};
  Scene scene = job.asset.scene(pose);
  if (o.light_falloff) set_falloff(*o.light_falloff, scene);
  for (Camera& camera : scene.cameras) {
    if (o.ignores_planes) camera.near_plane = 0.0f, camera.far_plane = kInfinity;
  }
  return scene;
}

/// The view of picture `index` in a scene of another moment.
View view_at(const RenderOptions& o, const Job& job, const Scene& scene, std::size_t index) {
  if (!job.has_own_camera) return job.views[std::min(index, job.views.size() - 1)];
  std::string description;
  View view = choose_view(o, scene, job.camera_node, description);
  set_lens(o, scene, view);
  return view;
}

/// Whether something moves, and when each picture is taken.
void choose_moments(const RenderOptions& o, Job& job, Diagnostics& diagnostics) {
  const bool is_asked = o.frame_time_s || o.animation || o.shutter_s > 0.0 || o.sequence;
  const bool is_animated = job.asset.is_animated();
  if (is_asked && !is_animated && !o.animation) {
    diagnostics.warn("nothing in it is animated: shown as it stands", o.scene);
  }
  job.is_moving = is_asked && (is_animated || o.animation);
  const double first = o.frame_time_s.value_or(0.0);
  job.moments_s.assign(static_cast<std::size_t>(o.turntable.value_or(1)), first);
  if (!o.sequence) return;
  const double length = std::max(job.asset.duration_s(o.animation.value_or("")) - first, 0.0);
  job.moments_s.resize(static_cast<std::size_t>(*o.sequence));
  for (std::size_t i = 0; i < job.moments_s.size(); ++i) {
    job.moments_s[i] = first + length * static_cast<double>(i) / static_cast<double>(job.moments_s.size());
  }
}

void prepare(const RenderOptions& o, Shared& shared, Job& job, Diagnostics& diagnostics) {
  choose_moments(o, job, diagnostics);
  job.scene = scene_at(o, job, job.moments_s[0]);
  job.environment = !o.environment && job.scene.image_light
                        ? job.scene.image_light->environment
                        : shared.environment(o.environment.value_or(default_environment(job.scene)), diagnostics);
  const bool has_more_moments = job.moments_s.size() > 1 || o.shutter_s > 0.0;
  if (!o.environment && job.scene.image_light && job.is_moving && has_more_moments &&
      job.asset.moves_image_light(o.animation.value_or(""))) {
    diagnostics.warn("the image-based light moves, and stands as at the first moment", o.scene);
  }
  job.environment.rotation += o.environment_rotation;
  job.environment.intensity *= o.environment_intensity;
  job.camera_node = choose_camera(o, job.scene, diagnostics);
  View view = choose_view(o, job.scene, job.camera_node, job.camera);
  set_lens(o, job.scene, view);
  job.has_own_camera = (o.camera || job.camera_node) && job.is_moving && !o.turntable;
  job.views = all_around(view, o.target.value_or(subject_bounds(job.scene).center()), o.turntable.value_or(1));
  job.develop = default_develop(job.scene, job.environment);
  if (o.exposure) job.develop.exposure = *o.exposure;
  job.develop.tone_curve = o.tone_curve;
  job.develop.bloom = o.bloom;
  if (shows_numbers(o.quantity)) {
    // Numbers, not light: shown as they are.
    job.develop.exposure = 1.0f;
    job.develop.tone_curve = ToneCurve::linear;
  }
  job.develop.background = o.background.color;

  for (const fs::path output : o.outputs) {
    if (is_linear_format(output) && o.develop_given) {
      diagnostics.warn("--exposure, --tonemap and --bloom have no effect on linear radiance", output.string());
    }
    if (o.background.color && has_extension(output, ".hdr")) {
      diagnostics.warn("--background's colour has no effect on linear radiance, and this format has no transparency",
                       output.string());
    }
    const bool keeps_alpha = has_extension(output, ".png") || has_extension(output, ".exr");
    if (o.background.kind == path::Background::transparent && !o.background.color && !keeps_alpha) {
      diagnostics.warn("this format has no transparency", output.string());
    }
  }
}

/// With --strict the first warning is the error that ends the work; `shown` of them were printed already.
void report_warnings(const RenderOptions& o, const Diagnostics& diagnostics, std::size_t shown,
                     ProgressLine& progress) {
  const auto& warnings = diagnostics.warnings();
  const bool fails = o.strict && shown < warnings.size();
  for (std::size_t i = fails ? shown + 1 : shown; i < warnings.size(); ++i) progress.warn(warnings[i]);
  if (!fails) return;
  const std::size_t more = warnings.size() - shown - 1;
  throw Error(warnings[shown].message + (more > 0 ? fmt::format(" (--strict; and {} more)", more) : " (--strict)"),
              warnings[shown].where);
}

std::map<std::string, std::string> metadata(const RenderOptions& o, const Job& job, double samples_per_pixel) {
  std::map<std::string, std::string> result{
      {"scene", o.scene},
      {"camera", job.camera},
      {"environment", job.environment.name},
      {"integrator", o.engine == Engine::raster                        ? "raster"
                     : o.settings.integrator == path::Integrator::full ? "full"
                                                                       : "minimal"},
      {"samples", fmt::format("{}", samples_per_pixel)},
      {"seed", fmt::format("{}", o.settings.seed)},
      {"version", fmt::format("candela {}", version())}};
  if (!o.scene_choice.empty()) result["scene_of_file"] = o.scene_choice;
  if (!o.variant.empty()) result["variant"] = o.variant;
  if (!o.shading.empty()) result["shading"] = o.shading;
  return result;
}

/// The picture so far, on disk: what is there when the machine goes down. Its cost is bounded by a twentieth of the
/// time.
class PartialWriter {
 public:
  PartialWriter(const RenderOptions& options, const Job& job, std::vector<fs::path> outputs, ProgressLine& progress)
      : options_(options), job_(job), outputs_(std::move(outputs)), progress_(progress) {
    for (const fs::path& output : outputs_) disabled_ |= is_device(output);
  }

  void operator()(Film film, double samples_per_pixel) {
    constexpr double kShareOfTime = 0.05;
    if (disabled_ || since_last_.seconds() < last_cost_s_ / kShareOfTime) return;
    const Stopwatch cost;
    try {
      film.metadata.merge(metadata(options_, job_, samples_per_pixel));
      write_outputs(outputs_, film, job_.develop);
    } catch (const Error& error) {
      disabled_ = true;  // the end may go better; say it once
      progress_.warn({error.message(), error.where()});
    }
    last_cost_s_ = cost.seconds();
    since_last_ = Stopwatch{};
  }

 private:
  const RenderOptions& options_;
  const Job& job_;
  std::vector<fs::path> outputs_;
  ProgressLine& progress_;
  Stopwatch since_last_;
  double last_cost_s_ = 0.0;
  bool disabled_ = false;
};

/// The mean of the moments while the shutter is open.
Film trace_moving(const RenderOptions& o, Job& job, std::size_t index, const path::Callbacks& callbacks,
                  path::Statistics& statistics) {
  constexpr int kMostMoments = 32;
  const int count = std::min(kMostMoments, o.settings.samples);
  path::Settings settings = o.settings;
  settings.samples = (settings.samples + count - 1) / count;
  if (settings.time_limit_s) *settings.time_limit_s /= count;
  if (settings.noise) *settings.noise *= std::sqrt(static_cast<float>(count));
  Film sum;
  int moments = 0;
  double samples_per_pixel = 0.0;
  for (int i = 0; i < count && !statistics.interrupted; ++i) {
    path::Callbacks of_moment = callbacks;
    of_moment.progress = [&](path::Progress p) {
      p.fraction = (i + p.fraction) / count;
      callbacks.progress(p);
    };
    of_moment.partial = nullptr;
    const Scene scene = scene_at(o, job, job.moments_s[index] + o.shutter_s * (i + 0.5) / count);
    path::Statistics one;
    const Film film = render(scene, job.environment, view_at(o, job, scene, index), settings, &one, of_moment);
    if (one.samples == 0) break;
    accumulate(film, 1.0f, sum);
    ++moments;
    samples_per_pixel += one.mean_samples_per_pixel;
    add_work(one, statistics);
    ++settings.seed;
  }
  statistics.mean_samples_per_pixel = samples_per_pixel;
  // Of the mean; each moment had a target of its own.
  if (statistics.noise && moments > 0) statistics.noise->worst /= std::sqrt(static_cast<float>(moments));
  // Interrupted, it is the mean of the moments so far.
  Film mean;
  if (moments > 0) accumulate(sum, 1.0f / static_cast<float>(moments), mean);
  return mean;
}

Film trace(const RenderOptions& o, Job& job, std::size_t index, ProgressLine& progress, path::Statistics& statistics) {
  PartialWriter partial(o, job, outputs_of(o, index), progress);
  double samples_per_pixel = 0.0;
  const Interrupt interrupt;
  path::Callbacks callbacks;
  callbacks.progress = [&](const path::Progress& p) {
    samples_per_pixel = p.mean_samples;
    progress.update(p);
  };
  callbacks.partial = [&](Film film) { partial(std::move(film), samples_per_pixel); };
  callbacks.stop = &Interrupt::requested();
  Film film;
  if (job.is_moving && o.shutter_s > 0.0) {
    film = trace_moving(o, job, index, callbacks, statistics);
  } else if (index > 0 && o.sequence) {
    const Scene scene = scene_at(o, job, job.moments_s[index]);
    film = render(scene, job.environment, view_at(o, job, scene, index), o.settings, &statistics, callbacks);
  } else {
    film = render(job.scene, job.environment, job.views[index], o.settings, &statistics, callbacks);
  }
  if (statistics.samples == 0) throw Interrupted("before the first sample: no picture");
  return film;
}

/// Pictures of a turntable have one exposure, that of the first: else they would flicker.
void keep_exposure(const RenderOptions& o, const Film& film, DevelopSettings& develop) {
  if (o.has_many_pictures() && !develop.exposure) develop.exposure = metered_exposure(film);
}

/// What became of the pictures of one scene.
struct Outcome {
  std::size_t asked = 0;
  std::size_t done = 0;
  bool is_interrupted = false;      ///< with samples, frames or pictures left
  bool is_last_unfinished = false;  ///< of those that are done
};

/// Pictures by the rasterizer, from what is loaded to what is written.
Outcome draw(const RenderOptions& o, Job& job, Shared& shared, Times& times, const Stopwatch& total,
             Diagnostics& diagnostics, ProgressLine& progress) {
  progress.phase("drawing");
  const Interrupt interrupt;
  Outcome outcome{.asked = job.moments_s.size()};
  raster::Statistics statistics;
  const raster::Settings settings = raster_settings(o);
  DevelopSettings develop = job.develop;
  int frames_before = 0;
  const auto take = [&](std::size_t index, Film film) {
    const int frames = statistics.frames - frames_before;
    frames_before = statistics.frames;
    outcome.is_last_unfinished = frames < settings.frames;
    film.metadata.merge(metadata(o, job, frames));
    keep_exposure(o, film, develop);
    const Stopwatch writing;
    write_outputs(outputs_of(o, index), film, develop);
    times.write_s += writing.seconds();
    ++outcome.done;
  };
  Scene moved;
  raster::MomentOf moment;
  if (job.is_moving && (o.shutter_s > 0.0 || o.sequence)) {
    moment = [&](std::size_t index, int frame) {
      const double share = (frame + 0.5) / settings.frames;
      moved = scene_at(o, job, job.moments_s[index] + (o.shutter_s > 0.0 ? o.shutter_s * share : 0.0));
      return raster::Moment{&moved, view_at(o, job, moved, index)};
    };
  }
  std::vector<View> views = job.views;
  views.resize(job.moments_s.size(), views.back());
  constexpr int kProbeSamples = 64;
  path::Callbacks of_probes;
  of_probes.progress = [&](const path::Progress& p) { progress.update(p.fraction, "tracing probes"); };
  of_probes.stop = &Interrupt::requested();
  raster::Callbacks of_frames;
  of_frames.progress = [&](const raster::Progress& p) {
    const std::string picture = p.pictures > 1 ? fmt::format("picture {} of {}, ", p.picture + 1, p.pictures) : "";
    progress.update(p.fraction, fmt::format("{}frame {} of {}", picture, p.frame, settings.frames));
  };
  of_frames.stop = &Interrupt::requested();
  shared.raster(o.threads).set_probes(bake_probes(job.scene, job.environment, o.probes, kProbeSamples, of_probes));
  shared.raster(o.threads).draw(job.scene, job.environment, views, settings, diagnostics, take, &statistics, moment,
                                of_frames);
  outcome.is_interrupted = statistics.interrupted;
  times.total_s = total.seconds();
  if (statistics.non_finite_pixels > 0) {
    diagnostics.warn(fmt::format("{} pixels were not finite and are black", statistics.non_finite_pixels), o.scene);
  }
  for (const std::string& output : o.outputs) {
    progress.line(fmt::format("{}{}: {}x{}, {} {} in {}, {} each, on {}", outcome.is_interrupted ? "interrupted, " : "",
                              output, o.size.x, o.size.y, statistics.frames,
                              statistics.frames == 1 ? "frame" : "frames", duration_text(times.total_s),
                              duration_text(statistics.frame_s / statistics.frames), statistics.driver));
  }
  if (o.stats) write_stats(o, stats_json(o, statistics, times, diagnostics));
  return outcome;
}

/// Pictures by the path tracer.
Outcome trace_all(const RenderOptions& o, Job& job, int threads, Times& times, const Stopwatch& total,
                  Diagnostics& diagnostics, ProgressLine& progress) {
  Outcome outcome{.asked = job.moments_s.size()};
  path::Statistics statistics;
  DevelopSettings develop = job.develop;
  for (std::size_t index = 0; index < job.moments_s.size() && !outcome.is_interrupted; ++index) {
    progress.phase("building");
    path::Statistics of_picture;
    Film film = trace(o, job, index, progress, of_picture);
    film.metadata.merge(metadata(o, job, of_picture.mean_samples_per_pixel));
    add_work(of_picture, statistics);
    statistics.mean_samples_per_pixel = of_picture.mean_samples_per_pixel;

    const Stopwatch writing;
    const std::vector<fs::path> outputs = outputs_of(o, index);
    keep_exposure(o, film, develop);
    write_outputs(outputs, film, develop);
    ++outcome.done;
    times.write_s += writing.seconds();
    times.total_s = total.seconds();
    for (const fs::path& output : outputs) {
      progress.line(fmt::format("{}{}: {}x{}, {:.4g} samples per pixel in {}, {:.2f} Msamples/s",
                                of_picture.interrupted ? "interrupted, " : "", output.string(), film.width(),
                                film.height(), of_picture.mean_samples_per_pixel, duration_text(times.total_s),
                                static_cast<double>(of_picture.samples) / std::max(of_picture.render_s, 1e-9) * 1e-6));
    }
    outcome.is_last_unfinished = of_picture.interrupted;
    outcome.is_interrupted = of_picture.interrupted || (outcome.done < outcome.asked && Interrupt::requested());
  }
  statistics.interrupted = outcome.is_interrupted;
  if (statistics.non_finite_samples > 0) {
    diagnostics.warn(fmt::format("{} samples were not finite and are left out", statistics.non_finite_samples),
                     o.scene);
  }
  warn_of_noise(o, statistics, diagnostics);
  if (o.stats) write_stats(o, stats_json(o, statistics, times, threads, diagnostics));
  return outcome;
}

Outcome render_scene(const RenderOptions& given, Inputs inputs, Shared& shared, int threads, ProgressLine& progress) {
  const Stopwatch total;
  RenderOptions o = given;
  // What is wrong with a name that was given is told before anything is loaded.
  if (!o.has_default_name) check_overwriting(o, inputs);
  check_paths(o);
  progress.phase("loading " + o.scene);
  Diagnostics diagnostics;
  Job job(Asset(o.scene, &diagnostics,
                LoadOptions{.variant = o.variant, .root = o.root, .scene = o.scene_choice, .measures = o.measures}));
  inputs.add(job.asset.files());
  choose_default_name(o, inputs);
  check_overwriting(o, inputs);
  prepare(o, shared, job, diagnostics);
  Times times{.load_s = total.seconds()};
  report_warnings(o, diagnostics, 0, progress);
  const std::size_t reported = diagnostics.warnings().size();
  const Outcome outcome = o.engine == Engine::raster ? draw(o, job, shared, times, total, diagnostics, progress)
                                                     : trace_all(o, job, threads, times, total, diagnostics, progress);
  report_warnings(o, diagnostics, reported, progress);
  return outcome;
}

/// A set that was stopped is not what was asked for, unlike one picture, which is there with fewer samples.
void report_interruption(std::size_t done, std::size_t asked, bool is_last_unfinished) {
  throw Interrupted(
      fmt::format("{} of {} pictures are there{}", done, asked, is_last_unfinished ? ", the last one unfinished" : ""));
}

/// A picture of each scene, whatever becomes of the others; throws at the end when one has none.
void render_batch(const RenderOptions& o, Inputs inputs, Shared& shared, int threads, ProgressLine& progress) {
  const fs::path folder = o.outputs[0];
  std::error_code code;
  fs::create_directories(folder, code);
  if (code) throw Error("cannot be made: " + code.message(), folder.string());
  // The picture of one scene must not be a texture of the next.
  add_scene_files(o.scenes, o.root, inputs);
  const std::vector<fs::path> outputs = batch_outputs(o.scenes, folder, inputs);
  std::size_t failed = 0, done = 0;
  bool is_last_unfinished = false;
  for (std::size_t i = 0; i < o.scenes.size() && !Interrupt::requested(); ++i) {
    RenderOptions one = o;
    one.scene = o.scenes[i];
    one.outputs = {outputs[i].string()};
    try {
      const Outcome outcome = render_scene(one, inputs, shared, threads, progress);
      done += outcome.done;
      is_last_unfinished = outcome.is_last_unfinished;
    } catch (const Error& error) {
      if (o.scenes.size() == 1) throw;
      ++failed;
      progress.warn({error.message(), error.where()});
    }
  }
  const bool is_cut_short = is_last_unfinished || done + failed < o.scenes.size();
  if (is_cut_short && o.scenes.size() > 1) report_interruption(done, o.scenes.size(), is_last_unfinished);
  if (failed > 0) throw Error(fmt::format("{} of {} scenes have no picture", failed, o.scenes.size()), folder.string());
}

void run_render(const RenderOptions& o) {
  ProgressLine progress(o.quiet);
  check_memory(o);
  const ThreadLimit threads(o.threads);
  Shared shared;
  const bool is_set = o.has_many_pictures() || o.scenes.size() > 1;
  std::optional<Interrupt> between;
  if (is_set) between.emplace();
  if (o.is_batch) return render_batch(o, inputs_of_options(o), shared, threads.threads(), progress);
  const Outcome outcome = render_scene(o, inputs_of_options(o), shared, threads.threads(), progress);
  if (is_set && outcome.is_interrupted) {
    report_interruption(outcome.done, outcome.asked, outcome.is_last_unfinished);
  }
}

}  // namespace

Verb add_render(CLI::App& app) {
  const auto options = std::make_shared<RenderOptions>();
  const CLI::App* verb = add_render_options(app, *options);
  return [options, verb] {
    finish_options(*verb, *options);
    run_render(*options);
  };
}

}  // namespace candela::cli
