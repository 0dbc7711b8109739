#include "path/pixel_paths.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "path/pixel_surface.h"
#include "unit/path/scenes.h"

// What a pixel is made of: the same light as the picture's, by source, by turns and path by path.

namespace candela {
namespace {

using namespace test;

Environment sky_with_sun() {
  Environment environment = mapped_environment(
      32, 16, [](vec3 d) { return vec3(0.6f, 0.5f, 0.4f) * (1.2f + d.x) * (d.x > 0.8f ? 6.0f : 1.0f); });
  environment.suns.push_back(
      {.direction = glm::normalize(vec3(1, 2, 0.5f)), .angular_radius = 0.05f, .radiance = vec3(200.0f)});
  return environment;
}

Material glass() {
  Material m = plastic(vec3(1.0f), 0.0f);
  m.transmission = 1.0f;
  m.thickness = 1.0f;
  return m;
}

/// A ground with a metal ball, a ball of glass and a box, under two lamps at one place and a glowing quad.
SceneBuilder still_life() {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 4.0f), matte({0.7f, 0.5f, 0.3f}));
  b.add(sphere({-0.6f, 0.5f, 0}, 0.5f, 4, false), metal({0.9f, 0.8f, 0.6f}, 0.3f));
  b.add(sphere({0.6f, 0.4f, 0.7f}, 0.4f, 4, false), glass());
  b.add(box({0.3f, 0, -0.6f}, {0.9f, 1.2f, 0.2f}), plastic({0.2f, 0.3f, 0.6f}, 0.4f));
  b.add_light(point_light(vec3(1.0f), 5.0f), translation({1.5f, 2, 1}));
  b.add_light(point_light({1.0f, 0.2f, 0.1f}, 2.0f), translation({1.5f, 2, 1}));
  b.add(quad({-1, 2, -1}, {0.8f, 0, 0}, {0, 0, 0.8f}), lamp(vec3(4.0f)));
  return b;
}

View still_life_view() { return look_at({1.5f, 2.5f, 3.5f}, {0, 0.4f, 0}, 0.7f); }

void expect_near(vec3 a, vec3 b, float relative, const std::string& what) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], relative * (std::abs(b[c]) + 1e-3f)) << what << ", channel " << c;
}

std::vector<ivec2> all_over(int size, int step) {
  std::vector<ivec2> pixels;
  for (int y = step / 2; y < size; y += step) {
    for (int x = step / 2; x < size; x += step) pixels.emplace_back(x, y);
  }
  return pixels;
}

TEST(unit_path_pixel_paths, are_those_of_the_picture) {
  const Scene scene = still_life().build();
  const path::Tracer tracer(borrowed(scene), sky_with_sun());
  path::Settings s = settings(24, 16, 8);
  s.filter = path::PixelFilter::gaussian;
  const Film film = tracer.render(still_life_view(), s);
  for (const ivec2 p : all_over(24, 6)) {
    const path::PixelEstimate pixel = path::trace_pixel(tracer, still_life_view(), s, p);
    EXPECT_EQ(pixel.samples, 16);
    expect_near(pixel.mean, film.beauty.rgb(p.x, p.y), 1e-5f, std::to_string(p.x) + "," + std::to_string(p.y));
  }
}

TEST(unit_path_pixel_paths, sources_and_turns_add_up_to_the_pixel) {
  const Scene scene = still_life().build();
  const path::Tracer tracer(borrowed(scene), sky_with_sun());
  const path::Settings s = settings(24, 512, 8);
  for (const ivec2 p : all_over(24, 6)) {
    const path::PixelEstimate pixel = path::trace_pixel(tracer, still_life_view(), s, p);
    vec3 sources(0.0f), turns(0.0f), straight(0.0f);
    for (const path::SourceLight& light : pixel.sources) sources += light.straight + light.indirect;
    for (const path::SourceLight& light : pixel.sources) straight += light.straight;
    for (const vec3 light : pixel.turns) turns += light;
    expect_near(sources, pixel.mean, 1e-5f, "sources");
    expect_near(turns, pixel.mean, 1e-5f, "turns");
    vec3 few(0.0f);
    for (std::size_t i = 0; i < std::min<std::size_t>(pixel.turns.size(), 2); ++i) few += pixel.turns[i];
    expect_near(straight, few, 1e-5f, "at most one turn");
  }
}

TEST(unit_path_pixel_paths, confidence_holds_the_value_of_other_samples) {
  const Scene scene = still_life().build();
  const path::Tracer tracer(borrowed(scene), sky_with_sun());
  path::Settings s = settings(16, 4096, 8);
  s.seed = 7;
  const Film film = tracer.render(still_life_view(), s);
  s.seed = 0;
  s.samples = 512;
  int inside = 0, all = 0;
  for (const ivec2 p : all_over(16, 3)) {
    const path::PixelEstimate pixel = path::trace_pixel(tracer, still_life_view(), s, p);
    for (int c = 0; c < 3; ++c) {
      const float off = std::abs(pixel.mean[c] - film.beauty.rgb(p.x, p.y)[c]);
      inside += off <= 1.96f * pixel.error[c] + 1e-6f ? 1 : 0;
      ++all;
    }
  }
  // Samples are spread better than independent ones; but the film has a noise of its own, and light that few paths
  // find, as through the glass ball, is in none of some.
  EXPECT_GE(inside, all * 93 / 100) << "of " << all;
}

TEST(unit_path_pixel_paths, each_ends_at_the_source_that_it_names) {
  const Scene scene = still_life().build();
  const path::Tracer tracer(borrowed(scene), sky_with_sun());
  const path::Settings s = settings(24, 256, 8);
  bool sees_lamps[2] = {false, false};
  bool sees_sky = false, sees_sun = false, sees_quad = false;
  for (const ivec2 p : all_over(24, 6)) {
    const path::PixelEstimate pixel = path::trace_pixel(tracer, still_life_view(), s, p, {8});
    EXPECT_LE(pixel.brightest.size(), 8U);
    for (std::size_t i = 0; i < pixel.brightest.size(); ++i) {
      const path::LightPath& path = pixel.brightest[i];
      if (i > 0) {
        EXPECT_LE(luminance(path.radiance), luminance(pixel.brightest[i - 1].radiance));
      }
      EXPECT_LT(luminance(path.radiance), luminance(pixel.mean) * 1.001f);
    }
    for (const path::SourceLight& light : pixel.sources) {
      switch (light.source.kind) {
        case path::LightKind::sky:
          sees_sky = true;
          break;
        case path::LightKind::sun:
          sees_sun = light.source.index == 0 || sees_sun;
          break;
        case path::LightKind::lamp:
          ASSERT_TRUE(light.source.index == 4 || light.source.index == 5) << light.source.index;
          sees_lamps[light.source.index - 4] = true;
          break;
        case path::LightKind::surface:
          EXPECT_EQ(light.source.index, 6);
          EXPECT_EQ(light.source.primitive, 0);
          sees_quad = true;
          break;
      }
    }
  }
  EXPECT_TRUE(sees_sky && sees_sun && sees_quad);
  EXPECT_TRUE(sees_lamps[0] && sees_lamps[1]) << "lamps at one place are told apart by their light";
}

TEST(unit_path_pixel_paths, go_from_vertex_to_vertex) {
  // A red wall that only light from a white one reaches.
  SceneBuilder b;
  b.add(quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), matte({0.8f, 0.1f, 0.1f}));
  b.add(quad({1, -1, 4}, {-2, 0, 0}, {0, 2, 0}), matte(vec3(0.8f)));
  b.add_light(spot_light(vec3(1.0f), 50.0f, 0.2f, 0.3f), aimed({0, 0, 2}, {0, 0, 4}));
  const Scene scene = b.build();
  const path::Tracer tracer(borrowed(scene), dark_environment());
  const View view = look_at({0, 0, 3}, vec3(0.0f), 0.5f);
  const path::PixelEstimate pixel = path::trace_pixel(tracer, view, settings(8, 256, 2), {4, 4});
  ASSERT_FALSE(pixel.brightest.empty());
  for (const path::LightPath& path : pixel.brightest) {
    ASSERT_EQ(path.vertices.size(), 2U);
    EXPECT_NEAR(path.vertices[0].position.z, 0.0f, 1e-4f);
    EXPECT_NEAR(path.vertices[1].position.z, 4.0f, 1e-4f);
    EXPECT_EQ(path.vertices[0].event, path::PathEvent::reflected);
    EXPECT_EQ(path.vertices[1].event, path::PathEvent::reflected);
    EXPECT_EQ(path.source, (path::LightSource{path::LightKind::lamp, 2, -1}));
    const vec3 to_lamp = glm::normalize(vec3(0, 0, 2) - path.vertices[1].position);
    expect_near(path.direction, to_lamp, 1e-4f, "direction");
  }
  ASSERT_EQ(pixel.turns.size(), 3U);
  EXPECT_EQ(pixel.turns[0] + pixel.turns[1], vec3(0.0f));
}

TEST(unit_path_pixel_paths, of_what_is_not_in_the_picture_are_an_error) {
  const Scene scene = still_life().build();
  const path::Tracer tracer(borrowed(scene), sky_with_sun());
  const path::Settings s = settings(24, 16, 8);
  EXPECT_THROW(path::trace_pixel(tracer, still_life_view(), s, {24, 0}), Error);
  EXPECT_THROW(path::trace_pixel(tracer, still_life_view(), s, {0, -1}), Error);
  EXPECT_THROW(path::find_pixel_surface(tracer, still_life_view(), {24, 24}, {0, 24}), Error);
  Scene on_ground = scene;
  on_ground.ground = Ground{};
  EXPECT_THROW(path::trace_pixel(path::Tracer(borrowed(on_ground), sky_with_sun()), still_life_view(), s, {1, 1}),
               Error);
}

TEST(unit_path_pixel_surface, lamps_light_it_as_the_picture_of_one_bounce_has_it) {
  SceneBuilder lit;
  lit.add(plane(vec3(0.0f), 4.0f), plastic({0.7f, 0.5f, 0.3f}, 0.4f));
  lit.add(sphere({-0.6f, 0.5f, 0}, 0.5f, 5, false), metal({0.9f, 0.8f, 0.6f}, 0.3f));
  lit.add_light(point_light(vec3(1.0f), 5.0f), translation({1.5f, 2, 1}));
  lit.add_light(sunlight({0.2f, 0.4f, 1.0f}, 3.0f), aimed({-1, 3, 2}, vec3(0.0f)));
  const Scene scene = lit.build();
  const path::Tracer tracer(borrowed(scene), dark_environment());
  const path::Settings s = centred(24, 4096, 1);
  const Film film = tracer.render(still_life_view(), s);
  int lit_pixels = 0;
  for (const ivec2 p : all_over(24, 2)) {
    const auto surface = path::find_pixel_surface(tracer, still_life_view(), {24, 24}, p);
    if (!surface) continue;
    vec3 sum = surface->emission;
    for (const path::LampTerms& lamp : surface->lamps) sum += lamp.radiance;
    expect_near(sum, film.beauty.rgb(p.x, p.y), 2e-3f, std::to_string(p.x) + "," + std::to_string(p.y));
    lit_pixels += max_component(sum) > 0.0f ? 1 : 0;
  }
  EXPECT_GT(lit_pixels, 60);
}

TEST(unit_path_pixel_surface, terms_of_facets_multiply_to_their_value) {
  const Scene scene = still_life().build();
  const path::Tracer tracer(borrowed(scene), sky_with_sun());
  int seen = 0;
  for (const ivec2 p : all_over(24, 2)) {
    const auto surface = path::find_pixel_surface(tracer, still_life_view(), {24, 24}, p);
    if (!surface || surface->surface.is_mirror || surface->where.node == 2) continue;
    for (const path::LampTerms& lamp : surface->lamps) {
      if (lamp.facets.d <= 0.0f) continue;
      const vec3 wi = lamp.wi;
      const float dv = shade::terms_dv(surface->surface, surface->wo, wi, lamp.facets.half);
      EXPECT_NEAR(lamp.facets.d * lamp.facets.g / (4.0f * wi.z * surface->wo.z), dv, 1e-4f * dv);
      EXPECT_GT(lamp.facets.g, 0.0f);
      EXPECT_LE(lamp.facets.g, 1.0001f);
      ++seen;
    }
  }
  EXPECT_GT(seen, 20);
}

TEST(unit_path_pixel_surface, is_where_the_picture_has_it) {
  const Scene scene = still_life().build();
  const path::Tracer tracer(borrowed(scene), sky_with_sun());
  path::Settings s = centred(24, 4, 1);
  s.layers = {Layer::normal, Layer::position, Layer::object_id};
  const Film film = tracer.render(still_life_view(), s);
  for (const ivec2 p : all_over(24, 2)) {
    const auto surface = path::find_pixel_surface(tracer, still_life_view(), {24, 24}, p);
    const float id = film.layers.at(Layer::object_id).at(p.x, p.y)[0];
    ASSERT_EQ(surface ? static_cast<float>(1 + surface->where.node) : 0.0f, id) << p.x << ',' << p.y;
    if (!surface) continue;
    expect_near(surface->where.position, film.layers.at(Layer::position).rgb(p.x, p.y), 1e-4f, "position");
    expect_near(surface->frame.n, film.layers.at(Layer::normal).rgb(p.x, p.y), 1e-3f, "normal");
    EXPECT_NEAR(surface->distance, glm::distance(surface->where.position, vec3(1.5f, 2.5f, 3.5f)), 1e-4f);
  }
}

}  // namespace
}  // namespace candela
