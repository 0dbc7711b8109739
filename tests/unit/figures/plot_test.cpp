#include "figures/plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <sstream>

#include "base/error.h"
#include "unit/figures/well_formed.h"

namespace candela::figures {
namespace {

using test::count_of;
using testing::Pointwise;

testing::Matcher<std::vector<double>> near(const std::vector<double>& values) {
  return Pointwise(testing::DoubleNear(1e-9), values);
}

TEST(unit_figures_plot, round_ticks_are_one_two_or_five) {
  EXPECT_THAT(round_ticks(0.0, 1.0, 5), near({0.0, 0.2, 0.4, 0.6, 0.8, 1.0}));
  EXPECT_THAT(round_ticks(0.0, 90.0, 5), near({0, 20, 40, 60, 80}));
  EXPECT_THAT(round_ticks(-0.06, 0.06, 6), near({-0.06, -0.04, -0.02, 0, 0.02, 0.04, 0.06}));
  EXPECT_THAT(round_ticks(0.84, 1.0, 4), near({0.85, 0.9, 0.95, 1.0}));
  EXPECT_THAT(even_ticks(45, 90, 15), near({45, 60, 75, 90}));
}

TEST(unit_figures_plot, ticks_stay_within_any_axis) {
  for (const double span : {1e-9, 0.3, 7.0, 12345.0}) {
    for (const double low : {-3.7, 0.0, 11.1}) {
      const std::vector<double> ticks = round_ticks(low, low + span, 5);
      EXPECT_GE(ticks.size(), 2u) << low << " + " << span;
      EXPECT_LE(ticks.size(), 8u) << low << " + " << span;
      for (const double tick : ticks) {
        EXPECT_GE(tick, low - 1e-6 * span);
        EXPECT_LE(tick, low + span * (1 + 1e-6));
      }
    }
  }
}

TEST(unit_figures_plot, logarithmic_ticks_are_powers_of_ten) {
  EXPECT_THAT(logarithmic_ticks(1e-3, 2.0, 9), near({1e-3, 1e-2, 1e-1, 1.0}));
  EXPECT_THAT(logarithmic_ticks(4, 16384, 9), near({10, 100, 1000, 10000}));
  EXPECT_LE(logarithmic_ticks(1e-12, 1e12, 6).size(), 7u) << "thinned where there are many";
  EXPECT_THAT(logarithmic_ticks(1.5, 30.0, 9), near({2, 5, 10, 20})) << "finer where there is but one";
}

TEST(unit_figures_plot, ticks_are_written_as_people_write_them) {
  EXPECT_EQ(tick_text(0.0), "0");
  EXPECT_EQ(tick_text(-0.0), "0");
  EXPECT_EQ(tick_text(0.30000000000000004), "0.3");
  EXPECT_EQ(tick_text(-0.04), "−0.04");
  EXPECT_EQ(tick_text(10000), "10000");
  EXPECT_EQ(tick_text(1e-4), "10⁻⁴");
  EXPECT_EQ(tick_text(1e6), "10⁶");
  EXPECT_EQ(tick_text(2e12), "2·10¹²");
}

/// The points of the first curve, pixels.
std::vector<dvec2> drawn(const std::string& svg) {
  const std::size_t path = svg.find("<path class=\"curve");
  const std::size_t begin = svg.find(" d=\"", path) + 4;
  std::string data = svg.substr(begin, svg.find('"', begin) - begin);
  for (char& c : data) c = c == 'M' || c == 'L' ? ' ' : c;
  std::vector<dvec2> points;
  std::istringstream in(data);
  for (dvec2 p; in >> p.x >> p.y;) points.push_back(p);
  return points;
}

TEST(unit_figures_plot, a_linear_axis_keeps_distances) {
  const Plot plot{.title = "t",
                  .x = {.label = "x"},
                  .y = {.label = "y"},
                  .curves = {{.label = "", .points = {{0, 0}, {0.5, 0.5}, {1, 1}}}}};
  const std::vector<dvec2> p = drawn(plot_svg(plot));
  ASSERT_EQ(p.size(), 3u);
  EXPECT_NEAR(p[1].x, 0.5 * (p[0].x + p[2].x), 0.11);
  EXPECT_NEAR(p[1].y, 0.5 * (p[0].y + p[2].y), 0.02);
  EXPECT_GT(p[0].y, p[2].y) << "up is less y";
}

TEST(unit_figures_plot, a_logarithmic_axis_keeps_ratios) {
  Plot plot{.title = "t",
            .x = {.label = "x", .low = 1, .high = 10000, .scale = Scale::logarithmic},
            .y = {.label = "y", .low = 1e-4, .high = 1, .scale = Scale::logarithmic},
            .curves = {{.label = "", .points = {{1, 1}, {10, 0.1}, {100, 0.01}, {10000, 1e-4}}}}};
  const std::vector<dvec2> p = drawn(plot_svg(plot));
  ASSERT_EQ(p.size(), 4u);
  EXPECT_NEAR(p[1].x - p[0].x, p[2].x - p[1].x, 0.21);
  EXPECT_NEAR(p[1].y - p[0].y, p[2].y - p[1].y, 0.03);
  EXPECT_NEAR(p[3].y - p[0].y, 4 * (p[1].y - p[0].y), 0.06);
}

TEST(unit_figures_plot, a_curve_has_gaps_where_it_has_no_value) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Plot plot{.title = "t",
            .x = {.label = "x"},
            .y = {.label = "y"},
            .curves = {{.label = "", .points = {{0, 0}, {0.2, 0.2}, {0.4, nan}, {0.6, 0.6}, {1, 1}}}}};
  const std::string svg = plot_svg(plot);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  const std::string path = svg.substr(svg.find("<path class=\"curve"));
  EXPECT_EQ(count_of(path.substr(0, path.find("/>")), "M"), 2u);

  plot.y = {.label = "y", .low = 0.1, .high = 1, .scale = Scale::logarithmic};
  EXPECT_EQ(drawn(plot_svg(plot)).size(), 3u) << "0 has no logarithm";
}

TEST(unit_figures_plot, text_is_escaped_and_the_whole_is_well_formed) {
  const Plot plot{.title = "a < b",
                  .x = {.label = "x & \"y\""},
                  .y = {.label = "<script>"},
                  .curves = {{.label = "r > 1", .points = {{0, 0}, {1, 1}}, .has_markers = true},
                             {.label = "out at the top", .points = {{0, 0}, {0.5, 2.0}}, .stroke = Stroke::dashed},
                             {.label = "nothing", .points = {}}}};
  const std::string svg = plot_svg(plot);
  EXPECT_TRUE(test::is_well_formed(svg));
  EXPECT_EQ(svg.find("<script>"), std::string::npos);
  EXPECT_NE(svg.find("x &amp; &quot;y&quot;"), std::string::npos);
  EXPECT_NE(svg.find("r &gt; 1"), std::string::npos);
}

/// Where the labels of curves stand.
std::vector<dvec2> label_places(const std::string& svg) {
  std::vector<dvec2> places;
  const std::string begin = "<text class=\"name";
  for (std::size_t at = svg.find(begin); at != std::string::npos; at = svg.find(begin, at + 1)) {
    places.emplace_back(std::stod(svg.substr(svg.find(" x=\"", at) + 4)),
                        std::stod(svg.substr(svg.find(" y=\"", at) + 4)));
  }
  return places;
}

TEST(unit_figures_plot, labels_do_not_overlap) {
  Plot plot{.title = "t", .x = {.label = "x"}, .y = {.label = "y"}};
  for (int i = 0; i < 6; ++i) plot.curves.push_back({.label = "ends", .points = {{0, 0.1 * i}, {1, 1}}});
  for (int i = 0; i < 3; ++i) plot.curves.push_back({.label = "leaves", .points = {{0, 0}, {0.5, 1}, {0.6, 3}}});
  const std::vector<dvec2> places = label_places(plot_svg(plot));
  ASSERT_EQ(places.size(), 9u);
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      EXPECT_TRUE(std::abs(places[i].x - places[k].x) > 40 || std::abs(places[i].y - places[k].y) >= 15)
          << i << " and " << k;
    }
  }
}

TEST(unit_figures_plot, impossible_axes_are_refused) {
  Plot plot{.title = "t", .x = {.label = "x", .low = 1, .high = 1}, .y = {.label = "y"}};
  EXPECT_THROW(plot_svg(plot), Error);
  plot.x = {.label = "x", .low = 0, .high = 1, .scale = Scale::logarithmic};
  EXPECT_THROW(plot_svg(plot), Error);
  EXPECT_THROW(polar_plot_svg({.title = "t", .radius = 0.0, .label = "r"}), Error);
}

TEST(unit_figures_plot, a_polar_diagram_has_the_normal_on_top) {
  PolarPlot plot{.title = "lobe", .label = "r", .incoming = -45.0, .incoming_label = "light"};
  plot.lobes.push_back({.label = "", .points = {{-90, 1}, {0, 1}, {90, 1}}});
  const std::string svg = polar_plot_svg(plot);
  EXPECT_TRUE(test::is_well_formed(svg));
  const std::size_t begin = svg.find(" d=\"", svg.find("<path class=\"lobe")) + 4;
  std::string data = svg.substr(begin, svg.find('"', begin) - begin);
  for (char& c : data) c = c == 'M' || c == 'L' ? ' ' : c;
  std::istringstream in(data);
  dvec2 left, top, right;
  in >> left.x >> left.y >> top.x >> top.y >> right.x >> right.y;
  EXPECT_NEAR(top.x, 0.5 * (left.x + right.x), 0.11);
  EXPECT_NEAR(left.y, right.y, 0.11);
  EXPECT_NEAR(left.y - top.y, 0.5 * (right.x - left.x), 0.11) << "a circle is round";
  EXPECT_LT(left.x, right.x);
}

TEST(unit_figures_plot, inks_differ) {
  std::set<std::string_view> inks;
  for (int i = 0; i < 7; ++i) inks.insert(categorical_ink(i).light);
  EXPECT_EQ(inks.size(), 7u);
  for (const int count : {1, 2, 5, 8}) {
    std::set<std::string_view> ramp;
    for (int i = 0; i < count; ++i) ramp.insert(sequential_ink(i, count).light);
    EXPECT_EQ(ramp.size(), static_cast<std::size_t>(count));
  }
}

}  // namespace
}  // namespace candela::figures
