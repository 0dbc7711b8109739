#include "laws/laws.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "laws/quadrature.h"

namespace candela::laws {

namespace {

using shade::Surface;
using shade::SurfaceEval;
using shade::SurfaceParams;
using shade::SurfaceSample;
using shade::vec2;
using shade::vec3;

std::string show(vec3 v) {
  std::ostringstream text;
  text.precision(7);
  text << '(' << v.x << ", " << v.y << ", " << v.z << ')';
  return text.str();
}

bool is_proper(float x) { return std::isfinite(x) && x >= 0.0f; }
bool is_proper(vec3 v) { return is_proper(v.x) && is_proper(v.y) && is_proper(v.z); }

vec3 mirrored(vec3 w) { return {w.x, w.y, -w.z}; }

std::function<Closure(vec3 wo)> seen(const SurfaceParams& params) {
  return [params](vec3 wo) {
    const Surface s = shade::surface_prepare(params, wo);
    return Closure{[s, wo](vec3 wi) { return shade::surface_eval(s, wo, wi); },
                   [s, wo](vec3 u) { return shade::surface_sample(s, wo, u); }};
  };
}

/// Refracted lobes end where their facets do, in the midst of a hemisphere.
bool is_bent(const Bsdf& bsdf) { return bsdf.eta != 1.0; }

/// Integrals of f·cos and pdf over one side.
glm::dvec4 integrate_side(const Closure& closure, const std::vector<vec3>& peaks, bool is_behind, bool has_edges,
                          double tolerance) {
  const DirectionFunction f = [&](vec3 w) {
    const SurfaceEval e = closure.eval(is_behind ? mirrored(w) : w);
    return glm::dvec4(glm::dvec3(e.value), static_cast<double>(e.pdf));
  };
  std::vector<vec3> on_side;
  for (const vec3 peak : peaks) {
    if ((peak.z < 0.0f) == is_behind) on_side.push_back(is_behind ? mirrored(peak) : peak);
  }
  QuadratureOptions options;
  options.tolerance = tolerance;
  if (has_edges) options.even_depth = 10;
  return HemisphereQuadrature(f, on_side, options).integral();
}

}  // namespace

vec3 lattice_point(int i) {
  const auto part = [i](double step) {
    const double x = 0.5 + step * (i + 1);
    return static_cast<float>((x - std::floor(x)) * (1.0 - 1e-7));
  };
  return {part(0.8191725133961644), part(0.6710436067037892), part(0.5497004779019702)};
}

SurfaceParams params_from_behind(SurfaceParams params) {
  params.eta = 1.0f / params.eta;
  return params;
}

Bsdf real_bsdf(const SurfaceParams& params) {
  Bsdf bsdf;
  const bool is_bent = (params.lobes & shade::kLobeTransmission) != 0 && !params.is_thin;
  bsdf.eta = is_bent ? static_cast<double>(params.eta) : 1.0;
  bsdf.seen_from = seen(params);
  bsdf.seen_from_behind = seen(params_from_behind(params));
  bsdf.peaks = [params, is_bent](vec3 wo) {
    std::vector<vec3> peaks = {vec3(-wo.x, -wo.y, wo.z)};
    if ((params.lobes & shade::kLobeClearcoat) != 0) {
      peaks.push_back(shade::microfacet_reflect(wo, params.clearcoat_normal));
    }
    if ((params.lobes & shade::kLobeTransmission) != 0) {
      const vec3 bent = shade::microfacet_refract(wo, vec3(0.0f, 0.0f, 1.0f), is_bent ? params.eta : 1.0f);
      if (bent != vec3(0.0f)) peaks.push_back(bent);
      if (is_bent) peaks.push_back(-wo);  // where media hardly differ, light seen at grazing angles hardly bends
    }
    if ((params.lobes & shade::kLobeRetroreflection) != 0) peaks.push_back(wo);
    return peaks;
  };
  return bsdf;
}

vec3 direction(float cos_theta, float phi) {
  const float sine = std::sqrt(std::max(1.0f - cos_theta * cos_theta, 0.0f));
  return {sine * std::cos(phi), sine * std::sin(phi), cos_theta};
}

std::vector<vec3> view_directions() {
  return {direction(1.0f, 0.0f), direction(0.7f, 0.7f), direction(0.3f, 2.9f), direction(0.05f, -1.1f)};
}

std::vector<DeltaLobe> delta_lobes(const Closure& closure) {
  constexpr int kChoices = 4096;  // the rarest lobe has a share of a few thousandths
  std::vector<DeltaLobe> lobes;
  SurfaceSample last = shade::surface_no_sample(vec3(0.0f));
  for (int i = 0; i < kChoices; ++i) {
    const float choice = (static_cast<float>(i) + 0.5f) / static_cast<float>(kChoices);
    const SurfaceSample s = closure.draw(vec3(0.37f, 0.61f, choice));
    // A lobe is an interval of choices: a new one begins where anything changes.
    const bool is_new = !last.is_delta || s.wi != last.wi || s.pdf != last.pdf || s.weight != last.weight;
    if (s.is_delta && s.pdf > 0.0f && is_new) lobes.push_back({s.wi, s.weight * s.pdf, s.pdf});
    last = s;
  }
  return lobes;
}

glm::dvec4 furnace(const Bsdf& bsdf, vec3 wo, double tolerance) {
  const Closure closure = bsdf.seen_from(wo);
  const std::vector<vec3> peaks = bsdf.peaks(wo);
  const double behind = bsdf.eta * bsdf.eta;
  glm::dvec4 sum = integrate_side(closure, peaks, false, false, tolerance);
  sum += integrate_side(closure, peaks, true, is_bent(bsdf), tolerance) * glm::dvec4(behind, behind, behind, 1.0);
  for (const DeltaLobe& lobe : delta_lobes(closure)) {
    sum += glm::dvec4(glm::dvec3(lobe.value) * (lobe.wi.z < 0.0f ? behind : 1.0), 0.0);
  }
  return sum;
}

namespace {

void widen(FurnaceRange& range, glm::dvec4 albedo) {
  range.least = std::min(range.least, std::min(albedo.x, std::min(albedo.y, albedo.z)));
  range.most = std::max(range.most, std::max(albedo.x, std::max(albedo.y, albedo.z)));
}

}  // namespace

FurnaceRange furnace_range(const Bsdf& bsdf, double tolerance) {
  FurnaceRange range{1e30, -1e30};
  for (const vec3 wo : view_directions()) widen(range, furnace(bsdf, wo, tolerance));
  return range;
}

Measurement measure(const Bsdf& bsdf, double tolerance) {
  constexpr int kSamples = 32768;
  Measurement m;
  m.reciprocity = reciprocity_error(bsdf);
  m.flaws = flaws(bsdf);
  m.furnace = {1e30, -1e30};
  for (const vec3 wo : view_directions()) {
    const glm::dvec4 albedo = furnace(bsdf, wo, tolerance);
    widen(m.furnace, albedo);
    const Closure closure = bsdf.seen_from(wo);
    int without_density = 0;
    for (int i = 0; i < kSamples; ++i) {
      const SurfaceSample s = closure.draw(lattice_point(i));
      if (s.is_delta || s.pdf == 0.0f) ++without_density;
    }
    m.pdf = std::max(m.pdf, std::abs(albedo.w + static_cast<double>(without_density) / kSamples - 1.0));
  }
  return m;
}

double reciprocity_error(const Bsdf& bsdf) {
  constexpr int kPairs = 300;
  constexpr double kFloor = 1e-3 / 3.14159265;
  const double eta2 = bsdf.eta * bsdf.eta;
  double worst = 0.0;
  for (int i = 0; i < kPairs; ++i) {
    const vec3 u = lattice_point(i);
    // Every third pair is grazing, down to a cosine of 1e-4.
    const float low = i % 3 == 0 ? std::pow(10.0f, -4.0f * u.x) : 0.01f + 0.99f * u.x;
    const vec3 wo = direction(low, 1.3f);
    const Closure there = bsdf.seen_from(wo);
    // Half of the pairs are near a peak, where the lobes are.
    vec3 wi = direction(0.01f + 0.99f * u.z, 6.28f * u.y);
    if (i % 2 == 1) {
      const std::vector<vec3> peaks = bsdf.peaks(wo);
      const vec3 peak = peaks[static_cast<std::size_t>(i / 2) % peaks.size()];
      wi = glm::normalize(peak + 0.02f * (u - vec3(0.5f)));
    } else if (i % 4 == 0) {
      wi = mirrored(wi);
    }
    if (std::abs(wi.z) < 1e-4f) continue;
    const bool is_through = wi.z < 0.0f;
    const Closure back = is_through ? bsdf.seen_from_behind(mirrored(wi)) : bsdf.seen_from(wi);
    const glm::dvec3 forward = glm::dvec3(there.eval(wi).value) / std::abs(static_cast<double>(wi.z));
    const glm::dvec3 backward = glm::dvec3(back.eval(is_through ? mirrored(wo) : wo).value) / static_cast<double>(wo.z);
    for (int c = 0; c < 3; ++c) {
      const double a = forward[c] * (is_through ? eta2 : 1.0);
      const double b = backward[c];
      worst = std::max(worst, std::abs(a - b) / (std::max(std::abs(a), std::abs(b)) + kFloor));
    }
  }
  return worst;
}

namespace {

std::string flaw_of_eval(const SurfaceEval& e, vec3 wo, vec3 wi) {
  if (is_proper(e.value) && is_proper(e.pdf)) return {};
  std::ostringstream text;
  text << "eval " << show(e.value) << " pdf " << e.pdf << " for wo " << show(wo) << " wi " << show(wi);
  return text.str();
}

std::string flaw_of_sample(const SurfaceSample& s, vec3 wo, vec3 u) {
  std::ostringstream text;
  if (!is_proper(s.weight) || !is_proper(s.pdf)) {
    text << "weight " << show(s.weight) << " pdf " << s.pdf;
  } else if (s.pdf == 0.0f && s.weight != vec3(0.0f)) {
    text << "a weight without a density";
  } else if (s.pdf > 0.0f && (!(std::abs(s.wi.z) > 0.0f) || !(std::abs(glm::length(s.wi) - 1.0f) < 1e-5f))) {
    text << "sampled wi " << show(s.wi);
  } else {
    return {};
  }
  text << " for wo " << show(wo) << " u " << show(u);
  return text.str();
}

}  // namespace

Flaws flaws(const Bsdf& bsdf) {
  constexpr std::array<float, 8> kCosines = {1e-4f, 1e-3f, 0.01f, 0.1f, 0.5f, 0.9f, 0.9999f, 1.0f};
  constexpr std::array<float, 7> kTurns = {0.0f, 1e-3f, 0.5f, 1.57f, 3.0f, 3.1405f, 3.14159265f};
  constexpr float kAlmostOne = 0x1.fffffep-1f;
  constexpr std::array<float, 5> kUnits = {0.0f, 1e-6f, 0.5f, 0.93f, kAlmostOne};
  Flaws found;
  const auto note = [&](const std::string& flaw) {
    ++found.looked_at;
    if (flaw.empty()) return;
    if (found.count == 0) found.first = flaw;
    ++found.count;
  };
  for (const float cos_o : kCosines) {
    const vec3 wo = direction(cos_o, 0.0f);
    const Closure closure = bsdf.seen_from(wo);
    for (const float cos_i : kCosines) {
      for (const float turn : kTurns) {
        const vec3 wi = direction(cos_i, turn);
        note(flaw_of_eval(closure.eval(wi), wo, wi));
        note(flaw_of_eval(closure.eval(mirrored(wi)), wo, mirrored(wi)));
      }
    }
    for (const float x : kUnits) {
      for (const float y : kUnits) {
        for (const float z : kUnits) note(flaw_of_sample(closure.draw(vec3(x, y, z)), wo, vec3(x, y, z)));
      }
    }
  }
  return found;
}

}  // namespace candela::laws
