#include "image/primaries.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace candela {
namespace {

const Primaries kP3{{0.68, 0.32}, {0.265, 0.69}, {0.15, 0.06}, {0.3127, 0.3290}};
const Primaries kAcesCg{{0.713, 0.293}, {0.165, 0.830}, {0.128, 0.044}, {0.32168, 0.33767}};
const Primaries kAces{{0.7347, 0.2653}, {0.0, 1.0}, {0.0001, -0.0770}, {0.32168, 0.33767}};

TEST(unit_image_primaries, matrices_are_the_published_ones) {
  // ITU-R BT.709 and SMPTE EG 432-1 to four decimals; ACEScg by Bradford as the Academy's transforms have it.
  const mat3 p3 = *rec709_from_rgb(kP3);
  EXPECT_NEAR(glm::distance(p3[0], vec3(1.2249f, -0.0421f, -0.0196f)), 0.0f, 2e-4f);
  EXPECT_NEAR(glm::distance(p3[1], vec3(-0.2249f, 1.0421f, -0.0786f)), 0.0f, 2e-4f);
  const mat3 acescg = *rec709_from_rgb(kAcesCg);
  EXPECT_NEAR(glm::distance(acescg[0], vec3(1.7050f, -0.1302f, -0.0240f)), 0.0f, 2e-3f);
  EXPECT_NEAR(glm::distance(acescg[2], vec3(-0.0832f, -0.0105f, 1.1529f)), 0.0f, 2e-3f);
}

TEST(unit_image_primaries, what_is_neutral_stays_neutral) {
  for (const Primaries& p : {kP3, kAcesCg, kAces, kRec709}) {
    const vec3 white = *rec709_from_rgb(p) * vec3(1.0f);
    EXPECT_NEAR(glm::distance(white, vec3(1.0f)), 0.0f, 1e-4f) << primaries_text(p);
  }
  // Unless the file adopts another neutral: then that is.
  const dvec2 tungsten(0.4476, 0.4074);
  const glm::dmat3 xyz = *xyz_from_rgb(kP3);
  const dvec3 lamp =
      glm::inverse(xyz) * dvec3(tungsten.x / tungsten.y, 1.0, (1.0 - tungsten.x - tungsten.y) / tungsten.y);
  EXPECT_NEAR(glm::distance(*rec709_from_rgb(kP3, tungsten) * vec3(lamp), vec3(1.0f)), 0.0f, 1e-4f);
}

TEST(unit_image_primaries, xyz_itself_is_taken_as_measured) {
  const vec3 d65(0.95046f, 1.0f, 1.08906f);
  EXPECT_NEAR(glm::distance(*rec709_from_rgb(kXyz) * d65, vec3(1.0f)), 0.0f, 1e-3f);
}

TEST(unit_image_primaries, what_spans_no_colours_is_refused) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const auto with = [](dvec2 red, dvec2 green, dvec2 blue, dvec2 white) { return Primaries{red, green, blue, white}; };
  const dvec2 r = kRec709.red, g = kRec709.green, b = kRec709.blue, w = kRec709.white;
  for (const Primaries& p : {with(r, g, b, {0.3127, 0.0}), with(r, g, b, {0.0, 0.0}), with(r, g, b, {nan, 0.3}),
                             with(r, g, b, {0.7, 0.25}), with(r, r, b, w), with({0.2, 0.2}, {0.3, 0.3}, {0.4, 0.4}, w),
                             with({inf, 0.3}, g, b, w), with(r, {1e30, -1e30}, b, w), with(r, g, {-1e9, 2.0}, w),
                             with({}, {}, {}, {}), with(r, g, b, {-0.3, -0.3}), with(r, g, b, {0.6, 0.5}),
                             // White is within, of a triangle that is no more than a line.
                             with({0.6, 0.329}, {0.1, 0.3291}, {0.3127, 0.3286}, w)}) {
    EXPECT_FALSE(xyz_from_rgb(p)) << primaries_text(p);
    EXPECT_FALSE(rec709_from_rgb(p)) << primaries_text(p);
  }
  for (const dvec2 neutral : {dvec2(0.3, 0.0), dvec2(nan, 0.3), dvec2(2.0, -1.0)})
    EXPECT_FALSE(rec709_from_rgb(kP3, neutral));
}

TEST(unit_image_primaries, files_round_their_numbers) {
  EXPECT_TRUE(is_same(kRec709, {{0.64, 0.33}, {0.3, 0.6}, {0.15, 0.06}, {0.31271, 0.32902}}));
  EXPECT_FALSE(is_same(kRec709, kP3));
  EXPECT_FALSE(is_same(kRec709, {{0.64, 0.33}, {0.29, 0.6}, {0.15, 0.06}, {0.3127, 0.329}}));
}

TEST(unit_image_primaries, colours_beyond_rec709_keep_their_luminance_and_lose_what_is_negative) {
  const mat3 m = *rec709_from_rgb(kAcesCg);
  Image image(5, 1, 3);
  const float inf = std::numeric_limits<float>::infinity();
  image.set_rgb(0, 0, vec3(0.0f, 4.0f, 0.0f));   // far outside
  image.set_rgb(1, 0, vec3(0.5f, 0.5f, 0.5f));   // within
  image.set_rgb(2, 0, vec3(-1.0f, 0.5f, 0.5f));  // no light to begin with: for others to tell
  image.set_rgb(3, 0, vec3(inf, 1.0f, 1.0f));
  image.set_rgb(4, 0, vec3(0.0f));
  EXPECT_EQ(convert_to_rec709(image, m), 1U);
  const vec3 green = image.rgb(0, 0);
  EXPECT_GE(std::min({green.x, green.y, green.z}), 0.0f);
  EXPECT_NEAR(luminance(green), luminance(m * vec3(0.0f, 4.0f, 0.0f)), 1e-4f);
  EXPECT_GT(green.y, 2.0f * green.x) << "still green";
  EXPECT_NEAR(glm::distance(image.rgb(1, 0), vec3(0.5f)), 0.0f, 1e-4f);
  EXPECT_LT(image.rgb(2, 0).x, 0.0f);
  EXPECT_EQ(image.rgb(3, 0).x, inf);
  EXPECT_EQ(image.rgb(4, 0), vec3(0.0f));
}

}  // namespace
}  // namespace candela
