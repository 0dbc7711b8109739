// Light of lamps, and of surfaces that shine.

#ifdef HAS_AREAS
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

/// The lobes of a surface as maps that turn each into a clamped cosine.
struct AreaLobes {
  mat3 cosine;
  mat3 facets;
  mat3 turned;  // facets that send light back
  mat3 coat;
};

AreaLobes area_lobes(Point p, Surface s, vec3 wo, mat3 frame) {
  AreaLobes lobes;
  lobes.cosine = viewer_frame(p.normal, p.wo);
  mat3 facets = area_lobe(wo.z, sqrt(s.alpha));
  lobes.facets = facets * lobes.cosine;
#ifdef LOBE_retroreflection
  lobes.turned = facets * kTurned * lobes.cosine;
#endif
#ifdef LOBE_clearcoat
  vec3 nc = normalize(frame * s.coat_normal);
  lobes.coat = area_lobe(max(dot(nc, p.wo), 0.0), sqrt(s.coat_alpha)) * viewer_frame(nc, p.wo);
#endif
  return lobes;
}

// How many there are beyond diffuse light and facets, in this order.
#ifdef LOBE_clearcoat
const int kCoats = 1;
#else
const int kCoats = 0;
#endif
#ifdef LOBE_retroreflection
const int kTurns = 1;
#else
const int kTurns = 0;
#endif
#if defined(LOBE_diffuse_transmission) && !defined(IS_SCATTERING)
#define SHINES_THROUGH 1
const int kBelows = 1;
#else
const int kBelows = 0;
#endif

/// What is sent to the eye of light that comes from a polygon with these corners, as seen from here.
vec3 area_reflected(vec3 corners[4], AreaLobes lobes, Surface s, SurfaceShares shares) {
  vec3 value = vec3(0.0);
  for (int i = 0; i < SHADE_TIMES(2 + kCoats + kTurns + kBelows); ++i) {
    mat3 lobe = lobes.cosine;
    vec3 share = shares.diffuse + shares.spread;
#ifdef HAS_LAYERS
    share += shares.sheen;
#endif
    if (i == 1) {
      lobe = lobes.facets;
      share = shares.specular + shares.glass;
#ifdef LOBE_retroreflection
      share -= shares.specular * s.retroreflection;
#endif
    }
#ifdef LOBE_clearcoat
    if (i == 1 + kCoats) {
      lobe = lobes.coat;
      share = shares.coat;
    }
#endif
#ifdef LOBE_retroreflection
    if (i == 1 + kCoats + kTurns) {
      lobe = lobes.turned;
      share = shares.specular * s.retroreflection;
    }
#endif
#ifdef SHINES_THROUGH
    if (i == 1 + kCoats + kTurns + kBelows) {
      lobe = kBelow * lobes.cosine;
      share = shares.below;
    }
#endif
    value += share * area_seen(lobe, corners);
  }
  return value;
}
#endif

/// Light that comes straight from lamps and shining surfaces, numbered one after the other.
vec3 direct_light(Point p, Surface s, SurfaceShares shares, vec3 wo, mat3 frame) {
  vec3 sum = vec3(0.0);
#ifdef HAS_PUNCTUAL
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
    sum += value * e * light_shadow(lights[i], v_position, is_outside ? p.vertex_normal : -p.vertex_normal, wi);
  }
#endif
#ifdef HAS_AREAS
  AreaLobes lobes = area_lobes(p, s, wo, frame);
  for (int i = 0; i < area_count; ++i) {
    if (shown_light >= 0 && shown_light != light_count + i) continue;
    vec3 corners[4];
    if (!area_corners(areas[i], (own_areas >> i & 1) == 1, v_position, corners)) continue;
    vec3 value = area_reflected(corners, lobes, s, shares);
    if (shade_max3(value) <= 0.0) continue;
    vec3 n = p.vertex_normal;
#ifdef SHINES_THROUGH
    // What lies behind shines through: nothing of the surface itself is in its way.
    if (dot(n, area_middle(areas[i]) - v_position) < 0.0) n = -n;
#endif
    sum += value * areas[i].color * area_shadow(areas[i], v_position, n);
  }
#endif
  return sum;
}
