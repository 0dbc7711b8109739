// A height map: where the view meets the relief, and how that faces.

// A view along the surface would go through more of the map than any number of steps finds the relief in: from here on,
// 5° above the surface, it is taken to be no flatter.
const float kFlattestView = 0.08;
// Of the search, along the surface and straight down: a texel or two each in maps of the usual sizes. The chord of the
// last step makes up for the rest.
const float kStepsAlong = 40.0;
const float kStepsDown = 12.0;
// Of a height, far below a code of 16 bits: two heights that are the same have no chord.
const float kLeastGap = 1e-6;
// Below these a pixel has no area (m²), and the map no texels (per metre).
const float kLeastArea = 1e-20;
const float kLeastTexels = 1e-12;

/// What to take of dFdx and dFdy for how a quantity changes along a direction in the surface.
vec2 steps_along(vec3 direction, vec3 n) {
  vec3 px = dFdx(v_position), py = dFdy(v_position);
  vec3 ax = cross(py, n), ay = cross(n, px);
  float area = dot(px, ax);  // m², of a pixel
  return abs(area) < kLeastArea ? vec2(0.0) : vec2(dot(ax, direction), dot(ay, direction)) / area;
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

/// Moves surface_uv to where the view meets the relief below, and partly above, the mesh. Policarpo, Oliveira & Comba
/// 2005, "Real-Time Relief Mapping on Arbitrary Polygonal Surfaces": a linear search, then the chord of the last step.
void find_relief(vec3 n, vec3 wo) {
  move_uvs(vec2(0.0));
  float depth = material.height_scale * v_scale;
  float cosine = max(dot(n, wo), kFlattestView);
  // From the top of the relief, as far as the view goes sideways down to its bottom.
  vec2 steps_down = steps_along((n * dot(n, wo) - wo) / cosine, n) * depth;
  vec2 middle = height_uv();
  relief_dx = dFdx(middle), relief_dy = dFdy(middle);
  vec2 sideways = relief_dx * steps_down.x + relief_dy * steps_down.y;
  vec2 uv = middle - sideways * (1.0 - material.height_level);
  int steps = int(mix(kStepsAlong, kStepsDown, cosine));
  float last_gap = 1.0 - relief_at(uv);
  float t = 0.0, dt = 1.0 / float(steps);
  for (int i = 1; i <= steps && last_gap > 0.0; ++i) {
    float next = float(i) * dt;
    float gap = 1.0 - next - relief_at(uv + sideways * next);
    if (gap <= 0.0) {
      t = next - dt * (-gap / max(last_gap - gap, kLeastGap));
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
  float step = max(0.5 * length(fwidth(v_position)), 0.5 / max(per_metre, kLeastTexels));
  float dx = relief_at(uv + ux * step) - relief_at(uv - ux * step);
  float dy = relief_at(uv + uy * step) - relief_at(uv - uy * step);
  return normalize(n - (x * dx + y * dy) * (material.height_scale * v_scale / (2.0 * step)));
}
