// Computes the tables of shade/tables.glsl.h and writes them as C++ source. Runs once per build; every sum is a fixed
// quadrature or a fixed point set, so that all builds have the same numbers.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <vector>

#include "shade/albedo.h"
#include "shade/fresnel.glsl.h"
#include "shade/microfacet.glsl.h"
#include "shade/surface_constants.glsl.h"
#include "shade/tables.glsl.h"

namespace candela::shade {

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

void make_ggx() {
  for (int r = 0; r < kTableRoughness; ++r) {
    const float alpha = roughness_to_alpha(roughness_at(r, kTableRoughness));
    for (int m = 0; m < kTableMu; ++m) {
      const vec2 ab = ggx_split_sum(direction(mu_at(m, kTableMu)), alpha);
      at(kTableGgx, (r * kTableMu + m) * 2) = ab.x;
      at(kTableGgx, (r * kTableMu + m) * 2 + 1) = ab.y;
    }
    for (int c = 0; c < 2; ++c) {
      at(kTableGgxMean, r * 2 + c) =
          static_cast<float>(mean_over_mu([&](int m) { return get(kTableGgx, (r * kTableMu + m) * 2 + c); }, kTableMu));
    }
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

double glass_albedo(vec3 wo, float alpha, float eta) {
  constexpr int kPoints = 1024;
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
    if (refracted.z < 0.0f) sum += (1.0 - f) * masking(wo, refracted, alpha);
  });
  return sum / kPoints;
}

void make_glass() {
  for (int side = 0; side < 2; ++side) {
    for (int i = 0; i < kTableIndices; ++i) {
      const double root = static_cast<double>(i) / (kTableIndices - 1);
      const double x = static_cast<double>(kTableGlassMost) * root * root;
      const double dense = std::max((1.0 + x) / (1.0 - x), 1.0 + 1e-4);
      const auto eta = static_cast<float>(side == 0 ? dense : 1.0 / dense);
      for (int r = 0; r < kTableRoughness; ++r) {
        const float alpha = roughness_to_alpha(roughness_at(r, kTableRoughness));
        const int row = ((side * kTableIndices + i) * kTableRoughness + r) * kTableMu;
        for (int m = 0; m < kTableMu; ++m) {
          at(kTableGlass, row + m) = static_cast<float>(glass_albedo(direction(mu_at(m, kTableMu)), alpha, eta));
        }
        at(kTableGlassMean, (side * kTableIndices + i) * kTableRoughness + r) =
            static_cast<float>(mean_over_mu([&](int m) { return get(kTableGlass, row + m); }, kTableMu));
      }
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
    float mu, weight, schlick;
  };
  for (int lobe = 0; lobe < n; ++lobe) {
    const float alpha = roughness_to_alpha(roughness_at(lobe, n));
    // ----- the white lobe: single scattering as directions with weights, the rest as a product of escapes
    std::vector<std::vector<Scattered>> sampled(n);
    std::vector<double> escape(n, 0.0);
    for (int m = 0; m < n; ++m) {
      const vec3 wo = direction(mu_at(m, n));
      auto& scattered = sampled[static_cast<std::size_t>(m)];
      if (alpha < kGgxMirrorAlpha) {
        scattered = {{wo.z, 1.0f, schlick_weight(wo.z)}};
        continue;
      }
      double albedo = 0.0;
      over_visible(wo, alpha, kPoints, [&](vec3 wm) {
        const vec3 wi = microfacet_reflect(wo, wm);
        if (wi.z <= 0.0f) return;
        const double w = masking(wo, wi, alpha) / kPoints;
        scattered.push_back({wi.z, static_cast<float>(w), schlick_weight(dot(wo, wm))});
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
          a += value * (1.0 - static_cast<double>(w.schlick));
          b += value * static_cast<double>(w.schlick);
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

/// Albedo of the coat: Schlick from kCoatF0, with its own multiple scattering.
double coat_albedo(int layer, double mu) {
  const double r = layer_at(layer) * (kTableRoughness - 1);
  const int r0 = std::min(static_cast<int>(r), kTableRoughness - 2);
  double e_mean = 0.0;
  for (int c = 0; c < 2; ++c) {
    e_mean += (1.0 - (r - r0)) * get(kTableGgxMean, r0 * 2 + c) + (r - r0) * get(kTableGgxMean, r0 * 2 + 2 + c);
  }
  const double a = read_between(kTableGgx, layer_at(layer), mu, 2, 0);
  const double b = read_between(kTableGgx, layer_at(layer), mu, 2, 1);
  const double f0 = static_cast<double>(kCoatF0);
  const double f_mean = f0 + (1.0 - f0) / 21.0;
  return f0 * a + b + f_mean * f_mean * e_mean / (1.0 - f_mean * (1.0 - e_mean)) * (1.0 - a - b);
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
  make_sheen();
  make_glass();
  make_over(kTableCoatOver, [](int layer, double mu) { return 1.0 - coat_albedo(layer, mu); });
  make_over(kTableSheenOver, [](int layer, double mu) { return 1.0 - sheen_albedo(layer, mu); });
  make_anisotropic();
  make_film();
  std::FILE* file = std::fopen(argv[1], "w");
  if (file == nullptr) return 1;
  write(file);
  return std::fclose(file) == 0 ? 0 : 1;
}
