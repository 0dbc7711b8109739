#include "raster/quantity.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <set>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace candela::raster {
namespace {

std::vector<Quantity> quantities() {
  std::vector<Quantity> all;
  all.reserve(kQuantityCount);
  for (int i = 0; i < kQuantityCount; ++i) all.push_back(static_cast<Quantity>(i));
  return all;
}

TEST(unit_raster_quantity, each_has_a_name_of_its_own_that_is_understood) {
  std::set<std::string_view> names;
  for (const Quantity q : quantities()) {
    EXPECT_FALSE(quantity_name(q).empty());
    EXPECT_TRUE(names.insert(quantity_name(q)).second) << quantity_name(q);
    EXPECT_EQ(parse_quantity(quantity_name(q)), q);
  }
  EXPECT_EQ(quantity_name(Quantity::base_color), "base-color");
  EXPECT_EQ(quantity_name(Quantity::geometric_normal), "facet");
  EXPECT_EQ(quantity_name(Quantity::non_finite), "non-finite");
}

TEST(unit_raster_quantity, another_name_is_an_error_that_lists_them) {
  try {
    parse_quantity("colour");
    ADD_FAILURE() << "understood";
  } catch (const Error& error) {
    EXPECT_NE(error.message().find("'colour'"), std::string::npos);
    for (const Quantity q : quantities()) EXPECT_NE(error.message().find(quantity_name(q)), std::string::npos);
  }
}

TEST(unit_raster_quantity, parts_of_the_light_add_up_to_all_of_it) {
  const int far = parts_of(Quantity::ambient), direct = parts_of(Quantity::direct), own = parts_of(Quantity::emission);
  EXPECT_EQ(far | direct | own, all_parts);
  EXPECT_EQ(far & direct, 0);
  EXPECT_EQ((far | direct) & own, 0);
  int sum = 0;
  for (const Quantity q :
       {Quantity::diffuse, Quantity::specular, Quantity::coat, Quantity::sheen, Quantity::transmission}) {
    EXPECT_EQ(std::popcount(static_cast<unsigned>(parts_of(q))), 1) << quantity_name(q);
    EXPECT_EQ(sum & parts_of(q), 0) << quantity_name(q);
    sum |= parts_of(q);
  }
  EXPECT_EQ(sum, far);
  EXPECT_EQ(parts_of(Quantity::light), all_parts);
  EXPECT_EQ(parts_of(Quantity::luminance), all_parts);
}

TEST(unit_raster_quantity, layers_are_numbers_of_the_surface) {
  for (const Layer layer : {Layer::albedo, Layer::normal, Layer::camera_normal, Layer::base_color}) {
    EXPECT_TRUE(is_of_surface(quantity_of(layer)));
    EXPECT_TRUE(shows_numbers(quantity_of(layer)));
  }
  EXPECT_EQ(quantity_of(Layer::camera_normal), Quantity::normal);
  for (const Quantity q : {Quantity::light, Quantity::diffuse, Quantity::direct, Quantity::emission}) {
    EXPECT_FALSE(is_of_surface(q));
    EXPECT_FALSE(shows_numbers(q));
  }
  EXPECT_TRUE(shows_numbers(Quantity::luminance));
  EXPECT_FALSE(is_of_surface(Quantity::luminance));
}

TEST(unit_raster_quantity, false_colours_go_through_the_spectrum_over_twelve_stops) {
  const auto at = [](float stops) { return false_color(0.18f * std::exp2(stops)); };
  EXPECT_EQ(false_color(0.0f), vec3(0.0f));
  EXPECT_EQ(at(-6.5f), vec3(0.0f));
  EXPECT_EQ(at(6.5f), vec3(1.0f));
  EXPECT_LT(glm::distance(at(0.0f), vec3(0, 1, 0)), 1e-4f) << "middle grey";
  EXPECT_LT(glm::distance(at(-5.999f), vec3(0, 0, 1)), 1e-2f);
  EXPECT_LT(glm::distance(at(5.999f), vec3(1, 0, 0)), 1e-2f);
  EXPECT_LT(glm::distance(at(3.0f), vec3(1, 1, 0)), 1e-4f);
}

}  // namespace
}  // namespace candela::raster
