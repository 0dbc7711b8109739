// What of a surface is asked for in place of its light (raster/quantity.h).

// Colours of answers: any that one tells apart.
const vec3 kFrontColor = vec3(0.1, 0.6, 0.1);
const vec3 kBackColor = vec3(0.8, 0.1, 0.05);
const vec3 kUnlitColor = vec3(0.1, 0.1, 0.1);  // by no directional light
const vec3 kCascadeColors[4] =
    vec3[4](vec3(0.8, 0.1, 0.1), vec3(0.1, 0.8, 0.1), vec3(0.1, 0.2, 0.9), vec3(0.8, 0.7, 0.1));
const float kPerSurface = 0.1;  // of overdraw
const float kPerLevel = 0.1;    // of mips

vec4 quantity(float opacity) {
  bool is_back = !gl_FrontFacing;
#ifdef SURFACE_MAP
  return vec4(float(v_place.x + 1), float(v_place.y), v_corner);
#elif SHOW == SHOW_position
  return vec4(v_position, 1.0);
#elif SHOW == SHOW_depth
  return vec4(vec3(dot(eye - v_position, back)), 1.0);
#elif SHOW == SHOW_distance
  return vec4(vec3(distance_to_eye()), 1.0);
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
  return is_back ? vec4(kBackColor, 1.0) : vec4(kFrontColor, 1.0);
#elif SHOW == SHOW_overdraw
  return vec4(vec3(kPerSurface), 1.0);
#elif SHOW == SHOW_mips
#ifdef HAS_base_color
  vec2 texels = base_color_uv() * vec2(textureSize(base_color_texture, 0));
  vec2 dx = dFdx(texels), dy = dFdy(texels);
  return vec4(vec3(max(0.5 * log2(max(dot(dx, dx), dot(dy, dy))), 0.0) * kPerLevel), 1.0);
#else
  return vec4(0.0, 0.0, 0.0, 1.0);
#endif
#elif SHOW == SHOW_cascades
#ifdef HAS_LIGHTS
  for (int i = 0; i < light_count; ++i) {
    if (lights[i].kind != kDirectionalLight || lights[i].first_shadow < 0) continue;
    int c = light_cascade(lights[i], v_position);
    return vec4(kCascadeColors[min(c, 3)], 1.0);
  }
#endif
  return vec4(kUnlitColor, 1.0);
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
