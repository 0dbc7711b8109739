#include "candela/explain.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <map>

#include "base/error.h"

// A pixel explained: what the frame reads and shows, what the material says, beside the truth.

namespace candela {
namespace {

Shot shot_of(const std::string& scene, ivec2 size) {
  Shot shot;
  shot.scene = scene;
  shot.size = size;
  shot.environment = "studio";
  return shot;
}

ExplainSettings settings_of(std::vector<ivec2> pixels, int samples = 64) {
  return {.pixels = std::move(pixels), .samples = samples};
}

/// A pixel near the middle of each ball of a row.
std::vector<ivec2> balls(ivec2 size, int count) {
  std::vector<ivec2> pixels;
  for (int i = 0; i < count; ++i) pixels.emplace_back((2 * i + 1) * size.x / (2 * count), size.y / 2 - 1);
  return pixels;
}

vec3 term_of(const FrameTerms& frame, raster::Quantity part) {
  for (const FrameTerm& term : frame.terms) {
    if (term.part == part) return term.radiance;
  }
  return vec3(0.0f);
}

TEST(unit_explain, what_the_frame_reads_is_what_it_shows) {
  for (const char* scene : {"demo:row-roughness", "demo:row-roughness-metal", "demo:row-clearcoat",
                            "demo:row-anisotropy", "demo:row-sheen-roughness"}) {
    Shot shot = shot_of(scene, {240, 48});
    shot.drawn.specular_antialiasing = false;
    std::vector<ivec2> pixels;
    for (const ivec2 p : balls(shot.size, 12)) {
      for (const ivec2 beside : {ivec2(0), ivec2(3, 0), ivec2(-3, 0), ivec2(0, 3), ivec2(0, -3)})
        pixels.push_back(p + beside);
    }
    const Explanation e = explain(shot, settings_of(pixels, 2));
    int seen = 0;
    for (std::size_t i = 0; i < e.pixels.size(); i += 5) {
      const PixelExplanation& p = e.pixels[i];
      bool is_within = true;
      for (std::size_t k = 0; k < 5; ++k) {
        const auto& there = e.pixels[i + k].surface;
        is_within = is_within && there && p.surface && there->where.node == p.surface->where.node;
      }
      if (!is_within) continue;
      ASSERT_TRUE(p.frame && p.frame->far);
      std::map<raster::Quantity, vec3> light;  // of a part all lookups, of several lobes
      for (const FarLookup& read : p.frame->far->lookups) {
        const raster::Quantity part = read.lobe == "diffuse" ? raster::Quantity::diffuse
                                      : read.lobe == "coat"  ? raster::Quantity::coat
                                      : read.lobe == "sheen" ? raster::Quantity::sheen
                                                             : raster::Quantity::specular;
        light.try_emplace(part, 0.0f).first->second += read.light;
      }
      for (const auto& [part, read] : light) {
        const vec3 shown = term_of(*p.frame, part);
        // Four samples over the pixel beside its middle.
        for (int c = 0; c < 3; ++c) {
          EXPECT_NEAR(read[c], shown[c], 0.05f * shown[c] + 2e-3f)
              << scene << ' ' << raster::quantity_name(part) << ' ' << p.pixel.x;
        }
        ++seen;
      }
    }
    EXPECT_GE(seen, 5) << scene;
  }
}

TEST(unit_explain, thirty_pixels_hold_the_film_within_their_confidence) {
  for (const char* scene : {"demo:row-lobes", "demo:cornell"}) {
    Shot shot = shot_of(scene, {60, 20});
    std::vector<ivec2> pixels;
    for (const int y : {3, 7, 11, 15, 18}) {
      for (const int x : {5, 14, 25, 35, 44, 55}) pixels.emplace_back(x, y);
    }
    ExplainSettings settings = settings_of(pixels, 512);
    settings.has_frame = false;
    const Explanation e = explain(shot, settings);
    shot.traced.seed = 9;
    path::Settings traced = traced_settings(shot);
    traced.samples = 4096;
    const Film film = path::render(*e.scene, make_environment(*shot.environment), e.view, traced);
    int held = 0;
    for (const PixelExplanation& p : e.pixels) {
      const vec3 value = film.beauty.rgb(p.pixel.x, p.pixel.y);
      for (int c = 0; c < 3; ++c) {
        const float off = std::abs(p.truth.mean[c] - value[c]), reach = kConfidence95 * p.truth.error[c] + 1e-5f;
        held += off <= reach ? 1 : 0;
        EXPECT_LT(off, 3.0f * reach) << scene << ' ' << p.pixel.x << ' ' << p.pixel.y;
      }
    }
    EXPECT_GE(held, 84) << scene << ", of 90";
  }
}

TEST(unit_explain, parts_of_the_frame_add_up_to_it) {
  const Explanation e = explain(shot_of("demo:materials", {96, 54}), settings_of({{30, 40}, {48, 27}, {70, 40}}, 2));
  for (const PixelExplanation& p : e.pixels) {
    if (!p.surface) continue;
    vec3 sum(0.0f);
    for (const FrameTerm& term : p.frame->terms) sum += term.light >= 0 ? vec3(0.0f) : term.radiance;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], p.frame->radiance[c], 1e-3f * p.frame->radiance[c] + 1e-4f);
  }
}

TEST(unit_explain, properties_are_what_the_layers_say) {
  Shot shot = shot_of("demo:materials", {96, 54});
  const Explanation e = explain(shot, settings_of({{30, 40}, {48, 27}, {70, 40}, {10, 50}}, 2));
  shot.traced.samples = 1;
  path::Settings traced = traced_settings(shot);
  traced.filter_radius = 1e-3f;
  traced.layers = {Layer::base_color};
  const Environment environment = make_environment(*shot.environment);
  const Film film = path::render(*e.scene, environment, e.view, traced);
  for (const PixelExplanation& p : e.pixels) {
    if (!p.surface) continue;
    ASSERT_FALSE(p.properties.empty());
    EXPECT_EQ(p.properties[0].name, "base_color");
    const vec3 layer = film.layers.at(Layer::base_color).rgb(p.pixel.x, p.pixel.y);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(p.properties[0].value[c], layer[c], 2e-3f) << p.pixel.x;
  }
}

TEST(unit_explain, harmonics_are_near_the_irradiance_of_an_even_sky) {
  Shot shot = shot_of("demo:row-roughness", {120, 24});
  const Explanation e = explain(shot, settings_of(balls(shot.size, 5), 2));
  int seen = 0;
  for (const PixelExplanation& p : e.pixels) {
    if (!p.frame->far) continue;
    const FarTerms& far = *p.frame->far;
    EXPECT_EQ(far.harmonics.size(), 9U);
    EXPECT_NEAR(luminance(far.harmonics_irradiance), luminance(far.irradiance), 0.1f * luminance(far.irradiance));
    ++seen;
  }
  EXPECT_GE(seen, 3);
}

TEST(unit_explain, lobes_are_cut_in_the_plane_of_the_eye) {
  Shot shot = shot_of("demo:row-roughness-metal", {240, 48});
  const Explanation e = explain(shot, settings_of({{60, 16}}, 2));
  ASSERT_TRUE(e.pixels[0].surface);
  const path::PixelSurface& surface = *e.pixels[0].surface;
  const std::vector<LobeCut> cuts = cut_lobes(surface);
  ASSERT_EQ(cuts.size(), 1U);
  EXPECT_EQ(cuts[0].lobe, "specular");
  // The lobe of a smooth metal is highest where a mirror would show it: as far from the normal as the eye, opposite.
  dvec2 top(0.0);
  for (const dvec2 point : cuts[0].points) top = point.y > top.y ? point : top;
  const double eye = degrees(std::acos(surface.wo.z));
  EXPECT_GT(top.x, 0.0);
  EXPECT_NEAR(top.x, eye, 6.0);
}

TEST(unit_explain, a_pixel_of_the_sky_has_no_surface) {
  const Explanation e = explain(shot_of("demo:furnace", {64, 36}), settings_of({{0, 0}}));
  EXPECT_FALSE(e.pixels[0].surface);
  EXPECT_FALSE(e.pixels[0].frame->far);
  EXPECT_TRUE(e.pixels[0].properties.empty());
  EXPECT_GT(e.pixels[0].truth.mean.x, 0.0f);
  ASSERT_EQ(e.pixels[0].truth.turns.size(), 1U);
}

TEST(unit_explain, what_cannot_be_explained_is_an_error) {
  const Shot shot = shot_of("demo:row-roughness", {120, 24});
  EXPECT_THROW(explain(shot, settings_of({})), Error);
  EXPECT_THROW(explain(shot, settings_of({{120, 0}})), Error);
  EXPECT_THROW(explain(shot, settings_of({{1, 1}}, 1)), Error);
  Shot many = shot;
  many.turntable = 4;
  EXPECT_THROW(explain(many, settings_of({{1, 1}})), Error);
  Shot ground = shot;
  ground.ground = GroundChoice{};
  EXPECT_THROW(explain(ground, settings_of({{1, 1}})), Error);
  const std::atomic<bool> stop = true;
  EXPECT_THROW(explain(shot, settings_of({{1, 1}}), {.stop = &stop}), Interrupted);
}

}  // namespace
}  // namespace candela
