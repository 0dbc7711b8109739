// Light from surfaces that shine.

float area_seen(mat3 m, vec3 c[4]) { return area_share(m * c[0], m * c[1], m * c[2], m * c[3]); }

const mat3 kTurned = mat3(-1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0);  // half a turn about z
const mat3 kBelow = mat3(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0);    // z to its other side

// Squared sine of the angle between normal and viewer: below it any x will do.
const float kLeastLean2 = 1e-8;

/// The frame about a normal in which the viewer leans towards x, as rows.
mat3 viewer_frame(vec3 n, vec3 wo) {
  vec3 x = wo - n * dot(n, wo);
  float x2 = dot(x, x);
  x = x2 > kLeastLean2 ? x * inversesqrt(x2) : shade_tangent(n);
  return transpose(mat3(x, cross(n, x), n));
}

vec3 area_light(Point p, Surface s, SurfaceShares shares, vec3 wo, mat3 frame) {
  mat3 local = viewer_frame(p.normal, p.wo);
  mat3 lobe = area_lobe(wo.z, sqrt(s.alpha)) * local;
#ifdef LOBE_retroreflection
  mat3 turned_lobe = area_lobe(wo.z, sqrt(s.alpha)) * kTurned * local;
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
    vec3 value = (shares.diffuse + shares.spread) * seen + (shares.specular + shares.glass) * area_seen(lobe, c);
#ifdef HAS_LAYERS
    value += shares.sheen * seen;
#ifdef LOBE_retroreflection
    value += shares.specular * (s.retroreflection * (area_seen(turned_lobe, c) - area_seen(lobe, c)));
#endif
#ifdef LOBE_clearcoat
    value += shares.coat * area_seen(coat_lobe, c);
#endif
#if defined(LOBE_diffuse_transmission) && !defined(IS_SCATTERING)
    value += shares.below * area_seen(kBelow * local, c);
#endif
#endif
    if (shade_max3(value) <= 0.0) continue;
    sum += value * areas[i].color * area_shadow(areas[i], v_position, p.vertex_normal);
  }
  return sum;
}
