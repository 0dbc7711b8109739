#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "check/check_parts.h"
#include "shade/units.glsl.h"

// Intensities of lamps and of what glows, against those of the world.
namespace candela::check {

namespace {

// A floodlight of a stadium gives 200 klm (2 kW metal halide).
constexpr double kMostLumens = 200e3;
// A candle: 1 cd, 12.6 lm.
constexpr double kLeastCandela = 1.0;
// The sun above the atmosphere: 133 klx (Darula, Kittler & Gueymard 2005).
constexpr double kMostLux = 134e3;
// A street at night has 10 lx, the full moon gives 0.3.
constexpr double kLeastLux = 10.0;
// The filament of a halogen lamp is brighter than 1e7 cd/m², the sun's disc has 1.6e9.
constexpr double kMostLuminance = 1.6e9;
// Of a white wall beside it; less than that is not seen to glow.
constexpr double kFaint = 1e-3;

std::string light_label(const Scene& scene, std::size_t index) {
  const std::string& name = scene.lights[index].name;
  return name.empty() ? fmt::format("light {}", number_of(scene.lights, index)) : fmt::format("light '{}'", name);
}

/// Flux of a point or spot in lumens, of its luminance.
double flux(const Scene& scene, const Light& light) {
  const double of_one = intensity_from_lumens(scene, light, 1.0f);
  return of_one > 0.0 && std::isfinite(of_one) ? light.intensity * luminance(light.color) / of_one : 0.0;
}

void judge_light(const Scene& scene, std::size_t index, std::vector<Finding>& findings) {
  const Light& light = scene.lights[index];
  const double strength = light.intensity * luminance(light.color);
  Finding f;
  f.subject = light_label(scene, index);
  if (light.type == LightType::directional) {
    f.measured.emplace_back("illuminance_lux", strength);
    if (strength > kMostLux) {
      f.severity = Severity::warning;
      f.code = "light-too-bright";
      f.message = fmt::format("{:.3g} lux; the sun above the atmosphere gives {:.3g}", strength, kMostLux);
    } else if (strength > 0.0 && strength < kLeastLux) {
      f.severity = Severity::note;
      f.code = "light-without-unit";
      f.message = fmt::format(
          "{:.3g} lux, less than a street lamp's {:.0f} on the ground: a number without unit? "
          "glTF takes lux; the sun gives 100 000",
          strength, kLeastLux);
    } else {
      return;
    }
  } else {
    const double lumens = flux(scene, light);
    f.measured = {{"intensity_cd", light.ies >= 0 ? 0.0 : strength}, {"flux_lm", lumens}};
    if (light.ies >= 0) f.measured.erase(f.measured.begin());
    if (lumens > kMostLumens) {
      f.severity = Severity::warning;
      f.code = "light-too-bright";
      f.message = fmt::format(
          "{:.3g} lm; a stadium's floodlight gives {:.3g}. An exporter that takes the watts of "
          "Blender's lamps for radiant flux (683 lm/W) makes such numbers",
          lumens, kMostLumens);
    } else if (light.ies < 0 && strength > 0.0 && strength < kLeastCandela) {
      f.severity = Severity::note;
      f.code = "light-without-unit";
      f.message = fmt::format("{:.3g} cd, less than a candle's {:.0f}: a number without unit? glTF takes candela",
                              strength, kLeastCandela);
    } else {
      return;
    }
  }
  findings.push_back(std::move(f));
}

/// What a white wall that faces the file's own lights shows, cd/m²; points as far away as half of the scene.
double white_wall(const Scene& scene) {
  const Box3 box = world_bounds(scene);
  if (box.empty()) return 0.0;
  const double distance2 = 0.25 * glm::dot(dvec3(box.size()), dvec3(box.size()));
  double most = 0.0;
  for (const Node& node : scene.nodes) {
    if (node.light < 0) continue;
    const Light& light = scene.lights[static_cast<std::size_t>(node.light)];
    const double strength = light.intensity * luminance(light.color);
    if (light.ies >= 0) continue;
    most = std::max(most, light.type == LightType::directional ? strength : strength / std::max(distance2, 1e-12));
  }
  return most / kPi;
}

void judge_emission(const Scene& scene, int index, double wall, std::vector<Finding>& findings) {
  const Material& m = scene.materials[static_cast<std::size_t>(index)];
  const double brightest = luminance(m.emission);
  if (m.unlit || brightest <= 0.0) return;
  Finding f;
  f.material = index;
  f.texture = m.emissive_texture.texture;
  f.measured.emplace_back("luminance_cd_m2", brightest);
  if (brightest > kMostLuminance) {
    f.severity = Severity::warning;
    f.code = "emission-too-bright";
    f.message = fmt::format("{:.3g} cd/m²; the disc of the sun has {:.2g}", brightest, kMostLuminance);
  } else if (wall > 0.0 && brightest < kFaint * wall) {
    f.severity = Severity::note;
    f.code = "emission-too-faint";
    f.measured.emplace_back("white_wall_cd_m2", wall);
    f.message = fmt::format(
        "{:.3g} cd/m², while a white wall in the light of the file's own lamps has {:.3g}: nobody "
        "sees it glow",
        brightest, wall);
    f.fix = "give emissiveStrength in cd/m²; a screen has 100 to 1000";
  } else {
    return;
  }
  findings.push_back(std::move(f));
}

}  // namespace

void check_lights(const Scene& scene, std::vector<Finding>& findings) {
  for (std::size_t i = 0; i < scene.lights.size(); ++i) judge_light(scene, i, findings);
  const double wall = white_wall(scene);
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    judge_emission(scene, static_cast<int>(i), wall, findings);
  }
}

}  // namespace candela::check
