// What a material is at a point: factors times textures.

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

// Of the paper below: σ², the variance of a pixel's filter over its width, and κ, the most that squared α may grow by.
const float kPixelVariance = 0.25;
const float kMostWidening = 0.18;

/// Widens a lobe by how the normal turns within a pixel. Tokuyoshi & Kaplanyan 2021, "Stable Geometric Specular
/// Antialiasing with Projected-Space NDF Filtering".
float antialiased_roughness(float roughness, vec3 n) {
  vec3 dx = dFdx(n), dy = dFdy(n);
  float variance = sample_area * kPixelVariance * (dot(dx, dx) + dot(dy, dy));
  float alpha = roughness_to_alpha(roughness);
  return sqrt(sqrt(clamp(alpha * alpha + min(2.0 * variance, kMostWidening), 0.0, 1.0)));
}
