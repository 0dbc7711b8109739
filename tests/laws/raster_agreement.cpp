#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "io/gltf.h"
#include "laws/raster_draw.h"
#include "path/capture.h"
#include "raster/packing.h"
#include "raster/render.h"
#include "scene/framing.h"
#include "scene/material_table.h"
#include "unit/gl/gl_fixture.h"
#include "unit/path/scenes.h"

// Both renderers read one material source, so that where both compute the same thing they must show the same thing.

namespace candela {
namespace {

using namespace test;
namespace fs = std::filesystem;

class law_raster : public NeedsGl {};  // NOLINT(readability-identifier-naming): a suite is named as its laws

constexpr int kSize = 96;

raster::Settings drawn(int size) {
  raster::Settings s;
  s.width = s.height = size;
  s.msaa = 1;
  s.specular_antialiasing = false;  // the path tracer's samples are in the middle of pixels
  return s;
}

Film draw(const Scene& scene, const Environment& environment, const View& view, const raster::Settings& settings,
          const shade::ShadingModel& shading = shade::shading_model_candela()) {
  Diagnostics diagnostics;
  Film film = test::draw(scene, environment, view, settings, diagnostics, shading);
  EXPECT_TRUE(diagnostics.warnings().empty());
  return film;
}

/// How far two pictures are apart where the picture changes little from pixel to pixel: relative, with `floor` added to
/// what it is relative to.
struct Agreement {
  double worst = 0.0;
  int compared = 0;
  ivec2 at{0};
};

Agreement compare(const Image& expected, const Image& found, double floor, double smoothness = 0.15) {
  Agreement a;
  for (int y = 1; y + 1 < expected.height; ++y) {
    for (int x = 1; x + 1 < expected.width; ++x) {
      const vec3 e = expected.rgb(x, y);
      double step = 0.0;
      for (int k = 0; k < 9; ++k) {
        const vec3 d = glm::abs(expected.rgb(x + k % 3 - 1, y + k / 3 - 1) - e);
        step = std::max(step, static_cast<double>(max_component(d)));
      }
      if (step > smoothness * (static_cast<double>(max_component(e)) + floor)) continue;
      ++a.compared;
      const vec3 d = glm::abs(found.rgb(x, y) - e);
      for (int c = 0; c < 3; ++c) {
        const double relative = static_cast<double>(d[c]) / (static_cast<double>(e[c]) + floor);
        if (relative > a.worst) a.worst = relative, a.at = {x, y};
      }
    }
  }
  return a;
}

View sphere_view() { return look_at({1.7f, 1.3f, 2.6f}, vec3(0.0f), 0.9f); }

struct NamedMaterial {
  const char* name;
  Material material;
};

std::vector<NamedMaterial> materials() {
  std::vector<NamedMaterial> all = {{"matte", matte({0.6f, 0.4f, 0.2f})},
                                    {"metal", metal({0.9f, 0.6f, 0.3f}, 0.4f)},
                                    {"smooth metal", metal({0.9f, 0.6f, 0.3f}, 0.15f)},
                                    {"plastic", plastic({0.1f, 0.3f, 0.7f}, 0.3f)}};
  const auto add = [&](const char* name, auto change) {
    Material m = plastic({0.3f, 0.2f, 0.5f}, 0.5f);
    change(m);
    all.push_back({name, m});
  };
  add("half metal", [](Material& m) { m.metallic = 0.5f; });
  add("specular tint", [](Material& m) { m.specular = 0.5f, m.specular_color = {1.0f, 0.5f, 0.1f}; });
  add("coat", [](Material& m) { m.clearcoat = 0.8f, m.clearcoat_roughness = 0.2f; });
  add("sheen", [](Material& m) { m.sheen_color = {0.6f, 0.5f, 0.3f}, m.sheen_roughness = 0.4f; });
  add("coat on sheen", [](Material& m) {
    m.clearcoat = 0.8f, m.sheen_color = {0.6f, 0.5f, 0.3f}, m.sheen_roughness = 0.4f;
  });
  add("tinted coat", [](Material& m) {
    m.clearcoat = 0.8f, m.clearcoat_roughness = 0.2f, m.clearcoat_ior = 1.8f, m.clearcoat_color = {0.8f, 0.4f, 0.3f};
  });
  add("coat that darkens", [](Material& m) { m.clearcoat = 0.8f, m.clearcoat_darkening = 1.0f; });
  add("rough diffuse layer", [](Material& m) { m.diffuse_roughness = 0.8f; });
  add("streaked coat",
      [](Material& m) { m.clearcoat = 0.8f, m.clearcoat_roughness = 0.3f, m.clearcoat_anisotropy = 0.8f; });
  add("dusty coat", [](Material& m) {
    m.clearcoat = 0.8f, m.fuzz = 0.6f, m.fuzz_color = {0.5f, 0.4f, 0.3f}, m.fuzz_roughness = 0.8f;
  });
  add("edge color", [](Material& m) {
    m.specular_edge_color = 1.0f, m.metallic = 0.5f, m.specular_color = {1.0f, 0.4f, 0.2f};
  });
  add("sent back", [](Material& m) { m.retroreflection = 0.7f, m.metallic = 0.5f; });
  add("film", [](Material& m) { m.iridescence = 1.0f, m.iridescence_thickness_max_nm = 420.0f; });
  add("film on metal", [](Material& m) { m.iridescence = 1.0f, m.metallic = 1.0f; });
  add("conductor", [](Material& m) {
    m.metallic = 1.0f, m.conductor_n = {0.14f, 0.37f, 1.44f}, m.conductor_k = {3.98f, 2.39f, 1.6f};
  });
  add("rough glass sheet", [](Material& m) { m.transmission = 0.7f; });
  add("diffuse transmission", [](Material& m) {
    m.diffuse_transmission = 0.5f, m.diffuse_transmission_color = {0.2f, 0.8f, 0.4f};
  });
  add("specular-glossiness", [](Material& m) {
    m.specular_glossiness = true, m.metallic = 0.0f, m.ior = 0.0f, m.specular_color = {0.3f, 0.2f, 0.1f};
  });
  return all;
}

/// One light at a time: the path tracer then has nothing to choose.
Film trace_direct(const Scene& scene, const View& view, int size) {
  return shoot(scene, dark_environment(), view, centred(size, 1, 1));
}

TEST_F(law_raster, direct_light_of_every_lobe_is_that_of_the_path_tracer) {
  const std::vector<std::pair<Light, mat4>> lights = {
      {sunlight(vec3(1.0f, 0.9f, 0.7f), 3.0f), aimed({3, 4, 2}, vec3(0.0f))},
      {point_light(vec3(0.8f, 0.9f, 1.0f), 40.0f), translation({1.5f, 2.0f, 2.5f})},
      {spot_light(vec3(1.0f), 60.0f, 0.2f, 0.6f), aimed({2.5f, 1.5f, 2.5f}, {0.2f, 0.2f, 0.0f})}};
  for (const NamedMaterial& m : materials()) {
    for (std::size_t i = 0; i < lights.size(); ++i) {
      SceneBuilder b;
      b.add(sphere(vec3(0.0f), 1.0f, 5, false), m.material);
      b.add_light(lights[i].first, lights[i].second);
      const Scene scene = b.build();
      const Film expected = trace_direct(scene, sphere_view(), kSize);
      const Film found = draw(scene, dark_environment(), sphere_view(), drawn(kSize));
      const Agreement a = compare(expected.beauty, found.beauty, 0.02);
      EXPECT_GT(a.compared, kSize * kSize / 3) << m.name << " " << i;
      EXPECT_LT(a.worst, 5e-3) << m.name << ", light " << i << ", pixel " << a.at.x << "," << a.at.y << ": "
                               << expected.beauty.rgb(a.at.x, a.at.y).x << " drawn as "
                               << found.beauty.rgb(a.at.x, a.at.y).x;
    }
  }
}

/// Every preset, and the default with each of its terms another.
std::vector<std::pair<std::string, shade::ShadingModel>> other_models() {
  std::vector<std::pair<std::string, shade::ShadingModel>> all = {{"gltf", shade::shading_model_gltf()},
                                                                  {"ue4", shade::shading_model_ue4()},
                                                                  {"learnopengl", shade::shading_model_learnopengl()},
                                                                  {"thesis", shade::shading_model_thesis()},
                                                                  {"blinn-phong", shade::shading_model_blinn_phong()}};
  const auto add = [&](const char* name, auto change) {
    shade::ShadingModel m = shade::shading_model_candela();
    change(m);
    all.emplace_back(name, m);
  };
  add("d=beckmann", [](auto& m) { m.distribution = shade::kDistributionBeckmann; });
  add("d=charlie", [](auto& m) { m.distribution = shade::kDistributionCharlie; });
  add("g=smith-separable", [](auto& m) { m.masking = shade::kMaskingSmithSeparable; });
  add("g=schlick-ibl", [](auto& m) { m.masking = shade::kMaskingSchlickIbl; });
  add("f=schlick", [](auto& m) { m.fresnel = shade::kFresnelSchlick; });
  add("f=f82", [](auto& m) { m.fresnel = shade::kFresnelF82; });
  add("diffuse=burley", [](auto& m) { m.diffuse = shade::kDiffuseBurley; });
  add("diffuse=eon", [](auto& m) { m.diffuse = shade::kDiffuseEon; });
  add("blend=view", [](auto& m) { m.blend = shade::kBlendView; });
  add("multiscatter=off", [](auto& m) { m.multiscatter = false; });
  return all;
}

/// Something of everything that a term may change.
Material much_at_once() {
  Material m = plastic({0.3f, 0.5f, 0.7f}, 0.6f);
  m.metallic = 0.4f;
  m.specular_color = {0.6f, 0.8f, 1.0f};
  return m;
}

Scene ball(const Material& material, const Light* light = nullptr) {
  SceneBuilder b;
  b.add(sphere(vec3(0.0f), 1.0f, 5, false), material);
  if (light != nullptr) b.add_light(*light, aimed({3, 4, 2}, vec3(0.0f)));
  return b.build();
}

TEST_F(law_raster, other_shading_models_are_those_of_the_path_tracer) {
  const Light sun = sunlight(vec3(1.0f), 3.0f);
  const Scene scene = ball(much_at_once(), &sun);
  const Film plain = draw(scene, dark_environment(), sphere_view(), drawn(kSize));
  for (const auto& [name, model] : other_models()) {
    path::Settings traced = centred(kSize, 1, 1);
    raster::Settings settings = drawn(kSize);
    const Film expected = shoot(scene, dark_environment(), sphere_view(), traced, model);
    const Film found = draw(scene, dark_environment(), sphere_view(), settings, model);
    EXPECT_LT(compare(expected.beauty, found.beauty, 0.02).worst, 5e-3) << name;
    // The twin: the default model is seen to be another.
    EXPECT_GT(compare(expected.beauty, plain.beauty, 0.02).worst, name.find('=') == std::string::npos ? 5e-3 : 5e-4)
        << name;
  }
}

/// Σ |a - b| over Σ a.
double mean_difference(const Image& expected, const Image& found) {
  double sum = 0.0, weight = 0.0;
  for (std::size_t i = 0; i < expected.pixels.size(); ++i) {
    if (i % 4 == 3) continue;
    sum += std::abs(static_cast<double>(expected.pixels[i] - found.pixels[i]));
    weight += static_cast<double>(expected.pixels[i]);
  }
  return sum / weight;
}

double mean_difference(const Film& expected, const Film& found) {
  return mean_difference(expected.beauty, found.beauty);
}

/// Sum over the picture, or the middle of it, where the ball is seen from the front.
double sum_of(const Film& film, bool is_middle) {
  const int size = film.beauty.width, from = is_middle ? 3 * size / 8 : 0;
  double sum = 0.0;
  for (int y = from; y < size - from; ++y) {
    for (int x = from; x < size - from; ++x) {
      const vec3 c = film.beauty.rgb(x, y);
      sum += static_cast<double>(c.x + c.y + c.z);
    }
  }
  return sum;
}

double difference_of_means(const Film& a, const Film& b) {
  double worst = 0.0;
  for (const bool is_middle : {false, true}) {
    worst = std::max(worst, std::abs(sum_of(b, is_middle) / sum_of(a, is_middle) - 1.0));
  }
  return worst;
}

// Light that is the same from everywhere leaves nothing to the shape of a lobe, only how much it is.
TEST_F(law_raster, other_shading_models_reflect_as_much_of_light_from_far_away) {
  Material layered = much_at_once();
  layered.clearcoat = 0.6f, layered.clearcoat_roughness = 0.3f;
  layered.sheen_color = {0.5f, 0.4f, 0.3f}, layered.sheen_roughness = 0.5f;
  const Environment furnace = constant_environment(vec3(1.0f));
  constexpr int kPixels = 48;
  for (const bool is_layered : {false, true}) {
    const Scene scene = ball(is_layered ? layered : much_at_once());
    raster::Settings settings = drawn(kPixels);
    settings.specular_antialiasing = false;  // a wider lobe of a model that loses energy loses more
    const Film plain = draw(scene, furnace, sphere_view(), settings);
    for (const auto& [name, model] : other_models()) {
      // A shader takes seconds to compile.
      if (name != "gltf" && (is_layered || (name != "ue4" && name != "thesis"))) continue;
      path::Settings traced = test::settings(kPixels, 64, 1);
      const Film expected = shoot(scene, furnace, sphere_view(), traced, model);
      const Film found = draw(scene, furnace, sphere_view(), settings, model);
      EXPECT_LT(difference_of_means(expected, found), 0.015) << name << (is_layered ? ", layered" : "");
      // The twin: what the default model reflects is told apart.
      EXPECT_GT(difference_of_means(expected, plain), 0.015) << name;
    }
  }
}

TEST_F(law_raster, no_two_presets_draw_the_same_picture) {
  const Scene scene = ball(much_at_once());
  const Environment sky =
      mapped_environment(64, 32, [](vec3 d) { return vec3(1.0f + 0.5f * d.y, 1.0f, 1.0f + 0.4f * d.x); });
  std::vector<std::pair<std::string, Film>> pictures;
  pictures.emplace_back("candela", draw(scene, sky, sphere_view(), drawn(48)));
  for (const auto& [name, model] : other_models()) {
    if (name.find('=') != std::string::npos) continue;
    pictures.emplace_back(name, draw(scene, sky, sphere_view(), drawn(48), model));
    for (std::size_t i = 0; i + 1 < pictures.size(); ++i) {
      EXPECT_GT(mean_difference(pictures[i].second, pictures.back().second), 1e-3) << pictures[i].first << ' ' << name;
    }
  }
}

TEST_F(law_raster, agreement_sees_a_light_that_is_one_percent_brighter) {
  SceneBuilder b, brighter;
  for (SceneBuilder* s : {&b, &brighter}) {
    s->add(sphere(vec3(0.0f), 1.0f, 5, false), plastic({0.1f, 0.3f, 0.7f}, 0.3f));
    s->add_light(sunlight(vec3(1.0f), s == &b ? 3.0f : 3.03f), aimed({3, 4, 2}, vec3(0.0f)));
  }
  const Film expected = trace_direct(b.build(), sphere_view(), kSize);
  const Film found = draw(brighter.build(), dark_environment(), sphere_view(), drawn(kSize));
  EXPECT_GT(compare(expected.beauty, found.beauty, 0.02).worst, 5e-3);
}

TEST_F(law_raster, shadows_fall_where_the_path_tracer_has_them) {
  const std::vector<std::pair<Light, mat4>> lights = {
      {sunlight(vec3(1.0f), 3.0f), aimed({2, 4, 1}, vec3(0.0f))},
      {point_light(vec3(1.0f), 40.0f), translation({1.5f, 3.0f, 1.0f})},
      {spot_light(vec3(1.0f), 60.0f, 0.4f, 0.6f), aimed({1.5f, 3.5f, 1.0f}, vec3(0.0f))}};
  for (std::size_t i = 0; i < lights.size(); ++i) {
    SceneBuilder b;
    b.add(plane(vec3(0.0f), 3.0f), matte(vec3(0.8f)));
    b.add(box({-0.4f, 0.5f, -0.4f}, {0.4f, 1.0f, 0.4f}), matte(vec3(0.5f)));
    b.add_light(lights[i].first, lights[i].second);
    const Scene scene = b.build();
    const View view = look_at({2.5f, 3.5f, 4.0f}, vec3(0.0f), 0.8f);
    const Film expected = trace_direct(scene, view, kSize);
    const Film found = draw(scene, dark_environment(), view, drawn(kSize));
    // Shadow borders are soft by three texels of the map and jagged by one pixel of the picture: few pixels differ.
    int differing = 0, dark = 0;
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const float e = expected.beauty.rgb(x, y).x, f = found.beauty.rgb(x, y).x;
        dark += e <= 0.0f ? 1 : 0;
        differing += std::abs(e - f) > 0.01f * std::max(e, 0.1f) ? 1 : 0;
      }
    }
    EXPECT_GT(dark, kSize * kSize / 50) << "light " << i;
    EXPECT_LT(differing, kSize * kSize / 40) << "light " << i;
  }
}

TEST_F(law_raster, profiles_of_lamps_are_turned_as_in_the_path_tracer) {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 3.0f), matte(vec3(0.8f)));
  IesProfile profile;
  profile.vertical_deg = {0, 30, 60, 90};
  profile.horizontal_deg = {0, 90, 180, 270, 360};
  profile.candela = {10, 40, 20, 0, 10, 20, 35, 5, 10, 5, 10, 20, 10, 12, 3, 1, 10, 40, 20, 0};
  b.scene().ies_profiles.push_back(profile);
  Light lamp = point_light(vec3(1.0f), 1.0f);
  lamp.ies = 0;
  b.add_light(lamp, translation({0.2f, 1.5f, -0.1f}) * rotation({0, 1, 0}, 0.4f) * rotation({1, 0, 0}, -1.3f));
  const View view = look_at({0.0f, 5.0f, 0.01f}, vec3(0.0f), 0.9f);
  const Film expected = trace_direct(b.build(), view, kSize);
  const Agreement a = compare(expected.beauty, draw(b.build(), dark_environment(), view, drawn(kSize)).beauty, 0.05);
  EXPECT_GT(a.compared, kSize * kSize / 2);
  EXPECT_LT(a.worst, 0.02) << a.at.x << "," << a.at.y;  // the profile is a table of halves
}

TEST_F(law_raster, white_surfaces_are_invisible_in_the_furnace) {
  const auto departure = [](const Material& material) {
    SceneBuilder b;
    b.add(sphere(vec3(0.0f), 1.0f, 4, false), material);
    const Film film = draw(b.build(), constant_environment(vec3(1.0f)), sphere_view(), drawn(64));
    double worst = 0.0;
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        const vec3 c = film.beauty.rgb(x, y);
        for (int i = 0; i < 3; ++i) worst = std::max(worst, std::abs(static_cast<double>(c[i]) - 1.0));
      }
    }
    return worst;
  };
  for (const float roughness : {0.0f, 0.1f, 0.3f, 0.5f, 0.8f, 1.0f}) {
    EXPECT_LT(departure(metal(vec3(1.0f), roughness)), 5e-3) << "metal " << roughness;
    EXPECT_LT(departure(plastic(vec3(1.0f), roughness)), 5e-3) << "plastic " << roughness;
    Material coated = plastic(vec3(1.0f), 0.5f);
    coated.clearcoat = 1.0f, coated.clearcoat_roughness = roughness;
    EXPECT_LT(departure(coated), 1e-2) << "coat " << roughness;
    Material sheet = plastic(vec3(1.0f), roughness);
    sheet.transmission = 1.0f;
    EXPECT_LT(departure(sheet), 1e-2) << "sheet " << roughness;
    Material cloth = matte(vec3(1.0f));
    cloth.sheen_color = vec3(1.0f), cloth.sheen_roughness = std::max(roughness, 0.1f);
    EXPECT_LT(departure(cloth), 1e-2) << "sheen " << roughness;
  }
  // The twin: one percent of absorption is seen.
  EXPECT_GT(departure(metal(vec3(0.99f), 0.3f)), 5e-3);
}

TEST_F(law_raster, light_from_far_away_falls_on_matter_as_in_the_path_tracer) {
  // A convex body sees no other light than this; smooth enough that both converge, strong enough to be seen turned.
  const Environment sky = mapped_environment(128, 64, [](vec3 d) {
    return vec3(0.3f + 0.25f * d.x, 0.4f + 0.3f * d.y, 0.5f - 0.3f * d.z) +
           vec3(2.0f) * std::pow(std::max(d.x, 0.0f), 8.0f);
  });
  Environment turned = sky;
  turned.rotation = 0.7f;
  // The lobe is prefiltered as if seen along the normal: a stated approximation, worst at grazing angles.
  const auto difference = [&](const Material& traced, const Material& drawn_as) {
    const Film expected = shoot(ball(traced), turned, sphere_view(), settings(48, 1024, 1));
    return mean_difference(expected, draw(ball(drawn_as), turned, sphere_view(), drawn(48)));
  };
  for (const float roughness : {0.0f, 0.25f, 0.5f, 1.0f}) {
    for (const Material& m : {metal(vec3(0.9f, 0.6f, 0.3f), roughness), plastic(vec3(0.2f, 0.4f, 0.6f), roughness)}) {
      EXPECT_LT(difference(m, m), 0.02) << "roughness " << roughness << " metallic " << m.metallic;
    }
  }
  // Wide one way and narrow the other.
  for (const bool is_coat : {false, true}) {
    Material m = is_coat ? matte(vec3(0.02f)) : metal(vec3(0.9f, 0.6f, 0.3f), 0.35f);
    if (is_coat) m.clearcoat = 1.0f, m.clearcoat_roughness = 0.35f;
    float& strength = is_coat ? m.clearcoat_anisotropy : m.anisotropy;
    const Material round = m;
    strength = 0.8f;
    EXPECT_LT(difference(m, m), is_coat ? 0.02 : 0.065) << is_coat;
    EXPECT_GT(difference(m, round), is_coat ? 0.024 : 0.07) << "the twin, whose lobe is round, " << is_coat;
  }
}

TEST_F(law_raster, camera_and_background_are_those_of_the_path_tracer) {
  const Environment sky = mapped_environment(256, 128, [](vec3 d) { return vec3(0.5f) + 0.4f * d; });
  SceneBuilder b;
  b.add(box(vec3(-0.5f), vec3(0.5f)), unlit({0.9f, 0.1f, 0.1f}));
  Environment turned = sky;
  turned.rotation = -1.1f;
  View orthographic = sphere_view();
  orthographic.projection = OrthographicCamera{.xmag = 1.2f, .ymag = 1.2f};
  for (const View& view : {sphere_view(), orthographic}) {
    const Film expected = shoot(b.build(), turned, view, centred(kSize, 1, 1));
    const Film found = draw(b.build(), turned, view, drawn(kSize));
    EXPECT_LT(compare(expected.beauty, found.beauty, 0.02, 0.05).worst, 4e-3);
  }
}

/// A box in front of a ball in front of a wall, all unlit: the near plane cuts the box, the far plane the wall or ball.
Scene cut_scene() {
  SceneBuilder b;
  b.add(box({-0.7f, -0.7f, 1.0f}, {0.2f, 0.2f, 1.6f}), unlit({0.9f, 0.1f, 0.1f}));
  b.add(sphere(vec3(0.1f), 0.8f, 4, false), unlit({0.1f, 0.9f, 0.1f}));
  b.add(quad({-3, -3, -2}, {6, 0, 0}, {0, 6, 1}), unlit({0.1f, 0.1f, 0.9f}));
  return b.build();
}

TEST_F(law_raster, planes_of_a_camera_cut_what_it_sees_as_in_the_path_tracer) {
  const Scene scene = cut_scene();
  path::Settings traced = centred(kSize, 1, 1);
  raster::Settings settings = drawn(kSize);
  traced.layers = settings.layers = {Layer::depth, Layer::position, Layer::object_id};
  View perspective = look_at({0, 0, 4}, vec3(0.0f), 0.9f), orthographic = perspective;
  orthographic.projection = OrthographicCamera{.xmag = 1.8f, .ymag = 1.8f};
  std::vector<Image> beauties;
  for (View view : {perspective, orthographic}) {
    for (const vec2 planes : {vec2(0, kInfinity), vec2(2.7f, kInfinity), vec2(0, 5.5f), vec2(2.7f, 5.5f),
                              vec2(3.6f, 3.9f), vec2(0.001f, 2.0f), vec2(9, 10)}) {
      view.near_plane = planes.x, view.far_plane = planes.y;
      const Film expected = shoot(scene, constant_environment(vec3(0.5f)), view, traced);
      const Film found = draw(scene, constant_environment(vec3(0.5f)), view, settings);
      EXPECT_LT(compare(expected.beauty, found.beauty, 0.02, 0.05).worst, 4e-3) << planes.x << ' ' << planes.y;
      for (const Layer layer : settings.layers) {
        const Image &e = expected.layers.at(layer), &f = found.layers.at(layer);
        int differing = 0;
        for (std::size_t i = 0; i < e.pixels.size(); ++i) {
          differing += e.pixels[i] == f.pixels[i] || std::abs(e.pixels[i] - f.pixels[i]) < 2e-3f ? 0 : 1;
        }
        EXPECT_LT(differing, static_cast<int>(e.pixels.size()) / 200) << layer_name(layer) << ' ' << planes.x;
        if (layer != Layer::depth || planes.x == 0.0f) continue;  // along the axis, as the planes are
        EXPECT_GE(*std::min_element(e.pixels.begin(), e.pixels.end()), planes.x);
      }
      for (const Image& other : beauties) EXPECT_GT(largest_difference(other, expected.beauty), 0.1);
      // Where nothing is between the planes both kinds of camera see the same nothing.
      if (planes.y > 2.0f && planes.x < 9.0f) beauties.push_back(expected.beauty);
    }
  }
}

// Matter counts from the near plane on, in both engines: that which lies before it is cut away.
TEST_F(law_raster, an_eye_whose_near_plane_is_in_a_body_begins_there) {
  Material glass = plastic(vec3(1.0f), 0.0f);
  glass.transmission = 1.0f, glass.thickness = 4.0f, glass.ior = 1.0f;
  glass.attenuation_color = {0.2f, 0.5f, 0.8f}, glass.attenuation_distance = 1.0f;
  SceneBuilder b;
  b.add(box(vec3(-2.0f), vec3(2.0f)), glass);
  const Scene scene = b.build();
  const Environment white = constant_environment(vec3(1.0f));
  View perspective = look_at({0, 0, 5}, vec3(0.0f), 0.1f), orthographic = perspective;
  orthographic.projection = OrthographicCamera{.xmag = 0.3f, .ymag = 0.3f};
  View inside = look_at({0, 0, 1}, vec3(0.0f), 0.1f), inside_orthographic = inside;
  inside_orthographic.projection = orthographic.projection;
  struct Case {
    const char* name;
    View view;
    float near_plane, way;  // of what is left of the body
  };
  for (Case c : {Case{"outside, nothing cut", perspective, 2.5f, 4.0f},
                 {"on the front face", perspective, 3.0f, 4.0f},
                 {"just within", perspective, 3.01f, 3.99f},
                 {"a metre within", perspective, 4.0f, 3.0f},
                 {"nearly through", perspective, 6.9f, 0.1f},
                 {"beyond", perspective, 7.5f, 0.0f},
                 {"orthographic, outside", orthographic, 2.5f, 4.0f},
                 {"orthographic, on the front face", orthographic, 3.0f, 4.0f},
                 {"orthographic, a metre within", orthographic, 4.0f, 3.0f},
                 {"orthographic, beyond", orthographic, 7.5f, 0.0f},
                 {"eye inside", inside, 0.0f, 3.0f},
                 {"eye inside, cut", inside, 1.0f, 2.0f},
                 {"eye inside, orthographic", inside_orthographic, 0.0f, 3.0f},
                 {"eye inside, orthographic, cut", inside_orthographic, 1.0f, 2.0f}}) {
    c.view.near_plane = c.near_plane;
    const vec3 traced = shoot(scene, white, c.view, centred(8, 1, 8)).beauty.rgb(4, 4);
    const vec3 found = draw(scene, white, c.view, drawn(8)).beauty.rgb(4, 4);
    for (int i = 0; i < 3; ++i) {
      const float expected = std::pow(glass.attenuation_color[i], c.way);
      EXPECT_NEAR(traced[i], expected, 0.01f) << c.name << ", path";
      EXPECT_NEAR(found[i], expected, 0.01f) << c.name << ", raster";
    }
  }
}

TEST_F(law_raster, layers_are_those_of_the_path_tracer) {
  SceneBuilder b;
  b.add(sphere(vec3(0.0f), 1.0f, 4, false), plastic({0.2f, 0.4f, 0.6f}, 0.5f));
  b.add(box({0.8f, -0.5f, -0.5f}, {1.6f, 0.5f, 0.5f}), metal({0.9f, 0.6f, 0.3f}, 0.3f));
  path::Settings traced = centred(kSize, 1, 1);
  raster::Settings settings = drawn(kSize);
  for (const LayerInfo& info : kLayers) traced.layers.insert(info.layer);
  traced.layers.erase(Layer::motion);  // which takes another moment
  settings.layers = traced.layers;
  traced.has_masks = settings.has_masks = true;
  traced.mattes = settings.mattes = {MatteKind::object, MatteKind::material};
  Scene scene = b.build();
  scene.nodes[0].file_index = 41;
  const Film expected = shoot(scene, constant_environment(vec3(1.0f)), sphere_view(), traced);
  const Film found = draw(scene, constant_environment(vec3(1.0f)), sphere_view(), settings);
  EXPECT_EQ(found.layers.at(Layer::object_id).rgb(kSize / 2, kSize / 2).x, 42.0f) << "the number of the file's node";
  for (const Layer layer : settings.layers) {
    const Image &e = expected.layers.at(layer), &f = found.layers.at(layer);
    ASSERT_EQ(e.channels, f.channels) << layer_name(layer);
    int differing = 0;
    for (std::size_t i = 0; i < e.pixels.size(); ++i) {
      const bool is_same = e.pixels[i] == f.pixels[i] || std::abs(e.pixels[i] - f.pixels[i]) < 2e-3f;
      differing += is_same ? 0 : 1;
    }
    EXPECT_LT(differing, static_cast<int>(e.pixels.size()) / 200) << layer_name(layer);
  }
  ASSERT_EQ(found.masks->size(), expected.masks->size());
  for (std::size_t i = 0; i < found.masks->size(); ++i) {
    const InstanceMask &e = (*expected.masks)[i], &f = (*found.masks)[i];
    EXPECT_EQ(f.node, e.node);
    int differing = 0;
    for (int at = 0; at < kSize * kSize; ++at) {
      const ivec2 pixel(at % kSize, at / kSize);
      differing += e.covers(pixel) == f.covers(pixel) ? 0 : 1;
    }
    EXPECT_LT(differing, kSize * kSize / 200) << "node " << e.node;
  }
  for (const auto& [kind, mattes] : found.mattes) {
    double sum = 0.0, apart = 0.0;
    const Mattes& traced_mattes = expected.mattes.at(kind);
    for (std::size_t i = 0; i < static_cast<std::size_t>(kSize * kSize); ++i) {
      sum += static_cast<double>(mattes.at(i)[0].coverage);
      const bool is_same = mattes.at(i)[0].number == traced_mattes.at(i)[0].number;
      apart += is_same || mattes.at(i)[0].coverage < 0.9f ? 0.0 : 1.0;
    }
    EXPECT_GT(sum, 500.0);
    EXPECT_LT(apart, kSize * kSize / 100.0) << "one sample of the path tracer at the centre";
    EXPECT_EQ(mattes.names, traced_mattes.names);
  }
}

TEST_F(law_raster, faces_and_places_of_relief_shared_and_mirrored_meshes_are_those_of_the_path_tracer) {
  SceneBuilder b;
  const int mesh = b.add_mesh(box({-0.5f, -0.4f, -0.3f}, {0.5f, 0.4f, 0.3f}), b.add_material(matte(vec3(0.5f))));
  b.add_node(mesh, translation({-0.8f, 0.2f, 0}) * rotation({0, 1, 0}, 0.6f));
  b.add_node(mesh, translation({0.7f, 0, 0}) * scaling({-1, 1, 1}) * rotation({1, 0, 0}, 0.4f));
  // Points that no triangle uses move the middle of the bounds.
  Primitive holed = sphere({0, -0.9f, 0.2f}, 0.4f, 2, true);
  holed.positions.push_back(vec3(50.0f));
  holed.normals.push_back(vec3(0, 1, 0));
  holed.uvs[0].push_back(vec2(0.0f));
  b.add(holed, matte(vec3(0.5f)));
  path::Settings traced = centred(kSize, 1, 1);
  raster::Settings settings = drawn(kSize);
  traced.layers = settings.layers = {Layer::face, Layer::instance, Layer::position, Layer::uv};
  const Film expected = shoot(b.build(), constant_environment(vec3(1.0f)), sphere_view(), traced);
  const Film found = draw(b.build(), constant_environment(vec3(1.0f)), sphere_view(), settings);
  for (const Layer layer : settings.layers) {
    const Image &e = expected.layers.at(layer), &f = found.layers.at(layer);
    int differing = 0;
    for (std::size_t i = 0; i < e.pixels.size(); ++i) differing += std::abs(e.pixels[i] - f.pixels[i]) < 1e-3f ? 0 : 1;
    EXPECT_LT(differing, static_cast<int>(e.pixels.size()) / 100) << layer_name(layer);
    EXPECT_GT(*std::max_element(e.pixels.begin(), e.pixels.end()), 0.0f) << layer_name(layer);
  }
}

TEST_F(law_raster, several_frames_show_what_one_shows_at_the_same_place) {
  // Brightness along a card is a straight line, which no even jitter changes.
  SceneBuilder b;
  Primitive card = quad({-9, -9, 0}, {18, 0, 0}, {0, 18, 0});
  for (const vec3& p : card.positions) card.colors.emplace_back(vec3(0.5f) + 0.05f * vec3(p.x, p.y, -p.x), 1.0f);
  b.add(card, unlit(vec3(1.0f)));
  raster::Settings settings = drawn(kSize);
  const Film one = draw(b.build(), dark_environment(), sphere_view(), settings);
  for (const int frames : {2, 3, 4, 16}) {
    settings.frames = frames;
    const Film several = draw(b.build(), dark_environment(), sphere_view(), settings);
    EXPECT_LT(glm::length(mean_of(several.beauty) - mean_of(one.beauty)), 1e-3) << frames;
    EXPECT_LT(largest_difference(several.beauty, one.beauty), 2e-3) << frames;
  }
}

TEST_F(law_raster, an_environment_that_is_black_is_no_light) {
  SceneBuilder b;
  b.add(sphere(vec3(0.0f), 1.0f, 3, false), plastic(vec3(0.5f), 0.5f));
  Environment black = constant_environment(vec3(0.0f));
  black.map = std::make_shared<const Image>(8, 4, 3);
  const Film film = draw(b.build(), black, sphere_view(), drawn(16));
  EXPECT_EQ(mean_of(film.beauty), dvec3(0.0));
}

TEST_F(law_raster, colours_of_nodes_are_those_of_the_path_tracer) {
  // One mesh three times, of which a mask leaves two.
  SceneBuilder b;
  Material white = unlit(vec3(1.0f));
  white.alpha_mode = AlphaMode::mask;
  const int mesh = b.add_mesh(quad({-0.3f, -0.3f, 0}, {0.6f, 0, 0}, {0, 0.6f, 0}), b.add_material(white));
  const std::array colors = {vec4(1, 0.1f, 0.1f, 1), vec4(0.1f, 1, 0.1f, 0.8f), vec4(0.1f, 0.1f, 1, 0.2f)};
  for (int i = 0; i < 3; ++i) b.add_node(mesh, translation({0.7f * static_cast<float>(i - 1), 0, 0}));
  Scene scene = b.build();
  for (std::size_t i = 0; i < 3; ++i) scene.nodes[i].color = colors[i];
  const Film expected = shoot(scene, dark_environment(), sphere_view(), centred(kSize, 1, 1));
  const Film found = draw(scene, dark_environment(), sphere_view(), drawn(kSize));
  EXPECT_LT(compare(expected.beauty, found.beauty, 0.02, 0.05).worst, 4e-3);
  EXPECT_LT(glm::length(found.beauty.rgb(kSize / 2, kSize / 2) - vec3(colors[1])), 4e-3f);
  // The twin: all of them white.
  for (Node& node : scene.nodes) node.color = vec4(1.0f);
  EXPECT_GT(
      compare(expected.beauty, draw(scene, dark_environment(), sphere_view(), drawn(kSize)).beauty, 0.02, 0.05).worst,
      0.1);
}

TEST_F(law_raster, panels_and_bulbs_light_what_is_around_them) {
  const View view = look_at({2.5f, 2.2f, 3.0f}, {0.6f, 0.2f, 0}, 0.5f);  // which sees no lamp
  for (const bool is_panel : {true, false}) {
    for (const Material& m : {matte(vec3(0.8f)), plastic(vec3(0.3f, 0.2f, 0.5f), 0.4f), metal(vec3(0.9f), 0.5f)}) {
      const auto lit_from = [&](float further) {
        SceneBuilder b;
        b.add(plane(vec3(0.0f), 3.0f), m);
        b.add(sphere({0.0f, 0.6f, 0.0f}, 0.6f, 5, false), m);
        if (is_panel) {
          b.add(quad({-1.8f - further, 0.4f, -1.0f}, {0, 1.4f, 0}, {0, 0, 1.6f}), lamp(vec3(4.0f)));
        } else {
          b.add(sphere({-1.5f - further, 1.2f, 0.3f}, 0.3f, 4, false), lamp(vec3(8.0f)));
        }
        return b.build();
      };
      const Image expected = shoot(lit_from(0.0f), dark_environment(), view, settings(64, 256, 1)).beauty;
      raster::Settings many = drawn(64);
      many.frames = 32;
      const auto found = [&](float further) { return draw(lit_from(further), dark_environment(), view, many).beauty; };
      // The lobes are fitted, without the long tails of GGX, which are what a metal shows beside its highlights; and
      // the bulb is a square that turns.
      const bool is_metal = m.metallic > 0.0f;
      const double most = is_metal ? 0.3 : 0.1;
      const Image there = found(0.0f);
      EXPECT_LT(mean_difference(expected, there), most) << is_panel << " roughness " << m.roughness;
      EXPECT_NEAR(mean_luminance(there) / mean_luminance(expected), 1.0, is_metal ? 0.17 : 0.05) << is_panel;
      EXPECT_GT(mean_difference(expected, found(0.6f)), most) << "the twin: a lamp that stands further away";
    }
  }
}

TEST_F(law_raster, soft_shadows_are_as_wide_as_the_sun) {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 2.0f), matte(vec3(0.8f)));
  b.add(box({-0.5f, 0.8f, -0.5f}, {0.5f, 1.0f, 0.5f}), matte(vec3(0.5f)));
  const Scene scene = b.build();
  Environment environment = dark_environment();
  SunDisc sun;
  sun.direction = glm::normalize(vec3(0.3f, 1.0f, 0.2f));
  sun.angular_radius = 0.12f;
  sun.radiance = vec3(60.0f);
  environment.suns = {sun};
  const View view = look_at({0.5f, 4.0f, 2.5f}, vec3(0.0f), 0.9f);
  const Film expected = shoot(scene, environment, view, settings(64, 256, 1));
  raster::Settings soft = drawn(64);
  soft.has_soft_shadows = true;
  soft.frames = 64;  // each from another point of the sun
  const double softly = mean_difference(expected.beauty, draw(scene, environment, view, soft).beauty);
  raster::Settings hard = soft;
  hard.has_soft_shadows = false;
  const double hardly = mean_difference(expected.beauty, draw(scene, environment, view, hard).beauty);
  EXPECT_LT(softly, 0.008);
  EXPECT_GT(hardly, 1.6 * softly);
}

TEST_F(law_raster, light_spreads_in_bodies_and_none_is_lost) {
  Material wax = plastic(vec3(1.0f), 0.5f);
  wax.diffuse_transmission = 1.0f;
  wax.thickness = 2.0f;
  wax.multiscatter_color = vec3(0.8f);
  wax.attenuation_color = vec3(0.36787944f);
  const auto shown = [&](float mean_free_path) {
    Material m = wax;
    m.attenuation_distance = mean_free_path;
    SceneBuilder b;
    b.add(sphere(vec3(0.0f), 1.0f, 5, false), m);
    b.add_light(sunlight(vec3(1.0f), 3.0f), aimed({5, 1, 0}, vec3(0.0f)));
    return draw(b.build(), dark_environment(), look_at({0, 0, 3}, vec3(0.0f), 0.9f), drawn(kSize)).beauty;
  };
  const Image narrow = shown(1e-3f), wide = shown(0.05f);
  // Light crosses the terminator, and as much is there in all.
  const int dark = kSize / 2 - 6, middle = kSize / 2;
  EXPECT_LT(narrow.rgb(dark, middle).x, 1e-3f);
  EXPECT_GT(wide.rgb(dark, middle).x, 5e-3f);
  EXPECT_NEAR(mean_luminance(wide) / mean_luminance(narrow), 1.0, 0.06);
}

TEST_F(law_raster, an_edge_of_light_fades_in_a_body_by_its_profile) {
  // Sun from above, cut off at x = 0 by a wall that hardly scatters; the floor spreads it.
  Material wax = plastic(vec3(1.0f), 0.5f);
  wax.specular = 0.0f;
  wax.diffuse_transmission = 1.0f;
  wax.thickness = 2.0f;
  wax.multiscatter_color = vec3(0.8f);
  wax.attenuation_color = vec3(0.36787944f);
  wax.attenuation_distance = 0.1f;
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 3.0f), wax);
  b.add(box({-3.0f, 1.0f, -3.0f}, {0.0f, 1.1f, 3.0f}), matte(vec3(0.0f)));
  b.add_light(sunlight(vec3(1.0f), 3.0f), aimed({0.0f, 5.0f, 0.0f}, vec3(0.0f)));
  // From below the wall, along the floor's normal but for a little.
  const View view = look_at({0.0f, 0.95f, 0.0f}, {0.0f, 0.0f, 0.001f}, 1.2f);
  raster::Settings many = drawn(kSize);
  many.frames = 32;
  const Image found = draw(b.build(), dark_environment(), view, many).beauty;
  // The profile (exp(-r/d) + exp(-r/3d)) / (8 π d r) of Christensen & Burley 2015 over the lit half plane.
  constexpr double kMeanFreePath = 0.1, kAlbedo = 0.8;
  const double d = kMeanFreePath / (1.85 - kAlbedo + 7.0 * std::pow(std::abs(kAlbedo - 0.8), 3.0));
  const auto lit_share = [&](double x) {
    double sum = 0.0, all = 0.0;
    for (int i = 0; i < 4000; ++i) {
      const double r = 40.0 * d * (i + 0.5) / 4000.0;
      const double density = (std::exp(-r / d) + std::exp(-r / (3.0 * d))) / (4.0 * d);
      const double angle = x >= r ? 1.0 : x <= -r ? 0.0 : 1.0 - std::acos(x / r) / glm::pi<double>();
      sum += density * angle, all += density;
    }
    return sum / all;
  };
  const auto column = [&](double x) { return kSize / 2.0 * (1.0 + x / (0.95 * std::tan(0.6))); };
  const double whole = static_cast<double>(found.rgb(static_cast<int>(column(0.6)), kSize / 2).x);
  for (const double x : {-0.3, -0.2, -0.1, -0.05, 0.05, 0.1, 0.2}) {
    const int at = static_cast<int>(column(x));
    const double center = ((at + 0.5) / kSize * 2.0 - 1.0) * 0.95 * std::tan(0.6);
    double mean = 0.0;
    for (int y = -8; y < 8; ++y) mean += static_cast<double>(found.rgb(at, kSize / 2 + y).x) / 16.0;
    EXPECT_NEAR(mean / whole, lit_share(center) / lit_share(0.6), 0.015) << x;
  }
}

TEST_F(law_raster, relief_is_where_the_path_tracer_displaces_to) {
  // A checkered plane whose height map is black all over lies lower by the whole scale.
  SceneBuilder b;
  Material m = unlit(vec3(1.0f));
  std::vector<std::uint8_t> checks;
  for (int i = 0; i < 64; ++i)
    checks.insert(checks.end(), {255, static_cast<std::uint8_t>((i + i / 8) % 2 * 255), 40, 255});
  m.base_color_texture = slot(b.add_texture(8, 8, checks));
  m.height_texture = slot(b.add_texture(1, 1, {0, 0, 0, 255}));
  m.height_scale = 0.3f;
  // Further uv sets move as the first ones do; the height map may read one of them.
  Primitive sets = plane(vec3(0.0f), 3.0f);
  sets.uvs[2] = sets.uvs[5] = sets.uvs[0];
  for (vec2& uv : sets.uvs[0]) uv = vec2(0.5f);
  Material further = m;
  further.base_color_texture.uv_set = 5, further.height_texture.uv_set = 2;
  SceneBuilder other = b;
  other.add(sets, further);
  b.add(plane(vec3(0.0f), 3.0f), m);
  const Scene scene = b.build();
  const View view = look_at({0.3f, 1.2f, 1.6f}, {0.3f, 0, 0}, 0.7f);
  const Film expected = shoot(scene, dark_environment(), view, settings(kSize, 64, 1));
  raster::Settings settings = drawn(kSize);
  settings.frames = 8;
  const Image found = draw(scene, dark_environment(), view, settings).beauty;
  EXPECT_LT(mean_difference(expected.beauty, found), 0.06);
  EXPECT_LT(mean_difference(found, draw(other.build(), dark_environment(), view, settings).beauty), 1e-4);
  EXPECT_LT(mean_difference(expected.beauty,
                            shoot(other.build(), dark_environment(), view, test::settings(kSize, 64, 1)).beauty),
            1e-4);
  Scene flat = scene;
  flat.materials.back().height_texture = {};
  EXPECT_GT(mean_difference(expected.beauty, draw(flat, dark_environment(), view, settings).beauty), 0.12);
}

/// A quad one metre wide, tangents along +x, that a map of one texel gives the normal (x, 0, z).
Primitive leaning_quad() {
  Primitive p = quad({-0.5f, -0.5f, 0}, {1, 0, 0}, {0, 1, 0});
  p.tangents.assign(p.positions.size(), vec4(1, 0, 0, 1));
  return p;
}

int lean(SceneBuilder& b, float x) {
  const auto code = [](float v) { return static_cast<std::uint8_t>(std::lround(127.5f * v + 127.5f)); };
  return b.add_texture(1, 1, {code(x), 128, code(std::sqrt(1.0f - x * x)), 255});
}

TEST_F(law_raster, coats_and_what_they_cover_have_normals_of_their_own) {
  const Environment sky =
      mapped_environment(64, 32, [](vec3 d) { return vec3(0.5f) + vec3(0.45f, 0.3f, -0.4f) * d.x; });
  const View view = look_at({0.0f, 0.0f, 2.0f}, vec3(0.0f), 0.3f);
  const auto pictures = [&](Material m, float base, float coat) {
    SceneBuilder b;
    m.normal_texture = slot(lean(b, base));
    m.clearcoat_normal_texture = slot(lean(b, coat));
    b.add(leaning_quad(), m);
    const Region middle{6, 6, 10, 10};
    return std::pair(mean_of(shoot(b.build(), sky, view, settings(16, 256, 1)).beauty, middle),
                     mean_of(draw(b.build(), sky, view, drawn(16)).beauty, middle));
  };
  Material coated = matte(vec3(0.0f));
  coated.clearcoat = 1.0f, coated.clearcoat_roughness = 0.2f;
  for (const float x : {-0.3f, 0.3f}) {
    const auto [metal_traced, metal_found] = pictures(metal(vec3(0.8f), 0.2f), x, 0.0f);
    EXPECT_LT(glm::distance(metal_traced, metal_found), 0.03 * glm::length(metal_traced)) << x;
    const auto [coat_traced, coat_found] = pictures(coated, -x, x);
    EXPECT_LT(glm::distance(coat_traced, coat_found), 0.05 * glm::length(coat_traced)) << x;
    // The twin: leaning the other way shows.
    EXPECT_GT(glm::distance(coat_traced, pictures(coated, x, -x).second), 0.3 * glm::length(coat_traced)) << x;
  }
}

/// A streaked base, or a streaked coat over black, whose direction its factor turns so far, or else its texture.
Scene streaked(bool is_coat, float rotation, bool by_texture) {
  SceneBuilder b;
  Material m = is_coat ? matte(vec3(0.0f)) : metal(vec3(0.8f), 0.3f);
  if (is_coat) m.clearcoat = 1.0f, m.clearcoat_roughness = 0.3f;
  (is_coat ? m.clearcoat_anisotropy : m.anisotropy) = 0.9f;
  if (by_texture) {
    const auto code = [](float v) { return static_cast<std::uint8_t>(std::lround(127.5f * v + 127.5f)); };
    const int texture = b.add_texture(1, 1, {code(std::cos(rotation)), code(std::sin(rotation)), 255, 255});
    (is_coat ? m.clearcoat_anisotropy_texture : m.anisotropy_texture) = slot(texture);
  } else {
    (is_coat ? m.clearcoat_anisotropy_rotation : m.anisotropy_rotation) = rotation;
  }
  b.add(leaning_quad(), m);
  b.add_light(sunlight(vec3(1.0f), 3.0f), aimed({1.0f, 2.0f, 2.0f}, vec3(0.0f)));
  return b.build();
}

TEST_F(law_raster, streaks_of_base_and_coat_follow_their_directions) {
  const View view = look_at({0.4f, 0.2f, 2.0f}, vec3(0.0f), 0.3f);
  const Region middle{6, 6, 10, 10};
  const auto found = [&](const Scene& scene) {
    return mean_of(draw(scene, dark_environment(), view, drawn(16)).beauty, middle).x;
  };
  for (const bool is_coat : {false, true}) {
    const Scene scene = streaked(is_coat, 0.7f, false);
    const double turned = found(scene);
    const double traced = mean_of(shoot(scene, dark_environment(), view, centred(16, 1, 1)).beauty, middle).x;
    EXPECT_NEAR(turned, traced, 0.01 * traced) << is_coat;
    EXPECT_NEAR(found(streaked(is_coat, 0.7f, true)), traced, 0.03 * traced) << is_coat;
    // The twin: across, it shows.
    EXPECT_GT(std::abs(found(streaked(is_coat, 0.7f + 0.5f * kPi, false)) - traced), 0.2 * traced) << is_coat;
  }
}

TEST_F(law_raster, light_from_behind_does_not_leak_through_a_normal_map) {
  for (const float x : {0.0f, 0.9f}) {
    SceneBuilder b;
    Material m = plastic(vec3(0.8f), 0.5f);
    m.double_sided = true;
    m.normal_texture = slot(lean(b, x));
    b.add(leaning_quad(), m);
    b.add_light(sunlight(vec3(1.0f), 3.0f), aimed({3.0f, 0.0f, -1.0f}, vec3(0.0f)));
    const View view = look_at({0.5f, 0.0f, 2.0f}, vec3(0.0f), 0.3f);
    const auto middle = [&](const SceneBuilder& lit) {
      return mean_of(draw(lit.build(), dark_environment(), view, drawn(16)).beauty, {6, 6, 10, 10});
    };
    EXPECT_EQ(middle(b), dvec3(0.0)) << x;
    b.add_light(sunlight(vec3(1.0f), 3.0f), aimed({3.0f, 0.0f, 1.0f}, vec3(0.0f)));
    EXPECT_GT(middle(b).x, 0.05) << "the same from before it";
  }
}

TEST_F(law_raster, dispersion_parts_colours_where_the_path_tracer_does) {
  // A thick pane on a floor that is black beyond x = 0.
  SceneBuilder b;
  b.add(quad({-4, 0, 2}, {4, 0, 0}, {0, 0, -4}), unlit(vec3(0.0f)));
  b.add(quad({0, 0, 2}, {6, 0, 0}, {0, 0, -4}), unlit(vec3(1.0f)));
  Material glass = plastic(vec3(1.0f), 0.0f);
  glass.ior = 1.8f, glass.transmission = 1.0f, glass.dispersion = 8.0f;
  glass.thickness = 0.6f;
  b.add(box({-1.5f, 0.001f, -1.5f}, {1.5f, 0.6f, 1.5f}), glass);
  const View view = look_at({2.0f, 2.0f, 0.0f}, {0.0f, 0.3f, 0.0f}, 0.5f);
  // How many rows further the white side reaches in blue than in red, each over its own white.
  const auto parted = [](const Image& image) {
    const dvec3 reach = 9.0 * mean_of(image, {4, 8, 28, 17}) / mean_of(image, {4, 17, 28, 22});
    return reach.z - reach.x;
  };
  const double traced = parted(shoot(b.build(), dark_environment(), view, settings(32, 1024, 12)).beauty);
  const auto found = [&](float strength) {
    Scene scene = b.build();
    for (Material& m : scene.materials) m.dispersion *= strength;
    return parted(draw(scene, dark_environment(), view, drawn(32)).beauty) / traced;
  };
  EXPECT_GT(traced, 0.5);
  constexpr double kThreeRays = 0.3;  // they stand for the spectrum, and for both surfaces
  EXPECT_NEAR(found(1.0f), 1.0, kThreeRays);
  for (const float other : {0.0f, 0.4f, 2.5f}) EXPECT_GT(std::abs(found(other) - 1.0), kThreeRays) << other;
}

TEST_F(law_raster, textures_that_share_channels_look_as_if_they_did_not) {
  const auto smooth = [](int seed) {
    constexpr int kTexels = 16;
    std::vector<std::uint8_t> rgba;
    for (int y = 0; y < kTexels; ++y) {
      for (int x = 0; x < kTexels; ++x) {
        for (int c = 0; c < 4; ++c) {
          const double wave = std::sin(0.4 * x + seed + c) * std::sin(0.3 * y + 2 * seed - c);
          rgba.push_back(static_cast<std::uint8_t>(140 + 80 * wave));
        }
      }
    }
    return rgba;
  };
  // What wraps otherwise is not packed, and looks the same within the texture.
  const auto picture = [&](Wrap wrap_of_guests, std::size_t textures) {
    SceneBuilder b;
    Material m;
    m.emission = vec3(0.3f);
    m.normal_scale = 0.3f;
    for (std::size_t i = 0; i < 5; ++i) {
      const bool is_guest = i == 1 || i == 3;
      *texture_slots(m)[i] = slot(
          b.add_texture(16, 16, smooth(static_cast<int>(i)), Filter::linear, is_guest ? wrap_of_guests : Wrap::repeat));
    }
    Primitive p = quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    p.tangents.assign(p.positions.size(), vec4(1, 0, 0, 1));
    b.add(p, m);
    const Scene scene = b.build();
    const auto packed = raster::pack_textures(scene);
    EXPECT_EQ(static_cast<std::size_t>(std::count_if(packed[0].slots.begin(), packed[0].slots.end(),
                                                     [](const auto& s) { return s.image >= 0; })),
              textures);
    return draw(scene, constant_environment(vec3(1.0f)), look_at({0.2f, 0.1f, 1.5f}, vec3(0.0f), 0.6f), drawn(kSize))
        .beauty;
  };
  const Image apart = picture(Wrap::clamp_to_edge, 4);  // occlusion beside roughness
  const Image together = picture(Wrap::repeat, 3);
  double most = 0.0;
  for (std::size_t i = 0; i < apart.pixels.size(); ++i) {
    most = std::max(most, static_cast<double>(std::abs(apart.pixels[i] - together.pixels[i])));
  }
  EXPECT_LT(most, 0.01);  // drivers may filter colours and data with different precision
}

/// A quad with twenty uv sets, of which only `set` looks up the green half of a picture.
Scene scene_of_set(int set, const std::function<void(Material&, const TextureSlot&)>& use, bool is_instanced) {
  SceneBuilder b;
  const int texture = b.add_texture(2, 1, {255, 0, 0, 0, 0, 255, 0, 255}, Filter::nearest);
  Primitive p = quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  for (std::size_t i = 0; i < 20; ++i) p.uvs[i].assign(4, vec2(0.25f, 0.5f));
  p.uvs[static_cast<std::size_t>(set)].assign(4, vec2(0.75f, 0.5f));
  Material m = unlit(vec3(1.0f));
  use(m, slot(texture, set));
  const int node = b.add(p, m);
  if (is_instanced) {
    b.scene().nodes[static_cast<std::size_t>(node)].world_from_node = translation({-0.5f, 0, 0});
    b.add_node(b.scene().nodes[static_cast<std::size_t>(node)].mesh, translation({0.5f, 0, 0.1f}));
  }
  return b.build();
}

TEST_F(law_raster, textures_are_not_blurred_along_a_flat_view) {
  // Stripes that run away from the viewer, over a floor that is seen nearly from the side.
  std::vector<std::uint8_t> stripes;
  for (int i = 0; i < 64 * 64; ++i) stripes.insert(stripes.end(), 4, (i / 2) % 2 == 0 ? 255 : 20);
  SceneBuilder b;
  Material m = matte(vec3(0.8f));
  m.base_color_texture = slot(b.add_texture(64, 64, stripes));
  b.add(plane(vec3(0.0f), 1.0f), m);
  const Scene scene = b.build();
  const View view = look_at({0, 0.2f, 2.0f}, vec3(0.0f), 0.5f);
  const Environment white = constant_environment(vec3(1.0f));
  const Film expected = shoot(scene, white, view, settings(64, 64, 1));
  raster::Settings settings = drawn(64);
  settings.frames = 16;
  const auto difference = [&](int anisotropy) {
    settings.texture_anisotropy = anisotropy;
    return mean_difference(expected, draw(scene, white, view, settings));
  };
  EXPECT_LT(difference(8), 0.5 * difference(1));
  context_ = gl::Context::open();
  const bool is_software = gl::is_software();
  context_.reset();
  EXPECT_EQ(difference(0), difference(is_software ? 1 : 8));
}

TEST_F(law_raster, every_uv_set_has_its_own_coordinates) {
  const View view = look_at({0, 0, 3}, vec3(0.0f), 0.9f);
  for (const int set : {0, 1, 2, 3, 4, 19}) {
    for (const bool is_instanced : {false, true}) {
      const auto color = [](Material& m, const TextureSlot& s) { m.base_color_texture = s; };
      const Film plain = draw(scene_of_set(set, color, is_instanced), dark_environment(), view, drawn(16));
      EXPECT_EQ(plain.beauty.rgb(8, 8), vec3(0, 1, 0)) << set;
      // Two textures of different sets, and the alpha of a mask in a shadow's own program.
      const auto mask = [](Material& m, const TextureSlot& s) {
        m.base_color_texture = s;
        m.alpha_mode = AlphaMode::mask;
        m.emissive_texture = s;
        m.emissive_texture.uv_set = 11;
      };
      const Film cut = draw(scene_of_set(set, mask, is_instanced), dark_environment(), view, drawn(16));
      EXPECT_EQ(cut.beauty.rgb(8, 8), vec3(0, 1, 0)) << set;
    }
  }
}

TEST_F(law_raster, sets_for_which_a_vertex_has_no_room_are_told) {
  const auto many = [](Material& m, const TextureSlot& s) {
    int set = 0;
    for (TextureSlot* slot : texture_slots(m)) {
      *slot = s;
      slot->uv_set = set++ % 20;
    }
    m.base_color_texture = s, m.height_texture = {};
  };
  Diagnostics told;
  const Film film = test::draw(scene_of_set(3, many, false), dark_environment(), look_at({0, 0, 3}, vec3(0.0f), 0.9f),
                               drawn(16), told);
  EXPECT_EQ(film.beauty.rgb(8, 8), vec3(0, 1, 0));
  EXPECT_TRUE(std::any_of(told.warnings().begin(), told.warnings().end(), [](const Diagnostic& d) {
    return d.text().find("textures of TEXCOORD_16 and beyond are left out") != std::string::npos;
  }));
}

TEST_F(law_raster, textures_that_a_driver_cannot_read_at_once_are_left_out_and_told) {
  SceneBuilder b;
  Material m = plastic({0.6f, 0.5f, 0.4f}, 0.5f);
  m.name = "paint";
  m.clearcoat = 1.0f, m.clearcoat_roughness = 0.5f;
  const std::vector<std::uint8_t> gray(16, 128);
  m.base_color_texture = slot(b.add_texture(2, 2, gray));
  m.clearcoat_texture = slot(b.add_texture(2, 2, gray));
  m.clearcoat_roughness_texture = slot(b.add_texture(2, 2, gray));
  b.add(sphere(vec3(0.0f), 1.0f, 4, false), m);
  const Scene scene = b.build();
  const auto picture = [&](const Scene& drawn_scene, int most, Diagnostics& diagnostics) {
    raster::Settings s = drawn(kSize);
    s.most_textures = most;
    s.frames = 2;
    return raster::render(drawn_scene, constant_environment(vec3(1.0f)), sphere_view(), s,
                          {.diagnostics = &diagnostics})
        .beauty;
  };
  // Two tables and two cubes of light leave three.
  Diagnostics enough;
  const Image whole = picture(scene, 0, enough);
  EXPECT_EQ(largest_difference(picture(scene, 7, enough), whole), 0.0);
  EXPECT_TRUE(enough.warnings().empty());

  Diagnostics few;
  const Image partial = picture(scene, 5, few);
  ASSERT_EQ(few.warnings().size(), 1u);
  EXPECT_NE(few.warnings()[0].message.find("clearcoat, clearcoat_roughness"), std::string::npos)
      << few.warnings()[0].message;
  Scene plain = scene;
  plain.materials[0].clearcoat_texture = plain.materials[0].clearcoat_roughness_texture = {};
  EXPECT_EQ(largest_difference(partial, picture(plain, 0, enough)), 0.0);
  EXPECT_GT(largest_difference(partial, whole), 0.0);
}

TEST_F(law_raster, textures_beyond_the_drivers_limit_are_halved_and_told) {
  constexpr int kWide = 40000;  // more than any driver takes
  for (const bool has_16_bits : {false, true}) {
    SceneBuilder b;
    Material m = unlit(vec3(1.0f));
    // Linear grey 0.2 to 0.8 from left to right.
    std::vector<std::uint8_t> bytes;
    std::vector<std::uint16_t> words;
    for (int x = 0; x < kWide; ++x) {
      const bool is_right = x >= kWide / 2;
      for (int c = 0; c < 4; ++c) {
        bytes.push_back(c == 3 ? 255 : is_right ? 231 : 124);
        words.push_back(c == 3 ? 65535 : is_right ? 59367 : 31868);
      }
    }
    m.base_color_texture = slot(has_16_bits ? b.add_texture_16(kWide, 1, words, Filter::linear, Wrap::clamp_to_edge)
                                            : b.add_texture(kWide, 1, bytes, Filter::linear, Wrap::clamp_to_edge));
    b.add(plane(vec3(0.0f), 1.0f), m);
    Diagnostics diagnostics;
    const Film film = raster::render(b.build(), dark_environment(), look_at({0, 3, 0.01f}, vec3(0.0f), 0.4f), drawn(16),
                                     {.diagnostics = &diagnostics});
    ASSERT_EQ(diagnostics.warnings().size(), 1u);
    EXPECT_NE(diagnostics.warnings()[0].message.find("larger than the driver's limit"), std::string::npos);
    const float left = film.beauty.rgb(2, 8).x, right = film.beauty.rgb(13, 8).x;
    EXPECT_NEAR(std::min(left, right), 0.2f, 0.01f);
    EXPECT_NEAR(std::max(left, right), 0.8f, 0.01f);
  }
}

TEST_F(law_raster, probes_of_an_open_place_see_the_environment) {
  const Environment sky = mapped_environment(128, 64, [](vec3 d) { return vec3(0.5f) + 0.4f * d; });
  SceneBuilder b;
  b.add(sphere(vec3(0.0f), 1.0f, 5, false), plastic(vec3(0.6f, 0.3f, 0.2f), 0.5f));
  const Scene scene = b.build();
  // A box far larger than the sphere: its walls are far away.
  const path::Tracer nothing(SceneBuilder{}.build(), sky);
  const Cubemap seen = path::capture_environment(nothing, vec3(0.0f), 64, {.samples = 64});
  const raster::Probe probe{vec3(0.0f), {vec3(-1e4f), vec3(1e4f)}, raster::bake_light(seen.levels[0], false)};
  raster::Drawer drawer(borrowed(scene), sky);
  const auto shown = [&](const std::vector<raster::Probe>& probes) {
    drawer.set_probes(probes);
    return drawer.render(sphere_view(), drawn(kSize)).beauty;
  };
  const Image without = shown({});
  raster::Probe near = probe;
  near.box = {vec3(-1.1f), vec3(1.1f)};
  constexpr double kSame = 1e-3;
  EXPECT_LT(mean_difference(without, shown({probe})), kSame);
  EXPECT_GT(mean_difference(without, shown({near})), kSame) << "walls that are near are seen elsewhere";
}

TEST_F(law_raster, simple_kinds_of_ambient_light_keep_the_mean) {
  const Environment sky = mapped_environment(128, 64, [](vec3 d) { return vec3(0.5f) + 0.4f * d; });
  const raster::BakedLight baked = raster::bake_light(sky, false, {});
  const auto mean = [](const CubeFaces& faces) {
    double sum = 0.0;
    for (const Image& face : faces) sum += mean_luminance(face) / 6.0;
    return sum;
  };
  for (const raster::Ambient kind : {raster::Ambient::harmonics, raster::Ambient::mips, raster::Ambient::constant}) {
    const raster::BakedLight light = raster::simplified(baked, kind);
    EXPECT_NEAR(mean(light.irradiance) / mean(baked.irradiance), 1.0, 0.02) << static_cast<int>(kind);
  }
  // A gradient is all in the first two bands.
  const raster::BakedLight nine = raster::simplified(baked, raster::Ambient::harmonics);
  EXPECT_LT(mean_difference(baked.irradiance[0], nine.irradiance[0]), 2e-3);
  EXPECT_GT(mean_difference(baked.irradiance[0], raster::simplified(baked, raster::Ambient::constant).irradiance[0]),
            0.1);
  EXPECT_TRUE(raster::simplified(baked, raster::Ambient::none).specular.empty());
}

// Whatever carries a vertex, it stands at one place.
TEST_F(law_raster, animated_skinned_and_morphed_models_stand_alike) {
  const fs::path models = fs::path(CANDELA_ASSETS) / "models";
  if (!fs::exists(models)) GTEST_SKIP() << "no assets at " << models;
  struct Sample {
    const char* file;
    double moment_s;
    const char* animation = "";
  };
  for (const Sample& sample :
       {Sample{"CesiumMan/glTF-Binary/CesiumMan.glb", 0.6}, Sample{"Fox/glTF-Binary/Fox.glb", 0.4},
        Sample{"MorphStressTest/glTF-Binary/MorphStressTest.glb", 0.7},
        Sample{"InterpolationTest/glTF-Binary/InterpolationTest.glb", 1.1, "all"},
        Sample{"SimpleInstancing/glTF-Binary/SimpleInstancing.glb", 0.0}}) {
    Diagnostics diagnostics;
    io::GltfFile file(models / sample.file, diagnostics);
    const Scene rest = file.scene(diagnostics);
    const Scene scene = file.scene(diagnostics, io::Pose{sample.animation, sample.moment_s});
    const Box3 bounds = world_bounds(scene);
    const View view = frame(Extent(bounds), {.yfov = 0.8f, .margin = 0.04f});
    raster::Settings settings = drawn(kSize);
    settings.layers = {Layer::position};
    path::Settings traced;
    traced.width = traced.height = kSize;
    traced.samples = 1;
    traced.layers = settings.layers;
    Environment environment;
    environment.constant = vec3(1.0f);
    const Image expected = path::render(scene, environment, view, traced).layers.at(Layer::position);
    const Image found = draw(scene, environment, view, settings).layers.at(Layer::position);
    const float size = glm::length(bounds.size());
    int covered = 0, apart = 0;
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        covered += max_component(glm::abs(expected.rgb(x, y))) > 0.0f ? 1 : 0;
        apart += glm::length(expected.rgb(x, y) - found.rgb(x, y)) > 1e-3f * size ? 1 : 0;
      }
    }
    EXPECT_GT(covered, kSize) << sample.file;
    // Edges, where the two round a pixel's centre to either side.
    EXPECT_LT(apart, covered / 50 + 4) << sample.file;
    if (sample.moment_s == 0.0) continue;
    // And it is not where it rests.
    const Image resting = draw(rest, environment, view, settings).layers.at(Layer::position);
    int moved = 0;
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) moved += glm::length(resting.rgb(x, y) - found.rgb(x, y)) > 1e-2f * size ? 1 : 0;
    }
    EXPECT_GT(moved, covered / 20) << sample.file;
  }
}

TEST_F(law_raster, blended_sheets_are_composited_far_to_near) {
  const auto sheet = [](vec3 color, float opacity) {
    Material m = unlit(color);
    m.alpha_mode = AlphaMode::blend, m.opacity = opacity;
    return m;
  };
  SceneBuilder b;
  // The near one first in the file.
  b.add(quad({-1, -1, 0.5f}, {2, 0, 0}, {0, 2, 0}), sheet({1, 0, 0}, 0.25f));
  b.add(quad({-1, -1, 0.0f}, {2, 0, 0}, {0, 2, 0}), sheet({0, 1, 0}, 0.5f));
  const Film film =
      draw(b.build(), constant_environment(vec3(0.0f, 0.0f, 0.8f)), look_at({0, 0, 4}, vec3(0.0f), 0.3f), drawn(16));
  const vec3 c = film.beauty.rgb(8, 8);
  EXPECT_NEAR(c.x, 0.25f, 1e-3f);
  EXPECT_NEAR(c.y, 0.75f * 0.5f, 1e-3f);
  EXPECT_NEAR(c.z, 0.75f * 0.5f * 0.8f, 1e-3f);
}

TEST_F(law_raster, hidden_background_is_transparent_and_premultiplied) {
  SceneBuilder b;
  Material half = unlit({1.0f, 0.5f, 0.25f});
  half.alpha_mode = AlphaMode::blend, half.opacity = 0.5f;
  b.add(quad({-1, -1, 0}, {1, 0, 0}, {0, 2, 0}), half);
  raster::Settings settings = drawn(32);
  settings.background = Background::transparent;
  const Film film = draw(b.build(), constant_environment(vec3(1.0f)), look_at({0, 0, 4}, vec3(0.0f), 0.4f), settings);
  const auto left = film.beauty.at(8, 16), right = film.beauty.at(24, 16);
  EXPECT_NEAR(left[3], 0.5f, 1e-3f);
  EXPECT_NEAR(left[0], 0.5f, 1e-3f);
  EXPECT_NEAR(left[2], 0.125f, 1e-3f);
  EXPECT_EQ(right[3], 0.0f);
  EXPECT_EQ(right[0], 0.0f);
}

TEST_F(law_raster, many_frames_give_the_mean_over_the_pixel_and_the_lens) {
  SceneBuilder b;
  b.add(quad({-4, -4, -2}, {8, 0, 0}, {0, 8, 0}), unlit({0.1f, 0.2f, 0.3f}));
  b.add(box({-0.5f, -0.5f, 0.0f}, {0.5f, 0.5f, 0.5f}), unlit({0.9f, 0.7f, 0.4f}));
  View view = look_at({0, 0, 3}, vec3(0.0f), 0.6f);
  view.lens.radius = 0.15f, view.lens.focus_distance = 5.0f;  // the wall is sharp
  raster::Settings settings = drawn(48);
  settings.frames = 64;
  const Film found = draw(b.build(), dark_environment(), view, settings);
  const Film expected = shoot(b.build(), dark_environment(), view, test::settings(48, 256, 1));
  double worst = 0.0;
  for (std::size_t i = 0; i < found.beauty.pixels.size(); ++i) {
    worst = std::max(worst, std::abs(static_cast<double>(found.beauty.pixels[i] - expected.beauty.pixels[i])));
  }
  EXPECT_LT(worst, 0.09);
  // The twin: without the lens the border is hard.
  settings.frames = 1;
  const Film sharp = draw(b.build(), dark_environment(), view, settings);
  double twin = 0.0;
  for (std::size_t i = 0; i < sharp.beauty.pixels.size(); ++i) {
    twin = std::max(twin, std::abs(static_cast<double>(sharp.beauty.pixels[i] - expected.beauty.pixels[i])));
  }
  EXPECT_GT(twin, 0.2);
}

}  // namespace
}  // namespace candela
