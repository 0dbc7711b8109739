#include "candela/gap.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "candela/gap_parts.h"

namespace candela {

namespace {

std::size_t index_of(GapCause cause) { return static_cast<std::size_t>(cause); }

/// Of a work whose steps are not equally long.
class Steps {
 public:
  explicit Steps(const Job& whole) : whole_(whole) {}
  /// The next one, which takes about that share of the whole.
  Job step(double share, const std::string& what) {
    const double begin = done_;
    done_ += share;
    Job part{.progress = {}, .stop = whole_.stop, .diagnostics = whole_.diagnostics};
    part.progress = [this, begin, share, what](const Progress& p) {
      Progress told = p;
      told.fraction = std::clamp(begin + share * p.fraction, 0.0, 1.0);
      told.seconds = watch_.seconds();
      told.remaining_s =
          told.fraction > 0.0 ? std::optional(told.seconds * (1.0 - told.fraction) / told.fraction) : std::nullopt;
      told.what = p.what.empty() ? what : what + ", " + p.what;
      whole_.report(told);
    };
    return part;
  }

 private:
  const Job& whole_;
  Stopwatch watch_;
  double done_ = 0.0;
};

struct Half {
  Film truth;
  path::DirectLight direct;
};

bool has_occlusion(const Scene& scene, const raster::Settings& settings) {
  return settings.occlusion_radius > 0.0f ||
         std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& m) { return m.occlusion_texture && m.occlusion_strength > 0.0f; });
}

bool has_glowing(const Scene& scene) {
  return std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& m) { return !m.unlit && max_component(m.emission) > 0.0f; });
}

bool has_lamps(const Scene& scene, const Environment& environment) {
  return !environment.suns.empty() ||
         std::any_of(scene.nodes.begin(), scene.nodes.end(), [](const Node& n) { return n.light >= 0; });
}

std::shared_ptr<const Scene> changed(const Scene& scene, void (*change)(Material&)) {
  auto other = std::make_shared<Scene>(scene);
  for (Material& material : other->materials) change(material);
  return other;
}

GapCause kind_of(const Material& m) {
  if (m.unlit) return GapCause::rest;
  const bool scatters = max_component(m.multiscatter_color) > 0.0f || m.sheet_scatter > 0.0f;
  if (scatters && (m.transmission > 0.0f || m.diffuse_transmission > 0.0f || m.thickness > 0.0f)) {
    return GapCause::scattering;
  }
  return m.transmission > 0.0f ? GapCause::glass : GapCause::rest;
}

/// 0 of a picture that was not made.
vec3 pixel_or_black(const Image& image, std::size_t i) { return image.empty() ? vec3(0.0f) : pixel_of(image, i); }

/// One view by both engines, and what comes of it.
class ViewMeasure {
 public:
  ViewMeasure(GapScene of, const GapSettings& settings, raster::Drawer& drawer, raster::Settings frame_settings,
              path::Settings truth_settings)
      : of_(std::move(of)),
        settings_(settings),
        drawer_(drawer),
        frame_settings_(std::move(frame_settings)),
        truth_settings_(std::move(truth_settings)) {}

  ViewGap run(const Job& job) {
    Steps steps(job);
    ViewGap gap;
    gap.frame = draw_one(steps.step(0.02, "frame"));
    trace(steps);
    draw_parts(steps);
    gap.truth = mean_truth();
    return gap;
  }

  void judge(ViewGap& gap, const Job& job);

 private:
  Film draw_one(const Job& job) {
    Film film = drawer_.render(of_.view, frame_settings_, job);
    film.metadata["engine"] = "raster";
    return film;
  }
  void trace(Steps& steps);
  void draw_parts(Steps& steps);
  Film mean_truth() const;
  void find_pixels(const ViewGap& gap);
  vec3 error_of(GapCause cause, const ViewGap& gap, const Half& half, std::size_t i) const;
  void find_causes(ViewGap& gap, const GapErrors& errors);
  Image frames(raster::Settings settings, const Job& job) const;

  GapScene of_;
  const GapSettings& settings_;
  raster::Drawer& drawer_;
  raster::Settings frame_settings_;
  path::Settings truth_settings_;
  std::array<Half, kHalves> halves_;
  DrawnParts drawn_;
  std::vector<int> materials_;
  std::vector<GapPixel> pixels_;
  GapParts parts_;  ///< of the error of each pixel
};

void ViewMeasure::trace(Steps& steps) {
  for (std::size_t h = 0; h < kHalves; ++h) {
    path::Settings settings = truth_settings_;
    settings.samples = std::max(settings_.samples / 2, 1);
    settings.seed = truth_settings_.seed + static_cast<std::uint32_t>(h);
    const std::string what = h == 0 ? "truth" : "truth again";
    halves_[h].truth = trace_half(of_.tracer, of_.view, settings, steps.step(0.32, what));
    settings.samples = std::max(settings.samples / 2, 1);
    halves_[h].direct = path::trace_direct_light(of_.tracer, of_.view, settings, steps.step(0.08, what));
  }
}

Image ViewMeasure::frames(raster::Settings settings, const Job& job) const {
  settings.frames = settings_.frames;
  settings.layers.clear();
  raster::Statistics statistics;
  Film film = drawer_.render(of_.view, settings, job, &statistics);
  if (statistics.interrupted) throw Interrupted("the comparison is not complete");
  return std::move(film.beauty);
}

/// What the frame shows, converged and in parts.
void ViewMeasure::draw_parts(Steps& steps) {
  constexpr double kShare = 0.03;
  const auto with = [&](raster::Quantity quantity) {
    raster::Settings settings = frame_settings_;
    settings.quantity = quantity;
    return settings;
  };
  const Scene& scene = *of_.scene;
  drawn_.many = frames(frame_settings_, steps.step(kShare, "many frames"));
  drawn_.ambient = frames(with(raster::Quantity::ambient), steps.step(kShare, "light from far away"));
  const bool glows = has_glowing(scene), shines = has_lamps(scene, of_.environment);
  if (glows || shines) {
    raster::Settings direct = with(raster::Quantity::direct);
    drawn_.direct = frames(direct, steps.step(kShare, "lamps"));
    direct.has_shadows = false;
    drawn_.unshadowed = frames(direct, steps.step(kShare, "lamps without shadows"));
    if (glows && shines) {
      drawer_.set_scene(changed(scene, [](Material& m) { m.emission = vec3(0.0f); }));
      drawn_.lamps_alone = frames(direct, steps.step(kShare, "lamps alone"));
      drawer_.set_scene(of_.scene);
    }
  }
  if (has_occlusion(scene, frame_settings_) && of_.shot.probes == 0) {
    raster::Settings open = with(raster::Quantity::ambient);
    open.occlusion_radius = 0.0f;
    drawer_.set_scene(changed(scene, [](Material& m) { m.occlusion_strength = 0.0f; }));
    drawn_.open = frames(open, steps.step(kShare, "without occlusion"));
    drawer_.set_scene(of_.scene);
  }
}

Film ViewMeasure::mean_truth() const {
  Film mean;
  for (const Half& half : halves_) accumulate(half.truth, 1.0f / kHalves, mean);
  return mean;
}

/// At the edge of glass a pixel shows glass in part.
void ViewMeasure::find_pixels(const ViewGap& gap) {
  const Scene& scene = *of_.scene;
  const int w = gap.truth.width(), h = gap.truth.height();
  materials_ = materials_seen(scene, halves_[0].truth);
  pixels_ = weighted_pixels(gap.truth.beauty, *gap.develop.exposure);
  std::vector<GapCause> kinds;
  kinds.reserve(scene.materials.size());
  for (const Material& m : scene.materials) kinds.push_back(kind_of(m));
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      GapPixel& pixel = pixels_[static_cast<std::size_t>(y * w + x)];
      for (int j = std::max(y - 1, 0); j <= std::min(y + 1, h - 1); ++j) {
        for (int i = std::max(x - 1, 0); i <= std::min(x + 1, w - 1); ++i) {
          const int material = materials_[static_cast<std::size_t>(j * w + i)];
          if (material < 0 || kinds[static_cast<std::size_t>(material)] == GapCause::rest) continue;
          pixel.kind = kinds[static_cast<std::size_t>(material)];
        }
      }
    }
  }
}

/// What an approximation adds to a pixel of the frame. All add up to frame - truth, of either half: each is what is
/// drawn less what is traced, and what one takes away another has.
vec3 ViewMeasure::error_of(GapCause cause, const ViewGap& gap, const Half& half, std::size_t i) const {
  const vec3 many = pixel_of(drawn_.many, i), truth = pixel_of(half.truth.beauty, i);
  if (cause == GapCause::sampling) return pixel_of(gap.frame.beauty, i) - many;
  if (!pixels_[i].is_plain()) return cause == pixels_[i].kind ? many - truth : vec3(0.0f);

  const path::DirectLight& exact = half.direct;
  const vec3 ambient = pixel_of(drawn_.ambient, i), direct = pixel_or_black(drawn_.direct, i);
  const vec3 lamps = pixel_of(exact.lamps.arriving, i), areas = pixel_of(exact.areas.arriving, i);
  const vec3 seen = pixel_of(exact.seen, i);
  switch (cause) {
    case GapCause::rest:
      return many - ambient - direct - seen;
    case GapCause::lamps:
    case GapCause::areas: {
      const bool is_lamp = cause == GapCause::lamps;
      const vec3 unhindered = pixel_of(is_lamp ? exact.lamps.unhindered : exact.areas.unhindered, i);
      if (drawn_.unshadowed.empty()) return -unhindered;
      vec3 drawn = pixel_of(drawn_.unshadowed, i);
      if (!drawn_.lamps_alone.empty()) {
        const vec3 alone = pixel_of(drawn_.lamps_alone, i);
        drawn = is_lamp ? alone : drawn - alone;
      } else if (is_lamp != has_lamps(*of_.scene, of_.environment)) {
        drawn = vec3(0.0f);
      }
      return drawn - unhindered;
    }
    case GapCause::shadows: {
      const vec3 hidden = pixel_of(exact.lamps.unhindered, i) + pixel_of(exact.areas.unhindered, i) - lamps - areas;
      return direct - pixel_or_black(drawn_.unshadowed, i) + hidden;
    }
    default:
      break;
  }
  if (of_.shot.probes > 0) return cause == GapCause::probes ? ambient - (truth - seen - lamps - areas) : vec3(0.0f);
  const vec3 far = pixel_of(exact.far.arriving, i), far_open = pixel_of(exact.far.unhindered, i);
  const vec3 open = pixel_of(drawn_.without_occlusion(), i);
  switch (cause) {
    case GapCause::far_light:
      return open - far_open;
    case GapCause::occlusion:
      return ambient - open + far_open - far;
    case GapCause::between:
      return far + lamps + areas + seen - truth;
    default:
      return vec3(0.0f);
  }
}

/// Shares by covariance: half of the error with one half's noise times half with the other's, whose mean is that
/// without noise.
void ViewMeasure::find_causes(ViewGap& gap, const GapErrors& errors) {
  std::array<double, kCauses> shares{};
  double all = 0.0, noise = 0.0;
  std::array<dvec3, kCauses> sums{};
  dvec3 light(0.0);
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    const double w = pixels_[i].weight;
    all += w * dot(errors[0][i], errors[1][i]);
    const vec3 between = errors[0][i] - errors[1][i];
    noise += 0.25 * w * dot(between, between);
    light += dvec3(pixel_of(gap.truth.beauty, i));
    for (std::size_t k = 0; k < kCauses; ++k) {
      const vec3 a = parts_[0][i][k], b = parts_[1][i][k];
      shares[k] += 0.5 * w * (dot(a, errors[1][i]) + dot(b, errors[0][i]));
      sums[k] += 0.5 * (dvec3(a) + dvec3(b));
    }
  }
  constexpr double kLeast = 0.05;  // of the noise of the truth: below, shares would be chance
  if (!(all > kLeast * noise) || !(all > 0.0)) return;
  for (std::size_t k = 0; k < kCauses; ++k) {
    CauseGap cause{.cause = kGapCauses[k].cause,
                   .share = shares[k] / all,
                   .error = Image(gap.truth.width(), gap.truth.height(), 3)};
    bool is_there = false;
    Film without = gap.frame;
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      const vec3 error = 0.5f * (parts_[0][i][k] + parts_[1][i][k]);
      is_there = is_there || error != vec3(0.0f);
      for (std::size_t c = 0; c < 3; ++c) {
        cause.error.pixels[3 * i + c] = error[static_cast<int>(c)];
        float& pixel = without.beauty.pixels[4 * i + c];
        pixel = std::max(pixel - error[static_cast<int>(c)], 0.0f);
      }
    }
    if (!is_there) continue;
    cause.bias = vec3(sums[k] / glm::max(light, dvec3(1e-30)));
    cause.flip_without = compare_films(gap.truth, without, gap.develop).flip;
    gap.causes.push_back(std::move(cause));
  }
  std::stable_sort(gap.causes.begin(), gap.causes.end(),
                   [](const CauseGap& a, const CauseGap& b) { return std::abs(a.share) > std::abs(b.share); });
}

void ViewMeasure::judge(ViewGap& gap, const Job& job) {
  if (!gap.develop.exposure) gap.develop.exposure = metered_exposure(gap.truth);
  gap.difference = compare_films(gap.truth, gap.frame, gap.develop);
  gap.flip_noise = 0.5 * compare_films(halves_[0].truth, halves_[1].truth, gap.develop).flip;
  find_pixels(gap);
  GapErrors errors;
  for (std::size_t h = 0; h < kHalves; ++h) {
    parts_[h].resize(pixels_.size());
    errors[h].resize(pixels_.size());
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      errors[h][i] = pixel_of(gap.frame.beauty, i) - pixel_of(halves_[h].truth.beauty, i);
      for (const GapCauseInfo& info : kGapCauses) {
        parts_[h][i][index_of(info.cause)] = error_of(info.cause, gap, halves_[h], i);
      }
    }
  }
  find_causes(gap, errors);
  find_numbers(*of_.scene, pixels_, materials_, errors, parts_, gap);
  if (settings_.looks_for_suspects && of_.shot.probes == 0) {
    const auto draw = [&](const raster::Settings& settings) { return frames(settings, {.stop = job.stop}); };
    gap.suspects = find_suspects(of_, pixels_, drawn_, halves_[0].direct, frame_settings_, draw, job);
  }
}

}  // namespace

Shot truth_shot(Shot shot, const std::string& what) {
  path::check_built();
  if (shot.background != Background::environment || shot.ground || shot.background_color) {
    throw Error(what + " before the environment alone", "--background");
  }
  if (shot.shutter_s > 0.0) throw Error(what + " of one moment", "--shutter");
  if (shot.part || shot.pictures) throw Error(what + " of whole pictures", "--part");
  shot.engine = Engine::path;
  shot.denoiser.reset();
  shot.layers.clear();
  return shot;
}

Shot comparable(Shot shot, const GapSettings& settings) {
  if (settings.samples < 2) throw Error("the truth needs two samples, to know its noise", "--spp");
  return truth_shot(std::move(shot), "engines are compared");
}

void measure_gaps(const Shot& wished, const GapSettings& settings, const std::function<void(ViewGap)>& take,
                  const Job& job) {
  if (settings.frames < 1) throw Error("at least one frame is needed", "--frames");
  const Shot shot = comparable(wished, settings);
  raster::check_built();
  const auto stage = std::make_shared<Stage>();
  Take pictures(shot, job.diagnostics, stage);
  pictures.prepare();
  const std::vector<PictureLabel> labels = pictures.labels();
  DevelopSettings develop = pictures.develop();
  std::shared_ptr<const Scene> scene;
  std::unique_ptr<path::Tracer> tracer;
  std::unique_ptr<raster::Drawer> drawer;
  const JobParts parts(job, labels.size());
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const Job part = parts.part(i, labels.size() > 1 ? fmt::format("{} of {}, ", i + 1, labels.size()) : "");
    const std::shared_ptr<const Scene> next = pictures.scene(i);
    if (next != scene) {
      scene = next;
      drawer.reset();
      tracer.reset();
      tracer = std::make_unique<path::Tracer>(scene, pictures.environment(), shot.shading);
      drawer = std::make_unique<raster::Drawer>(scene, pictures.environment(), shot.shading, stage->device());
      constexpr int kProbeSamples = 64;
      if (shot.probes > 0) drawer->set_probes(bake_probes(*tracer, shot.probes, kProbeSamples, {.stop = job.stop}));
    }
    ViewMeasure measure({scene, pictures.environment(), shot, pictures.view(*scene, i), *tracer}, settings, *drawer,
                        drawn_settings(shot), traced_settings(shot));
    ViewGap gap = measure.run(part);
    gap.index = i;
    gap.label = labels[i];
    gap.develop = develop;
    gap.develop.dither = false;
    gap.develop.bloom = 0.0f;
    measure.judge(gap, part);
    develop.exposure = gap.develop.exposure;  // of a set the first one's
    take(std::move(gap));
  }
}

}  // namespace candela
