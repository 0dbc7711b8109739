#include "cli/explain_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "cli/values.h"
#include "raster/quantity.h"
#include "scene/surface_layers.h"

namespace candela::cli {

namespace {

std::string number_words(float value) { return std::abs(value) < 1e-7f ? "0" : fmt::format("{:.4g}", value); }

/// "node 3 “Lamp”"
std::string named(const char* kind, int number, const std::string& name) {
  return name.empty() ? fmt::format("{} {}", kind, number) : fmt::format("{} {} \"{}\"", kind, number, one_line(name));
}

std::string node_name(const Scene& scene, int node) {
  if (node < 0) return "the ground";
  const auto index = static_cast<std::size_t>(node);
  return named("node", number_of(scene.nodes, index), scene.nodes[index].name);
}

std::string facet_words(const path::FacetTerms& t) {
  return fmt::format("D {} G {} F {}", number_words(t.d), number_words(t.g), vec_words(t.f));
}

std::vector<NamedColor> those_there(std::vector<NamedColor> colors) {
  std::erase_if(colors, [](const NamedColor& color) { return color.second == vec3(0.0f); });
  return colors;
}

}  // namespace

std::string vec_words(vec3 v) {
  return fmt::format("{} {} {}", number_words(v.x), number_words(v.y), number_words(v.z));
}

float angle_deg(float cosine) { return degrees(std::acos(std::clamp(cosine, -1.0f, 1.0f))); }

std::vector<NamedColor> parts_of(const shade::LobeParts& p) {
  return those_there({{"specular", p.specular},
                      {"diffuse", p.diffuse},
                      {"sheen", p.sheen},
                      {"coat", p.coat},
                      {"below", p.below},
                      {"through", p.through}});
}

std::vector<NamedColor> shares_of(const path::PixelSurface& surface) {
  const shade::SurfaceShares& s = surface.shares;
  return those_there({{"specular", s.specular},
                      {"spread", s.spread},
                      {"diffuse", s.diffuse},
                      {"sheen", s.sheen},
                      {"coat", s.coat},
                      {"below", s.below},
                      {"glass", s.glass},
                      {"through", s.through}});
}

std::string surface_words(const Scene& scene, const path::PixelSurface& s) {
  const int material = material_of(scene, s.where);
  const auto index = static_cast<std::size_t>(material);
  return fmt::format(
      "{}, primitive {}, triangle {}, {}{}", node_name(scene, s.where.node), s.where.primitive, s.where.triangle,
      material < 0 ? "no material" : named("material", number_of(scene.materials, index), scene.materials[index].name),
      s.is_unlit ? ", unlit" : "");
}

std::string property_words(const PropertyValue& property, vec3 value) {
  return property.size == 1 ? number_words(value.x) : vec_words(value);
}

std::string property_origin(const PropertyValue& p) {
  if (p.value == p.factor && !p.has_texture) return "";
  return property_words(p, p.factor) + " in the file" + (p.has_texture ? ", times its texture" : "");
}

std::string facets_words(const path::PixelSurface& p) {
  const shade::Surface& s = p.surface;
  std::string text = fmt::format("alpha {}, ", number_words(s.alpha));
  if ((s.lobes & shade::kLobeAnisotropy) != 0) {
    text = fmt::format("alpha {} along and {} across, ", number_words(s.alpha_x), number_words(s.alpha_y));
  }
  if (s.weight_metal < 1.0f) text += "F0 " + vec_words(s.f0_dielectric);
  if (s.weight_metal > 0.0f) text += (s.weight_metal < 1.0f ? ", of the metal " : "F0 ") + vec_words(s.f0_metal);
  if (s.is_mirror) return text + "; a mirror";
  return p.mirror.d > 0.0f ? text + "; where a mirror looks " + facet_words(p.mirror) : text;
}

std::string lamp_name(const Scene& scene, const path::LampTerms& lamp) {
  return lamp.node >= 0 ? node_name(scene, lamp.node) : fmt::format("sun {}", lamp.sun);
}

std::string lamp_words(const path::LampTerms& lamp) {
  return fmt::format("{}{:.1f}° from the normal, irradiance {}, arriving {}",
                     std::isfinite(lamp.distance) ? fmt::format("{:.4g} m, ", lamp.distance) : "", angle_deg(lamp.wi.z),
                     vec_words(lamp.irradiance), vec_words(lamp.visible));
}

std::string lamp_terms_words(const path::LampTerms& lamp) {
  std::string text = lamp.facets.d > 0.0f ? facet_words(lamp.facets) + "; f cos" : "f cos";
  for (const auto& [name, value] : parts_of(lamp.parts)) text += fmt::format(" {} {}", name, vec_words(value));
  return text + "; radiance " + vec_words(lamp.radiance);
}

std::string frame_term_name(const FrameTerm& term) {
  return term.light >= 0 ? fmt::format("light:{}", term.light) : std::string(raster::quantity_name(term.part));
}

std::string lookup_words(const FarLookup& read, int levels) {
  const bool is_irradiance = read.lobe == "diffuse" || read.lobe == "below";
  return fmt::format("{:<9} {} {} x {} = {}", read.lobe,
                     is_irradiance ? std::string("irradiance / pi")
                                   : fmt::format("level {:.2f} of 0 to {} (alpha {})", read.level, levels - 1,
                                                 number_words(read.alpha)),
                     vec_words(read.radiance), vec_words(read.share), vec_words(read.light));
}

std::string ratio_words(vec3 frame, const path::PixelEstimate& truth) {
  const float exact = luminance(truth.mean);
  if (!(exact > 0.0f)) return "";
  return fmt::format(", {:+.1f} % of the truth", 100.0f * (luminance(frame) / exact - 1.0f));
}

std::string_view source_kind_name(path::LightKind kind) {
  constexpr std::array<std::string_view, 4> kNames{"sky", "sun", "lamp", "surface"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::string_view event_name(path::PathEvent event) {
  constexpr std::array<std::string_view, 5> kNames{"reflected", "let through", "passed", "scattered", "ended"};
  return kNames[static_cast<std::size_t>(event)];
}

std::string source_name(const Scene& scene, const path::LightSource& source) {
  switch (source.kind) {
    case path::LightKind::sky:
      return "environment";
    case path::LightKind::sun:
      return fmt::format("sun {}", source.index);
    case path::LightKind::lamp:
      return "lamp " + node_name(scene, source.index);
    case path::LightKind::surface:
      break;
  }
  return "glowing " + node_name(scene, source.index);
}

std::string path_words(const Scene& scene, const path::LightPath& path) {
  std::string text = "eye";
  for (const path::PathVertex& vertex : path.vertices) {
    if (vertex.event == path::PathEvent::ended) break;  // the source says it
    const bool is_in_body = vertex.event == path::PathEvent::scattered;
    text += fmt::format(" > {}{} at {}", event_name(vertex.event),
                        is_in_body ? "" : " by " + node_name(scene, vertex.node), vec_words(vertex.position));
  }
  text += " > " + source_name(scene, path.source);
  if (path.source.kind == path::LightKind::sky || path.source.kind == path::LightKind::sun) {
    text += " in " + vec_words(path.direction);
  } else if (!path.vertices.empty() && path.vertices.back().event == path::PathEvent::ended) {
    text += " at " + vec_words(path.vertices.back().position);
  }
  return text;
}

}  // namespace candela::cli
