#ifndef CANDELA_SHADE_SKY_GLSL_H
#define CANDELA_SHADE_SKY_GLSL_H

#include "shade/shim.glsl.h"

// Clear-sky atmosphere: Rayleigh scattering by air, scattering and absorption by aerosols, absorption by ozone, at
// 680, 550 and 440 nm. Constants and parametrisation: Bruneton & Neyret 2008 "Precomputed Atmospheric Scattering" in
// the revision of Bruneton 2017 (a new implementation); multiple scattering: Hillaire 2020 "A Scalable and Production
// Ready Sky and Atmosphere Rendering Technique". Deviation: 14 times Bruneton's aerosol, an optical depth of 0.08
// instead of 0.005, so that direct and diffuse illuminance agree with the clear sky of the IES Lighting Handbook.
//
// Lengths are kilometres, coefficients per kilometre, `r` is the distance from the planet's centre and `mu` the cosine
// of an angle to the local zenith. Luminance is in units of 10 000 cd/m², illuminance in units of 10 000 lx.

SHADE_BEGIN

SHADE_CONST float kSkyGroundRadius = 6360.0f;
SHADE_CONST float kSkyTopRadius = 6420.0f;
SHADE_CONST float kSkyRayleighHeight = 8.0f;
SHADE_CONST float kSkyAerosolHeight = 1.2f;
SHADE_CONST float kSkyAerosolScattering = 0.056f;
SHADE_CONST float kSkyAerosolAlbedo = 0.9f;
SHADE_CONST float kSkyAerosolG = 0.8f;
SHADE_CONST float kSkySunAngularRadius = 0.00465120f;  // 0.2665°

struct SkyMedium {
  vec3 rayleigh;    // scattering
  float aerosol;    // scattering
  vec3 extinction;  // scattering and absorption together
};

SHADE_FN SkyMedium sky_medium(float altitude) {
  float air = exp(-altitude / kSkyRayleighHeight);
  float haze = exp(-altitude / kSkyAerosolHeight);
  float ozone = max(0.0f, 1.0f - abs(altitude - 25.0f) / 15.0f);  // a layer between 10 and 40 km
  SkyMedium medium;
  medium.rayleigh = vec3(0.005802f, 0.013558f, 0.033100f) * air;
  medium.aerosol = kSkyAerosolScattering * haze;
  medium.extinction =
      medium.rayleigh + vec3(medium.aerosol / kSkyAerosolAlbedo) + vec3(0.000650f, 0.001881f, 0.000085f) * ozone;
  return medium;
}

/// Illuminance of the sun outside the atmosphere, linear Rec.709. Three wavelengths cannot carry a spectrum: after
/// Bruneton 2017's factors (14.5, 12.9, 12.7; 133 klx) daylight is pinkish. These keep the 133 klx and put sun and sky
/// together on the CIE daylight locus.
SHADE_FN vec3 sky_sun_illuminance() { return vec3(14.0f, 13.2f, 12.2f); }

SHADE_FN float sky_phase_rayleigh(float cos_angle) {
  return 3.0f / (16.0f * kShadePi) * (1.0f + cos_angle * cos_angle);
}

/// Cornette & Shanks 1992 "Physically reasonable analytic expression for the single-scattering phase function".
SHADE_FN float sky_phase_aerosol(float cos_angle) {
  float g = kSkyAerosolG;
  float base = 1.0f + g * g - 2.0f * g * cos_angle;
  return 3.0f / (8.0f * kShadePi) * (1.0f - g * g) / (2.0f + g * g) * (1.0f + cos_angle * cos_angle) /
         (base * sqrt(base));
}

/// Way from `r` to the top of the atmosphere.
SHADE_FN float sky_distance_to_top(float r, float mu) {
  float square = r * r * (mu * mu - 1.0f) + kSkyTopRadius * kSkyTopRadius;
  return max(0.0f, -r * mu + sqrt(max(0.0f, square)));
}

SHADE_FN bool sky_hits_ground(float r, float mu) {
  return mu < 0.0f && r * r * (mu * mu - 1.0f) + kSkyGroundRadius * kSkyGroundRadius >= 0.0f;
}

/// Way from `r` to the ground, for rays that hit it. The constant term is factored so that low observers lose no
/// digits.
SHADE_FN float sky_distance_to_ground(float r, float mu) {
  float c = (r - kSkyGroundRadius) * (r + kSkyGroundRadius);
  float square = r * r * mu * mu - c;
  return max(0.0f, c / (-r * mu + sqrt(max(0.0f, square))));
}

/// Distance from the planet's centre after going `t` along the ray.
SHADE_FN float sky_radius_at(float r, float mu, float t) {
  return clamp(sqrt(max(0.0f, r * r + t * t + 2.0f * r * mu * t)), kSkyGroundRadius, kSkyTopRadius);
}

/// Transmittance to the top of the atmosphere along a ray that misses the ground.
SHADE_FN vec3 sky_transmittance_to_top(float r, float mu) {
  float way = sky_distance_to_top(r, mu);
  vec3 depth = vec3(0.0f);
  for (int i = 0; i < 64; ++i) {
    // Steps grow with the distance: low rays are densest near the observer.
    float s = (float(i) + 0.5f) / 64.0f;
    float altitude = sky_radius_at(r, mu, way * s * s) - kSkyGroundRadius;
    depth = depth + sky_medium(altitude).extinction * (way * 2.0f * s / 64.0f);
  }
  return exp(-depth);
}

/// Where (r, mu) lies in a transmittance table, both coordinates in [0, 1]. Bruneton 2017, "Transmittance": distance to
/// the top against its extremes, and distance to the horizon.
SHADE_FN vec2 sky_transmittance_uv(float r, float mu) {
  float horizon = sqrt(kSkyTopRadius * kSkyTopRadius - kSkyGroundRadius * kSkyGroundRadius);
  float rho = sqrt(max(0.0f, (r - kSkyGroundRadius) * (r + kSkyGroundRadius)));
  float nearest = kSkyTopRadius - r;
  float farthest = rho + horizon;
  float u = (sky_distance_to_top(r, mu) - nearest) / (farthest - nearest);
  return vec2(clamp(u, 0.0f, 1.0f), clamp(rho / horizon, 0.0f, 1.0f));
}

/// The inverse: (r, mu) of a table coordinate.
SHADE_FN vec2 sky_transmittance_r_mu(vec2 uv) {
  float horizon = sqrt(kSkyTopRadius * kSkyTopRadius - kSkyGroundRadius * kSkyGroundRadius);
  float rho = horizon * uv.y;
  float r = sqrt(rho * rho + kSkyGroundRadius * kSkyGroundRadius);
  float nearest = kSkyTopRadius - r;
  float way = nearest + uv.x * (rho + horizon - nearest);
  float mu = 1.0f;
  if (way > 0.0f) mu = (horizon * horizon - rho * rho - way * way) / (2.0f * r * way);
  return vec2(r, clamp(mu, -1.0f, 1.0f));
}

/// Part of the sun's disc above the horizon of a point at `r`, 0 in the planet's shadow.
SHADE_FN float sky_sun_visibility(float r, float mu_sun) {
  float sin_horizon = kSkyGroundRadius / r;
  float cos_horizon = -sqrt(max(0.0f, 1.0f - sin_horizon * sin_horizon));
  float width = sin_horizon * kSkySunAngularRadius;
  return smoothstep(-width, width, mu_sun - cos_horizon);
}

/// Light scattered towards the viewer per kilometre and unit of solar illuminance: once, from a sun dimmed by
/// `sun_transmittance`, and many times, taken as isotropic (Hillaire 2020 § 5.5, Ψ).
SHADE_FN vec3 sky_in_scattering(SkyMedium medium, float cos_sun_angle, vec3 sun_transmittance, vec3 multiple) {
  vec3 once =
      medium.rayleigh * sky_phase_rayleigh(cos_sun_angle) + vec3(medium.aerosol * sky_phase_aerosol(cos_sun_angle));
  return sun_transmittance * once + multiple * (medium.rayleigh + vec3(medium.aerosol));
}

/// ∫ source · e^(-extinction·t) dt over a step with constant source that lets `transmittance` through (Hillaire 2016
/// "Physically Based Sky, Atmosphere and Cloud Rendering in Frostbite", energy-conserving integration).
SHADE_FN vec3 sky_step(vec3 source, vec3 extinction, vec3 transmittance) {
  return source * (vec3(1.0f) - transmittance) / max(extinction, vec3(1e-9f));
}

SHADE_END

#endif
