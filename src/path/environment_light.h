#pragma once

#include <memory>
#include <span>
#include <vector>

#include "math/distribution.h"
#include "math/frame.h"
#include "scene/scene.h"

namespace candela::path {

/// The environment map as the integrator uses it: radiance and sampling density side by side, one lookup for both.
/// Sampled by luminance × solid angle above the mean (MIS compensation, Karlík et al. 2019, "MIS Compensation:
/// Optimizing Sampling Techniques in Multiple Importance Sampling", §5): what lies below is left to the material's
/// samples.
class EnvironmentLight {
 public:
  explicit EnvironmentLight(const Environment& environment);

  struct Value {
    vec3 radiance{0.0f};
    float pdf = 0.0f;  ///< of sample(), per solid angle
  };
  /// The texels that a direction reads. Finding them starts the memory access: do something else before read().
  struct Footprint {
    std::uint32_t offsets[4] = {};
    float tx = 0.0f, ty = 0.0f;
    std::uint32_t cell = 0;
    float sin_theta = 1.0f;
  };
  /// `direction` is unit, world space.
  Footprint locate(vec3 direction) const;
  /// Without the suns.
  Value read(const Footprint& footprint) const;
  Value evaluate(vec3 direction) const { return read(locate(direction)); }

  /// Map and suns together. `footprint` is locate(direction).
  vec3 radiance(vec3 direction, const Footprint& footprint) const;
  /// What the camera sees in a direction: the backdrop where there is one, else the map and the suns.
  vec3 background(vec3 direction) const;

  /// What a pixel sees: the map alone, its suns too, or the backdrop (where there is none, map and suns).
  enum class Sight { map, lights, backdrop };
  /// Difference between the brightest and the darkest luminance that is seen between `corners`, over their mean;
  /// infinite where a sun is seen, or more texels than it is worth to look at. Unit directions, world space.
  float contrast(std::span<const vec3> corners, Sight sight) const;

  struct Sample {
    vec3 direction{0, 1, 0};
    float pdf = 0.0f;
    Footprint footprint;  ///< of the direction: read() gives the radiance, and the same density
  };
  /// Only when can_sample().
  Sample sample(vec2 u) const;
  /// Starts the memory access that sample(u) will wait for.
  void prefetch_sample(vec2 u) const { distribution_.prefetch(u); }

  bool can_sample() const { return can_sample_; }
  /// ∫ L dω of the map, luminance; for choosing between lights.
  float flux() const { return flux_; }

  struct Sun {
    Frame frame;               ///< +z towards it
    float sin2_radius = 0.0f;  ///< sin² of the angular radius: its cosine has too few digits in single precision
    float solid_angle = 0.0f;
    vec3 radiance{0.0f};

    bool contains(vec3 direction) const {
      const vec3 local = frame.to_local(direction);
      return local.z > 0.0f && local.x * local.x + local.y * local.y <= sin2_radius;
    }
  };
  const std::vector<Sun>& suns() const { return suns_; }

 private:
  Footprint locate_uv(vec2 uv) const;
  vec3 world_from_map(vec3 v) const {
    return {v.x * cos_rotation_ + v.z * sin_rotation_, v.y, -v.x * sin_rotation_ + v.z * cos_rotation_};
  }
  vec3 map_from_world(vec3 v) const {
    return {v.x * cos_rotation_ - v.z * sin_rotation_, v.y, v.x * sin_rotation_ + v.z * cos_rotation_};
  }
  void build_distribution();

  int width_ = 0;
  int height_ = 0;
  float cos_rotation_ = 1.0f;
  float sin_rotation_ = 0.0f;
  vec3 constant_{0.0f};
  std::vector<vec4> texels_;  ///< radiance and density over uv
  std::shared_ptr<const Image> backdrop_;
  float intensity_ = 1.0f;
  Distribution2D distribution_;
  bool can_sample_ = false;
  float flux_ = 0.0f;
  std::vector<Sun> suns_;
};

/// An environment and what was made of it, for the tracers of all scenes under it.
struct PreparedEnvironment {
  explicit PreparedEnvironment(const Environment& given) : environment(given), light(given) {}

  Environment environment;
  EnvironmentLight light;
};

}  // namespace candela::path
