#include "candela/shot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/stopwatch.h"
#include "candela/objects.h"
#include "candela/taking.h"
#include "candela/viewpoint.h"
#include "path/statistics.h"
#include "scene/surface_layers.h"

namespace candela {

namespace {

float aspect_of(const Shot& shot) { return static_cast<float>(shot.size.x) / static_cast<float>(shot.size.y); }

std::string prefix_of(std::size_t index, std::size_t count) {
  return count > 1 ? fmt::format("picture {} of {}, ", index + 1, count) : "";
}

}  // namespace

struct Take::Viewpoints {
  std::vector<Viewpoint> all;
};

Take::Take(Shot shot, Diagnostics* diagnostics, std::shared_ptr<Stage> stage)
    : shot_(takeable(std::move(shot))),
      diagnostics_(diagnostics),
      stage_(stage != nullptr ? std::move(stage) : std::make_shared<Stage>()),
      asset_(shot_.scene, diagnostics, shot_.load) {
  plan();
}

Take::~Take() = default;

void Take::warn(std::string message) const {
  if (diagnostics_ != nullptr) diagnostics_->warn(std::move(message), shot_.scene);
}

std::vector<std::string> Take::chosen_variants() const {
  const std::vector<std::string>& known = asset_.info().variants;
  if (known.empty()) throw Error("the file has no variants", "--variants");
  if (shot_.variants->empty()) return known;
  for (const std::string& name : *shot_.variants) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    throw Error(fmt::format("there is no variant '{}'; the file has: {}", name, fmt::join(known, ", ")), "--variants");
  }
  return *shot_.variants;
}

/// All pictures of a variant and an animation.
void Take::plan_moments(const std::optional<std::string>& variant, const std::string& animation, PictureLabel label) {
  const double first = shot_.moment_s.value_or(0.0);
  const double length = shot_.sequence ? std::max(asset_.duration_s(animation) - first, 0.0) : 0.0;
  const int moments = shot_.sequence.value_or(1);
  const std::vector<ViewpointName> names = viewpoint_names(shot_);
  for (int moment = 0; moment < moments; ++moment) {
    std::size_t viewpoint = 0;
    for (const ViewpointName& name : names) {
      label.view = name.view;
      label.camera = name.camera;
      for (int turn = 0; turn < shot_.turntable.value_or(1); ++turn) {
        planned_.push_back(
            {variant, animation, first + length * moment / moments, length / moments, viewpoint++, label});
      }
    }
  }
}

/// What the pictures show, and when: whether something moves.
void Take::plan() {
  const bool is_named = shot_.animation || shot_.animations;
  const bool is_asked = shot_.moment_s || is_named || shot_.shutter_s > 0.0 || shot_.sequence;
  const bool is_animated = asset_.is_animated();
  if (shot_.sequence && !is_animated) throw Error("nothing in " + shot_.scene + " is animated", "--sequence");
  if (is_asked && !is_animated && !is_named) warn("nothing in it is animated: shown as it stands");
  is_moving_ = is_asked && (is_animated || is_named);
  std::vector<std::string> animations = {shot_.animation.value_or("")};
  if (shot_.animations) {
    animations = *shot_.animations;
    if (!is_animated) throw Error("the file has no animations", "--animations");
    for (std::size_t i = 0; animations.size() < asset_.info().animations.size() && shot_.animations->empty(); ++i) {
      const std::string& name = asset_.info().animations[i].name;
      animations.push_back(name.empty() ? std::to_string(i) : name);
    }
  }
  std::vector<std::optional<std::string>> variants = {std::nullopt};
  if (shot_.variants) {
    const std::vector<std::string> names = chosen_variants();
    variants.assign(names.begin(), names.end());
  }
  for (const std::optional<std::string>& variant : variants) {
    for (const std::string& animation : animations) {
      plan_moments(variant, animation,
                   {.variant = variant.value_or(""), .animation = shot_.animations ? animation : ""});
    }
  }
  if (shot_.pictures && shot_.pictures->last > planned_.size()) {
    throw Error(fmt::format("of {} there {} {} {}", shot_.scene, planned_.size() == 1 ? "is" : "are", planned_.size(),
                            planned_.size() == 1 ? "picture" : "pictures"),
                "--pictures");
  }
}

std::vector<PictureLabel> Take::labels() const {
  std::vector<PictureLabel> labels;
  labels.reserve(planned_.size());
  for (const Planned& planned : planned_) labels.push_back(planned.label);
  return labels;
}

/// Which camera of the scene is looked through where none is asked for, and a word on cameras and framings that show
/// nothing.
void Take::choose_camera() {
  const auto emptiness = find_emptiness(*scene_, std::min(shot_.size.x, shot_.size.y));
  const bool is_empty = emptiness && world_bounds(*scene_).empty();
  if (shot_.camera) {
    if (!is_empty && !sees_something(*scene_, scene_camera(*scene_, *shot_.camera, aspect_of(shot_)))) {
      warn(fmt::format("the camera {} sees nothing of the scene", *shot_.camera));
    }
  } else if (!shot_.eye && !frames_subject(shot_, std::size_t{0}) && shot_.cameras.empty()) {
    camera_node_ = default_camera(*scene_, aspect_of(shot_), diagnostics_);
  }
  if (emptiness && (is_empty || frames_subject(shot_, camera_node_))) warn(emptiness->message);
}

/// What all pictures show, so that what moves stays in them: at most so many moments are looked at.
Extent Take::extent_of_all(const Scene& first) {
  constexpr std::size_t kMostMoments = 32;
  constexpr int kDirections = 2000;
  std::vector<const Planned*> moments;
  for (const Planned& planned : planned_) {
    const auto is_same = [&](const Planned* other) {
      return other->animation == planned.animation && other->moment_s == planned.moment_s;
    };
    if (moments.empty() || !is_same(moments.back())) moments.push_back(&planned);
    if (planned.variant != planned_[0].variant) break;
  }
  if (!is_moving_ || moments.size() == 1 || !frames_subject(shot_, camera_node_)) return Extent(first);
  const std::size_t step = (moments.size() + kMostMoments - 1) / kMostMoments;
  std::vector<vec3> points = Extent(first).outline(kDirections);
  for (std::size_t i = step; i < moments.size(); i += step) {
    const Scene scene = scene_at(*moments[i], moments[i]->moment_s);
    const std::vector<vec3> more = Extent(scene).outline(kDirections);
    points.insert(points.end(), more.begin(), more.end());
  }
  return Extent(points);
}

/// The scene at a moment of its animation, or at rest.
Scene Take::scene_at(const Planned& planned, double moment_s) {
  std::optional<Pose> pose;
  if (is_moving_) pose = Pose{planned.animation, moment_s};
  Scene scene = asset_.scene(pose, planned.variant);
  if (shot_.falloff) set_falloff(*shot_.falloff, scene);
  if (shot_.ground && !ground_) ground_ = ground_of(shot_, scene);
  scene.ground = ground_;
  for (Camera& camera : scene.cameras) {
    if (shot_.ignores_planes) camera.near_plane = 0.0f, camera.far_plane = kInfinity;
  }
  return scene;
}

namespace {

std::string text_of(vec3 v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }

}  // namespace

/// What does not move may be there from an earlier take.
std::shared_ptr<const Scene> Take::first_scene() {
  const Planned& planned = planned_[0];
  const auto make = [&] { return scene_at(planned, planned.moment_s); };
  if (is_moving_ || shot_.variants) return std::make_shared<const Scene>(make());
  std::string key = scene_key(asset_.files(), shot_.scene, shot_.load) + (shot_.ignores_planes ? "no planes " : "");
  if (shot_.falloff) {
    key += fmt::format("{} {}", static_cast<int>(shot_.falloff->kind),
                       text_of(shot_.falloff->polynomial.value_or(vec3(-1))));
  }
  if (shot_.ground) {
    const GroundChoice& ground = *shot_.ground;
    const std::optional<vec3> color = ground.color ? ground.color : shot_.background_color;
    key += fmt::format("ground {} {} {}", color ? text_of(*color) : "", ground.mirror,
                       ground.height ? fmt::format("{}", *ground.height) : "");
    if (ground_) key += fmt::format(" at {}", ground_->height);
  }
  return stage_->scenes().scene(key, make, diagnostics_);
}

/// Other takes on the stage may have it, but for light that is in a scene.
const path::FarLight& Take::far_light() {
  if (far_light_ != nullptr) return *far_light_;
  const std::string key = fmt::format("{} {} {}", environment_.name, environment_.rotation, environment_.intensity);
  const Stopwatch watch;
  far_light_ =
      has_own_light_ ? std::make_shared<const path::FarLight>(environment_) : stage_->far_light(key, environment_);
  light_s_ = watch.seconds();
  return *far_light_;
}

path::Tracer Take::new_tracer(std::shared_ptr<const Scene> scene) {
  const std::string key = fmt::format("{} {} {} {} {}", shot_.environment.value_or(""), environment_.name,
                                      environment_.rotation, environment_.intensity, shading_key(shot_.shading));
  return stage_->scenes().tracer(scene, key, [&] { return path::Tracer(scene, far_light(), shot_.shading); });
}

std::shared_ptr<const Scene> Take::scene_of(std::size_t index) {
  const Planned& planned = planned_[index];
  if (planned.has_same_scene(planned_[0])) return scene_;
  return std::make_shared<const Scene>(scene_at(planned, planned.moment_s));
}

/// The view of picture `index` in a scene of another moment.
View Take::view_at(const Scene& scene, std::size_t index) const {
  if (!has_own_camera_) return viewpoints_->all[planned_[index].viewpoint].view;
  return choose_viewpoints(shot_, {scene, Extent(scene), camera_node_})[0].view;
}

std::optional<double> Take::real_time_rate(std::size_t index) const {
  const double step_s = planned_[index].step_s;
  return step_s > 0.0 ? std::optional(1.0 / step_s) : std::nullopt;
}

std::vector<View> Take::views() const {
  std::vector<View> views;
  views.reserve(planned_.size());
  for (const Planned& planned : planned_) views.push_back(viewpoints_->all[planned.viewpoint].view);
  return views;
}

void Take::load_scene() {
  if (scene_ != nullptr) return;
  scene_ = first_scene();
  if (!is_moving_ && !shot_.variants) asset_.release();
}

/// `wished`: where neither shot nor scene has one.
void Take::choose_light(const std::string& wished) {
  has_own_light_ = !shot_.environment && scene_->image_light.has_value();
  environment_ = has_own_light_ ? scene_->image_light->environment
                                : stage_->environment(shot_.environment.value_or(wished), diagnostics_);
  const bool has_more_moments = shot_.sequence.value_or(1) > 1 || shot_.shutter_s > 0.0;
  if (has_own_light_ && is_moving_ && has_more_moments && asset_.moves_image_light(planned_[0].animation)) {
    warn("the image-based light moves, and stands as at the first moment");
  }
  environment_.rotation += shot_.environment_rotation;
  environment_.intensity *= shot_.environment_intensity;
}

void Take::choose_views(const Extent& extent) {
  viewpoints_ = std::make_unique<Viewpoints>();
  viewpoints_->all = choose_viewpoints(shot_, {*scene_, extent, camera_node_});
  has_own_camera_ = (shot_.camera || camera_node_) && is_moving_ && !shot_.turntable;
}

void Take::prepare() {
  if (is_prepared_) return;
  load_scene();
  choose_light(default_environment(*scene_));
  choose_camera();
  choose_views(extent_of_all(*scene_));
  develop_ = develop_of(shot_, *scene_, environment_);
  choose_denoiser(shot_, [this](std::string message) { warn(std::move(message)); });
  const bool is_still = !step_of(0) && shot_.turntable.value_or(1) == 1;
  if (is_still && shot_.layers.contains(Layer::motion)) {
    warn("motion is 0: nothing moves from one picture to the next without --sequence, --shutter or --turntable");
  }
  is_prepared_ = true;
}

void Take::prepare_beside(Take& reference) {
  if (labels() != reference.labels()) {
    throw Error(fmt::format("has other pictures than {}: no two of them can be compared", reference.shot_.scene),
                shot_.scene);
  }
  reference.load_scene();
  if (shot_.ground) ground_ = reference.scene_->ground;
  load_scene();
  reference.choose_light(default_environment(*reference.scene_));
  choose_light(default_environment(*reference.scene_));
  reference.choose_camera();
  const auto emptiness = find_emptiness(*scene_, std::min(shot_.size.x, shot_.size.y));
  if (emptiness && frames_subject(shot_, reference.camera_node_)) warn(emptiness->message);
  Extent both = reference.extent_of_all(*reference.scene_);
  both.add(extent_of_all(*scene_));
  reference.choose_views(both);
  reference.has_own_camera_ = false;
  viewpoints_ = std::make_unique<Viewpoints>(*reference.viewpoints_);
  reference.develop_ = develop_of(reference.shot_, *reference.scene_, reference.environment_);
  develop_ = reference.develop_;
  for (Take* take : {&reference, this}) {
    choose_denoiser(take->shot_, [take](std::string message) { take->warn(std::move(message)); });
    take->is_prepared_ = true;
  }
}

std::map<std::string, std::string> Take::metadata(std::size_t index, double samples_per_pixel, bool is_denoised) const {
  const Planned& planned = planned_[index];
  std::map<std::string, std::string> result = picture_metadata(
      shot_, environment_, viewpoints_->all[planned.viewpoint].description, samples_per_pixel, is_denoised);
  if (!shot_.load.scene.empty()) result["scene_of_file"] = shot_.load.scene;
  const std::string variant = planned.variant.value_or(shot_.load.variant);
  if (!variant.empty()) result["variant"] = variant;
  if (shot_.animations) result["animation"] = planned.animation;
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
    const auto scene = std::make_shared<const Scene>(
        scene_at(planned_[index], planned_[index].moment_s + shot_.shutter_s * (i + 0.5) / count));
    if (i == 0) scene_shown_ = scene;
    const View view = view_at(*scene, index);
    const path::Tracer tracer(scene, far_light(), shot_.shading);
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
  statistics.build_s += std::exchange(light_s_, 0.0);
  // Of the mean; each moment had a target of its own.
  if (statistics.noise && moments > 0) statistics.noise->worst /= std::sqrt(static_cast<float>(moments));
  // Interrupted, it is the mean of the moments so far.
  Film mean;
  if (moments > 0) accumulate(sum, 1.0f / static_cast<float>(moments), mean);
  return mean;
}

/// Has the tracer of the scene of picture `index`. Returns how long it took to build.
double Take::make_traceable(std::size_t index) {
  if (tracer_ && is_shown(index)) return 0.0;
  tracer_.reset();  // before there is another
  scene_shown_ = scene_of(index);
  shown_ = index;
  tracer_.emplace(new_tracer(scene_shown_));
  return tracer_->build_s();
}

/// For the exposure of the first picture.
Shot Take::small_shot() const {
  constexpr int kLongSide = 256, kSamples = 16;
  Shot small = shot_;
  const int longer = std::max(shot_.size.x, shot_.size.y);
  if (longer > kLongSide) small.size = glm::max(shot_.size * kLongSide / longer, ivec2(1));
  small.layers.clear();
  small.mattes.clear();
  small.has_masks = false;
  small.denoiser.reset();
  small.part.reset();
  small.traced.samples = std::min(shot_.traced.samples, kSamples);
  small.traced.noise.reset();
  small.traced.time_limit_s.reset();
  small.drawn.frames = 1;
  return small;
}

void Take::meter_traced(const Job& job) {
  make_traceable(0);
  const Job quiet{.stop = job.stop};
  develop_.exposure =
      metered_exposure(tracer_->render(view_at(tracer_->scene(), 0), traced_settings(small_shot()), quiet, nullptr));
}

Film Take::trace_one(std::size_t index, const Job& job, path::Statistics& statistics) {
  if (is_moving_ && shot_.shutter_s > 0.0) return trace_moving(index, job, statistics);
  const double build_s = make_traceable(index);
  Film film = shot_.part || checkpoint_
                  ? trace_kept(index, job, statistics)
                  : tracer_->render(view_at(tracer_->scene(), index), settings_of_trace(), job, &statistics);
  statistics.build_s = build_s + std::exchange(light_s_, 0.0);
  return film;
}

/// How long after a picture the next one is, or its own exposure ends; none where nothing moves from one to the next.
std::optional<double> Take::step_of(std::size_t index) const {
  if (!is_moving_) return std::nullopt;
  if (shot_.sequence.value_or(1) > 1) return planned_[index].step_s;
  return shot_.shutter_s > 0.0 ? std::optional(shot_.shutter_s) : std::nullopt;
}

/// Of a turntable that of the next turn, after the last the first; else the picture's own.
std::size_t Take::next_viewpoint(std::size_t index) const {
  const auto turns = static_cast<std::size_t>(shot_.turntable.value_or(1));
  const std::size_t viewpoint = planned_[index].viewpoint, first = viewpoint / turns * turns;
  return first + (viewpoint - first + 1) % turns;
}

Image Take::motion_of(const TakenPicture& picture) {
  const SurfaceMap& map = *picture.film.surfaces;
  const std::size_t index = picture.index;
  if (const std::optional<double> step = step_of(index)) {
    // A sequence's exposure begins with its moment; the map is of the middle of the first part of it.
    const Scene next = scene_at(planned_[index], planned_[index].moment_s + *step);
    return motion_layer(*picture.scene, picture.view, map, next, view_at(next, index));
  }
  const View& next = viewpoints_->all[next_viewpoint(index)].view;
  const bool is_still = next_viewpoint(index) == planned_[index].viewpoint;
  return motion_layer(*picture.scene, picture.view, map, *picture.scene, is_still ? picture.view : next);
}

/// What the engine does not know.
void Take::complete(TakenPicture& picture) {
  picture.scene = scene_shown_;
  picture.view = view_at(*scene_shown_, picture.index);
  if (picture.film.surfaces) {
    picture.film.layers[Layer::motion] = motion_of(picture);
    picture.film.surfaces.reset();
  }
  const bool has_numbers =
      std::any_of(shot_.layers.begin(), shot_.layers.end(), [](Layer layer) { return layer_info(layer).is_number; });
  if (has_numbers) picture.film.metadata["objects"] = objects_json(*scene_shown_);
}

TakeResult Take::trace(const std::function<void(TakenPicture)>& take, const Job& job) {
  TakeResult result{.asked = end_index() - first_index()};
  if (meters_apart()) meter_traced(job);
  const JobParts parts(job, result.asked);
  for (std::size_t index = first_index(); index < end_index() && !result.interrupted; ++index) {
    Job part = parts.part(index - first_index(), prefix_of(index, planned_.size()));
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
        film.metadata.merge(metadata(index, samples_per_pixel, false));
        job.partial(std::move(film));
      };
    }
    TakenPicture picture{.index = index, .label = planned_[index].label};
    picture.film = trace_one(index, part, picture.traced);
    if (picture.traced.samples == 0) throw Interrupted("before the first sample: no picture");
    if (shot_.part && picture.traced.interrupted) throw Interrupted("the part is not whole, and was not written");
    if (shot_.denoiser && !shot_.part) {
      take_noise_out(*shot_.denoiser, picture, parts.part(index - first_index(), prefix_of(index, planned_.size())),
                     [this](std::string message) { warn(std::move(message)); });
    }
    result.denoise_s += picture.denoise_s;
    picture.film.metadata.merge(metadata(index, picture.traced.mean_samples_per_pixel, picture.is_denoised));
    complete(picture);
    if (shot_.part) picture.part = part_of(picture);
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
      const auto scene =
          std::make_shared<const Scene>(scene_at(planned_[index], planned_[index].moment_s + shot_.shutter_s * share));
      if (frame == 0) scene_shown_ = scene;
      return raster::Moment{scene, view_at(*scene, index)};
    };
    return drawer.render(moment, settings, job, &statistics);
  }
  return drawer.render(view_at(*scene_shown_, index), settings, job, &statistics);
}

constexpr int kProbeSamples = 64;

/// The scene of picture `index`. Of another moment or variant the drawer is given it, which keeps what is the same; of
/// another variant with its probes.
void Take::make_drawable(std::size_t index, std::unique_ptr<raster::Drawer>& drawer, const Job& job) {
  if (drawer != nullptr && is_shown(index)) return;
  const std::optional<std::size_t> before = drawer != nullptr ? shown_ : std::nullopt;
  scene_shown_ = scene_of(index);
  shown_ = index;
  if (!before) {
    drawer = std::make_unique<raster::Drawer>(scene_shown_, environment_, shot_.shading, stage_->device());
  } else {
    drawer->set_scene(scene_shown_);
  }
  if (shot_.probes > 0 && (!before || planned_[index].variant != planned_[*before].variant)) {
    drawer->set_probes(bake_probes(path::Tracer(scene_shown_, far_light()), shot_.probes, kProbeSamples, job));
  }
}

void Take::meter_drawn(std::unique_ptr<raster::Drawer>& drawer, const Job& job) {
  make_drawable(0, drawer, job);
  const Job quiet{.stop = job.stop};
  develop_.exposure =
      metered_exposure(drawer->render(view_at(*scene_shown_, 0), drawn_settings(small_shot()), quiet, nullptr));
}

TakeResult Take::draw(const std::function<void(TakenPicture)>& take, const Job& job) {
  TakeResult result{.asked = end_index() - first_index()};
  std::unique_ptr<raster::Drawer> drawer;
  if (meters_apart()) meter_drawn(drawer, job);
  const JobParts parts(job, result.asked);
  for (std::size_t index = first_index(); index < end_index() && !result.interrupted; ++index) {
    Job part = parts.part(index - first_index(), prefix_of(index, planned_.size()));
    part.diagnostics = diagnostics_;
    TakenPicture picture{.index = index, .label = planned_[index].label};
    make_drawable(index, drawer, part);
    picture.film = draw_one(index, *drawer, part, picture.drawn);
    picture.film.metadata.merge(metadata(index, picture.drawn.frames, false));
    complete(picture);
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
