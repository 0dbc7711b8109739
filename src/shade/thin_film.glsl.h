#ifndef CANDELA_SHADE_THIN_FILM_GLSL_H
#define CANDELA_SHADE_THIN_FILM_GLSL_H

#include "shade/shim.glsl.h"

SHADE_BEGIN

// Reflectance of a dielectric film on a substrate, seen in linear Rec.709 under white light (D65). The sum over the
// reflections inside the film is Airy's; its integral over the spectrum is taken order by order in the frequency
// domain, where the sensitivity of each channel is a sum of Gaussians. Belcour & Barla 2017, "A Practical Extension to
// Microfacet Theory for the Modeling of Varying Iridescence", section 4. docs/theory/thin-film.md has the derivation,
// the deviations from the paper and the measured errors.

/// Orders of interference that are summed.
SHADE_CONST int kFilmOrders = 8;

/// Fourier transform of the three sensitivities at m times the optical path difference, m = 1 … kFilmOrders; its
/// value at 0 is 1.
struct FilmFringes {
  vec3 re[kFilmOrders];
  vec3 im[kFilmOrders];
};

/// A Gaussian of the sensitivities: centre and deviation in 1/µm, area in each channel.
struct FilmGaussian {
  float nu;
  float sigma;
  vec3 area;
};

SHADE_CONST int kFilmGaussians = 6;

SHADE_FN FilmGaussian film_gaussian_of(float nu, float sigma, vec3 area) {
  FilmGaussian g;
  g.nu = nu;
  g.sigma = sigma;
  g.area = area;
  return g;
}

/// Sensitivities of linear Rec.709: the CIE 1931 observer times D65, each channel with integral 1. Fitted by least
/// squares of the transform over path differences from 0 to 6 µm.
SHADE_FN FilmGaussian film_gaussian(int i) {
  if (i == 0) return film_gaussian_of(1.64674f, 0.07284f, vec3(1.30868f, -0.24035f, 0.00593f));
  if (i == 1) return film_gaussian_of(1.77725f, 0.10256f, vec3(0.38660f, 0.74630f, -0.10816f));
  if (i == 2) return film_gaussian_of(1.90957f, 0.09761f, vec3(-0.81710f, 0.63348f, -0.03943f));
  if (i == 3) return film_gaussian_of(1.98172f, 0.04307f, vec3(0.06053f, -0.04507f, 0.03314f));
  if (i == 4) return film_gaussian_of(2.13731f, 0.07514f, vec3(-0.06015f, 0.01415f, 0.32721f));
  return film_gaussian_of(2.24128f, 0.09245f, vec3(0.12144f, -0.10851f, 0.78131f));
}

/// Adds a Gaussian. `opd` in µm. The transform is area · exp(-2 (π σ x)²) exp(2πi ν x); powers of the first order give
/// the others.
SHADE_FN FilmFringes film_add_gaussian(FilmFringes f, float opd, FilmGaussian g) {
  float phase = 2.0f * kShadePi * g.nu * opd;
  float c = cos(phase);
  float s = sin(phase);
  float decay = exp(-2.0f * shade_sqr(kShadePi * g.sigma * opd));
  float decay2 = decay * decay;
  float re = decay * c;
  float im = decay * s;
  float ratio = decay;  // of the amplitudes of order m and m - 1: decay^(2m - 1)
  for (int m = 0; m < kFilmOrders; ++m) {
    f.re[m] += g.area * re;
    f.im[m] += g.area * im;
    ratio *= decay2;
    float turned = (re * c - im * s) * ratio;
    im = (re * s + im * c) * ratio;
    re = turned;
  }
  return f;
}

SHADE_FN FilmFringes film_fringes(float opd) {
  FilmFringes f;
  for (int m = 0; m < kFilmOrders; ++m) {
    f.re[m] = vec3(0.0f);
    f.im[m] = vec3(0.0f);
  }
  for (int i = 0; i < SHADE_TIMES(kFilmGaussians); ++i) f = film_add_gaussian(f, opd, film_gaussian(i));
  return f;
}

/// What a boundary does to one polarisation: the amplitude reflected, whose argument is the phase it adds, and the
/// power 1 - |r|² that goes on, which float would lose near 1.
struct FilmBoundary {
  float re;
  float im;
  float through;
};

/// s-polarised wave at the boundary of a dielectric and a substrate n + ik; `eta2` = ((n² - k²) + 2ink) / n_i², `g` the
/// root of η² - sin²θ that decays (film_root). r_s = (cosθ - g) / (cosθ + g).
/// Born & Wolf, "Principles of Optics", §1.5.2 and §14.2.
SHADE_FN FilmBoundary film_boundary_s(float cos_theta, vec2 g) {
  float den = max(shade_sqr(cos_theta + g.x) + g.y * g.y, 1e-20f);
  FilmBoundary b;
  b.re = (cos_theta * cos_theta - g.x * g.x - g.y * g.y) / den;
  b.im = -2.0f * cos_theta * g.y / den;
  b.through = 4.0f * cos_theta * g.x / den;
  return b;
}

/// The p-polarised wave, in the convention in which both agree at normal incidence. r_p = (g - η² cosθ) / (g + η²
/// cosθ).
SHADE_FN FilmBoundary film_boundary_p(float cos_theta, vec2 g, vec2 eta2) {
  vec2 a = eta2 * cos_theta;
  float den = max(shade_sqr(g.x + a.x) + shade_sqr(g.y + a.y), 1e-20f);
  FilmBoundary b;
  b.re = (dot(g, g) - dot(a, a)) / den;
  b.im = 2.0f * (g.y * a.x - g.x * a.y) / den;
  b.through = 4.0f * dot(g, a) / den;
  return b;
}

/// g = √(η² - sin²θ), the normal component of the refracted wave: the root with both parts ≥ 0. Total reflection is the
/// case of a negative real square.
SHADE_FN vec2 film_root(float cos_theta, vec2 eta2) {
  float re = eta2.x - (1.0f - cos_theta * cos_theta);
  float modulus = sqrt(re * re + eta2.y * eta2.y);
  // The greater part by the sum, the smaller by what is left of 2 g.x g.y = eta2.y: no cancellation.
  float larger = sqrt(0.5f * (modulus + abs(re)));
  float smaller = 0.5f * eta2.y / max(larger, 1e-20f);
  return re >= 0.0f ? vec2(larger, smaller) : vec2(smaller, larger);
}

/// Reflectance of one polarisation in one channel: `a` the boundary from outside, whose amplitude is real, `b` that to
/// the substrate, `c` the channel. With t = -r_a r_b, Airy's sum is
///   R = 1 - K Re[1 + 2 Σ t^m exp(2πi m opd / λ)],  K = (1 - |r_a|²)(1 - |r_b|²) / (1 - |t|²):
/// Belcour & Barla 2017, eq. 7-10, with signed amplitudes instead of reflectances and phases of 0 or π. Unlike theirs
/// the sum does not end with the last order: the transforms go on by the ratio of the last two, exactly so for no
/// thickness.
SHADE_FN float film_airy(FilmBoundary a, FilmBoundary b, FilmFringes fringes, int c) {
  float t_re = -a.re * b.re;
  float t_im = -a.re * b.im;
  float re = 1.0f;
  float im = 0.0f;
  float sum = 1.0f;
  for (int m = 0; m < kFilmOrders; ++m) {
    float turned = re * t_re - im * t_im;
    im = re * t_im + im * t_re;
    re = turned;
    sum += 2.0f * (re * fringes.re[m][c] - im * fringes.im[m][c]);
    if (re * re + im * im < 1e-12f) break;  // most dielectrics need four orders
  }
  // Σ over m > M of t^m Ŝ_M ρ^(m - M) = t^M Ŝ_M tρ / (1 - tρ), ρ = Ŝ_M / Ŝ_(M-1) and never above 1.
  vec2 last = vec2(fringes.re[kFilmOrders - 1][c], fringes.im[kFilmOrders - 1][c]);
  vec2 before = vec2(fringes.re[kFilmOrders - 2][c], fringes.im[kFilmOrders - 2][c]);
  float scale = 1.0f / max(max(dot(before, before), dot(last, last)), 1e-12f);
  float ratio_re = dot(last, before) * scale;
  float ratio_im = (last.y * before.x - last.x * before.y) * scale;
  float w_re = t_re * ratio_re - t_im * ratio_im;
  float w_im = t_re * ratio_im + t_im * ratio_re;
  float gap = 1.0f - w_re;
  float tail = 1.0f / max(gap * gap + w_im * w_im, 1e-12f);
  float tail_re = (w_re * gap - w_im * w_im) * tail;  // w / (1 - w)
  float tail_im = w_im * tail;
  float end_re = re * last.x - im * last.y;
  float end_im = re * last.y + im * last.x;
  sum += 2.0f * (end_re * tail_re - end_im * tail_im);

  return 1.0f - a.through * b.through / max(a.through + b.through - a.through * b.through, 1e-12f) * sum;
}

/// Mean of both polarisations in channel c, for a substrate of relative index squared `eta2`; `s` and `p` are the
/// boundary from outside.
SHADE_FN float film_channel(FilmBoundary s, FilmBoundary p, float cos2, vec2 eta2, FilmFringes fringes, int c) {
  vec2 g = film_root(cos2, eta2);
  return 0.5f * (film_airy(s, film_boundary_s(cos2, g), fringes, c) +
                 film_airy(p, film_boundary_p(cos2, g, eta2), fringes, c));
}

/// Unpolarised reflectance of a film of index `eta2` and `thickness_nm` between a dielectric of index `eta1`, where
/// `cos_theta1` ≥ 0 is measured, and a substrate of index n + ik per channel. In [0, 1]: what lies outside the gamut of
/// Rec.709 is cut. Total reflection at the film returns 1, so light does not tunnel through it.
SHADE_APART SHADE_FN vec3 thin_film_conductor(float cos_theta1, float eta1, float eta2, vec3 n, vec3 k,
                                              float thickness_nm) {
  // KHR_materials_iridescence: a film below 0.03 nm is no film.
  float film_eta = mix(eta1, eta2, smoothstep(0.0f, 0.03f, thickness_nm));
  float cos1 = shade_saturate(cos_theta1);
  float cos2_2 = 1.0f - shade_sqr(eta1 / film_eta) * (1.0f - cos1 * cos1);
  if (cos2_2 <= 0.0f && film_eta < eta1) return vec3(1.0f);
  float cos2 = sqrt(max(cos2_2, 0.0f));
  float opd = 2.0f * film_eta * thickness_nm * cos2 * 1e-3f;  // between neighbouring reflections, in µm

  FilmFringes fringes = film_fringes(opd);
  vec2 eta2_film = vec2(shade_sqr(film_eta / eta1), 0.0f);
  vec2 root = film_root(cos1, eta2_film);
  FilmBoundary s = film_boundary_s(cos1, root);
  FilmBoundary p = film_boundary_p(cos1, root, eta2_film);
  vec3 eta2_re = (n * n - k * k) / (film_eta * film_eta);
  vec3 eta2_im = n * k * (2.0f / (film_eta * film_eta));
  vec3 r = vec3(0.0f);
  for (int c = 0; c < SHADE_TIMES(3); ++c) {
    r[c] = film_channel(s, p, cos2, vec2(eta2_re[c], eta2_im[c]), fringes, c);
  }
  return clamp(r, vec3(0.0f), vec3(1.0f));
}

/// The same on a dielectric of reflectance `f0_base` at normal incidence from the outside, as KHR_materials_iridescence
/// has it: the substrate's index follows from F0, without absorption. Below 0.9999, where the index would be infinite.
SHADE_APART SHADE_FN vec3 thin_film_fresnel(float cos_theta1, float eta1, float eta2, vec3 f0_base,
                                            float thickness_nm) {
  vec3 root = sqrt(clamp(f0_base, vec3(0.0f), vec3(0.9999f)));
  vec3 n = (vec3(1.0f) + root) / (vec3(1.0f) - root) * eta1;
  return thin_film_conductor(cos_theta1, eta1, eta2, n, vec3(0.0f), thickness_nm);
}

/// The same on a metal of which only F0 is known. KHR_materials_iridescence ignores absorption there too, and a metal
/// without it is up to 0.49 darker towards grazing than Schlick's curve. Here it has the n and k of Gulbrandsen 2014,
/// "Artist Friendly Metallic Fresnel", eq. 12 and 15, with the edge tint g = 1 - (1 - F0)^2.5 that follows Schlick's
/// curve closest; g of measured silver, gold, copper and aluminium is 0.92 to 1.
SHADE_APART SHADE_FN vec3 thin_film_metal(float cos_theta1, float eta1, float eta2, vec3 f0_base, float thickness_nm) {
  vec3 f0 = clamp(f0_base, vec3(0.0f), vec3(0.9999f));
  vec3 t = vec3(1.0f) - f0;
  vec3 root = sqrt(f0);
  vec3 g = vec3(1.0f) - t * t * sqrt(t);
  vec3 n = g * t / (vec3(1.0f) + f0) + (vec3(1.0f) - g) * (vec3(1.0f) + root) / (vec3(1.0f) - root);
  vec3 up = n + vec3(1.0f);
  vec3 down = n - vec3(1.0f);
  vec3 k = sqrt(max((f0 * up * up - down * down) / t, vec3(0.0f)));
  return thin_film_conductor(cos_theta1, eta1, eta2, n * eta1, k * eta1, thickness_nm);
}

SHADE_END

#endif
