#include "path/camera.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random.h"
#include "support/statistics.h"
#include "unit/path/scenes.h"

namespace candela {
namespace {

using namespace test;

constexpr int kSize = 64;

View lens_view(float radius, float focus, int blades = 0) {
  View view;  // at the origin, looks along -z
  view.projection = PerspectiveCamera{.yfov = 0.6f, .aspect_ratio = {}};
  view.lens = {.radius = radius, .focus_distance = focus, .blades = blades, .vignetting = 0.0f};
  return view;
}

vec3 at_depth(const path::Ray& ray, float depth) {
  return ray.origin + ray.direction * ((-depth - ray.origin.z) / ray.direction.z);
}

/// Diameter of the bundle of rays through one film point, where it crosses a depth.
float bundle_diameter(const View& view, vec2 film, float depth) {
  const path::Camera camera(view, kSize, kSize);
  Pcg32 random(1);
  Box3 box;
  for (int i = 0; i < 20000; ++i) box.extend(at_depth(camera.generate(film, random.next_vec2()).ray, depth));
  return 0.5f * (box.size().x + box.size().y);
}

TEST(unit_path_camera, rays_meet_on_the_focus_plane_and_spread_off_it) {
  const View view = lens_view(0.1f, 3.0f);
  for (const vec2 film : {vec2(32, 32), vec2(3, 50)}) {
    EXPECT_LT(bundle_diameter(view, film, 3.0f), 1e-5f);
    // Similar triangles: diameter of the lens × |distance from focus| / focus.
    for (const float depth : {1.0f, 2.5f, 6.0f, 20.0f}) {
      const float expected = 0.2f * std::abs(depth - 3.0f) / 3.0f;
      EXPECT_NEAR(bundle_diameter(view, film, depth), expected, 5e-3f * expected);
    }
  }
}

/// Variance along x, in pixels², of the light in the picture of a small lamp on the axis.
double blur_variance(float radius, float focus, float depth, float lamp_half) {
  constexpr int kBlurSize = 32;
  SceneBuilder b;
  b.add(quad({-lamp_half, -lamp_half, -depth}, {2 * lamp_half, 0, 0}, {0, 2 * lamp_half, 0}), lamp(vec3(1.0f)));
  View view = lens_view(radius, focus);
  std::get<PerspectiveCamera>(view.projection).yfov = 0.3f;
  const Image image = shoot(b.build(), dark_environment(), view, settings(kBlurSize, 1024, 0)).beauty;
  double sum = 0.0, first = 0.0, second = 0.0;
  for (int y = 0; y < kBlurSize; ++y) {
    for (int x = 0; x < kBlurSize; ++x) {
      const auto v = static_cast<double>(image.rgb(x, y).x);
      const double px = x + 0.5 - 0.5 * kBlurSize;
      sum += v, first += v * px, second += v * px * px;
    }
  }
  return second / sum - std::pow(first / sum, 2.0);
}

TEST(unit_path_camera, blur_disc_has_the_diameter_of_the_circle_of_confusion) {
  // CoC = A |S2 - S1| / S2 on the focus plane S1, of an object at S2; a uniform disc has the variance d² / 16 per axis.
  constexpr double kFocus = 2.0, kRadius = 0.2, kLampHalf = 0.03;
  const double pixels_per_metre = 0.5 * 32 / (kFocus * std::tan(0.15));
  for (const double depth : {1.4, 3.0}) {
    const double disc = 2.0 * kRadius * std::abs(depth - kFocus) / depth * pixels_per_metre;
    const double lamp_width = 2.0 * kLampHalf * kFocus / depth * pixels_per_metre;
    const double expected = disc * disc / 16.0 + lamp_width * lamp_width / 12.0 + 1.0 / 12.0;
    const double found = blur_variance(static_cast<float>(kRadius), static_cast<float>(kFocus),
                                       static_cast<float>(depth), static_cast<float>(kLampHalf));
    EXPECT_NEAR(found, expected, 0.04 * expected) << depth;
  }
  // In focus: 3.18 pixels around a corner of four, so two pixels filled and two to 0.59, from ½ and 1½ away.
  EXPECT_NEAR(blur_variance(0.2f, 2.0f, 2.0f, 0.03f), (0.25 + 0.588 * 2.25) / 1.588, 0.01);
}

TEST(unit_path_camera, field_of_view_and_aspect_reach_the_corners) {
  const path::Camera camera(lens_view(0.0f, 1.0f), 80, 40);
  const vec3 corner = at_depth(camera.generate(vec2(0.0f), vec2(0.5f)).ray, 1.0f);
  const float t = std::tan(0.3f);
  EXPECT_NEAR(corner.x, -2.0f * t, 1e-6f);
  EXPECT_NEAR(corner.y, t, 1e-6f);
  const vec3 centre = camera.generate(vec2(40, 20), vec2(0.5f)).ray.direction;
  EXPECT_NEAR(glm::length(centre - vec3(0, 0, -1)), 0.0f, 1e-6f);
}

TEST(unit_path_camera, orthographic_rays_are_parallel_and_cover_the_box) {
  View view;
  view.world_from_camera = translation({1, 2, 3});
  view.projection = OrthographicCamera{.xmag = 2.0f, .ymag = 0.5f};
  view.lens.vignetting = 1.0f;
  const path::Camera camera(view, 40, 10);
  for (const vec2 film : {vec2(0, 0), vec2(40, 10), vec2(13, 7)}) {
    const auto s = camera.generate(film, vec2(0.5f));
    EXPECT_EQ(s.ray.direction, vec3(0, 0, -1));
    EXPECT_EQ(s.weight, 1.0f);
    EXPECT_NEAR(s.ray.origin.x, 1.0f + 2.0f * (film.x / 20.0f - 1.0f), 1e-5f);
    EXPECT_NEAR(s.ray.origin.y, 2.0f + 0.5f * (1.0f - film.y / 5.0f), 1e-5f);
    EXPECT_NEAR(s.ray.origin.z, 3.0f, 1e-5f);
  }
}

TEST(unit_path_camera, rays_begin_and_end_at_the_planes) {
  View perspective = lens_view(0.0f, 1.0f), lens = lens_view(0.2f, 3.0f), orthographic = lens_view(0.0f, 1.0f);
  orthographic.projection = OrthographicCamera{.xmag = 2.0f, .ymag = 2.0f};
  for (View view : {perspective, lens, orthographic}) {
    const path::Camera::Sample open = path::Camera(view, kSize, kSize).generate(vec2(3, 50), vec2(0.9f, 0.3f));
    EXPECT_EQ(open.start, 0.0f);
    EXPECT_EQ(open.ray.t_max, kInfinity);
    view.near_plane = 0.7f, view.far_plane = 5.0f;
    const path::Camera camera(view, kSize, kSize);
    const path::Camera::Sample cut = camera.generate(vec2(3, 50), vec2(0.9f, 0.3f));
    EXPECT_EQ(cut.ray.direction, open.ray.direction);
    EXPECT_NEAR(cut.ray.origin.z, -0.7f, 1e-6f);
    EXPECT_NEAR((cut.ray.origin + cut.ray.direction * cut.ray.t_max).z, -5.0f, 1e-5f);
    EXPECT_NEAR(glm::length(cut.ray.origin - open.ray.origin), cut.start, 1e-6f);
    const Box3 origins = camera.origins();
    EXPECT_TRUE(glm::all(glm::lessThanEqual(origins.lower - 1e-5f, cut.ray.origin)) &&
                glm::all(glm::greaterThanEqual(origins.upper + 1e-5f, cut.ray.origin)));
  }
}

TEST(unit_path_camera, planes_hide_from_the_eye_alone) {
  // A mirror at z = 0 shows a lamp behind the eye, whose light casts shadows of what is beyond the far plane.
  SceneBuilder b;
  b.add(quad({-5, -5, 0}, {10, 0, 0}, {0, 10, 0}), metal(vec3(1.0f), 0.0f));
  b.add(turned_inside_out(quad({-5, -5, 9}, {10, 0, 0}, {0, 10, 0})), lamp({0.2f, 0.5f, 0.9f}));
  View view = lens_view(0.0f, 1.0f);
  view.world_from_camera = translation({0, 0, 4});
  view.near_plane = 3.0f, view.far_plane = 4.5f;
  const Film film = shoot(b.build(), dark_environment(), view, centred(8, 4, 3));
  EXPECT_LT(glm::length(film.beauty.rgb(4, 4) - vec3(0.2f, 0.5f, 0.9f)), 1e-3f);
  // A sheet of glass before the far plane does not lengthen the view.
  SceneBuilder sheet;
  Material glass = plastic(vec3(1.0f), 0.0f);
  glass.transmission = 1.0f, glass.specular = 0.0f, glass.double_sided = true;
  sheet.add(quad({-5, -5, 0}, {10, 0, 0}, {0, 10, 0}), glass);
  sheet.add(quad({-5, -5, -1}, {10, 0, 0}, {0, 10, 0}), unlit(vec3(1.0f)));
  for (const path::Integrator integrator : {path::Integrator::full, path::Integrator::minimal}) {
    path::Settings s = centred(8, 4, 4);
    s.integrator = integrator;
    EXPECT_EQ(shoot(sheet.build(), dark_environment(), view, s).beauty.rgb(4, 4), vec3(0.0f));
    view.far_plane = 5.5f;
    EXPECT_GT(shoot(sheet.build(), dark_environment(), view, s).beauty.rgb(4, 4).x, 0.9f);
    view.far_plane = 4.5f;
  }
}

TEST(unit_path_camera, vignetting_is_the_fourth_power_of_the_cosine) {
  View view = lens_view(0.0f, 1.0f);
  for (const float amount : {0.0f, 0.4f, 1.0f}) {
    view.lens.vignetting = amount;
    const path::Camera camera(view, kSize, kSize);
    for (const vec2 film : {vec2(32, 32), vec2(0, 0), vec2(10, 55)}) {
      const auto s = camera.generate(film, vec2(0.5f));
      EXPECT_NEAR(s.weight, 1.0f + amount * (std::pow(-s.ray.direction.z, 4.0f) - 1.0f), 1e-5f);
    }
  }
  view.lens.vignetting = 1.0f;
  SceneBuilder b;
  const Image image = shoot(b.build(), constant_environment(vec3(1.0f)), view, centred(kSize, 1, 1)).beauty;
  const float corner = std::tan(0.3f) * (1.0f - 1.0f / kSize);
  EXPECT_NEAR(image.rgb(0, 0).x, std::pow(1.0f + 2.0f * corner * corner, -2.0f), 1e-5f);
}

/// Positions on the aperture in units of its radius: the origin of a ray through the middle of the film.
vec2 aperture_point(const path::Camera& camera, vec2 u, float radius) {
  return vec2(camera.generate(vec2(0.5f * kSize), u).ray.origin) / radius;
}

TEST(unit_path_camera, round_aperture_is_sampled_uniformly) {
  const path::Camera camera(lens_view(0.3f, 2.0f), kSize, kSize);
  Pcg32 random(2);
  std::vector<double> observed(128, 0.0);  // 8 × 16 cells
  constexpr int kSamples = 50000;
  for (int i = 0; i < kSamples; ++i) {
    const vec2 p = aperture_point(camera, random.next_vec2(), 0.3f);
    const float r2 = glm::dot(p, p);
    ASSERT_LE(r2, 1.0001f);
    const int ring = std::min(static_cast<int>(r2 * 8.0f), 7);  // rings of equal area
    const int sector = std::min(static_cast<int>((std::atan2(p.y, p.x) / (2.0f * kPi) + 0.5f) * 16.0f), 15);
    observed[static_cast<std::size_t>(ring * 16 + sector)] += 1.0;
  }
  const std::vector<double> expected(observed.size(), kSamples / static_cast<double>(observed.size()));
  EXPECT_GT(chi_square_test(observed, expected).p_value, kFamilySignificance);
}

bool is_in_polygon(vec2 p, int corners, float slack) {
  for (int i = 0; i < corners; ++i) {
    const float middle = 2.0f * kPi * (static_cast<float>(i) + 0.5f) / static_cast<float>(corners);
    const vec2 outward(std::cos(middle), std::sin(middle));
    if (glm::dot(p, outward) > std::cos(kPi / static_cast<float>(corners)) + slack) return false;
  }
  return true;
}

TEST(unit_path_camera, bladed_aperture_is_sampled_uniformly_inside_its_polygon) {
  for (const int blades : {3, 5, 6, 9}) {
    const path::Camera camera(lens_view(0.3f, 2.0f, blades), kSize, kSize);
    constexpr int kGrid = 10, kCells = kGrid * kGrid, kSamples = 100000, kFine = 40;
    std::vector<double> observed(kCells, 0.0), expected(kCells, 0.0);
    const auto cell = [](vec2 p) {
      const ivec2 i = glm::clamp(ivec2(glm::floor((p + 1.0f) * (0.5f * kGrid))), ivec2(0), ivec2(kGrid - 1));
      return static_cast<std::size_t>(i.y * kGrid + i.x);
    };
    Pcg32 random(4);
    for (int i = 0; i < kSamples; ++i) {
      const vec2 p = aperture_point(camera, random.next_vec2(), 0.3f);
      ASSERT_TRUE(is_in_polygon(p, blades, 1e-5f)) << p.x << " " << p.y;
      observed[cell(p)] += 1.0;
    }
    double inside = 0.0;
    constexpr int kSteps = kGrid * kFine;
    for (int y = 0; y < kSteps; ++y) {
      for (int x = 0; x < kSteps; ++x) {
        const vec2 p = (vec2(x, y) + 0.5f) * (2.0f / kSteps) - 1.0f;
        if (!is_in_polygon(p, blades, 0.0f)) continue;
        expected[cell(p)] += 1.0;
        inside += 1.0;
      }
    }
    // Cells at the rim are known to the quadrature's grid only; take those that are well filled.
    std::vector<double> o(1, 0.0), e(1, 0.0);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const bool is_whole = expected[i] == kFine * kFine;
      (is_whole ? o.emplace_back(0.0) : o[0]) += observed[i];
      (is_whole ? e.emplace_back(0.0) : e[0]) += expected[i] / inside * kSamples;
    }
    EXPECT_GT(chi_square_test(o, e).p_value, sidak_threshold(4)) << blades << " blades";
  }
}

}  // namespace
}  // namespace candela
