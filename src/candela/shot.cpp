#include "candela/shot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/stopwatch.h"
#include "path/statistics.h"

namespace candela {

namespace {

std::string vec3_text(vec3 v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }

float aspect_of(const Shot& shot) { return static_cast<float>(shot.size.x) / static_cast<float>(shot.size.y); }

void set_falloff(const FalloffChoice& choice, Scene& scene) {
  for (Light& light : scene.lights) {
    light.falloff = choice.kind;
    if (choice.polynomial) light.polynomial = *choice.polynomial;
  }
}

std::string prefix_of(std::size_t index, std::size_t count) {
  return count > 1 ? fmt::format("picture {} of {}, ", index + 1, count) : "";
}

/// How much of the progress of a picture that is denoised is that of its samples.
constexpr double kShareOfSamples = 0.97;

}  // namespace

Quality parse_quality(std::string_view name) {
  std::string known;
  for (const QualityInfo& info : kQualities) {
    if (info.name == name) return info.quality;
    known += (known.empty() ? "" : ", ") + std::string(info.name);
  }
  throw Error("unknown quality \"" + std::string(name) + "\" (known: " + known + ")");
}

void set_quality(Quality quality, Shot& shot) {
  for (const QualityInfo& info : kQualities) {
    if (info.quality != quality) continue;
    shot.traced.samples = info.samples;
    shot.traced.noise = info.noise > 0.0f ? std::optional(info.noise) : std::nullopt;
    shot.denoiser = denoise::Method::regression;
    shot.drawn.frames = info.frames;
  }
}

Studio parse_studio(std::string_view name) {
  std::string known;
  for (const StudioInfo& info : kStudios) {
    if (info.name == name) return info.studio;
    known += (known.empty() ? "" : ", ") + std::string(info.name);
  }
  throw Error("unknown studio \"" + std::string(name) + "\" (known: " + known + ")");
}

void set_studio(Studio studio, Shot& shot) {
  for (const StudioInfo& info : kStudios) {
    if (info.studio != studio) continue;
    shot.environment = info.environment;
    shot.ground = GroundChoice{.color = info.paper, .mirror = info.mirror};
  }
}

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

namespace {

/// An engine's settings with what a shot says of the picture, which both engines know.
template <class Settings>
Settings with_picture(Settings settings, const Shot& shot) {
  settings.width = shot.size.x;
  settings.height = shot.size.y;
  settings.background = shot.background;
  settings.environment_in_glass = shot.environment_in_glass;
  settings.layers = shot.layers;
  return settings;
}

}  // namespace

path::Settings traced_settings(const Shot& shot) {
  path::Settings settings = with_picture(shot.traced, shot);
  settings.has_features |= shot.denoiser.has_value();
  if (shot.exposure) settings.develop.exposure = *shot.exposure;
  settings.develop.tone_curve = shot.tone_curve;
  return settings;
}
raster::Settings drawn_settings(const Shot& shot) { return with_picture(shot.drawn, shot); }

namespace {

/// Throws Error where this build is without the engine, before any file is read.
Shot takeable(Shot shot) {
  if (shot.engine == Engine::raster) raster::check_built();
  if (shot.engine == Engine::path || shot.probes > 0) path::check_built();
  shot.load.counts_texture_levels |= shot.engine == Engine::raster;
  if (shot.ground && shot.ground->color && shot.background == Background::environment) {
    shot.background = Background::transparent;
    shot.background_color = shot.ground->color;
  }
  return shot;
}

}  // namespace

std::uint64_t picture_bytes(const Shot& shot) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(shot.size.x) * static_cast<std::uint64_t>(shot.size.y);
  return shot.engine == Engine::raster
             ? raster::picture_bytes(drawn_settings(shot))
             : path::picture_bytes(traced_settings(shot)) + (shot.denoiser ? denoise::bytes_per_pixel() * pixels : 0);
}

const Environment& Stage::environment(const std::string& name, Diagnostics* diagnostics) {
  auto found = environments_.find(name);
  if (found == environments_.end()) {
    Loaded loaded;
    loaded.environment = make_environment(name, &loaded.diagnostics);
    found = environments_.emplace(name, std::move(loaded)).first;
  }
  if (diagnostics != nullptr) {
    for (const Diagnostic& warning : found->second.diagnostics.warnings()) {
      diagnostics->warn(warning.message, warning.where);
    }
  }
  return found->second.environment;
}

std::shared_ptr<raster::Device> Stage::device() {
  if (device_ == nullptr) device_ = std::make_shared<raster::Device>();
  return device_;
}

Take::Take(Shot shot, Diagnostics* diagnostics, std::shared_ptr<Stage> stage)
    : shot_(takeable(std::move(shot))),
      diagnostics_(diagnostics),
      stage_(stage != nullptr ? std::move(stage) : std::make_shared<Stage>()),
      asset_(shot_.scene, diagnostics, shot_.load) {}

void Take::warn(std::string message) const {
  if (diagnostics_ != nullptr) diagnostics_->warn(std::move(message), shot_.scene);
}

/// Whether something moves, and when each picture is taken.
void Take::choose_moments() {
  const bool is_asked = shot_.moment_s || shot_.animation || shot_.shutter_s > 0.0 || shot_.sequence;
  const bool is_animated = asset_.is_animated();
  if (shot_.sequence && !is_animated) throw Error("nothing in " + shot_.scene + " is animated", "--sequence");
  if (is_asked && !is_animated && !shot_.animation) warn("nothing in it is animated: shown as it stands");
  is_moving_ = is_asked && (is_animated || shot_.animation);
  const double first = shot_.moment_s.value_or(0.0);
  moments_s_.assign(static_cast<std::size_t>(shot_.turntable.value_or(1)), first);
  if (!shot_.sequence) return;
  const double length = std::max(asset_.duration_s(shot_.animation.value_or("")) - first, 0.0);
  moments_s_.resize(static_cast<std::size_t>(*shot_.sequence));
  for (std::size_t i = 0; i < moments_s_.size(); ++i) {
    moments_s_[i] = first + length * static_cast<double>(i) / static_cast<double>(moments_s_.size());
  }
}

/// Which camera of the scene is looked through where none is asked for, and a word on cameras and framings that show
/// nothing.
void Take::choose_camera() {
  const auto emptiness = find_emptiness(*scene_);
  const bool is_empty = emptiness && world_bounds(*scene_).empty();
  if (shot_.camera) {
    if (!is_empty && !sees_something(*scene_, scene_camera(*scene_, *shot_.camera, aspect_of(shot_)))) {
      warn(fmt::format("the camera {} sees nothing of the scene", *shot_.camera));
    }
  } else if (!shot_.eye && !shot_.orbit) {
    camera_node_ = default_camera(*scene_, aspect_of(shot_), diagnostics_);
  }
  const bool is_framed = !shot_.camera && !shot_.eye && !camera_node_;
  if (emptiness && (is_empty || is_framed)) warn(emptiness->message);
}

View Take::choose_view(const Scene& scene, std::string& description) const {
  const float aspect = aspect_of(shot_);
  const float yfov = shot_.yfov.value_or(PerspectiveCamera{}.yfov);
  if (shot_.eye) {
    const vec3 target = shot_.target.value_or(subject_bounds(scene).center());
    if (*shot_.eye == target) throw Error("the camera is where it looks at", "--eye");
    description = "eye " + vec3_text(*shot_.eye) + " target " + vec3_text(target);
    return look_at(*shot_.eye, target, yfov);
  }
  if (shot_.orbit) {
    const Orbit& orbit = *shot_.orbit;
    description = fmt::format("orbit {},{},{}", degrees(orbit.azimuth), degrees(orbit.elevation), orbit.distance_scale);
    return frame_box(subject_bounds(scene), aspect, yfov, orbit);
  }
  description = shot_.camera ? "camera " + *shot_.camera : "default";
  if (!shot_.camera && !camera_node_) return frame_box(subject_bounds(scene), aspect, yfov);
  View view = shot_.camera ? scene_camera(scene, *shot_.camera, aspect)
                           : scene_camera(scene, scene.nodes[*camera_node_], aspect);
  if (!shot_.yfov) return view;
  auto* perspective = std::get_if<PerspectiveCamera>(&view.projection);
  if (perspective == nullptr) throw Error("the scene's camera is orthographic and has no field of view", "--fov");
  perspective->yfov = *shot_.yfov;
  return view;
}

void Take::set_lens(const Scene& scene, View& view) const {
  const auto* perspective = std::get_if<PerspectiveCamera>(&view.projection);
  if (shot_.vignetting > 0.0f && perspective == nullptr) {
    throw Error("an orthographic camera has no lens", "--vignetting");
  }
  view.lens.vignetting = shot_.vignetting;
  if (shot_.f_number) {
    if (perspective == nullptr) throw Error("an orthographic camera has no lens", "--f-number");
    view.lens.radius = aperture_radius(*shot_.f_number, perspective->yfov);
  }
  const bool is_focused = shot_.focus_distance || shot_.focuses_on_target;
  if (view.lens.radius <= 0.0f) {
    if (shot_.blades > 0) throw Error("without an aperture has no effect: give --f-number", "--blades");
    if (is_focused) throw Error("without an aperture has no effect: give --f-number", "--focus-distance");
    return;
  }
  view.lens.blades = shot_.blades;
  if (!shot_.f_number && !is_focused) return;  // the scene's own camera, focused by its author
  if (shot_.focus_distance) {
    view.lens.focus_distance = *shot_.focus_distance;
    return;
  }
  const vec3 subject = shot_.target.value_or(subject_bounds(scene).center());
  const float distance = -transform_point(glm::inverse(view.world_from_camera), subject).z;
  if (!(distance > 0.0f)) throw Error("the subject is behind the camera: give --focus-distance", "--f-number");
  view.lens.focus_distance = distance;
}

Ground Take::ground_of(const Scene& scene) const {
  const GroundChoice& choice = *shot_.ground;
  Ground ground;
  // A little below, so that a floor of the scene's own hides it.
  const Box3 subject = subject_bounds(scene);
  ground.height = choice.height.value_or(subject.lower.y - 1e-4f * glm::length(subject.size()));
  ground.mirror = choice.mirror;
  const std::optional<vec3> color = choice.color ? choice.color : shot_.background_color;
  if (color) ground.color = glm::clamp(*color, 0.0f, 1.0f);
  return ground;
}

/// The scene at a moment of its animation, or at rest.
Scene Take::scene_at(double moment_s) {
  std::optional<Pose> pose;
  if (is_moving_) pose = Pose{shot_.animation.value_or(""), moment_s};
  Scene scene = asset_.scene(pose);
  if (shot_.falloff) set_falloff(*shot_.falloff, scene);
  if (shot_.ground && !ground_) ground_ = ground_of(scene);
  scene.ground = ground_;
  for (Camera& camera : scene.cameras) {
    if (shot_.ignores_planes) camera.near_plane = 0.0f, camera.far_plane = kInfinity;
  }
  return scene;
}

/// What does not move may be there from an earlier take.
std::shared_ptr<const Scene> Take::first_scene() {
  const auto make = [&] { return scene_at(moments_s_[0]); };
  if (is_moving_) return std::make_shared<const Scene>(make());
  std::string key = scene_key(asset_.files(), shot_.scene, shot_.load) + (shot_.ignores_planes ? "no planes " : "");
  if (shot_.falloff) {
    key += fmt::format("{} {}", static_cast<int>(shot_.falloff->kind),
                       vec3_text(shot_.falloff->polynomial.value_or(vec3(-1))));
  }
  return stage_->scenes().scene(key, make, diagnostics_);
}

path::Tracer Take::new_tracer(std::shared_ptr<const Scene> scene) {
  const shade::ShadingModel& m = shot_.shading;
  const std::string key = fmt::format("{} {} {} {} {} {} {} {} {} {} {}", shot_.environment.value_or(""),
                                      environment_.name, environment_.rotation, environment_.intensity, m.distribution,
                                      m.masking, m.fresnel, m.diffuse, m.blend, m.multiscatter, m.literal_layers);
  return stage_->scenes().tracer(scene, key, [&] { return path::Tracer(scene, environment_, shot_.shading); });
}

/// The view of picture `index` in a scene of another moment.
View Take::view_at(const Scene& scene, std::size_t index) const {
  if (!has_own_camera_) return views_[std::min(index, views_.size() - 1)];
  std::string description;
  View view = choose_view(scene, description);
  set_lens(scene, view);
  return view;
}

void Take::prepare() {
  if (is_prepared_) return;
  choose_moments();
  scene_ = first_scene();
  if (!is_moving_) asset_.release();
  const bool has_own_light = !shot_.environment && scene_->image_light.has_value();
  environment_ = has_own_light
                     ? scene_->image_light->environment
                     : stage_->environment(shot_.environment.value_or(default_environment(*scene_)), diagnostics_);
  const bool has_more_moments = moments_s_.size() > 1 || shot_.shutter_s > 0.0;
  if (has_own_light && is_moving_ && has_more_moments && asset_.moves_image_light(shot_.animation.value_or(""))) {
    warn("the image-based light moves, and stands as at the first moment");
  }
  environment_.rotation += shot_.environment_rotation;
  environment_.intensity *= shot_.environment_intensity;
  choose_camera();
  View view = choose_view(*scene_, camera_);
  set_lens(*scene_, view);
  has_own_camera_ = (shot_.camera || camera_node_) && is_moving_ && !shot_.turntable;
  views_ = all_around(view, shot_.target.value_or(subject_bounds(*scene_).center()), shot_.turntable.value_or(1));
  develop_ = default_develop(*scene_, environment_);
  if (shot_.exposure) develop_.exposure = *shot_.exposure;
  develop_.tone_curve = shot_.tone_curve;
  develop_.bloom = shot_.bloom;
  if (shot_.engine == Engine::raster && raster::shows_numbers(shot_.drawn.quantity)) {
    // Numbers, not light: shown as they are.
    develop_.exposure = 1.0f;
    develop_.tone_curve = ToneCurve::linear;
  }
  develop_.background = shot_.background_color;
  develop_.background_opacity = shot_.background_opacity;
  choose_denoiser();
  is_prepared_ = true;
}

/// What is built in stands in for a library that is not there.
void Take::choose_denoiser() {
  if (!shot_.denoiser || shot_.engine == Engine::raster) return;
  const std::string why = denoise::why_not(*shot_.denoiser);
  if (why.empty()) return;
  warn(why + "; the built-in regression denoises");
  shot_.denoiser = denoise::Method::regression;
}

std::map<std::string, std::string> Take::metadata(double samples_per_pixel, bool is_denoised) const {
  std::map<std::string, std::string> result{
      {"scene", shot_.scene},
      {"camera", camera_},
      {"environment", environment_.name},
      {"integrator", shot_.engine == Engine::raster ? "raster" : path::integrator_name(shot_.traced.integrator)},
      {"samples", fmt::format("{}", samples_per_pixel)},
      {"seed", fmt::format("{}", shot_.traced.seed)},
      {"version", fmt::format("candela {}", version())}};
  if (!shot_.load.scene.empty()) result["scene_of_file"] = shot_.load.scene;
  if (!shot_.load.variant.empty()) result["variant"] = shot_.load.variant;
  if (!shot_.shading_name.empty()) result["shading"] = shot_.shading_name;
  if (is_denoised) result["denoiser"] = denoise::method_name(*shot_.denoiser);
  return result;
}

/// Pictures of a set have one exposure, that of the first: else they would flicker.
void Take::hand_over(TakenPicture picture, TakeResult& result, const std::function<void(TakenPicture)>& take) {
  if (shot_.has_many_pictures() && !develop_.exposure) develop_.exposure = metered_exposure(picture.film);
  picture.develop = develop_;
  result.is_last_unfinished = result.interrupted = !picture.is_whole();
  ++result.done;
  take(std::move(picture));
}

/// Noise is judged where it will be seen.
path::Settings Take::settings_of_trace() const {
  path::Settings settings = traced_settings(shot_);
  settings.develop = develop_;
  return settings;
}

/// The mean of the moments while the shutter is open.
Film Take::trace_moving(std::size_t index, const Job& job, path::Statistics& statistics) {
  constexpr int kMostMoments = 32;
  path::Settings settings = settings_of_trace();
  const int count = std::min(kMostMoments, settings.samples);
  settings.samples = (settings.samples + count - 1) / count;
  if (settings.time_limit_s) *settings.time_limit_s /= count;
  if (settings.noise) *settings.noise *= std::sqrt(static_cast<float>(count));
  Film sum;
  int moments = 0;
  double samples_per_pixel = 0.0;
  const JobParts parts(job, static_cast<std::size_t>(count));
  tracer_.reset();
  for (int i = 0; i < count && !statistics.interrupted; ++i) {
    Scene scene = scene_at(moments_s_[index] + shot_.shutter_s * (i + 0.5) / count);
    const View view = view_at(scene, index);
    const path::Tracer tracer(std::move(scene), environment_, shot_.shading);
    path::Statistics one;
    const Film film = tracer.render(view, settings, parts.part(static_cast<std::size_t>(i)), &one);
    one.build_s = tracer.build_s();
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

Film Take::trace_one(std::size_t index, const Job& job, path::Statistics& statistics) {
  if (is_moving_ && shot_.shutter_s > 0.0) return trace_moving(index, job, statistics);
  const bool has_moved = index > 0 && shot_.sequence && is_moving_;
  if (has_moved) tracer_.reset();  // before there is another
  double build_s = 0.0;
  if (!tracer_) {
    tracer_.emplace(new_tracer(has_moved ? std::make_shared<const Scene>(scene_at(moments_s_[index])) : scene_));
    build_s = tracer_->build_s();
  }
  Film film = tracer_->render(view_at(tracer_->scene(), index), settings_of_trace(), job, &statistics);
  statistics.build_s = build_s;
  return film;
}

/// Stopped on the way, it is the picture as it was traced, which is not what was asked for.
void Take::take_noise_out(TakenPicture& picture, const Job& job) const {
  Job part = job;
  if (job.progress) {
    part.progress = [&](Progress p) {
      p.fraction = kShareOfSamples + (1.0 - kShareOfSamples) * p.fraction;
      p.samples_per_pixel = picture.traced.mean_samples_per_pixel;
      job.progress(p);
    };
  }
  const Stopwatch watch;
  picture.is_denoised = denoise::denoise(picture.film, *shot_.denoiser, part);
  picture.denoise_s = watch.seconds();
  if (picture.is_denoised) return;
  picture.traced.interrupted = true;
  warn("stopped while it was denoised: the picture has its noise");
}

TakeResult Take::trace(const std::function<void(TakenPicture)>& take, const Job& job) {
  TakeResult result{.asked = moments_s_.size()};
  const JobParts parts(job, result.asked);
  for (std::size_t index = 0; index < result.asked && !result.interrupted; ++index) {
    Job part = parts.part(index, prefix_of(index, result.asked));
    double samples_per_pixel = 0.0;
    part.progress = [&, tell = part.progress](const Progress& p) {
      samples_per_pixel = p.samples_per_pixel;
      if (!tell) return;
      Progress told = p;
      if (shot_.denoiser) told.fraction *= kShareOfSamples;
      tell(told);
    };
    if (job.partial) {
      part.partial = [&](Film film) {
        film.metadata.merge(metadata(samples_per_pixel, false));
        job.partial(std::move(film));
      };
    }
    TakenPicture picture{.index = index};
    picture.film = trace_one(index, part, picture.traced);
    if (picture.traced.samples == 0) throw Interrupted("before the first sample: no picture");
    if (shot_.denoiser) take_noise_out(picture, parts.part(index, prefix_of(index, result.asked)));
    result.denoise_s += picture.denoise_s;
    picture.film.metadata.merge(metadata(picture.traced.mean_samples_per_pixel, picture.is_denoised));
    add_work(picture.traced, result.traced);
    result.traced.mean_samples_per_pixel = picture.traced.mean_samples_per_pixel;
    hand_over(std::move(picture), result, take);
    result.interrupted |= result.done < result.asked && job.is_stopped();
  }
  result.traced.interrupted = result.interrupted;
  if (result.traced.non_finite_samples > 0) {
    warn(fmt::format("{} samples were not finite and are left out", result.traced.non_finite_samples));
  }
  return result;
}

Film Take::draw_one(std::size_t index, raster::Drawer& drawer, const Job& job, raster::Statistics& statistics) {
  const raster::Settings settings = drawn_settings(shot_);
  if (is_moving_ && shot_.shutter_s > 0.0) {
    const auto moment = [&](int frame) {
      const double share = (frame + 0.5) / settings.frames;
      const auto scene = std::make_shared<const Scene>(scene_at(moments_s_[index] + shot_.shutter_s * share));
      return raster::Moment{scene, view_at(*scene, index)};
    };
    return drawer.render(moment, settings, job, &statistics);
  }
  std::shared_ptr<const Scene> scene = scene_;
  if (index > 0 && shot_.sequence && is_moving_) {
    scene = std::make_shared<const Scene>(scene_at(moments_s_[index]));
    drawer.set_scene(scene);
  }
  return drawer.render(view_at(*scene, index), settings, job, &statistics);
}

TakeResult Take::draw(const std::function<void(TakenPicture)>& take, const Job& job) {
  constexpr int kProbeSamples = 64;
  TakeResult result{.asked = moments_s_.size()};
  raster::Drawer drawer(scene_, environment_, shot_.shading, stage_->device());
  if (shot_.probes > 0) {
    drawer.set_probes(bake_probes(path::Tracer(scene_, environment_), shot_.probes, kProbeSamples, job));
  }
  const JobParts parts(job, result.asked);
  for (std::size_t index = 0; index < result.asked && !result.interrupted; ++index) {
    Job part = parts.part(index, prefix_of(index, result.asked));
    part.diagnostics = diagnostics_;
    TakenPicture picture{.index = index};
    picture.film = draw_one(index, drawer, part, picture.drawn);
    picture.film.metadata.merge(metadata(picture.drawn.frames, false));
    add_work(picture.drawn, result.drawn);
    hand_over(std::move(picture), result, take);
    result.interrupted |= result.done < result.asked && job.is_stopped();
  }
  result.drawn.interrupted = result.interrupted;
  if (result.drawn.non_finite_pixels > 0) {
    warn(fmt::format("{} pixels were not finite and are black", result.drawn.non_finite_pixels));
  }
  return result;
}

TakeResult Take::render(const std::function<void(TakenPicture)>& take, const Job& job) {
  prepare();
  return shot_.engine == Engine::raster ? draw(take, job) : trace(take, job);
}

}  // namespace candela
