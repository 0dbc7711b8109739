// Computes the tables of shade/tables.glsl.h and writes them as C++ source. Runs once per build; every sum is a fixed
// quadrature or a fixed point set, so that all builds have the same numbers.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <numbers>
#include <vector>

#include "shade/albedo.h"
#include "shade/facet_walk.h"
#include "shade/fresnel.glsl.h"
#include "shade/microfacet.glsl.h"
#include "shade/surface_base.glsl.h"
#include "shade/surface_constants.glsl.h"
#include "shade/tables.glsl.h"

namespace candela::shade {

using glm::dmat3;
using glm::dvec3;

// The generator links no tables: nothing here may look one up.
const float kTableEntries[] = {0.0f};
const int kTableCount = 1;

namespace {

std::vector<float> g_table(kTableSize);

float& at(int table, int index) { return g_table[static_cast<std::size_t>(table + index)]; }
double get(int table, int index) { return static_cast<double>(g_table[static_cast<std::size_t>(table + index)]); }

double mu_at(int i, int count) {
  const double x = static_cast<double>(i) / (count - 1);
  return std::max(x * x, 1e-5);  // the limit at the horizon, from a hair above it
}

float roughness_at(int i, int count) { return static_cast<float>(i) / static_cast<float>(count - 1); }

/// The inverse of table_cell_sheen.
float sheen_roughness_at(int i, int count) {
  const float x = roughness_at(i, count);
  return kSheenLeastRoughness + (1.0f - kSheenLeastRoughness) * x * x;
}

vec3 direction(double mu) {
  return {static_cast<float>(std::sqrt(std::max(1.0 - mu * mu, 0.0))), 0.0f, static_cast<float>(mu)};
}

/// Roberts 2018, the additive recurrence with the plastic number: `count` points that fill a square evenly.
vec2 point(int i) {
  const double x = 0.5 + 0.7548776662466927 * (i + 1);
  const double y = 0.5 + 0.5698402909980532 * (i + 1);
  return {static_cast<float>(x - std::floor(x)), static_cast<float>(y - std::floor(y))};
}

/// Linear in x = √µ, as the renderers read.
double read_row(const std::vector<double>& row, double mu) {
  const double s = std::sqrt(std::clamp(mu, 0.0, 1.0)) * static_cast<double>(row.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(s), row.size() - 2);
  const double t = s - static_cast<double>(i);
  return row[i] * (1.0 - t) + row[i + 1] * t;
}

/// Mean of f(wm) over facets seen from `wo`.
template <class F>
void over_visible(vec3 wo, float alpha, int count, const F& f) {
  for (int i = 0; i < count; ++i) f(ggx_sample_visible(wo, alpha, point(i)));
}

double masking(vec3 wo, vec3 wi, float alpha) {  // G2 / G1(wo)
  const double lo = static_cast<double>(ggx_lambda(wo, alpha));
  return (1.0 + lo) / (1.0 + lo + static_cast<double>(ggx_lambda(wi, alpha)));
}

/// 2 ∫ f(µ) µ dµ of a table row over cosines, exact for what table_cell_mu interpolates (Simpson on each interval, of
/// the polynomial in x = √µ that it is there).
double mean_over_mu(const std::function<double(int)>& f, int count) {
  double sum = 0.0;
  for (int i = 0; i + 1 < count; ++i) {
    const double x0 = static_cast<double>(i) / (count - 1);
    const double h = 1.0 / (count - 1);
    // 2 µ dµ = 4 x³ dx; f is linear in x: degree four, so three Gauss points are exact.
    const double nodes[3] = {0.5 - 0.5 * std::sqrt(0.6), 0.5, 0.5 + 0.5 * std::sqrt(0.6)};
    const double weights[3] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
    for (int k = 0; k < 3; ++k) {
      const double x = x0 + nodes[k] * h;
      const double value = (1.0 - nodes[k]) * f(i) + nodes[k] * f(i + 1);
      sum += weights[k] * h * value * 4.0 * x * x * x;
    }
  }
  return sum;
}

/// The inverse of table_curve.
float curve_index(int curve) {
  const double root = static_cast<double>(curve - 1) / (kTableCurves - 2);
  const double x = static_cast<double>(kTableCurveMost) * root * root;
  return static_cast<float>((1.0 + x) / (1.0 - x));
}

/// How far a curve has risen at a facet. 1 / (1 - F0) is computed once: this is asked millions of times.
class Curve {
 public:
  explicit Curve(int curve) : index_(curve == 0 ? 0.0f : curve_index(curve)) {
    if (index_ > 0.0f) scale_ = fresnel_rise_scale(index_);
  }
  double at(float cos_m) const {
    return static_cast<double>(index_ > 0.0f ? fresnel_rise(cos_m, index_, scale_) : schlick_weight(cos_m));
  }

 private:
  float index_, scale_ = 1.0f;
};

void make_ggx() {
  std::vector<Curve> curves;
  curves.reserve(kTableCurves);
  for (int c = 0; c < kTableCurves; ++c) curves.emplace_back(c);
  for (int r = 0; r < kTableRoughness; ++r) {
    const float alpha = roughness_to_alpha(roughness_at(r, kTableRoughness));
    for (int m = 0; m < kTableMu; ++m) {
      const vec3 wo = direction(mu_at(m, kTableMu));
      double white = 0.0;
      std::vector<double> rise(curves.size(), 0.0);
      const auto add = [&](float cos_m, double weight) {
        white += weight;
        for (std::size_t c = 0; c < curves.size(); ++c) rise[c] += weight * curves[c].at(cos_m);
      };
      if (alpha < kGgxMirrorAlpha) {
        add(wo.z, 1.0);
      } else {
        over_ggx(wo, alpha, [&](vec3, float cos_m, double weight) { add(cos_m, weight); });
      }
      for (int c = 0; c < kTableCurves; ++c) {
        const int entry = c * kTableGgxSlice + (r * kTableMu + m) * 2;
        const double b = rise[static_cast<std::size_t>(c)];
        at(kTableGgx, entry) = static_cast<float>(white - b);
        at(kTableGgx, entry + 1) = static_cast<float>(b);
      }
    }
    for (int i = 0; i < 2 * kTableCurves; ++i) {
      const int c = i / 2, k = i % 2;
      const auto entry = [&](int m) { return get(kTableGgx, c * kTableGgxSlice + (r * kTableMu + m) * 2 + k); };
      at(kTableGgxMean, (c * kTableRoughness + r) * 2 + k) = static_cast<float>(mean_over_mu(entry, kTableMu));
    }
  }
  const GaussRule rule = gauss_rule(64);
  for (int c = 0; c < kTableCurves; ++c) {
    // µ = x³: near an index of 1 all of the rise is at the horizon.
    double sum = 0.0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      const double x = rule.nodes[i], mu = x * x * x;
      sum += rule.weights[i] * curves[static_cast<std::size_t>(c)].at(static_cast<float>(mu)) * 2.0 * mu * 3.0 * x * x;
    }
    at(kTableRise, c) = static_cast<float>(sum);
  }
}

/// Charlie's fitted masking returns up to three times the light that arrives at grazing angles where the fibres are
/// narrow. A factor n(µo) n(µi) ≤ 1 takes that back and leaves the rest alone.
void make_sheen() {
  constexpr int kTheta = 96;
  constexpr int kPhi = 48;
  constexpr int kIterations = 64;
  constexpr double kMost = 0.99;  // so that something reaches the base at every angle
  for (int r = 0; r < kTableRoughness; ++r) {
    const float alpha = sheen_alpha(sheen_roughness_at(r, kTableRoughness));
    // ----- the lobe, integrated over azimuth: kernel[µo][µi]
    std::vector<std::vector<double>> kernel(kTableMu, std::vector<double>(kTheta, 0.0));
    for (int m = 0; m < kTableMu; ++m) {
      const vec3 wo = direction(mu_at(m, kTableMu));
      for (int i = 0; i < kTheta; ++i) {
        // µ = x², dµ = 2x dx: denser at the horizon, where the lobe is.
        const double x = (i + 0.5) / kTheta;
        const double mu = x * x;
        const double sine = std::sqrt(1.0 - mu * mu);
        double sum = 0.0;
        for (int j = 0; j < kPhi; ++j) {
          const double phi = (j + 0.5) / kPhi * std::numbers::pi;
          const vec3 wi(static_cast<float>(sine * std::cos(phi)), static_cast<float>(sine * std::sin(phi)),
                        static_cast<float>(mu));
          sum += static_cast<double>(charlie_d(normalize(wo + wi), alpha) * charlie_v(wo, wi, alpha));
        }
        kernel[static_cast<std::size_t>(m)][static_cast<std::size_t>(i)] =
            sum * mu * 2.0 * x * 2.0 * std::numbers::pi / (kTheta * kPhi);
      }
    }
    std::vector<double> n(kTableMu, 1.0);
    std::vector<double> albedo(kTableMu, 0.0);
    for (int k = 0; k <= kIterations; ++k) {
      for (std::size_t m = 0; m < kTableMu; ++m) {
        double sum = 0.0;
        for (std::size_t i = 0; i < kTheta; ++i) {
          const double x = (static_cast<double>(i) + 0.5) / kTheta;
          sum += kernel[m][i] * read_row(n, x * x);
        }
        albedo[m] = sum * n[m];
      }
      if (k == kIterations) break;
      for (std::size_t m = 0; m < kTableMu; ++m) n[m] = std::min(1.0, n[m] * std::sqrt(kMost / albedo[m]));
    }
    for (int m = 0; m < kTableMu; ++m) {
      at(kTableSheenScale, r * kTableMu + m) = static_cast<float>(n[static_cast<std::size_t>(m)]);
      at(kTableSheen, r * kTableMu + m) = static_cast<float>(std::min(albedo[static_cast<std::size_t>(m)], kMost));
    }
  }
}

/// Masking of light that goes through, over that of wo alone: the facets that hide it and those that shade it lie on
/// either side, so that no height does both. Heitz et al. 2016, eq. 15: G2 = B(1 + Λ(wo), 1 + Λ(wi)).
double masking_through(vec3 wo, vec3 wi, float alpha) {
  const auto o = static_cast<double>(ggx_lambda(wo, alpha)), i = static_cast<double>(ggx_lambda(wi, alpha));
  return std::exp(std::lgamma(1.0 + o) + std::lgamma(1.0 + i) - std::lgamma(2.0 + o + i)) * (1.0 + o);
}

/// What single scattering at a boundary returns; `hidden` is how much more it lets through than it should, because its
/// masking is that of reflection.
double glass_albedo(vec3 wo, float alpha, float eta, double& hidden) {
  constexpr int kPoints = 1024;
  hidden = 0.0;
  if (alpha < kGgxMirrorAlpha) return 1.0;
  double sum = 0.0;
  over_visible(wo, alpha, kPoints, [&](vec3 wm) {
    const float c = dot(wo, wm);
    const auto f = static_cast<double>(fresnel_dielectric(c, eta));
    const vec3 reflected = microfacet_reflect(wo, wm);
    if (reflected.z > 0.0f) sum += f * masking(wo, reflected, alpha);
    const double k = 1.0 - (1.0 - static_cast<double>(c) * c) / (static_cast<double>(eta) * eta);
    if (k <= 0.0) return;
    const vec3 refracted = wm * static_cast<float>(static_cast<double>(c) / eta - std::sqrt(k)) - wo / eta;
    if (refracted.z >= 0.0f) return;
    sum += (1.0 - f) * masking(wo, refracted, alpha);
    hidden += (1.0 - f) * (masking(wo, refracted, alpha) - masking_through(wo, refracted, alpha));
  });
  hidden /= kPoints;
  return sum / kPoints;
}

/// PCG-XSH-RR 64/32. O'Neill 2014, "PCG: A Family of Simple Fast Space-Efficient Statistically Good Algorithms".
class Random {
 public:
  float next_float() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005U + 1442695040888963407U;
    const auto mixed = static_cast<std::uint32_t>(((old >> 18) ^ old) >> 27);
    const auto turn = static_cast<std::uint32_t>(old >> 59);
    return static_cast<float>(((mixed >> turn) | (mixed << ((32U - turn) & 31U))) >> 8) * 0x1p-24f;
  }
  vec2 next_vec2() {
    const float x = next_float();
    return {x, next_float()};
  }

 private:
  std::uint64_t state_ = 0x853c49e6748fea9bU;
};

/// Smoother surfaces scatter too little light twice to be worth the walks: they have what this one has.
constexpr float kLeastWalked = 0.25f;

bool is_walked(int r) { return roughness_at(r, kTableRoughness) >= kLeastWalked; }

/// One of `count` directions whose cosines are distributed as those of light from everywhere.
vec3 arriving(int i, int count) { return direction(std::sqrt((i + 0.5) / count)); }

void make_walks() {
  constexpr int kWalks = 65536;
  std::vector<Curve> curves;
  curves.reserve(kTableCurves);
  for (int c = 0; c < kTableCurves; ++c) curves.emplace_back(c);
  for (int r = kTableRoughness - 1; r >= 0; --r) {
    if (!is_walked(r)) {
      for (int k = 0; k < 2; ++k) at(kTableWalk, 2 * r + k) = at(kTableWalk, 2 * r + 2 + k);
      for (int c = 0; c < kTableCurves; ++c) {
        at(kTableWalkRise, c * kTableRoughness + r) = at(kTableWalkRise, c * kTableRoughness + r + 1);
      }
      continue;
    }
    Random random;
    const FacetWalk<Random> walk(roughness_to_alpha(roughness_at(r, kTableRoughness)), random);
    double multiple = 0.0, second = 0.0, beyond = 0.0;
    std::vector<double> rise(curves.size(), 0.0);
    std::vector<float> cosines;
    for (int i = 0; i < kWalks; ++i) {
      cosines.clear();
      const FacetExit exit = walk.over_mirrors(arriving(i, kWalks), [&](float c) { cosines.push_back(c); });
      if (exit.is_lost || exit.bounces < 2) continue;
      multiple += 1.0;
      if (exit.bounces == 2) second += 1.0;
      beyond += exit.bounces - 2;
      for (std::size_t c = 0; c < curves.size(); ++c) {
        for (const float cosine : cosines) rise[c] += curves[c].at(cosine) / exit.bounces;
      }
    }
    at(kTableWalk, 2 * r) = static_cast<float>(second / multiple);
    at(kTableWalk, 2 * r + 1) = static_cast<float>(beyond > 0.0 ? (multiple - second) / beyond : 1.0);
    for (int c = 0; c < kTableCurves; ++c) {
      at(kTableWalkRise, c * kTableRoughness + r) = static_cast<float>(rise[static_cast<std::size_t>(c)] / multiple);
    }
  }
}

/// The inverse of table_cell_index.
float glass_index(int i) {
  const double root = static_cast<double>(i) / (kTableIndices - 1);
  const double x = static_cast<double>(kTableGlassMost) * root * root;
  return static_cast<float>(std::max((1.0 + x) / (1.0 - x), 1.0 + 1e-4));
}

/// After the means of kTableGlass. `hidden` as glass_albedo() has it, in the mean.
float glass_through(int index, int r, float eta, double hidden) {
  constexpr int kWalks = 8192;
  Random random;
  const FacetWalk<Random> walk(roughness_to_alpha(roughness_at(r, kTableRoughness)), random);
  int multiple = 0, through = 0;
  for (int i = 0; i < kWalks; ++i) {
    const FacetExit exit = walk.over_glass(arriving(i, kWalks), eta);
    if (exit.is_lost || exit.bounces < 2) continue;
    ++multiple;
    if (exit.w.z < 0.0f) ++through;
  }
  const auto lost = [&](int side) {
    return 1.0 - get(kTableGlassMean, (side * kTableIndices + index) * kTableRoughness + r);
  };
  // What single scattering lets through too much is taken back here.
  const double crossing = (lost(0) + hidden) * through / std::max(multiple, 1) - hidden;
  // Nor may more of what the denser side loses cross than there is.
  const double most = std::min(1.0, lost(1) * static_cast<double>(eta * eta) / lost(0));
  return static_cast<float>(std::clamp(crossing / lost(0), 0.0, most));
}

void make_glass() {
  std::vector<double> hidden_mean(static_cast<std::size_t>(kTableIndices * kTableRoughness));
  for (int side = 0; side < 2; ++side) {
    for (int i = 0; i < kTableIndices; ++i) {
      const float eta = side == 0 ? glass_index(i) : 1.0f / glass_index(i);
      for (int r = 0; r < kTableRoughness; ++r) {
        const float alpha = roughness_to_alpha(roughness_at(r, kTableRoughness));
        const int row = ((side * kTableIndices + i) * kTableRoughness + r) * kTableMu;
        std::vector<double> hidden(kTableMu);
        for (int m = 0; m < kTableMu; ++m) {
          at(kTableGlass, row + m) = static_cast<float>(
              glass_albedo(direction(mu_at(m, kTableMu)), alpha, eta, hidden[static_cast<std::size_t>(m)]));
        }
        if (side == 0) {
          hidden_mean[static_cast<std::size_t>(i * kTableRoughness + r)] =
              mean_over_mu([&](int m) { return hidden[static_cast<std::size_t>(m)]; }, kTableMu);
        }
        at(kTableGlassMean, (side * kTableIndices + i) * kTableRoughness + r) =
            static_cast<float>(mean_over_mu([&](int m) { return get(kTableGlass, row + m); }, kTableMu));
      }
    }
  }
  for (int i = 0; i < kTableIndices; ++i) {
    for (int r = kTableRoughness - 1; r >= 0; --r) {
      const int entry = i * kTableRoughness + r;
      at(kTableGlassThrough, entry) =
          is_walked(r) ? glass_through(i, r, glass_index(i), hidden_mean[static_cast<std::size_t>(entry)])
                       : at(kTableGlassThrough, entry + 1);
    }
  }
}

/// The transmission T(µ) of a layer splits into s(µo) s(µi) such that a white lobe below it returns T(µo): the
/// symmetric scaling of a kernel to given sums (Sinkhorn 1967). `transmission` gives T by layer and cosine.
void make_over(int table, const std::function<double(int layer, double mu)>& transmission) {
  constexpr int n = kTableLobes;
  constexpr int kPoints = 512;
  constexpr int kIterations = 16;
  struct Scattered {
    float mu, weight, rise;
  };
  const Curve curve(kTableCurveOfGlass);
  const auto rise = [&](float cos_m) { return static_cast<float>(curve.at(cos_m)); };
  for (int lobe = 0; lobe < n; ++lobe) {
    const float alpha = roughness_to_alpha(roughness_at(lobe, n));
    // ----- the white lobe: single scattering as directions with weights, the rest as a product of escapes
    std::vector<std::vector<Scattered>> sampled(n);
    std::vector<double> escape(n, 0.0);
    for (int m = 0; m < n; ++m) {
      const vec3 wo = direction(mu_at(m, n));
      auto& scattered = sampled[static_cast<std::size_t>(m)];
      if (alpha < kGgxMirrorAlpha) {
        scattered = {{wo.z, 1.0f, rise(wo.z)}};
        continue;
      }
      double albedo = 0.0;
      over_visible(wo, alpha, kPoints, [&](vec3 wm) {
        const vec3 wi = microfacet_reflect(wo, wm);
        if (wi.z <= 0.0f) return;
        const double w = masking(wo, wi, alpha) / kPoints;
        scattered.push_back({wi.z, static_cast<float>(w), rise(dot(wo, wm))});
        albedo += w;
      });
      escape[static_cast<std::size_t>(m)] = 1.0 - albedo;
    }
    const double escape_mean = mean_over_mu([&](int m) { return escape[static_cast<std::size_t>(m)]; }, n);
    for (int layer = 0; layer < kTableLayers; ++layer) {
      std::vector<double> t(n);
      std::vector<double> s(n);
      for (int m = 0; m < n; ++m) {
        t[static_cast<std::size_t>(m)] = transmission(layer, mu_at(m, n));
        s[static_cast<std::size_t>(m)] = std::sqrt(t[static_cast<std::size_t>(m)]);
      }
      for (int k = 0; k < kIterations; ++k) {
        const double lost =
            escape_mean > 1e-6
                ? mean_over_mu(
                      [&](int m) { return escape[static_cast<std::size_t>(m)] * s[static_cast<std::size_t>(m)]; }, n) /
                      escape_mean
                : 0.0;
        std::vector<double> next(n);
        for (std::size_t m = 0; m < n; ++m) {
          double sum = escape[m] * lost;
          for (const Scattered& w : sampled[m])
            sum += static_cast<double>(w.weight) * read_row(s, static_cast<double>(w.mu));
          next[m] = std::sqrt(s[m] * t[m] / sum);
        }
        s = next;
      }
      for (std::size_t m = 0; m < n; ++m) {
        double a = 0.0;
        double b = 0.0;
        for (const Scattered& w : sampled[m]) {
          const double value = s[m] * static_cast<double>(w.weight) * read_row(s, static_cast<double>(w.mu));
          a += value * (1.0 - static_cast<double>(w.rise));
          b += value * static_cast<double>(w.rise);
        }
        const int entry = ((layer * n + lobe) * n + static_cast<int>(m)) * 3;
        at(table, entry) = static_cast<float>(s[m] / std::sqrt(t[m]));
        at(table, entry + 1) = static_cast<float>(a / t[m]);
        at(table, entry + 2) = static_cast<float>(b / t[m]);
      }
    }
  }
}

void make_anisotropic() {
  constexpr int n = kTableWidths;
  constexpr int kPoints = 1024;
  for (int x = 0; x < n; ++x) {
    for (int y = 0; y < n; ++y) {
      const float ax = std::max(roughness_to_alpha(roughness_at(x, n)), kGgxMirrorAlpha);
      const float ay = std::max(roughness_to_alpha(roughness_at(y, n)), kGgxMirrorAlpha);
      const double rx = std::sqrt(static_cast<double>(ax));
      const double ry = std::sqrt(static_cast<double>(ay));
      const double least = std::min(rx, ry);
      const double most = std::max(rx, ry);
      double mean[2] = {};
      for (int c = 0; c < kTableAzimuths; ++c) {
        // The azimuth along which the lobe is so rough; any where it is the same all around.
        const double along = least + (most - least) * c / (kTableAzimuths - 1);
        const double cos2 =
            x == y ? 0.5
                   : std::clamp((std::pow(along, 4.0) - std::pow(ry, 4.0)) / (std::pow(rx, 4.0) - std::pow(ry, 4.0)),
                                0.0, 1.0);
        const int row = ((x * n + y) * kTableAzimuths + c) * n;
        for (int m = 0; m < n; ++m) {
          const double mu = mu_at(m, n);
          const double sine = std::sqrt(1.0 - mu * mu);
          const vec3 wo(static_cast<float>(sine * std::sqrt(cos2)), static_cast<float>(sine * std::sqrt(1.0 - cos2)),
                        static_cast<float>(mu));
          const auto lo = static_cast<double>(ggx_lambda_aniso(wo, ax, ay));
          double albedo = 0.0;
          double rise = 0.0;
          for (int i = 0; i < kPoints; ++i) {
            const vec3 wm = ggx_sample_visible_aniso(wo, ax, ay, point(i));
            const vec3 wi = microfacet_reflect(wo, wm);
            if (wi.z <= 0.0f) continue;
            const double w = (1.0 + lo) / (1.0 + lo + static_cast<double>(ggx_lambda_aniso(wi, ax, ay))) / kPoints;
            albedo += w;
            rise += w * static_cast<double>(schlick_weight(dot(wo, wm)));
          }
          at(kTableAnisotropic, row + m) = static_cast<float>(1.0 - albedo);
          at(kTableAnisotropic + kTableAnisotropicSlice, row + m) = static_cast<float>(rise);
        }
        // How much of the circle each entry stands for.
        constexpr int kSteps = 512;
        double weight = 0.0;
        for (int k = 0; k < kSteps; ++k) {
          const double turn = std::pow(std::cos((k + 0.5) / kSteps * std::numbers::pi / 2.0), 2.0);
          const double r = std::pow(std::pow(ry, 4.0) * (1.0 - turn) + std::pow(rx, 4.0) * turn, 0.25);
          const double u = x == y ? 0.0 : (r - least) / (most - least) * (kTableAzimuths - 1);
          weight += std::max(0.0, 1.0 - std::abs(u - c)) / kSteps;
        }
        for (int k = 0; k < 2; ++k) {
          mean[k] +=
              weight *
              mean_over_mu([&](int m) { return get(kTableAnisotropic + k * kTableAnisotropicSlice, row + m); }, n);
        }
      }
      for (int k = 0; k < 2; ++k) at(kTableAnisotropicMean, (k * n + x) * n + y) = static_cast<float>(mean[k]);
    }
  }
}

void make_film() {
  constexpr int kPoints = 4096;
  std::vector<double> nodes = {0.0, 1.0};
  for (int i = 0; i < kFilmCosines; ++i) nodes.push_back(static_cast<double>(table_film_cosine(i)));
  const auto lagrange = [&](std::size_t node, double c) {
    double product = 1.0;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      if (k != node) product *= (c - nodes[k]) / (nodes[node] - nodes[k]);
    }
    return product;
  };
  for (int r = 0; r < kTableRoughness; ++r) {
    const float alpha = roughness_to_alpha(roughness_at(r, kTableRoughness));
    for (int m = 0; m < kTableMu; ++m) {
      const vec3 wo = direction(mu_at(m, kTableMu));
      const auto add = [&](double weight, double c) {
        for (int i = 0; i < kFilmCosines; ++i) {
          at(kTableFilm, (i * kTableRoughness + r) * kTableMu + m) +=
              static_cast<float>(weight * lagrange(static_cast<std::size_t>(i) + 2, c));
        }
      };
      if (alpha < kGgxMirrorAlpha) {
        add(1.0, static_cast<double>(wo.z));
        continue;
      }
      over_visible(wo, alpha, kPoints, [&](vec3 wm) {
        const vec3 wi = microfacet_reflect(wo, wm);
        if (wi.z > 0.0f) add(masking(wo, wi, alpha) / kPoints, static_cast<double>(dot(wo, wm)));
      });
    }
    for (int i = 0; i < kFilmCosines; ++i) {
      const int row = (i * kTableRoughness + r) * kTableMu;
      at(kTableFilmMean, i * kTableRoughness + r) =
          static_cast<float>(mean_over_mu([&](int m) { return get(kTableFilm, row + m); }, kTableMu));
    }
  }
}

// ----- lobes as linearly transformed cosines

/// A cosine lobe about z, transformed by the frame of the lobe's middle direction times
///     | x 0 s |
///     | 0 y 0 |
///     | 0 0 1 |
class TransformedCosine {
 public:
  TransformedCosine(dvec3 middle, std::array<double, 3> shape)
      : map_(dmat3(dvec3(middle.z, 0, -middle.x), dvec3(0, 1, 0), middle) *
             dmat3(dvec3(shape[0], 0, 0), dvec3(0, shape[1], 0), dvec3(shape[2], 0, 1))),
        inverse_(glm::inverse(map_)),
        scale_(std::abs(glm::determinant(inverse_))) {}

  double density(dvec3 w) const {
    const dvec3 v = inverse_ * w;
    const double length = glm::length(v);
    return std::max(v.z, 0.0) / length * std::numbers::inv_pi * scale_ / (length * length * length);
  }
  dvec3 sample(vec2 u) const {
    const double r = std::sqrt(static_cast<double>(u.x)), phi = 2 * std::numbers::pi * static_cast<double>(u.y);
    return glm::normalize(map_ * dvec3(r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - static_cast<double>(u.x))));
  }
  const dmat3& inverse() const { return inverse_; }

 private:
  dmat3 map_, inverse_;
  double scale_;
};

/// A white lobe of GGX seen from one direction, as a density.
class WhiteLobe {
 public:
  WhiteLobe(double mu, float alpha) : wo_(direction(mu)), alpha_(alpha) {
    over_visible(wo_, alpha_, kPoints, [&](vec3 wm) {
      const vec3 wi = microfacet_reflect(wo_, wm);
      if (wi.z <= 0.0f) return;
      const double weight = masking(wo_, wi, alpha_) / kPoints;
      albedo_ += weight;
      middle_ += dvec3(wi) * weight;
    });
    middle_.y = 0;
    middle_ = glm::normalize(middle_);
  }

  dvec3 middle() const { return middle_; }
  double density(vec3 wi) const {
    if (wi.z <= 0.0f) return 0.0;
    const vec3 wm = normalize(wo_ + wi);
    return static_cast<double>(ggx_d(wm, alpha_)) * static_cast<double>(ggx_v_smith(wo_, wi, alpha_)) *
           static_cast<double>(wi.z) / albedo_;
  }

  /// How much of one density lies elsewhere than the other, by points of both. (Heitz et al. take the cube of the
  /// difference: then shares of polygons are a third further off, most at grazing angles.)
  double distance(const TransformedCosine& cosine) const {
    double sum = 0.0;
    const auto add = [&](vec3 wi) {
      const vec3 wm = normalize(wo_ + wi);
      const double mine = density(wi), other = cosine.density(dvec3(wi));
      const double sampled = static_cast<double>(ggx_pdf_visible(wo_, wm, alpha_)) + other;
      if (sampled > 0.0) sum += std::abs(mine - other) / sampled;
    };
    for (int i = 0; i < kPoints; ++i) {
      add(microfacet_reflect(wo_, ggx_sample_visible(wo_, alpha_, point(i))));
      add(vec3(cosine.sample(point(i))));
    }
    return sum / kPoints;
  }

 private:
  static constexpr int kPoints = 256;
  vec3 wo_;
  float alpha_;
  double albedo_ = 0.0;
  dvec3 middle_{0};
};

using Shape = std::array<double, 3>;

/// The downhill simplex of Nelder & Mead 1965, "A Simplex Method for Function Minimization".
Shape minimize(const std::function<double(const Shape&)>& f, const Shape& start, double step) {
  constexpr std::size_t n = 3;
  constexpr int kSteps = 60;
  std::array<std::pair<double, Shape>, n + 1> simplex;
  for (std::size_t i = 0; i <= n; ++i) {
    simplex[i].second = start;
    if (i > 0) simplex[i].second[i - 1] += step * std::max(std::abs(start[i - 1]), 0.05);
    simplex[i].first = f(simplex[i].second);
  }
  const auto by_value = [](const auto& a, const auto& b) { return a.first < b.first; };
  for (int k = 0; k < kSteps; ++k) {
    std::sort(simplex.begin(), simplex.end(), by_value);
    Shape center{};
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t c = 0; c < n; ++c) center[c] += simplex[i].second[c] / n;
    }
    const auto beyond = [&](double t) {
      Shape p;
      for (std::size_t c = 0; c < n; ++c) p[c] = center[c] + t * (simplex[n].second[c] - center[c]);
      return std::pair(f(p), p);
    };
    const auto reflected = beyond(-1.0);
    if (reflected.first < simplex[0].first) {
      simplex[n] = std::min(reflected, beyond(-2.0), by_value);
    } else if (reflected.first < simplex[n - 1].first) {
      simplex[n] = reflected;
    } else if (const auto inside = beyond(0.5); inside.first < simplex[n].first) {
      simplex[n] = inside;
    } else {
      for (std::size_t i = 1; i <= n; ++i) {
        for (std::size_t c = 0; c < n; ++c) simplex[i].second[c] = 0.5 * (simplex[i].second[c] + simplex[0].second[c]);
        simplex[i].first = f(simplex[i].second);
      }
    }
  }
  return std::min_element(simplex.begin(), simplex.end(), by_value)->second;
}

/// From rough to smooth and from the normal to the horizon, each fit starting where its neighbour ended.
void make_cosines() {
  constexpr int n = kTableCosines;
  Shape at_normal = {1.0, 1.0, 0.0};
  for (int r = n - 1; r >= 0; --r) {
    const float alpha = roughness_to_alpha(roughness_at(std::max(r, 1), n));
    Shape shape = at_normal;
    for (int m = n - 1; m >= 0; --m) {
      const double mu = std::max(mu_at(m, n), 1e-3);
      const WhiteLobe lobe(mu, alpha);
      const bool is_round = m == n - 1;  // the lobe about the normal
      const auto clean = [&](Shape s) {
        s[0] = std::max(s[0], 1e-7), s[1] = std::max(s[1], 1e-7);
        return is_round ? Shape{s[0], s[0], 0.0} : s;
      };
      const auto error = [&](const Shape& s) { return lobe.distance(TransformedCosine(lobe.middle(), clean(s))); };
      shape = clean(minimize(error, shape, is_round ? 0.3 : 0.1));
      if (is_round) at_normal = shape;
      // A density does not know its map's scale: the middle number is 1.
      dmat3 inverse = TransformedCosine(lobe.middle(), shape).inverse();
      inverse /= inverse[1][1];
      const int entry = (r * n + m) * 4;
      at(kTableCosine, entry) = static_cast<float>(inverse[0][0]);
      at(kTableCosine, entry + 1) = static_cast<float>(inverse[0][2]);
      at(kTableCosine, entry + 2) = static_cast<float>(inverse[2][0]);
      at(kTableCosine, entry + 3) = static_cast<float>(inverse[2][2]);
    }
  }
}

/// A table over (x, µ) read between its rows, `stride` floats per entry.
double read_between(int table, double x, double mu, int stride, int offset) {
  const double r = x * (kTableRoughness - 1);
  const int r0 = std::min(static_cast<int>(r), kTableRoughness - 2);
  double sum = 0.0;
  for (int k = 0; k < 2; ++k) {
    std::vector<double> row(kTableMu);
    for (int m = 0; m < kTableMu; ++m) {
      row[static_cast<std::size_t>(m)] = get(table, ((r0 + k) * kTableMu + m) * stride + offset);
    }
    sum += (k == 0 ? 1.0 - (r - r0) : r - r0) * read_row(row, mu);
  }
  return sum;
}

double layer_at(int layer) { return static_cast<double>(layer) / (kTableLayers - 1); }

/// Albedo of the coat, with its own multiple scattering.
double coat_albedo(int layer, double mu) {
  const double r = layer_at(layer) * (kTableRoughness - 1);
  const int r0 = std::min(static_cast<int>(r), kTableRoughness - 2);
  constexpr int kTerms = kTableGgx + kTableCurveOfGlass * kTableGgxSlice;
  const auto between = [&](int table, int stride) {
    return (1.0 - (r - r0)) * get(table, r0 * stride) + (r - r0) * get(table, (r0 + 1) * stride);
  };
  const double a = read_between(kTerms, layer_at(layer), mu, 2, 0);
  const double b = read_between(kTerms, layer_at(layer), mu, 2, 1);
  const double f0 = static_cast<double>(kCoatF0);
  const double f_mean = f0 + (1.0 - f0) * between(kTableWalkRise + kTableCurveOfGlass * kTableRoughness, 1);
  const vec2 walk(static_cast<float>(between(kTableWalk, 2)), static_cast<float>(between(kTableWalk + 1, 2)));
  const auto share = static_cast<double>(multiscatter_share(static_cast<float>(f_mean), walk));
  return f0 * a + b + share * (1.0 - a - b);
}

double sheen_albedo(int layer, double mu) { return read_between(kTableSheen, layer_at(layer), mu, 1, 0); }

void write(std::FILE* file) {
  std::fputs(
      "// Written by shade/make_tables.cpp.\n\nnamespace candela::shade {\nextern const float kTableEntries[];\nextern "
      "const int kTableCount;\nconst float kTableEntries[] = {",
      file);
  for (std::size_t i = 0; i < g_table.size(); ++i)
    std::fprintf(file, "%s%.8ef,", i % 8 == 0 ? "\n" : " ", static_cast<double>(g_table[i]));
  std::fprintf(file, "\n};\nconst int kTableCount = %zu;\n}  // namespace candela::shade\n", g_table.size());
}

}  // namespace
}  // namespace candela::shade

int main(int argc, char** argv) {
  using namespace candela::shade;
  if (argc != 2) return 2;
  make_ggx();
  make_walks();
  make_sheen();
  make_glass();
  make_over(kTableCoatOver, [](int layer, double mu) { return 1.0 - coat_albedo(layer, mu); });
  make_over(kTableSheenOver, [](int layer, double mu) { return 1.0 - sheen_albedo(layer, mu); });
  make_anisotropic();
  make_film();
  make_cosines();
  std::FILE* file = std::fopen(argv[1], "w");
  if (file == nullptr) return 1;
  write(file);
  return std::fclose(file) == 0 ? 0 : 1;
}
