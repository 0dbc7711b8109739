// Lamps and shining surfaces: what of their light arrives.
#include "shade/lights.glsl.h"

// Mirrors raster/blocks.h, which says what each member is.
struct Light {
  vec3 position;
  int kind;
  vec3 direction;
  float range;
  vec3 color;
  int falloff;
  vec3 polynomial;
  int profile;
  vec3 across;
  float handedness;
  float cos_inner;
  float cos_outer;
  float sun_radius;
  int first_shadow;
  int shadow_count;
};

struct Area {
  vec3 corner_0;
  float radius;
  vec3 corner_1;
  float half_side;
  vec3 corner_2;
  float extent;
  vec3 corner_3;
  int is_body;
  vec3 color;
  int has_two_sides;
  int first_shadow;
  int shadow_count;
};

struct Shadow {
  mat4 from_world;
  float texel;
  int is_perspective;
  float near;
  float far;
};

layout(std140) uniform Lights {
  Light lights[kMostLights];
  Shadow shadows[kMostShadows];
  Area areas[kMostAreas];
};

uniform highp sampler2DArray light_profiles;

#include "shadows.glsl"

// Of half a cascade's map: what is filtered at its edge would read beyond it.
const float kCascadeEdge = 0.97;
const float kLeastDistance = 1e-20;  // m, to a light: none is divided by

/// Which cascade of a directional light holds a point: the finest that does.
int light_cascade(Light light, vec3 position) {
  int first = light.first_shadow, last = light.shadow_count - 1;
  for (int i = 0; i < last; ++i) {
    vec3 at = shadow_point(first + i, position);
    vec2 edge = abs(at.xy * 2.0 - 1.0);
    if (max(edge.x, edge.y) < kCascadeEdge && at.z > 0.0 && at.z < 1.0) return i;
  }
  return last;
}

/// Which of six views from a point, in the order +x -x +y -y +z -z, sees what lies towards -wi.
int shadow_face(vec3 wi) {
  vec3 a = abs(wi);
  return a.x >= a.y && a.x >= a.z ? (wi.x > 0.0 ? 1 : 0) : a.y >= a.z ? (wi.y > 0.0 ? 3 : 2) : (wi.z > 0.0 ? 5 : 4);
}

float light_shadow(Light light, vec3 position, vec3 normal, vec3 wi) {
  int layer = light.first_shadow;
  if (layer < 0) return 1.0;
  bool is_directional = light.kind == kDirectionalLight;
  if (light.kind == kPointLight) layer += shadow_face(wi);
  if (is_directional) layer += light_cascade(light, position);
  return shadow_in(layer, position, normal, dot(normal, wi), is_directional ? light.sun_radius : light_radius);
}

#ifdef HAS_AREAS
// A surface is no lamp to itself. It is taken for the lamp's own within this much more than the lamp's reach from its
// middle, and this near to its plane, over the radius of a disc as large: lamps are not quite flat. Any surface is
// within a body that shines where it is nearer than the corner of its square, which is √2 of the half side, less a
// little.
const float kOwnReach = 1.05;
const float kOwnDepth = 0.3;
const float kBodyReach = 1.2;

vec3 area_middle(Area area) {
  return area.is_body == 1 ? area.corner_0 : 0.25 * (area.corner_0 + area.corner_1 + area.corner_2 + area.corner_3);
}

/// The corners of an area light from a point, relative to it; false where it shines elsewhere, and where the point is
/// on the lamp itself, if it is of a surface that `is_own`.
bool area_corners(Area area, bool is_own, vec3 position, out vec3 c[4]) {
  if (area.is_body == 1) {
    vec3 to = area.corner_0 - position;
    float distance = length(to);
    if (distance < (is_own ? kOwnReach * area.extent : kBodyReach * area.half_side)) return false;  // within the body
    vec3 z = to / distance;
    vec3 x = shade_tangent(z) * area.half_side;
    vec3 y = cross(z, x);
    c[0] = to - x - y, c[1] = to + x - y, c[2] = to + x + y, c[3] = to - x + y;
    return true;
  }
  c[0] = area.corner_0 - position, c[1] = area.corner_1 - position;
  c[2] = area.corner_2 - position, c[3] = area.corner_3 - position;
  vec3 n = cross(c[1] - c[0], c[2] - c[0]);
  float front = -dot(n, c[0]);
  if (is_own && abs(front) < kOwnDepth * area.radius * length(n) &&
      distance(area_middle(area), position) < kOwnReach * area.extent)
    return false;
  return front > 0.0 || area.has_two_sides == 1;
}

float area_shadow(Area area, vec3 position, vec3 normal) {
  int layer = area.first_shadow;
  if (layer < 0) return 1.0;
  vec3 center = area_middle(area);
  if (area.is_body == 0 && area.shadow_count > 1) {
    vec3 n = cross(area.corner_1 - area.corner_0, area.corner_2 - area.corner_0);
    if (dot(n, position - center) < 0.0) ++layer;
  }
  vec3 wi = normalize(center - position);
  if (area.is_body == 1) layer += shadow_face(wi);
  return shadow_in(layer, position, normal, dot(normal, wi), area.radius);
}
#endif

/// Irradiance on a surface that faces the light, and the direction towards it.
vec3 light_arriving(Light light, vec3 position, out vec3 wi) {
  if (light.kind == kDirectionalLight) {
    wi = -light.direction;
    return light.color;
  }
  vec3 to_light = light.position - position;
  float distance = length(to_light);
  wi = to_light / max(distance, kLeastDistance);
  PunctualLamp lamp;
  lamp.kind = light.kind;
  lamp.direction = light.direction;
  lamp.range = light.range;
  lamp.falloff = light.falloff;
  lamp.polynomial = light.polynomial;
  lamp.cos_inner = light.cos_inner;
  lamp.cos_outer = light.cos_outer;
  lamp.across = light.across;
  lamp.handedness = light.handedness;
  vec3 e = light.color * light_left(lamp, wi, distance);
  if (light.profile >= 0) {
    vec2 angles = light_profile_angles(light_local(lamp, wi));
    vec2 size = vec2(textureSize(light_profiles, 0).xy);
    // Entries stand at both ends of either axis.
    vec2 at = (vec2(fract(angles.x / (2.0 * kShadePi)), angles.y / kShadePi) * (size - 1.0) + 0.5) / size;
    e *= texture(light_profiles, vec3(at, float(light.profile))).x;
  }
  return e;
}
