#include "cli/explain_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "cli/explain_words.h"
#include "cli/json_text.h"
#include "raster/quantity.h"
#include "scene/surface_layers.h"

namespace candela::cli {

using Json = nlohmann::ordered_json;

namespace {

/// Blocks of lines, each behind a word.
class Lines {
 public:
  void add(const std::string& word, const std::string& text) {
    text_ += fmt::format("{:<10} {}\n", word == last_ ? "" : word, text);
    last_ = word;
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_, last_;
};

void add_surface(const Explanation& e, const PixelExplanation& p, Lines& lines) {
  if (!p.surface) {
    lines.add("surface", "none: the middle of the pixel sees the environment");
    return;
  }
  const path::PixelSurface& s = *p.surface;
  lines.add("surface", surface_words(*e.scene, s));
  lines.add("surface", fmt::format("at {} m, {:.4g} m from the eye; {}; uv {:.4g} {:.4g}", vec_words(s.where.position),
                                   s.distance, s.is_back ? "its back" : "its front", s.where.uv.x, s.where.uv.y));
  lines.add("surface",
            fmt::format("normal {}, {:.1f}° from the eye; of the facet {}, of the vertices {}", vec_words(s.frame.n),
                        angle_deg(s.wo.z), vec_words(s.geometric_normal), vec_words(s.smooth_normal)));
  if (s.emission != vec3(0.0f)) lines.add("surface", "sends out " + vec_words(s.emission));
  for (const PropertyValue& value : p.properties) {
    lines.add("material",
              fmt::format("{:<26} {:<24} {}", value.name, property_words(value, value.value), property_origin(value)));
  }
  if (s.is_unlit) return;
  for (const auto& [name, share] : shares_of(s)) lines.add("albedo", fmt::format("{:<10} {}", name, vec_words(share)));
  lines.add("facets", facets_words(s));
  for (const path::LampTerms& lamp : s.lamps) {
    lines.add("lights", lamp_name(*e.scene, lamp) + ": " + lamp_words(lamp));
    if (lamp.radiance != vec3(0.0f)) lines.add("lights", "  " + lamp_terms_words(lamp));
  }
}

void add_frame(const PixelExplanation& p, Lines& lines) {
  if (!p.frame) return;
  const FrameTerms& frame = *p.frame;
  lines.add("frame", vec_words(frame.radiance) + ratio_words(frame.radiance, p.truth));
  for (const FrameTerm& term : frame.terms) {
    lines.add("frame", fmt::format("  {:<14} {}", frame_term_name(term), vec_words(term.radiance)));
  }
  if (!frame.far) return;
  for (const FarLookup& read : frame.far->lookups) lines.add("reads", lookup_words(read, frame.far->levels));
  lines.add("reads", fmt::format("irradiance {}; by nine harmonics {}", vec_words(frame.far->irradiance),
                                 vec_words(frame.far->harmonics_irradiance)));
}

void add_truth(const Explanation& e, const PixelExplanation& p, Lines& lines) {
  const path::PixelEstimate& truth = p.truth;
  lines.add("truth", fmt::format("{} ± {} with 95 % confidence, of {} paths", vec_words(truth.mean),
                                 vec_words(kConfidence95 * truth.error), truth.samples));
  if (truth.non_finite > 0) lines.add("truth", fmt::format("{} paths were not finite", truth.non_finite));
  for (const path::SourceLight& light : truth.sources) {
    lines.add("sources", fmt::format("{:<28} straight {:<26} after more turns {}", source_name(*e.scene, light.source),
                                     vec_words(light.straight), vec_words(light.indirect)));
  }
  for (std::size_t i = 0; i < truth.turns.size(); ++i) {
    if (truth.turns[i] != vec3(0.0f)) lines.add("turns", fmt::format("{:>2}  {}", i, vec_words(truth.turns[i])));
  }
  for (const path::LightPath& path : truth.brightest) {
    lines.add("paths", fmt::format("{}: {}", vec_words(path.radiance), path_words(*e.scene, path)));
  }
}

// ----- for programs

Json vec_json(vec3 v) { return Json::array({v.x, v.y, v.z}); }

Json object_json(int number, const std::string& name) { return {{"number", number}, {"name", name}}; }

Json node_json(const Scene& scene, int node) {
  if (node < 0) return nullptr;
  const auto index = static_cast<std::size_t>(node);
  return object_json(number_of(scene.nodes, index), scene.nodes[index].name);
}

Json parts_json(const shade::LobeParts& parts) {
  Json json = Json::object();
  for (const auto& [name, value] : parts_of(parts)) json[std::string(name)] = vec_json(value);
  return json;
}

Json facets_json(const path::FacetTerms& t) {
  return {{"half", vec_json(t.half)}, {"D", t.d}, {"G", t.g}, {"F", vec_json(t.f)}};
}

Json source_json(const Scene& scene, const path::LightSource& source) {
  Json json = {{"kind", source_kind_name(source.kind)}};
  if (source.kind == path::LightKind::sun) json["sun"] = source.index;
  if (source.kind == path::LightKind::lamp || source.kind == path::LightKind::surface) {
    json["node"] = node_json(scene, source.index);
  }
  if (source.kind == path::LightKind::surface) json["primitive"] = source.primitive;
  return json;
}

Json surface_json(const Scene& scene, const PixelExplanation& p) {
  if (!p.surface) return nullptr;
  const path::PixelSurface& s = *p.surface;
  const int material = material_of(scene, s.where);
  Json json = {{"node", node_json(scene, s.where.node)},
               {"primitive", s.where.primitive},
               {"triangle", s.where.triangle},
               {"barycentric", {s.where.barycentric.x, s.where.barycentric.y}},
               {"uv", {s.where.uv.x, s.where.uv.y}},
               {"position", vec_json(s.where.position)},
               {"distance", s.distance},
               {"is_back", s.is_back},
               {"normal", vec_json(s.frame.n)},
               {"geometric_normal", vec_json(s.geometric_normal)},
               {"smooth_normal", vec_json(s.smooth_normal)},
               {"tangent", vec_json(s.frame.t)},
               {"to_eye", vec_json(s.to_eye)},
               {"cos_eye", s.wo.z},
               {"unlit", s.is_unlit},
               {"emission", vec_json(s.emission)}};
  json["material"] = nullptr;
  if (material >= 0) {
    const auto index = static_cast<std::size_t>(material);
    json["material"] = object_json(number_of(scene.materials, index), scene.materials[index].name);
  }
  Json properties = Json::object();
  for (const PropertyValue& value : p.properties) {
    const auto number = [&](vec3 v) { return value.size == 1 ? Json(v.x) : vec_json(v); };
    properties[std::string(value.name)] = {
        {"value", number(value.value)}, {"factor", number(value.factor)}, {"texture", value.has_texture}};
  }
  json["properties"] = std::move(properties);
  if (s.is_unlit) return json;
  Json shares = Json::object();
  for (const auto& [name, share] : shares_of(s)) shares[std::string(name)] = vec_json(share);
  json["albedo"] = std::move(shares);
  json["alpha"] = s.surface.alpha;
  json["f0_dielectric"] = vec_json(s.surface.f0_dielectric);
  json["f0_metal"] = vec_json(s.surface.f0_metal);
  json["mirror"] = facets_json(s.mirror);
  Json lamps = Json::array();
  for (const path::LampTerms& lamp : s.lamps) {
    Json one = lamp.node >= 0 ? Json{{"node", node_json(scene, lamp.node)}} : Json{{"sun", lamp.sun}};
    one.update({{"direction", vec_json(lamp.direction)},
                {"distance", std::isfinite(lamp.distance) ? Json(lamp.distance) : Json(nullptr)},
                {"cos", lamp.wi.z},
                {"irradiance", vec_json(lamp.irradiance)},
                {"visible", vec_json(lamp.visible)},
                {"facets", facets_json(lamp.facets)},
                {"f_cos", parts_json(lamp.parts)},
                {"radiance", vec_json(lamp.radiance)}});
    lamps.push_back(std::move(one));
  }
  json["lights"] = std::move(lamps);
  Json lobes = Json::array();
  for (const LobeCut& cut : cut_lobes(s)) {
    Json points = Json::array();
    for (const dvec2 point : cut.points) points.push_back({point.x, point.y});
    lobes.push_back({{"lobe", cut.lobe}, {"below", cut.is_below}, {"points", std::move(points)}});
  }
  json["plane_of_incidence"] = std::move(lobes);
  return json;
}

Json frame_json(const FrameTerms& frame) {
  Json json = {{"radiance", vec_json(frame.radiance)}};
  Json terms = Json::object();
  for (const FrameTerm& term : frame.terms) terms[frame_term_name(term)] = vec_json(term.radiance);
  json["terms"] = std::move(terms);
  json["far"] = nullptr;
  if (!frame.far) return json;
  Json lookups = Json::array();
  for (const FarLookup& read : frame.far->lookups) {
    lookups.push_back({{"lobe", read.lobe},
                       {"direction", vec_json(read.direction)},
                       {"alpha", read.alpha},
                       {"level", read.level},
                       {"radiance", vec_json(read.radiance)},
                       {"share", vec_json(read.share)},
                       {"light", vec_json(read.light)}});
  }
  Json harmonics = Json::array();
  for (const dvec3& c : frame.far->harmonics) harmonics.push_back(vec_json(vec3(c)));
  json["far"] = {{"levels", frame.far->levels},
                 {"lookups", std::move(lookups)},
                 {"irradiance", vec_json(frame.far->irradiance)},
                 {"harmonics_irradiance", vec_json(frame.far->harmonics_irradiance)},
                 {"harmonics", std::move(harmonics)}};
  return json;
}

Json truth_json(const Scene& scene, const path::PixelEstimate& truth) {
  Json sources = Json::array(), turns = Json::array(), paths = Json::array();
  for (const path::SourceLight& light : truth.sources) {
    Json one = source_json(scene, light.source);
    one.update({{"straight", vec_json(light.straight)}, {"indirect", vec_json(light.indirect)}});
    sources.push_back(std::move(one));
  }
  for (const vec3 light : truth.turns) turns.push_back(vec_json(light));
  for (const path::LightPath& path : truth.brightest) {
    Json vertices = Json::array();
    for (const path::PathVertex& vertex : path.vertices) {
      vertices.push_back({{"event", event_name(vertex.event)},
                          {"position", vec_json(vertex.position)},
                          {"normal", vec_json(vertex.normal)},
                          {"node", node_json(scene, vertex.node)},
                          {"primitive", vertex.node < 0 ? Json(nullptr) : Json(vertex.primitive)}});
    }
    paths.push_back({{"radiance", vec_json(path.radiance)},
                     {"sample", path.sample},
                     {"source", source_json(scene, path.source)},
                     {"direction", vec_json(path.direction)},
                     {"looked_for", path.is_looked_for},
                     {"vertices", std::move(vertices)}});
  }
  return {{"samples", truth.samples},
          {"mean", vec_json(truth.mean)},
          {"standard_error", vec_json(truth.error)},
          {"confidence_95", vec_json(kConfidence95 * truth.error)},
          {"non_finite", truth.non_finite},
          {"sources", std::move(sources)},
          {"turns", std::move(turns)},
          {"brightest", std::move(paths)}};
}

}  // namespace

std::string explain_text(const Explanation& e) {
  std::string text;
  for (const PixelExplanation& p : e.pixels) {
    Lines lines;
    lines.add("pixel", fmt::format("{},{} of {}x{}", p.pixel.x, p.pixel.y, e.size.x, e.size.y));
    add_surface(e, p, lines);
    add_frame(p, lines);
    add_truth(e, p, lines);
    text += (text.empty() ? "" : "\n") + lines.take();
  }
  return text;
}

std::string explain_json(const std::string& scene, const Explanation& e) {
  Json pixels = Json::array();
  for (const PixelExplanation& p : e.pixels) {
    pixels.push_back({{"pixel", {p.pixel.x, p.pixel.y}},
                      {"surface", surface_json(*e.scene, p)},
                      {"frame", p.frame ? frame_json(*p.frame) : Json(nullptr)},
                      {"truth", truth_json(*e.scene, p.truth)}});
  }
  return json_text({{"scene", scene}, {"width", e.size.x}, {"height", e.size.y}, {"pixels", std::move(pixels)}});
}

}  // namespace candela::cli
