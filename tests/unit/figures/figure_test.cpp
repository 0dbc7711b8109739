#include "figures/figure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.h"
#include "figures/figure_book.h"
#include "figures/figure_page.h"
#include "figures/markup.h"
#include "figures/symbols.h"
#include "unit/figures/well_formed.h"

namespace candela::figures {
namespace {

TEST(unit_figures_figure, the_slope_of_a_power_is_its_exponent) {
  std::vector<dvec2> points;
  for (int n = 1; n <= 4096; n *= 4) points.emplace_back(n, 3.0 / std::sqrt(n));
  EXPECT_NEAR(logarithmic_slope(points), -0.5, 1e-12);
  points.emplace_back(10000, 0.0);
  EXPECT_NEAR(logarithmic_slope(points), -0.5, 1e-12) << "what has no logarithm does not count";
  EXPECT_EQ(logarithmic_slope({}), 0.0);
}

TEST(unit_figures_figure, the_error_is_relative_and_of_the_columns_asked_for) {
  Image truth(4, 2, 4), image(4, 2, 4);
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 4; ++x) {
      truth.set_rgb(x, y, vec3(0.5f));
      image.set_rgb(x, y, vec3(x < 2 ? 0.5f : 0.75f));
      image.at(x, y)[3] = truth.at(x, y)[3] = 1.0f;
    }
  }
  EXPECT_NEAR(relative_error(image, truth, 0, 2), 0.0, 1e-7);
  EXPECT_NEAR(relative_error(image, truth, 2, 4), 0.5, 1e-6);
  EXPECT_NEAR(relative_error(image, truth), 0.5 / std::sqrt(2.0), 1e-6);
  EXPECT_EQ(relative_error(Image(2, 2, 3), Image(2, 2, 3)), 0.0);
}

TEST(unit_figures_figure, edges_that_a_surface_covers_in_part_do_not_count) {
  Image truth(4, 1, 4), image(4, 1, 4);
  for (int x = 0; x < 4; ++x) {
    truth.set_rgb(x, 0, vec3(0.5f));
    image.set_rgb(x, 0, vec3(x == 2 ? 5.0f : 0.5f));
    truth.at(x, 0)[3] = image.at(x, 0)[3] = x < 2 ? 1.0f : 0.4f;
  }
  EXPECT_EQ(relative_error(image, truth), 0.0);
  truth.at(2, 0)[3] = 1.0f;
  EXPECT_EQ(relative_error(image, truth), 0.0) << "in either picture";
  image.at(2, 0)[3] = 1.0f;
  EXPECT_GT(relative_error(image, truth), 1.0);
}

TEST(unit_figures_figure, percents_have_two_digits) {
  EXPECT_EQ(percent_text(0.0), "0.0 %");
  EXPECT_EQ(percent_text(1e-9), "< 0.01 %");
  EXPECT_EQ(percent_text(0.0005), "0.05 %");
  EXPECT_EQ(percent_text(0.0312), "3.1 %");
  EXPECT_EQ(percent_text(0.099), "9.9 %");
  EXPECT_EQ(percent_text(0.0999), "10 %");
  EXPECT_EQ(percent_text(1.2), "120 %");
}

TEST(unit_figures_figure, names_are_unique_and_fit_for_files) {
  std::set<std::string> names;
  Chapter last = Chapter::facets;
  for (const FigureInfo& info : figures()) {
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    EXPECT_TRUE(std::all_of(info.name.begin(), info.name.end(), [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
    })) << info.name;
    EXPECT_FALSE(info.title.empty());
    EXPECT_GE(info.chapter, last) << info.name << " comes after its chapter";
    last = info.chapter;
  }
}

TEST(unit_figures_figure, chosen_figures_stand_in_the_order_of_the_book) {
  const std::vector<FigureInfo> chosen = choose_figures({"fresnel-metals", "ndf-ggx"});
  ASSERT_EQ(chosen.size(), 2u);
  EXPECT_EQ(chosen[0].name, "ndf-ggx");
  EXPECT_EQ(choose_figures({}).size(), figures().size());
  try {
    choose_figures({"ndf-ggx", "nonsense"});
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(error.message().find("nonsense"), std::string::npos);
    EXPECT_NE(error.message().find("fresnel-metals"), std::string::npos);
  }
}

/// Those that need no renderer.
TEST(unit_figures_figure, curves_are_well_formed_and_formulas_can_be_read) {
  const FigureSettings settings;
  Diagnostics diagnostics;
  FigureContext context(settings, {.diagnostics = &diagnostics});
  std::set<std::string> files;
  for (const FigureInfo& info : figures()) {
    const bool is_drawn = info.name == "points" || info.name == "sketch-radiance";
    if (info.chapter != Chapter::facets && info.chapter != Chapter::fresnel && !is_drawn) continue;
    const Figure figure = info.make(context);
    EXPECT_FALSE(figure.text.empty() || figure.formulas.empty() || figure.sources.empty() || figure.panels.empty())
        << info.name;
    for (const std::string& formula : figure.formulas) EXPECT_NO_THROW(mathml(formula)) << formula;
    EXPECT_FALSE(symbols_in(figure.formulas).empty()) << info.name;
    for (const Symbol& symbol : symbols_in(figure.formulas)) EXPECT_NO_THROW(mathml(symbol.formula)) << symbol.formula;
    for (const Panel& panel : figure.panels) {
      EXPECT_TRUE(panel.file.starts_with(info.name)) << panel.file;
      EXPECT_TRUE(files.insert(panel.file).second) << panel.file;
      if (std::holds_alternative<DisplayImage>(panel.content)) continue;
      const std::string& svg = std::get<std::string>(panel.content);
      EXPECT_TRUE(test::is_well_formed(svg)) << panel.file;
      EXPECT_EQ(svg.find("nan"), std::string::npos) << panel.file;
      EXPECT_EQ(svg.find("inf"), std::string::npos) << panel.file;
    }
    for (const auto& row : figure.table.rows) EXPECT_EQ(row.size(), figure.table.head.size()) << info.name;
  }
  EXPECT_TRUE(diagnostics.warnings().empty());
}

TEST(unit_figures_figure, pages_name_what_they_show_and_escape_it) {
  PageFigure page;
  page.info = {.name = "row-x", .title = "A & B", .chapter = Chapter::parameters, .make = {}};
  page.figure.text = {"1 < 2"};
  page.figure.formulas = {"α = r^2"};
  page.figure.panels = {{.file = "row-x.png", .content = DisplayImage{4, 2, {}}, .caption = "<b>", .error = "3 %"}};
  page.figure.left_out = {"what needs OpenGL"};
  const std::string index = index_html({page}, "a note");
  EXPECT_NE(index.find("row-x.png"), std::string::npos);
  EXPECT_NE(index.find("href=\"parameter-row-x.html\""), std::string::npos);
  EXPECT_NE(index.find("A &amp; B"), std::string::npos);
  const std::string own = parameter_html(page, nullptr, &page, "a note");
  for (const char* part :
       {"1 &lt; 2", "<math", "alt=\"&lt;b&gt;\"", "width=\"4\"", "<b>3 %</b>", "Left out: what needs OpenGL",
        "candela figures -o DIR --only row-x", "A &amp; B →", "index.html", "a note"}) {
    EXPECT_NE(own.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(own.find("<script"), std::string::npos);
}

TEST(unit_figures_figure, a_row_of_squares_is_cut_so_that_it_can_wrap) {
  PageFigure page;
  page.info = {.name = "row-x", .title = "X", .chapter = Chapter::spheres, .make = {}};
  page.figure.panels = {
      {.file = "row-x.png", .content = DisplayImage{30, 10, {}}, .caption = "three", .scale = {"a", "b", "c"}},
      {.file = "strip.png", .content = DisplayImage{40, 10, {}}, .caption = "no squares", .scale = {"a", "b", "c"}}};
  const std::string index = index_html({page}, "a note");
  for (const char* part : {"object-position: 0% 0", "object-position: 50% 0", "object-position: 100% 0", "--n: 3"}) {
    EXPECT_NE(index.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(index.find("strip.png"), index.rfind("strip.png")) << "what is no row of squares stays whole";
}

TEST(unit_figures_figure, symbols_are_those_of_the_formulas) {
  const auto has = [](const std::vector<std::string>& formulas, std::string_view letter) {
    const std::vector<Symbol> symbols = symbols_in(formulas);
    return std::any_of(symbols.begin(), symbols.end(), [&](const Symbol& s) { return s.formula == letter; });
  };
  EXPECT_TRUE(has({"f(l, v) = \\frac{D(h) F(v·h) G(l, v)}{4 (n·l) (n·v)}"}, "G"));
  EXPECT_TRUE(has({"α = r^2"}, "r"));
  EXPECT_FALSE(has({"α = r^2"}, "n"));
  EXPECT_TRUE(symbols_in({}).empty());
}

TEST(unit_figures_figure, balls_beside_each_other_keep_their_places) {
  const Film row = beside(3, [](int i) {
    Film film;
    film.beauty = Image(2, 2, 4);
    for (int y = 0; y < 2; ++y) film.beauty.set_rgb(1, y, vec3(static_cast<float>(i + 1)));
    return film;
  });
  ASSERT_EQ(row.width(), 6);
  ASSERT_EQ(row.height(), 2);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(row.beauty.rgb(2 * i, 1), vec3(0.0f));
    EXPECT_EQ(row.beauty.rgb(2 * i + 1, 1), vec3(static_cast<float>(i + 1)));
  }
}

}  // namespace
}  // namespace candela::figures
