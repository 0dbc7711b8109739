#include "candela/explain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "candela/gap_parts.h"
#include "ibl/cube.h"
#include "ibl/sh.h"
#include "scene/material_table.h"
#include "scene/surface_layers.h"
#include "shade/image_light.glsl.h"

namespace candela {

namespace {

template <class Owner>
vec3 value_of(const NumberOrColor<Owner>& member, const Owner& owner) {
  return member.is_color() ? owner.*member.color : vec3(owner.*member.number);
}

std::vector<PropertyValue> find_properties(const Scene& scene, const path::PixelSurface& surface) {
  std::vector<PropertyValue> values;
  const Material plain;
  const int index = material_of(scene, surface.where);
  const Material& material = index < 0 ? plain : scene.materials[static_cast<std::size_t>(index)];
  for (const MaterialProperty& row : kMaterialProperties) {
    PropertyValue value{row.name, row.member.size()};
    value.has_texture = row.texture && material.*row.texture.slot;
    value.factor = value.value = value_of(row.member, material);
    if (row.param && !surface.is_unlit && (row.lobe.bit == 0 || (surface.params.lobes & row.lobe.bit) != 0)) {
      value.value = value_of(row.param, surface.params);
    }
    if (row.member == NumberOrColor<Material>(&Material::emission) && surface.emission != vec3(0.0f)) {
      value.value = surface.emission;
    }
    const bool is_base = row.name == "base_color" || row.name == "metallic" || row.name == "roughness";
    if (is_base || value.value != value_of(row.member, plain)) values.push_back(value);
  }
  return values;
}

// ----- light from far away, as the frame reads it

vec3 lookup(const Cubemap& cube, vec3 direction, float level) {
  const auto below = static_cast<std::size_t>(level);
  const std::size_t above = std::min(below + 1, cube.levels.size() - 1);
  return glm::mix(ibl::cube_lookup(cube.levels[below], direction), ibl::cube_lookup(cube.levels[above], direction),
                  level - static_cast<float>(below));
}

/// The rasterizer's light, and what of it a surface reads: mesh_far_light.glsl without what is in the way.
class FarReader {
 public:
  FarReader(const Scene& scene, const Environment& environment, const raster::Settings& settings)
      : light_(raster::simplified(raster::bake_light(environment, raster::uses_sheen(scene), settings.cache),
                                  settings.ambient)) {
    Environment without = environment;
    without.suns.clear();
    harmonics_ = ibl::sh_irradiance(ibl::sh_project(ibl::make_source(without), 2));
  }

  FarTerms read(const path::PixelSurface& p) const {
    FarTerms far;
    const vec3 n = p.frame.n;
    far.levels = static_cast<int>(light_.specular.levels.size());
    far.harmonics = harmonics_.coefficients;
    far.irradiance = ibl::cube_lookup(light_.irradiance, n);
    far.harmonics_irradiance = vec3(ibl::sh_evaluate(harmonics_, n));
    if (p.is_unlit) return far;
    const shade::Surface& s = p.surface;
    add(far, {"diffuse", n, 1.0f, 0.0f, far.irradiance / kPi, p.shares.diffuse});
    add(far, {"spread", n, 1.0f, 0.0f, far.irradiance / kPi, p.shares.spread});
    const vec3 specular = p.shares.specular + p.shares.glass;
    if ((s.lobes & shade::kLobeAnisotropy) != 0) {
      add_streaked(far, "specular", p, p.frame, vec2(s.alpha_x, s.alpha_y), p.shares.rise, specular);
    } else {
      add_mirrored(far, "specular", p, n, s.alpha, p.shares.rise, specular);
    }
    add(far, {"below", -n, 1.0f, 0.0f, ibl::cube_lookup(light_.irradiance, -n) / kPi, p.shares.below});
    if (!light_.sheen.empty()) {
      const float alpha = shade::roughness_to_alpha(s.sheen_roughness);
      const float level = shade::image_light_level(alpha, static_cast<float>(light_.sheen.levels.size()));
      add(far, {"sheen", n, alpha, level, lookup(light_.sheen, n, level), p.shares.sheen});
    }
    if ((s.lobes & shade::kLobeClearcoat) != 0) {
      const vec3 coat = glm::normalize(p.frame.to_world(s.coat_normal));
      if ((s.lobes & shade::kLobeCoatAnisotropy) != 0) {
        const vec3 along = p.frame.to_world(s.coat_tangent);
        const Frame frame{along, glm::cross(coat, along), coat};
        add_streaked(far, "coat", p, frame, s.coat_widths, p.shares.coat_rise, p.shares.coat);
      } else {
        add_mirrored(far, "coat", p, coat, s.coat_alpha, p.shares.coat_rise, p.shares.coat);
      }
    }
    return far;
  }

 private:
  static void add(FarTerms& far, FarLookup lookup) {
    if (lookup.share == vec3(0.0f)) return;
    lookup.light = lookup.share * lookup.radiance;
    far.lookups.push_back(lookup);
  }
  void add_mirrored(FarTerms& far, std::string_view lobe, const path::PixelSurface& p, vec3 n, float alpha, float rise,
                    vec3 share) const {
    const vec3 mirrored = 2.0f * glm::dot(n, p.to_eye) * n - p.to_eye;
    const shade::ImageLightLookup at = shade::image_light_lookup(n, mirrored, alpha, rise);
    add_specular(far, lobe, at.direction, at.alpha, share * shade::image_light_horizon(mirrored, p.geometric_normal));
  }
  void add_streaked(FarTerms& far, std::string_view lobe, const path::PixelSurface& p, const Frame& frame, vec2 widths,
                    float rise, vec3 share) const {
    std::array<shade::ImageLightLookup, shade::kStreakLookups> lookups;
    const vec3 wo = frame.to_local(p.to_eye);
    float sum = 0.0f;
    for (int i = 0; i < shade::kStreakLookups; ++i) {
      lookups[static_cast<std::size_t>(i)] = shade::image_light_streak(wo, widths, rise, i);
      sum += lookups[static_cast<std::size_t>(i)].weight;
    }
    if (sum <= 0.0f) return add_mirrored(far, lobe, p, frame.n, widths.y, rise, share);
    for (const shade::ImageLightLookup& at : lookups) {
      const vec3 direction = frame.to_world(at.direction);
      const float horizon = shade::image_light_horizon(direction, p.geometric_normal);
      add_specular(far, lobe, direction, at.alpha, share * (at.weight / sum * horizon));
    }
  }
  void add_specular(FarTerms& far, std::string_view lobe, vec3 direction, float alpha, vec3 share) const {
    const float level = shade::image_light_level(alpha, static_cast<float>(far.levels));
    add(far, {lobe, direction, alpha, level, lookup(light_.specular, direction, level), share});
  }

  raster::BakedLight light_;
  ibl::Sh harmonics_;
};

// ----- the frame

constexpr int kMostLampsDrawn = 16;  ///< one after the other; of more, the strongest

/// Draws the frame and its parts, whole, and reads the pixels.
class FrameExplainer {
 public:
  FrameExplainer(std::shared_ptr<const Scene> scene, const Environment& environment, const Shot& shot,
                 const path::Tracer& tracer, std::shared_ptr<raster::Device> device, const Job& job)
      : scene_(std::move(scene)),
        environment_(environment),
        settings_(drawn_settings(shot)),
        drawer_(scene_, environment, shot.shading, std::move(device)),
        has_probes_(shot.probes > 0),
        job_(job) {
    constexpr int kProbeSamples = 64;
    if (has_probes_) drawer_.set_probes(bake_probes(tracer, shot.probes, kProbeSamples, {.stop = job.stop}));
  }

  Film draw(const View& view, std::vector<PixelExplanation>& pixels) {
    using raster::Quantity;
    Film film = draw_one(view, Quantity::light, 0, "frame");
    for (PixelExplanation& p : pixels) p.frame.emplace().radiance = film.beauty.rgb(p.pixel.x, p.pixel.y);
    for (const Quantity quantity : {Quantity::diffuse, Quantity::specular, Quantity::coat, Quantity::sheen,
                                    Quantity::transmission, Quantity::direct, Quantity::emission}) {
      if (!may_show(quantity)) continue;
      draw_part(view, quantity, -1, pixels);
    }
    const int lamps = count_lamps();
    for (int i = 0; lamps > 1 && i < std::min(lamps, kMostLampsDrawn); ++i) {
      draw_part(view, Quantity::one_light, i, pixels);
    }
    if (!has_probes_ && settings_.ambient != raster::Ambient::none && raster::is_lit_from_far(environment_)) {
      const FarReader reader(*scene_, environment_, settings_);
      for (PixelExplanation& p : pixels) {
        if (p.surface) p.frame->far = reader.read(*p.surface);
      }
    }
    return film;
  }

 private:
  bool may_show(raster::Quantity quantity) const {
    const auto some = [&](auto is) { return std::any_of(scene_->materials.begin(), scene_->materials.end(), is); };
    switch (quantity) {
      case raster::Quantity::coat:
        return some([](const Material& m) { return m.clearcoat > 0.0f; });
      case raster::Quantity::sheen:
        return raster::uses_sheen(*scene_) || some([](const Material& m) { return m.fuzz > 0.0f; });
      case raster::Quantity::transmission:
        return some([](const Material& m) { return m.transmission > 0.0f; });
      default:
        return true;
    }
  }
  void draw_part(const View& view, raster::Quantity quantity, int light, std::vector<PixelExplanation>& pixels) {
    const std::string name(raster::quantity_name(quantity));
    const Film part = draw_one(view, quantity, std::max(light, 0), name);
    for (PixelExplanation& p : pixels) {
      const vec3 radiance = part.beauty.rgb(p.pixel.x, p.pixel.y);
      if (radiance != vec3(0.0f)) p.frame->terms.push_back({quantity, light, radiance});
    }
  }
  Film draw_one(const View& view, raster::Quantity quantity, int light, const std::string& what) {
    raster::Settings settings = settings_;
    settings.quantity = quantity;
    settings.shown_light = light;
    raster::Statistics statistics;
    job_.report({.fraction = 0.0, .what = what});
    Film film = drawer_.render(view, settings, {.stop = job_.stop, .diagnostics = job_.diagnostics}, &statistics);
    if (statistics.interrupted || job_.is_stopped()) throw Interrupted("the frame is not complete");
    return film;
  }
  int count_lamps() const {
    const auto lamps =
        std::count_if(scene_->nodes.begin(), scene_->nodes.end(), [](const Node& node) { return node.light >= 0; });
    return static_cast<int>(lamps) + static_cast<int>(environment_.suns.size());
  }

  std::shared_ptr<const Scene> scene_;
  const Environment& environment_;
  raster::Settings settings_;
  raster::Drawer drawer_;
  bool has_probes_;
  const Job& job_;
};

/// A picture to find the pixels in, where there is no frame.
Film sketch(const path::Tracer& tracer, const View& view, path::Settings settings, const Job& job) {
  constexpr int kSketchSamples = 16;
  settings.samples = kSketchSamples;
  path::Statistics statistics;
  Film film = tracer.render(view, settings, job, &statistics);
  if (statistics.interrupted) throw Interrupted("the picture is not complete");
  return film;
}

}  // namespace

std::vector<LobeCut> cut_lobes(const path::PixelSurface& p) {
  std::vector<LobeCut> cuts;
  if (p.is_unlit) return cuts;
  const vec2 away = -vec2(p.wo);
  const float length = glm::length(away);
  const vec2 x = length > 1e-6f ? away / length : vec2(1.0f, 0.0f);
  using Part = vec3 shade::LobeParts::*;
  struct Row {
    std::string_view name;
    Part part;
    bool is_below;
  };
  constexpr auto kRows = std::to_array<Row>({{"specular", &shade::LobeParts::specular, false},
                                             {"diffuse", &shade::LobeParts::diffuse, false},
                                             {"sheen", &shade::LobeParts::sheen, false},
                                             {"coat", &shade::LobeParts::coat, false},
                                             {"below", &shade::LobeParts::below, true},
                                             {"through", &shade::LobeParts::through, true}});
  constexpr int kSteps = 720;
  for (const bool is_below : {false, true}) {
    std::vector<LobeCut> lobes;
    for (const Row& row : kRows) {
      if (row.is_below == is_below) lobes.push_back({row.name, is_below, {}});
    }
    for (int i = 1; i < kSteps; ++i) {
      const float degrees = -90.0f + 180.0f * static_cast<float>(i) / kSteps;
      const float angle = radians(degrees);
      const vec3 wi(x * std::sin(angle), is_below ? -std::cos(angle) : std::cos(angle));
      const shade::LobeParts parts = shade::surface_parts(p.surface, p.wo, wi);
      std::size_t k = 0;
      for (const Row& row : kRows) {
        if (row.is_below != is_below) continue;
        lobes[k++].points.emplace_back(degrees, std::max(luminance(parts.*row.part), 0.0f));
      }
    }
    for (LobeCut& lobe : lobes) {
      const bool is_there = std::any_of(lobe.points.begin(), lobe.points.end(), [](dvec2 at) { return at.y > 1e-6; });
      if (is_there) cuts.push_back(std::move(lobe));
    }
  }
  return cuts;
}

PixelExplanation explain_pixel(const path::Tracer& tracer, const View& view, const path::Settings& settings,
                               ivec2 pixel, std::size_t paths, const Job& job) {
  PixelExplanation p;
  p.pixel = pixel;
  p.surface = path::find_pixel_surface(tracer, view, {settings.width, settings.height}, pixel);
  if (p.surface) p.properties = find_properties(tracer.scene(), *p.surface);
  p.truth = path::trace_pixel(tracer, view, settings, pixel, {paths}, job);
  return p;
}

Explanation explain(const Shot& wished, const ExplainSettings& settings, const Job& job) {
  if (settings.pixels.empty()) throw Error("which pixel?", "--pixel");
  if (settings.samples < 2) throw Error("a confidence needs two samples", "--spp");
  if (wished.has_many_pictures()) throw Error("pixels are explained of one picture", wished.scene);
  for (const ivec2 pixel : settings.pixels) path::check_pixel(pixel, wished.size);
  const Shot shot = truth_shot(wished, "pixels are explained");
  if (settings.has_frame) raster::check_built();
  const auto stage = std::make_shared<Stage>();
  Take pictures(shot, job.diagnostics, stage);
  pictures.prepare();
  Explanation explanation;
  explanation.size = shot.size;
  explanation.scene = pictures.scene(0);
  explanation.view = pictures.view(*explanation.scene, 0);
  explanation.develop = pictures.develop();
  const path::Tracer tracer(explanation.scene, pictures.environment(), shot.shading);
  path::Settings traced = traced_settings(shot);
  traced.samples = settings.samples;
  const JobParts parts(job, settings.pixels.size() + 1);
  for (std::size_t i = 0; i < settings.pixels.size(); ++i) {
    explanation.pixels.push_back(
        explain_pixel(tracer, explanation.view, traced, settings.pixels[i], settings.paths, parts.part(i)));
  }
  const Job last = parts.part(settings.pixels.size());
  if (settings.has_frame) {
    FrameExplainer frame(explanation.scene, pictures.environment(), shot, tracer, stage->device(), last);
    explanation.picture = frame.draw(explanation.view, explanation.pixels);
  } else {
    explanation.picture = sketch(tracer, explanation.view, traced, last);
  }
  if (!explanation.develop.exposure) explanation.develop.exposure = metered_exposure(explanation.picture);
  return explanation;
}

}  // namespace candela
