#include <cmath>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "content/builtin_environment.h"
#include "scene/environment.h"

namespace candela::content {
namespace {

constexpr int kWidth = 1024;
constexpr int kHeight = 512;
/// The default camera's azimuth (view.h); the lamps stand around the subject as that camera sees it.
constexpr float kCameraAzimuth = radians(35.0f);

float smoothstep(float from, float to, float x) {
  const float t = glm::clamp((x - from) / (to - from), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

/// Direction at an azimuth counted from the camera's (positive to the camera's right) and a height, degrees.
vec3 around_camera(float azimuth_deg, float elevation_deg) {
  const float azimuth = kCameraAzimuth + radians(azimuth_deg);
  const float elevation = radians(elevation_deg);
  return {std::cos(elevation) * std::sin(azimuth), std::sin(elevation), std::cos(elevation) * std::cos(azimuth)};
}

/// A rectangular softbox facing the subject: its size as seen from there, soft edges, rounded corners.
struct Softbox {
  vec3 axis;
  vec3 right;
  vec3 up;
  vec2 half_size;  ///< tangents of the half angles
  float edge;      ///< width of the soft border, as a tangent
  float falloff;   ///< how much dimmer the cloth is at its border than in front of the lamp
  vec3 radiance;

  Softbox(vec3 axis_, vec2 half_angles_deg, float edge_, float falloff_, vec3 radiance_, float roll_deg = 0.0f)
      : axis(axis_),
        half_size(std::tan(radians(half_angles_deg.x)), std::tan(radians(half_angles_deg.y))),
        edge(edge_),
        falloff(falloff_),
        radiance(radiance_) {
    // Overhead, "up" is away from the camera.
    const vec3 reference = std::abs(axis.y) > 0.99f ? -around_camera(0.0f, 0.0f) : vec3(0.0f, 1.0f, 0.0f);
    const vec3 level = glm::normalize(glm::cross(reference, axis));
    const vec3 upright = glm::cross(axis, level);
    const float c = std::cos(radians(roll_deg)), s = std::sin(radians(roll_deg));
    right = c * level + s * upright;
    up = c * upright - s * level;
  }

  vec3 at(vec3 d) const {
    const float depth = glm::dot(d, axis);
    if (depth <= 0.0f) return vec3(0.0f);
    const vec2 p(glm::dot(d, right) / depth, glm::dot(d, up) / depth);
    // Signed distance to a rounded rectangle.
    const float corner = 0.3f * glm::min(half_size.x, half_size.y);
    const vec2 q = glm::abs(p) - half_size + vec2(corner);
    const float distance = glm::length(glm::max(q, vec2(0.0f))) + glm::min(glm::max(q.x, q.y), 0.0f) - corner;
    const vec2 n = p / half_size;
    const float cloth = 1.0f - falloff * glm::min(1.0f, 0.5f * glm::dot(n, n));
    return radiance * (cloth * smoothstep(edge, -edge, distance));
  }
};

/// The room: a sweep that is brightest behind the subject where it meets the floor, dimmer above and below. What the
/// camera sees of it is the same all around, so that every orbit has that backdrop. `pool_share`: of that brightness.
vec3 backdrop(vec3 d, bool is_seen, float pool_share) {
  const float elevation = degrees(std::asin(glm::clamp(d.y, -1.0f, 1.0f)));
  const float above = 0.26f - 0.06f * smoothstep(0.0f, 75.0f, elevation);
  const float below = 0.26f - 0.16f * smoothstep(0.0f, 55.0f, -elevation);
  // A background lamp's pool of light low on the sweep, wider than high; round the back of the pool the angle wraps.
  const vec3 behind = around_camera(180.0f, 0.0f);
  const float cos_sideways = (d.x * behind.x + d.z * behind.z) / glm::max(1e-6f, std::sqrt(d.x * d.x + d.z * d.z));
  const float sideways = is_seen ? 0.0f : degrees(std::acos(glm::clamp(cos_sideways, -1.0f, 1.0f))) / 40.0f;
  const float height = (elevation + 8.0f) / 14.0f;
  const float pool = std::exp(-0.5f * (sideways * sideways + height * height));
  return vec3(0.985f, 0.995f, 1.02f) * ((elevation > 0.0f ? above : below) + 0.34f * pool_share * pool);
}

constexpr vec3 kWarm(1.04f, 1.0f, 0.94f), kCool(0.95f, 1.0f, 1.07f), kWhite(1.0f);

/// A room and its lamps.
struct Studio {
  float room = 1.0f;        ///< how bright it is
  float pool_share = 1.0f;  ///< how much of the background lamp there is
  std::vector<Softbox> lamps;
};

Studio light_grey_studio() {
  return {.lamps = {
              // key: large, front left, above the camera
              {around_camera(-46.0f, 38.0f), {15.5f, 15.5f}, 0.03f, 0.35f, 7.0f * kWarm},
              // overhead: long, a little behind the subject so that tops shine
              {around_camera(180.0f, 76.0f), {20.0f, 8.0f}, 0.03f, 0.35f, 6.6f * kWhite},
              // rims: narrow strips behind left and right
              {around_camera(-128.0f, 22.0f), {3.2f, 24.0f}, 0.016f, 0.3f, 8.0f * kCool},
              {around_camera(120.0f, 24.0f), {4.2f, 26.0f}, 0.018f, 0.3f, 9.0f * kCool},
              // fill: wide and weak, front right
              {around_camera(62.0f, 12.0f), {15.0f, 23.0f}, 0.09f, 0.3f, 0.8f * kWhite},
          }};
}

/// Contours before black: strips behind the subject and above it, and little from the front.
Studio dark_studio() {
  return {.room = 0.04f,
          .pool_share = 0.0f,
          .lamps = {
              {around_camera(-122.0f, 20.0f), {4.5f, 30.0f}, 0.02f, 0.3f, 17.0f * kCool},
              {around_camera(118.0f, 22.0f), {4.5f, 30.0f}, 0.02f, 0.3f, 17.0f * kWarm},
              {around_camera(180.0f, 70.0f), {24.0f, 6.0f}, 0.03f, 0.35f, 9.0f * kWhite},
              {around_camera(-40.0f, 35.0f), {9.0f, 9.0f}, 0.05f, 0.35f, 3.5f * kWarm},
          }};
}

/// A portrait's key, fill and back light.
Studio three_point_studio() {
  return {.room = 0.12f,
          .pool_share = 0.3f,
          .lamps = {
              {around_camera(-45.0f, 40.0f), {11.0f, 11.0f}, 0.03f, 0.35f, 17.0f * kWarm},
              {around_camera(50.0f, 12.0f), {16.0f, 18.0f}, 0.08f, 0.3f, 1.6f * kCool},
              {around_camera(160.0f, 48.0f), {9.0f, 9.0f}, 0.03f, 0.35f, 18.0f * kWhite},
          }};
}

}  // namespace

Environment make_studio(std::string_view kind) {
  Studio studio = light_grey_studio();
  if (kind == "dark") studio = dark_studio();
  if (kind == "three-point") studio = three_point_studio();
  Image map(kWidth, kHeight, 3);
  Image seen(kWidth, kHeight, 3);
  parallel_for(0, kHeight, 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      for (int x = 0; x < kWidth; ++x) {
        const int y = static_cast<int>(row);
        const vec3 d = map_direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, kWidth, kHeight);
        seen.set_rgb(x, y, studio.room * backdrop(d, true, studio.pool_share));
        vec3 radiance = studio.room * backdrop(d, false, studio.pool_share);
        for (const Softbox& lamp : studio.lamps) radiance += lamp.at(d);
        map.set_rgb(x, y, radiance);
      }
    }
  });
  Environment environment;
  environment.name = kind.empty() ? "studio" : "studio:" + std::string(kind);
  environment.exposure = 1.0f;
  environment.map = std::make_shared<const Image>(std::move(map));
  environment.backdrop = std::make_shared<const Image>(std::move(seen));
  return environment;
}

}  // namespace candela::content
