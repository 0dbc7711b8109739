#include "laws/mutants.h"

#include <cmath>
#include <limits>

namespace candela::laws {

namespace {

using shade::Surface;

using EvalMistake = std::function<SurfaceEval(const Surface&, vec3 wo, vec3 wi)>;
using DirectionMistake = std::function<vec3(const Surface&, vec3 wo, vec3 u)>;

// ----- which surfaces have what

bool is_plain(const SurfaceParams& p) { return p.lobes == 0; }
bool is_mirror(const SurfaceParams& p) { return shade::roughness_to_alpha(p.roughness) < shade::kGgxMirrorAlpha; }
bool is_metal(const SurfaceParams& p) { return p.metallic == 1.0f; }
bool is_black(const SurfaceParams& p) { return p.base_color == vec3(0.0f); }
// Between two media of the same index there is none.
bool has_boundary(const SurfaceParams& p) {
  return is_plain(p) && p.metallic < 1.0f && p.specular > 0.0f && p.ior != 1.0f;
}
bool has_specular(const SurfaceParams& p) { return is_plain(p) && (p.metallic > 0.0f || has_boundary(p)); }
bool has_diffuse(const SurfaceParams& p) {
  return is_plain(p) && p.metallic < 1.0f && !is_black(p) && (p.ior != 0.0f || p.specular < 1.0f);
}
// At most a tenth of the samples may go to the diffuse layer of a half metallic mirror: too little to tell 3 %.
bool has_much_density(const SurfaceParams& p) {
  return is_plain(p) && (!is_mirror(p) || (has_diffuse(p) && p.metallic == 0.0f));
}
bool reflects_diffusely(const SurfaceParams& p) { return has_diffuse(p) || (!is_mirror(p) && has_specular(p)); }
bool is_rough_metal(const SurfaceParams& p) { return is_plain(p) && is_metal(p) && !is_mirror(p); }
bool is_rough_body(const SurfaceParams& p) {
  return p.lobes == shade::kLobeTransmission && !p.is_thin && !is_mirror(p) && p.ior >= 1.5f;
}

// ----- ways to be wrong

/// Both sides of the real surface, each seen through `spoil`.
Bsdf spoilt(const SurfaceParams& p, const std::function<Closure(const Surface&, vec3 wo)>& spoil) {
  Bsdf bsdf = real_bsdf(p);
  bsdf.seen_from = [p, spoil](vec3 wo) { return spoil(shade::surface_prepare(p, wo), wo); };
  const SurfaceParams behind = laws::params_from_behind(p);
  bsdf.seen_from_behind = [behind, spoil](vec3 wo) { return spoil(shade::surface_prepare(behind, wo), wo); };
  return bsdf;
}

// A wrong eval; sample picks the right directions and weighs them with it.
Bsdf with_eval(const SurfaceParams& p, const EvalMistake& mistake) {
  return spoilt(p, [mistake](const Surface& s, vec3 wo) {
    return Closure{[s, wo, mistake](vec3 wi) { return mistake(s, wo, wi); },
                   [s, wo, mistake](vec3 u) {
                     SurfaceSample r = shade::surface_sample(s, wo, u);
                     if (r.is_delta || r.pdf == 0.0f) return r;
                     const SurfaceEval e = mistake(s, wo, r.wi);
                     r.pdf = e.pdf;
                     r.weight = e.value / e.pdf;
                     return r;
                   }};
  });
}

// Directions that do not follow the density; weights are still eval / pdf.
Bsdf with_directions(const SurfaceParams& p, const DirectionMistake& mistake) {
  return spoilt(p, [mistake](const Surface& s, vec3 wo) {
    return Closure{[s, wo](vec3 wi) { return shade::surface_eval(s, wo, wi); },
                   [s, wo, mistake](vec3 u) {
                     SurfaceSample r = shade::surface_sample(s, wo, u);
                     if (r.is_delta) return r;
                     r.wi = mistake(s, wo, u);
                     const SurfaceEval e = shade::surface_eval(s, wo, r.wi);
                     r.pdf = e.pdf;
                     r.weight = e.pdf > 0.0f ? e.value / e.pdf : vec3(0.0f);
                     return r;
                   }};
  });
}

// A right eval with samples that are spoilt afterwards.
Bsdf with_sample(const SurfaceParams& p, const std::function<void(const Surface&, vec3 wo, SurfaceSample&)>& mistake) {
  return spoilt(p, [mistake](const Surface& s, vec3 wo) {
    return Closure{[s, wo](vec3 wi) { return shade::surface_eval(s, wo, wi); },
                   [s, wo, mistake](vec3 u) {
                     SurfaceSample r = shade::surface_sample(s, wo, u);
                     mistake(s, wo, r);
                     return r;
                   }};
  });
}

// A closure that was prepared wrongly, and is used consistently.
Bsdf with_surface(const SurfaceParams& p, const std::function<void(Surface&)>& mistake) {
  return spoilt(p, [mistake](Surface s, vec3 wo) {
    mistake(s);
    return Closure{[s, wo](vec3 wi) { return shade::surface_eval(s, wo, wi); },
                   [s, wo](vec3 u) { return shade::surface_sample(s, wo, u); }};
  });
}

Mutant eval_mutant(const std::string& name, const EvalMistake& mistake,
                   std::function<bool(const SurfaceParams&)> shows) {
  return {name, [mistake](const SurfaceParams& p) { return with_eval(p, mistake); }, std::move(shows)};
}

// ----- parts of the real surface, to be put together wrongly

vec3 specular_value(const Surface& s, vec3 wo, vec3 wi, vec3 fresnel) {
  const vec3 wm = glm::normalize(wo + wi);
  return s.is_mirror ? vec3(0.0f) : fresnel * (shade::ggx_d(wm, s.alpha) * shade::ggx_v_smith(wo, wi, s.alpha) * wi.z);
}

vec3 specular_value(const Surface& s, vec3 wo, vec3 wi) {
  return specular_value(s, wo, wi, shade::base_fresnel(s, glm::dot(wo, glm::normalize(wo + wi))));
}

// With what scatters many times between facets left out: of smooth dielectrics, where it is nothing.
vec3 diffuse_value(const Surface& s, vec3 wi) {
  const float into = shade::base_transmission(s, shade::table_ggx_curve(wi.z, s.row, s.curve));
  return shade::lambert_f(s.diffuse) * (s.transmission_o * into * s.diffuse_scale * wi.z);
}

float specular_pdf(const Surface& s, vec3 wo, vec3 wi) {
  return s.is_mirror ? 0.0f : s.chance_specular * shade::ggx_pdf_visible(wo, glm::normalize(wo + wi), s.alpha);
}

bool above(vec3 wo, vec3 wi) { return wo.z > 0.0f && wi.z > 0.0f; }

SurfaceEval scaled_pdf(const Surface& s, vec3 wo, vec3 wi) {
  SurfaceEval e = shade::surface_eval(s, wo, wi);
  e.pdf *= 1.03f;
  return e;
}

SurfaceEval cosine_forgotten(const Surface& s, vec3 wo, vec3 wi) {
  SurfaceEval e = shade::surface_eval(s, wo, wi);
  if (wi.z > 0.0f) e.value /= wi.z;
  return e;
}

SurfaceEval four_missing_in_value(const Surface& s, vec3 wo, vec3 wi) {
  SurfaceEval e = shade::surface_eval(s, wo, wi);
  if (above(wo, wi)) e.value += 3.0f * specular_value(s, wo, wi);
  return e;
}

SurfaceEval four_missing_in_pdf(const Surface& s, vec3 wo, vec3 wi) {
  SurfaceEval e = shade::surface_eval(s, wo, wi);
  if (above(wo, wi)) e.pdf += 3.0f * specular_pdf(s, wo, wi);
  return e;
}

// glTF 2.0 Appendix B as printed: (1 - F(wo·h)) diffuse + F specular.
SurfaceEval fresnel_mix(const Surface& s, vec3 wo, vec3 wi) {
  SurfaceEval e = shade::surface_eval(s, wo, wi);
  if (!above(wo, wi)) return e;
  const float w = shade::schlick_weight(glm::dot(wo, glm::normalize(wo + wi)));
  const vec3 f = s.f0_dielectric + (vec3(s.f90_dielectric) - s.f0_dielectric) * w;
  e.value += shade::lambert_f(s.diffuse) * ((1.0f - shade::shade_max3(f)) * wi.z) - diffuse_value(s, wi);
  return e;
}

// Radiance is not compressed where it enters a body.
SurfaceEval without_eta2(const Surface& s, vec3 wo, vec3 wi) {
  SurfaceEval e = shade::surface_eval(s, wo, wi);
  if (wi.z < 0.0f) e.value *= s.eta * s.eta;
  return e;
}

SurfaceParams brighter_f0(SurfaceParams p) {
  p.base_color *= 1.05f;
  return p;
}

// Walter et al. 2007, eq. 35-36: normals by D cosθ, the way before visible normals.
vec3 sample_all_normals(const Surface& s, vec3 wo, vec3 u) {
  const float tan2 = s.alpha * s.alpha * u.x / std::max(1.0f - u.x, 1e-7f);
  const vec3 wm = direction(1.0f / std::sqrt(1.0f + tan2), 2.0f * shade::kShadePi * u.y);
  return shade::microfacet_reflect(wo, wm);
}

vec3 sample_uniform_for_cosine(const Surface& s, vec3 wo, vec3 u) {
  if (u.z >= s.chance_specular) return direction(u.x, 2.0f * shade::kShadePi * u.y);
  return shade::surface_sample(s, wo, u).wi;
}

}  // namespace

std::vector<Mutant> reciprocity_mutants() {
  const auto literal_layers = [](SurfaceParams p) {
    p.lobes |= shade::kLobeModel;
    p.model.literal_layers = true;
    return real_bsdf(p);
  };
  const auto left_over_cosine = [](const Surface& s, vec3 wo, vec3 wi) {
    SurfaceEval e = shade::surface_eval(s, wo, wi);
    e.value *= wi.z;
    return e;
  };
  const auto viewer_decides_transmission = [](const Surface& s, vec3 wo, vec3 wi) {
    SurfaceEval e = shade::surface_eval(s, wo, wi);
    if (above(wo, wi)) {
      e.value = specular_value(s, wo, wi) + shade::lambert_f(s.diffuse) * (s.transmission_o * wi.z);
    }
    return e;
  };
  const auto viewer_decides_fresnel = [](const Surface& s, vec3 wo, vec3 wi) {
    SurfaceEval e = shade::surface_eval(s, wo, wi);
    if (above(wo, wi)) {
      e.value += specular_value(s, wo, wi, shade::base_fresnel(s, wo.z)) - specular_value(s, wo, wi);
    }
    return e;
  };
  const auto fresnel_bends = [](const SurfaceParams& p) {
    if (is_mirror(p) || !is_plain(p)) return false;
    const bool metal_bends = p.metallic > 0.0f && p.base_color != vec3(1.0f);
    return metal_bends || (has_boundary(p) && p.ior != 0.0f);
  };
  return {
      eval_mutant("one cosine too many", left_over_cosine, reflects_diffusely),
      eval_mutant("the viewer alone decides what reaches the diffuse layer", viewer_decides_transmission,
                  [](const SurfaceParams& p) { return has_diffuse(p) && has_boundary(p) && p.ior != 0.0f; }),
      eval_mutant("Fresnel at the viewer's angle instead of the half vector's", viewer_decides_fresnel, fresnel_bends),
      {"the viewer alone decides what gets through coat and sheen, as printed", literal_layers,
       [](const SurfaceParams& p) {
         const bool is_layered = p.lobes == shade::kLobeClearcoat || p.lobes == shade::kLobeSheen;
         return is_layered && p.clearcoat_normal.z == 1.0f && (p.metallic == 0.0f || !is_mirror(p));
       }},
      eval_mutant("radiance is not scaled by η²", without_eta2, is_rough_body)};
}

std::vector<Mutant> finiteness_mutants() {
  const auto negative = [](const Surface& s, vec3 wo, vec3 wi) {
    SurfaceEval e = shade::surface_eval(s, wo, wi);
    if (wi.z < 5e-4f) e.value = vec3(-1e-6f);
    return e;
  };
  const auto grazing_nan = [](const Surface& s, vec3 wo, vec3 wi) {
    SurfaceEval e = shade::surface_eval(s, wo, wi);
    if (wi.z < 5e-4f) e.value *= std::numeric_limits<float>::quiet_NaN();
    return e;
  };
  const auto too_long = [](const SurfaceParams& p) {
    return with_sample(p, [](const Surface&, vec3, SurfaceSample& r) { r.wi *= 1.0001f; });
  };
  const auto always = [](const SurfaceParams&) { return true; };
  return {eval_mutant("slightly negative values", negative, always),
          eval_mutant("not a number at grazing incidence", grazing_nan, always),
          {"sampled directions are not unit", too_long, always}};
}

std::vector<Mutant> opacity_mutants() {
  const auto shines_through = [](const Surface& s, vec3 wo, vec3 wi) {
    return shade::surface_eval(s, wo, vec3(wi.x, wi.y, std::abs(wi.z)));
  };
  return {eval_mutant("light from below", shines_through, reflects_diffusely)};
}

std::vector<Mutant> energy_mutants() {
  // Multiple scattering of one material whose F0 lies between dielectric and metal.
  const auto blended_f0 = [](const SurfaceParams& p) {
    return with_surface(p, [](Surface& s) {
      const vec3 f0 = s.weight_dielectric * s.f0_dielectric + s.weight_metal * s.f0_metal;
      s.multiscatter = shade::multiscatter_share3(f0 + (1.0f - f0) * s.rise_mean, shade::table_walk(s.row)) /
                       (shade::kShadePi * s.escape_mean);
    });
  };
  const auto without_multiscatter = [](const SurfaceParams& p) {
    return with_surface(p, [](Surface& s) { s.multiscatter = vec3(0.0f); });
  };
  // A layer that is laid on without dimming what is below.
  const auto laid_on = [](int lobe) {
    return [lobe](const SurfaceParams& p) {
      SurfaceParams bare = p;
      bare.lobes &= ~lobe;
      return with_eval(p, [bare, lobe](const Surface& s, vec3 wo, vec3 wi) {
        SurfaceEval e = shade::surface_eval(s, wo, wi);
        if (!above(wo, wi)) return e;
        const shade::LayersAt at = shade::layers_at(s, wi);
        e.value = shade::surface_eval(shade::surface_prepare(bare, wo), wo, wi).value;
        e.value += lobe == shade::kLobeClearcoat
                       ? shade::coat_eval(s, wo, wi).value
                       : shade::sheen_eval(s, wo, wi, shade::layers_below_coat(s, at), at.sheen_scale);
        return e;
      });
    };
  };
  const auto only = [](int lobe, float metallic) {
    return [lobe, metallic](const SurfaceParams& p) {
      return p.lobes == lobe && p.metallic == metallic && p.clearcoat_normal.z == 1.0f && p.roughness >= 0.3f;
    };
  };
  const auto reflects_much = [](const SurfaceParams& p) { return is_rough_metal(p) && !is_black(p); };
  return {{"multiple scattering of blended F0", blended_f0,
           [](const SurfaceParams& p) {
             return is_plain(p) && p.metallic == 0.5f && p.base_color == vec3(1.0f) && p.ior >= 1.3f && p.ior < 2.0f &&
                    p.specular_color == vec3(1.0f) && p.roughness >= 0.3f;
           }},
          {"single scattering alone", without_multiscatter,
           [](const SurfaceParams& p) {
             return is_rough_metal(p) && p.base_color == vec3(1.0f) && p.specular_color == vec3(1.0f) &&
                    p.roughness >= 0.3f;
           }},
          {"a coat that dims nothing", laid_on(shade::kLobeClearcoat), only(shade::kLobeClearcoat, 1.0f)},
          {"a sheen that dims nothing", laid_on(shade::kLobeSheen), only(shade::kLobeSheen, 0.0f)},
          eval_mutant("radiance is not scaled by η²", without_eta2, is_rough_body),
          eval_mutant("cosine forgotten", cosine_forgotten,
                      [=](const SurfaceParams& p) {
                        return reflects_much(p) || (has_diffuse(p) && p.metallic == 0.0f && p.specular == 1.0f);
                      }),
          eval_mutant("factor 4 missing in the microfacet lobe", four_missing_in_value, reflects_much),
          {"F0 scaled by 1.05", [](const SurfaceParams& p) { return real_bsdf(brighter_f0(p)); },
           [](const SurfaceParams& p) {
             return is_plain(p) && is_metal(p) && p.base_color == vec3(1.0f) && p.roughness <= 0.1f;
           }},
          eval_mutant("1 - F(wo·h) for the diffuse layer", fresnel_mix, [](const SurfaceParams& p) {
            return is_plain(p) && p.metallic == 0.0f && p.base_color == vec3(1.0f) && p.specular == 1.0f &&
                   p.specular_color == vec3(1.0f) && p.ior >= 1.0f && p.roughness <= 0.3f && !is_mirror(p);
          })};
}

std::vector<Mutant> pdf_mutants() {
  const auto lobe_chance_forgotten = [](const Surface& s, vec3 wo, vec3 wi) {
    SurfaceEval e = shade::surface_eval(s, wo, wi);
    if (above(wo, wi)) e.pdf += s.chance_specular * shade::cosine_pdf(wi.z);
    return e;
  };
  const auto certain_delta = [](const SurfaceParams& p) {
    return with_sample(p, [](const Surface&, vec3, SurfaceSample& r) { r.pdf = r.is_delta ? 1.0f : r.pdf; });
  };
  const auto has_both = [](const SurfaceParams& p) { return has_diffuse(p) && has_specular(p); };
  return {eval_mutant("pdf times 1.03", scaled_pdf, has_much_density),
          eval_mutant("Jacobian without its 4", four_missing_in_pdf, is_rough_metal),
          eval_mutant("chance of the diffuse lobe forgotten", lobe_chance_forgotten, has_both),
          {"a delta lobe claims to be certain", certain_delta,
           [=](const SurfaceParams& p) { return is_mirror(p) && has_both(p); }},
          eval_mutant("pdf of a body times 1.03", scaled_pdf, is_rough_body)};
}

std::vector<Mutant> sampling_mutants() {
  const auto roughness_for_alpha = [](const SurfaceParams& p) {
    return with_directions(p, [p](const Surface& s, vec3 wo, vec3 u) {
      return u.z < s.chance_specular
                 ? shade::microfacet_reflect(wo, shade::ggx_sample_visible(wo, p.roughness, vec2(u.x, u.y)))
                 : shade::cosine_sample(vec2(u.x, u.y));
    });
  };
  const auto refracts_inversely = [](const SurfaceParams& p) {
    return with_directions(p, [](const Surface& s, vec3 wo, vec3 u) {
      Surface wrong = s;
      wrong.eta = 1.0f / s.eta;
      return shade::surface_sample(wrong, wo, u).wi;
    });
  };
  return {
      eval_mutant("pdf times 1.03", scaled_pdf, [](const SurfaceParams& p) { return is_plain(p) && !is_mirror(p); }),
      {"roughness in place of alpha", roughness_for_alpha,
       [](const SurfaceParams& p) { return is_rough_metal(p) && p.roughness < 1.0f; }},
      {"all normals instead of the visible ones",
       [](const SurfaceParams& p) { return with_directions(p, sample_all_normals); },
       [](const SurfaceParams& p) { return is_rough_metal(p) && p.roughness >= 0.1f; }},
      {"uniform directions instead of cosine-weighted ones",
       [](const SurfaceParams& p) { return with_directions(p, sample_uniform_for_cosine); }, has_diffuse},
      {"refraction by the inverse index", refracts_inversely, is_rough_body}};
}

std::vector<Mutant> density_mutants() {
  const auto refracted_as_reflected = [](const Surface& s, vec3 wo, vec3 wi) {
    SurfaceEval e = shade::surface_eval(s, wo, wi);
    if (wi.z >= 0.0f) return e;
    const vec3 wm = shade::microfacet_half_refract(wo, wi, s.eta);
    e.pdf /= 4.0f * dot(wo, wm) * shade::microfacet_refract_jacobian(dot(wo, wm), dot(wi, wm), s.eta);
    return e;
  };
  return {eval_mutant("pdf times 1.03", scaled_pdf, is_plain),
          eval_mutant("Jacobian without its 4", four_missing_in_pdf, is_rough_metal),
          eval_mutant("Jacobian of reflection for refraction", refracted_as_reflected, is_rough_body),
          eval_mutant("pdf of layers times 1.03", scaled_pdf,
                      [](const SurfaceParams& p) { return (p.lobes & shade::kLobeClearcoat) != 0; })};
}

std::vector<Mutant> weight_mutants() {
  const auto off = [](const SurfaceParams& p) {
    return with_sample(p, [](const Surface&, vec3, SurfaceSample& r) { r.weight *= 1.001f; });
  };
  const auto without_cosine = [](const SurfaceParams& p) {
    return with_sample(p, [](const Surface&, vec3, SurfaceSample& r) { r.weight /= std::max(r.wi.z, 1e-6f); });
  };
  // Divided by the density of the lobe that was chosen, not of both.
  const auto own_density = [](const SurfaceParams& p) {
    return with_sample(p, [](const Surface& s, vec3, SurfaceSample& r) {
      if (r.pdf > 0.0f && !r.is_delta) r.weight *= r.pdf / ((1.0f - s.chance_specular) * shade::cosine_pdf(r.wi.z));
    });
  };
  return {{"weight times 1.001", off, reflects_diffusely},
          {"cosine forgotten", without_cosine, reflects_diffusely},
          {"density of one lobe only", own_density,
           [](const SurfaceParams& p) { return !is_mirror(p) && has_diffuse(p) && has_specular(p); }}};
}

std::vector<Mutant> mean_mutants() {
  const auto brighter_eval = [](const SurfaceParams& p) {
    Bsdf bsdf = real_bsdf(p);
    bsdf.seen_from = [p](vec3 wo) {
      return Closure{real_bsdf(brighter_f0(p)).seen_from(wo).eval, real_bsdf(p).seen_from(wo).draw};
    };
    return bsdf;
  };
  const auto without_cosine = [](const SurfaceParams& p) {
    return with_sample(p, [](const Surface&, vec3, SurfaceSample& r) { r.weight /= std::max(r.wi.z, 1e-6f); });
  };
  // Drawing again until a direction is above the horizon is a common way to brighten rough metals.
  const auto never_fails = [](const SurfaceParams& p) {
    Bsdf bsdf = real_bsdf(p);
    bsdf.seen_from = [p](vec3 wo) {
      const Closure real = real_bsdf(p).seen_from(wo);
      return Closure{real.eval, [real](vec3 u) {
                       SurfaceSample r = real.draw(u);
                       for (int i = 0; i < 100 && r.pdf == 0.0f; ++i) {
                         u = glm::fract(u + vec3(0.618034f, 0.754878f, 0.0f));
                         r = real.draw(u);
                       }
                       return r;
                     }};
    };
    return bsdf;
  };
  const auto bright_metal = [](const SurfaceParams& p) { return is_rough_metal(p) && !is_black(p); };
  return {{"F0 scaled by 1.05", brighter_eval, bright_metal},
          {"cosine forgotten", without_cosine, reflects_diffusely},
          {"failed samples are drawn again", never_fails,
           [=](const SurfaceParams& p) { return bright_metal(p) && p.roughness >= 0.3f; }}};
}

std::vector<Mutant> smooth_limit_mutants() {
  const auto without_fresnel = [](const SurfaceParams& p) {
    return with_sample(p, [](const Surface& s, vec3, SurfaceSample& r) {
      if (r.is_delta) r.weight = vec3(1.0f / s.chance_specular);
    });
  };
  const auto without_chance = [](const SurfaceParams& p) {
    return with_sample(p, [](const Surface& s, vec3, SurfaceSample& r) {
      if (r.is_delta) r.weight *= s.chance_specular;
    });
  };
  const auto straight_back = [](const SurfaceParams& p) {
    return with_sample(p, [](const Surface&, vec3 wo, SurfaceSample& r) {
      if (r.is_delta) r.wi = wo;
    });
  };
  const auto dielectric = [](const SurfaceParams& p) { return has_boundary(p) && p.metallic == 0.0f && p.ior > 1.0f; };
  const auto bends_a_sheet = [](const SurfaceParams& p) {
    return with_sample(p, [](const Surface& s, vec3 wo, SurfaceSample& r) {
      if (r.is_straight) r.wi = shade::microfacet_refract(wo, vec3(0.0f, 0.0f, 1.0f), s.eta);
    });
  };
  return {{"a sheet bends light", bends_a_sheet,
           [](const SurfaceParams& p) {
             return p.lobes == shade::kLobeTransmission && p.is_thin && p.transmission == 1.0f;
           }},
          {"the mirror has no Fresnel", without_fresnel, dielectric},
          {"the mirror's weight is not divided by its chance", without_chance,
           [=](const SurfaceParams& p) { return dielectric(p) && has_diffuse(p); }},
          {"the mirror returns light to the viewer", straight_back, has_specular}};
}

}  // namespace candela::laws
