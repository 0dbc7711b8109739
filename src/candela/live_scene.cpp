#include "candela/live_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <utility>

#include "base/parallel.h"
#include "base/stopwatch.h"
#include "candela/objects.h"
#include "candela/taking.h"
#include "candela/viewpoint.h"
#include "image/image_file.h"
#include "scene/surface_layers.h"

namespace candela {

namespace fs = std::filesystem;

namespace {

/// Differs where a file has changed; empty where there is none.
std::string state_of_file(const fs::path& path) {
  std::error_code code;
  const auto time = fs::last_write_time(path, code);
  if (code) return {};
  return fmt::format("{} {}", time.time_since_epoch().count(), fs::file_size(path, code));
}

/// A scene that no change touches while this is held.
std::shared_ptr<const Scene> held(std::shared_ptr<const Scene> scene, std::shared_ptr<const int> is_in_use) {
  using Both = std::pair<std::shared_ptr<const Scene>, std::shared_ptr<const int>>;
  const auto both = std::make_shared<Both>(std::move(scene), std::move(is_in_use));
  return {both, both->first.get()};
}

bool are_same(const std::optional<Ground>& a, const std::optional<Ground>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return a->height == b->height && a->color == b->color && a->mirror == b->mirror;
}

}  // namespace

std::shared_ptr<const Environment> LiveStage::environment(const std::string& name, Diagnostics* diagnostics) {
  constexpr std::size_t kMostKept = 8;
  const std::string state = is_built_in_environment(name) ? "built in" : state_of_file(parse_image_name(name).path);
  const std::lock_guard lock(mutex_);
  if (environments_.size() >= kMostKept && !environments_.contains(name)) environments_.clear();
  Loaded& loaded = environments_[name];
  if (loaded.environment == nullptr || loaded.state != state || state.empty()) {
    loaded = {.state = state, .environment = nullptr, .diagnostics = {}};
    loaded.environment = std::make_shared<const Environment>(make_environment(name, &loaded.diagnostics));
  }
  if (diagnostics != nullptr) {
    for (const Diagnostic& warning : loaded.diagnostics.warnings()) diagnostics->warn(warning.message, warning.where);
  }
  return loaded.environment;
}

DrawingThread& LiveStage::drawing() {
  const std::lock_guard lock(drawing_mutex_);
  if (drawing_ == nullptr) drawing_ = std::make_unique<DrawingThread>();
  return *drawing_;
}

/// What an engine was given. A scene is changed in place, or as a copy that another picture is begun of, so its counts
/// of changes tell one state from another.
struct LiveScene::Prepared {
  std::shared_ptr<const Scene> scene;
  std::uint64_t shapes = 0, materials = 0, lamps = 0;
  std::shared_ptr<const Environment> environment;
  float rotation = 0.0f, intensity = 1.0f;
  std::string shading;
  int probes = 0;

  bool has_same_environment(const Prepared& other) const {
    return environment == other.environment && rotation == other.rotation && intensity == other.intensity;
  }
  bool has_same_light(const Prepared& other) const { return has_same_environment(other) && shading == other.shading; }
  bool is_same(const Prepared& other) const {
    return has_same_light(other) && shapes == other.shapes && materials == other.materials && lamps == other.lamps &&
           probes == other.probes;
  }
};

/// What the engines keep between pictures.
struct LiveScene::Engines {
  explicit Engines(std::shared_ptr<LiveStage> of) : stage(std::move(of)) {}
  ~Engines() {
    // Its device is another thread's.
    if (drawer != nullptr) stage->drawing().post([gone = std::shared_ptr<raster::Drawer>(std::move(drawer))] {});
  }
  Engines(const Engines&) = delete;
  Engines& operator=(const Engines&) = delete;

  /// The tracer that is wanted: the last one, what of it still holds, or a new one.
  path::Tracer tracer_of(const Prepared& wanted, const Environment& lit, const shade::ShadingModel& shading,
                         const Job& job, double& build_s);
  /// The same, on the thread that draws.
  raster::Drawer& drawer_of(const Prepared& wanted, const Environment& lit, const shade::ShadingModel& shading,
                            const std::shared_ptr<raster::Device>& device, const Job& job);

  std::shared_ptr<LiveStage> stage;
  std::mutex mutex;  ///< of the tracer and its light
  std::unique_ptr<path::Tracer> tracer;
  std::shared_ptr<const path::FarLight> far_light;
  Prepared traced;

  // ----- of the thread that draws
  std::unique_ptr<raster::Drawer> drawer;
  Prepared drawn;
  std::size_t material_count = 0, profile_count = 0;
  std::optional<Ground> ground;
};

path::Tracer LiveScene::Engines::tracer_of(const Prepared& wanted, const Environment& lit,
                                           const shade::ShadingModel& shading, const Job& job, double& build_s) {
  const std::lock_guard lock(mutex);
  if (tracer != nullptr && traced.is_same(wanted)) return *tracer;
  const StopScope scope(job.stop);
  const Stopwatch watch;
  const bool keeps_shapes = tracer != nullptr && traced.shapes == wanted.shapes && traced.shading == wanted.shading;
  if (far_light == nullptr || !traced.has_same_environment(wanted)) {
    far_light.reset();  // before there is another
    far_light = std::make_shared<const path::FarLight>(lit);
  }
  const bool keeps_materials = traced.materials == wanted.materials;
  traced = {};  // until there is a tracer of all that is wanted
  if (keeps_shapes && keeps_materials) {
    tracer = std::make_unique<path::Tracer>(*tracer, wanted.scene, *far_light);
  } else if (!keeps_shapes || !tracer->take_materials(wanted.scene, *far_light, shading)) {
    tracer.reset();
    tracer = std::make_unique<path::Tracer>(wanted.scene, *far_light, shading);
  }
  traced = wanted;
  build_s = watch.seconds();
  return *tracer;
}

raster::Drawer& LiveScene::Engines::drawer_of(const Prepared& wanted, const Environment& lit,
                                              const shade::ShadingModel& shading,
                                              const std::shared_ptr<raster::Device>& device, const Job& job) {
  constexpr int kProbeSamples = 64;
  if (drawer != nullptr && drawn.is_same(wanted)) return *drawer;
  const Scene& scene = *wanted.scene;
  const bool is_kept = drawer != nullptr && drawn.has_same_light(wanted) && are_same(ground, scene.ground) &&
                       material_count == scene.materials.size() && profile_count == scene.ies_profiles.size();
  if (is_kept) {
    drawer->set_scene(wanted.scene);
  } else {
    drawer.reset();  // before there is another
    drawer = std::make_unique<raster::Drawer>(wanted.scene, lit, shading, device);
  }
  drawn = {};  // until its probes are there
  std::vector<raster::Probe> probes;
  if (wanted.probes > 0) {
    probes = bake_probes(path::Tracer(wanted.scene, lit), wanted.probes, kProbeSamples, job);
  }
  drawer->set_probes(std::move(probes));
  drawn = wanted;
  material_count = scene.materials.size();
  profile_count = scene.ies_profiles.size();
  ground = scene.ground;
  return *drawer;
}

LiveScene::LiveScene(Scene scene, std::shared_ptr<LiveStage> stage)
    : scene_(std::make_shared<Scene>(std::move(scene))),
      stage_(std::move(stage)),
      is_in_use_(std::make_shared<const int>(0)),
      engines_(std::make_shared<Engines>(stage_)) {
  for (Mesh& mesh : scene_->meshes) {
    if (mesh.identity == nullptr) mesh.identity = std::make_shared<const int>(0);
  }
}

LiveScene::~LiveScene() = default;

Scene& LiveScene::change(Change what) {
  // What a picture on another thread reads stays as it is.
  if (is_in_use_.use_count() > 1) {
    scene_ = std::make_shared<Scene>(*scene_);
    is_in_use_ = std::make_shared<const int>(0);
  }
  std::atomic_thread_fence(std::memory_order_acquire);  // the last one has read it
  if (what == Change::lamps) ++lamps_;
  if (what == Change::materials) ++materials_;
  if (what == Change::all) ++shapes_;
  return *scene_;
}

std::shared_ptr<const Scene> LiveScene::snapshot() const { return held(scene_, is_in_use_); }

Mesh& LiveScene::change_mesh(std::size_t mesh) {
  Mesh& changed = change(Change::all).meshes[mesh];
  changed.identity = std::make_shared<const int>(0);
  return changed;
}

/// Gives every mesh what its materials read of its vertices and it has not, as the readers of files do.
void LiveScene::complete() {
  if (completed_ == shapes_ + materials_) return;
  for (std::size_t m = 0; m < scene_->meshes.size(); ++m) {
    for (std::size_t p = 0; p < scene_->meshes[m].primitives.size(); ++p) {
      const Primitive& primitive = std::as_const(*scene_).meshes[m].primitives[p];
      if (is_complete(*scene_, primitive)) continue;
      const Material& material = scene_->materials[static_cast<std::size_t>(primitive.material)];
      complete_primitive(material, change_mesh(m).primitives[p]);
    }
  }
  completed_ = shapes_ + materials_;
}

LiveScene::Moment LiveScene::begin(Shot shot) {
  Moment moment;
  moment.shot_ = takeable(std::move(shot));
  const std::optional<Ground> ground =
      moment.shot_.ground ? std::optional(ground_of(moment.shot_, *scene_)) : std::nullopt;
  if (!are_same(ground, scene_->ground)) change(Change::all).ground = ground;
  complete();
  moment.scene_ = scene_;
  moment.is_in_use_ = is_in_use_;
  moment.shapes_ = shapes_;
  moment.materials_ = materials_;
  moment.lamps_ = lamps_;
  moment.stage_ = stage_;
  moment.engines_ = engines_;
  return moment;
}

std::shared_ptr<const Environment> LiveScene::Moment::environment(const std::shared_ptr<const Environment>& light,
                                                                  Diagnostics* diagnostics) const {
  if (light != nullptr) return light;
  if (shot_.environment) return stage_->environment(*shot_.environment, diagnostics);
  if (scene_->image_light) return {scene_, &scene_->image_light->environment};
  return stage_->environment(default_environment(*scene_), diagnostics);
}

/// As a Take chooses it.
void LiveScene::Moment::choose_view(Diagnostics* diagnostics, std::string& camera, View& view) const {
  const float aspect = static_cast<float>(shot_.size.x) / static_cast<float>(shot_.size.y);
  const auto warn = [&](const std::string& message) {
    if (diagnostics != nullptr) diagnostics->warn(message, scene_->name);
  };
  const auto emptiness = find_emptiness(*scene_, std::min(shot_.size.x, shot_.size.y));
  const bool is_empty = emptiness && world_bounds(*scene_).empty();
  std::optional<std::size_t> camera_node;
  if (shot_.camera) {
    if (!is_empty && !sees_something(*scene_, scene_camera(*scene_, *shot_.camera, aspect))) {
      warn("the camera " + *shot_.camera + " sees nothing of the scene");
    }
  } else if (!shot_.eye && !frames_subject(shot_, std::size_t{0}) && shot_.cameras.empty()) {
    camera_node = default_camera(*scene_, aspect, diagnostics);
  }
  if (emptiness && (is_empty || frames_subject(shot_, camera_node))) warn(emptiness->message);
  Viewpoint viewpoint = choose_viewpoints(shot_, {*scene_, Extent(*scene_), camera_node})[0];
  camera = std::move(viewpoint.description);
  view = viewpoint.view;
  if (shot_.ignores_planes) view.near_plane = 0.0f, view.far_plane = kInfinity;
}

TakenPicture LiveScene::Moment::trace(const View& view, const Prepared& wanted, const Environment& lit,
                                      const DevelopSettings& develop, const Job& job) const {
  path::Settings settings = traced_settings(shot_);
  settings.develop = develop;  // noise is judged where it will be seen
  TakenPicture picture;
  double build_s = 0.0;
  const path::Tracer tracer = engines_->tracer_of(wanted, lit, shot_.shading, job, build_s);
  Job part = job;
  if (job.progress && shot_.denoiser) {
    part.progress = [&](Progress p) {
      p.fraction *= kShareOfSamples;
      job.progress(p);
    };
  }
  picture.film = tracer.render(view, settings, part, &picture.traced);
  picture.traced.build_s = build_s;
  if (picture.traced.samples == 0) throw Interrupted("before the first sample: no picture");
  if (picture.traced.non_finite_samples > 0 && job.diagnostics != nullptr) {
    job.diagnostics->warn(fmt::format("{} samples were not finite and are left out", picture.traced.non_finite_samples),
                          scene_->name);
  }
  return picture;
}

TakenPicture LiveScene::Moment::draw(const View& view, const Prepared& wanted, const Environment& lit,
                                     const Job& job) const {
  TakenPicture picture;
  stage_->drawing().run([&](const std::shared_ptr<raster::Device>& device) {
    raster::Drawer& drawer = engines_->drawer_of(wanted, lit, shot_.shading, device, job);
    picture.film = drawer.render(view, drawn_settings(shot_), job, &picture.drawn);
  });
  if (picture.drawn.non_finite_pixels > 0 && job.diagnostics != nullptr) {
    job.diagnostics->warn(fmt::format("{} pixels were not finite and are black", picture.drawn.non_finite_pixels),
                          scene_->name);
  }
  return picture;
}

/// What the engines do not know.
void LiveScene::Moment::complete(LivePicture& picture, Diagnostics* diagnostics) const {
  Film& film = picture.taken.film;
  if (film.surfaces) {
    film.layers[Layer::motion] = motion_layer(*scene_, picture.view, *film.surfaces, *scene_, picture.view);
    film.surfaces.reset();
    if (diagnostics != nullptr) diagnostics->warn("motion is 0: a picture of a scene that stands still", scene_->name);
  }
  const bool has_numbers =
      std::any_of(shot_.layers.begin(), shot_.layers.end(), [](Layer layer) { return layer_info(layer).is_number; });
  if (has_numbers) film.metadata["objects"] = objects_json(*scene_);
}

LivePicture LiveScene::Moment::render(const std::shared_ptr<const Environment>& light, Diagnostics* diagnostics,
                                      const Job& job) const {
  const auto warn = [&](std::string message) {
    if (diagnostics != nullptr) diagnostics->warn(std::move(message), scene_->name);
  };
  const std::shared_ptr<const Environment> base = environment(light, diagnostics);
  Environment lit = *base;
  lit.rotation += shot_.environment_rotation;
  lit.intensity *= shot_.environment_intensity;
  LivePicture picture;
  std::string camera;
  choose_view(diagnostics, camera, picture.view);
  const DevelopSettings develop = develop_of(shot_, *scene_, lit);
  Shot shot = shot_;
  choose_denoiser(shot, warn);
  const bool is_traced = shot_.engine == Engine::path;
  const bool is_denoised = is_traced && shot.denoiser.has_value();
  const Prepared wanted{scene_,
                        shapes_,
                        materials_,
                        lamps_,
                        base,
                        shot_.environment_rotation,
                        shot_.environment_intensity,
                        shading_key(shot_.shading),
                        is_traced ? 0 : shot_.probes};
  Job told = job;
  told.diagnostics = diagnostics;
  picture.taken = is_traced ? trace(picture.view, wanted, lit, develop, told) : draw(picture.view, wanted, lit, told);
  if (is_denoised) take_noise_out(*shot.denoiser, picture.taken, job, warn);
  complete(picture, diagnostics);
  picture.taken.develop = develop;
  picture.taken.view = picture.view;
  if (shot_.has_masks) picture.taken.scene = held(scene_, is_in_use_);
  picture.taken_of = engines_;
  const double samples = is_traced ? picture.taken.traced.mean_samples_per_pixel : picture.taken.drawn.frames;
  shot.scene = scene_->name;
  picture.taken.film.metadata.merge(picture_metadata(shot, lit, camera, samples, picture.taken.is_denoised));
  return picture;
}

}  // namespace candela
