#include <algorithm>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "content/builtin_environment.h"
#include "scene/environment.h"
#include "shade/sky.glsl.h"

namespace candela::content {
namespace {

constexpr int kWidth = 512;
constexpr int kHeight = 256;
/// The sun stands this many columns from +x towards +z, on the edge between two columns so that the map's halves mirror
/// each other; seen from the default camera (azimuth 35°) it is an orbit azimuth of 80°: side light from the front
/// right.
constexpr int kSunColumn = 14;
constexpr float kObserverAltitude = 0.1f;
constexpr float kGroundAlbedo = 0.3f;
constexpr int kSkySteps = 24;
constexpr int kGroundSteps = 8;  // the air before the ground is nearly uniform

/// A table of colours over [0, 1]², first and last entries on the edges, read bilinearly.
class Table {
 public:
  Table(int width, int height) : width_(width), height_(height), values_(static_cast<std::size_t>(width * height)) {}

  /// Fills every entry with f(uv), in parallel.
  template <class F>
  void fill(const F& f) {
    parallel_for(0, static_cast<std::size_t>(height_), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t y = begin; y < end; ++y)
        for (int x = 0; x < width_; ++x)
          values_[y * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)] =
              f(vec2(static_cast<float>(x) / static_cast<float>(width_ - 1),
                     static_cast<float>(y) / static_cast<float>(height_ - 1)));
    });
  }

  vec3 operator()(vec2 uv) const {
    const float x = std::clamp(uv.x, 0.0f, 1.0f) * static_cast<float>(width_ - 1);
    const float y = std::clamp(uv.y, 0.0f, 1.0f) * static_cast<float>(height_ - 1);
    const int x0 = std::min(static_cast<int>(x), width_ - 2), y0 = std::min(static_cast<int>(y), height_ - 2);
    const vec3* const p = values_.data() + std::ptrdiff_t{y0} * width_ + x0;
    const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
    return glm::mix(glm::mix(p[0], p[1], fx), glm::mix(p[width_], p[width_ + 1], fx), fy);
  }

 private:
  int width_;
  int height_;
  std::vector<vec3> values_;
};

/// Tables for one height of the sun, and the light along rays. Luminances are per unit of solar illuminance.
class Atmosphere {
 public:
  explicit Atmosphere(float sun_elevation)
      : sun_elevation_(sun_elevation), transmittance_(128, 64), multiple_(kSunAngles, kAltitudes) {
    transmittance_.fill([](vec2 uv) {
      const vec2 r_mu = shade::sky_transmittance_r_mu(uv);
      return shade::sky_transmittance_to_top(r_mu.x, r_mu.y);
    });
    multiple_.fill([this](vec2 uv) {
      const float r =
          shade::kSkyGroundRadius + 0.001f + uv.y * uv.y * (shade::kSkyTopRadius - shade::kSkyGroundRadius - 0.002f);
      return multiple_scattering(r, std::sin(sun_elevation_ + (2.0f * uv.x - 1.0f) * kSunAngleRange));
    });
  }

  vec3 sun_transmittance(float r, float mu_sun) const {
    const float visible = shade::sky_sun_visibility(r, mu_sun);
    return visible <= 0.0f ? vec3(0.0f) : visible * transmittance_(shade::sky_transmittance_uv(r, mu_sun));
  }

  struct Along {
    vec3 luminance{0.0f};
    vec3 transmittance{1.0f};  ///< to the end of the ray
  };
  /// Light scattered into the ray (r, mu) over `way`; `cos_sun` is between ray and sun.
  Along march(float r, float mu, float mu_sun, float cos_sun, float way, int steps) const {
    Along along;
    float from = 0.0f;
    for (int i = 0; i < steps; ++i) {
      const float s = static_cast<float>(i + 1) / static_cast<float>(steps);
      const float to = way * s * s;
      const float t = 0.5f * (from + to);
      const float ri = shade::sky_radius_at(r, mu, t);
      const float mu_sun_i = std::clamp((r * mu_sun + t * cos_sun) / ri, -1.0f, 1.0f);
      const shade::SkyMedium medium = shade::sky_medium(ri - shade::kSkyGroundRadius);
      const vec3 source =
          shade::sky_in_scattering(medium, cos_sun, sun_transmittance(ri, mu_sun_i), multiple_lookup(ri, mu_sun_i));
      const vec3 through = glm::exp(-medium.extinction * (to - from));
      along.luminance += along.transmittance * shade::sky_step(source, medium.extinction, through);
      along.transmittance *= through;
      from = to;
    }
    return along;
  }

 private:
  static constexpr int kSunAngles = 16;
  static constexpr int kAltitudes = 16;
  /// The sun's height above the local horizon changes by less than acos(6360/6420) = 7.9° along any ray from the
  /// ground.
  static constexpr float kSunAngleRange = radians(9.0f);

  vec3 multiple_lookup(float r, float mu_sun) const {
    const float altitude = (r - shade::kSkyGroundRadius) / (shade::kSkyTopRadius - shade::kSkyGroundRadius);
    const float angle = std::asin(std::clamp(mu_sun, -1.0f, 1.0f)) - sun_elevation_;
    return multiple_({0.5f + 0.5f * angle / kSunAngleRange, std::sqrt(std::max(0.0f, altitude))});
  }

  /// Ψ of Hillaire 2020 eq. 5-10: second-order light over all directions, and the geometric series of later orders,
  /// with isotropic phase functions.
  vec3 multiple_scattering(float r, float mu_sun) const {
    constexpr int kDirections = 8;  // squared, over the sphere
    constexpr int kSteps = 20;
    constexpr float kIsotropic = 1.0f / (4.0f * kPi);
    const float sin_sun = std::sqrt(std::max(0.0f, 1.0f - mu_sun * mu_sun));
    vec3 second(0.0f), transfer(0.0f);
    for (int k = 0; k < kDirections * kDirections; ++k) {
      const int row = k / kDirections;
      const float mu = 1.0f - 2.0f * (static_cast<float>(row) + 0.5f) / kDirections;
      const float azimuth = 2.0f * kPi * (static_cast<float>(k % kDirections) + 0.5f) / kDirections;
      const float cos_sun = mu * mu_sun + std::sqrt(1.0f - mu * mu) * sin_sun * std::cos(azimuth);
      const bool ground = shade::sky_hits_ground(r, mu);
      const float way = ground ? shade::sky_distance_to_ground(r, mu) : shade::sky_distance_to_top(r, mu);
      vec3 transmittance(1.0f);
      float from = 0.0f;
      for (int i = 0; i < kSteps; ++i) {
        const float to = way * static_cast<float>(i + 1) / kSteps;
        const float t = 0.5f * (from + to);
        const float ri = shade::sky_radius_at(r, mu, t);
        const shade::SkyMedium medium = shade::sky_medium(ri - shade::kSkyGroundRadius);
        const vec3 scattering = medium.rayleigh + vec3(medium.aerosol);
        const vec3 through = glm::exp(-medium.extinction * (to - from));
        const vec3 weight = transmittance * shade::sky_step(scattering, medium.extinction, through);
        transfer += weight;
        second += weight * sun_transmittance(ri, std::clamp((r * mu_sun + t * cos_sun) / ri, -1.0f, 1.0f)) * kIsotropic;
        transmittance *= through;
        from = to;
      }
      if (!ground) continue;
      const float rg = shade::kSkyGroundRadius;
      const float mu_sun_ground = std::clamp((r * mu_sun + way * cos_sun) / rg, -1.0f, 1.0f);
      second +=
          transmittance * sun_transmittance(rg, mu_sun_ground) * std::max(0.0f, mu_sun_ground) * (kGroundAlbedo / kPi);
    }
    constexpr float kCount = kDirections * kDirections;
    return second / kCount / (vec3(1.0f) - transfer / kCount);
  }

  float sun_elevation_;
  Table transmittance_;  ///< to the top of the atmosphere, by sky_transmittance_uv
  Table multiple_;       ///< by the sun's height around sun_elevation_ and the square root of the altitude
};

/// Calls body(row) for rows [begin, end) in parallel.
template <class F>
void for_rows(int begin, int end, const F& body) {
  parallel_for(static_cast<std::size_t>(begin), static_cast<std::size_t>(end), 4,
               [&](std::size_t from, std::size_t to) {
                 for (std::size_t y = from; y < to; ++y) body(static_cast<int>(y));
               });
}

}  // namespace

Environment make_sky(float elevation_deg) {
  const float elevation = radians(elevation_deg);
  const float sun_azimuth = 2.0f * kPi * static_cast<float>(kSunColumn) / static_cast<float>(kWidth);
  const vec3 sun(std::cos(elevation) * std::cos(sun_azimuth), std::sin(elevation),
                 std::cos(elevation) * std::sin(sun_azimuth));
  const Atmosphere atmosphere(elevation);
  const float r = shade::kSkyGroundRadius + kObserverAltitude;
  const vec3 sun_outside = shade::sky_sun_illuminance();
  const vec3 sun_illuminance = sun_outside * atmosphere.sun_transmittance(r, sun.y);

  // Both halves of the map mirror each other about the vertical plane through the sun.
  Image map(kWidth, kHeight, 3);
  const int first = kWidth / 2 + kSunColumn;
  const auto set_both = [&](int offset, int y, vec3 value) {
    map.set_rgb((first + offset) % kWidth, y, value);
    map.set_rgb((first - 1 - offset + kWidth) % kWidth, y, value);
  };
  const auto direction = [&](int offset, int y) {
    return map_direction(static_cast<float>(first + offset) + 0.5f, static_cast<float>(y) + 0.5f, kWidth, kHeight);
  };

  // Above the horizon.
  for_rows(0, kHeight / 2, [&](int y) {
    for (int i = 0; i < kWidth / 2; ++i) {
      const vec3 d = direction(i, y);
      const auto along =
          atmosphere.march(r, d.y, sun.y, glm::dot(d, sun), shade::sky_distance_to_top(r, d.y), kSkySteps);
      set_both(i, y, sun_outside * along.luminance);
    }
  });

  // The ground: a Lambertian plain under that sky and sun, seen through the air before it.
  glm::dvec3 sky_illuminance(0.0);
  for (int y = 0; y < kHeight / 2; ++y)
    for (int x = 0; x < kWidth; ++x)
      sky_illuminance +=
          glm::dvec3(map.rgb(x, y)) * static_cast<double>(map_solid_angle(y, kWidth, kHeight) * direction(0, y).y);
  const vec3 ground = kGroundAlbedo / kPi * (vec3(sky_illuminance) + sun_illuminance * std::max(0.0f, sun.y));
  for_rows(kHeight / 2, kHeight, [&](int y) {
    for (int i = 0; i < kWidth / 2; ++i) {
      const vec3 d = direction(i, y);
      const bool hit = shade::sky_hits_ground(r, d.y);
      const float way = hit ? shade::sky_distance_to_ground(r, d.y) : shade::sky_distance_to_top(r, d.y);
      const auto along = atmosphere.march(r, d.y, sun.y, glm::dot(d, sun), way, kGroundSteps);
      set_both(i, y, sun_outside * along.luminance + (hit ? along.transmittance * ground : vec3(0.0f)));
    }
  });

  Environment environment;
  environment.name = "sky";
  environment.map = std::make_shared<const Image>(std::move(map));
  if (elevation_deg > 0.0f) {
    SunDisc disc;
    disc.direction = sun;
    disc.angular_radius = shade::kSkySunAngularRadius;
    const float half_sine = std::sin(0.5f * disc.angular_radius);
    disc.radiance = sun_illuminance / (4.0f * kPi * half_sine * half_sine);
    environment.suns.push_back(disc);
  }
  return environment;
}

}  // namespace candela::content
