#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "image/film.h"

namespace candela::raster {

/// What a picture shows in place of all light. First what a shader knows of the surface (linear values), then parts of
/// the light, then what is counted or judged.
enum class Quantity {
  light,
  albedo,
  normal,
  depth,     ///< along the view
  distance,  ///< from the eye
  position,
  object_id,
  base_color,
  metallic,
  roughness,
  geometric_normal,
  tangent,
  uv,
  uv1,
  occlusion,
  opacity,
  facing,    ///< green the front, red the back
  mips,      ///< of the base colour's texture: level over 10
  cascades,  ///< of the strongest directional light
  overdraw,  ///< a tenth for each surface drawn
  diffuse,   ///< of the light from far away, as the next four
  specular,
  coat,
  sheen,
  transmission,
  ambient,    ///< all light from far away
  direct,     ///< of every light
  one_light,  ///< of Settings::shown_light
  emission,
  luminance,   ///< in stops about middle grey, as colours
  non_finite,  ///< magenta
};
inline constexpr int kQuantityCount = static_cast<int>(Quantity::non_finite) + 1;

/// As on the command line: "base-color".
std::string_view quantity_name(Quantity quantity);
/// Throws Error that lists what there is.
Quantity parse_quantity(std::string_view name);

/// Whether a shader writes it in place of light.
bool is_of_surface(Quantity quantity);
/// Whether its picture is shown as it is, without exposure and tone curve.
bool shows_numbers(Quantity quantity);
/// Of a layer that has a mean.
Quantity quantity_of(Layer layer);

/// Bits of what adds up to the light of a surface.
enum Part : int {
  diffuse_part = 1,
  specular_part = 2,
  coat_part = 4,
  sheen_part = 8,
  through_part = 16,
  direct_part = 32,
  emission_part = 64,
  all_parts = 127
};
int parts_of(Quantity quantity);

/// Colour of a luminance: blue to red through the spectrum over twelve stops, middle grey (0.18) in the middle; black
/// below, white above.
vec3 false_color(float luminance);

}  // namespace candela::raster
