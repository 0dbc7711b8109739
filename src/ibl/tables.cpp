#include "ibl/tables.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/parallel.h"
#include "shade/albedo.h"
#include "shade/surface_constants.glsl.h"

namespace candela::ibl {
namespace {

vec3 view_direction(float mu) { return {std::sqrt(std::max(1.0f - mu * mu, 0.0f)), 0.0f, mu}; }

struct SplitSums {
  dvec2 smith{0.0};
  dvec2 k_ibl{0.0};
};

SplitSums split_sums(float mu, float roughness) {
  const vec3 wo = view_direction(mu);
  const float alpha = std::max(shade::roughness_to_alpha(roughness), shade::kGgxMirrorAlpha);
  const float k = shade::schlick_k_ibl(roughness);
  SplitSums sums;
  shade::over_ggx(wo, alpha, [&](vec3 wi, float cos_m, double weight) {
    const auto fresnel = static_cast<double>(shade::schlick_weight(cos_m));
    const dvec2 parts(weight * (1.0 - fresnel), weight * fresnel);
    sums.smith += parts;
    sums.k_ibl += parts * static_cast<double>(shade::v_schlick_ggx(wo, wi, k) / shade::ggx_v_smith(wo, wi, alpha));
  });
  return sums;
}

/// A point of a product of Gauss's rules over half the hemisphere, which counts twice.
struct LightPoint {
  vec3 wi;
  double weight;
  double cosine;
  double x;  ///< cos θ = x²: denser at the horizon, where the sheen lobe is
};

std::vector<LightPoint> half_hemisphere() {
  const shade::GaussRule rule = shade::gauss_rule(24);
  std::vector<LightPoint> points;
  points.reserve(rule.nodes.size() * rule.nodes.size());
  for (std::size_t j = 0; j < rule.nodes.size(); ++j) {
    const double x = rule.nodes[j];
    const double cosine = x * x;
    const double sine = std::sqrt(1.0 - cosine * cosine);
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      const double azimuth = std::numbers::pi * rule.nodes[i];
      const vec3 wi(static_cast<float>(sine * std::cos(azimuth)), static_cast<float>(sine * std::sin(azimuth)),
                    static_cast<float>(cosine));
      points.push_back({wi, rule.weights[j] * rule.weights[i], cosine, x});
    }
  }
  return points;
}

}  // namespace

vec2 split_sum(float mu, float roughness) {
  return shade::ggx_split_sum(view_direction(mu), shade::roughness_to_alpha(roughness));
}

vec2 split_sum_k_ibl(float mu, float roughness) { return split_sums(mu, roughness).k_ibl; }

float sheen_albedo(float mu, float roughness) {
  static const std::vector<LightPoint> lights = half_hemisphere();
  const vec3 wo = view_direction(mu);
  const float alpha = shade::sheen_alpha(roughness);
  double sum = 0.0;
  for (const auto& [wi, weight, cosine, x] : lights) {
    const float lobe = shade::charlie_d(glm::normalize(wo + wi), alpha) * shade::neubelt_v(wo, wi);
    sum += weight * static_cast<double>(lobe) * cosine * 2.0 * x;
  }
  return static_cast<float>(sum * 2.0 * std::numbers::pi);
}

Tables make_tables(int size) {
  Tables tables{Image(size, size, 3), Image(size, size, 3)};
  parallel_for(0, static_cast<std::size_t>(size), 1, [&](std::size_t begin, std::size_t end) {
    for (auto y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      const float roughness = (static_cast<float>(y) + 0.5f) / static_cast<float>(size);
      for (int x = 0; x < size; ++x) {
        const float mu = (static_cast<float>(x) + 0.5f) / static_cast<float>(size);
        const SplitSums sums = split_sums(mu, roughness);
        tables.dfg.set_rgb(x, y, vec3(vec2(sums.smith), sheen_albedo(mu, roughness)));
        tables.dfg_k_ibl.set_rgb(x, y, vec3(vec2(sums.k_ibl), 0.0f));
      }
    }
  });
  return tables;
}

}  // namespace candela::ibl
