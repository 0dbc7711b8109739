// What shade/make_tables.cpp computed, against quadrature by another way and against published numbers.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "laws/laws.h"
#include "laws/quadrature.h"
#include "laws/split_sums.h"
#include "shade/surface.glsl.h"

namespace candela::laws {
namespace {

using laws::direction;
using shade::vec2;
using shade::vec3;

template <class F>
double over_hemisphere(vec3 wo, const F& f, int even_depth = 0) {
  const laws::DirectionFunction g = [&](vec3 wi) { return glm::dvec4(static_cast<double>(f(wi))); };
  const std::array<vec3, 1> peaks = {vec3(-wo.x, -wo.y, wo.z)};
  laws::QuadratureOptions options;
  options.even_depth = even_depth;
  return laws::HemisphereQuadrature(g, peaks, options).integral().x;
}

/// The white lobe, with `weight` of the cosine at the facet.
template <class F>
double ggx_albedo(vec3 wo, float ax, float ay, const F& weight) {
  return over_hemisphere(wo, [&](vec3 wi) {
    const vec3 wm = glm::normalize(wo + wi);
    return shade::ggx_d_aniso(wm, ax, ay) * shade::ggx_v_smith_aniso(wo, wi, ax, ay) * wi.z *
           weight(glm::dot(wo, wm), wi);
  });
}

float table_albedo(float mu, float roughness) {
  const vec2 ab = shade::table_ggx(mu, shade::table_ggx_roughness(roughness));
  return ab.x + ab.y;
}

/// Off the entries of the table, where it interpolates.
constexpr std::array<float, 4> kCosines = {0.07f, 0.23f, 0.55f, 0.97f};
constexpr std::array<float, 5> kRoughnesses = {0.15f, 0.37f, 0.52f, 0.71f, 0.93f};

TEST(law_tables, ggx_equals_quadrature) {
  double wrong = 0.0;
  for (const float mu : kCosines) {
    for (const float r : kRoughnesses) {
      const float alpha = shade::roughness_to_alpha(r);
      const vec3 wo = direction(mu, 0.3f);
      const vec2 ab = shade::table_ggx(mu, shade::table_ggx_roughness(r));
      const double b = ggx_albedo(wo, alpha, alpha, [](float cos_m, vec3) { return shade::schlick_weight(cos_m); });
      const double all = ggx_albedo(wo, alpha, alpha, [](float, vec3) { return 1.0f; });
      EXPECT_NEAR(static_cast<double>(ab.y), b, 3e-3) << mu << ' ' << r;
      EXPECT_NEAR(static_cast<double>(ab.x + ab.y), all, 3e-3) << mu << ' ' << r;
      const double confused = ggx_albedo(wo, r, r, [](float, vec3) { return 1.0f; });  // roughness for alpha
      wrong = std::max(wrong, std::abs(static_cast<double>(ab.x + ab.y) - confused));
    }
  }
  EXPECT_GT(wrong, 0.1);
}

TEST(law_tables, ggx_has_the_published_albedos) {
  // E(µ) at µ = 0.1 0.2 0.4 0.6 0.8 1, and the cosine-weighted mean, by quadrature in double precision.
  struct Row {
    float roughness;
    std::array<float, 6> albedo;
    float mean;
  };
  const std::array<Row, 5> rows = {{{0.2f, {0.9291f, 0.9753f, 0.9934f, 0.9967f, 0.9977f, 0.9984f}, 0.9943f},
                                    {0.4f, {0.8883f, 0.8698f, 0.9079f, 0.9404f, 0.9581f, 0.9677f}, 0.9404f},
                                    {0.6f, {0.8824f, 0.8258f, 0.7839f, 0.7867f, 0.8044f, 0.8245f}, 0.8029f},
                                    {0.8f, {0.8331f, 0.7489f, 0.6514f, 0.5988f, 0.5699f, 0.5552f}, 0.6042f},
                                    {1.0f, {0.7602f, 0.6417f, 0.4989f, 0.4115f, 0.3513f, 0.3069f}, 0.4092f}}};
  const std::array<float, 6> cosines = {0.1f, 0.2f, 0.4f, 0.6f, 0.8f, 1.0f};
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < cosines.size(); ++i) {
      EXPECT_NEAR(table_albedo(cosines[i], row.roughness), row.albedo[i], 2.5e-3f)
          << cosines[i] << ' ' << row.roughness;
    }
    const vec2 mean = shade::table_ggx_mean(shade::table_ggx_roughness(row.roughness));
    EXPECT_NEAR(mean.x + mean.y, row.mean, 1e-3f) << row.roughness;
  }
  // Exact: 1 - ln 2.
  EXPECT_NEAR(table_albedo(1.0f, 1.0f), 1.0f - std::log(2.0f), 5e-4f);
}

TEST(law_tables, ggx_has_the_published_split_sums) {
  for (const laws::SplitSum& e : laws::kSplitSums) {
    const vec2 ab = shade::table_ggx(e.mu, shade::table_ggx_roughness(e.roughness));
    EXPECT_NEAR(ab.x, e.a, 3e-3f) << e.roughness << ' ' << e.mu;
    EXPECT_NEAR(ab.y, e.b, 3e-3f) << e.roughness << ' ' << e.mu;
  }
}

TEST(law_tables, sheen_equals_quadrature) {
  for (const float mu : kCosines) {
    for (const float r : kRoughnesses) {
      const vec3 wo = direction(mu, 0.3f);
      const float alpha = shade::sheen_alpha(r);
      const auto lobe = [&](vec3 wi) {
        return shade::charlie_d(glm::normalize(wo + wi), alpha) * shade::charlie_v(wo, wi, alpha) * wi.z;
      };
      const double scaled = over_hemisphere(wo, [&](vec3 wi) { return lobe(wi) * shade::table_sheen_scale(wi.z, r); }) *
                            static_cast<double>(shade::table_sheen_scale(mu, r));
      const auto tabulated = static_cast<double>(shade::table_sheen(mu, r));
      EXPECT_NEAR(tabulated, scaled, 6e-3) << mu << ' ' << r;
    }
  }
  // Narrow fibres alone return more than arrives at grazing angles.
  double unscaled = 0.0;
  for (const float mu : {0.01f, 0.03f, 0.1f, 0.2f}) {
    for (const float r : {0.07f, 0.1f, 0.2f}) {
      const vec3 wo = direction(mu, 0.3f);
      const float alpha = shade::sheen_alpha(r);
      const double alone = over_hemisphere(wo, [&](vec3 wi) {
        return shade::charlie_d(glm::normalize(wo + wi), alpha) * shade::charlie_v(wo, wi, alpha) * wi.z;
      });
      unscaled = std::max(unscaled, alone - static_cast<double>(shade::table_sheen(mu, r)));
    }
  }
  EXPECT_GT(unscaled, 0.05);
}

TEST(law_tables, glass_equals_quadrature) {
  double swapped = 0.0;
  for (const float eta : {1.1f, 1.5f, 2.42f, 1.0f / 1.5f}) {
    for (const float mu : {0.23f, 0.55f, 0.97f}) {
      for (const float r : {0.37f, 0.71f}) {
        const vec3 wo = direction(mu, 0.3f);
        const float alpha = shade::roughness_to_alpha(r);
        const double reflected =
            ggx_albedo(wo, alpha, alpha, [&](float cos_m, vec3) { return shade::fresnel_dielectric(cos_m, eta); });
        const auto through = [&](vec3 above) {  // Walter et al. 2007, eq. 21, as energy
          const vec3 wi(above.x, above.y, -above.z);
          const vec3 wm = shade::microfacet_half_refract(wo, wi, eta);
          const float cos_o = glm::dot(wo, wm);
          const float cos_i = glm::dot(wi, wm);
          if (cos_o <= 0.0f || cos_i >= 0.0f) return 0.0f;
          return (1.0f - shade::fresnel_dielectric(cos_o, eta)) * 4.0f * cos_o * shade::ggx_d(wm, alpha) *
                 shade::ggx_v_smith(wo, above, alpha) * above.z * shade::microfacet_refract_jacobian(cos_o, cos_i, eta);
        };
        const double all = reflected + over_hemisphere(wo, through, 10);
        EXPECT_NEAR(static_cast<double>(shade::table_glass(mu, r, eta)), all, 0.01) << mu << ' ' << r << ' ' << eta;
        swapped = std::max(swapped, std::abs(static_cast<double>(shade::table_glass(mu, r, 1.0f / eta)) - all));
      }
    }
  }
  EXPECT_GT(swapped, 0.05);  // a table that mistakes one side for the other would be seen
}

/// A white lobe below a layer returns what the layer lets through.
TEST(law_tables, layers_over_a_white_lobe_return_their_transmission) {
  double undivided = 0.0;
  for (const bool is_coat : {true, false}) {
    for (const float layer : {0.2f, 0.6f}) {
      for (const float r : {0.3f, 0.71f}) {
        const shade::TableCell row = shade::table_ggx_roughness(r);
        const float alpha = shade::roughness_to_alpha(r);
        shade::SurfaceParams p = shade::surface_params_default();
        p.lobes = is_coat ? shade::kLobeClearcoat : shade::kLobeSheen;
        p.clearcoat = 1.0f;
        p.clearcoat_roughness = layer;
        p.sheen_color = vec3(1.0f);
        p.sheen_roughness = layer;
        p.roughness = r;
        const auto factor = [&](const shade::Surface& s, float mu) {
          const shade::LayersAt at = shade::layers_at(s, direction(mu, 0.3f));
          return is_coat ? at.coat.over.x : at.sheen.over.x;
        };
        for (const float mu : kCosines) {
          const vec3 wo = direction(mu, 0.3f);
          const shade::Surface s = shade::surface_prepare(p, wo);
          const vec2 mean = shade::table_ggx_mean(row);
          const float escape_mean = 1.0f - mean.x - mean.y;
          const auto escape = [&](float c) { return 1.0f - table_albedo(c, r); };
          const double single = ggx_albedo(wo, alpha, alpha, [&](float, vec3 wi) { return factor(s, wi.z); });
          const double multiple = over_hemisphere(wo, [&](vec3 wi) {
            return escape(mu) * escape(wi.z) / (shade::kShadePi * escape_mean) * wi.z * factor(s, wi.z);
          });
          const double back = static_cast<double>(factor(s, mu)) * (single + multiple);
          const double transmission = 1.0 - static_cast<double>(is_coat ? s.coat_albedo_o : s.sheen_albedo_o);
          EXPECT_NEAR(back, transmission, 8e-3) << mu << ' ' << r << ' ' << layer << (is_coat ? " coat" : " sheen");
          undivided = std::max(undivided, std::abs(transmission * transmission - back));  // T on both ways
        }
      }
    }
  }
  EXPECT_GT(undivided, 0.1);
}

TEST(law_tables, anisotropic_ggx_equals_quadrature) {
  double round = 0.0;
  double round_rise = 0.0;
  for (const float mu : kCosines) {
    for (const float phi : {0.1f, 0.7f, 1.4f}) {
      const float rx = 0.9f;
      const float ry = 0.3f;
      const vec3 wo = direction(mu, phi);
      const double albedo = ggx_albedo(wo, rx * rx, ry * ry, [](float, vec3) { return 1.0f; });
      const float cos2 = std::cos(phi) * std::cos(phi);
      const float along = std::pow(cos2 * std::pow(rx, 4.0f) + (1.0f - cos2) * std::pow(ry, 4.0f), 0.25f);
      const double rise = ggx_albedo(wo, rx * rx, ry * ry, [](float c, vec3) { return shade::schlick_weight(c); });
      const shade::vec2 entry = shade::table_anisotropic(mu, along, rx, ry);
      EXPECT_NEAR(1.0 - static_cast<double>(entry.x), albedo, 0.006) << mu << ' ' << phi;
      EXPECT_NEAR(static_cast<double>(entry.y), rise, 0.006) << mu << ' ' << phi;
      round_rise = std::max(
          round_rise, std::abs(static_cast<double>(shade::table_ggx(mu, shade::table_ggx_roughness(along)).y) - rise));
      round = std::max(round, std::abs(static_cast<double>(table_albedo(mu, std::sqrt(rx * ry))) - albedo));
    }
  }
  EXPECT_GT(round, 0.03);       // a round lobe of the same area is none
  EXPECT_GT(round_rise, 0.02);  // nor one as rough along the azimuth
}

}  // namespace
}  // namespace candela::laws
