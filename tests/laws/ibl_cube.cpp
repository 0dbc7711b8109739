// Panorama to cube and back: what must hold whatever the picture is.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ibl/cube.h"
#include "ibl/sampling.h"
#include "ibl/verify.h"
#include "laws/ibl_scenes.h"
#include "laws/quadrature.h"
#include "shade/cube.glsl.h"

namespace candela::laws {
namespace {

double change(dvec3 before, dvec3 after) { return glm::length(after - before) / glm::length(before); }

/// The mistake that is common: one lookup at the middle of each texel.
CubeFaces point_sampled(const ibl::Source& source, int size) {
  CubeFaces faces = make_cube_faces(size);
  for (int f = 0; f < 6; ++f) {
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        faces[static_cast<std::size_t>(f)].set_rgb(
            x, y, vec3(ibl::radiance_at(source, ibl::cube_texel_direction(f, x, y, size))));
      }
    }
  }
  return faces;
}

TEST(law_ibl_cube, texels_have_the_solid_angle_of_their_density) {
  double sum = 0.0;
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 5; ++x) {
      const double exact = cube_texel_solid_angle(5, x, y);
      sum += 6.0 * exact;
      const double by_density = laws::integrate(
          [&](double t) {
            return laws::integrate(
                [&](double s) {
                  return static_cast<double>(
                      shade::cube_solid_angle_density(static_cast<float>(s), static_cast<float>(t)));
                },
                2.0 * x / 5 - 1.0, 2.0 * (x + 1) / 5 - 1.0, 1e-7);
          },
          2.0 * y / 5 - 1.0, 2.0 * (y + 1) / 5 - 1.0, 1e-7);
      EXPECT_NEAR(exact, by_density, 1e-6);
    }
  }
  EXPECT_NEAR(sum, 4.0 * std::numbers::pi, 1e-12);
}

TEST(law_ibl_cube, energy_before_is_energy_after) {
  ibl::Source source = sun_and_sky(96);
  source.rotation = 0.4;
  source.suns.push_back({glm::normalize(vec3(-0.2f, 0.5f, 0.9f)), 0.0047f, vec3(3e4f)});
  const dvec3 before = ibl::total_flux(source);
  for (const int size : {1, 3, 16, 40}) {
    EXPECT_LT(change(before, ibl::total_flux(ibl::cube_from_source(source, size))), 1e-7) << size;
  }
  EXPECT_GT(change(before, ibl::total_flux(point_sampled(source, 16))), 0.01);
}

TEST(law_ibl_cube, a_constant_stays_that_constant) {
  const ibl::Source source = panorama(50, [](dvec3) { return dvec3(2.0, 1.0, 0.25); });
  for (const int size : {1, 7, 32}) {
    for (const Image& face : ibl::cube_from_source(source, size)) {
      for (std::size_t i = 0; i < face.pixels.size(); i += 3) EXPECT_NEAR(face.pixels[i], 2.0f, 1e-6f);
    }
  }
}

TEST(law_ibl_cube, every_texel_is_the_mean_over_its_area) {
  // Texels that have nothing to do with each other.
  ibl::Source source = panorama(32, [](dvec3 d) { return dvec3(0.5 + 0.5 * std::sin(1e4 * d.x + 3e4 * d.y + d.z)); });
  source.rotation = -1.3;
  constexpr int kSize = 4, kFine = 256;
  const CubeFaces faces = ibl::cube_from_source(source, kSize), points = point_sampled(source, kSize);
  double wrong = 0.0;
  for (int f = 0; f < 6; ++f) {
    for (int k = 0; k < kSize * kSize; ++k) {
      dvec3 sum(0.0);
      for (int j = 0; j < kFine * kFine; ++j) {
        const int x = k % kSize * kFine + j % kFine, y = k / kSize * kFine + j / kFine;
        sum += ibl::radiance_at(source, ibl::cube_texel_direction(f, x, y, kSize * kFine)) *
               cube_texel_solid_angle(kSize * kFine, x, y);
      }
      const double mean = sum.x / cube_texel_solid_angle(kSize, k % kSize, k / kSize);
      const auto value = [&](const CubeFaces& cube) {
        return static_cast<double>(cube[static_cast<std::size_t>(f)].rgb(k % kSize, k / kSize).x);
      };
      EXPECT_NEAR(value(faces), mean, 2.5e-3) << f << ' ' << k;
      wrong = std::max(wrong, std::abs(value(points) - mean));
    }
  }
  EXPECT_GT(wrong, 0.1);
}

TEST(law_ibl_cube, the_way_back_keeps_energy_and_constants) {
  const CubeFaces faces = ibl::cube_from_source(sun_and_sky(64), 12);
  ibl::Source back;
  for (const int width : {8, 30, 96}) {
    back.map = ibl::equirect_from_cube(faces, width);
    EXPECT_LT(change(ibl::total_flux(faces), ibl::total_flux(back)), 1e-6) << width;
  }
  CubeFaces white = make_cube_faces(6);
  for (Image& face : white) std::fill(face.pixels.begin(), face.pixels.end(), 1.0f);
  for (const float v : ibl::equirect_from_cube(white, 24).pixels) EXPECT_NEAR(v, 1.0f, 1e-6f);
}

TEST(law_ibl_cube, mips_keep_energy) {
  const Cubemap cube = ibl::cube_mips(ibl::cube_from_source(sun_and_sky(64), 16));
  ASSERT_EQ(cube.levels.size(), 5U);
  for (const CubeFaces& level : cube.levels) {
    EXPECT_LT(change(ibl::total_flux(cube.levels[0]), ibl::total_flux(level)), 1e-6);
  }
  // Without the weights of solid angle it is lost.
  CubeFaces box = make_cube_faces(8);
  for (std::size_t f = 0; f < 6; ++f) {
    for (int y = 0; y < 8; ++y) {
      for (int x = 0; x < 8; ++x) {
        vec3 sum(0.0f);
        for (int k = 0; k < 4; ++k) sum += cube.levels[0][f].rgb(2 * x + k % 2, 2 * y + k / 2);
        box[f].set_rgb(x, y, 0.25f * sum);
      }
    }
  }
  EXPECT_GT(change(ibl::total_flux(cube.levels[0]), ibl::total_flux(box)), 1e-4);
}

TEST(law_ibl_cube, neighbours_are_mutual) {
  constexpr int kSize = 4;
  for (int face = 0; face < 6; ++face) {
    for (int i = 0; i < kSize; ++i) {
      const ivec2 off[] = {{-1, i}, {kSize, i}, {i, -1}, {i, kSize}};
      for (const ivec2 at : off) {
        const ibl::CubeTexel there = ibl::cube_neighbour(face, at.x, at.y, kSize);
        EXPECT_NE(there.face, face);
        const ivec2 own(std::clamp(at.x, 0, kSize - 1), std::clamp(at.y, 0, kSize - 1));
        int back = 0;
        for (const ivec2 step : {ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1)}) {
          const ivec2 beyond = ivec2(there.x, there.y) + step;
          const bool is_x = beyond.x < 0 || beyond.x >= kSize, is_y = beyond.y < 0 || beyond.y >= kSize;
          if (is_x == is_y) continue;
          const ibl::CubeTexel here = ibl::cube_neighbour(there.face, beyond.x, beyond.y, kSize);
          back += here.face == face && here.x == own.x && here.y == own.y ? 1 : 0;
        }
        EXPECT_EQ(back, 1) << face << ' ' << at.x << ' ' << at.y;
      }
    }
  }
}

TEST(law_ibl_cube, lookups_have_no_seam) {
  const CubeFaces faces =
      ibl::cube_from_source(panorama(128, [](dvec3 d) { return dvec3(2.0 + d.x + 0.5 * d.y * d.z); }), 16);
  const auto jump = [&](const std::function<vec3(dvec3)>& lookup) {
    double most = 0.0;
    for (int i = 0; i < 200; ++i) {
      const double t = 2.0 * (i + 0.37) / 200 - 1.0;
      const dvec3 here = glm::normalize(dvec3(1.0, t, 1.0 - 1e-5)), there = glm::normalize(dvec3(1.0 - 1e-5, t, 1.0));
      most = std::max(most, static_cast<double>(std::abs(lookup(here).x - lookup(there).x)));
    }
    return most;
  };
  EXPECT_LT(jump([&](dvec3 d) { return ibl::cube_lookup(faces, d); }), 1e-3);
  // The mutant takes the texel of its own face alone.
  EXPECT_GT(jump([&](dvec3 d) {
              const vec3 at = shade::cube_coordinates(vec3(d));
              const auto cell = [](float s) { return std::min(static_cast<int>((s + 1.0f) * 8.0f), 15); };
              return faces[static_cast<std::size_t>(at.x)].rgb(cell(at.y), cell(at.z));
            }),
            0.01);
}

}  // namespace
}  // namespace candela::laws
