#include "laws/bsdf_laws.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "laws/quadrature.h"
#include "support/random.h"
#include "support/statistics.h"

namespace candela::laws {

namespace {

using laws::HemisphereQuadrature;
using test::Moments;
using test::Pcg32;

constexpr int kSamples = 8192;
// Single precision noise of eval plus the tolerance of the cells, summed over a few hundred cells.
constexpr double kCellTolerance = 2e-6;
constexpr double kQuadratureError = 2e-4;
// Where facets end in the midst of a hemisphere, quadrature is less sure.
constexpr double kBentQuadratureError = 2e-3;

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

bool nearly(float a, float b, float relative, float absolute) {
  return std::abs(a - b) <= absolute + relative * std::max(std::abs(a), std::abs(b));
}
bool nearly(vec3 a, vec3 b, float relative, float absolute) {
  return nearly(a.x, b.x, relative, absolute) && nearly(a.y, b.y, relative, absolute) &&
         nearly(a.z, b.z, relative, absolute);
}

vec3 mirrored(vec3 w) { return {w.x, w.y, -w.z}; }

double quadrature_error(const Bsdf& bsdf) { return bsdf.eta != 1.0 ? kBentQuadratureError : kQuadratureError; }

/// f·cos and pdf over both hemispheres; narrow lobes sit around the peaks.
struct Sphere {
  Sphere(const Bsdf& bsdf, const Closure& closure, vec3 wo, double max_share)
      : above(side(bsdf, closure, wo, false, max_share)), below(side(bsdf, closure, wo, true, max_share)) {}

  static HemisphereQuadrature side(const Bsdf& bsdf, const Closure& closure, vec3 wo, bool is_below, double max_share) {
    const laws::DirectionFunction f = [&](vec3 w) {
      const SurfaceEval e = closure.eval(is_below ? mirrored(w) : w);
      return glm::dvec4(glm::dvec3(e.value), static_cast<double>(e.pdf));
    };
    std::vector<vec3> peaks;
    for (const vec3 peak : bsdf.peaks(wo)) {
      if ((peak.z < 0.0f) == is_below) peaks.push_back(is_below ? mirrored(peak) : peak);
    }
    laws::QuadratureOptions options;
    options.tolerance = kCellTolerance;
    options.max_share = max_share;
    if (is_below && bsdf.eta != 1.0) options.even_depth = 10;
    return HemisphereQuadrature(f, peaks, options);
  }

  glm::dvec4 integral() const { return above.integral() + below.integral(); }
  std::size_t cells() const { return above.cells().size() + below.cells().size(); }
  std::size_t cell_of(vec3 w) const {
    return w.z < 0.0f ? above.cells().size() + below.cell_of(mirrored(w)) : above.cell_of(w);
  }

  HemisphereQuadrature above;
  HemisphereQuadrature below;
};

}  // namespace

Verdict reciprocity(const Bsdf& bsdf, const Trial& trial) {
  if (!trial.promise.is_reciprocal) return {};
  const double error = laws::reciprocity_error(bsdf);
  return error <= laws::reciprocity_slack(bsdf.eta != 1.0) ? Verdict{}
                                                           : failure("f(wo, wi) and f(wi, wo) differ by ", error);
}

Verdict finiteness(const Bsdf& bsdf, const Trial&) {
  const laws::Flaws flaws = laws::flaws(bsdf);
  return flaws.count == 0 ? Verdict{} : failure(flaws.count, " of ", flaws.looked_at, ": ", flaws.first);
}

Verdict opacity(const Bsdf& bsdf, const Trial&) {
  Pcg32 random(17);
  for (const vec3 wo : view_directions()) {
    const Closure closure = bsdf.seen_from(wo);
    for (int i = 0; i < 64; ++i) {
      const vec3 u = random.next_vec3();
      const SurfaceEval below = closure.eval(direction(-std::max(u.x, 1e-4f), 6.28f * u.y));
      if (below.value != vec3(0.0f) || below.pdf != 0.0f) {
        return failure("light from below: ", show(below.value), " pdf ", below.pdf, " for wo ", show(wo));
      }
      const SurfaceSample s = closure.draw(u);
      if (s.pdf > 0.0f && !(s.wi.z > 0.0f)) return failure("sampled ", show(s.wi), " for wo ", show(wo));
    }
  }
  return {};
}

Verdict energy(const Bsdf& bsdf, const Trial& trial) {
  const laws::FurnaceRange range = laws::furnace_range(bsdf, 1e-5);
  if (range.most > 1.0 + trial.promise.gain) return failure("albedo up to ", range.most);
  if (trial.promise.is_white && range.least < 1.0 - trial.promise.loss) return failure("albedo down to ", range.least);
  return {};
}

int pdf_integrates_to_one_tests() { return 2 * static_cast<int>(view_directions().size()); }

Verdict pdf_integrates_to_one(const Bsdf& bsdf, const Trial& trial) {
  Pcg32 random(trial.seed);
  for (const vec3 wo : view_directions()) {
    const Closure closure = bsdf.seen_from(wo);
    const double integral = Sphere(bsdf, closure, wo, 1e30).integral().w;
    int without_density = 0;  // delta or no sample at all
    int deltas = 0;
    double chance = 0.0;
    for (const laws::DeltaLobe& lobe : laws::delta_lobes(closure)) chance += static_cast<double>(lobe.pdf);
    for (int i = 0; i < kSamples; ++i) {
      const SurfaceSample s = closure.draw(random.next_vec3());
      if (s.is_delta || s.pdf == 0.0f) ++without_density;
      if (s.is_delta && s.pdf > 0.0f) ++deltas;
    }
    if (test::share_p_value(without_density, kSamples, 1.0 - integral, quadrature_error(bsdf)) < trial.threshold) {
      return failure("integral of the pdf ", integral, " + share of delta and failed samples ",
                     static_cast<double>(without_density) / kSamples, " is not 1 for wo ", show(wo));
    }
    if (test::share_p_value(deltas, kSamples, chance, 1e-6) < trial.threshold) {
      return failure("delta lobes say they are chosen with probability ", chance, " and are with ",
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
    const Closure closure = bsdf.seen_from(wo);
    const Sphere sphere(bsdf, closure, wo, kMaxShare);
    std::vector<double> observed(sphere.cells() + 1, 0.0);
    std::vector<double> expected;
    for (const glm::dvec4& cell : sphere.above.cells()) expected.push_back(cell.w * kSamples);
    for (const glm::dvec4& cell : sphere.below.cells()) expected.push_back(cell.w * kSamples);
    // The last bin is for samples without a density; how many there are is what pdf_integrates_to_one checks.
    for (int i = 0; i < kSamples; ++i) {
      const SurfaceSample s = closure.draw(random.next_vec3());
      const bool has_density = s.pdf > 0.0f && !s.is_delta;
      observed[has_density ? sphere.cell_of(s.wi) : sphere.cells()] += 1.0;
    }
    const double rest = 1.0 - sphere.integral().w;
    if (rest < -quadrature_error(bsdf)) {
      return failure("integral of the pdf ", sphere.integral().w, " for wo ", show(wo));
    }
    expected.push_back(std::max(rest, 0.0) * kSamples);
    const test::ChiSquare chi = test::chi_square_test(observed, expected);
    if (chi.p_value < trial.threshold) {
      return failure("chi square ", chi.statistic, " with ", chi.degrees, " degrees, p = ", chi.p_value, " < ",
                     trial.threshold, " for wo ", show(wo));
    }
  }
  return {};
}

Verdict weight_is_eval_over_pdf(const Bsdf& bsdf, const Trial&) {
  Pcg32 random(13);
  for (const vec3 wo : view_directions()) {
    const Closure closure = bsdf.seen_from(wo);
    for (int i = 0; i < 200; ++i) {
      const SurfaceSample s = closure.draw(random.next_vec3());
      if (s.is_delta || s.pdf == 0.0f) continue;
      const SurfaceEval e = closure.eval(s.wi);
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
    const Closure closure = bsdf.seen_from(wo);
    const glm::dvec4 albedo = Sphere(bsdf, closure, wo, 1e30).integral();
    const double failed = std::clamp(1.0 - albedo.w, 0.0, 1.0);
    std::array<Moments, 3> mean;
    for (int i = 0; i < kSamples; ++i) {
      const SurfaceSample s = closure.draw(random.next_vec3());
      for (int c = 0; c < 3; ++c)
        mean[static_cast<std::size_t>(c)].add(s.is_delta ? 0.0 : static_cast<double>(s.weight[c]));
    }
    for (int c = 0; c < 3; ++c) {
      const Moments& m = mean[static_cast<std::size_t>(c)];
      // Failed samples weigh nothing and may be too rare to have been met: their variance is known all the same, and
      // three of them are forgiven.
      const double slack = quadrature_error(bsdf) + 3.0 / kSamples * albedo[c];
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
    const glm::dvec4 difference = glm::abs(laws::furnace(mirror, wo) - laws::furnace(narrow, wo));
    if (std::max(difference.x, std::max(difference.y, difference.z)) > kTolerance) {
      return failure("albedos of the mirror and of a narrow lobe differ by ", show(vec3(difference)), " for wo ",
                     show(wo));
    }
    for (const laws::DeltaLobe& lobe : laws::delta_lobes(mirror.seen_from(wo))) {
      const std::vector<vec3> peaks = mirror.peaks(wo);
      const auto goes_to = [&](vec3 peak) { return glm::length(lobe.wi - peak) < 1e-6f; };
      if (std::none_of(peaks.begin(), peaks.end(), goes_to)) {
        return failure("a mirror sends wo ", show(wo), " to ", show(lobe.wi));
      }
    }
  }
  return {};
}

}  // namespace candela::laws
