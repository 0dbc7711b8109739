#include "laws/bsdf_laws.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "support/quadrature.h"
#include "support/random.h"
#include "support/statistics.h"

namespace candela::laws {

namespace {

using test::HemisphereQuadrature;
using test::Moments;
using test::Pcg32;

constexpr int kSamples = 8192;
// Single precision noise of eval plus the tolerance of the cells, summed over a few hundred cells.
constexpr double kCellTolerance = 2e-6;
constexpr double kQuadratureError = 2e-4;

template <class... Values>
Verdict failure(const Values&... values) {
  std::ostringstream text;
  text.precision(7);
  (text << ... << values);
  return {false, text.str()};
}

std::string show(vec3 v) {
  std::ostringstream text;
  text.precision(7);
  text << '(' << v.x << ", " << v.y << ", " << v.z << ')';
  return text.str();
}

bool is_finite_and_not_negative(float x) { return std::isfinite(x) && x >= 0.0f; }
bool is_finite_and_not_negative(vec3 v) {
  return is_finite_and_not_negative(v.x) && is_finite_and_not_negative(v.y) && is_finite_and_not_negative(v.z);
}

bool nearly(float a, float b, float relative, float absolute) {
  return std::abs(a - b) <= absolute + relative * std::max(std::abs(a), std::abs(b));
}
bool nearly(vec3 a, vec3 b, float relative, float absolute) {
  return nearly(a.x, b.x, relative, absolute) && nearly(a.y, b.y, relative, absolute) &&
         nearly(a.z, b.z, relative, absolute);
}

// f·cos and pdf over the hemisphere of incident directions; narrow lobes sit around the mirror direction.
HemisphereQuadrature integrate_over_wi(const Bsdf& bsdf, vec3 wo, double max_share = 1e30) {
  const test::DirectionFunction f = [&](vec3 wi) {
    const SurfaceEval e = bsdf.eval(wo, wi);
    return glm::dvec4(glm::dvec3(e.value), static_cast<double>(e.pdf));
  };
  const std::array<vec3, 1> peaks = {vec3(-wo.x, -wo.y, wo.z)};
  return HemisphereQuadrature(f, peaks, {kCellTolerance, max_share});
}

// What delta lobes reflect: the mean of their weights over the choice of lobe.
glm::dvec3 delta_reflectance(const Bsdf& bsdf, vec3 wo) {
  constexpr int kChoices = 4096;
  glm::dvec3 sum(0.0);
  for (int i = 0; i < kChoices; ++i) {
    const float choice = (static_cast<float>(i) + 0.5f) / static_cast<float>(kChoices);
    const SurfaceSample s = bsdf.sample(wo, vec3(0.37f, 0.61f, choice));
    if (s.is_delta) sum += glm::dvec3(s.weight);
  }
  return sum / static_cast<double>(kChoices);
}

double largest(glm::dvec3 v) { return std::max(v.x, std::max(v.y, v.z)); }

}  // namespace

Bsdf real_bsdf(const SurfaceParams& params) {
  return {[params](vec3 wo, vec3 wi) { return shade::surface_eval(shade::surface_prepare(params, wo.z), wo, wi); },
          [params](vec3 wo, vec3 u) { return shade::surface_sample(shade::surface_prepare(params, wo.z), wo, u); }};
}

vec3 direction(float cos_theta, float phi) {
  const float sine = std::sqrt(std::max(1.0f - cos_theta * cos_theta, 0.0f));
  return {sine * std::cos(phi), sine * std::sin(phi), cos_theta};
}

std::vector<vec3> view_directions() {
  return {direction(1.0f, 0.0f), direction(0.7f, 0.7f), direction(0.3f, 2.9f), direction(0.05f, -1.1f)};
}

Verdict reciprocity(const Bsdf& bsdf) {
  Pcg32 random(11);
  for (int i = 0; i < 300; ++i) {
    // Every third pair is grazing, down to a cosine of 1e-4.
    const vec3 u = random.next_vec3();
    const float low = i % 3 == 0 ? std::pow(10.0f, -4.0f * u.x) : 0.01f + 0.99f * u.x;
    const vec3 wo = direction(low, 1.3f);
    // Half of the pairs are near the mirror direction, where the lobes are.
    const float phi = i % 2 == 0 ? 6.28f * u.y : 1.3f + 3.14f + 0.01f * u.y;
    const vec3 wi = direction(i % 2 == 0 ? 0.01f + 0.99f * u.z : std::min(low * (1.0f + 0.02f * u.z), 1.0f), phi);
    const vec3 forward = bsdf.eval(wo, wi).value / wi.z;
    const vec3 backward = bsdf.eval(wi, wo).value / wo.z;
    if (!nearly(forward, backward, 1e-5f, 1e-7f)) {
      return failure("f(wo, wi) = ", show(forward), " but f(wi, wo) = ", show(backward), " for wo ", show(wo), " wi ",
                     show(wi));
    }
  }
  return {};
}

namespace {

Verdict eval_is_finite(const Bsdf& bsdf, vec3 wo, vec3 wi) {
  const SurfaceEval e = bsdf.eval(wo, wi);
  if (!is_finite_and_not_negative(e.value) || !is_finite_and_not_negative(e.pdf)) {
    return failure("eval ", show(e.value), " pdf ", e.pdf, " for wo ", show(wo), " wi ", show(wi));
  }
  const SurfaceEval below = bsdf.eval(wo, vec3(wi.x, wi.y, -wi.z));
  if (below.value != vec3(0.0f) || below.pdf != 0.0f) {
    return failure("light from below: ", show(below.value), " pdf ", below.pdf, " for wo ", show(wo));
  }
  return {};
}

Verdict sample_is_finite(const Bsdf& bsdf, vec3 wo, vec3 u) {
  const SurfaceSample s = bsdf.sample(wo, u);
  if (!is_finite_and_not_negative(s.weight) || !is_finite_and_not_negative(s.pdf)) {
    return failure("weight ", show(s.weight), " pdf ", s.pdf, " for wo ", show(wo), " u ", show(u));
  }
  if (s.pdf == 0.0f) {
    return s.weight == vec3(0.0f) ? Verdict{} : failure("a weight without a density for wo ", show(wo), " u ", show(u));
  }
  if (!(s.wi.z > 0.0f) || !nearly(glm::length(s.wi), 1.0f, 0.0f, 1e-5f)) {
    return failure("sampled wi ", show(s.wi), " for wo ", show(wo), " u ", show(u));
  }
  return {};
}

}  // namespace

Verdict finiteness(const Bsdf& bsdf) {
  constexpr std::array<float, 8> kCosines = {1e-4f, 1e-3f, 0.01f, 0.1f, 0.5f, 0.9f, 0.9999f, 1.0f};
  constexpr std::array<float, 7> kTurns = {0.0f, 1e-3f, 0.5f, 1.57f, 3.0f, 3.1405f, 3.14159265f};
  constexpr float kAlmostOne = 0x1.fffffep-1f;
  constexpr std::array<float, 5> kUnits = {0.0f, 1e-6f, 0.5f, 0.93f, kAlmostOne};
  for (const float cos_o : kCosines) {
    const vec3 wo = direction(cos_o, 0.0f);
    for (const float cos_i : kCosines) {
      for (const float turn : kTurns) {
        if (Verdict v = eval_is_finite(bsdf, wo, direction(cos_i, turn)); !v.holds) return v;
      }
    }
    for (const float x : kUnits) {
      for (const float y : kUnits) {
        for (const float z : kUnits) {
          if (Verdict v = sample_is_finite(bsdf, wo, vec3(x, y, z)); !v.holds) return v;
        }
      }
    }
  }
  return {};
}

Verdict energy(const Bsdf& bsdf) {
  // The approximate boundary albedo of surface_prepare is up to 1.1 % off; anything beyond makes light.
  constexpr double kTolerance = 0.012;
  for (const vec3 wo : view_directions()) {
    const glm::dvec3 albedo = glm::dvec3(integrate_over_wi(bsdf, wo).integral()) + delta_reflectance(bsdf, wo);
    if (!(largest(albedo) <= 1.0 + kTolerance)) {
      return failure("albedo ", show(vec3(albedo)), " for wo ", show(wo));
    }
  }
  return {};
}

int pdf_integrates_to_one_tests() { return 2 * static_cast<int>(view_directions().size()); }

Verdict pdf_integrates_to_one(const Bsdf& bsdf, const Trial& trial) {
  Pcg32 random(trial.seed);
  for (const vec3 wo : view_directions()) {
    const double integral = integrate_over_wi(bsdf, wo).integral().w;
    int without_density = 0;  // delta or no sample at all
    int deltas = 0;
    Moments delta_chance;
    for (int i = 0; i < kSamples; ++i) {
      const SurfaceSample s = bsdf.sample(wo, random.next_vec3());
      if (s.is_delta || s.pdf == 0.0f) ++without_density;
      if (s.is_delta) ++deltas;
      if (s.is_delta) delta_chance.add(static_cast<double>(s.pdf));
    }
    if (test::share_p_value(without_density, kSamples, 1.0 - integral, kQuadratureError) < trial.threshold) {
      return failure("integral of the pdf ", integral, " + share of delta and failed samples ",
                     static_cast<double>(without_density) / kSamples, " is not 1 for wo ", show(wo));
    }
    if (test::share_p_value(deltas, kSamples, delta_chance.mean(), 1e-6) < trial.threshold) {
      return failure("a delta lobe says it is chosen with probability ", delta_chance.mean(), " and is with ",
                     static_cast<double>(deltas) / kSamples, " for wo ", show(wo));
    }
  }
  return {};
}

int sampling_follows_pdf_tests() { return static_cast<int>(view_directions().size()); }

Verdict sampling_follows_pdf(const Bsdf& bsdf, const Trial& trial) {
  // Cells of at most 1/100 of the samples: enough of them to see a shape, enough in each to count.
  constexpr double kMaxShare = 0.01;
  Pcg32 random(trial.seed);
  for (const vec3 wo : view_directions()) {
    const HemisphereQuadrature cells = integrate_over_wi(bsdf, wo, kMaxShare);
    std::vector<double> observed(cells.cells().size() + 1, 0.0);
    std::vector<double> expected;
    for (const glm::dvec4& cell : cells.cells()) expected.push_back(cell.w * kSamples);
    // The last bin is for samples without a density; how many there are is what pdf_integrates_to_one checks.
    for (int i = 0; i < kSamples; ++i) {
      const SurfaceSample s = bsdf.sample(wo, random.next_vec3());
      const bool has_density = s.pdf > 0.0f && !s.is_delta;
      observed[has_density ? cells.cell_of(s.wi) : cells.cells().size()] += 1.0;
    }
    const double rest = 1.0 - cells.integral().w;
    if (rest < -kQuadratureError) return failure("integral of the pdf ", cells.integral().w, " for wo ", show(wo));
    expected.push_back(std::max(rest, 0.0) * kSamples);
    const test::ChiSquare chi = test::chi_square_test(observed, expected);
    if (chi.p_value < trial.threshold) {
      return failure("chi square ", chi.statistic, " with ", chi.degrees, " degrees, p = ", chi.p_value, " < ",
                     trial.threshold, " for wo ", show(wo));
    }
  }
  return {};
}

Verdict weight_is_eval_over_pdf(const Bsdf& bsdf) {
  Pcg32 random(13);
  for (const vec3 wo : view_directions()) {
    for (int i = 0; i < 200; ++i) {
      const SurfaceSample s = bsdf.sample(wo, random.next_vec3());
      if (s.is_delta || s.pdf == 0.0f) continue;
      const SurfaceEval e = bsdf.eval(wo, s.wi);
      if (!nearly(s.pdf, e.pdf, 1e-4f, 0.0f) || !nearly(s.weight * s.pdf, e.value, 1e-4f, 1e-6f)) {
        return failure("weight ", show(s.weight), " pdf ", s.pdf, " but eval ", show(e.value), " pdf ", e.pdf,
                       " for wo ", show(wo), " wi ", show(s.wi));
      }
    }
  }
  return {};
}

int mean_weight_is_albedo_tests() { return 3 * static_cast<int>(view_directions().size()); }

Verdict mean_weight_is_albedo(const Bsdf& bsdf, const Trial& trial) {
  Pcg32 random(trial.seed);
  for (const vec3 wo : view_directions()) {
    const glm::dvec4 albedo = integrate_over_wi(bsdf, wo).integral();
    const double failed = std::clamp(1.0 - albedo.w, 0.0, 1.0);
    std::array<Moments, 3> mean;
    for (int i = 0; i < kSamples; ++i) {
      const SurfaceSample s = bsdf.sample(wo, random.next_vec3());
      for (int c = 0; c < 3; ++c)
        mean[static_cast<std::size_t>(c)].add(s.is_delta ? 0.0 : static_cast<double>(s.weight[c]));
    }
    for (int c = 0; c < 3; ++c) {
      const Moments& m = mean[static_cast<std::size_t>(c)];
      // Failed samples weigh nothing and may be too rare to have been met: their variance is known all the same, and
      // three of them are forgiven.
      const double slack = kQuadratureError + 3.0 / kSamples * albedo[c];
      const double p = test::z_test_p_value(m, albedo[c], slack, failed * (1.0 - failed) * albedo[c] * albedo[c]);
      if (p < trial.threshold) {
        return failure("mean weight ", m.mean(), " +- ", m.standard_error(), " but albedo ", albedo[c], " in channel ",
                       c, ", p = ", p, " for wo ", show(wo));
      }
    }
  }
  return {};
}

Verdict smooth_limit(const std::function<Bsdf(float roughness)>& family) {
  // Fresnel's curve bends over the lobe's width; at these angles that is worth less than half a percent.
  constexpr double kTolerance = 0.005;
  const Bsdf mirror = family(0.0f);
  const Bsdf narrow = family(1.01f * std::sqrt(shade::kGgxMirrorAlpha));
  for (const float cosine : {1.0f, 0.8f, 0.4f}) {
    const vec3 wo = direction(cosine, 0.7f);
    const glm::dvec3 below = glm::dvec3(integrate_over_wi(mirror, wo).integral()) + delta_reflectance(mirror, wo);
    const glm::dvec3 above = glm::dvec3(integrate_over_wi(narrow, wo).integral()) + delta_reflectance(narrow, wo);
    if (largest(glm::abs(below - above)) > kTolerance) {
      return failure("albedo of the mirror ", show(vec3(below)), ", of a narrow lobe ", show(vec3(above)), " for wo ",
                     show(wo));
    }
    for (int i = 0; i < 64; ++i) {
      const SurfaceSample s = mirror.sample(wo, vec3(0.3f, 0.6f, (static_cast<float>(i) + 0.5f) / 64.0f));
      if (s.is_delta && glm::length(s.wi - vec3(-wo.x, -wo.y, wo.z)) > 1e-6f) {
        return failure("the mirror sends wo ", show(wo), " to ", show(s.wi));
      }
    }
  }
  return {};
}

}  // namespace candela::laws
