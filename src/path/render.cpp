#include "path/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "path/accumulator.h"
#include "path/camera.h"
#include "path/empty_pixels.h"
#include "path/integrator.h"
#include "path/pixel_filter.h"
#include "path/surface_map.h"
#include "path/tracer_parts.h"
#include "scene/surface_layers.h"

namespace candela::path {

namespace {

constexpr int kTile = 16;                                ///< pixels; a tile is the unit of parallel work
constexpr int kBlock = 4;                                ///< a packet is 4 × 4 pixels
constexpr std::uint32_t kPassSamples = kSamplesOfBlock;  ///< per pixel between two looks at the error

struct BlockCounts {
  RayCounts rays;
  std::uint64_t samples = 0;
  std::uint64_t spared = 0;  ///< that empty pixels did without
  std::uint64_t non_finite = 0;
};

struct Totals {
  std::atomic<std::uint64_t> samples{0}, spared{0}, camera{0}, bounce{0}, shadow{0}, non_finite{0};
};

View without_lens(View view) {
  view.lens.radius = 0.0f;
  return view;
}

bool shows_background_in_glass(const Scene& scene, const Settings& settings) {
  return settings.background == Background::transparent && !settings.environment_in_glass &&
         std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& m) { return m.transmission > 0.0f && !m.unlit; });
}

/// On a transparent background.
bool shows_shadows(const Scene& scene, const Settings& settings) {
  return settings.background == Background::transparent && scene.ground;
}

void check_settings(const Settings& s) {
  constexpr int kMaxSize = 65536;
  if (s.width < 1 || s.height < 1 || s.width > kMaxSize || s.height > kMaxSize)
    throw Error("picture size out of range");
  if (s.samples < 1) throw Error("at least one sample per pixel is needed");
  if (s.first_sample < 0 || s.first_sample >= s.samples || s.first_sample % kSamplesOfBlock != 0) {
    throw Error("the first sample's number is below the number of samples and a multiple of sixteen");
  }
  if (s.first_sample > 0 && s.noise) throw Error("a part of a picture has no noise target");
  if (s.bounces < 0) throw Error("the number of bounces is negative");
  if (s.has_features && s.integrator != Integrator::full) throw Error("features come from the full integrator alone");
  if (s.clamp && s.integrator != Integrator::full) throw Error("clamping is of the full integrator alone");
  if (s.clamp && !(*s.clamp > 0.0f)) throw Error("what indirect light is clamped to must be above 0");
  if (s.noise && !(*s.noise > 0.0f)) throw Error("the noise target must be above 0");
  if (s.time_limit_s && !(*s.time_limit_s > 0.0)) throw Error("the time limit must be above 0");
}

void check_view(const View& view) {
  constexpr float kFarthest = 1e15f;  // metres; Embree's arithmetic ends at 1.8e18
  for (int c = 0; c < 4; ++c) {
    for (int row = 0; row < 4; ++row) {
      if (!(std::abs(view.world_from_camera[c][row]) < kFarthest)) throw Error("the camera is out of range");
    }
  }
}

/// The function that follows a path.
decltype(&trace_path) path_of(Integrator integrator) {
  switch (integrator) {
    case Integrator::minimal:
      return trace_path_minimal;
    case Integrator::surfaces:
      return trace_path_surfaces;
    case Integrator::full:
      break;
  }
  return trace_path;
}

/// A sample that is not finite stays so, for others to count.
void clamp_indirect(float most, PathSample& sample) {
  const float largest = max_component(sample.indirect);
  if (!(largest > most) || !std::isfinite(largest)) return;
  sample.radiance = glm::max(sample.radiance - sample.indirect * (1.0f - most / largest), vec3(0.0f));
}

constexpr std::uint32_t kWhole = 255;  ///< all passes, where they are counted in shares

/// How many of the passes an empty pixel needs, in 1/kWhole, for an error of 1.6 %/√N after N samples, which surfaces
/// do not reach. Sixteen Sobol' points in a square miss the mean of a linear function by 0.41/16^1.5 of its range: each
/// coordinate is stratified to a sixteenth.
std::uint8_t share_of_passes(float contrast) {
  constexpr float kWanted = 0.016f;
  const float of_pass = 0.41f * contrast / static_cast<float>(kPassSamples) / kWanted;
  return static_cast<std::uint8_t>(std::ceil(std::clamp(kWhole * of_pass * of_pass, 1.0f, float(kWhole))));
}

std::uint64_t placed_triangles(const Geometry& geometry) {
  std::uint64_t sum = 0;
  for (const Placement& placement : geometry.placements()) sum += placement.mesh->triangles.size();
  return sum;
}

const Settings& checked(const Settings& settings) {
  check_settings(settings);
  return settings;
}

}  // namespace

/// Owns what the passes of a picture share.
class Picture::Impl {
 public:
  Impl(std::shared_ptr<const Tracer::Parts> traced, const View& view, const Settings& settings)
      : parts_(std::move(traced)),
        settings_(checked(settings)),
        geometry_(parts_->geometry),
        context_{geometry_,
                 parts_->lights,
                 settings.bounces,
                 settings.background,
                 shows_background_in_glass(*parts_->scene, settings),
                 settings.sees_lamps,
                 settings.sees_backdrop,
                 geometry_.has_media()},
        view_(view),
        camera_(relative(view, geometry_.origin()), settings.width, settings.height),
        pinhole_(without_lens(relative(view, geometry_.origin())), settings.width, settings.height),
        filter_(settings.filter, settings.filter_radius),
        accumulator_(settings, context_.background_in_glass || shows_shadows(*parts_->scene, settings)),
        converged_(static_cast<std::size_t>(settings.width) * static_cast<std::size_t>(settings.height), 0),
        tiles_x_((settings.width + kTile - 1) / kTile),
        tiles_y_((settings.height + kTile - 1) / kTile) {
    if (settings.integrator == Integrator::surfaces && geometry_.has_media())
      throw Error("the integrator of surfaces alone cannot enter the scene's bodies; minimal can", parts_->scene->name);
    if (settings.integrator == Integrator::surfaces && geometry_.ground() != nullptr)
      throw Error("the integrator of surfaces alone knows no ground; minimal does", parts_->scene->name);
    check_numbers(*parts_->scene, settings.layers);
    done_ = static_cast<std::uint32_t>(settings.first_sample);
    set_start();
  }

  void trace(std::uint32_t limit, const Job& job);
  Film film(bool has_features) const;
  Statistics statistics() const;
  const Accumulator& sums() const { return accumulator_; }
  bool has_through() const { return context_.background_in_glass || shows_shadows(*parts_->scene, settings_); }
  std::vector<std::byte> state() const;
  void set_state(std::span<const std::byte> bytes);

 private:
  /// Where the work stands, besides the sums.
  struct Place {
    std::uint32_t done, pass_end, next_tile, converged_count;
    std::uint64_t samples, spared, camera, bounce, shadow, non_finite;
    double render_s;
  };
  void render_tile(int tile, std::uint32_t first_sample, std::uint32_t last_sample);
  void render_block(ivec2 corner, std::uint32_t first_sample, std::uint32_t last_sample, BlockCounts& counts);
  bool takes_part(std::size_t pixel, std::uint32_t pass) const;
  void set_start();
  void find_empty();
  void find_converged();
  NoiseReached noise_reached() const;
  bool is_complete() const;
  std::uint32_t next_look() const;
  void run_pass(const Job& job);
  bool must_stop(const Job& job) const;
  void report(const Job& job);
  void add_centre_layers(Film& film) const;
  void add_mattes(ivec2 pixel, const Ray& ray, const Hit& first);
  std::size_t pixel_count() const { return converged_.size(); }
  double mean_samples() const {
    return static_cast<double>(totals_.samples.load() + totals_.spared.load()) / static_cast<double>(pixel_count());
  }

  std::shared_ptr<const Tracer::Parts> parts_;
  Settings settings_;
  const Geometry& geometry_;
  PathContext context_;
  View view_;
  Camera camera_;
  Camera pinhole_;  ///< through the middle of the lens: a polygon's numbers (½, ½) are not its middle
  PixelFilterSampler filter_;
  Accumulator accumulator_;
  std::vector<std::uint8_t> converged_;
  std::size_t converged_count_ = 0;
  bool has_looked_for_empty_ = false;
  std::vector<std::uint8_t> empty_shares_;  ///< of the passes, in 1/kWhole; 0 where surfaces may be, empty until known
  int tiles_x_;
  int tiles_y_;
  std::uint32_t done_ = 0;       ///< samples of every pixel that is not converged
  std::uint32_t pass_end_ = 0;   ///< the same after the pass at hand
  int next_tile_ = 0;            ///< of that pass
  int chunk_ = 64;               ///< tiles between two looks at the clock
  std::uint32_t limit_ = 0;      ///< of the call at hand
  double samples_before_ = 0.0;  ///< the mean at its beginning
  double fraction_ = 0.0;        ///< of its work, as last reported
  bool interrupted_ = false;
  bool timed_out_ = false;
  double render_s_ = 0.0;  ///< of the calls before
  Totals totals_;
  Stopwatch watch_;          ///< of the call at hand
  Stopwatch partial_watch_;  ///< since the last partial picture
};

/// What camera rays begin in, and how their layers are found.
void Picture::Impl::set_start() {
  find_start(camera_, context_);
  context_.has_features = settings_.has_features;
  context_.sees_shadows = geometry_.ground() != nullptr && settings_.sees_lamps;
  // Elsewhere the first surface of the layers is that of the path.
  const bool is_by_chance = geometry_.has_blends() || !context_.start.empty() || context_.eye_is_wide;
  context_.has_first_surface = is_by_chance && count_mean_layers(settings_.layers) > 0;
}

/// Pixels that no surface can cover take part in the first pass, and in a share of the others. Geometry and environment
/// decide that, never what was sampled, so that expectations stay.
bool Picture::Impl::takes_part(std::size_t pixel, std::uint32_t pass) const {
  if (pass == 0 || empty_shares_.empty() || empty_shares_[pixel] == 0) return true;
  const std::uint32_t share = empty_shares_[pixel];
  return (pass + 1) * share / kWhole > pass * share / kWhole;
}

void Picture::Impl::render_block(ivec2 corner, std::uint32_t first_sample, std::uint32_t last_sample,
                                 BlockCounts& counts) {
  RayPacket packet;
  SobolSampler samplers[RayPacket::kSize];
  float weights[RayPacket::kSize];
  ivec2 pixels[RayPacket::kSize];
  std::uint64_t active = 0, spared = 0;
  for (int i = 0; i < RayPacket::kSize; ++i) {
    pixels[i] = corner + ivec2(i % kBlock, i / kBlock);
    packet.active[i] = false;
    if (pixels[i].x >= settings_.width || pixels[i].y >= settings_.height) continue;
    const std::size_t pixel = static_cast<std::size_t>(pixels[i].y) * static_cast<std::size_t>(settings_.width) +
                              static_cast<std::size_t>(pixels[i].x);
    if (converged_[pixel] != 0) continue;
    packet.active[i] = takes_part(pixel, first_sample / kPassSamples);
    (packet.active[i] ? active : spared)++;
  }
  counts.samples += active * (last_sample - first_sample);
  counts.spared += spared * (last_sample - first_sample);
  counts.rays.camera += active * (last_sample - first_sample);
  if (active == 0) return;

  for (std::uint32_t s = first_sample; s < last_sample; ++s) {
    // ----- sixteen camera rays together
    for (int i = 0; i < RayPacket::kSize; ++i) {
      if (!packet.active[i]) continue;
      samplers[i] = SobolSampler(pixel_seed(settings_.seed, pixels[i].x, pixels[i].y), s);
      const vec2 film = vec2(pixels[i]) + 0.5f + filter_.sample(samplers[i].next_2d());
      const vec2 u_lens = camera_.has_lens() ? samplers[i].next_2d() : vec2(0.5f);
      const Camera::Sample camera = camera_.generate(film, u_lens);
      packet.rays[i] = camera.ray;
      packet.seeds[i] = samplers[i].next_hash();
      weights[i] = camera.weight;
    }
    Hit hits[RayPacket::kSize];
    geometry_.intersect(packet, hits);

    // ----- then every path on its own
    for (int i = 0; i < RayPacket::kSize; ++i) {
      if (!packet.active[i]) continue;
      PathSample sample = path_of(settings_.integrator)(context_, packet.rays[i], hits[i], samplers[i], counts.rays);
      if (settings_.clamp) clamp_indirect(*settings_.clamp, sample);
      sample.radiance *= weights[i];
      sample.seen *= weights[i];
      const bool is_finite = accumulator_.add(pixels[i].x, pixels[i].y, s, sample);
      if (!is_finite) ++counts.non_finite;
      if (is_finite && !settings_.mattes.empty()) add_mattes(pixels[i], packet.rays[i], hits[i]);
    }
  }
}

void Picture::Impl::render_tile(int tile, std::uint32_t first_sample, std::uint32_t last_sample) {
  const ivec2 corner = ivec2(tile % tiles_x_, tile / tiles_x_) * kTile;
  BlockCounts counts;
  for (int y = 0; y < kTile; y += kBlock) {
    for (int x = 0; x < kTile; x += kBlock) {
      render_block(corner + ivec2(x, y), first_sample, last_sample, counts);
    }
  }
  totals_.samples += counts.samples;
  totals_.spared += counts.spared;
  totals_.camera += counts.rays.camera;
  totals_.bounce += counts.rays.bounce;
  totals_.shadow += counts.rays.shadow;
  totals_.non_finite += counts.non_finite;
}

void Picture::Impl::find_empty() {
  has_looked_for_empty_ = true;
  constexpr std::uint64_t kMostTriangles = 20;  // per pixel: what projecting them may cost beside tracing
  const std::optional<Camera::Pinhole> pinhole = camera_.pinhole();
  if (!pinhole || placed_triangles(geometry_) > kMostTriangles * pixel_count()) return;
  const std::vector<std::uint8_t> covered = find_covered_pixels(geometry_, *pinhole, filter_.radius());
  empty_shares_.resize(pixel_count(), 0);
  const auto w = static_cast<std::size_t>(settings_.width);
  parallel_for(0, pixel_count(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (covered[i] != 0) continue;
      const std::size_t x = i % w, y = i / w;
      const vec2 middle = vec2(x, y) + 0.5f;
      std::array<vec3, 4> corners;
      for (std::size_t c = 0; c < 4; ++c) {
        const vec2 side((c & 1) != 0 ? 1.0f : -1.0f, (c & 2) != 0 ? 1.0f : -1.0f);
        corners[c] = camera_.generate(middle + side * filter_.radius(), vec2(0.5f)).ray.direction;
      }
      empty_shares_[i] = share_of_passes(background_contrast(context_, corners));
    }
  });
}

/// A pixel stops when it and its eight neighbours are below the target: a lone pixel that has met no highlight yet must
/// not freeze beside one that has.
void Picture::Impl::find_converged() {
  const std::vector<float> errors = accumulator_.shown_errors(settings_.develop);
  const auto w = static_cast<std::size_t>(settings_.width);
  converged_count_ = 0;
  for (int y = 0; y < settings_.height; ++y) {
    for (int x = 0; x < settings_.width; ++x) {
      bool all = true;
      for (int j = std::max(y - 1, 0); j <= std::min(y + 1, settings_.height - 1); ++j) {
        for (int i = std::max(x - 1, 0); i <= std::min(x + 1, settings_.width - 1); ++i) {
          all = all && errors[static_cast<std::size_t>(j) * w + static_cast<std::size_t>(i)] < *settings_.noise;
        }
      }
      converged_[static_cast<std::size_t>(y) * w + static_cast<std::size_t>(x)] = all ? 1 : 0;
      converged_count_ += all ? 1 : 0;
    }
  }
}

NoiseReached Picture::Impl::noise_reached() const {
  NoiseReached reached;
  std::size_t above = 0;
  for (const float error : accumulator_.shown_errors(settings_.develop)) {
    reached.worst = std::max(reached.worst, error);
    above += error < *settings_.noise ? 0 : 1;
  }
  reached.share_above = static_cast<double>(above) / static_cast<double>(pixel_count());
  return reached;
}

void Picture::Impl::report(const Job& job) {
  if (job.progress) {
    Progress p;
    p.seconds = watch_.seconds();
    p.samples_per_pixel = mean_samples();
    const double fresh = p.samples_per_pixel - samples_before_;
    p.fraction = fresh / std::max(static_cast<double>(limit_) - settings_.first_sample - samples_before_, 1e-9);
    if (settings_.noise) {
      p.fraction = std::max(p.fraction, static_cast<double>(converged_count_) / static_cast<double>(pixel_count()));
    }
    if (settings_.time_limit_s) p.fraction = std::max(p.fraction, p.seconds / *settings_.time_limit_s);
    // A pixel may lose its convergence again; the bar does not go back.
    p.fraction = fraction_ = std::clamp(p.fraction, fraction_, 1.0);
    if (p.fraction > 0.0) p.remaining_s = p.seconds * (1.0 - p.fraction) / p.fraction;
    const double rate = fresh * static_cast<double>(pixel_count()) / std::max(p.seconds, 1e-9);
    p.what = fmt::format("{:.0f} spp  {:.2f} Msamples/s", p.samples_per_pixel, rate * 1e-6);
    job.progress(p);
  }
  if (job.partial && partial_watch_.seconds() >= job.partial_interval_s) {
    job.partial(film(false));
    partial_watch_ = {};
  }
}

bool Picture::Impl::must_stop(const Job& job) const {
  return job.is_stopped() || (settings_.time_limit_s && watch_.seconds() >= *settings_.time_limit_s);
}

bool Picture::Impl::is_complete() const {
  return next_tile_ == 0 && (done_ >= limit_ || converged_count_ == pixel_count());
}

/// 1, 4, 16, then sixteen at a time: an early first picture, then steady looks at the error. They are at the same
/// numbers of samples however often the work is taken up again.
std::uint32_t Picture::Impl::next_look() const {
  if (done_ == 0) return 1;
  if (done_ < kPassSamples) return std::min(4 * done_, kPassSamples);
  return (done_ / kPassSamples + 1) * kPassSamples;
}

/// What is left of the pass at hand, or as much of it as there is time for.
void Picture::Impl::run_pass(const Job& job) {
  constexpr double kLookEvery = 0.25;  // seconds: how late Ctrl-C, a time limit and the progress bar may be
  const int tiles = tiles_x_ * tiles_y_;
  while (next_tile_ < tiles) {
    const int begin = next_tile_;
    next_tile_ = std::min(begin + chunk_, tiles);
    const Stopwatch watch;
    parallel_for(static_cast<std::size_t>(begin), static_cast<std::size_t>(next_tile_), 1,
                 [&](std::size_t first, std::size_t last) {
                   for (std::size_t tile = first; tile < last; ++tile)
                     render_tile(static_cast<int>(tile), done_, pass_end_);
                 });
    const double rate = static_cast<double>(next_tile_ - begin) / std::max(watch.seconds(), 1e-6);
    chunk_ = std::clamp(static_cast<int>(rate * kLookEvery), 16, std::max(tiles, 16));
    report(job);
    // The first pass is always whole, so that no part of the picture is missing.
    if (done_ > static_cast<std::uint32_t>(settings_.first_sample) && must_stop(job)) return;
  }
}

void Picture::Impl::trace(std::uint32_t limit, const Job& job) {
  watch_ = partial_watch_ = {};
  limit_ = limit;
  samples_before_ = mean_samples();
  fraction_ = 0.0;
  interrupted_ = timed_out_ = false;
  while (!is_complete()) {
    if (next_tile_ == 0) pass_end_ = std::min(limit, next_look());
    // Before a second pass; pictures of few samples have none.
    if (done_ >= kPassSamples && !has_looked_for_empty_) find_empty();
    run_pass(job);
    if (next_tile_ == tiles_x_ * tiles_y_) {
      done_ = pass_end_;
      next_tile_ = 0;
      if (settings_.noise && done_ % kPassSamples == 0) find_converged();
    }
    if (!is_complete() && must_stop(job)) {
      interrupted_ = job.is_stopped();
      timed_out_ = !interrupted_;
      break;
    }
  }
  if (!interrupted_) {
    fraction_ = 1.0;
    report(job);
  }
  render_s_ += watch_.seconds();
}

Statistics Picture::Impl::statistics() const {
  Statistics s;
  s.render_s = render_s_;
  if (settings_.noise) s.noise = noise_reached();
  s.samples = totals_.samples;
  s.spared_samples = totals_.spared;
  s.camera_rays = totals_.camera;
  s.bounce_rays = totals_.bounce;
  s.shadow_rays = totals_.shadow;
  s.non_finite_samples = totals_.non_finite;
  s.triangles = geometry_.triangle_count();
  s.instances = geometry_.instance_count();
  s.mean_samples_per_pixel = mean_samples();
  s.interrupted = interrupted_;
  s.timed_out = timed_out_;
  return s;
}

std::vector<std::byte> Picture::Impl::state() const {
  const std::array<Place, 1> place{{{done_, pass_end_, static_cast<std::uint32_t>(next_tile_),
                                     static_cast<std::uint32_t>(converged_count_), totals_.samples, totals_.spared,
                                     totals_.camera, totals_.bounce, totals_.shadow, totals_.non_finite, render_s_}}};
  std::vector<std::byte> bytes;
  const auto append = [&](std::span<const std::byte> raw) { bytes.insert(bytes.end(), raw.begin(), raw.end()); };
  append(std::as_bytes(std::span(place)));
  append(std::as_bytes(std::span(converged_)));
  accumulator_.write(bytes);
  return bytes;
}

void Picture::Impl::set_state(std::span<const std::byte> bytes) {
  std::array<Place, 1> place{};
  const auto take = [&](std::span<std::byte> into) {
    if (bytes.size() < into.size()) throw Error("the picture to go on from is cut short");
    std::copy_n(bytes.begin(), into.size(), into.begin());
    bytes = bytes.subspan(into.size());
  };
  take(std::as_writable_bytes(std::span(place)));
  take(std::as_writable_bytes(std::span(converged_)));
  accumulator_.read(bytes);
  const Place& p = place[0];
  const bool is_possible = bytes.empty() && p.next_tile < static_cast<std::uint32_t>(tiles_x_ * tiles_y_) &&
                           p.done >= static_cast<std::uint32_t>(settings_.first_sample) &&
                           p.done <= p.pass_end + kPassSamples;
  if (!is_possible) throw Error("the picture to go on from is another one");
  done_ = p.done, pass_end_ = p.pass_end, next_tile_ = static_cast<int>(p.next_tile);
  converged_count_ = p.converged_count;
  totals_.samples = p.samples, totals_.spared = p.spared, totals_.camera = p.camera;
  totals_.bounce = p.bounce, totals_.shadow = p.shadow, totals_.non_finite = p.non_finite;
  render_s_ = p.render_s;
}

/// What is at a pixel's centre: means across an edge would be places where nothing is.
void Picture::Impl::add_centre_layers(Film& film) const {
  const Scene& scene = *parts_->scene;
  const ivec2 size(settings_.width, settings_.height);
  if (settings_.has_masks) film.masks = find_masks(geometry_, pinhole_, size);
  if (!has_centre_layer(settings_.layers)) return;
  SurfaceMap map = map_surfaces(geometry_, pinhole_, size);
  add_surface_layers(scene, view_, map, settings_.layers, film);
  if (settings_.layers.contains(Layer::motion)) film.surfaces = std::move(map);
}

void Picture::Impl::add_mattes(ivec2 pixel, const Ray& ray, const Hit& first) {
  RayCounts ignored;
  const Hit hit = first_visible_hit(context_, ray, first, ignored);
  if (!hit || geometry_.placement(hit.placement).is_ground) return;
  const Placement& p = geometry_.placement(hit.placement);
  const Scene& scene = *parts_->scene;
  for (const MatteKind kind : settings_.mattes) {
    const int number =
        kind == MatteKind::object ? p.node : material_of(scene, {.node = p.node, .primitive = p.primitive});
    accumulator_.add_matte(kind, pixel.x, pixel.y, static_cast<std::uint32_t>(number));
  }
}

Film Picture::Impl::film(bool has_features) const {
  Film film;
  accumulator_.resolve(film, has_features);
  for (auto& [kind, mattes] : film.mattes) mattes.names = matte_names(*parts_->scene, kind);
  if (const auto found = film.layers.find(Layer::camera_normal); found != film.layers.end()) {
    turn_to_camera(view_, found->second);
  }
  add_centre_layers(film);
  return film;
}

const char* integrator_name(Integrator integrator) {
  switch (integrator) {
    case Integrator::minimal:
      return "minimal";
    case Integrator::surfaces:
      return "surfaces";
    case Integrator::full:
      break;
  }
  return "full";
}

void check_built() {}

void check(const Settings& settings, const View& view) {
  check_settings(settings);
  check_view(view);
}

std::uint64_t picture_bytes(const Settings& settings) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(settings.width) * static_cast<std::uint64_t>(settings.height);
  constexpr std::uint64_t kFlags = 2;  // who is empty, and has converged
  return pixels * (Accumulator::bytes_per_pixel(settings) + kFlags +
                   film_bytes_per_pixel(settings.layers, settings.has_features) +
                   (has_centre_layer(settings.layers) ? sizeof(SurfaceSample) : 0));
}

FarLight::FarLight(const Environment& environment)
    : prepared_(std::make_shared<const PreparedEnvironment>(environment)) {}

Tracer::Tracer(std::shared_ptr<const Scene> scene, const FarLight& light, const shade::ShadingModel& shading)
    : parts_(std::make_shared<const Parts>(std::move(scene), light.prepared_, shading)) {}

Tracer::Tracer(std::shared_ptr<const Scene> scene, const Environment& environment, const shade::ShadingModel& shading) {
  const Stopwatch watch;
  const FarLight light(environment);
  parts_ = std::make_shared<const Parts>(std::move(scene), light.prepared_, shading, watch.seconds());
}

Tracer::Tracer(Scene scene, const Environment& environment, const shade::ShadingModel& shading)
    : Tracer(std::make_shared<const Scene>(std::move(scene)), environment, shading) {}

const Scene& Tracer::scene() const { return *parts_->scene; }
double Tracer::build_s() const { return parts_->build_s; }

Tracer::Tracer(const Tracer& before, std::shared_ptr<const Scene> scene, const FarLight& light)
    : parts_(std::make_shared<Parts>(*before.parts_, std::move(scene), light.prepared_)) {}

bool Tracer::take_materials(const std::shared_ptr<const Scene>& scene, const FarLight& light,
                            const shade::ShadingModel& shading) {
  if (parts_.use_count() != 1 || parts_->shared_geometry.use_count() != 1) return false;
  std::atomic_thread_fence(std::memory_order_acquire);  // the last picture has read it
  if (!parts_->shared_geometry->set_materials(Parts::checked(scene), shading)) return false;
  parts_ = std::make_shared<const Parts>(*parts_, scene, light.prepared_);
  return true;
}

Film Tracer::render(const View& view, const Settings& settings, const Job& job, Statistics* statistics) const {
  Picture picture(*this, view, settings);
  picture.trace(settings.samples, job);
  if (statistics != nullptr) *statistics = picture.statistics();
  return picture.film();
}

Picture::Picture(const Tracer& tracer, const View& view, const Settings& settings) {
  check_view(view);
  impl_ = std::make_unique<Impl>(tracer.parts_, view, settings);
}
Picture::~Picture() = default;
void Picture::trace(int samples, const Job& job) {
  impl_->trace(static_cast<std::uint32_t>(std::max(samples, 0)), job);
}
Film Picture::film() const { return impl_->film(true); }
Statistics Picture::statistics() const { return impl_->statistics(); }
const Accumulator& Picture::sums() const { return impl_->sums(); }
bool Picture::has_through() const { return impl_->has_through(); }
std::vector<std::byte> Picture::state() const { return impl_->state(); }
void Picture::set_state(std::span<const std::byte> bytes) { impl_->set_state(bytes); }

Film render(const Scene& scene, const Environment& environment, const View& view, const Settings& settings,
            const Job& job, Statistics* statistics) {
  check(settings, view);
  const Tracer tracer(borrowed(scene), environment);
  Film film = tracer.render(view, settings, job, statistics);
  if (statistics != nullptr) statistics->build_s = tracer.build_s();
  return film;
}

}  // namespace candela::path
