#include "raster/render.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
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
#include "cli/render_options.h"
#include "cli/values.h"
#include "cli/verbs.h"
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
  Scene scene;
  Environment environment;
  View view;
  DevelopSettings develop;
  std::string camera;  ///< in words, for the EXR header
};

/// Never overwrite what the picture is made from, and find out about an unwritable path before hours of work.
void check_paths(const RenderOptions& o) {
  std::vector<fs::path> written(o.outputs.begin(), o.outputs.end());
  if (o.stats && *o.stats != "-") written.push_back(*o.stats);
  for (const fs::path& path : written) {
    for (const std::string& source : {o.scene, o.environment.value_or("")}) {
      std::error_code code;
      if (fs::equivalent(path, source, code)) throw Error("is an input of this picture", path.string());
    }
    check_writable(path);
  }
}

raster::Settings raster_settings(const RenderOptions& o) {
  raster::Settings settings;
  settings.width = o.settings.width;
  settings.height = o.settings.height;
  settings.frames = o.settings.samples;
  settings.msaa = o.msaa;
  settings.background = o.settings.background == path::Background::transparent ? raster::Background::transparent
                                                                               : raster::Background::environment;
  settings.shading = o.settings.shading;
  settings.layers = o.settings.layers;
  if (o.keeps_cache) settings.cache = raster::default_cache();
  settings.shader_folder = o.shader_folder;
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

View choose_view(const RenderOptions& o, const Scene& scene, std::string& description) {
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
  View view = o.camera ? scene_camera(scene, *o.camera, aspect) : default_view(scene, aspect);
  if (!o.fov) return view;
  auto* perspective = std::get_if<PerspectiveCamera>(&view.projection);
  if (perspective == nullptr) throw Error("the scene's camera is orthographic and has no field of view", "--fov");
  const bool from_file =
      std::any_of(scene.nodes.begin(), scene.nodes.end(), [](const Node& n) { return n.camera >= 0; });
  if (!from_file) return frame_box(subject_bounds(scene), aspect, yfov);
  perspective->yfov = *o.fov;
  return view;
}

void set_lens(const RenderOptions& o, const Scene& scene, View& view) {
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

Job prepare(const RenderOptions& o, Diagnostics& diagnostics) {
  Job job;
  job.scene = load(o.scene, &diagnostics, o.variant);
  if (o.light_falloff) set_falloff(*o.light_falloff, job.scene);
  job.environment = make_environment(o.environment.value_or(default_environment(job.scene)));
  job.environment.rotation += o.environment_rotation;
  job.environment.intensity *= o.environment_intensity;
  job.view = choose_view(o, job.scene, job.camera);
  set_lens(o, job.scene, job.view);
  job.develop = default_develop(job.scene, job.environment);
  if (o.exposure) job.develop.exposure = *o.exposure;
  job.develop.tone_curve = o.tone_curve;
  job.develop.background = o.background.color;

  if (world_bounds(job.scene).empty()) diagnostics.warn("nothing in the scene has a mesh", o.scene);
  for (const fs::path output : o.outputs) {
    if (is_linear_format(output) && o.develop_given) {
      diagnostics.warn("--exposure and --tonemap have no effect on linear radiance", output.string());
    }
    const bool keeps_alpha = has_extension(output, ".png") || has_extension(output, ".exr");
    if (o.background.kind == path::Background::transparent && !o.background.color && !keeps_alpha) {
      diagnostics.warn("this format has no transparency", output.string());
    }
  }
  return job;
}

/// With --strict the first warning ends the work; `shown` of them were printed already.
void report_warnings(const RenderOptions& o, const Diagnostics& diagnostics, std::size_t shown,
                     ProgressLine& progress) {
  const auto& warnings = diagnostics.warnings();
  for (std::size_t i = shown; i < warnings.size(); ++i) progress.warn(warnings[i]);
  if (!o.strict || shown == warnings.size()) return;
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
  if (!o.variant.empty()) result["variant"] = o.variant;
  if (!o.shading.empty()) result["shading"] = o.shading;
  return result;
}

/// The picture so far, on disk: what is there when the machine goes down. Its cost is bounded by a twentieth of the
/// time.
class PartialWriter {
 public:
  PartialWriter(const RenderOptions& options, const Job& job, ProgressLine& progress)
      : options_(options), job_(job), progress_(progress) {
    for (const fs::path output : options.outputs) disabled_ |= is_device(output);
  }

  void operator()(Film film, double samples_per_pixel) {
    constexpr double kShareOfTime = 0.05;
    if (disabled_ || since_last_.seconds() < last_cost_s_ / kShareOfTime) return;
    const Stopwatch cost;
    try {
      film.metadata.merge(metadata(options_, job_, samples_per_pixel));
      write_outputs({options_.outputs.begin(), options_.outputs.end()}, film, job_.develop);
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
  ProgressLine& progress_;
  Stopwatch since_last_;
  double last_cost_s_ = 0.0;
  bool disabled_ = false;
};

struct Times {
  double load_s = 0.0;
  double write_s = 0.0;
  double total_s = 0.0;
};

double cpu_seconds(const rusage& usage) {
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

std::string stats_json(const RenderOptions& o, const path::Statistics& s, const Times& times, int threads,
                       const Diagnostics& diagnostics) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  nlohmann::ordered_json json{
      {"version", version()},
      {"scene", o.scene},
      {"width", o.size.x},
      {"height", o.size.y},
      {"spp", s.mean_samples_per_pixel},
      {"threads", threads},
      {"load_s", times.load_s},
      {"build_s", s.build_s},
      {"render_s", s.render_s},
      {"write_s", times.write_s},
      {"total_s", times.total_s},
      {"cpu_s", cpu_seconds(usage)},
      {"peak_rss_mb", static_cast<double>(usage.ru_maxrss) / 1024.0},  // Linux counts kibibytes
      {"samples", s.samples},
      {"msamples_per_s", s.render_s > 0.0 ? static_cast<double>(s.samples) / s.render_s * 1e-6 : 0.0},
      {"rays", {{"camera", s.camera_rays}, {"bounce", s.bounce_rays}, {"shadow", s.shadow_rays}}},
      {"non_finite_samples", s.non_finite_samples},
      {"triangles", s.triangles},
      {"instances", s.instances},
      {"interrupted", s.interrupted},
      {"warnings", nlohmann::ordered_json::array()}};
  for (const Diagnostic& warning : diagnostics.warnings()) json["warnings"].push_back(warning.text());
  // File names are bytes, JSON is UTF-8: what is not becomes a replacement character.
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

Film trace(const RenderOptions& o, const Job& job, ProgressLine& progress, path::Statistics& statistics) {
  PartialWriter partial(o, job, progress);
  double samples_per_pixel = 0.0;
  const Interrupt interrupt;
  path::Callbacks callbacks;
  callbacks.progress = [&](const path::Progress& p) {
    samples_per_pixel = p.mean_samples;
    progress.update(p);
  };
  callbacks.partial = [&](Film film) { partial(std::move(film), samples_per_pixel); };
  callbacks.stop = &Interrupt::requested();
  Film film = render(job.scene, job.environment, job.view, o.settings, &statistics, callbacks);
  if (statistics.samples == 0) throw Error("interrupted before the first sample: no picture", o.scene);
  return film;
}

std::string raster_stats_json(const RenderOptions& o, const raster::Statistics& s, const Times& times,
                              const Diagnostics& diagnostics) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  nlohmann::ordered_json json{{"version", version()},
                              {"engine", "raster"},
                              {"driver", s.driver},
                              {"scene", o.scene},
                              {"width", o.size.x},
                              {"height", o.size.y},
                              {"frames", s.frames},
                              {"msaa", o.msaa},
                              {"load_s", times.load_s},
                              {"open_s", s.open_s},
                              {"light_s", s.light_s},
                              {"light_is_cached", s.is_light_cached},
                              {"upload_s", s.upload_s},
                              {"compile_s", s.compile_s},
                              {"shadow_s", s.shadow_s},
                              {"frame_s", s.frame_s},
                              {"write_s", times.write_s},
                              {"total_s", times.total_s},
                              {"cpu_s", cpu_seconds(usage)},
                              {"peak_rss_mb", static_cast<double>(usage.ru_maxrss) / 1024.0},
                              {"programs", s.programs},
                              {"draws", s.draws},
                              {"triangles", s.triangles},
                              {"non_finite_pixels", s.non_finite_pixels},
                              {"warnings", nlohmann::ordered_json::array()}};
  for (const Diagnostic& warning : diagnostics.warnings()) json["warnings"].push_back(warning.text());
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void write_stats(const RenderOptions& o, const std::string& json) {
  if (!o.stats) return;
  if (*o.stats == "-")
    print(json);
  else
    write_file(*o.stats, json);
}

/// One picture by the rasterizer, from what is loaded to what is written.
void draw(const RenderOptions& o, const Job& job, Times& times, const Stopwatch& total, Diagnostics& diagnostics,
          ProgressLine& progress) {
  progress.phase("drawing");
  raster::Statistics statistics;
  Film film = raster::render(job.scene, job.environment, job.view, raster_settings(o), diagnostics, &statistics);
  film.metadata.merge(metadata(o, job, statistics.frames));
  const Stopwatch writing;
  write_outputs({o.outputs.begin(), o.outputs.end()}, film, job.develop);
  times.write_s = writing.seconds();
  times.total_s = total.seconds();
  if (statistics.non_finite_pixels > 0) {
    diagnostics.warn(fmt::format("{} pixels were not finite and are black", statistics.non_finite_pixels), o.scene);
  }
  for (const std::string& output : o.outputs) {
    progress.line(fmt::format("{}: {}x{}, {} {} in {}, {} each, on {}", output, o.size.x, o.size.y, statistics.frames,
                              statistics.frames == 1 ? "frame" : "frames", duration_text(times.total_s),
                              duration_text(statistics.frame_s / statistics.frames), statistics.driver));
  }
  write_stats(o, raster_stats_json(o, statistics, times, diagnostics));
}

void run_render(const RenderOptions& o) {
  const Stopwatch total;
  ProgressLine progress(o.quiet);
  check_paths(o);
  check_memory(o);
  const ThreadLimit threads(o.threads);

  progress.phase("loading " + o.scene);
  Diagnostics diagnostics;
  const Job job = prepare(o, diagnostics);
  Times times{.load_s = total.seconds()};
  report_warnings(o, diagnostics, 0, progress);
  const std::size_t reported = diagnostics.warnings().size();

  if (o.engine == Engine::raster) {
    draw(o, job, times, total, diagnostics, progress);
    report_warnings(o, diagnostics, reported, progress);
    return;
  }
  progress.phase("building");
  path::Statistics statistics;
  Film film = trace(o, job, progress, statistics);
  film.metadata.merge(metadata(o, job, statistics.mean_samples_per_pixel));

  const Stopwatch writing;
  write_outputs({o.outputs.begin(), o.outputs.end()}, film, job.develop);
  times.write_s = writing.seconds();
  times.total_s = total.seconds();

  if (statistics.non_finite_samples > 0) {
    diagnostics.warn(fmt::format("{} samples were not finite and are left out", statistics.non_finite_samples),
                     o.scene);
  }
  for (const std::string& output : o.outputs) {
    progress.line(fmt::format("{}{}: {}x{}, {:.4g} samples per pixel in {}, {:.2f} Msamples/s",
                              statistics.interrupted ? "interrupted, " : "", output, film.width(), film.height(),
                              statistics.mean_samples_per_pixel, duration_text(times.total_s),
                              static_cast<double>(statistics.samples) / std::max(statistics.render_s, 1e-9) * 1e-6));
  }
  if (o.stats) write_stats(o, stats_json(o, statistics, times, threads.threads(), diagnostics));
  report_warnings(o, diagnostics, reported, progress);
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
