// Light from far away: of the environment, or of a probe within the scene.

// Of the map of what is visible: texels whose depth differs by a twentieth are of another surface. They count by so
// little that they matter where there is no other; where even they weigh nothing, nothing is in the way.
const float kDepthsApart = 20.0;
const float kAnyDepth = 1e-4;
const float kOpen = 1e-5;
const float kNoDepth = 1e-30;  // m: none is divided by

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

/// A direction where light from far away was baked, before it was turned about +y.
vec3 turned_back(vec3 d) {
  return vec3(light_turn.x * d.x - light_turn.y * d.z, d.y, light_turn.y * d.x + light_turn.x * d.z);
}

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
  return turned_back(direction);
#endif
}

/// What light from far away, but not that of probes, is multiplied by.
float far_light_factor() {
#ifdef HAS_PROBES
  return 1.0;
#else
  return light_turn.z;
#endif
}

vec3 prefiltered(vec3 direction, float alpha) {
  return textureLod(specular_light, far_light_direction(direction), far_light_level(alpha)).rgb * far_light_factor();
}

/// Irradiance of a surface with this normal.
vec3 irradiance(vec3 n) {
#ifdef HAS_PROBES
  return texture(diffuse_light, n).rgb;
#else
  return texture(diffuse_light, turned_back(n)).rgb * light_turn.z;
#endif
}

/// `widened` is the part of α² that stands for normals which turn within the pixel. They mirror light to all sides of
/// where the lobe of the facets has its middle.
vec3 mirrored_light(Point p, vec3 n, float alpha, float widened, float rise) {
  vec3 r = 2.0 * dot(n, p.wo) * n - p.wo;
  ImageLightLookup lookup = image_light_lookup(n, r, sqrt(max(alpha * alpha - widened, 0.0)), rise);
  return prefiltered(lookup.direction, sqrt(lookup.alpha * lookup.alpha + widened)) *
         image_light_horizon(r, p.geometric);
}

#if defined(LOBE_anisotropy) || defined(LOBE_clearcoat_anisotropy)
/// The same of facets that lean along x of a frame by more than along its y.
vec3 streaked_light(Point p, mat3 frame, vec2 widths, float rise) {
  vec3 wo = p.wo * frame;
  vec3 sum = vec3(0.0);
  float weight = 0.0;
  for (int i = 0; i < kStreakLookups; ++i) {
    ImageLightLookup lookup = image_light_streak(wo, widths, rise, i);
    if (lookup.weight <= 0.0) continue;
    vec3 direction = frame * lookup.direction;
    sum += prefiltered(direction, lookup.alpha) * (lookup.weight * image_light_horizon(direction, p.geometric));
    weight += lookup.weight;
  }
  return weight > 0.0 ? sum / weight : mirrored_light(p, frame[2], widths.y, 0.0, rise);
}
#endif

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
  float sum = 0.0, weight = kOpen;
  for (int i = 0; i < 4; ++i) {
    ivec2 d = ivec2(i & 1, i >> 1);
    vec2 texel = texelFetch(screen_visibility, clamp(corner + d, ivec2(0), most), 0).xy;
    float w = (d.x == 1 ? f.x : 1.0 - f.x) * (d.y == 1 ? f.y : 1.0 - f.y);
    w *= max(1.0 - kDepthsApart * abs(texel.y - depth) / max(depth, kNoDepth), 0.0) + kAnyDepth;
    sum += w * texel.x;
    weight += w;
  }
  // Both tell of the same crevices.
  visible = min(visible, (sum + kOpen) / weight);
#endif
  return visible;
}

#ifdef LOBE_transmission
#include "mesh_transmission.glsl"
#endif

/// 1 where a part of the light is shown.
float part(int bit) { return (shown_parts & bit) != 0 ? 1.0 : 0.0; }

vec3 far_light(Point p, SurfaceParams params, Surface s, SurfaceShares shares, vec3 wo, mat3 frame) {
  vec3 n = p.normal;
  float visible = occlusion();
  vec3 color = vec3(0.0);
#ifdef HAS_FAR_LIGHT
  vec3 arriving = irradiance(n) / kShadePi;
  color = shares.diffuse * arriving * part(kDiffusePart) *
          image_light_multibounce(visible, min(shares.diffuse, vec3(1.0)));
  color += shares.spread * arriving * (part(kSpecularPart) * visible);
#if defined(LOBE_anisotropy) && defined(HAS_TANGENT)
  vec3 mirrored = streaked_light(p, frame, vec2(s.alpha_x, s.alpha_y), shares.rise);
#else
  vec3 mirrored = mirrored_light(p, n, s.alpha, p.widened, shares.rise);
#endif
  float specular_visible = part(kSpecularPart) * image_light_specular_occlusion(wo.z, visible, s.alpha);
  color += (shares.specular + shares.glass) * mirrored * specular_visible;
#ifdef LOBE_retroreflection
  ImageLightLookup back = image_light_lookup(n, p.wo, s.alpha, shares.rise);
  vec3 turned = prefiltered(back.direction, back.alpha) - mirrored;
  color += shares.specular * turned * (s.retroreflection * specular_visible);
#endif
#ifdef HAS_LAYERS
#if defined(LOBE_diffuse_transmission) && !defined(IS_SCATTERING)
  color += shares.below * irradiance(-n) * (part(kDiffusePart) / kShadePi);
#endif
#ifdef HAS_FIBRES
#ifdef HAS_SHEEN_LIGHT
  // Fibres that stand up send light to all sides: from whatever side they are seen, their lobe is nearest to what it is
  // along the normal.
  float sheen_level = far_light_level(roughness_to_alpha(s.sheen_roughness));
  color += shares.sheen * textureLod(sheen_light, far_light_direction(n), sheen_level).rgb *
           (part(kSheenPart) * visible * far_light_factor());
#else
  color += shares.sheen * arriving * (part(kSheenPart) * visible);
#endif
#endif
#ifdef LOBE_clearcoat
  vec3 nc = normalize(frame * s.coat_normal);
#ifdef LOBE_clearcoat_anisotropy
  vec3 tc = frame * s.coat_tangent;
  vec3 coated = streaked_light(p, mat3(tc, cross(nc, tc), nc), s.coat_widths, shares.coat_rise);
#else
  vec3 coated = mirrored_light(p, nc, s.coat_alpha, 0.0, shares.coat_rise);
#endif
  color += shares.coat * coated *
           (part(kCoatPart) * image_light_specular_occlusion(dot(nc, p.wo), visible, s.coat_alpha));
#endif
#endif
#endif
#if defined(LOBE_transmission) && !defined(IS_SCATTERING)
  vec3 open;
  color += shares.through * transmitted_light(p, params, s.alpha, open) * part(kThroughPart);
#ifdef HAS_THROUGH
  seen_through = shares.through * open;
#endif
#endif
  return color;
}
