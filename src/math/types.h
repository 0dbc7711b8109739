#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>

namespace candela {

using glm::dvec2;
using glm::dvec3;
using glm::ivec2;
using glm::ivec3;
using glm::mat2;
using glm::mat2x3;
using glm::mat3;
using glm::mat4;
using glm::quat;
using glm::uvec2;
using glm::uvec3;
using glm::uvec4;
using glm::vec2;
using glm::vec3;
using glm::vec4;

inline constexpr float kPi = 3.14159265358979323846f;
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

inline constexpr float radians(float deg) { return deg * (kPi / 180.0f); }
inline constexpr float degrees(float rad) { return rad * (180.0f / kPi); }

/// Relative luminance of linear Rec.709 (ITU-R BT.709-6).
inline float luminance(vec3 rgb) { return 0.2126f * rgb.x + 0.7152f * rgb.y + 0.0722f * rgb.z; }
inline double luminance(dvec3 rgb) { return 0.2126 * rgb.x + 0.7152 * rgb.y + 0.0722 * rgb.z; }
inline float max_component(vec3 v) { return glm::max(v.x, glm::max(v.y, v.z)); }
inline bool is_finite(float v) { return std::isfinite(v); }
inline bool is_finite(vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
inline vec3 transform_point(const mat4& m, vec3 p) { return vec3(m * vec4(p, 1.0f)); }
inline vec3 transform_vector(const mat4& m, vec3 v) { return vec3(m * vec4(v, 0.0f)); }

/// Axis-aligned box; empty until extended.
struct Box3 {
  vec3 lower{kInfinity};
  vec3 upper{-kInfinity};

  bool empty() const { return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z); }
  void extend(vec3 p) { lower = glm::min(lower, p), upper = glm::max(upper, p); }
  void extend(const Box3& b) { lower = glm::min(lower, b.lower), upper = glm::max(upper, b.upper); }
  vec3 center() const { return 0.5f * (lower + upper); }
  vec3 size() const { return upper - lower; }
};

}  // namespace candela
