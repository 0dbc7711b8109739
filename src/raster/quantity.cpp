#include "raster/quantity.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"

namespace candela::raster {

namespace {

constexpr std::array<std::string_view, kQuantityCount> kNames = {
    "light",        "albedo",    "normal",   "depth",     "distance", "position",  "id",        "base-color",
    "metallic",     "roughness", "facet",    "tangent",   "uv",       "uv1",       "occlusion", "opacity",
    "facing",       "mips",      "cascades", "overdraw",  "diffuse",  "specular",  "coat",      "sheen",
    "transmission", "ambient",   "direct",   "one-light", "emission", "luminance", "non-finite"};

}  // namespace

std::string_view quantity_name(Quantity quantity) { return kNames[static_cast<std::size_t>(quantity)]; }

Quantity parse_quantity(std::string_view name) {
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found != kNames.end()) return static_cast<Quantity>(found - kNames.begin());
  std::string known;
  for (const std::string_view n : kNames) known += (known.empty() ? "" : ", ") + std::string(n);
  throw Error("'" + std::string(name) + "' is none of " + known);
}

bool is_of_surface(Quantity quantity) { return quantity >= Quantity::albedo && quantity <= Quantity::overdraw; }

bool shows_numbers(Quantity quantity) {
  return is_of_surface(quantity) || quantity == Quantity::luminance || quantity == Quantity::non_finite;
}

Quantity quantity_of(Layer layer) {
  return layer == Layer::camera_normal ? Quantity::normal : parse_quantity(layer_name(layer));
}

int parts_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::diffuse:
      return diffuse_part;
    case Quantity::specular:
      return specular_part;
    case Quantity::coat:
      return coat_part;
    case Quantity::sheen:
      return sheen_part;
    case Quantity::transmission:
      return through_part;
    case Quantity::ambient:
      return diffuse_part | specular_part | coat_part | sheen_part | through_part;
    case Quantity::direct:
    case Quantity::one_light:
      return direct_part;
    case Quantity::emission:
      return emission_part;
    default:
      return all_parts;
  }
}

vec3 false_color(float luminance) {
  constexpr float kStops = 12.0f, kGrey = 0.18f;
  if (!(luminance > 0.0f)) return vec3(0.0f);
  const float t = std::log2(luminance / kGrey) / kStops + 0.5f;
  if (t < 0.0f) return vec3(0.0f);
  if (t > 1.0f) return vec3(1.0f);
  // A hue from blue (2/3) down to red (0).
  const float hue = (1.0f - t) * 4.0f;
  return glm::clamp(vec3(std::abs(hue - 3.0f) - 1.0f, 2.0f - std::abs(hue - 2.0f), 2.0f - std::abs(hue - 4.0f)), 0.0f,
                    1.0f);
}

}  // namespace candela::raster
