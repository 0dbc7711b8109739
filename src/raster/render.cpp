#include "raster/render.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <future>
#include <limits>

#include "base/parallel.h"
#include "gl/gl.h"
#include "math/hash.h"
#include "raster/renderer.h"
#include "shade/surface_params.glsl.h"

namespace candela::raster {

namespace {

class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - last_).count(); }
  /// Seconds since the last call.
  double lap() {
    const auto now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

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
      const float weight = glm::mix(1.0f, cos2 * cos2, view.lens.vignetting);
      for (int c = 0; c < 3; ++c) image.pixels[image.index(x, y) + static_cast<std::size_t>(c)] *= weight;
    }
  }
}

}  // namespace

std::uint64_t picture_bytes(const Settings& settings) {
  const auto pixels = static_cast<std::uint64_t>(settings.width) * static_cast<std::uint64_t>(settings.height);
  // Colour of half floats and depth per sample, two resolved pictures with mips, twelve depths where something is
  // blended, three copies in floats, the layers.
  const auto samples = static_cast<std::uint64_t>(settings.msaa);
  const std::uint64_t through =
      settings.background == Background::transparent && !settings.environment_in_glass ? samples * 8 + 8 + 48 : 0;
  return pixels * (samples * 12 + 24 + 48 + 48 + through + film_bytes_per_pixel(settings.layers));
}

struct Session::Parts {
  std::unique_ptr<gl::Context> context;
  double open_s = 0.0;
  LightKey key;  ///< of `light`
  BakedLight light;
  std::vector<Probe> probes;
};

Session::Session() : parts_(std::make_unique<Parts>()) {
  Stopwatch watch;
  parts_->context = gl::Context::open();
  parts_->open_s = watch.lap();
}

Session::~Session() = default;

void Session::set_probes(std::vector<Probe> probes) { parts_->probes = std::move(probes); }

namespace {

/// Brings directions and lengths to where a picture can show them: directions from −1 … 1 to 0 … 1, positions and
/// depths over the scene's size, an object's number to a colour of its own.
/// Positions and `bounds` are relative to the same origin.
void show_numbers(Quantity quantity, const Box3& bounds, Image& picture) {
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

/// Tells how far the work is, and knows when it has to end.
class Watcher {
 public:
  Watcher(const Callbacks& callbacks, std::size_t pictures, int frames)
      : callbacks_(callbacks), pictures_(pictures), frames_(frames) {}

  bool must_stop() const { return callbacks_.stop != nullptr && callbacks_.stop->load(); }

  void tell(std::size_t picture, int frame) {
    constexpr double kTellEvery = 0.1;  // seconds
    const double now = since_start_.seconds();
    if (!callbacks_.progress || now < next_s_) return;
    next_s_ = now + kTellEvery;
    const double done = static_cast<double>(picture) + static_cast<double>(frame) / frames_;
    callbacks_.progress({picture, pictures_, frame, done / static_cast<double>(pictures_), now});
  }

 private:
  const Callbacks& callbacks_;
  std::size_t pictures_;
  int frames_;
  Stopwatch since_start_;
  double next_s_ = 0.0;
};

/// What shows through is what nothing covers, and `glass` of what is covered.
void add_open(Image glass, Film& film) {
  for (std::size_t i = 0; i < glass.pixels.size(); i += 4) {
    const float coverage = film.beauty.pixels[i + 3];
    for (std::size_t c = 0; c < 3; ++c) glass.pixels[i + c] += 1.0f - coverage;
    glass.pixels[i + 3] = coverage;
  }
  set_through(std::move(glass), film);
}

/// The mean of a view's frames, or of those that are drawn when it has to end. Where a moment wants light for sheen,
/// which none before did, `light_sheen` gives it to the renderer.
Film draw_view(Renderer& renderer, View view, std::size_t picture_index, const MomentOf& moment,
               const std::function<void()>& light_sheen, const Settings& settings, Watcher& watcher, Statistics& s) {
  Film film;
  film.beauty = Image(settings.width, settings.height, 4);
  Image through;
  int drawn = 0;
  for (int frame = 0; frame < settings.frames; ++frame) {
    const bool is_still = settings.frames > 1;
    const vec4 u = lattice_point(frame);
    const vec2 jitter = is_still ? vec2(u) - 0.5f : vec2(0.0f);
    const vec2 lens = is_still ? sample_aperture(view.lens, {u.z, u.w}) : vec2(0.0f);
    if (moment) {
      const Moment now = moment(picture_index, frame);
      view = now.view;
      renderer.set_scene(*now.scene);
      if (renderer.lacks_sheen_light()) light_sheen();
      renderer.begin(view, light_point(frame, settings.frames));
    } else if (is_still && renderer.has_extended_lights()) {
      renderer.begin(view, light_point(frame, settings.frames));
    }
    Stopwatch drawing;
    renderer.draw(view, jitter, lens, frame + 1);
    glFinish();
    s.draw_s += drawing.lap();
    const Image picture = renderer.read();
    const Image behind = renderer.read_through();
    const float share = 1.0f / static_cast<float>(settings.frames);
    if (through.empty()) through = Image(behind.width, behind.height, behind.channels);
    for (std::size_t i = 0; i < behind.pixels.size(); ++i) {
      if (std::isfinite(behind.pixels[i])) through.pixels[i] += share * behind.pixels[i];
    }
    for (std::size_t i = 0; i < picture.pixels.size(); i += 4) {
      const float* p = picture.pixels.data() + i;
      const bool is_good = std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]) && std::isfinite(p[3]);
      if (!is_good) ++s.non_finite_pixels;
      for (std::size_t c = 0; c < 4; ++c) film.beauty.pixels[i + c] += is_good ? share * p[c] : 0.0f;
      if (settings.quantity == Quantity::non_finite) {
        const vec4 judged = is_good ? vec4(vec3(0.05f * p[3]), p[3]) : vec4(1, 0, 1, 1);
        for (int c = 0; c < 4; ++c) film.beauty.pixels[i + static_cast<std::size_t>(c)] = judged[c];
      }
    }
    watcher.tell(picture_index, ++drawn);
    if (drawn < settings.frames && watcher.must_stop()) {
      s.interrupted = true;
      break;
    }
  }
  s.frames += drawn;
  if (drawn < settings.frames && settings.quantity != Quantity::non_finite) {
    const float rest = static_cast<float>(settings.frames) / static_cast<float>(drawn);
    for (Image* image : {&film.beauty, &through}) {
      for (float& v : image->pixels) v *= rest;
    }
  }
  if (!through.empty()) add_open(std::move(through), film);
  apply_vignetting(view, film.beauty);
  show_numbers(settings.quantity, renderer.scene().bounds(), film.beauty);
  if (settings.quantity == Quantity::luminance) {
    for (std::size_t i = 0; i < film.beauty.pixels.size(); i += 4) {
      float* p = film.beauty.pixels.data() + i;
      const vec3 color = false_color(luminance(vec3(p[0], p[1], p[2])));
      p[0] = color.x, p[1] = color.y, p[2] = color.z;
    }
  }
  for (const Layer layer : settings.layers) film.layers[layer] = renderer.read_layer(view, layer);
  return film;
}

}  // namespace

void Session::draw(const Scene& scene, const Environment& environment, const std::vector<View>& views,
                   const Settings& settings, Diagnostics& diagnostics,
                   const std::function<void(std::size_t, Film)>& take, Statistics* statistics, const MomentOf& moment,
                   const Callbacks& callbacks) {
  Statistics ignored;
  Statistics& s = statistics != nullptr ? *statistics : ignored;
  Stopwatch watch;
  s.driver = parts_->context->renderer();
  s.open_s = parts_->open_s;

  // The light is baked while this thread, the driver's, uploads and compiles.
  const auto bake = [&](bool wants_sheen) {
    Stopwatch baking;
    const LightKey key = light_key(environment, wants_sheen);
    if (key != parts_->key) {
      parts_->light =
          is_lit_from_far(environment) ? bake_light(environment, wants_sheen, settings.cache) : BakedLight{};
      parts_->key = key;
    }
    s.light_s += baking.lap();
  };
  std::future<void> baked = std::async(std::launch::async, bake, uses_sheen(scene));
  Settings used = settings;
  if (is_of_surface(used.quantity)) used.msaa = 1;  // numbers of two surfaces have no mean
  Renderer renderer(scene, environment, used, diagnostics);
  glFinish();
  s.upload_s = watch.lap();
  Watcher watcher(callbacks, views.size(), settings.frames);
  const auto give_light = [&] {
    renderer.set_light(settings.ambient == Ambient::baked ? parts_->light
                                                          : simplified(parts_->light, settings.ambient));
  };
  const auto light_sheen = [&] {
    bake(true);
    give_light();
  };
  for (std::size_t i = 0; i < views.size() && !s.interrupted; ++i) {
    watch.lap();
    renderer.begin(views[i]);
    glFinish();
    s.shadow_s += watch.lap();
    if (i == 0) {
      renderer.warm_up(views[i]);
      s.compile_s = watch.lap();
      baked.get();
      s.is_light_cached = parts_->light.is_cached;
      give_light();
      renderer.set_probes(parts_->probes);
      watch.lap();
    }
    Film film = draw_view(renderer, views[i], i, moment, light_sheen, settings, watcher, s);
    s.frame_s += watch.lap();
    take(i, std::move(film));
    if (i + 1 < views.size() && watcher.must_stop()) s.interrupted = true;
  }
  s.programs = static_cast<int>(renderer.programs().count());
  s.triangles = renderer.scene().triangle_count();
  s.draws = renderer.scene().draws().size();
}

Film render(const Scene& scene, const Environment& environment, const View& view, const Settings& settings,
            Diagnostics& diagnostics, Statistics* statistics, const Callbacks& callbacks) {
  Film film;
  Session session;
  session.draw(
      scene, environment, {view}, settings, diagnostics, [&film](std::size_t, Film drawn) { film = std::move(drawn); },
      statistics, {}, callbacks);
  return film;
}

}  // namespace candela::raster
