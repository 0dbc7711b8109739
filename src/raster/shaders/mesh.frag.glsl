// A surface and the light that it sends to the eye: the frame of what mesh_*.glsl does.
#include "frame.glsl"
#include "shade/image_light.glsl.h"
#include "shade/dispersion.glsl.h"
#include "shade/shading_normal.glsl.h"
#include "shade/workflow.glsl.h"
#include "material.glsl"
#include "material_fetch.glsl"
#ifdef HAS_AREAS
#include "shade/area_light.glsl.h"
#endif
#ifdef HAS_LIGHTS
#include "lights.glsl"
#endif

in vec3 v_position;
in vec3 v_normal;
#ifdef HAS_TANGENT
in vec4 v_tangent;
#endif
#ifdef HAS_COLOR
in vec4 v_color;
#endif
#ifdef HAS_SCALE
flat in float v_scale;
#endif
#ifdef HAS_AREAS
uniform int own_areas;  // bit i: area light i is part of this surface
#endif

uniform highp samplerCube specular_light;
uniform highp samplerCube diffuse_light;
#ifdef HAS_SHEEN_LIGHT
uniform highp samplerCube sheen_light;
#endif
#ifdef HAS_SCREEN_OCCLUSION
uniform highp sampler2D screen_visibility;
#endif
#ifdef HAS_OPAQUE_PICTURE
uniform highp sampler2D opaque_picture;
#endif

#ifdef SURFACE_MAP
flat in ivec2 v_place;
in vec2 v_corner;
#elif defined(SHOW) && SHOW == SHOW_id
uniform float object_id;
#endif

layout(location = 0) out vec4 o_color;
#if defined(HAS_SCATTERING) && !defined(SHOW)
layout(location = 1) out vec4 o_scattered;  // light that spreads; a: distance along the view
layout(location = 2) out vec4 o_width;      // and how wide
#endif

#ifdef HAS_THROUGH
layout(location = 3) out vec4 o_through;  // what glass lets through of a background that is not in the picture
vec3 seen_through = vec3(0.0);
#endif

// What half floats hold: beyond it a picture would have infinities.
const float kMostHalf = 65504.0;

#include "mesh_point.glsl"
#include "mesh_material.glsl"
#include "mesh_far_light.glsl"
#ifdef HAS_LIGHTS
#include "mesh_lamps.glsl"
#endif
#ifdef IS_SCATTERING
#include "mesh_scattering.glsl"
#endif
#if (defined(BLENDED_PART) || defined(IN_BODY)) && !defined(SHOW)
#include "mesh_layers.glsl"
#endif

struct Shading {
  Point point;
  SurfaceParams params;
  Surface surface;
  mat3 frame;
  vec3 wo;  // local
};

/// Fetches textures and prepares the closure.
Shading prepare(bool is_back) {
  Point p = make_point(is_back);
  SurfaceParams params = fetch_params();
  float own_alpha = roughness_to_alpha(params.roughness);
  params.roughness = max(antialiased_roughness(params.roughness, p.normal), least_roughness);
  p.widened = max(shade_sqr(roughness_to_alpha(params.roughness)) - own_alpha * own_alpha, 0.0);
#if defined(IN_BODY) && defined(HAS_BODY)
  if (is_back) params.eta = 1.0 / max(params.ior, 1.0);
#endif

  // ----- the local frame
  vec3 tangent = anisotropy_direction(p.front_tangent, p.front_bitangent);
  vec3 t = tangent - p.normal * dot(p.normal, tangent);
  float t2 = dot(t, t);
  t = t2 > kLeastTangent2 ? t * inversesqrt(t2) : shade_tangent(p.normal);
  mat3 frame = mat3(t, cross(p.normal, t), p.normal);
  vec3 wo = p.wo * frame;
#ifdef LOBE_clearcoat
  params.clearcoat_normal = normal_kept_outside(p.coat_normal, p.geometric, p.wo) * frame;
#endif
#ifdef HAS_TANGENT
  fetch_directions(p.front_tangent, p.front_bitangent, frame, params);
#endif
  Surface s = surface_prepare(params, wo);
  Shading h;
  h.point = p;
  h.params = params;
  h.surface = s;
  h.frame = frame;
  h.wo = wo;
  return h;
}

#ifdef IS_EMISSIVE
vec3 emitted_light(Surface s) {
  vec3 emitted = material.emission * surface_emission_scale(s);
#ifdef emission_factor
  emitted *= emission_factor();
#endif
  return emitted;
}
#endif

vec4 shaded() {
#ifdef IS_UNLIT
  return vec4(fetch_base_color(), 1.0);
#else
  bool is_back = !gl_FrontFacing;
  Shading h = prepare(is_back);
  Point p = h.point;
  Surface s = h.surface;
  mat3 frame = h.frame;
  vec3 wo = h.wo;
  SurfaceShares shares = surface_shares(s, wo);
  vec3 color = far_light(p, h.params, s, shares, wo, frame);
#ifdef IS_SCATTERING
#ifdef HAS_SCATTERING
  o_scattered = vec4(scattered_light(p, shares), dot(eye - v_position, back));
  o_width = vec4(material.scatter_width * v_scale, 0.0);
#else
  color += scattered_light(p, shares);
#endif
#endif
#ifdef HAS_LIGHTS
  color += part(kDirectPart) * direct_light(p, s, shares, wo, frame);
#endif
#ifdef IS_EMISSIVE
  color += part(kEmissionPart) * emitted_light(s);
#endif
  return vec4(color, 1.0);
#endif
}

#ifdef SHOW
#include "mesh_quantity.glsl"
#endif

// Of opacity per pixel: below it an edge is as wide as the picture.
const float kFlattestEdge = 1e-4;

void main() {
  float opacity = 1.0;
#ifdef HAS_height
  vec3 wo = is_perspective > 0.5 ? normalize(eye - v_position) : back;
  vec3 n = normalize(v_normal);
  find_relief(dot(n, wo) < 0.0 ? -n : n, wo);
#endif
#if defined(HAS_SCATTERING) && !defined(SHOW)
  o_scattered = vec4(0.0);
  o_width = vec4(0.0);
#endif
#ifdef ALPHA_MASK
  float a = fetch_opacity();
#ifdef ALPHA_TO_COVERAGE
  // One texel of the picture wide, around the cutoff.
  opacity = clamp((a - material.drawn_cutoff) / max(fwidth(a), kFlattestEdge) + 0.5, 0.0, 1.0);
  if (opacity <= 0.0) discard;
#else
  if (a < material.drawn_cutoff) discard;
#endif
#endif
#ifdef ALPHA_BLEND
  opacity = clamp(fetch_opacity(), 0.0, 1.0);
#ifdef OPAQUE_PART
  if (opacity < kOpaqueAlpha) discard;
  opacity = 1.0;
#endif
#if defined(BLENDED_PART) && !defined(SHOW)
  if (opacity >= kWholeAlpha || opacity < kLeastAlpha || is_elsewhere()) discard;
#endif
#endif
#ifdef SHOW
#if defined(ALPHA_BLEND) && SHOW != SHOW_opacity && SHOW != SHOW_overdraw
  if (opacity < kOpacityOfLayers) discard;  // shown is what is there for the better part
#endif
  o_color = quantity(opacity);
#else
  o_color = min(shaded(), vec4(kMostHalf));
#endif
#ifdef HAS_THROUGH
  o_through = vec4(seen_through, 1.0);
#endif
#if defined(IN_BODY) && !defined(SHOW)
  vec3 passing = passing_body();
  o_color.rgb *= passing;
#ifdef HAS_SCATTERING
  o_scattered.rgb *= passing;
#endif
#ifdef HAS_THROUGH
  o_through.rgb *= passing;
#endif
#endif
#if defined(ALPHA_BLEND) && !defined(SHOW)
  o_color = o_color * opacity;
#ifdef HAS_THROUGH
  o_through = o_through * opacity;
#endif
#endif
#ifdef ALPHA_TO_COVERAGE
  o_color.a = opacity;
#endif
}
