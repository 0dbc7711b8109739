#include "image/bloom.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "image/film.h"

namespace candela {
namespace {

double sum(const Image& image) { return std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0); }

Image spot(int size, float value) {
  Image image(size, size, 3);
  image.set_rgb(size / 2, size / 2, vec3(value));
  return image;
}

TEST(unit_image_bloom, an_even_picture_stays_as_it_is) {
  Image image(37, 20, 3);
  for (float& v : image.pixels) v = 0.7f;
  for (const float v : bloomed(image, 0.5f).pixels) EXPECT_NEAR(v, 0.7f, 1e-5f);
}

TEST(unit_image_bloom, a_spot_keeps_its_light_and_gives_a_share_away) {
  const Image before = spot(128, 100.0f), after = bloomed(before, 0.2f);
  EXPECT_NEAR(sum(after) / sum(before), 1.0, 0.02);
  EXPECT_NEAR(after.rgb(64, 64).x, 80.0f, 2.0f);
  // Less and less with the distance, and something far away.
  EXPECT_GT(after.rgb(67, 64).x, after.rgb(74, 64).x);
  EXPECT_GT(after.rgb(74, 64).x, after.rgb(100, 64).x);
  EXPECT_GT(after.rgb(100, 64).x, 0.0f);
  EXPECT_EQ(sum(bloomed(before, 0.0f)), sum(before));
}

TEST(unit_image_bloom, light_spreads_alike_to_all_sides) {
  Image before(64, 64, 3);
  before.set_rgb(20, 41, vec3(100.0f));
  before.set_rgb(33, 7, vec3(3.0f));
  const auto turned = [](const Image& image, int turn) {
    Image result(image.width, image.height, 3);
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        const int right = image.width - 1 - x, below = image.height - 1 - y;
        result.set_rgb(x, y, turn == 0 ? image.rgb(right, y) : turn == 1 ? image.rgb(x, below) : image.rgb(y, x));
      }
    }
    return result;
  };
  for (int turn = 0; turn < 3; ++turn) {
    const Image expected = turned(bloomed(before, 0.4f), turn), found = bloomed(turned(before, turn), 0.4f);
    for (std::size_t i = 0; i < expected.pixels.size(); ++i) EXPECT_NEAR(found.pixels[i], expected.pixels[i], 1e-5f);
  }
}

TEST(unit_image_bloom, what_is_not_finite_stays_where_it_is) {
  Image image = spot(64, std::numeric_limits<float>::infinity());
  image.set_rgb(3, 3, vec3(std::numeric_limits<float>::quiet_NaN()));
  const Image after = bloomed(image, 0.3f);
  EXPECT_TRUE(std::isfinite(after.rgb(40, 32).x));
  EXPECT_EQ(after.rgb(32, 32).x, std::numeric_limits<float>::infinity());
}

TEST(unit_image_bloom, tiny_pictures_are_pictures) {
  for (const int size : {1, 2, 3, 5}) EXPECT_EQ(bloomed(spot(size, 1.0f), 0.5f).width, size);
}

TEST(unit_image_film, films_add_up_and_what_has_no_mean_stays) {
  const auto film = [](float value) {
    Film f;
    f.beauty = Image(2, 1, 4);
    f.layers[Layer::albedo] = Image(2, 1, 3);
    f.layers[Layer::depth] = Image(2, 1, 1);
    for (Image* image : {&f.beauty, &f.layers[Layer::albedo], &f.layers[Layer::depth]}) {
      for (float& v : image->pixels) v = value;
    }
    return f;
  };
  Film mean;
  accumulate(film(1.0f), 0.25f, mean);
  accumulate(film(3.0f), 0.75f, mean);
  EXPECT_EQ(mean.beauty.pixels[5], 2.5f);
  EXPECT_EQ(mean.layers.at(Layer::albedo).pixels[0], 2.5f);
  EXPECT_EQ(mean.layers.at(Layer::depth).pixels[0], 1.0f);
}

}  // namespace
}  // namespace candela
