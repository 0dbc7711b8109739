#include "scene/metals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <set>
#include <string>

#include "shade/fresnel.glsl.h"

namespace candela {
namespace {

using Find = std::function<const Metal*(std::string_view)>;

struct Colour {
  std::string_view name;
  vec3 f0;  ///< linear Rec.709, D65, CIE 1931
};

// Of the spectra integrated at 1 nm; gold's red is 1.022 before it is held.
const std::array<Colour, 5> kColours = {{{"silver", {.9715f, .9599f, .9153f}},
                                         {"aluminium", {.9132f, .9215f, .9244f}},
                                         {"gold", {.999f, .7825f, .3434f}},
                                         {"copper", {.9553f, .6376f, .5382f}},
                                         {"brass", {.9097f, .7783f, .4228f}}}};

double error(vec3 a, vec3 b) { return static_cast<double>(max_component(glm::abs(a - b))); }

double worst_colour(const Find& find) {
  double worst = 0.0;
  for (const Colour& row : kColours) {
    const Metal* metal = find(row.name);
    if (!metal) return 1.0;
    worst = std::max(worst, error(shade::fresnel_conductor3(1.0f, metal->n, metal->k), row.f0));
  }
  return worst;
}

TEST(metals, colour_at_the_normal_is_the_published_one) {
  EXPECT_LT(worst_colour(find_metal), 2e-4);
  Metal wrong;
  EXPECT_GT(worst_colour([&](std::string_view name) {
              wrong = *find_metal(name);
              wrong.n = wrong.n_measured, wrong.k = wrong.k_measured;
              return &wrong;
            }),
            0.03)
      << "three wavelengths in place of three channels";
}

double worst_measurement(const std::function<vec3(const Metal&)>& reflectance) {
  // At 650, 550 and 450 nm.
  const std::array<Colour, 2> rows = {{{"gold", {.9401f, .8475f, .3857f}}, {"copper", {.9411f, .6341f, .5525f}}}};
  double worst = 0.0;
  for (const Colour& row : rows) worst = std::max(worst, error(reflectance(*find_metal(row.name)), row.f0));
  return worst;
}

TEST(metals, measured_index_reflects_what_was_measured) {
  EXPECT_LT(
      worst_measurement([](const Metal& m) { return shade::fresnel_conductor3(1.0f, m.n_measured, m.k_measured); }),
      2e-4);
  EXPECT_GT(worst_measurement(
                [](const Metal& m) { return shade::fresnel_conductor3(1.0f, m.n_measured, 1.01f * m.k_measured); }),
            2e-4);
  struct At550 {
    std::string_view name;
    float n, k;
  };
  for (const At550& row : {At550{"gold", .3504f, 2.7141f}, At550{"silver", .1248f, 3.3396f},
                           At550{"aluminium", .9586f, 6.6870f}, At550{"copper", .9582f, 2.5771f}}) {
    EXPECT_NEAR(find_metal(row.name)->n_measured.y, row.n, 1e-4f) << row.name;
    EXPECT_NEAR(find_metal(row.name)->k_measured.y, row.k, 1e-4f) << row.name;
  }
}

// A channel is an average over wavelengths, so that it cannot be far from the wavelength in its middle. Red gold is the
// one that is held in the gamut.
TEST(metals, channels_are_near_the_measurement) {
  const auto difference = [](const Metal& m, vec3 n, vec3 k) {
    vec3 d =
        glm::abs(shade::fresnel_conductor3(1.0f, n, k) - shade::fresnel_conductor3(1.0f, m.n_measured, m.k_measured));
    return max_component(d);
  };
  for (const Metal& m : metals()) {
    EXPECT_LT(difference(m, m.n, m.k), 0.07f) << m.name;
    EXPECT_GT(difference(m, m.k, 0.5f * m.n), 0.07f) << "n and k swapped: " << m.name;
    for (const float cosine : {0.0f, 1.0f / 7.0f, 0.5f, 1.0f}) {
      const vec3 f = shade::fresnel_conductor3(cosine, m.n, m.k);
      for (int c = 0; c < 3; ++c) EXPECT_TRUE(f[c] > 0.3f && f[c] <= 1.00001f) << m.name << ' ' << cosine;
    }
  }
}

TEST(metals, are_found_by_name_symbol_and_either_spelling) {
  std::set<std::string> names;
  for (const Metal& m : metals()) {
    EXPECT_EQ(find_metal(m.name), &m);
    EXPECT_TRUE(names.insert(std::string(m.name)).second) << m.name;
    EXPECT_FALSE(m.source.empty());
  }
  EXPECT_TRUE(std::is_sorted(metals().begin(), metals().end(), [](auto& a, auto& b) { return a.name < b.name; }));
  EXPECT_EQ(find_metal("Au"), find_metal("gold"));
  EXPECT_EQ(find_metal("aluminum"), find_metal("aluminium"));
  EXPECT_EQ(find_metal("unobtainium"), nullptr);
  EXPECT_EQ(find_metal(""), nullptr);
  for (const std::string_view symbol : {"Ag", "Al", "Co", "Cr", "Cu", "CuZn", "Fe", "Ni", "Pd", "Pt", "Ti", "W"}) {
    EXPECT_NE(find_metal(symbol), nullptr) << symbol;
  }
}

}  // namespace
}  // namespace candela
