#include "figures/markup.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "unit/figures/well_formed.h"

namespace candela::figures {
namespace {

TEST(unit_figures_markup, escaping_leaves_nothing_that_means_something) {
  EXPECT_EQ(escaped("a<b & \"c\" > 'd'"), "a&lt;b &amp; &quot;c&quot; &gt; &#39;d&#39;");
  EXPECT_EQ(escaped("α² ≤ 1"), "α² ≤ 1");
  EXPECT_EQ(escaped(std::string("a\x1b\x01z\n")), "az\n") << "control characters are no XML";
}

TEST(unit_figures_markup, formulas_become_mathml) {
  EXPECT_EQ(mathml("α = r^2"),
            "<math display=\"block\"><mrow><mi>α</mi><mo>=</mo><msup><mi>r</mi><mn>2</mn></msup></mrow></math>");
  EXPECT_EQ(
      mathml("\\frac{1}{2}"),
      "<math display=\"block\"><mrow><mfrac><mrow><mn>1</mn></mrow><mrow><mn>2</mn></mrow></mfrac></mrow></math>");
  EXPECT_NE(mathml("F_0").find("<msub><mi>F</mi><mn>0</mn></msub>"), std::string::npos);
  EXPECT_NE(mathml("x_1^2").find("<msubsup><mi>x</mi><mn>1</mn><mn>2</mn></msubsup>"), std::string::npos);
  EXPECT_NE(mathml("\\sqrt{N}").find("<msqrt><mrow><mi>N</mi></mrow></msqrt>"), std::string::npos);
  EXPECT_NE(mathml("\\op{max}(a, b)").find("<mi>max</mi><mrow><mo>(</mo><mi>a</mi><mo>,</mo>"), std::string::npos);
  EXPECT_NE(mathml("3.535c").find("<mn>3.535</mn><mi>c</mi>"), std::string::npos);
  EXPECT_NE(mathml("∑_k x").find("<munder><mo>∑</mo><mi>k</mi></munder>"), std::string::npos);
  EXPECT_NE(mathml("a \\text{ if } b").find("<mtext>\u00a0if\u00a0</mtext>"), std::string::npos)
      << "blanks at the ends of a text are set";
}

TEST(unit_figures_markup, a_script_belongs_to_the_whole_group) {
  const std::string squared = mathml("(n·h)^2");
  EXPECT_NE(squared.find("<msup><mrow><mo>(</mo>"), std::string::npos) << squared;
}

TEST(unit_figures_markup, formulas_are_well_formed_whatever_they_hold) {
  EXPECT_TRUE(test::is_well_formed(mathml("a < b & c > \\text{<i>}")));
  EXPECT_TRUE(test::is_well_formed(mathml("\\frac{(n − 1)^2 + k^2}{(n + 1)^2 + k^2} , \\op{sin}^2 \\, θ")));
}

TEST(unit_figures_markup, damaged_formulas_are_refused) {
  for (const char* formula :
       {"{a", "a}", "(a", "a)", "(a}", "\\frac{1}", "\\op", "\\op{a", "\\emph{a}", "a_", "a^2^3"}) {
    EXPECT_THROW(mathml(formula), Error) << formula;
  }
}

}  // namespace
}  // namespace candela::figures
