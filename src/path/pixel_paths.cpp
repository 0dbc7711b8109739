#include "path/pixel_paths.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "path/bodies.h"
#include "path/camera.h"
#include "path/integrator.h"
#include "path/pixel_filter.h"
#include "path/pixel_surface.h"
#include "path/surface_point.h"
#include "path/tracer_parts.h"
#include "scene/lamp.h"

namespace candela::path {

namespace {

constexpr std::uint32_t kChunk = 64;  ///< samples that one task follows

/// The punctual lights of a scene, to know one by the light that it sends somewhere.
class LampFinder {
 public:
  LampFinder(const Scene& scene, vec3 origin) {
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
      if (scene.nodes[i].light < 0) continue;
      lamps_.emplace_back(static_cast<int>(i), placed_lamp(scene, scene.nodes[i], origin));
    }
  }
  /// Its node. -1 = none of them would shine like that.
  int find(const LightSample& light, vec3 position) const {
    for (const auto& [node, lamp] : lamps_) {
      const ArrivingLight arriving = arriving_light(lamp, position);
      if (arriving.direction == light.direction && arriving.irradiance == light.radiance) return node;
    }
    return -1;
  }

 private:
  std::vector<std::pair<int, PlacedLamp>> lamps_;
};

bool is_brighter(const LightPath& a, const LightPath& b) {
  const float x = luminance(a.radiance), y = luminance(b.radiance);
  return x != y ? x > y : a.sample < b.sample;
}

/// What several samples bring.
struct PixelSums {
  dvec3 sum{0.0}, squares{0.0};
  std::map<LightSource, std::pair<dvec3, dvec3>> sources;
  std::vector<dvec3> turns;
  std::vector<LightPath> brightest;
  std::uint64_t non_finite = 0;

  void add(const PixelSums& other, std::size_t paths) {
    sum += other.sum;
    squares += other.squares;
    for (const auto& [source, light] : other.sources) {
      auto& [straight, indirect] = sources[source];
      straight += light.first;
      indirect += light.second;
    }
    turns.resize(std::max(turns.size(), other.turns.size()), dvec3(0.0));
    for (std::size_t i = 0; i < other.turns.size(); ++i) turns[i] += other.turns[i];
    keep(other.brightest, paths);
    non_finite += other.non_finite;
  }
  void keep(const std::vector<LightPath>& more, std::size_t paths) {
    brightest.insert(brightest.end(), more.begin(), more.end());
    std::stable_sort(brightest.begin(), brightest.end(), is_brighter);
    brightest.resize(std::min(brightest.size(), paths));
  }
};

/// Writes down one path: where it goes, and every light that it finds on its way.
class Recorder : public PathListener {
 public:
  Recorder(const PathContext& context, const LampFinder& lamps) : context_(context), lamps_(lamps) {}

  void meet(const Hit& hit, const SurfacePoint& point) override {
    const Placement& placement = context_.geometry.placement(hit.placement);
    vertices_.push_back({PathEvent::ended, point.position, point.frame.n, placement.node, placement.primitive});
  }
  void turn(const shade::SurfaceSample& next) override {
    vertices_.back().event = next.is_straight   ? PathEvent::passed
                             : next.wi.z < 0.0f ? PathEvent::let_through
                                                : PathEvent::reflected;
  }
  void scatter(vec3 position) override { vertices_.push_back({PathEvent::scattered, position}); }
  void look_for(const LightSample& lamp) override { lamp_ = lamp; }
  void find_lamp(vec3 light) override {
    if (is_dark(light)) return;
    LightPath& path = found_.emplace_back();
    path.vertices = vertices_;
    PathVertex& last = path.vertices.back();
    last.event = glm::dot(last.normal, lamp_.direction) > 0.0f ? PathEvent::reflected : PathEvent::let_through;
    path.source = source_of(lamp_, last.position);
    path.direction = lamp_.direction;
    path.radiance = light;
    path.is_looked_for = true;
  }
  void find_glow(vec3 light) override {
    if (is_dark(light)) return;
    LightPath& path = found_.emplace_back();
    path.vertices = vertices_;
    path.source = {LightKind::surface, vertices_.back().node, vertices_.back().primitive};
    path.radiance = light;
  }
  void find_sky(vec3 direction, vec3 light) override {
    if (is_dark(light)) return;
    LightPath& path = found_.emplace_back();
    path.vertices = vertices_;
    path.direction = direction;
    path.source = sky_in(direction);
    path.radiance = light;
  }

  /// All of a sample, which is then forgotten.
  std::vector<LightPath> take() {
    vertices_.clear();
    return std::exchange(found_, {});
  }

 private:
  static bool is_dark(vec3 light) { return light == vec3(0.0f); }
  LightSource sky_in(vec3 direction) const {
    const auto& suns = context_.lights.environment().suns();
    for (std::size_t i = 0; i < suns.size(); ++i) {
      if (suns[i].contains(direction)) return {LightKind::sun, static_cast<int>(i)};
    }
    return {LightKind::sky};
  }
  LightSource source_of(const LightSample& light, vec3 position) const {
    if (light.is_map) return {LightKind::sky};
    if (light.is_environment()) return sky_in(light.direction);
    if (light.is_delta) return {LightKind::lamp, lamps_.find(light, position)};
    // A lamp's target is just before its surface.
    const Hit hit = context_.geometry.intersect({.origin = light.target, .direction = light.direction}, 0);
    if (!hit) return {LightKind::surface};
    const Placement& placement = context_.geometry.placement(hit.placement);
    return {LightKind::surface, placement.node, placement.primitive};
  }

  const PathContext& context_;
  const LampFinder& lamps_;
  std::vector<PathVertex> vertices_;
  LightSample lamp_;
  std::vector<LightPath> found_;
};

std::size_t turns_of(const LightPath& path) {
  return static_cast<std::size_t>(std::count_if(
      path.vertices.begin(), path.vertices.end(),
      [](const PathVertex& vertex) { return vertex.event != PathEvent::passed && vertex.event != PathEvent::ended; }));
}

void add_sample(std::vector<LightPath> found, vec3 radiance, float weight, std::uint32_t number, std::size_t paths,
                PixelSums& sums) {
  radiance *= weight;
  if (!std::isfinite(radiance.x + radiance.y + radiance.z)) {
    ++sums.non_finite;
    return;
  }
  sums.sum += dvec3(radiance);
  sums.squares += dvec3(radiance) * dvec3(radiance);
  for (LightPath& path : found) {
    path.radiance *= weight;
    path.sample = number;
    const std::size_t turns = turns_of(path);
    if (sums.turns.size() <= turns) sums.turns.resize(turns + 1, dvec3(0.0));
    sums.turns[turns] += dvec3(path.radiance);
    auto& [straight, indirect] = sums.sources[path.source];
    (turns < 2 ? straight : indirect) += dvec3(path.radiance);
  }
  sums.keep(found, paths);
}

}  // namespace

PixelEstimate trace_pixel(const Tracer& tracer, const View& view, const Settings& settings, ivec2 pixel,
                          const PixelPathSettings& kept, const Job& job) {
  check(settings, view);
  check_pixel(pixel, {settings.width, settings.height});
  const Tracer::Parts& parts = *tracer.parts_;
  if (parts.geometry.ground() != nullptr) throw Error("pixels are explained of scenes without a ground", "--ground");
  const vec3 origin = parts.geometry.origin();
  const Camera camera(relative(view, origin), settings.width, settings.height);
  PathContext context{.geometry = parts.geometry,
                      .lights = parts.lights,
                      .bounces = settings.bounces,
                      .has_media = parts.geometry.has_media()};
  find_start(camera, context);
  const PixelFilterSampler filter(settings.filter, settings.filter_radius);
  const LampFinder lamps(*parts.scene, origin);
  const auto first = static_cast<std::uint32_t>(settings.first_sample);
  const auto last = static_cast<std::uint32_t>(settings.samples);
  std::vector<PixelSums> chunks((last - first + kChunk - 1) / kChunk);
  const auto trace_chunk = [&](std::size_t chunk) {
    Recorder recorder(context, lamps);
    RayCounts counts;
    const std::uint32_t begin = first + static_cast<std::uint32_t>(chunk) * kChunk;
    for (std::uint32_t s = begin; s < std::min(begin + kChunk, last); ++s) {
      SobolSampler sampler(pixel_seed(settings.seed, pixel.x, pixel.y), s);
      const vec2 film = vec2(pixel) + 0.5f + filter.sample(sampler.next_2d());
      const vec2 u_lens = camera.has_lens() ? sampler.next_2d() : vec2(0.5f);
      const Camera::Sample ray = camera.generate(film, u_lens);
      const Hit hit = parts.geometry.intersect(ray.ray, sampler.next_hash());
      const PathSample sample = trace_heard_path(context, ray.ray, hit, sampler, counts, recorder);
      add_sample(recorder.take(), sample.radiance, ray.weight, s, kept.paths, chunks[chunk]);
    }
  };
  constexpr std::size_t kStep = 64;  // chunks between two looks at the clock
  const Stopwatch watch;
  for (std::size_t begin = 0; begin < chunks.size(); begin += kStep) {
    if (job.is_stopped()) throw Interrupted("the paths of the pixel are not all traced");
    const std::size_t end = std::min(begin + kStep, chunks.size());
    parallel_for(begin, end, 1, [&](std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i) trace_chunk(i);
    });
    job.report({.fraction = static_cast<double>(end) / static_cast<double>(chunks.size()),
                .seconds = watch.seconds(),
                .what = "paths"});
  }

  PixelSums sums;
  for (const PixelSums& chunk : chunks) sums.add(chunk, kept.paths);
  PixelEstimate estimate;
  estimate.non_finite = sums.non_finite;
  const auto count = static_cast<double>(last - first) - static_cast<double>(sums.non_finite);
  estimate.samples = static_cast<int>(count);
  if (count < 1.0) return estimate;
  const dvec3 mean = sums.sum / count;
  estimate.mean = vec3(mean);
  const dvec3 variance =
      glm::max(sums.squares / count - mean * mean, dvec3(0.0)) * (count / std::max(count - 1.0, 1.0));
  estimate.error = count > 1.0 ? vec3(glm::sqrt(variance / count)) : vec3(std::numeric_limits<float>::infinity());
  for (const auto& [source, light] : sums.sources) {
    estimate.sources.push_back({source, vec3(light.first / count), vec3(light.second / count)});
  }
  std::stable_sort(estimate.sources.begin(), estimate.sources.end(), [](const SourceLight& a, const SourceLight& b) {
    return luminance(a.straight + a.indirect) > luminance(b.straight + b.indirect);
  });
  for (const dvec3& light : sums.turns) estimate.turns.emplace_back(light / count);
  estimate.brightest = std::move(sums.brightest);
  for (LightPath& path : estimate.brightest) {
    path.radiance /= static_cast<float>(count);
    for (PathVertex& vertex : path.vertices) vertex.position += origin;
  }
  return estimate;
}

}  // namespace candela::path
