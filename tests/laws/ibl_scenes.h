#pragma once

#include <functional>

#include "ibl/source.h"

namespace candela::laws {

/// A panorama with `radiance` at the middle of each texel.
inline ibl::Source panorama(int width, const std::function<dvec3(dvec3)>& radiance) {
  ibl::Source source;
  source.map = Image(width, width / 2, 3);
  for (int y = 0; y < width / 2; ++y) {
    for (int x = 0; x < width; ++x) {
      source.map.set_rgb(x, y, vec3(radiance(ibl::texel_direction(source, x, y))));
    }
  }
  return source;
}

/// A smooth colourful sky over a dark ground, with one texel that gives as much light as all the rest.
inline ibl::Source sun_and_sky(int width) {
  ibl::Source source = panorama(width, [](dvec3 d) {
    return d.y > 0.0 ? dvec3(0.6 + 0.3 * d.x, 0.8, 1.2 - 0.5 * d.z) : dvec3(0.02, 0.015, 0.01 + 0.005 * d.x);
  });
  const int x = width / 3, y = width / 6;
  const auto radiance = static_cast<float>(3.4 / ibl::texel_solid_angle(y, width, width / 2));
  source.map.set_rgb(x, y, vec3(radiance, 0.9f * radiance, 0.7f * radiance));
  return source;
}

}  // namespace candela::laws
