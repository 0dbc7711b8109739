#include "path/render.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "path/accumulator.h"
#include "path/bodies.h"
#include "path/camera.h"
#include "path/integrator.h"
#include "path/pixel_filter.h"

namespace candela::path {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

constexpr int kTile = 16;         ///< pixels; a tile is the unit of parallel work
constexpr int kBlock = 4;         ///< a packet is 4 × 4 pixels
constexpr int kPassSamples = 16;  ///< per pixel between two looks at the error

struct Totals {
  std::atomic<std::uint64_t> samples{0}, camera{0}, bounce{0}, shadow{0}, non_finite{0};
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

/// One rendering: owns what the passes share.
class Job {
 public:
  Job(const Scene& scene, const Environment& environment, const View& view, const Settings& settings)
      : settings_(settings),
        geometry_(scene, settings.shading),
        lights_(scene, environment, geometry_),
        context_{geometry_,
                 lights_,
                 settings.bounces,
                 settings.background,
                 shows_background_in_glass(scene, settings),
                 settings.sees_lamps,
                 geometry_.has_media()},
        camera_(view, settings.width, settings.height),
        pinhole_(without_lens(view), settings.width, settings.height),
        filter_(settings.filter, settings.filter_radius),
        accumulator_(settings, context_.background_in_glass),
        converged_(static_cast<std::size_t>(settings.width) * static_cast<std::size_t>(settings.height), 0),
        tiles_x_((settings.width + kTile - 1) / kTile),
        tiles_y_((settings.height + kTile - 1) / kTile) {
    find_start();
  }

  void run(const Callbacks& callbacks, Statistics& statistics);
  Film film() const;

 private:
  void render_tile(int tile, std::uint32_t first_sample, std::uint32_t last_sample);
  void render_block(ivec2 corner, std::uint32_t first_sample, std::uint32_t last_sample, RayCounts& counts,
                    std::uint64_t& samples, std::uint64_t& non_finite);
  void find_start();
  void find_converged();
  NoiseReached noise_reached() const;
  bool run_pass(std::uint32_t first_sample, std::uint32_t last_sample, const Callbacks& callbacks);
  bool must_stop(const Callbacks& callbacks) const;
  void report(const Callbacks& callbacks);
  void trace_centre_layers(Film& film) const;
  std::uint32_t pixel_seed(int x, int y) const {
    return hash_combine(hash_combine(settings_.seed, static_cast<std::uint32_t>(x)), static_cast<std::uint32_t>(y));
  }
  std::size_t pixel_count() const { return converged_.size(); }

  Settings settings_;
  Geometry geometry_;
  Lights lights_;
  PathContext context_;
  Camera camera_;
  Camera pinhole_;  ///< through the middle of the lens: a polygon's numbers (½, ½) are not its middle
  PixelFilterSampler filter_;
  Accumulator accumulator_;
  std::vector<std::uint8_t> converged_;
  std::size_t converged_count_ = 0;
  int tiles_x_;
  int tiles_y_;
  int chunk_ = 64;         ///< tiles between two looks at the clock
  double fraction_ = 0.0;  ///< of the work, as last reported
  Totals totals_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_partial_ = Clock::now();
};

/// What camera rays begin in, and how their layers are found.
void Job::find_start() {
  const Box3 eye = camera_.origins();
  if (eye.lower == eye.upper) {
    context_.start = bodies_around(geometry_, eye.lower);
  } else {
    context_.eye_is_wide = may_be_inside(geometry_, eye);
  }
  // Elsewhere the first surface of the layers is that of the path.
  const bool is_by_chance = geometry_.has_blends() || !context_.start.empty() || context_.eye_is_wide;
  context_.has_first_surface =
      is_by_chance && (settings_.layers.contains(Layer::albedo) || settings_.layers.contains(Layer::normal));
}

void Job::render_block(ivec2 corner, std::uint32_t first_sample, std::uint32_t last_sample, RayCounts& counts,
                       std::uint64_t& samples, std::uint64_t& non_finite) {
  RayPacket packet;
  SobolSampler samplers[RayPacket::kSize];
  float weights[RayPacket::kSize];
  ivec2 pixels[RayPacket::kSize];
  int active = 0;
  for (int i = 0; i < RayPacket::kSize; ++i) {
    pixels[i] = corner + ivec2(i % kBlock, i / kBlock);
    packet.active[i] = pixels[i].x < settings_.width && pixels[i].y < settings_.height &&
                       converged_[static_cast<std::size_t>(pixels[i].y) * static_cast<std::size_t>(settings_.width) +
                                  static_cast<std::size_t>(pixels[i].x)] == 0;
    active += packet.active[i] ? 1 : 0;
  }
  if (active == 0) return;

  for (std::uint32_t s = first_sample; s < last_sample; ++s) {
    // ----- sixteen camera rays together
    for (int i = 0; i < RayPacket::kSize; ++i) {
      if (!packet.active[i]) continue;
      samplers[i] = SobolSampler(pixel_seed(pixels[i].x, pixels[i].y), s);
      const vec2 film = vec2(pixels[i]) + 0.5f + filter_.sample(samplers[i].next_2d());
      const vec2 u_lens = camera_.has_lens() ? samplers[i].next_2d() : vec2(0.5f);
      const Camera::Sample camera = camera_.generate(film, u_lens);
      packet.rays[i] = camera.ray;
      packet.seeds[i] = samplers[i].next_hash();
      weights[i] = camera.weight;
    }
    Hit hits[RayPacket::kSize];
    geometry_.intersect(packet, hits);
    counts.camera += static_cast<std::uint64_t>(active);

    // ----- then every path on its own
    for (int i = 0; i < RayPacket::kSize; ++i) {
      if (!packet.active[i]) continue;
      PathSample sample = settings_.integrator == Integrator::full
                              ? trace_path(context_, packet.rays[i], hits[i], samplers[i], counts)
                              : trace_path_minimal(context_, packet.rays[i], hits[i], samplers[i], counts);
      sample.radiance *= weights[i];
      if (!accumulator_.add(pixels[i].x, pixels[i].y, sample)) ++non_finite;
      ++samples;
    }
  }
}

void Job::render_tile(int tile, std::uint32_t first_sample, std::uint32_t last_sample) {
  const ivec2 corner = ivec2(tile % tiles_x_, tile / tiles_x_) * kTile;
  RayCounts counts;
  std::uint64_t samples = 0;
  std::uint64_t non_finite = 0;
  for (int y = 0; y < kTile; y += kBlock) {
    for (int x = 0; x < kTile; x += kBlock) {
      render_block(corner + ivec2(x, y), first_sample, last_sample, counts, samples, non_finite);
    }
  }
  totals_.samples += samples;
  totals_.camera += counts.camera;
  totals_.bounce += counts.bounce;
  totals_.shadow += counts.shadow;
  totals_.non_finite += non_finite;
}

/// A pixel stops when it and its eight neighbours are below the target: a lone pixel that has met no highlight yet must
/// not freeze beside one that has.
void Job::find_converged() {
  const Accumulator::Reference reference = accumulator_.reference();
  const auto w = static_cast<std::size_t>(settings_.width);
  std::vector<std::uint8_t> good(pixel_count());
  parallel_for(0, static_cast<std::size_t>(settings_.height), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) {
      for (std::size_t x = 0; x < w; ++x) {
        good[y * w + x] =
            accumulator_.relative_error(static_cast<int>(x), static_cast<int>(y), reference) < *settings_.noise;
      }
    }
  });
  converged_count_ = 0;
  for (int y = 0; y < settings_.height; ++y) {
    for (int x = 0; x < settings_.width; ++x) {
      bool all = true;
      for (int j = std::max(y - 1, 0); j <= std::min(y + 1, settings_.height - 1); ++j) {
        for (int i = std::max(x - 1, 0); i <= std::min(x + 1, settings_.width - 1); ++i) {
          all = all && good[static_cast<std::size_t>(j) * w + static_cast<std::size_t>(i)] != 0;
        }
      }
      converged_[static_cast<std::size_t>(y) * w + static_cast<std::size_t>(x)] = all ? 1 : 0;
      converged_count_ += all ? 1 : 0;
    }
  }
}

NoiseReached Job::noise_reached() const {
  const Accumulator::Reference reference = accumulator_.reference();
  NoiseReached reached;
  std::size_t above = 0;
  for (int y = 0; y < settings_.height; ++y) {
    for (int x = 0; x < settings_.width; ++x) {
      const float error = accumulator_.relative_error(x, y, reference);
      reached.worst = std::max(reached.worst, error);
      above += error < *settings_.noise ? 0 : 1;
    }
  }
  reached.share_above = static_cast<double>(above) / static_cast<double>(pixel_count());
  return reached;
}

void Job::report(const Callbacks& callbacks) {
  if (callbacks.progress) {
    Progress p;
    p.seconds = seconds_since(start_);
    const auto samples = static_cast<double>(totals_.samples.load());
    p.mean_samples = samples / static_cast<double>(pixel_count());
    p.samples_per_second = p.seconds > 0.0 ? samples / p.seconds : 0.0;
    p.fraction = p.mean_samples / settings_.samples;
    if (settings_.noise) {
      p.fraction = std::max(p.fraction, static_cast<double>(converged_count_) / static_cast<double>(pixel_count()));
    }
    if (settings_.time_limit_s) p.fraction = std::max(p.fraction, p.seconds / *settings_.time_limit_s);
    // A pixel may lose its convergence again; the bar does not go back.
    p.fraction = fraction_ = std::clamp(p.fraction, fraction_, 1.0);
    if (p.fraction > 0.0) p.remaining_s = p.seconds * (1.0 - p.fraction) / p.fraction;
    callbacks.progress(p);
  }
  if (callbacks.partial && seconds_since(last_partial_) >= callbacks.partial_interval_s) {
    callbacks.partial(film());
    last_partial_ = Clock::now();
  }
}

bool Job::must_stop(const Callbacks& callbacks) const {
  return (callbacks.stop != nullptr && callbacks.stop->load()) ||
         (settings_.time_limit_s && seconds_since(start_) >= *settings_.time_limit_s);
}

/// False when the work has to stop.
bool Job::run_pass(std::uint32_t first_sample, std::uint32_t last_sample, const Callbacks& callbacks) {
  constexpr double kLookEvery = 0.25;  // seconds: how late Ctrl-C, a time limit and the progress bar may be
  const int tiles = tiles_x_ * tiles_y_;
  for (int begin = 0; begin < tiles;) {
    const int end = std::min(begin + chunk_, tiles);
    const auto chunk_start = Clock::now();
    parallel_for(static_cast<std::size_t>(begin), static_cast<std::size_t>(end), 1,
                 [&](std::size_t first, std::size_t last) {
                   for (std::size_t tile = first; tile < last; ++tile)
                     render_tile(static_cast<int>(tile), first_sample, last_sample);
                 });
    const double rate = static_cast<double>(end - begin) / std::max(seconds_since(chunk_start), 1e-6);
    chunk_ = std::clamp(static_cast<int>(rate * kLookEvery), 16, tiles);
    begin = end;
    report(callbacks);
    // The first pass is always whole, so that no part of the picture is missing.
    if (first_sample > 0 && must_stop(callbacks)) return false;
  }
  return !must_stop(callbacks);
}

void Job::run(const Callbacks& callbacks, Statistics& statistics) {
  start_ = last_partial_ = Clock::now();
  const auto limit = static_cast<std::uint32_t>(settings_.samples);
  // 1, 4, 16, then sixteen at a time: an early first picture, then steady looks at the error.
  for (std::uint32_t done = 0; done < limit;) {
    const std::uint32_t next = std::min(limit, done == 0 ? 1U : done < kPassSamples ? done * 4U : done + kPassSamples);
    if (!run_pass(done, next, callbacks)) {
      statistics.interrupted = callbacks.stop != nullptr && callbacks.stop->load();
      statistics.timed_out = !statistics.interrupted;
      break;
    }
    done = next;
    if (settings_.noise && done >= kPassSamples) {
      find_converged();
      if (converged_count_ == pixel_count()) break;
    }
  }
  if (!statistics.interrupted) {
    fraction_ = 1.0;
    report(callbacks);
  }
  statistics.render_s = seconds_since(start_);
  if (settings_.noise) statistics.noise = noise_reached();
  statistics.samples = totals_.samples;
  statistics.camera_rays = totals_.camera;
  statistics.bounce_rays = totals_.bounce;
  statistics.shadow_rays = totals_.shadow;
  statistics.non_finite_samples = totals_.non_finite;
  statistics.triangles = geometry_.triangle_count();
  statistics.instances = geometry_.instance_count();
  statistics.mean_samples_per_pixel = static_cast<double>(totals_.samples.load()) / static_cast<double>(pixel_count());
}

/// Depth, position and object id are those of the pixel's centre: their mean across an edge would be a place where
/// nothing is.
void Job::trace_centre_layers(Film& film) const {
  const bool depth = settings_.layers.contains(Layer::depth);
  const bool position = settings_.layers.contains(Layer::position);
  const bool id = settings_.layers.contains(Layer::object_id);
  if (!depth && !position && !id) return;
  if (depth) film.layers[Layer::depth] = Image(settings_.width, settings_.height, 1);
  if (position) film.layers[Layer::position] = Image(settings_.width, settings_.height, 3);
  if (id) film.layers[Layer::object_id] = Image(settings_.width, settings_.height, 1);
  parallel_for(0, static_cast<std::size_t>(settings_.height), 4, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < settings_.width; ++x) {
        const Camera::Sample camera = pinhole_.generate(vec2(x, y) + 0.5f, vec2(0.5f));
        const Ray& ray = camera.ray;
        const Hit hit = geometry_.first_surface(ray);
        const vec3 p = hit ? ray.origin + ray.direction * hit.t : vec3(0.0f);
        if (depth) film.layers[Layer::depth].at(x, y)[0] = hit ? camera.start + glm::length(p - ray.origin) : kInfinity;
        if (position) film.layers[Layer::position].set_rgb(x, y, p);
        if (id) {
          film.layers[Layer::object_id].at(x, y)[0] =
              hit ? static_cast<float>(geometry_.placement(hit.placement).number + 1) : 0.0f;
        }
      }
    }
  });
}

Film Job::film() const {
  Film film;
  accumulator_.resolve(film);
  trace_centre_layers(film);
  return film;
}

void check_settings(const Settings& s) {
  constexpr int kMaxSize = 65536;
  if (s.width < 1 || s.height < 1 || s.width > kMaxSize || s.height > kMaxSize)
    throw Error("picture size out of range");
  if (s.samples < 1) throw Error("at least one sample per pixel is needed");
  if (s.bounces < 0) throw Error("the number of bounces is negative");
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

}  // namespace

std::uint64_t picture_bytes(const Settings& settings) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(settings.width) * static_cast<std::uint64_t>(settings.height);
  const std::uint64_t flags = settings.noise ? 2 : 1;  // who has converged, and who is good in itself
  return pixels * (Accumulator::bytes_per_pixel(settings) + flags + film_bytes_per_pixel(settings.layers));
}

Film render(const Scene& scene, const Environment& environment, const View& view, const Settings& settings,
            Statistics* statistics, const Callbacks& callbacks) {
  check_settings(settings);
  check_view(view);
  Statistics local;
  const auto start = Clock::now();
  Job job(scene, environment, view, settings);
  local.build_s = seconds_since(start);
  job.run(callbacks, local);
  if (statistics != nullptr) *statistics = local;
  return job.film();
}

}  // namespace candela::path
