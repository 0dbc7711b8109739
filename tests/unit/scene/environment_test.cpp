#include "scene/environment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "base/error.h"
#include "content/make_environment.h"
#include "image/film.h"
#include "image/image_file.h"
#include "scene/framing.h"
#include "shade/sky.glsl.h"
#include "unit/base/temp_folder.h"

namespace candela {
namespace {

vec3 from_azimuth(float azimuth_deg, float elevation_deg) {
  const float a = radians(azimuth_deg), e = radians(elevation_deg);
  return {std::cos(e) * std::sin(a), std::sin(e), std::cos(e) * std::cos(a)};
}

/// Direction that a pixel's centre stands for, by the formula of scene.h.
vec3 pixel_direction(const Image& map, int x, int y) {
  const float azimuth = ((static_cast<float>(x) + 0.5f) / static_cast<float>(map.width) - 0.5f) * 2.0f * kPi;
  const float polar = (static_cast<float>(y) + 0.5f) / static_cast<float>(map.height) * kPi;
  return {std::sin(polar) * std::cos(azimuth), std::cos(polar), std::sin(polar) * std::sin(azimuth)};
}

float pixel_solid_angle(const Image& map, int y) {
  const float polar = (static_cast<float>(y) + 0.5f) / static_cast<float>(map.height) * kPi;
  return std::sin(polar) * 2.0f * kPi * kPi / static_cast<float>(map.width * map.height);
}

/// Illuminance on a surface facing `normal`, from the map alone.
vec3 irradiance(const Environment& environment, vec3 normal) {
  const Image& map = *environment.map;
  dvec3 sum(0.0);
  const int step = map.width > 512 ? 3 : 1;
  for (int y = step / 2; y < map.height; y += step)
    for (int x = step / 2; x < map.width; x += step)
      sum += dvec3(map.rgb(x, y)) * static_cast<double>(pixel_solid_angle(map, y) *
                                                        std::max(0.0f, glm::dot(pixel_direction(map, x, y), normal)));
  return vec3(sum) * static_cast<float>(step * step);
}

vec3 sun_illuminance(const Environment& environment) {
  if (environment.suns.empty()) return vec3(0.0f);
  const SunDisc& sun = environment.suns.front();
  return sun.radiance * (2.0f * kPi * (1.0f - std::cos(sun.angular_radius)));
}

Environment with_map(Image map) {
  Environment environment;
  environment.map = std::make_shared<const Image>(std::move(map));
  return environment;
}

TEST(unit_scene_environment, a_pixel_is_seen_in_its_direction) {
  for (const ivec2 pixel : {ivec2(0, 0), ivec2(5, 3), ivec2(31, 8), ivec2(16, 15), ivec2(20, 7)}) {
    Image map(32, 16, 3);
    map.set_rgb(pixel.x, pixel.y, vec3(1, 2, 3));
    const vec3 d = pixel_direction(map, pixel.x, pixel.y);
    const vec3 seen = environment_radiance(with_map(map), d);
    EXPECT_NEAR(seen.x, 1.0f, 1e-4f) << pixel.x << ',' << pixel.y;
    EXPECT_NEAR(seen.z, 3.0f, 1e-3f);
  }
  // Middle of the map: +x; a quarter to the right: +z; top: +y.
  Image map(64, 32, 3);
  for (int y = 14; y < 18; ++y)
    for (int x = 46; x < 50; ++x) map.set_rgb(x, y, vec3(1.0f));
  EXPECT_NEAR(environment_radiance(with_map(map), vec3(0, 0, 1)).x, 1.0f, 1e-5f);
  EXPECT_EQ(environment_radiance(with_map(map), vec3(1, 0, 0)).x, 0.0f);
  EXPECT_EQ(environment_radiance(with_map(map), vec3(0, 1, 0)).x, 0.0f);
}

TEST(unit_scene_environment, lookup_is_bilinear_wraps_around_and_clamps_at_the_poles) {
  Image map(4, 2, 3);
  for (int x = 0; x < 4; ++x) {
    map.set_rgb(x, 0, vec3(static_cast<float>(x)));
    map.set_rgb(x, 1, vec3(10.0f + static_cast<float>(x)));
  }
  const Environment environment = with_map(map);
  const auto at = [&](float u, float v) {
    const float azimuth = (u - 0.5f) * 2.0f * kPi, polar = v * kPi;
    return environment_radiance(environment, vec3(std::sin(polar) * std::cos(azimuth), std::cos(polar),
                                                  std::sin(polar) * std::sin(azimuth)))
        .x;
  };
  EXPECT_NEAR(at(0.5f, 0.25f), 1.5f, 1e-4f) << "half way between pixels 1 and 2";
  EXPECT_NEAR(at(0.375f, 0.5f), 6.0f, 1e-4f) << "half way between the rows";
  EXPECT_NEAR(at(0.0001f, 0.25f), 1.5f, 2e-3f) << "half way between the last and the first pixel";
  EXPECT_NEAR(at(0.9999f, 0.25f), 1.5f, 2e-3f);
  EXPECT_NEAR(at(0.375f, 0.02f), 1.0f, 1e-4f) << "above the first row's centres nothing is mixed in";
  EXPECT_NEAR(at(0.375f, 0.98f), 11.0f, 1e-4f);
}

TEST(unit_scene_environment, rotation_is_counter_clockwise_seen_from_above) {
  Environment environment = make_environment("none");
  environment.suns.push_back({.direction = vec3(1, 0, 0), .angular_radius = 0.1f, .radiance = vec3(4.0f)});
  Image map(64, 32, 3);
  for (int y = 15; y < 17; ++y)
    for (int x = 31; x < 33; ++x) map.set_rgb(x, y, vec3(1.0f));
  environment.map = std::make_shared<const Image>(map);
  EXPECT_NEAR(environment_radiance(environment, vec3(1, 0, 0)).x, 5.0f, 1e-5f);
  // From above, x to the right and z downwards: +x turns to -z.
  environment.rotation = radians(90.0f);
  EXPECT_NEAR(environment_radiance(environment, vec3(0, 0, -1)).x, 5.0f, 1e-4f);
  EXPECT_EQ(environment_radiance(environment, vec3(0, 0, 1)).x, 0.0f);
  EXPECT_EQ(environment_radiance(environment, vec3(1, 0, 0)).x, 0.0f);
  environment.intensity = 3.0f;
  EXPECT_NEAR(environment_radiance(environment, vec3(0, 0, -1)).x, 15.0f, 1e-3f);
}

TEST(unit_scene_environment, furnace_is_one_and_none_is_black_everywhere) {
  const Environment furnace = make_environment("furnace"), none = make_environment("none");
  for (const vec3 d : {vec3(1, 0, 0), vec3(0, -1, 0), glm::normalize(vec3(1, 2, -3))}) {
    EXPECT_EQ(environment_radiance(furnace, d), vec3(1.0f));
    EXPECT_EQ(environment_radiance(none, d), vec3(0.0f));
  }
}

// IES Lighting Handbook, clear sky: direct normal 127.5 klx e^(-0.21 / sin h), diffuse 0.8 + 15.5 √(sin h) klx.
TEST(unit_scene_environment, sky_gives_the_illuminance_of_a_clear_day) {
  for (const float elevation : {20.0f, 35.0f, 45.0f, 60.0f, 90.0f}) {
    const Environment sky = make_environment("sky:" + std::to_string(elevation));
    const float sine = std::sin(radians(elevation));
    const float direct_klx = 10.0f * luminance(sun_illuminance(sky));
    const float diffuse_klx = 10.0f * luminance(irradiance(sky, vec3(0, 1, 0)));
    EXPECT_NEAR(direct_klx / (127.5f * std::exp(-0.21f / sine)), 1.0f, 0.12f) << elevation;
    EXPECT_NEAR(diffuse_klx / (0.8f + 15.5f * std::sqrt(sine)), 1.0f, 0.12f) << elevation;
  }
}

TEST(unit_scene_environment, sky_and_sun_together_are_white_daylight) {
  for (const float elevation : {30.0f, 45.0f, 60.0f}) {
    const Environment sky = make_environment("sky:" + std::to_string(elevation));
    const vec3 e = irradiance(sky, vec3(0, 1, 0)) + sun_illuminance(sky) * std::sin(radians(elevation));
    const float x = 0.4124f * e.x + 0.3576f * e.y + 0.1805f * e.z, y = luminance(e);
    const float z = 0.0193f * e.x + 0.1192f * e.y + 0.9505f * e.z;
    const vec2 xy(x / (x + y + z), y / (x + y + z));
    // CIE daylight locus between about 5000 and 6500 K.
    EXPECT_NEAR(xy.y, -3.0f * xy.x * xy.x + 2.87f * xy.x - 0.275f, 0.005f) << elevation;
    EXPECT_GT(xy.x, 0.313f) << elevation;
    EXPECT_LT(xy.x, 0.346f) << elevation;
  }
}

TEST(unit_scene_environment, sky_is_blue_by_day_and_red_at_sunset) {
  const Environment day = make_environment("sky:50"), evening = make_environment("sky:1.5");
  const vec3 zenith = environment_radiance(day, vec3(0, 1, 0));
  EXPECT_GT(zenith.z, 1.4f * zenith.y);
  EXPECT_GT(zenith.y, zenith.x);
  EXPECT_GT(luminance(zenith), 0.2f);
  EXPECT_LT(luminance(zenith), 0.8f);

  const auto redness = [](vec3 c) { return c.x / c.z; };
  EXPECT_GT(redness(sun_illuminance(evening)), 10.0f * redness(sun_illuminance(day)));
  EXPECT_LT(luminance(sun_illuminance(evening)), 0.1f * luminance(sun_illuminance(day)));
  const vec3 sun = evening.suns.front().direction;
  const vec3 beside = glm::normalize(vec3(sun.x, 0.06f, sun.z));
  const vec3 opposite = glm::normalize(vec3(-sun.x, 0.3f, -sun.z));
  const Environment& e = evening;
  EXPECT_GT(redness(environment_radiance(e, beside)), 2.0f * redness(environment_radiance(e, opposite)));
}

TEST(unit_scene_environment, sky_darkens_as_the_sun_sinks_and_keeps_a_glow_below_the_horizon) {
  float before = kInfinity;
  for (const char* name : {"sky:60", "sky:20", "sky:5", "sky:0", "sky:-2", "sky:-5"}) {
    const Environment sky = make_environment(name);
    const float e = luminance(irradiance(sky, vec3(0, 1, 0)));
    EXPECT_LT(e, before) << name;
    EXPECT_GT(e, 0.0f) << name;
    EXPECT_EQ(sky.suns.empty(), std::string(name) == "sky:0" || std::string(name).find('-') != std::string::npos);
    before = e;
  }
}

TEST(unit_scene_environment, sky_is_symmetric_about_the_plane_of_the_sun) {
  const Environment sky = make_environment("sky:25");
  const vec3 sun = sky.suns.front().direction;
  const vec3 across = glm::normalize(glm::cross(sun, vec3(0, 1, 0)));
  for (const vec3 d : {vec3(0.3f, 0.2f, 0.9f), vec3(-0.5f, 0.05f, 0.2f), vec3(0.1f, -0.4f, 0.3f)}) {
    const vec3 n = glm::normalize(d);
    const vec3 mirrored = n - 2.0f * glm::dot(n, across) * across;
    const vec3 a = environment_radiance(sky, n), b = environment_radiance(sky, mirrored);
    EXPECT_GT(std::abs(glm::dot(n, across)), 0.1f) << "the direction must not mirror onto itself";
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], 2e-3f * std::max(a[k], 1e-3f));
  }
}

TEST(unit_scene_environment, ground_below_the_sky_is_lit_by_sun_and_sky) {
  const Environment sky = make_environment("sky:40");
  const vec3 e = irradiance(sky, vec3(0, 1, 0)) + sun_illuminance(sky) * std::sin(radians(40.0f));
  const vec3 ground = environment_radiance(sky, vec3(0, -1, 0));
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(ground[k], 0.3f / kPi * e[k], 0.02f * ground[k]);
}

TEST(unit_scene_environment, sun_stands_to_the_front_right_of_the_default_camera) {
  const Environment sky = make_environment("sky:33");
  ASSERT_EQ(sky.suns.size(), 1u);
  const SunDisc& sun = sky.suns.front();
  EXPECT_NEAR(glm::length(sun.direction), 1.0f, 1e-5f);
  EXPECT_NEAR(degrees(std::asin(sun.direction.y)), 33.0f, 1e-3f);
  EXPECT_NEAR(degrees(sun.angular_radius), 0.2665f, 1e-4f);
  const View view = frame(Extent(Box3{vec3(-1), vec3(1)}), {.yfov = radians(35.0f), .margin = 0.04f});
  EXPECT_GT(glm::dot(sun.direction, vec3(view.world_from_camera[0])), 0.3f) << "right";
  EXPECT_GT(glm::dot(sun.direction, vec3(view.world_from_camera[2])), 0.3f) << "front";
  // Inside the disc its radiance is added, just outside it is not.
  const vec3 side = glm::normalize(glm::cross(sun.direction, vec3(0, 1, 0)));
  const auto off = [&](float radii) {
    return luminance(
        environment_radiance(sky, glm::normalize(sun.direction + std::tan(radii * sun.angular_radius) * side)));
  };
  EXPECT_GT(off(0.95f), 0.9f * luminance(sun.radiance));
  EXPECT_LT(off(1.05f), 0.01f * luminance(sun.radiance));
}

TEST(unit_scene_environment, sky_transmittance_table_coordinates_invert) {
  for (float v = 0.05f; v < 1.0f; v += 0.1f) {
    for (float u = 0.05f; u < 1.0f; u += 0.1f) {
      const vec2 r_mu = shade::sky_transmittance_r_mu(vec2(u, v));
      const vec2 uv = shade::sky_transmittance_uv(r_mu.x, r_mu.y);
      EXPECT_NEAR(uv.x, u, 2e-3f);
      EXPECT_NEAR(uv.y, v, 2e-3f);
    }
  }
}

TEST(unit_scene_environment, sky_phase_functions_integrate_to_one) {
  double rayleigh = 0.0, aerosol = 0.0;
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    const float c = -1.0f + 2.0f * (static_cast<float>(i) + 0.5f) / static_cast<float>(n);
    rayleigh += static_cast<double>(shade::sky_phase_rayleigh(c)) * 4.0 * 3.14159265358979 / n;
    aerosol += static_cast<double>(shade::sky_phase_aerosol(c)) * 4.0 * 3.14159265358979 / n;
  }
  EXPECT_NEAR(rayleigh, 1.0, 1e-4);
  EXPECT_NEAR(aerosol, 1.0, 1e-4);
}

TEST(unit_scene_environment, studio_lights_a_white_sphere_to_about_one) {
  const Environment studio = make_environment("studio");
  float brightest = 0.0f, darkest = kInfinity;
  for (int az = -60; az <= 60; az += 20) {
    for (int el = -10; el <= 80; el += 15) {
      const vec3 normal = from_azimuth(35.0f + static_cast<float>(az), static_cast<float>(el));
      const float radiance = luminance(irradiance(studio, normal)) / kPi;
      brightest = std::max(brightest, radiance);
      darkest = std::min(darkest, radiance);
    }
  }
  EXPECT_GT(brightest, 0.8f);
  EXPECT_LT(brightest, 1.2f);
  EXPECT_GT(darkest, 0.2f) << "shadows keep detail";
  EXPECT_LT(darkest, 0.65f * brightest) << "light with a direction";
}

TEST(unit_scene_environment, studio_has_bright_boxes_before_a_quiet_neutral_backdrop) {
  const Environment studio = make_environment("studio");
  float brightest = 0.0f;
  dvec3 sum(0.0);
  for (int y = 0; y < studio.map->height; ++y) {
    for (int x = 0; x < studio.map->width; ++x) {
      const vec3 c = studio.map->rgb(x, y);
      ASSERT_GT(std::min({c.x, c.y, c.z}), 0.05f) << "nothing is black";
      brightest = std::max(brightest, luminance(c));
      sum += dvec3(c) * static_cast<double>(pixel_solid_angle(*studio.map, y));
    }
  }
  EXPECT_GT(brightest, 7.0f);
  EXPECT_LT(brightest, 20.0f);
  EXPECT_NEAR(sum.x / sum.y, 1.0, 0.03) << "no colour cast";
  EXPECT_NEAR(sum.z / sum.y, 1.0, 0.03);
  // What the default camera sees behind its subject: no lamp, brightest in the middle, darker downwards.
  const auto behind = [&](float az, float el) {
    return luminance(environment_radiance(studio, -from_azimuth(35.0f + az, el)));
  };
  for (float az = -25.0f; az <= 25.0f; az += 5.0f)
    for (float el = 3.0f; el <= 37.0f; el += 4.0f) {
      EXPECT_GT(behind(az, el), 0.1f);
      EXPECT_LT(behind(az, el), 0.7f);
    }
  EXPECT_GT(behind(0.0f, 8.0f), 1.5f * behind(0.0f, 36.0f));
  EXPECT_GT(behind(0.0f, 8.0f), behind(40.0f, 8.0f));
}

TEST(unit_scene_environment, a_file_is_read_as_it_stands) {
  const test::TempFolder folder;
  Image map(8, 4, 3);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x) map.set_rgb(x, y, vec3(static_cast<float>(x + 1), static_cast<float>(y + 1), 0.5f));
  write_hdr(folder / "map.hdr", map);
  const Environment environment = make_environment((folder / "map.hdr").string());
  EXPECT_EQ(environment.name, "map.hdr");
  ASSERT_TRUE(environment.map);
  EXPECT_EQ(environment.map->channels, 3);
  const vec3 seen = environment_radiance(environment, pixel_direction(map, 6, 2));
  EXPECT_NEAR(seen.x, 7.0f, 0.03f);
  EXPECT_NEAR(seen.y, 3.0f, 0.03f);
}

void write_exr_map(const std::filesystem::path& path, int width, int height, float odd_value) {
  Film film;
  film.beauty = Image(width, height, 4);
  std::fill(film.beauty.pixels.begin(), film.beauty.pixels.end(), 1.0f);
  film.beauty.at(width / 2, height / 2)[1] = odd_value;
  write_exr(path, film);
}

TEST(unit_scene_environment, bad_files_are_errors_that_name_the_file) {
  const test::TempFolder folder;
  write_exr_map(folder / "good.exr", 8, 4, 2.0f);
  EXPECT_NO_THROW(make_environment((folder / "good.exr").string()));
  write_exr_map(folder / "square.exr", 8, 8, 2.0f);
  std::ofstream(folder / "text.hdr") << "this is no picture";
  for (const char* name : {"square.exr", "text.hdr", "absent.hdr", "absent.exr:albedo"}) {
    try {
      make_environment((folder / name).string());
      ADD_FAILURE() << name << " was accepted";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  }
}

TEST(unit_scene_environment, an_absent_layer_is_an_error_that_names_both) {
  const test::TempFolder folder;
  write_exr_map(folder / "good.exr", 8, 4, 2.0f);
  try {
    make_environment((folder / "good.exr:albedo").string());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.where(), (folder / "good.exr").string());
    EXPECT_NE(error.message().find("\"albedo\""), std::string::npos) << error.message();
  }
}

TEST(unit_scene_environment, texels_that_are_no_light_are_put_right_and_told) {
  const test::TempFolder folder;
  for (const auto& [value, expected] : {std::pair(-0.25f, 0.0f), {std::nanf(""), 0.0f}, {kInfinity, 1.0f}}) {
    const std::string path = (folder / "odd.exr").string();
    write_exr_map(path, 8, 4, value);
    Diagnostics diagnostics;
    const Environment environment = make_environment(path, &diagnostics);
    EXPECT_EQ(environment.map->rgb(4, 2), vec3(1.0f, expected, 1.0f));
    ASSERT_EQ(diagnostics.warnings().size(), 1U);
    EXPECT_EQ(diagnostics.warnings()[0].where, path);
    EXPECT_NE(diagnostics.warnings()[0].message.find("4,2"), std::string::npos) << diagnostics.warnings()[0].message;
    EXPECT_NO_THROW(make_environment(path)) << "nobody has to listen";
  }
}

TEST(unit_scene_environment, a_cube_map_lights_as_the_panorama_that_it_is_of) {
  const test::TempFolder folder;
  CubeFaces faces = make_cube_faces(16);
  for (std::size_t face = 0; face < 6; ++face)
    std::fill(faces[face].pixels.begin(), faces[face].pixels.end(), static_cast<float>(face + 1));
  write_linear_image(folder / "strip.exr",
                     layout_from_faces(file_from_world(faces, kPictureAxes), CubeLayout::strip_6x1));
  const Environment environment = make_environment((folder / "strip.exr").string());
  ASSERT_EQ(environment.map->width, 64);
  const std::array<vec3, 6> axes{vec3(1, 0, 0), {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (std::size_t face = 0; face < 6; ++face)
    EXPECT_NEAR(environment_radiance(environment, axes[face]).x, static_cast<float>(face + 1), 1e-4f) << face;
}

TEST(unit_scene_environment, bad_names_of_skies_are_errors) {
  for (const char* name : {"sky:", "sky:high", "sky:91", "sky:-6", "sky:nan", "sky:10deg", "sky: 10", "Sky", ""})
    EXPECT_THROW(make_environment(name), Error) << name;
}

}  // namespace
}  // namespace candela
