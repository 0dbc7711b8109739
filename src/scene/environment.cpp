#include "scene/environment.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "base/error.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "image/cube_panorama.h"

namespace candela {
namespace {

vec3 lookup(const Image& map, vec3 d) {
  const float u = 0.5f + std::atan2(d.z, d.x) / (2.0f * kPi);
  const float v = std::acos(std::clamp(d.y, -1.0f, 1.0f)) / kPi;
  const float x = u * static_cast<float>(map.width) - 0.5f;
  const float y = v * static_cast<float>(map.height) - 0.5f;
  const float left = std::floor(x), top = std::floor(y);
  const auto column = [&](float c) {
    const int i = static_cast<int>(c) % map.width;
    return i < 0 ? i + map.width : i;
  };
  const auto row = [&](float r) { return std::clamp(static_cast<int>(r), 0, map.height - 1); };
  const int x0 = column(left), x1 = column(left + 1.0f), y0 = row(top), y1 = row(top + 1.0f);
  const vec3 upper = glm::mix(map.rgb(x0, y0), map.rgb(x1, y0), x - left);
  const vec3 lower = glm::mix(map.rgb(x0, y1), map.rgb(x1, y1), x - left);
  return glm::mix(upper, lower, y - top);
}

}  // namespace

vec3 map_direction(float x, float y, int width, int height) {
  const float azimuth = (x / static_cast<float>(width) - 0.5f) * 2.0f * kPi;
  const float polar = y / static_cast<float>(height) * kPi;
  return {std::sin(polar) * std::cos(azimuth), std::cos(polar), std::sin(polar) * std::sin(azimuth)};
}

float map_solid_angle(int row, int width, int height) {
  const float top = kPi * static_cast<float>(row) / static_cast<float>(height);
  const float bottom = kPi * static_cast<float>(row + 1) / static_cast<float>(height);
  return (std::cos(top) - std::cos(bottom)) * 2.0f * kPi / static_cast<float>(width);
}

Image panorama_of_cube(const CubeFaces& faces, const std::string& where) {
  constexpr std::uint64_t kPerTexel = 3 * sizeof(dvec3) + sizeof(vec3);  // what the conversion holds
  const int width = 4 * faces[0].width;
  const auto texels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(width / 2);
  require_memory(texels * kPerTexel, available_memory(), "a cube map as an environment", where);
  return equirect_from_cube(faces, width);
}

Image turned_panorama(const Image& map, const quat& world_from_map) {
  constexpr int kSide = 3;  // points along a texel
  const quat map_from_world = glm::conjugate(world_from_map);
  Image result(map.width, map.height, 3);
  parallel_for(0, static_cast<std::size_t>(map.height), 8, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < map.width; ++x) {
        vec3 sum(0.0f);
        for (int i = 0; i < kSide * kSide; ++i) {
          const int row = i / kSide;
          const float across = static_cast<float>(x) + (static_cast<float>(i % kSide) + 0.5f) / kSide;
          const float down = static_cast<float>(y) + (static_cast<float>(row) + 0.5f) / kSide;
          sum += lookup(map, map_from_world * map_direction(across, down, map.width, map.height));
        }
        result.set_rgb(x, y, sum / static_cast<float>(kSide * kSide));
      }
    }
  });
  return result;
}

void check_panorama(const Image& image, const std::string& where) {
  // A few pixels more or less come from resizing; anything else is no full panorama.
  if (!(std::abs(static_cast<float>(image.width) / static_cast<float>(image.height) - 2.0f) <= 0.05f))
    throw Error("an equirectangular environment is twice as wide as high, this image is " +
                    std::to_string(image.width) + "x" + std::to_string(image.height),
                where);
}

vec3 irradiance_from_above(const Environment& environment) {
  dvec3 sum = dvec3(environment.constant) * std::numbers::pi;
  if (environment.map) {
    const Image& map = *environment.map;
    const double rows = map.height;
    for (int y = 0; y < map.height; ++y) {
      // ∫ cos θ dω over a row is half the difference of sin² θ, times its azimuth; rows below the horizon give nothing.
      const double top = std::numbers::pi * std::min(y / rows, 0.5);
      const double bottom = std::numbers::pi * std::min((y + 1) / rows, 0.5);
      const double weight = 0.5 * (std::pow(std::sin(bottom), 2) - std::pow(std::sin(top), 2)) * 2.0 *
                            std::numbers::pi / static_cast<double>(map.width);
      if (weight <= 0.0) break;
      for (int x = 0; x < map.width; ++x) sum += dvec3(map.rgb(x, y)) * weight;
    }
  }
  for (const SunDisc& sun : environment.suns) {
    const double sine = std::sin(static_cast<double>(sun.angular_radius));
    sum += dvec3(sun.radiance) * (std::numbers::pi * sine * sine * std::max(static_cast<double>(sun.direction.y), 0.0));
  }
  return vec3(sum * static_cast<double>(environment.intensity));
}

std::vector<SunDisc> world_suns(const Environment& environment) {
  const float c = std::cos(environment.rotation), s = std::sin(environment.rotation);
  std::vector<SunDisc> suns = environment.suns;
  for (SunDisc& sun : suns) {
    const vec3 d = sun.direction;
    sun.direction = {c * d.x + s * d.z, d.y, -s * d.x + c * d.z};
    sun.radiance *= environment.intensity;
  }
  return suns;
}

vec3 environment_radiance(const Environment& environment, vec3 d) {
  // Turning the environment by +rotation is turning the direction back.
  const float c = std::cos(environment.rotation), s = std::sin(environment.rotation);
  const vec3 local(c * d.x - s * d.z, d.y, s * d.x + c * d.z);
  vec3 radiance = environment.constant;
  if (environment.map) radiance += lookup(*environment.map, local);
  for (const SunDisc& sun : environment.suns) {
    // 2 sin(½ angle) = chord: exact for the small angles where acos of a float is not.
    if (glm::length(local - sun.direction) <= 2.0f * std::sin(0.5f * sun.angular_radius)) radiance += sun.radiance;
  }
  return environment.intensity * radiance;
}

}  // namespace candela
