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

#if defined(SHOW) && SHOW == SHOW_id
uniform float object_id;
#endif
#if (defined(BLENDED_PART) || defined(IN_BODY)) && !defined(SHOW)
#include "layer_slack.glsl"

// Depths of this picture: of the nearest glass, of the boundary of the body that the eye is in, then of blended surfaces
// from near to far.
uniform highp sampler2DArray depth_layers;
#endif
#if defined(BLENDED_PART) && !defined(SHOW)
uniform ivec4 depth_slice;  // the layers between which a draw shows what is there, or -1; that of glass, or -1; 1: what
                            // is before it, 0: all else
#endif
#ifdef IN_BODY
uniform vec3 body_extinction;
#ifndef LOBE_transmission
uniform float body_share;  // of radiance in it that is left outside, where the lens is: 1 over the square of its index
#endif
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

// ----- geometry

struct Point {
  vec3 wo;         // world
  vec3 geometric;  // unit, on the viewer's side
  vec3 vertex_normal;    // of the vertices
  vec3 normal;     // mapped
  vec3 coat_normal;
  vec3 front_tangent;  // of the front; 0: there is none
  vec3 front_bitangent;
};

#ifdef HAS_height
/// What to take of dFdx and dFdy for how a quantity changes along a direction in the surface.
vec2 steps_along(vec3 direction, vec3 n) {
  vec3 px = dFdx(v_position), py = dFdy(v_position);
  vec3 ax = cross(py, n), ay = cross(n, px);
  float area = dot(px, ax);
  return abs(area) < 1e-20 ? vec2(0.0) : vec2(dot(ax, direction), dot(ay, direction)) / area;
}

vec2 relief_dx, relief_dy;  // how the height map's coordinates change over the mesh, from pixel to pixel

float relief_at(vec2 uv) { return texture(height_texture, uv).r; }

void move_uvs(vec2 steps) {
  surface_uv = v_uv + dFdx(v_uv) * steps.x + dFdy(v_uv) * steps.y;
#ifdef MORE_UVS
  for (int i = 0; i < MORE_UVS; ++i) {
    surface_more_uv[i] = v_more_uv[i] + dFdx(v_more_uv[i]) * steps.x + dFdy(v_more_uv[i]) * steps.y;
  }
#endif
}

/// Moves surface_uv to where the view meets the relief below, and partly above, the mesh. Policarpo, Oliveira & Comba 2005,
/// "Real-Time Relief Mapping on Arbitrary Polygonal Surfaces": a linear search, then the chord of the last step.
void find_relief(vec3 n, vec3 wo) {
  move_uvs(vec2(0.0));
  float depth = material.height_scale * v_scale;
  float cosine = max(dot(n, wo), 0.08);
  // From the top of the relief, as far as the view goes sideways down to its bottom.
  vec2 steps_down = steps_along((n * dot(n, wo) - wo) / cosine, n) * depth;
  vec2 middle = height_uv();
  relief_dx = dFdx(middle), relief_dy = dFdy(middle);
  vec2 sideways = relief_dx * steps_down.x + relief_dy * steps_down.y;
  vec2 uv = middle - sideways * (1.0 - material.height_level);
  int steps = int(mix(40.0, 12.0, cosine));
  float last_gap = 1.0 - relief_at(uv);
  float t = 0.0, dt = 1.0 / float(steps);
  for (int i = 1; i <= steps && last_gap > 0.0; ++i) {
    float next = float(i) * dt;
    float gap = 1.0 - next - relief_at(uv + sideways * next);
    if (gap <= 0.0) {
      t = next - dt * (-gap / max(last_gap - gap, 1e-6));
      break;
    }
    last_gap = gap;
    t = next;
  }
  move_uvs(steps_down * (t - 1.0 + material.height_level));
}

/// What the relief makes of a normal that no map tells of.
vec3 relief_normal(vec3 n) {
  vec3 x = shade_tangent(n), y = cross(n, x);
  // The map's coordinates change over the mesh as where they are looked up does.
  vec2 uv = height_uv(), sx = steps_along(x, n), sy = steps_along(y, n);
  vec2 dx_uv = relief_dx, dy_uv = relief_dy;
  // Half a pixel to either side, or half a texel where that is more.
  vec2 texels = vec2(textureSize(height_texture, 0));
  vec2 ux = dx_uv * sx.x + dy_uv * sx.y, uy = dx_uv * sy.x + dy_uv * sy.y;
  float per_metre = max(length(ux * texels), length(uy * texels));
  float step = max(0.5 * length(fwidth(v_position)), 0.5 / max(per_metre, 1e-12));
  float dx = relief_at(uv + ux * step) - relief_at(uv - ux * step);
  float dy = relief_at(uv + uy * step) - relief_at(uv - uy * step);
  return normalize(n - (x * dx + y * dy) * (material.height_scale * v_scale / (2.0 * step)));
}
#endif

Point make_point(bool is_back) {
  Point p;
  p.wo = is_perspective > 0.5 ? normalize(eye - v_position) : back;
  vec3 ng = cross(dFdx(v_position), dFdy(v_position));
  float ng2 = dot(ng, ng);
  ng = ng2 > 0.0 ? ng * inversesqrt(ng2) : p.wo;
  if (dot(ng, p.wo) < 0.0) ng = -ng;
  p.geometric = ng;
  float n2 = dot(v_normal, v_normal);
  vec3 ns = n2 > 1e-12 ? v_normal * inversesqrt(n2) : ng;
  if (dot(ns, ng) < 0.0) ns = -ns;
  p.vertex_normal = ns;
#if defined(HAS_height) && !defined(HAS_normal)
  ns = relief_normal(ns);
#endif
  p.coat_normal = ns;
  p.front_tangent = vec3(0.0);
  p.front_bitangent = vec3(0.0);
#ifdef HAS_TANGENT
  float side = is_back ? -1.0 : 1.0;
  vec3 nf = ns * side;
  vec3 t = v_tangent.xyz - nf * dot(nf, v_tangent.xyz);
  float t2 = dot(t, t);
  t = t2 > 1e-16 ? t * inversesqrt(t2) : shade_tangent(nf);
  bool flip = v_tangent.w < 0.0;
  mat3 front = mat3(t, cross(nf, t), nf);
#ifdef HAS_clearcoat_normal
  p.coat_normal = normal_mapped(clearcoat_normal_texel().xyz, material.clearcoat_normal_scale, front, flip, ns, side);
#endif
#ifdef HAS_normal
  ns = normal_mapped(normal_texel().xyz, material.normal_scale, front, flip, ns, side);
#endif
  p.front_tangent = front[0];
  p.front_bitangent = flip ? -front[1] : front[1];
#endif
  p.normal = normal_kept_outside(ns, ng, p.wo);
  return p;
}

// ----- material

float fetch_opacity() {
  float a = material.opacity;
#ifdef HAS_COLOR
  a *= v_color.a;
#endif
#ifdef opacity_factor
  a *= opacity_factor();
#endif
  return a;
}

vec3 fetch_base_color() {
  vec3 c = material.base_color;
#ifdef HAS_COLOR
  c *= v_color.rgb;
#endif
#ifdef base_color_factor
  c *= base_color_factor();
#endif
  return c;
}

SurfaceParams fetch_params() {
  SurfaceParams p = surface_params_default();
  p.lobes = LOBES;
  fetch_factors(p);
  p.base_color = fetch_base_color();
  p.is_thin = material.thickness <= 0.0;
  p.eta = material.ior;
#ifdef IS_SPECULAR_GLOSSINESS
#ifdef HAS_specular_glossiness
  vec4 sg = specular_glossiness_texel();
  p.specular_color *= sg.rgb;
  p.roughness = workflow_roughness(p.roughness, sg.a);
#endif
  p.base_color = workflow_base_color(p.base_color, p.specular_color);
#endif
#ifdef MODEL_BLEND
  p.model.distribution = MODEL_DISTRIBUTION;
  p.model.masking = MODEL_MASKING;
  p.model.fresnel = MODEL_FRESNEL;
  p.model.diffuse = MODEL_DIFFUSE;
  p.model.blend = MODEL_BLEND;
  p.model.multiscatter = MODEL_MULTISCATTER == 1;
  p.model.literal_layers = MODEL_LITERAL_LAYERS == 1;
#endif
  return p;
}

/// Widens a lobe by how the normal turns within a pixel. Tokuyoshi & Kaplanyan 2021, "Stable Geometric Specular
/// Antialiasing with Projected-Space NDF Filtering", with their constants.
float antialiased_roughness(float roughness, vec3 n) {
  vec3 dx = dFdx(n), dy = dFdy(n);
  float variance = sample_area * 0.25 * (dot(dx, dx) + dot(dy, dy));
  float alpha = roughness_to_alpha(roughness);
  return sqrt(sqrt(clamp(alpha * alpha + min(2.0 * variance, 0.18), 0.0, 1.0)));
}

// ----- light from far away

#ifdef HAS_PROBES
uniform vec3 probe_position;
uniform float probe_levels;  // of its cubes
uniform vec3 probe_low;
uniform vec3 probe_high;

/// Where a probe sees what lies in a direction from here, on the walls of its box. Lagarde & Zanuttini 2012, "Local
/// Image-based Lighting With Parallax-corrected Cubemap".
vec3 probe_direction(vec3 direction) {
  vec3 to_low = (probe_low - v_position) / direction, to_high = (probe_high - v_position) / direction;
  vec3 far = max(to_low, to_high);
  float t = min(far.x, min(far.y, far.z));
  return t > 0.0 ? v_position + direction * t - probe_position : direction;
}
#endif

float far_light_level(float alpha) {
#ifdef HAS_PROBES
  return image_light_level(alpha, probe_levels);
#else
  return image_light_level(alpha, light_levels);
#endif
}

/// Where the cubes of light from far away show what lies in a direction.
vec3 far_light_direction(vec3 direction) {
#ifdef HAS_PROBES
  return probe_direction(direction);
#else
  return direction;
#endif
}

vec3 prefiltered(vec3 direction, float alpha) {
  return textureLod(specular_light, far_light_direction(direction), far_light_level(alpha)).rgb;
}

vec3 mirrored_light(Point p, vec3 n, float alpha) {
  vec3 r = 2.0 * dot(n, p.wo) * n - p.wo;
  return prefiltered(image_light_dominant(n, r, alpha), alpha) * image_light_horizon(r, p.geometric);
}

float occlusion() {
  float visible = 1.0;
#ifdef occlusion_strength_factor
  visible = 1.0 + material.occlusion_strength * (occlusion_strength_factor() - 1.0);
#endif
#ifdef HAS_SCREEN_OCCLUSION
  // The map has half the picture's size: of the four texels around, those at this depth.
  vec2 at = gl_FragCoord.xy * 0.5 - 0.5;
  ivec2 corner = ivec2(floor(at)), most = textureSize(screen_visibility, 0) - 1;
  vec2 f = fract(at);
  float depth = dot(eye - v_position, back);
  float sum = 0.0, weight = 1e-5;
  for (int i = 0; i < 4; ++i) {
    ivec2 d = ivec2(i & 1, i >> 1);
    vec2 texel = texelFetch(screen_visibility, clamp(corner + d, ivec2(0), most), 0).xy;
    float w = (d.x == 1 ? f.x : 1.0 - f.x) * (d.y == 1 ? f.y : 1.0 - f.y);
    w *= max(1.0 - 20.0 * abs(texel.y - depth) / max(depth, 1e-30), 0.0) + 1e-4;
    sum += w * texel.x;
    weight += w;
  }
  // Both tell of the same crevices.
  visible = min(visible, (sum + 1e-5) / weight);
#endif
  return visible;
}

#ifdef LOBE_transmission
/// What is seen through the surface along a direction that leaves it at `exit` (world): the opaque picture, blurred by
/// `alpha`, and where it shows nothing (`open`) the light from far away or a background that comes later.
vec3 behind(vec3 exit, vec3 direction, float alpha, out float open) {
  open = 1.0;
#if defined(HAS_FAR_LIGHT) && !defined(HAS_THROUGH)
  vec3 far = prefiltered(direction, alpha);
#else
  vec3 far = vec3(0.0);
#endif
#ifdef HAS_OPAQUE_PICTURE
  vec4 clip = clip_from_world * vec4(exit, 1.0);
  vec2 uv = clip.xy / clip.w * 0.5 + 0.5;
  // A lobe of width α covers about α of the picture's height per unit of distance over depth.
  float level = clamp(log2(max(picture_height * alpha, 1.0)), 0.0, picture_levels - 1.0);
  vec4 near = textureLod(opaque_picture, uv, level);
  vec2 edge = smoothstep(vec2(0.0), vec2(0.04), uv) * (1.0 - smoothstep(vec2(0.96), vec2(1.0), uv));
  float inside = clip.w > 0.0 ? edge.x * edge.y : 0.0;
  open = 1.0 - inside * near.a;
  return inside * near.rgb + open * far;
#else
  return far;
#endif
}

vec3 transmitted_light(Point p, SurfaceParams params, float alpha, out vec3 open) {
  float seen_open;
#if defined(IN_BODY) && defined(HAS_BODY)
  if (!gl_FrontFacing) {
    // Out of the body that the eye is in. What is outside is taken to be as far from the boundary as the eye.
    float n = max(params.ior, 1.0);
    vec3 outside = refract(-p.wo, p.normal, n);
    if (dot(outside, outside) < 0.5) outside = -p.wo;
    float far_alpha = alpha * clamp(2.0 * n - 2.0, 0.0, 1.0);
    vec3 seen = behind(v_position + outside * distance(eye, v_position), outside, far_alpha, seen_open);
    open = vec3(seen_open);
    return seen;
  }
#endif
  float thickness = 0.0;
#ifdef HAS_BODY
  thickness = material.thickness * v_scale;
#ifdef thickness_factor
  thickness *= thickness_factor();
#endif
#endif
  // Of a body one boundary is drawn, which takes half of its colour; the other half is the far one's.
  vec3 left = params.is_thin ? vec3(1.0) : sqrt(params.base_color);
  if (params.is_thin || thickness <= 0.0) {
    vec3 seen = behind(v_position, -p.wo, alpha, seen_open);
    open = left * seen_open;
    return left * seen;
  }
  float n = max(params.ior, 1.0);
  // The lobe narrows as the bend does.
  float bent_alpha = alpha * clamp(2.0 * n - 2.0, 0.0, 1.0);
  vec3 color;
  vec3 channel_ior = dispersion_channel_ior(n, material.dispersion);
  int rays = material.dispersion > 0.0 && n > 1.0 ? 3 : 1;
  for (int i = 0; i < rays; ++i) {
    vec3 inner = refract(-p.wo, p.normal, 1.0 / (rays == 3 ? channel_ior[i] : n));
    if (dot(inner, inner) < 0.5) inner = -p.wo;
    vec3 seen = behind(v_position + inner * thickness, inner, bent_alpha, seen_open);
    if (rays == 1) {
      color = seen;
      open = vec3(seen_open);
    } else if (i == 0) {
      color.r = seen.r;
      open.r = seen_open;
    } else if (i == 1) {
      color.g = seen.g;
      open.g = seen_open;
    } else {
      color.b = seen.b;
      open.b = seen_open;
    }
  }
  left *= exp(-material.extinction * thickness);
  open *= left;
  return color * left;
}
#endif

/// 1 where a part of the light is shown.
float part(int bit) { return (shown_parts & bit) != 0 ? 1.0 : 0.0; }

/// The normal by which a lobe of this anisotropy mirrors prefiltered light: it is wide along its direction, so that the
/// normal leans towards the viewer in the plane across it.
vec3 leaning(Point p, vec3 n, vec3 across, float anisotropy) {
  vec3 along_view = cross(across, p.wo);
  vec3 anisotropic = normalize(cross(along_view, across));
  vec3 bent = normalize(mix(n, anisotropic, shade_saturate(anisotropy * anisotropy)));
  return dot(bent, n) < 0.0 ? n : bent;
}

vec3 far_light(Point p, SurfaceParams params, Surface s, SurfaceShares shares, vec3 wo, mat3 frame) {
  vec3 n = p.normal;
  float visible = occlusion();
  vec3 color = vec3(0.0);
#ifdef HAS_FAR_LIGHT
  color = shares.diffuse * texture(diffuse_light, n).rgb * (part(1) / kShadePi) *
          image_light_multibounce(visible, min(shares.diffuse, vec3(1.0)));
  vec3 bent = n;
#if defined(LOBE_anisotropy) && defined(HAS_TANGENT)
  bent = leaning(p, n, frame[1], params.anisotropy);
#endif
  float specular_visible = image_light_specular_occlusion(wo.z, visible, s.alpha);
  color += (shares.specular + shares.glass) * mirrored_light(p, bent, s.alpha) * (part(2) * specular_visible);
#ifdef LOBE_retroreflection
  vec3 turned = prefiltered(image_light_dominant(n, p.wo, s.alpha), s.alpha) - mirrored_light(p, bent, s.alpha);
  color += shares.specular * turned * (s.retroreflection * part(2) * specular_visible);
#endif
#ifdef HAS_LAYERS
#if defined(LOBE_diffuse_transmission) && !defined(IS_SCATTERING)
  color += shares.below * texture(diffuse_light, -n).rgb * (part(1) / kShadePi);
#endif
#ifdef HAS_FIBRES
#ifdef HAS_SHEEN_LIGHT
  color += shares.sheen * textureLod(sheen_light, far_light_direction(2.0 * wo.z * n - p.wo), far_light_level(roughness_to_alpha(s.sheen_roughness))).rgb * (part(8) * visible);
#else
  color += shares.sheen * texture(diffuse_light, n).rgb * (part(8) * visible / kShadePi);
#endif
#endif
#ifdef LOBE_clearcoat
  vec3 nc = normalize(frame * s.coat_normal);
  vec3 bent_coat = nc;
#ifdef LOBE_clearcoat_anisotropy
  bent_coat = leaning(p, nc, cross(nc, frame * s.coat_tangent), params.clearcoat_anisotropy);
#endif
  color += shares.coat * mirrored_light(p, bent_coat, s.coat_alpha) *
           (part(4) * image_light_specular_occlusion(dot(nc, p.wo), visible, s.coat_alpha));
#endif
#endif
#endif
#if defined(LOBE_transmission) && !defined(IS_SCATTERING)
  vec3 open;
  color += shares.through * transmitted_light(p, params, s.alpha, open) * part(16);
#ifdef HAS_THROUGH
  seen_through = shares.through * open;
#endif
#endif
  return color;
}

#ifdef HAS_AREAS
// ----- light from surfaces

float area_seen(mat3 m, vec3 c[4]) { return area_share(m * c[0], m * c[1], m * c[2], m * c[3]); }

/// The frame about a normal in which the viewer leans towards x, as rows.
mat3 viewer_frame(vec3 n, vec3 wo) {
  vec3 x = wo - n * dot(n, wo);
  float x2 = dot(x, x);
  x = x2 > 1e-8 ? x * inversesqrt(x2) : shade_tangent(n);
  return transpose(mat3(x, cross(n, x), n));
}

vec3 area_light(Point p, Surface s, SurfaceShares shares, vec3 wo, mat3 frame) {
  mat3 local = viewer_frame(p.normal, p.wo);
  mat3 lobe = area_lobe(wo.z, sqrt(s.alpha)) * local;
#ifdef LOBE_retroreflection
  mat3 turned_lobe = area_lobe(wo.z, sqrt(s.alpha)) * mat3(-1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0) * local;
#endif
#ifdef LOBE_clearcoat
  vec3 nc = normalize(frame * s.coat_normal);
  mat3 coat_lobe = area_lobe(max(dot(nc, p.wo), 0.0), sqrt(s.coat_alpha)) * viewer_frame(nc, p.wo);
#endif
  vec3 sum = vec3(0.0);
  for (int i = 0; i < area_count; ++i) {
    if (shown_light >= 0 && shown_light != light_count + i) continue;
    vec3 c[4];
    if (!area_corners(areas[i], (own_areas >> i & 1) == 1, v_position, c)) continue;
    float seen = area_seen(local, c);
    vec3 value = shares.diffuse * seen + (shares.specular + shares.glass) * area_seen(lobe, c);
#ifdef HAS_LAYERS
    value += shares.sheen * seen;
#ifdef LOBE_retroreflection
    value += shares.specular * (s.retroreflection * (area_seen(turned_lobe, c) - area_seen(lobe, c)));
#endif
#ifdef LOBE_clearcoat
    value += shares.coat * area_seen(coat_lobe, c);
#endif
#if defined(LOBE_diffuse_transmission) && !defined(IS_SCATTERING)
    value += shares.below * area_seen(mat3(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0) * local, c);
#endif
#endif
    if (shade_max3(value) <= 0.0) continue;
    sum += value * areas[i].color * area_shadow(areas[i], v_position, p.vertex_normal);
  }
  return sum;
}
#endif

#ifdef IS_SCATTERING
// ----- light that enters a scattering body and leaves it near by

/// Seen through the surface, as from a white diffuse one of the body's colour.
vec3 scattered_light(Point p, SurfaceShares shares) {
  vec3 n = p.normal;
#ifdef HAS_FAR_LIGHT
  vec3 arriving = texture(diffuse_light, n).rgb * occlusion();
#else
  vec3 arriving = vec3(0.0);
#endif
#ifdef HAS_LIGHTS
  for (int i = 0; i < light_count; ++i) {
    if (shown_light >= 0 && shown_light != i) continue;
    vec3 wi;
    vec3 e = light_arriving(lights[i], v_position, wi);
    float cosine = dot(n, wi);
    if (cosine <= 0.0 || dot(p.vertex_normal, wi) <= 0.0) continue;
    arriving += e * cosine * light_shadow(lights[i], v_position, p.vertex_normal, wi);
  }
#endif
#ifdef HAS_AREAS
  mat3 local = viewer_frame(n, p.wo);
  for (int i = 0; i < area_count; ++i) {
    vec3 c[4];
    if (!area_corners(areas[i], (own_areas >> i & 1) == 1, v_position, c)) continue;
    arriving += areas[i].color * (kShadePi * area_seen(local, c) * area_shadow(areas[i], v_position, p.vertex_normal));
  }
#endif
  // Light leaves a thin body before it has taken on its colour: matched by eye to spheres that the path tracer shows.
  float thickness = material.thickness * v_scale;
#ifdef thickness_factor
  thickness *= thickness_factor();
#endif
  vec3 deep = material.multiscatter_color;
#ifdef sheet_scatter_factor
  deep *= sheet_scatter_factor();
#endif
#ifdef multiscatter_color_factor
  deep *= multiscatter_color_factor();
#endif
  vec3 color = mix(deep, vec3(1.0), exp(-0.25 * material.extinction * thickness));
  return (shares.through + shares.below) * color * arriving * (part(16) / kShadePi);
}
#endif

// ----- all of it

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
  params.roughness = max(antialiased_roughness(params.roughness, p.normal), least_roughness);
#if defined(IN_BODY) && defined(HAS_BODY)
  if (is_back) params.eta = 1.0 / max(params.ior, 1.0);
#endif

  // ----- the local frame
  vec3 tangent = anisotropy_direction(p.front_tangent, p.front_bitangent);
  vec3 t = tangent - p.normal * dot(p.normal, tangent);
  float t2 = dot(t, t);
  t = t2 > 1e-16 ? t * inversesqrt(t2) : shade_tangent(p.normal);
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
#ifdef HAS_AREAS
  color += part(32) * area_light(p, s, shares, wo, frame);
#endif
#ifdef IS_SCATTERING
#ifdef HAS_SCATTERING
  o_scattered = vec4(scattered_light(p, shares), dot(eye - v_position, back));
  o_width = vec4(material.scatter_width * v_scale, 0.0);
#else
  color += scattered_light(p, shares);
#endif
#endif
#ifdef HAS_LIGHTS
  for (int i = 0; i < light_count; ++i) {
    if (shown_light >= 0 && shown_light != i) continue;
    vec3 wi;
    vec3 e = light_arriving(lights[i], v_position, wi);
    bool is_outside = dot(p.vertex_normal, wi) > 0.0;
    vec3 local = wi * frame;
#ifdef IS_SCATTERING
    if (local.z <= 0.0) continue;  // what comes through it has spread
#endif
    // Light from one side reaches the other only through a surface that scatters through.
    if (is_outside != (local.z > 0.0) || shade_max3(e) <= 0.0) continue;
    vec3 value = surface_eval(s, wo, local).value;
    if (shade_max3(value) <= 0.0) continue;
    color += part(32) * value * e * light_shadow(lights[i], v_position, is_outside ? p.vertex_normal : -p.vertex_normal, wi);
  }
#endif
#ifdef IS_EMISSIVE
  color += part(64) * emitted_light(s);
#endif
  return vec4(color, 1.0);
#endif
}

#ifdef SHOW
/// What of the surface is asked for in place of its light.
vec4 quantity(float opacity) {
  bool is_back = !gl_FrontFacing;
#if SHOW == SHOW_position
  return vec4(v_position, 1.0);
#elif SHOW == SHOW_depth
  return vec4(vec3(is_perspective > 0.5 ? distance(eye, v_position) : dot(eye - v_position, back)), 1.0);
#elif SHOW == SHOW_id
  return vec4(vec3(object_id), 1.0);
#elif SHOW == SHOW_normal
  return vec4(make_point(is_back).normal, 1.0);
#elif SHOW == SHOW_facet
  return vec4(make_point(is_back).geometric, 1.0);
#elif SHOW == SHOW_tangent
  Point p = make_point(is_back);
  return vec4(anisotropy_direction(p.front_tangent, p.front_bitangent), 1.0);
#elif SHOW == SHOW_uv
  return vec4(fract(v_uv.xy), 0.0, 1.0);
#elif SHOW == SHOW_uv1
  return vec4(fract(v_uv.zw), 0.0, 1.0);
#elif SHOW == SHOW_base_color
#ifdef IS_UNLIT
  return vec4(fetch_base_color(), 1.0);
#else
  return vec4(fetch_params().base_color, 1.0);
#endif
#elif SHOW == SHOW_metallic
  return vec4(vec3(fetch_params().metallic), 1.0);
#elif SHOW == SHOW_roughness
  return vec4(vec3(fetch_params().roughness), 1.0);
#elif SHOW == SHOW_occlusion
  return vec4(vec3(occlusion()), 1.0);
#elif SHOW == SHOW_opacity
  return vec4(vec3(opacity), 1.0);
#elif SHOW == SHOW_facing
  return is_back ? vec4(0.8, 0.1, 0.05, 1.0) : vec4(0.1, 0.6, 0.1, 1.0);
#elif SHOW == SHOW_overdraw
  return vec4(0.1, 0.1, 0.1, 1.0);
#elif SHOW == SHOW_mips
#ifdef HAS_base_color
  vec2 texels = base_color_uv() * vec2(textureSize(base_color_texture, 0));
  vec2 dx = dFdx(texels), dy = dFdy(texels);
  return vec4(vec3(max(0.5 * log2(max(dot(dx, dx), dot(dy, dy))), 0.0) * 0.1), 1.0);
#else
  return vec4(0.0, 0.0, 0.0, 1.0);
#endif
#elif SHOW == SHOW_cascades
#ifdef HAS_LIGHTS
  for (int i = 0; i < light_count; ++i) {
    if (lights[i].kind != kDirectionalLight || lights[i].first_shadow < 0) continue;
    int c = light_cascade(lights[i], v_position);
    return vec4(c == 0 ? vec3(0.8, 0.1, 0.1) : c == 1 ? vec3(0.1, 0.8, 0.1) : c == 2 ? vec3(0.1, 0.2, 0.9) : vec3(0.8, 0.7, 0.1), 1.0);
  }
#endif
  return vec4(0.1, 0.1, 0.1, 1.0);
#elif defined(IS_UNLIT)
  return vec4(1.0);  // as what emits: it is no reflectance
#else
  Shading h = prepare(is_back);
#ifdef IS_EMISSIVE
  if (shade_max3(emitted_light(h.surface)) > 0.0) return vec4(1.0);
#endif
  return vec4(min(surface_albedo(h.surface), vec3(1.0)), 1.0);
#endif
}
#endif

#if defined(BLENDED_PART) && !defined(SHOW)
/// Whether another draw shows what is here.
bool is_elsewhere() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float depth = gl_FragCoord.z - layer_slack();
  if (depth_slice.x >= 0 && depth <= texelFetch(depth_layers, ivec3(at, depth_slice.x), 0).x) return true;
  if (depth_slice.y >= 0 && depth > texelFetch(depth_layers, ivec3(at, depth_slice.y), 0).x) return true;
  if (depth_slice.z < 0) return false;
  float glass = texelFetch(depth_layers, ivec3(at, depth_slice.z), 0).x;
  bool is_before_glass = glass < 1.0 && depth <= glass;
  return is_before_glass != (depth_slice.w == 1);
}
#endif

#ifdef IN_BODY
/// What is left of light on its way to the eye in a body, from here or from where it enters the body.
vec3 passing_body() {
  float boundary = texelFetch(depth_layers, ivec3(ivec2(gl_FragCoord.xy), 1), 0).x;
  if (gl_FragCoord.z - layer_slack() > boundary) return vec3(1.0);
  vec3 passing = exp(-body_extinction * distance(eye.xyz, v_position));
#ifndef LOBE_transmission
  // What enters through the boundary has risen by as much as falls at the lens; what is seen through glass has fallen.
  passing *= body_share;
#endif
  return passing;
}
#endif

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
  opacity = clamp((a - material.drawn_cutoff) / max(fwidth(a), 1e-4) + 0.5, 0.0, 1.0);
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
#if SHOW != SHOW_opacity && SHOW != SHOW_overdraw
  if (opacity < 0.5) discard;
#endif
  o_color = quantity(opacity);
#else
  // What half floats hold: beyond it a picture would have infinities.
  o_color = min(shaded(), vec4(65504.0));
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
