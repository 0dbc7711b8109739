#include "ibl/profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "base/error.h"
#include "unit/image/labelled_cube.h"

namespace candela::ibl {
namespace {

TEST(unit_ibl_profile, names_are_found_and_others_listed) {
  for (const Profile& profile : profiles()) EXPECT_EQ(&find_profile(profile.name), &profile);
  try {
    find_profile("nintendo");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(error.message().find("filament, three, babylon, khronos, bevy, godot, unreal, unity"), std::string::npos);
  }
}

/// Largest departure of level_of_roughness(roughness_of_level(level)) from the level, where roughness is within 0 to 1.
double inverse_error(
    const Profile& profile, const std::function<float(float)>& mistake = [](float r) { return r; }) {
  double worst = 0.0;
  for (const int size : {64, 256, 1024}) {
    for (const int levels : {5, 6, 9}) {
      for (int level = 1; level < levels; ++level) {
        const float r = mistake(roughness_of_level(profile, level, levels, size));
        if (r >= 1.0f) continue;  // levels beyond the roughest are never looked at
        const float back = level_of_roughness(profile, r, levels, size);
        worst = std::max(worst, static_cast<double>(std::abs(back - static_cast<float>(level))));
      }
    }
  }
  return worst;
}

TEST(unit_ibl_profile, roughness_and_level_are_inverse) {
  for (const Profile& profile : profiles()) {
    EXPECT_LT(inverse_error(profile), 1e-3) << profile.name;
    // The twin: alpha in place of roughness.
    EXPECT_GT(inverse_error(profile, [](float r) { return r * r; }), 0.1) << profile.name;
  }
}

TEST(unit_ibl_profile, levels_grow_from_a_mirror_to_the_roughest) {
  for (const Profile& profile : profiles()) {
    float before = 0.0f;
    for (int level = 0; level < profile.levels; ++level) {
      const float r = roughness_of_level(profile, level, profile.levels, profile.size);
      EXPECT_TRUE(r >= before && r <= 1.0f) << profile.name;
      if (level == 0) {
        EXPECT_EQ(r, 0.0f);
      }
      before = r;
    }
    if (profile.levels > 1) {
      EXPECT_EQ(before, 1.0f) << profile.name;  // nothing rougher is left over
    }
    EXPECT_EQ(level_of_roughness(profile, 0.0f, 6, 256), 0.0f);
    EXPECT_LE(level_of_roughness(profile, 1.0f, 6, 256), 5.0f);
    EXPECT_EQ(roughness_of_level(profile, 0, 1, 256), 0.0f);
  }
}

// The formulas as the engines' shaders write them.
TEST(unit_ibl_profile, curves_are_those_of_the_shaders) {
  const auto level = [](const char* name, float r, int levels, int size) {
    return level_of_roughness(find_profile(name), r, levels, size);
  };
  const float r = 0.4f;
  EXPECT_FLOAT_EQ(level("filament", r, 5, 256), 4.0f * r * (2.0f - r));
  EXPECT_FLOAT_EQ(level("khronos", r, 6, 256), r * 5.0f);
  EXPECT_FLOAT_EQ(level("bevy", r, 9, 256), r * 8.0f);
  EXPECT_FLOAT_EQ(level("unity", r, 9, 256), 6.0f * r * (1.7f - 0.7f * r));
  EXPECT_FLOAT_EQ(level("godot", r, 8, 256), std::sqrt(r) * 7.0f);
  EXPECT_FLOAT_EQ(level("babylon", r, 9, 256), 0.8f * std::log2(256.0f * r * r));
  EXPECT_FLOAT_EQ(level("unreal", r, 9, 256), 9.0f - 1.0f - (1.0f - 1.2f * std::log2(r)));
}

/// The direction of the world in which an engine finds the middle of a texel, by what its shaders do with a direction.
using Lookup = vec3 (*)(vec3 world);
struct EngineLookup {
  const char* name;
  Lookup lookup;
};

TEST(unit_ibl_profile, each_engine_finds_the_directions_of_the_world) {
  const EngineLookup engines[] = {
      {"filament", [](vec3 d) { return d; }},
      {"three", [](vec3 d) { return vec3(-d.x, d.y, d.z); }},    // flipEnvMap
      {"babylon", [](vec3 d) { return vec3(-d.x, d.y, d.z); }},  // the root node of a glTF in a left-handed scene
      {"khronos", [](vec3 d) { return d; }},
      {"bevy", [](vec3 d) { return vec3(d.x, d.y, -d.z); }},
      {"godot", [](vec3 d) { return d; }},
      {"unreal", [](vec3 d) { return vec3(d.x, d.z, d.y); }},
      {"unity", [](vec3 d) { return vec3(-d.x, d.y, d.z); }},
  };
  ASSERT_EQ(std::size(engines), profiles().size());
  const CubeFaces world = test::labelled_faces(8);
  for (const EngineLookup& engine : engines) {
    const CubeFaces file = orient(find_profile(engine.name), world);
    for (int face = 0; face < 6; ++face) {
      for (int y = 0; y < 8; ++y) {
        for (int x = 0; x < 8; ++x) {
          const vec3 d = test::texel_direction(face, x, y, 8);
          const vec3 c = shade::cube_coordinates(engine.lookup(d));
          const auto texel = [](float s) { return static_cast<int>(std::floor((s + 1.0f) * 4.0f)); };
          ASSERT_EQ(file[static_cast<std::size_t>(c.x)].rgb(texel(c.y), texel(c.z)), d + 2.0f) << engine.name;
        }
      }
    }
  }
}

TEST(unit_ibl_profile, panoramas_are_turned_to_where_the_engine_looks) {
  // Each engine's u for a direction, from its source; v is acos(y) / π in all.
  const auto turn = [](double u) { return u - std::floor(u); };
  constexpr double kTwoPi = 2.0 * std::numbers::pi;
  const auto godot_u = [&](double x, double z) { return turn(std::atan2(x, -z) / kTwoPi); };
  const auto unity_u = [&](double x, double z) { return turn(1.0 - std::atan2(-x, -z) / kTwoPi); };
  const auto three_u = [&](double x, double z) { return turn(0.5 + std::atan2(z, x) / kTwoPi); };
  Image world(16, 2, 3);
  for (int x = 0; x < 16; ++x) {
    const double phi = ((x + 0.5) / 16.0 - 0.5) * kTwoPi;
    for (int y = 0; y < 2; ++y) world.set_rgb(x, y, vec3(dvec3(std::cos(phi), 0.0, std::sin(phi))));
  }
  const std::pair<const char*, std::function<double(double, double)>> engines[] = {
      {"godot", godot_u}, {"unity", unity_u}, {"three", three_u}};
  for (const auto& [name, u_of] : engines) {
    const Image turned = orient_panorama(find_profile(name), world);
    for (int x = 0; x < 16; ++x) {
      const vec3 d = turned.rgb(x, 1);
      EXPECT_NEAR(u_of(static_cast<double>(d.x), static_cast<double>(d.z)), (x + 0.5) / 16.0, 1e-6) << name;
    }
  }
  EXPECT_THROW(orient_panorama(find_profile("godot"), Image(10, 5, 3)), Error);
}

/// Orthonormal real harmonics of three bands, written out.
std::vector<double> basis(dvec3 d) {
  const double pi = std::numbers::pi;
  return {0.5 * std::sqrt(1 / pi),
          std::sqrt(0.75 / pi) * d.y,
          std::sqrt(0.75 / pi) * d.z,
          std::sqrt(0.75 / pi) * d.x,
          0.5 * std::sqrt(15 / pi) * d.x * d.y,
          0.5 * std::sqrt(15 / pi) * d.y * d.z,
          0.25 * std::sqrt(5 / pi) * (3 * d.z * d.z - 1),
          0.5 * std::sqrt(15 / pi) * d.z * d.x,
          0.25 * std::sqrt(15 / pi) * (d.x * d.x - d.y * d.y)};
}

TEST(unit_ibl_profile, diffuse_light_is_the_same_in_every_unit) {
  std::vector<dvec3> radiance(9);
  for (int i = 0; i < 9; ++i)
    radiance[static_cast<std::size_t>(i)] = dvec3(1.0 / (1 + i), 0.3 * i - 1.0, i == 0 ? 2.0 : -0.1 * i);
  const auto harmonics = convert_sh(DiffuseUnit::irradiance_over_pi, radiance);
  const auto p = convert_sh(DiffuseUnit::polynomial_over_pi, radiance);
  const auto q = convert_sh(DiffuseUnit::powers_over_pi, radiance);
  for (const dvec3 n :
       {dvec3(1, 0, 0), dvec3(0, -1, 0), glm::normalize(dvec3(1, 2, -3)), glm::normalize(dvec3(-3, 1, 1))}) {
    dvec3 expected(0.0);
    const std::vector<double> b = basis(n);
    // The cosine's factors over π, of degrees 0, 1 and 2.
    const double cosine[] = {1, 2.0 / 3, 2.0 / 3, 2.0 / 3, 0.25, 0.25, 0.25, 0.25, 0.25};
    for (std::size_t i = 0; i < 9; ++i) expected += cosine[i] * b[i] * radiance[i];
    dvec3 sum(0.0);
    for (std::size_t i = 0; i < 9; ++i) sum += b[i] * harmonics[i];
    EXPECT_LT(glm::length(sum - expected), 1e-12);
    // As Filament's shader has it.
    const dvec3 filament = p[0] + p[1] * n.y + p[2] * n.z + p[3] * n.x + p[4] * (n.y * n.x) + p[5] * (n.y * n.z) +
                           p[6] * (3.0 * n.z * n.z - 1.0) + p[7] * (n.z * n.x) + p[8] * (n.x * n.x - n.y * n.y);
    EXPECT_LT(glm::length(filament - expected), 1e-12);
    const dvec3 babylon = q[0] * n.x + q[1] * n.y + q[2] * n.z + q[3] * n.x * n.x + q[4] * n.y * n.y +
                          q[5] * n.z * n.z + q[6] * n.y * n.z + q[7] * n.z * n.x + q[8] * n.x * n.y;
    EXPECT_LT(glm::length(babylon - expected), 1e-12);
  }
}

TEST(unit_ibl_profile, constant_light_is_one_over_pi_of_its_irradiance) {
  // Radiance 1 everywhere: its only coefficient is √(4π), and E / π is 1.
  std::vector<dvec3> radiance(25, dvec3(0.0));
  radiance[0] = dvec3(std::sqrt(4.0 * std::numbers::pi));
  EXPECT_NEAR(convert_sh(DiffuseUnit::polynomial_over_pi, radiance)[0].x, 1.0, 1e-12);
  // Degrees 3 and 4 of the cosine: 0 and -1/24.
  for (std::size_t i = 1; i < 25; ++i) radiance[i] = dvec3(1.0);
  const auto diffuse = convert_sh(DiffuseUnit::irradiance_over_pi, radiance);
  EXPECT_EQ(diffuse[10].x, 0.0);
  EXPECT_NEAR(diffuse[20].x, -1.0 / 24.0, 1e-12);
  EXPECT_EQ(convert_sh(DiffuseUnit::radiance, radiance)[20].x, 1.0);
  EXPECT_THROW(convert_sh(DiffuseUnit::radiance, std::span(radiance).first(5)), Error);
  EXPECT_THROW(convert_sh(DiffuseUnit::polynomial_over_pi, std::span(radiance).first(4)), Error);
  EXPECT_THROW(convert_sh(DiffuseUnit::none, radiance), Error);
}

TEST(unit_ibl_profile, tables_are_arranged_as_the_shaders_look_them_up) {
  Image table(4, 2, 3);  // NoV along columns, roughness along rows: r = NoV index, g = roughness index
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x) table.set_rgb(x, y, vec3(x, 10.0f * static_cast<float>(y), 5.0f));
  const Image plain = arrange_table(*find_profile("khronos").table, table);
  EXPECT_EQ(plain.pixels, table.pixels);
  const Image three = arrange_table(*find_profile("three").table, table);
  EXPECT_EQ(ivec2(three.width, three.height), ivec2(2, 4));
  EXPECT_EQ(three.rgb(1, 3), vec3(3.0f, 10.0f, 5.0f));
  EXPECT_EQ(three.rgb(1, 0), vec3(0.0f, 10.0f, 5.0f));
  const Image babylon = arrange_table(*find_profile("babylon").table, table);
  EXPECT_EQ(babylon.rgb(3, 1), vec3(10.0f, 13.0f, 5.0f));  // mix(r, g, F0) of F0 3 + 10
  const Image filament = arrange_table(*find_profile("filament").table, table);
  EXPECT_EQ(filament.rgb(3, 0), vec3(10.0f, 13.0f, 5.0f));  // the first row is roughness 1
  EXPECT_EQ(filament.rgb(3, 1), vec3(0.0f, 3.0f, 5.0f));
}

TEST(unit_ibl_profile, files_are_what_the_profile_says_and_name_their_axes) {
  const Profile& bevy = find_profile("bevy");
  const TextureOptions options = texture_options(bevy);
  EXPECT_EQ(options.container, TextureContainer::ktx2);
  EXPECT_EQ(options.format, TexelFormat::rgb9e5);
  EXPECT_EQ(options.key_values.at("CandelaAxes"), "+x+y-z");
  EXPECT_EQ(texture_options(find_profile("filament")).container, TextureContainer::ktx1);
  EXPECT_TRUE(texture_options(find_profile("filament")).has_filament_type);
  EXPECT_TRUE(texture_options(find_profile("unity")).key_values.empty());  // DDS has none
  EXPECT_THROW(texture_options(find_profile("three")), Error);
  EXPECT_EQ(sh_lines(std::vector<dvec3>{{1, 0.5, 0}, {2, 3, 4}}), "1 0.5 0\n2 3 4\n");
}

}  // namespace
}  // namespace candela::ibl
