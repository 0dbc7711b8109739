// Light that enters a scattering body and leaves it near by.

// Share of a thin body's optical depth that its light takes on colour by: matched by eye to spheres that the path
// tracer shows.
const float kColorDepth = 0.25;

/// Seen through the surface, as from a white diffuse one of the body's colour.
vec3 scattered_light(Point p, SurfaceShares shares) {
  vec3 n = p.normal;
#ifdef HAS_FAR_LIGHT
  vec3 arriving = irradiance(n) * occlusion();
#else
  vec3 arriving = vec3(0.0);
#endif
#ifdef HAS_PUNCTUAL
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
  // Light leaves a thin body before it has taken on its colour.
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
  vec3 color = mix(deep, vec3(1.0), exp(-kColorDepth * material.extinction * thickness));
  return (shares.through + shares.below) * color * arriving * (part(kThroughPart) / kShadePi);
}
