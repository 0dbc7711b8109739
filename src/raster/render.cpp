#include "raster/render.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <future>

#include "base/parallel.h"
#include "gl/gl.h"
#include "math/hash.h"
#include "raster/renderer.h"
#include "shade/surface_params.glsl.h"

namespace candela::raster {

namespace {

class Stopwatch {
 public:
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

/// Whether emissive surfaces are the only light there is.
bool only_glows(const Scene& scene, const Environment& environment) {
  const bool has_lamp =
      std::any_of(scene.nodes.begin(), scene.nodes.end(), [](const Node& node) { return node.light >= 0; });
  // By a texture, whose lamps nobody finds; what glows evenly is a light.
  const bool glows = std::any_of(scene.materials.begin(), scene.materials.end(), [](const Material& m) {
    return max_component(m.emission) > 0.0f && m.emissive_texture && !m.unlit;
  });
  return glows && !has_lamp && !is_lit_from_far(environment) && environment.suns.empty();
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
  return pixels * (samples * 12 + 24 + 48 + 48 + film_bytes_per_pixel(settings.layers));
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
void show_numbers(Quantity quantity, const Box3& bounds, Image& picture) {
  const vec3 size = glm::max(bounds.size(), vec3(1e-6f));
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

/// The mean of a view's frames.
Film draw_view(Renderer& renderer, View view, std::size_t picture_index, const MomentOf& moment,
               const Settings& settings, Statistics& s) {
  Film film;
  film.beauty = Image(settings.width, settings.height, 4);
  for (int frame = 0; frame < settings.frames; ++frame) {
    const bool is_still = settings.frames > 1;
    const vec4 u = lattice_point(frame);
    const vec2 jitter = is_still ? vec2(u) - 0.5f : vec2(0.0f);
    const vec2 lens = is_still ? sample_aperture(view.lens, {u.z, u.w}) : vec2(0.0f);
    if (moment) {
      const Moment now = moment(picture_index, frame);
      view = now.view;
      renderer.set_scene(*now.scene);
      renderer.begin(view, light_point(frame, settings.frames));
    } else if (is_still && renderer.has_extended_lights()) {
      renderer.begin(view, light_point(frame, settings.frames));
    }
    Stopwatch drawing;
    renderer.draw(view, jitter, lens);
    glFinish();
    s.draw_s += drawing.lap();
    const Image picture = renderer.read();
    const float share = 1.0f / static_cast<float>(settings.frames);
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
  }
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
                   const std::function<void(std::size_t, Film)>& take, Statistics* statistics, const MomentOf& moment) {
  Statistics ignored;
  Statistics& s = statistics != nullptr ? *statistics : ignored;
  Stopwatch watch;
  s.driver = parts_->context->renderer();
  s.open_s = parts_->open_s;

  // The light is baked while this thread, the driver's, uploads and compiles.
  const auto bake = [&] {
    Stopwatch baking;
    const LightKey key = light_key(environment, uses_sheen(scene));
    if (key != parts_->key) {
      parts_->light =
          is_lit_from_far(environment) ? bake_light(environment, uses_sheen(scene), settings.cache) : BakedLight{};
      parts_->key = key;
    }
    s.light_s = baking.lap();
  };
  if (only_glows(scene, environment)) {
    diagnostics.warn("only what glows in it lights the scene, which the path tracer can show and this engine cannot",
                     scene.name);
  }
  std::future<void> baked = std::async(std::launch::async, bake);
  Settings used = settings;
  if (is_of_surface(used.quantity)) used.msaa = 1;  // numbers of two surfaces have no mean
  Renderer renderer(scene, environment, used, diagnostics);
  glFinish();
  s.upload_s = watch.lap();
  for (std::size_t i = 0; i < views.size(); ++i) {
    watch.lap();
    renderer.begin(views[i]);
    glFinish();
    s.shadow_s += watch.lap();
    if (i == 0) {
      renderer.warm_up(views[i]);
      s.compile_s = watch.lap();
      baked.get();
      s.is_light_cached = parts_->light.is_cached;
      renderer.set_light(settings.ambient == Ambient::baked ? parts_->light
                                                            : simplified(parts_->light, settings.ambient));
      renderer.set_probes(parts_->probes);
      watch.lap();
    }
    Film film = draw_view(renderer, views[i], i, moment, settings, s);
    s.frame_s += watch.lap();
    take(i, std::move(film));
  }
  s.frames = settings.frames * static_cast<int>(views.size());
  s.programs = static_cast<int>(renderer.programs().count());
  s.triangles = renderer.scene().triangle_count();
  s.draws = renderer.scene().draws().size();
}

Film render(const Scene& scene, const Environment& environment, const View& view, const Settings& settings,
            Diagnostics& diagnostics, Statistics* statistics) {
  Film film;
  Session session;
  session.draw(
      scene, environment, {view}, settings, diagnostics, [&film](std::size_t, Film drawn) { film = std::move(drawn); },
      statistics);
  return film;
}

}  // namespace candela::raster
