#include "raster/render.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <future>
#include <limits>
#include <map>

#include "base/browser.h"
#include "base/error.h"
#include "base/parallel.h"
#include "gl/gl.h"
#include "math/hash.h"
#include "raster/ground.h"
#include "raster/renderer.h"
#include "raster/targets.h"
#include "scene/environment.h"
#include "scene/surface_layers.h"
#include "shade/lens.glsl.h"
#include "shade/surface_params.glsl.h"

namespace candela::raster {

namespace {

/// Points of a lattice that fills the cube of four dimensions evenly however many there are: powers of the root of x⁵ =
/// x + 1. Roberts 2018, "The Unreasonable Effectiveness of Quasirandom Sequences".
vec4 lattice_point(int i) {
  constexpr std::array<double, 4> kSteps = {0.8566748838545029, 0.733891856627126, 0.6287067210378087,
                                            0.5385972572236101};
  vec4 point;
  for (int k = 0; k < 4; ++k) {
    point[k] = static_cast<float>(std::fmod(0.5 + kSteps[static_cast<std::size_t>(k)] * i, 1.0));
  }
  return point;
}

/// Of the first `count` points, in their first two dimensions: jitter about it does not move the picture.
vec2 middle_of_lattice(int count) {
  dvec2 sum(0.0);
  for (int i = 0; i < count; ++i) sum += dvec2(vec2(lattice_point(i)));
  return vec2(sum / static_cast<double>(count));
}

/// A point of every light for a frame of several: the same lattice of three dimensions, the root of x⁴ = x + 1.
LightPoint light_point(int i, int frames) {
  if (frames == 1) return LightPoint(0.5f);
  constexpr std::array<double, 3> kSteps = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
  LightPoint point;
  for (int k = 0; k < 3; ++k) {
    point[k] = static_cast<float>(std::fmod(0.25 + kSteps[static_cast<std::size_t>(k)] * (i + 1), 1.0));
  }
  return point;
}

/// cos⁴ of the angle to the axis, as far as the lens has it.
void apply_vignetting(const View& view, Image& image) {
  const auto* perspective = std::get_if<PerspectiveCamera>(&view.projection);
  if (view.lens.vignetting <= 0.0f || perspective == nullptr) return;
  const float half = std::tan(0.5f * perspective->yfov);
  const vec2 size(image.width, image.height);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const vec2 p = (2.0f * (vec2(x, y) + 0.5f) / size - 1.0f) * vec2(half * size.x / size.y, half);
      const float cos2 = 1.0f / (1.0f + glm::dot(p, p));
      const float weight = shade::lens_vignetting(cos2, view.lens.vignetting);
      for (int c = 0; c < 3; ++c) image.pixels[image.index(x, y) + static_cast<std::size_t>(c)] *= weight;
    }
  }
}

}  // namespace

void check_built() {}

std::uint64_t picture_bytes(const Settings& settings) {
  const auto pixels = static_cast<std::uint64_t>(settings.width) * static_cast<std::uint64_t>(settings.height);
  // Colour of half floats and depth per sample, two resolved pictures with mips, twelve depths where something is
  // blended, three copies in floats, the layers.
  const auto samples = static_cast<std::uint64_t>(settings.msaa);
  const std::uint64_t through =
      settings.background == Background::transparent && !settings.environment_in_glass ? samples * 8 + 8 + 48 : 0;
  return pixels * (samples * 12 + 24 + 48 + 48 + through + film_bytes_per_pixel(settings.layers) +
                   (has_centre_layer(settings.layers) || settings.has_masks ? sizeof(SurfaceSample) + 16 : 0) +
                   settings.mattes.size() * (sizeof(std::vector<Matte>) + 10 * sizeof(Matte)));
}

namespace {

/// Brings directions and lengths to where a picture can show them: directions from −1 … 1 to 0 … 1, positions and
/// depths over the scene's size, an object's number to a colour of its own.
/// Positions and `bounds` are relative to the same origin.
void scale_numbers(Quantity quantity, const Box3& bounds, Image& picture) {
  const vec3 size = glm::max(bounds.size(), vec3(std::numeric_limits<float>::min()));
  const auto shown = [&](vec3 v) {
    switch (quantity) {
      case Quantity::normal:
      case Quantity::geometric_normal:
      case Quantity::tangent:
        return 0.5f + 0.5f * v;
      case Quantity::position:
        return (v - bounds.lower) / size;
      case Quantity::depth:
      case Quantity::distance:
        return v / (2.0f * glm::length(size));
      case Quantity::object_id: {
        const std::uint32_t h = hash_combine(static_cast<std::uint32_t>(v.x), 1);
        return vec3(h & 255u, h >> 8 & 255u, h >> 16 & 255u) / 255.0f;
      }
      default:
        return v;
    }
  };
  for (std::size_t i = 0; i < picture.pixels.size(); i += 4) {
    float* p = picture.pixels.data() + i;
    if (p[3] <= 0.0f) continue;
    const vec3 v = shown({p[0], p[1], p[2]});
    p[0] = v.x, p[1] = v.y, p[2] = v.z;
  }
}

/// What shows through is what nothing covers, and `glass` of what is covered.
void add_open(Image glass, Film& film) {
  for (std::size_t i = 0; i < glass.pixels.size(); i += 4) {
    const float coverage = film.beauty.pixels[i + 3];
    for (std::size_t c = 0; c < 3; ++c) glass.pixels[i + c] += 1.0f - coverage;
    glass.pixels[i + 3] = coverage;
  }
  set_through(std::move(glass), film);
}

/// Puts what the eye sees of an environment behind a film.
void show_background(const FrameCamera& camera, const Environment& environment, Film& film) {
  Environment seen = environment;
  if (seen.backdrop) {
    seen.map = std::exchange(seen.backdrop, nullptr);
    seen.suns.clear();
  }
  const Image through = std::exchange(film.through, Image());
  const GroundSight sight(camera, {film.width(), film.height()}, 0.0f);
  parallel_for(0, static_cast<std::size_t>(film.height()), 8, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < film.width(); ++x) {
        const vec3 behind = environment_radiance(seen, sight.ray(x, y).direction) * through.rgb(x, y);
        film.beauty.set_rgb(x, y, film.beauty.rgb(x, y) + behind);
        film.beauty.at(x, y)[3] = 1.0f;
      }
    }
  });
}

void check(const Settings& s) {
  constexpr int kMostSize = 65536;
  if (s.width < 1 || s.height < 1 || s.width > kMostSize || s.height > kMostSize) {
    throw Error("picture size out of range");
  }
  if (s.frames < 1) throw Error("at least one frame is needed");
  if (s.msaa < 1) throw Error("at least one sample per pixel is needed");
  if (s.texture_anisotropy < 0) throw Error("the anisotropy of textures is negative");
  if (!(s.occlusion_radius >= 0.0f) || !std::isfinite(s.occlusion_radius)) {
    throw Error("the radius of occlusion is negative or not finite");
  }
  if (!(s.light_radius >= 0.0f) || !std::isfinite(s.light_radius)) {
    throw Error("the radius of lights is negative or not finite");
  }
  if (s.most_textures < 0) throw Error("the number of textures is negative");
  if (s.shown_light < 0) throw Error("the light that is shown does not exist");
}

void check(const View& view) {
  for (int c = 0; c < 4; ++c) {
    for (int row = 0; row < 4; ++row) {
      if (!std::isfinite(view.world_from_camera[c][row])) throw Error("the camera is out of range");
    }
  }
}

/// Adds `share` of a frame's numbers to those of a picture; those that are not finite are left out and counted.
void add_frame(const Image& frame, float share, Quantity quantity, Image& sum, std::uint64_t& non_finite) {
  for (std::size_t i = 0; i < frame.pixels.size(); i += 4) {
    const float* p = frame.pixels.data() + i;
    const bool is_good = std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]) && std::isfinite(p[3]);
    if (!is_good) ++non_finite;
    for (std::size_t c = 0; c < 4; ++c) sum.pixels[i + c] += is_good ? share * p[c] : 0.0f;
    if (quantity != Quantity::non_finite) continue;
    const vec4 judged = is_good ? vec4(vec3(0.05f * p[3]), p[3]) : vec4(1, 0, 1, 1);
    for (int c = 0; c < 4; ++c) sum.pixels[i + static_cast<std::size_t>(c)] = judged[c];
  }
}

void show_false_colors(Image& picture) {
  for (std::size_t i = 0; i < picture.pixels.size(); i += 4) {
    float* p = picture.pixels.data() + i;
    const vec3 color = false_color(luminance(vec3(p[0], p[1], p[2])));
    p[0] = color.x, p[1] = color.y, p[2] = color.z;
  }
}

}  // namespace

struct Device::Parts {
  std::unique_ptr<gl::Context> context;  ///< null: someone else's, who keeps it current
  double open_s = 0.0;                   ///< until it is told
  LightKey key;                          ///< of `light`
  BakedLight light;

  bool make_current() const { return context == nullptr || context->make_current(); }

  /// Bakes the light of an environment unless it is there.
  void bake(const Environment& environment, bool wants_sheen, const std::filesystem::path& cache) {
    const LightKey wanted = light_key(environment, wants_sheen);
    if (wanted == key) return;
    light = is_lit_from_far(environment) ? bake_light(environment, wants_sheen, cache) : BakedLight{};
    key = wanted;
  }
};

Device::Device() : parts_(std::make_unique<Parts>()) {
  const Stopwatch watch;
  parts_->context = gl::Context::open();
  parts_->open_s = watch.seconds();
}

Device::Device(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

Device::~Device() = default;

void Device::use() const {
  if (!parts_->make_current()) throw Error("a device of another thread cannot draw here");
}

std::shared_ptr<Device> Device::of_current_context() {
  return std::shared_ptr<Device>(new Device(std::make_unique<Parts>()));
}

class Drawer::Impl {
 public:
  Impl(std::shared_ptr<const Scene> scene, const Environment& environment, const shade::ShadingModel& shading,
       std::shared_ptr<Device> device)
      : scene_(std::move(scene)), environment_(environment), shading_(shading), device_(std::move(device)) {
    validate(*scene_);
    lit_by_ = scene_->ground ? environment_over_ground(environment, *scene_->ground) : environment;
    baked_rotation_ = lit_by_.rotation, baked_intensity_ = lit_by_.intensity;
    if (device_ == nullptr) device_ = std::make_shared<Device>();
  }
  ~Impl() {
    if (renderer_ == nullptr) return;
    // What the driver holds is given back to its own context.
    device().make_current();
    renderer_.reset();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void set_probes(std::vector<Probe> probes) {
    probes_ = std::move(probes);
    if (renderer_ == nullptr) return;
    use_device();
    renderer_->set_probes(probes_);
  }

  void set_scene(std::shared_ptr<const Scene> scene) {
    validate(*scene);
    if (renderer_ != nullptr) {
      use_device();
      renderer_->set_scene(*scene);
      if (renderer_->lacks_sheen_light()) {
        given_light_.reset();
        device().bake(as_baked(), true, settings_.cache);
        give_light();
      }
    }
    scene_ = std::move(scene);
    ground_share_.reset();
  }

  void set_environment(const Environment& environment, BakedLight light) {
    environment_ = environment;
    lit_by_ = scene_->ground ? environment_over_ground(environment, *scene_->ground) : environment;
    baked_rotation_ = lit_by_.rotation, baked_intensity_ = lit_by_.intensity;
    given_light_ = std::move(light);
    ground_share_.reset();
    if (renderer_ == nullptr) return;
    use_device();
    renderer_->set_environment(lit_by_);
    give_light();
  }
  void turn_environment(float rotation, float intensity) {
    if (rotation == lit_by_.rotation && intensity == lit_by_.intensity) return;
    for (Environment* turned : {&environment_, &lit_by_}) turned->rotation = rotation, turned->intensity = intensity;
    ground_share_.reset();
    if (renderer_ != nullptr) give_turn();
  }

  Film render(View view, const MomentOf& moment, const Settings& settings, const Job& job, Statistics& s);
  void draw_frame(const View& view, const Settings& settings, const Job& job, int bands);
  DisplayImage read_shown(float exposure, ToneCurve tone_curve) {
    use_frame();
    return renderer_->read_shown(exposure, tone_curve);
  }
  SurfaceMap read_surfaces(const View& view) {
    use_frame();
    renderer_->begin(view);
    return renderer_->read_surfaces(view);
  }
  void present(ivec2 size, float exposure, ToneCurve tone_curve) {
    use_frame();
    renderer_->present(size, exposure, tone_curve);
  }
  Film read_frame() {
    use_frame();
    Film film;
    film.beauty = renderer_->read();
    return film;
  }
  void reload_shaders() {
    if (renderer_ == nullptr) return;
    use_device();
    renderer_->programs().reload();
  }

 private:
  Device::Parts& device() { return *device_->parts_; }
  void use_device() { device_->use(); }
  void use_frame() {
    if (renderer_ == nullptr) throw Error("no frame was drawn");
    use_device();
  }
  void give_light() {
    const BakedLight& light = given_light_ ? *given_light_ : device().light;
    give_turn();
    renderer_->set_light(settings_.ambient == Ambient::baked ? light : simplified(light, settings_.ambient));
  }
  void give_turn() {
    const float factor = baked_intensity_ > 0.0f ? lit_by_.intensity / baked_intensity_ : 1.0f;
    renderer_->turn_light(lit_by_.rotation - baked_rotation_, factor);
  }
  /// As its light was baked, before it was turned.
  Environment as_baked() const {
    Environment baked = lit_by_;
    baked.rotation = baked_rotation_, baked.intensity = baked_intensity_;
    return baked;
  }
  bool is_prepared(const Settings& settings);
  /// Of a picture with all light: else the scene has no ground.
  bool shows_ground() const { return scene_->ground && is_whole(settings_.quantity); }
  void draw_mirrored(const View& view, vec2 jitter, vec2 lens, int frame, LightPoint point);
  void show_ground(const FrameCamera& camera, Image& picture, Image& through) const;
  void prepare(const View& view, const Settings& settings, Statistics& s, const std::atomic<bool>* stop = nullptr);
  void add_layers(const View& view, Film& film);
  int add_to_mattes(const View& view, int frame, std::map<MatteKind, MatteSums>& mattes);
  Film draw_frames(View view, const MomentOf& moment, const Job& job, Statistics& s);
  void tell_warnings(const Job& job);

  std::shared_ptr<const Scene> scene_;
  Environment environment_;
  Environment lit_by_;  ///< the same, with the ground below the horizon
  float baked_rotation_ = 0.0f, baked_intensity_ = 1.0f;
  std::optional<BakedLight> given_light_;  ///< in place of what the device bakes
  std::optional<GroundShare> ground_share_;
  Image mirrored_;  ///< what the ground mirrors in the frame at hand
  shade::ShadingModel shading_;
  std::shared_ptr<Device> device_;
  std::vector<Probe> probes_;
  Settings settings_;     ///< of `renderer_`
  Diagnostics warnings_;  ///< of all pictures
  std::size_t told_ = 0;  ///< of `warnings_`
  std::unique_ptr<Renderer> renderer_;
};

namespace {

/// What of the settings one renderer draws with as with another: sizes, and which part of the light under which
/// shadows.
void take_over_frame_settings(const Settings& from, Settings& to) {
  to.width = from.width, to.height = from.height, to.frames = from.frames;
  to.specular_antialiasing = from.specular_antialiasing;
  to.has_soft_shadows = from.has_soft_shadows, to.light_radius = from.light_radius, to.has_shadows = from.has_shadows;
  if (!is_of_surface(from.quantity) && !is_of_surface(to.quantity)) to.quantity = from.quantity;
  to.shown_light = from.shown_light;
  to.layers = from.layers, to.mattes = from.mattes, to.has_masks = from.has_masks;
}

}  // namespace

/// Whether what pictures of these settings need is there, or is after small changes.
bool Drawer::Impl::is_prepared(const Settings& settings) {
  if (renderer_ == nullptr) return false;
  // A ground and what shows through glass are parts of a whole picture alone.
  const bool shows_through = scene_->ground || settings.background != Background::environment;
  if (shows_through && settings.quantity != settings_.quantity) return false;
  Settings kept = settings_;
  take_over_frame_settings(settings, kept);
  if (settings != kept) return false;
  if (settings != settings_) renderer_->change(settings);
  settings_ = settings;
  return true;
}

/// Uploads and compiles what pictures of these settings need, unless it is there.
void Drawer::Impl::prepare(const View& view, const Settings& settings, Statistics& s, const std::atomic<bool>* stop) {
  Stopwatch watch;
  if (is_prepared(settings)) {
    renderer_->begin(view);
    glFinish();
    s.shadow_s = watch.lap();
    return;
  }
  // The light is baked while this thread, the driver's, uploads and compiles.
  std::future<void> baked = std::async(kIsBrowser ? std::launch::deferred : std::launch::async, [&] {
    if (given_light_) return;
    const StopScope scope(stop);
    const Stopwatch baking;
    device().bake(as_baked(), uses_sheen(*scene_), settings.cache);
    s.light_s = baking.seconds();
  });
  settings_ = settings;
  Settings used = settings;
  if (is_of_surface(used.quantity)) used.msaa = 1;  // numbers of two surfaces have no mean
  if (shows_ground()) {
    used.background = Background::transparent;
    used.environment_in_glass |= settings.background == Background::environment;
  }
  renderer_.reset();
  auto renderer = std::make_unique<Renderer>(*scene_, lit_by_, shading_, used, warnings_);
  glFinish();
  s.upload_s = watch.lap();
  renderer->begin(view);
  glFinish();
  s.shadow_s = watch.lap();
  renderer->warm_up(view);
  s.compile_s = watch.lap();
  baked.get();
  renderer_ = std::move(renderer);
  give_light();
  renderer_->set_probes(probes_);
}

/// The frame that the ground mirrors, into mirrored_.
void Drawer::Impl::draw_mirrored(const View& view, vec2 jitter, vec2 lens, int frame, LightPoint point) {
  const View mirrored = mirrored_view(view, scene_->ground->height);
  renderer_->begin(mirrored, point);
  renderer_->draw(mirrored, jitter * vec2(1, -1), lens * vec2(1, -1), frame);
  mirrored_ = renderer_->read();
  renderer_->begin(view, point);
}

/// Behind a frame, the ground: what it mirrors goes into the picture, and its shadows into what shows through.
void Drawer::Impl::show_ground(const FrameCamera& camera, Image& picture, Image& through) const {
  const Ground& ground = *scene_->ground;
  const GroundSight sight(camera, {picture.width, picture.height}, ground.height);
  if (through.empty()) through = Image(picture.width, picture.height, 4);
  parallel_for(0, static_cast<std::size_t>(picture.height), 8, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < picture.width; ++x) {
        const std::optional<vec2> at = sight.at(x, y);
        if (!at) continue;
        const auto pixel = picture.at(x, y);
        const auto behind = through.at(x, y);
        const float open = 1.0f - pixel[3];
        vec3 share = ground_share_->at(*at);
        if (ground.mirror > 0.0f) {
          const auto image = mirrored_.at(x, picture.height - 1 - y);
          for (std::size_t c = 0; c < 4; ++c) pixel[c] += open * ground.mirror * image[c];
          share *= 1.0f - ground.mirror * image[3];
        }
        // add_open() adds what the picture then leaves of 1.
        const float left = 1.0f - pixel[3];
        for (int c = 0; c < 3; ++c) {
          const auto i = static_cast<std::size_t>(c);
          behind[i] = behind[i] * share[c] + open * share[c] - left;
        }
      }
    }
  });
}

/// What is at the centres of pixels, and means as far as one sample is one.
void Drawer::Impl::add_layers(const View& view, Film& film) {
  check_numbers(*scene_, settings_.layers);
  for (const Layer layer : settings_.layers) {
    if (!layer_info(layer).has_mean) continue;
    film.layers[layer] = renderer_->read_layer(view, layer);
    if (layer == Layer::camera_normal) turn_to_camera(view, film.layers[layer]);
  }
  if (settings_.has_masks) film.masks = renderer_->read_masks(view);
  if (!has_centre_layer(settings_.layers)) return;
  SurfaceMap map = renderer_->read_surfaces(view);
  add_surface_layers(*scene_, view, map, settings_.layers, film);
  if (settings_.layers.contains(Layer::motion)) film.surfaces = std::move(map);
}

/// A frame's share of the mattes: as many places of each pixel as make enough over all frames. Returns how many.
int Drawer::Impl::add_to_mattes(const View& view, int frame, std::map<MatteKind, MatteSums>& mattes) {
  constexpr int kLeast = 16;
  const int count = (kLeast + settings_.frames - 1) / settings_.frames;
  const vec2 middle = middle_of_lattice(count * settings_.frames);
  for (int k = 0; k < count; ++k) {
    const vec4 u = lattice_point(frame * count + k);
    const vec2 lens = settings_.frames > 1 ? sample_aperture(view.lens, {u.z, u.w}) : vec2(0.0f);
    const SurfaceMap map = renderer_->read_surfaces(view, vec2(u) - middle, lens);
    for (std::size_t i = 0; i < map.pixels.size(); ++i) {
      const SurfaceSample& s = map.pixels[i];
      if (s.node < 0) continue;
      for (auto& [kind, sums] : mattes) {
        const int number = kind == MatteKind::object ? s.node : material_of(*scene_, s);
        sums.add(i, static_cast<std::uint32_t>(number), 1.0f);
      }
    }
  }
  return count;
}

/// The mean of a picture's frames, or of those that are drawn when it has to end.
Film Drawer::Impl::draw_frames(View view, const MomentOf& moment, const Job& job, Statistics& s) {
  const int frames = settings_.frames;
  const bool is_still = frames > 1;
  const float share = 1.0f / static_cast<float>(frames);
  const vec2 middle = middle_of_lattice(frames);
  const Stopwatch watch;
  double next_report_s = 0.0;
  Film film;
  film.beauty = Image(settings_.width, settings_.height, 4);
  std::map<MatteKind, MatteSums> mattes;
  for (const MatteKind kind : settings_.mattes) mattes.emplace(kind, MatteSums(settings_.width, settings_.height));
  int matte_samples = 0;
  Image through;
  for (int frame = 0; frame < frames && !s.interrupted; ++frame) {
    if (moment && frame > 0) {
      const Moment now = moment(frame);
      view = now.view;
      set_scene(now.scene);
    }
    const vec4 u = lattice_point(frame);
    const vec2 jitter = is_still ? vec2(u) - middle : vec2(0.0f);
    const vec2 lens = is_still ? sample_aperture(view.lens, {u.z, u.w}) : vec2(0.0f);
    if (moment || (is_still && renderer_->has_extended_lights())) renderer_->begin(view, light_point(frame, frames));
    if (frame == 0) add_layers(view, film);
    const Stopwatch drawing;
    if (shows_ground() && scene_->ground->mirror > 0.0f) {
      draw_mirrored(view, jitter, lens, frame + 1, is_still ? light_point(frame, frames) : LightPoint(0.5f));
    }
    renderer_->draw(view, jitter, lens, frame + 1);
    glFinish();
    s.draw_s += drawing.seconds();
    Image picture = renderer_->read();
    Image behind = renderer_->read_through();
    if (shows_ground()) {
      if (!ground_share_) {
        ground_share_ =
            draw_ground_share(*scene_, environment_, settings_.light_radius, renderer_->scene(), renderer_->programs());
      }
      show_ground(frame_camera(view, settings_.width, settings_.height, {}, jitter, lens), picture, behind);
    }
    if (through.empty()) through = Image(behind.width, behind.height, behind.channels);
    for (std::size_t i = 0; i < behind.pixels.size(); ++i) {
      if (std::isfinite(behind.pixels[i])) through.pixels[i] += share * behind.pixels[i];
    }
    add_frame(picture, share, settings_.quantity, film.beauty, s.non_finite_pixels);
    if (!mattes.empty()) matte_samples += add_to_mattes(view, frame, mattes);
    ++s.frames;
    constexpr double kReportEvery = 0.1;  // seconds
    if (job.progress && watch.seconds() >= next_report_s) {
      next_report_s = watch.seconds() + kReportEvery;
      job.progress({.fraction = static_cast<double>(s.frames) / frames,
                    .seconds = watch.seconds(),
                    .what = "frame " + std::to_string(s.frames) + " of " + std::to_string(frames)});
    }
    s.interrupted = s.frames < frames && job.is_stopped();
  }
  if (s.frames < frames && settings_.quantity != Quantity::non_finite) {
    const float rest = static_cast<float>(frames) / static_cast<float>(s.frames);
    for (Image* image : {&film.beauty, &through}) {
      for (float& v : image->pixels) v *= rest;
    }
  }
  if (!through.empty()) add_open(std::move(through), film);
  if (shows_ground() && settings_.background == Background::environment) {
    show_background(frame_camera(view, settings_.width, settings_.height, {}), environment_, film);
  }
  if (!is_of_surface(settings_.quantity)) apply_vignetting(view, film.beauty);
  scale_numbers(settings_.quantity, renderer_->scene().bounds(), film.beauty);
  if (settings_.quantity == Quantity::luminance) show_false_colors(film.beauty);
  for (const auto& [kind, sums] : mattes) {
    film.mattes[kind] = sums.mattes([&](std::size_t) { return 1.0f / static_cast<float>(matte_samples); });
    film.mattes[kind].names = matte_names(*scene_, kind);
  }
  return film;
}

/// What was not told before.
void Drawer::Impl::tell_warnings(const Job& job) {
  for (; job.diagnostics != nullptr && told_ < warnings_.warnings().size(); ++told_) {
    const Diagnostic& warning = warnings_.warnings()[told_];
    job.diagnostics->warn(warning.message, warning.where);
  }
}

Film Drawer::Impl::render(View view, const MomentOf& moment, const Settings& settings, const Job& job, Statistics& s) {
  check(settings);
  if (moment) {
    const Moment first = moment(0);
    view = first.view;
    set_scene(first.scene);
  }
  check(view);
  use_device();
  s = {};
  s.driver = gl::Context::renderer();
  s.open_s = std::exchange(device().open_s, 0.0);
  prepare(view, settings, s);
  const Stopwatch watch;
  Film film = draw_frames(view, moment, job, s);
  s.frame_s = watch.seconds();
  s.is_light_cached = device().light.is_cached;
  s.programs = static_cast<int>(renderer_->programs().count());
  s.triangles = renderer_->scene().triangle_count();
  s.draws = renderer_->scene().draws().size();
  tell_warnings(job);
  return film;
}

void Drawer::Impl::draw_frame(const View& view, const Settings& settings, const Job& job, int bands) {
  check(settings);
  check(view);
  use_device();
  if (is_prepared(settings)) {
    renderer_->begin(view);
  } else {
    Statistics ignored;
    prepare(view, settings, ignored, job.stop);
  }
  const StopScope scope(job.stop);
  renderer_->set_bands(bands);
  try {
    renderer_->draw(view);
    renderer_->set_bands(1);
  } catch (const Interrupted&) {
    renderer_->set_bands(1);
    Renderer::reset_state();
    throw;
  }
  tell_warnings(job);
}

Drawer::Drawer(std::shared_ptr<const Scene> scene, const Environment& environment, const shade::ShadingModel& shading,
               std::shared_ptr<Device> device)
    : impl_(std::make_unique<Impl>(std::move(scene), environment, shading, std::move(device))) {}

Drawer::Drawer(Scene scene, const Environment& environment, const shade::ShadingModel& shading,
               std::shared_ptr<Device> device)
    : Drawer(std::make_shared<const Scene>(std::move(scene)), environment, shading, std::move(device)) {}

Drawer::~Drawer() = default;

void Drawer::set_probes(std::vector<Probe> probes) { impl_->set_probes(std::move(probes)); }
void Drawer::set_scene(std::shared_ptr<const Scene> scene) { impl_->set_scene(std::move(scene)); }

Film Drawer::render(const View& view, const Settings& settings, const Job& job, Statistics* statistics) {
  Statistics ignored;
  return impl_->render(view, {}, settings, job, statistics != nullptr ? *statistics : ignored);
}

Film Drawer::render(const MomentOf& moment, const Settings& settings, const Job& job, Statistics* statistics) {
  Statistics ignored;
  return impl_->render({}, moment, settings, job, statistics != nullptr ? *statistics : ignored);
}

void Drawer::set_environment(const Environment& environment, BakedLight light) {
  impl_->set_environment(environment, std::move(light));
}
void Drawer::turn_environment(float rotation, float intensity) { impl_->turn_environment(rotation, intensity); }

void Drawer::draw_frame(const View& view, const Settings& settings, const Job& job, int bands) {
  impl_->draw_frame(view, settings, job, bands);
}
void Drawer::present(ivec2 size, float exposure, ToneCurve tone_curve) { impl_->present(size, exposure, tone_curve); }
DisplayImage Drawer::read_shown(float exposure, ToneCurve tone_curve) {
  return impl_->read_shown(exposure, tone_curve);
}
SurfaceMap Drawer::read_surfaces(const View& view) { return impl_->read_surfaces(view); }
Film Drawer::read_frame() { return impl_->read_frame(); }
void Drawer::reload_shaders() { impl_->reload_shaders(); }

BakedLight bake_light_of(const Scene& scene, const Environment& environment, const std::filesystem::path& cache) {
  const Environment lit = scene.ground ? environment_over_ground(environment, *scene.ground) : environment;
  return is_lit_from_far(lit) ? bake_light(lit, uses_sheen(scene), cache) : BakedLight{};
}

Film render(const Scene& scene, const Environment& environment, const View& view, const Settings& settings,
            const Job& job, Statistics* statistics) {
  return Drawer(borrowed(scene), environment).render(view, settings, job, statistics);
}

}  // namespace candela::raster
