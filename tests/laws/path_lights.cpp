#include <gtest/gtest.h>

#include <cmath>

#include "unit/path/scenes.h"

// Direct light on a Lambertian plane has closed forms.

namespace candela {
namespace {

using namespace test;

constexpr float kHalf = 2.0f;  ///< metres shown to each side
constexpr int kSize = 16;
const vec3 kAlbedo(0.6f, 0.4f, 0.2f);

/// Where the middle of a pixel of from_above(…, kHalf) lies on y = 0.
vec3 ground(int x, int y, int size = kSize, float half = kHalf) {
  const float step = 2.0f * half / static_cast<float>(size);
  return {-half + step * (static_cast<float>(x) + 0.5f), 0.0f, -half + step * (static_cast<float>(y) + 0.5f)};
}

/// Largest relative departure of the picture of a plane under `light` from `irradiance` × albedo / π.
double departure(const Light& light, const mat4& where, const std::function<vec3(vec3)>& irradiance) {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 10.0f), matte(kAlbedo));
  b.add_light(light, where);
  const Film film = shoot(b.build(), dark_environment(), from_above(0.5f, kHalf), centred(kSize, 1, 1));
  double largest = 0.0;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const vec3 expected = irradiance(ground(x, y)) * kAlbedo / kPi;
      const vec3 found = film.beauty.rgb(x, y);
      for (int i = 0; i < 3; ++i) {
        largest = std::max(largest, std::abs(static_cast<double>(found[i] - expected[i])) /
                                        std::max(static_cast<double>(expected[i]), 0.01));
      }
    }
  }
  return largest;
}

const vec3 kColor(1.0f, 0.8f, 0.5f);
const vec3 kLamp(0.4f, 2.0f, -0.3f);

vec3 point_irradiance(vec3 p) {
  const vec3 d = kLamp - p;
  const float d2 = glm::dot(d, d);
  return kColor * (30.0f * (d.y / std::sqrt(d2)) / d2);
}

TEST(law_path, point_light_falls_off_with_the_inverse_square_and_the_cosine) {
  EXPECT_LT(departure(point_light(kColor, 30.0f), translation(kLamp), point_irradiance), 1e-4);
  const auto no_cosine = [](vec3 p) { return point_irradiance(p) * glm::length(kLamp - p) / kLamp.y; };
  EXPECT_GT(departure(point_light(kColor, 30.0f), translation(kLamp), no_cosine), 1e-2);
}

TEST(law_path, scale_of_a_node_does_not_change_its_light) {
  EXPECT_LT(departure(point_light(kColor, 30.0f), translation(kLamp) * scaling(vec3(3.0f)), point_irradiance), 1e-4);
}

TEST(law_path, range_of_a_light_is_a_window_of_the_fourth_power) {
  Light light = point_light(kColor, 30.0f);
  light.range = 2.5f;
  const auto windowed = [](vec3 p) {
    const float q = glm::length(kLamp - p) / 2.5f;
    return point_irradiance(p) * glm::clamp(1.0f - q * q * q * q, 0.0f, 1.0f);
  };
  EXPECT_LT(departure(light, translation(kLamp), windowed), 1e-4);
  EXPECT_GT(departure(light, translation(kLamp), point_irradiance), 1e-2);
}

TEST(law_path, spot_light_fades_from_its_inner_to_its_outer_cone) {
  const vec3 target(-0.5f, 0.0f, 0.5f);
  const auto spot = [&](float inner, float outer) {
    return [=](vec3 p) {
      const float c = glm::dot(glm::normalize(p - kLamp), glm::normalize(target - kLamp));
      const float t = glm::clamp((c - std::cos(outer)) / (std::cos(inner) - std::cos(outer)), 0.0f, 1.0f);
      return point_irradiance(p) * t * t;
    };
  };
  const Light light = spot_light(kColor, 30.0f, 0.2f, 0.7f);
  EXPECT_LT(departure(light, aimed(kLamp, target), spot(0.2f, 0.7f)), 2e-4);
  EXPECT_GT(departure(light, aimed(kLamp, target), spot(0.2f, 0.72f)), 1e-2);
  EXPECT_GT(departure(light, aimed(kLamp, vec3(0.0f)), spot(0.2f, 0.7f)), 1e-2);
}

TEST(law_path, every_falloff_dims_a_point_by_its_law) {
  struct Kind {
    Falloff falloff;
    std::function<float(float d)> law;  // times d²
  };
  const auto window = [](float d) { return glm::clamp(1.0f - d * d * d * d / std::pow(2.5f, 4.0f), 0.0f, 1.0f); };
  const Kind kinds[] = {{Falloff::inverse_square, [](float) { return 1.0f; }},
                        {Falloff::gltf, [&](float d) { return window(d); }},
                        {Falloff::ue4, [&](float d) { return window(d) * window(d) * d * d / (d * d + 1.0f); }},
                        {Falloff::polynomial, [](float d) { return d * d / (0.5f * d * d + 0.25f * d + 2.0f); }}};
  for (const Kind& kind : kinds) {
    Light light = point_light(kColor, 30.0f);
    light.range = 2.5f;
    light.falloff = kind.falloff;
    light.polynomial = {0.5f, 0.25f, 2.0f};
    for (const Kind& law : kinds) {
      const auto expected = [&](vec3 p) { return point_irradiance(p) * law.law(glm::length(kLamp - p)); };
      const double found = departure(light, translation(kLamp), expected);
      if (law.falloff == kind.falloff) {
        EXPECT_LT(found, 1e-4) << static_cast<int>(kind.falloff);
      } else {
        EXPECT_GT(found, 1e-2) << static_cast<int>(kind.falloff) << " taken for " << static_cast<int>(law.falloff);
      }
    }
  }
}

// ----- profiles

/// A downlight with lobes that differ all around; its table is a law that the test can write down: linear in the
/// angles.
IesProfile lobed_profile() {
  IesProfile p;
  p.vertical_deg = {0.0f, 30.0f, 60.0f, 90.0f};
  p.horizontal_deg = {0.0f, 90.0f, 180.0f, 270.0f, 360.0f};
  p.candela = {60, 80, 30, 0, 60, 20, 10, 0, 60, 50, 40, 0, 60, 90, 5, 0, 60, 80, 30, 0};
  return p;
}

/// `departure` of a lamp with that profile, which hangs at kLamp, its +x along `x_axis` of the world and -z down.
double profile_departure(const mat4& where, const std::function<float(vec3 from_lamp)>& candela) {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 10.0f), matte(kAlbedo));
  b.scene().ies_profiles = {lobed_profile()};
  Light light = point_light(kColor, 0.5f);
  light.ies = 0;
  b.add_light(light, where);
  const Film film = shoot(b.build(), dark_environment(), from_above(0.5f, kHalf), centred(kSize, 1, 1));
  double largest = 0.0;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const vec3 p = ground(x, y);
      const vec3 from_lamp = p - kLamp;
      const float d2 = glm::dot(from_lamp, from_lamp);
      // E = I cos θ / d²
      const float lux = 0.5f * candela(from_lamp / std::sqrt(d2)) * (kLamp.y / std::sqrt(d2)) / d2;
      const vec3 expected = lux * kColor * kAlbedo / kPi;
      const vec3 found = film.beauty.rgb(x, y);
      for (int i = 0; i < 3; ++i) {
        largest =
            std::max(largest, static_cast<double>(std::abs(found[i] - expected[i]) / std::max(expected[i], 0.01f)));
      }
    }
  }
  return largest;
}

/// The table again, looked up in the plainest way: vertical angle from straight down, horizontal from world +x to -z.
float lobed_candela(vec3 d) {
  const IesProfile p = lobed_profile();
  const float v = degrees(std::acos(-d.y)) / 30.0f;
  const float h = std::fmod(degrees(std::atan2(-d.z, d.x)) + 360.0f, 360.0f) / 90.0f;
  const int i = std::min(static_cast<int>(v), 2), k = std::min(static_cast<int>(h), 3);
  const auto at = [&](int row, int column) { return p.candela[static_cast<std::size_t>(row * 4 + column)]; };
  const float s = v - static_cast<float>(i), t = h - static_cast<float>(k);
  return (1 - t) * ((1 - s) * at(k, i) + s * at(k, i + 1)) + t * ((1 - s) * at(k + 1, i) + s * at(k + 1, i + 1));
}

TEST(law_path, profile_lights_a_plane_by_its_candela_and_the_cosine) {
  // -z of the light turned to -y leaves +x where it is and takes +y to -z.
  const mat4 hung = translation(kLamp) * rotation({1, 0, 0}, -kPi / 2);
  EXPECT_LT(profile_departure(hung, lobed_candela), 1e-3);
  EXPECT_LT(profile_departure(hung * scaling({2.0f, 3.0f, 0.5f}), lobed_candela), 1e-3) << "scale changes nothing";
  const auto other_way_around = [](vec3 d) { return lobed_candela({d.x, d.y, -d.z}); };
  EXPECT_GT(profile_departure(hung, other_way_around), 0.05) << "horizontal angles clockwise";
  EXPECT_LT(profile_departure(hung * scaling({1, -1, 1}), other_way_around), 1e-3) << "a mirrored lamp";
  EXPECT_GT(profile_departure(hung, [](vec3 d) { return lobed_candela({-d.z, d.y, d.x}); }), 0.05) << "0 at +y";
  EXPECT_GT(profile_departure(hung, [](vec3) { return 60.0f; }), 0.05) << "no profile";
}

TEST(law_path, one_of_many_profiles_stands_for_all_of_them) {
  // A wall wash by lamps of unlike flux: the chance that each is chosen by must be divided out. Against the closed
  // form.
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 10.0f), matte(vec3(1.0f)));
  b.scene().ies_profiles = {lobed_profile()};
  double expected = 0.0;
  constexpr int kLamps = 40;  // more than are chosen one by one
  constexpr int kPixels = 8;
  for (int i = 0; i < kLamps; ++i) {
    const int from_middle = i - kLamps / 2;
    const vec3 at(0.1f * static_cast<float>(from_middle), 1.5f, -0.4f);
    Light light = point_light(vec3(1.0f), std::pow(1.2f, static_cast<float>(i)));
    light.ies = 0;
    b.add_light(light, translation(at) * rotation({1, 0, 0}, -kPi / 2));
    // Mean over the picture, by a midpoint sum.
    constexpr int kSteps = 64;
    for (int y = 0; y < kSteps; ++y) {
      for (int x = 0; x < kSteps; ++x) {
        const vec3 d = ground(x, y, kSteps, 1.0f) - at;
        const double d2 = static_cast<double>(glm::dot(d, d));
        const auto candela = static_cast<double>(light.intensity * lobed_candela(glm::normalize(d)));
        expected += candela * static_cast<double>(at.y) / (d2 * std::sqrt(d2)) / (M_PI * kSteps * kSteps);
      }
    }
  }
  const Moments m =
      mean_over_seeds(16, b.build(), dark_environment(), from_above(1.0f, 1.0f), settings(kPixels, 256, 1))[0];
  EXPECT_GT(z_test_p_value(m, expected, 1e-3 * expected), kFamilySignificance) << m.mean() << " expected " << expected;
  EXPECT_LT(z_test_p_value(m, 1.03 * expected, 1e-3 * expected), kFamilySignificance) << m.standard_error();
}

TEST(law_path, directional_light_gives_its_illuminance_times_the_cosine) {
  const vec3 towards = glm::normalize(vec3(1.0f, 2.0f, -0.7f));
  const auto expected = [&](vec3) { return kColor * (5.0f * towards.y); };
  EXPECT_LT(departure(sunlight(kColor, 5.0f), aimed(towards, vec3(0.0f)), expected), 1e-4);
  EXPECT_GT(departure(sunlight(kColor, 5.0f), aimed(-towards, vec3(0.0f)), expected), 1e-2);
}

TEST(law_path, one_of_many_lights_stands_for_all_of_them) {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 10.0f), matte(vec3(1.0f)));
  // Powers over three decades: the chance of each must be divided out.
  double expected = 0.0;
  for (int i = 0; i < 7; ++i) {
    const auto lux = static_cast<float>(std::pow(3.0, i));
    const vec3 towards = glm::normalize(vec3(0.3f * static_cast<float>(i - 3), 1.0f, 0.2f));
    b.add_light(sunlight(vec3(1.0f), lux), aimed(towards, vec3(0.0f)));
    expected += static_cast<double>(lux * towards.y / kPi);
  }
  const Moments m = mean_over_seeds(16, b.build(), dark_environment(), from_above(1.0f, 1.0f), settings(8, 64, 1))[0];
  EXPECT_GT(z_test_p_value(m, expected, 1e-5 * expected), kFamilySignificance) << m.mean() << " expected " << expected;
  EXPECT_LT(z_test_p_value(m, 1.02 * expected), kFamilySignificance) << m.standard_error();
}

// ----- area lights

/// Form factor from a point with normal +y to a rectangle `a` × `b` parallel to it at height `h`, one corner straight
/// above. Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", B-3.
double corner_form_factor(double a, double b, double h) {
  const double x = a / h, y = b / h;
  const double u = std::sqrt(1.0 + x * x), v = std::sqrt(1.0 + y * y);
  return (x / u * std::atan(y / u) + y / v * std::atan(x / v)) / (2.0 * static_cast<double>(kPi));
}

/// From `p` to the rectangle [x0,x1] × [z0,z1] at height h.
double form_factor(vec3 p, double x0, double x1, double z0, double z1, double h) {
  const auto signed_corner = [&](double x, double z) {
    const double dx = x - static_cast<double>(p.x), dz = z - static_cast<double>(p.z);
    return std::copysign(1.0, dx) * std::copysign(1.0, dz) * corner_form_factor(std::abs(dx), std::abs(dz), h);
  };
  return signed_corner(x1, z1) - signed_corner(x0, z1) - signed_corner(x1, z0) + signed_corner(x0, z0);
}

/// A lamp [-0.5, 0.5]² at height 1 that shines down.
Primitive ceiling_lamp() { return quad({-0.5f, 1.0f, -0.5f}, {1, 0, 0}, {0, 0, 1}); }

TEST(law_path, square_lamp_lights_a_plane_by_its_form_factor) {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 10.0f), matte(kAlbedo));
  b.add(ceiling_lamp(), lamp(vec3(4.0f)));
  const Scene scene = b.build();
  for (const auto integrator : {path::Integrator::full, path::Integrator::minimal}) {
    const bool is_full = integrator == path::Integrator::full;
    double worst = 0.0;
    const Moments ratio = over_seeds(8, [&](std::uint32_t seed) {
      path::Settings s = centred(kSize, is_full ? 128 : 512, 1);
      s.integrator = integrator;
      s.seed = seed;
      const Image image = shoot(scene, dark_environment(), from_above(0.9f, kHalf), s).beauty;
      double found = 0.0, expected = 0.0, squares = 0.0;
      for (int y = 0; y < kSize; ++y) {
        for (int x = 0; x < kSize; ++x) {
          const double e = 4.0 * static_cast<double>(kAlbedo.y) * form_factor(ground(x, y), -0.5, 0.5, -0.5, 0.5, 1.0);
          const auto f = static_cast<double>(image.rgb(x, y).y);
          found += f, expected += e;
          squares += std::pow((f - e) / e, 2.0);
        }
      }
      worst = std::max(worst, std::sqrt(squares / (kSize * kSize)));
      return found / expected;
    });
    EXPECT_GT(z_test_p_value(ratio, 1.0, 1e-5), sidak_threshold(2)) << ratio.mean() << " ± " << ratio.standard_error();
    EXPECT_LT(z_test_p_value(ratio, is_full ? 1.01 : 1.03), sidak_threshold(2)) << ratio.standard_error();
    // Pixel by pixel; the lamp fills from 1 to 25 % of what a point sees.
    EXPECT_LT(worst, is_full ? 0.03 : 0.3);
  }
}

TEST(law_path, parallel_unit_squares_have_their_form_factor) {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 10.0f), matte(vec3(1.0f)));
  b.add(ceiling_lamp(), lamp(vec3(1.0f)));
  const Moments m = mean_over_seeds(16, b.build(), dark_environment(), from_above(0.9f, 0.5f), settings(16, 64, 1))[0];
  EXPECT_GT(z_test_p_value(m, 0.199825, 1e-5), kFamilySignificance) << m.mean() << " ± " << m.standard_error();
  EXPECT_LT(z_test_p_value(m, 0.2008, 1e-5), kFamilySignificance) << m.standard_error();
}

TEST(law_path, lamps_of_one_side_leave_the_other_dark) {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 10.0f), matte(vec3(1.0f)));
  b.add(turned_inside_out(ceiling_lamp()), lamp(vec3(1.0f)));
  EXPECT_EQ(mean_luminance(shoot(b.build(), dark_environment(), from_above(0.9f, 0.5f), settings(8, 16, 4)).beauty),
            0.0);
  Material both = lamp(vec3(1.0f));
  both.double_sided = true;
  SceneBuilder c;
  c.add(plane(vec3(0.0f), 10.0f), matte(vec3(1.0f)));
  c.add(turned_inside_out(ceiling_lamp()), both);
  const Moments m = mean_over_seeds(16, c.build(), dark_environment(), from_above(0.9f, 0.5f), settings(16, 64, 1))[0];
  EXPECT_GT(z_test_p_value(m, 0.199825, 1e-5), kFamilySignificance) << m.mean() << " ± " << m.standard_error();
}

// ----- suns

Environment sun_environment(vec3 towards, float radius, float radiance) {
  Environment e;
  SunDisc sun;
  sun.direction = glm::normalize(towards);
  sun.angular_radius = radius;
  sun.radiance = vec3(radiance);
  e.suns.push_back(sun);
  return e;
}

TEST(law_path, sun_disc_gives_radiance_times_solid_angle_times_cosine) {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 10.0f), matte(vec3(1.0f)));
  for (const float radius : {0.00465f, 0.1f}) {
    const vec3 towards = glm::normalize(vec3(0.5f, 1.0f, 0.2f));
    const double solid_angle = 4.0 * M_PI * std::pow(std::sin(0.5 * static_cast<double>(radius)), 2.0);
    // The mean cosine over the cap is cos θ (1 + cos r) / 2.
    const double expected = 1000.0 * solid_angle * static_cast<double>(towards.y) * 0.5 *
                            (1.0 + std::cos(static_cast<double>(radius))) / M_PI;
    const Moments m = mean_over_seeds(8, b.build(), sun_environment(towards, radius, 1000.0f), from_above(1.0f, 1.0f),
                                      settings(8, 32, 1))[0];
    EXPECT_GT(z_test_p_value(m, expected, 1e-4 * expected), sidak_threshold(2)) << m.mean() << " expected " << expected;
    EXPECT_LT(z_test_p_value(m, 1.01 * expected, 1e-4 * expected), sidak_threshold(2)) << m.standard_error();
  }
}

TEST(law_path, environment_rotation_turns_the_sun_as_the_reference_does) {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 10.0f), matte(vec3(1.0f)));
  // A wall at x = 0 shades one half of the ground when the sun is on the other side.
  b.add(quad({0, 0, -5}, {0, 5, 0}, {0, 0, 10}), matte(vec3(0.0f)));
  Environment e = sun_environment({1.0f, 1.0f, 0.0f}, 0.01f, 1000.0f);
  for (const float turn : {0.0f, kPi}) {
    e.rotation = turn;
    const Image image = shoot(b.build(), e, from_above(6.0f, 2.0f), settings(8, 8, 1)).beauty;
    const double left = mean_of(image, {0, 0, 3, 8}).y;
    const double right = mean_of(image, {5, 0, 8, 8}).y;
    EXPECT_EQ(std::min(left, right), 0.0);
    EXPECT_NEAR(turn == 0.0f ? right : left, 0.1 * std::sqrt(0.5), 1e-3);
  }
}

TEST(law_path, sun_disc_casts_a_penumbra_of_its_width) {
  // An edge 1 m above the ground: full light beyond tan r to one side, none to the other, and the area of the disc that
  // is past the edge in between.
  constexpr float kRadius = 0.2f;
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 30.0f), matte(vec3(1.0f)));
  Material black = matte(vec3(0.0f));
  black.double_sided = true;
  b.add(quad({0, 1, -20}, {0, 0, 40}, {20, 0, 0}), black);
  path::Settings s = centred(16, 512, 1);
  s.height = 1;
  View view = from_above(0.5f, 0.4f);
  std::get<OrthographicCamera>(view.projection).ymag = 0.01f;
  const Image image = shoot(b.build(), sun_environment({0, 1, 0}, kRadius, 1.0f), view, s).beauty;
  const double full = M_PI * std::pow(std::sin(static_cast<double>(kRadius)), 2.0) / M_PI;
  for (int i = 0; i < 16; ++i) {
    const double x = -0.4 + 0.05 * (i + 0.5);
    // The edge cuts the disc at the plane through the point and the edge; projected to the ground (the cosine makes
    // areas of the unit disc) it is a circle of radius sin r cut at the sine of the angle to the edge.
    const double r = std::sin(static_cast<double>(kRadius));
    const double offset = std::min(std::max(-x / std::sqrt(1.0 + x * x), -r), r) / r;
    // The plane cuts the sphere in a great circle: its projection is half an ellipse, to first order a chord.
    const double seen = (std::acos(-offset) + offset * std::sqrt(1.0 - offset * offset)) / M_PI;
    EXPECT_NEAR(static_cast<double>(image.rgb(i, 0).x) / full, seen, 0.03) << "x = " << x;
  }
  EXPECT_NEAR(static_cast<double>(image.rgb(0, 0).x), full, 1e-4);
  EXPECT_EQ(image.rgb(15, 0).x, 0.0f);
}

TEST(law_path, sun_disc_is_visible_to_the_camera) {
  const vec3 towards = glm::normalize(vec3(0.3f, 0.8f, -0.6f));
  Environment e = sun_environment(towards, 0.05f, 50.0f);
  e.constant = vec3(0.25f);
  SceneBuilder b;
  const Image image = shoot(b.build(), e, look_at(vec3(0.0f), towards, 0.3f), settings(64, 16, 2)).beauty;
  EXPECT_EQ(image.rgb(32, 32), vec3(50.25f));
  EXPECT_EQ(image.rgb(2, 2), vec3(0.25f));
  // Its area in the picture: π tan² r over the picture's (2 tan ½ fov)².
  const double fraction = M_PI * std::pow(std::tan(0.05) / (2.0 * std::tan(0.15)), 2.0);
  EXPECT_NEAR(mean_luminance(image), 0.25 + 50.0 * fraction, 0.02 * 50.0 * fraction);
}

TEST(law_path, mirrors_show_lights_as_bright_as_they_are) {
  // Nothing but the mirror can find them that way: no part of that light may be left to next-event estimation.
  Environment sky = mapped_environment(32, 16, [](vec3 d) { return vec3(d.y > 0.6f ? 4.0f : 0.1f); });
  SunDisc sun;
  sun.direction = {0, 1, 0};
  sun.angular_radius = 0.5f;
  sun.radiance = vec3(3.0f);
  sky.suns.push_back(sun);
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 10.0f), metal(vec3(1.0f), 0.0f));
  // The orthographic camera looks straight down; its mirror image straight up.
  const Image up = shoot(b.build(), sky, from_above(0.5f, 0.4f), settings(4, 4, 1)).beauty;
  for (const float v : {up.rgb(0, 0).x, up.rgb(3, 2).y}) EXPECT_NEAR(v, 7.0f, 1e-4f);
  b.add(ceiling_lamp(), lamp(vec3(5.0f)));
  const Image below_lamp = shoot(b.build(), sky, from_above(0.9f, 0.4f), settings(4, 4, 1)).beauty;
  for (const float v : {below_lamp.rgb(0, 0).x, below_lamp.rgb(3, 2).y}) EXPECT_NEAR(v, 5.0f, 1e-4f);
}

}  // namespace
}  // namespace candela
