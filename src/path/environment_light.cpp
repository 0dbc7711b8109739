#include "path/environment_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/check.h"
#include "base/large_pages.h"
#include "scene/environment.h"
#include "shade/footprint.glsl.h"

namespace candela::path {

namespace {

/// Of four texels: top left, top right, bottom left, bottom right.
template <class Texel>
vec3 bilinear(const Texel& at, float tx, float ty) {
  return (at(0) * (1.0f - tx) + at(1) * tx) * (1.0f - ty) + (at(2) * (1.0f - tx) + at(3) * tx) * ty;
}

}  // namespace

EnvironmentLight::EnvironmentLight(const Environment& environment) {
  cos_rotation_ = std::cos(environment.rotation);
  sin_rotation_ = std::sin(environment.rotation);
  constant_ = environment.constant * environment.intensity;
  flux_ = 4.0f * kPi * luminance(constant_);

  for (const SunDisc& disc : world_suns(environment)) {
    if (max_component(disc.radiance) <= 0.0f || disc.angular_radius <= 0.0f) continue;
    Sun sun;
    sun.frame = frame_from_normal(glm::normalize(disc.direction));
    sun.sin2_radius = std::pow(std::sin(disc.angular_radius), 2.0f);
    // 2π (1 - cos r) without cancellation for a sun half a degree wide.
    sun.solid_angle = 4.0f * kPi * std::pow(std::sin(0.5f * disc.angular_radius), 2.0f);
    sun.radiance = disc.radiance;
    suns_.push_back(sun);
  }

  if (!environment.map) return;
  const Image& map = *environment.map;
  intensity_ = environment.intensity;
  backdrop_ = environment.backdrop;
  if (backdrop_) {
    CANDELA_CHECK_EQ(backdrop_->width, map.width);
    CANDELA_CHECK_EQ(backdrop_->height, map.height);
  }
  width_ = map.width;
  height_ = map.height;
  resize_large(texels_, static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      texels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)] =
          vec4(map.rgb(x, y) * environment.intensity + constant_, 0.0f);
    }
  }
  build_distribution();
}

void EnvironmentLight::build_distribution() {
  const auto w = static_cast<std::size_t>(width_);
  const auto h = static_cast<std::size_t>(height_);

  // ----- mean luminance of every cell under bilinear filtering: neighbours weigh 1/8, the texel itself 6/8, per axis
  std::vector<float> across(w * h);
  std::vector<float> mean(w * h);
  const auto lum = [&](std::size_t i) { return luminance(vec3(texels_[i])); };
  for (std::size_t y = 0; y < h; ++y) {
    for (std::size_t x = 0; x < w; ++x) {
      const std::size_t left = y * w + (x + w - 1) % w;
      const std::size_t right = y * w + (x + 1) % w;
      across[y * w + x] = 0.125f * (lum(left) + lum(right)) + 0.75f * lum(y * w + x);
    }
  }
  std::vector<double> row_solid_angle(h);
  double flux = 0.0;
  for (std::size_t y = 0; y < h; ++y) {
    const std::size_t up = y == 0 ? 0 : y - 1;
    const std::size_t down = std::min(y + 1, h - 1);
    const double top = std::cos(static_cast<double>(y) / static_cast<double>(h) * std::numbers::pi);
    const double bottom = std::cos(static_cast<double>(y + 1) / static_cast<double>(h) * std::numbers::pi);
    row_solid_angle[y] = (top - bottom) * 2.0 * std::numbers::pi / static_cast<double>(w);
    for (std::size_t x = 0; x < w; ++x) {
      mean[y * w + x] = 0.125f * (across[up * w + x] + across[down * w + x]) + 0.75f * across[y * w + x];
      flux += static_cast<double>(mean[y * w + x]) * row_solid_angle[y];
    }
  }
  flux_ = static_cast<float>(flux);

  // ----- what exceeds the mean over the sphere is sampled here
  const auto average = static_cast<float>(flux / (4.0 * std::numbers::pi));
  for (std::size_t y = 0; y < h; ++y) {
    for (std::size_t x = 0; x < w; ++x) {
      float& m = mean[y * w + x];
      m = std::max(m - average, 0.0f) * static_cast<float>(row_solid_angle[y]);
    }
  }
  distribution_ = Distribution2D(mean, width_, height_);
  // A map without contrast has nothing above its mean; rounding alone must not become a light.
  can_sample_ = distribution_.total() > 1e-4 * flux;
  if (!can_sample_) return;
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      texels_[static_cast<std::size_t>(y) * w + static_cast<std::size_t>(x)].w = distribution_.pdf({x, y});
    }
  }
}

inline EnvironmentLight::Footprint EnvironmentLight::locate_uv(vec2 uv) const {
  const shade::FootprintAxis across = shade::footprint_linear(uv.x, width_, shade::kFootprintRepeat);
  const shade::FootprintAxis down = shade::footprint_linear(uv.y, height_, shade::kFootprintClamp);
  const auto w = static_cast<std::uint32_t>(width_);
  const std::uint32_t top = w * static_cast<std::uint32_t>(down.first);
  const std::uint32_t bottom = w * static_cast<std::uint32_t>(down.second);
  Footprint f;
  f.offsets[0] = top + static_cast<std::uint32_t>(across.first);
  f.offsets[1] = top + static_cast<std::uint32_t>(across.second);
  f.offsets[2] = bottom + static_cast<std::uint32_t>(across.first);
  f.offsets[3] = bottom + static_cast<std::uint32_t>(across.second);
  f.tx = across.share;
  f.ty = down.share;
  f.cell = w * static_cast<std::uint32_t>(shade::footprint_nearest(uv.y, height_).first) +
           static_cast<std::uint32_t>(shade::footprint_nearest(uv.x, width_).first);
  __builtin_prefetch(texels_.data() + f.offsets[0]);
  __builtin_prefetch(texels_.data() + f.offsets[2]);
  return f;
}

EnvironmentLight::Footprint EnvironmentLight::locate(vec3 world) const {
  if (texels_.empty()) return {};
  const vec3 d = map_from_world(world);
  const float sin_theta = std::sqrt(d.x * d.x + d.z * d.z);
  Footprint f = locate_uv(shade::panorama_uv(d, sin_theta));
  f.sin_theta = std::max(sin_theta, 1e-6f);
  return f;
}

EnvironmentLight::Value EnvironmentLight::read(const Footprint& f) const {
  if (texels_.empty()) return {constant_, 0.0f};
  const auto at = [&](int i) { return vec3(texels_[f.offsets[i]]); };
  Value value;
  value.radiance = bilinear(at, f.tx, f.ty);
  value.pdf = texels_[f.cell].w / (2.0f * kPi * kPi * f.sin_theta);
  return value;
}

vec3 EnvironmentLight::background(vec3 direction) const {
  const Footprint f = locate(direction);
  if (backdrop_) {
    const auto at = [&](int i) {
      const float* p =
          backdrop_->pixels.data() + std::size_t{f.offsets[i]} * static_cast<std::size_t>(backdrop_->channels);
      return vec3(p[0], p[1], p[2]);
    };
    return intensity_ * bilinear(at, f.tx, f.ty) + constant_;
  }
  return radiance(direction, f);
}

float EnvironmentLight::contrast(std::span<const vec3> corners, Sight sight) const {
  constexpr int kMostTexels = 8;  // along each axis
  const bool sees_backdrop = sight == Sight::backdrop && backdrop_;
  vec3 middle(0.0f);
  for (const vec3& corner : corners) middle += corner;
  middle = glm::normalize(middle);
  if (sight != Sight::map && !sees_backdrop) {
    float reach = 0.0f;  // sine of the angle from the middle to the farthest corner
    for (const vec3& corner : corners) reach = std::max(reach, glm::length(glm::cross(middle, corner)));
    for (const Sun& sun : suns_) {
      const vec3 towards = sun.frame.to_local(middle);
      if (towards.z > 0.0f && std::hypot(towards.x, towards.y) <= 1.01f * (reach + std::sqrt(sun.sin2_radius)))
        return kInfinity;
    }
  }
  if (texels_.empty()) return 0.0f;

  // ----- the texels between the corners, and those that filtering mixes in; columns relative to the middle's
  const auto uv_of = [&](vec3 direction) {
    const vec3 d = map_from_world(direction);
    return shade::panorama_uv(d, std::hypot(d.x, d.z));
  };
  const vec2 size(width_, height_);
  const vec2 origin = uv_of(middle) * size;
  vec2 lower(0.0f), upper(0.0f);
  for (const vec3& corner : corners) {
    vec2 offset = uv_of(corner) * size - origin;
    offset.x -= size.x * std::round(offset.x / size.x);
    lower = glm::min(lower, offset);
    upper = glm::max(upper, offset);
  }
  const ivec2 first(glm::floor(origin + lower - 0.5f));
  const ivec2 last(glm::floor(origin + upper + 0.5f));
  if (last.x - first.x >= kMostTexels || last.y - first.y >= kMostTexels) return kInfinity;
  float least = kInfinity, most = 0.0f, sum = 0.0f;
  for (int y = first.y; y <= last.y; ++y) {
    for (int x = first.x; x <= last.x; ++x) {
      const int column = (x % width_ + width_) % width_;
      const int row = std::clamp(y, 0, height_ - 1);
      const float l = luminance(sees_backdrop ? backdrop_->rgb(column, row) * intensity_ + constant_
                                              : vec3(texels_[static_cast<std::size_t>(row * width_ + column)]));
      least = std::min(least, l);
      most = std::max(most, l);
      sum += l;
    }
  }
  if (!(most > least)) return 0.0f;
  const ivec2 count = last - first + 1;
  const vec2 extent = upper - lower;  // within one texel light changes evenly
  return (most - least) * std::min(extent.x + extent.y, 1.0f) * static_cast<float>(count.x * count.y) / sum;
}

vec3 EnvironmentLight::radiance(vec3 direction, const Footprint& footprint) const {
  vec3 sum = read(footprint).radiance;
  for (const Sun& sun : suns_) {
    if (sun.contains(direction)) sum += sun.radiance;
  }
  return sum;
}

EnvironmentLight::Sample EnvironmentLight::sample(vec2 u) const {
  const Distribution2D::Sample s = distribution_.sample(u);
  const float sin_theta = shade::panorama_sine(s.uv.y);
  Sample sample;
  sample.direction = world_from_map(shade::panorama_direction(s.uv, sin_theta));
  sample.footprint = locate_uv(s.uv);
  sample.footprint.sin_theta = sin_theta;
  sample.pdf = s.pdf / (2.0f * kPi * kPi * sin_theta);
  return sample;
}

}  // namespace candela::path
