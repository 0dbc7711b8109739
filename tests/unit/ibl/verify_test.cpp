#include "ibl/verify.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace candela::ibl {
namespace {

TEST(verify, errors_are_relative_to_the_reference) {
  const std::vector<dvec3> directions = {{1, 0, 0}, {0, 1, 0}};
  const ErrorBound bound = compare({{1.0, 2.0, 2.0}, {3.3, 0.0, 0.0}}, {{1.0, 2.0, 2.0}, {3.0, 0.0, 0.0}}, directions);
  EXPECT_NEAR(bound.max, 0.1, 1e-12);
  EXPECT_NEAR(bound.rms, 0.1 / std::sqrt(2.0), 1e-12);
  EXPECT_EQ(bound.worst, dvec3(0, 1, 0));
  // Of two directions the chance that both are among the best 1 - x is (1 - x)².
  EXPECT_NEAR(std::pow(1.0 - bound.exceeding, 2), 1.0 - bound.confidence, 1e-12);
}

TEST(verify, light_where_there_is_none_is_wholly_wrong) {
  EXPECT_EQ(compare({dvec3(0.1)}, {dvec3(0.0)}, {dvec3(0, 1, 0)}).max, 1.0);
}

TEST(verify, the_reference_of_a_constant_is_that_constant) {
  Source source;
  source.map = Image(128, 64, 3);
  for (float& v : source.map.pixels) v = 3.0f;
  for (const double roughness : {0.2, 0.6, 1.0}) {
    for (const dvec3& v : reference(source, Kernel(Lobe::ggx, roughness), random_directions(4, 1))) {
      EXPECT_NEAR(v.x, 3.0, 1e-3) << roughness;
    }
  }
}

TEST(verify, the_reference_of_one_texel_is_the_lobe_there) {
  Source source;
  source.map = Image(512, 256, 3);
  source.map.set_rgb(100, 90, vec3(1.0f, 2.0f, 4.0f));
  const Kernel kernel(Lobe::ggx, 0.7);
  const dvec3 there = texel_direction(source, 100, 90);
  for (const dvec3& d : random_directions(16, 3)) {
    const double expected = kernel(1.0 - glm::dot(d, there)) * texel_solid_angle(90, 512, 256);
    EXPECT_NEAR(reference(source, kernel, {d})[0].z, 4.0 * expected, 1e-3 * expected + 1e-9);
  }
}

TEST(verify, a_wrong_level_is_seen) {
  Source source;
  source.map = Image(64, 32, 3);
  for (float& v : source.map.pixels) v = 1.0f;
  CubeFaces faces = make_cube_faces(8);
  for (Image& face : faces) {
    for (float& v : face.pixels) v = 1.03f;
  }
  const LevelProof proof = verify_level(source, Kernel(Lobe::ggx, 1.0), faces, 16, 1);
  EXPECT_NEAR(proof.at_texels.max, 0.03, 1e-3);
  EXPECT_NEAR(proof.between.max, 0.03, 1e-3);
}

}  // namespace
}  // namespace candela::ibl
