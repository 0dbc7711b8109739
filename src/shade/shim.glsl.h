#ifndef CANDELA_SHADE_SHIM_GLSL_H
#define CANDELA_SHADE_SHIM_GLSL_H

// The one place that knows which compiler reads the material source: C++ (with glm) or GLSL ES 3.00.
// Every other *.glsl.h is the subset both accept: free functions and plain structs, 0.5f literals, no swizzles,
// no references, no recursion, no globals, structs filled member by member.

#ifdef __cplusplus
#include <glm/glm.hpp>

#define SHADE_BEGIN namespace candela::shade {
#define SHADE_END }
#define SHADE_FN inline
#define SHADE_CONST constexpr
// Structs too large to copy: read only, and filled in place.
#define SHADE_IN(Type) const Type&
#define SHADE_INOUT(Type) Type&
// Kept out of its callers, so that what most surfaces never need does not crowd what they do.
#define SHADE_APART [[gnu::noinline]]
// How often a loop runs that a compiler of shaders, which makes one function of everything, shall not unroll.
#define SHADE_TIMES(n) (n)

namespace candela::shade {

using glm::mat3;
using glm::vec2;
using glm::vec3;
using glm::vec4;

using glm::abs;
using glm::acos;
using glm::asin;
using glm::atan;
using glm::clamp;
using glm::cos;
using glm::cross;
using glm::dot;
using glm::exp;
using glm::exp2;
using glm::floatBitsToInt;
using glm::floor;
using glm::fract;
using glm::inversesqrt;
using glm::length;
using glm::log;
using glm::log2;
using glm::max;
using glm::min;
using glm::mix;
using glm::mod;
using glm::normalize;
using glm::pow;
using glm::reflect;
using glm::sign;
using glm::sin;
using glm::smoothstep;
using glm::sqrt;
using glm::step;
using glm::tan;

}  // namespace candela::shade
#else
#define SHADE_BEGIN
#define SHADE_END
#define SHADE_FN
#define SHADE_CONST const
#define SHADE_IN(Type) Type
#define SHADE_INOUT(Type) inout Type
#define SHADE_APART
uniform int shade_nothing;  // 0, which no compiler knows
#define SHADE_TIMES(n) ((n) + shade_nothing)
#endif

SHADE_BEGIN

SHADE_CONST float kShadePi = 3.14159265358979f;

SHADE_FN float shade_sqr(float x) { return x * x; }
SHADE_FN float shade_saturate(float x) { return clamp(x, 0.0f, 1.0f); }
SHADE_FN float shade_max3(vec3 v) { return max(v.x, max(v.y, v.z)); }

SHADE_END

#endif
