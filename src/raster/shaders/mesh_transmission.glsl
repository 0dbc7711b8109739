// Light through a surface, from what the picture shows behind it.

// Over the last 4 % of the picture on each side what it shows fades into light from far away, so that nothing appears
// at once where a ray leaves it.
const float kEdge = 0.04;

/// refract() gives 0 in place of a unit vector where all is reflected.
bool is_total(vec3 refracted) { return dot(refracted, refracted) < 0.5; }

/// A lobe narrows as the bend does: not at all by an index of 1, all of its width from 1.5, that of glass, on.
float bend(float ior) { return clamp(2.0 * ior - 2.0, 0.0, 1.0); }

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
  vec2 edge = smoothstep(vec2(0.0), vec2(kEdge), uv) * (1.0 - smoothstep(vec2(1.0 - kEdge), vec2(1.0), uv));
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
    if (is_total(outside)) outside = -p.wo;
    float far_alpha = alpha * bend(n);
    vec3 seen = behind(v_position + outside * distance_to_eye(), outside, far_alpha, seen_open);
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
  float bent_alpha = alpha * bend(n);
  vec3 color;
  vec3 channel_ior = dispersion_channel_ior(n, material.dispersion);
  int rays = material.dispersion > 0.0 && n > 1.0 ? 3 : 1;
  for (int i = 0; i < rays; ++i) {
    vec3 inner = refract(-p.wo, p.normal, 1.0 / (rays == 3 ? channel_ior[i] : n));
    if (is_total(inner)) inner = -p.wo;
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
