#include "io/ies.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "base/error.h"
#include "base/file.h"
#include "unit/base/temp_folder.h"

namespace candela::io::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// The parts of a file; tests take one that is right and change one thing.
struct IesText {
  std::string header = "IESNA:LM-63-2002\n[TEST] none\n[MANUFAC] nobody\n[LUMINAIRE] two, 100 lm";
  std::string tilt = "TILT=NONE";
  std::string lamp = "1 1000 1";  ///< count, lumens, multiplier
  std::string counts = "3 1";
  std::string type = "1";
  std::string opening = "2 0 0 0";
  std::string ballast = "1 1 50";
  std::string vertical = "0 45 90";
  std::string horizontal = "0";
  std::string candela = "100 50 0";

  std::string text() const {
    return header + '\n' + tilt + '\n' + lamp + ' ' + counts + ' ' + type + ' ' + opening + '\n' + ballast + '\n' +
           vertical + '\n' + horizontal + '\n' + candela + '\n';
  }
};

IesText with_rows(const std::string& horizontal, const std::string& counts, const std::string& candela) {
  IesText t;
  t.horizontal = horizontal;
  t.counts = counts;
  t.candela = candela;
  return t;
}

struct Parsed {
  IesProfile profile;
  std::vector<Diagnostic> warnings;
};

Parsed parse(const std::string& text) {
  Diagnostics diagnostics;
  IesProfile profile = parse_ies(text, "lamp.ies", diagnostics);
  EXPECT_TRUE(is_valid(profile));
  return {std::move(profile), diagnostics.warnings()};
}
Parsed parse(const IesText& t) { return parse(t.text()); }

std::string error_of(const std::string& text) {
  Diagnostics diagnostics;
  try {
    parse_ies(text, "lamp.ies", diagnostics);
  } catch (const Error& error) {
    return error.what();
  }
  return "parsed";
}
std::string error_of(const IesText& t) { return error_of(t.text()); }

/// Candela in the direction of these angles, degrees.
float at(const IesProfile& profile, double vertical_deg, double horizontal_deg) {
  const double v = vertical_deg * M_PI / 180.0, h = horizontal_deg * M_PI / 180.0;
  return ies_intensity(profile, vec3(std::sin(v) * std::cos(h), std::sin(v) * std::sin(h), -std::cos(v)));
}

// ----- what the angles mean

TEST(unit_io_ies, vertical_0_is_the_way_a_light_shines) {
  const IesProfile p = parse(IesText()).profile;
  EXPECT_EQ(ies_intensity(p, {0, 0, -1}), 100.0f);
  EXPECT_EQ(ies_intensity(p, {0, 0, 1}), 0.0f);
  EXPECT_NEAR(at(p, 45.0, 77.0), 50.0f, 1e-3f);
  EXPECT_NEAR(at(p, 22.5, 0.0), 75.0f, 1e-3f) << "linear in between";
  EXPECT_NEAR(at(p, 67.5, 200.0), 25.0f, 1e-3f);
  EXPECT_EQ(at(p, 90.1, 0.0), 0.0f);
}

TEST(unit_io_ies, light_that_goes_up_alone_leaves_below_dark) {
  IesText t;
  t.vertical = "90 135 180";
  t.candela = "0 50 100";
  const IesProfile p = parse(t).profile;
  EXPECT_EQ(ies_intensity(p, {0, 0, 1}), 100.0f);
  EXPECT_EQ(ies_intensity(p, {0, 0, -1}), 0.0f);
  EXPECT_NEAR(at(p, 135.0, 0.0), 50.0f, 1e-3f);
}

TEST(unit_io_ies, full_circle_turns_from_x_to_y) {
  const IesProfile p = parse(with_rows("0 90 180 270 360", "3 5", "0 10 0  0 20 0  0 30 0  0 40 0  0 10 0")).profile;
  EXPECT_NEAR(at(p, 45, 0), 10, 1e-3);
  EXPECT_NEAR(at(p, 45, 90), 20, 1e-3);
  EXPECT_NEAR(at(p, 45, 180), 30, 1e-3);
  EXPECT_NEAR(at(p, 45, 270), 40, 1e-3);
  EXPECT_NEAR(at(p, 45, 315), 25, 1e-3);
  EXPECT_NEAR(at(p, 45, 359.999), 10, 1e-2) << "no seam";
}

TEST(unit_io_ies, half_circle_is_mirrored_at_the_plane_of_0_and_180) {
  const IesProfile p = parse(with_rows("0 45 180", "3 3", "0 10 0  0 20 0  0 30 0")).profile;
  EXPECT_THAT(p.horizontal_deg, ElementsAre(0, 45, 180, 315, 360));
  for (const double h : {0.0, 20.0, 45.0, 100.0, 170.0}) EXPECT_NEAR(at(p, 45, h), at(p, 45, -h), 1e-3) << h;
  EXPECT_NEAR(at(p, 45, 315), 20, 1e-3);
}

TEST(unit_io_ies, quarter_is_mirrored_twice) {
  const IesProfile p = parse(with_rows("0 30 90", "3 3", "0 10 0  0 20 0  0 30 0")).profile;
  EXPECT_THAT(p.horizontal_deg, ElementsAre(0, 30, 90, 150, 180, 210, 270, 330, 360));
  for (const double h : {0.0, 30.0, 45.0, 90.0}) {
    EXPECT_NEAR(at(p, 45, h), at(p, 45, -h), 1e-3) << h;
    EXPECT_NEAR(at(p, 45, h), at(p, 45, 180 - h), 1e-3) << h;
    EXPECT_NEAR(at(p, 45, h), at(p, 45, 180 + h), 1e-3) << h;
  }
  EXPECT_NEAR(at(p, 45, 330), 20, 1e-3);
  EXPECT_NEAR(at(p, 45, 270), 30, 1e-3);
}

TEST(unit_io_ies, from_90_to_270_is_mirrored_at_the_plane_between) {
  const IesProfile p = parse(with_rows("90 180 225 270", "3 4", "0 10 0  0 20 0  0 25 0  0 30 0")).profile;
  EXPECT_THAT(p.horizontal_deg, ElementsAre(0, 90, 180, 225, 270, 315, 360));
  EXPECT_NEAR(at(p, 45, 0), 20, 1e-3);
  EXPECT_NEAR(at(p, 45, 90), 10, 1e-3);
  EXPECT_NEAR(at(p, 45, 315), 25, 1e-3);
  EXPECT_NEAR(at(p, 45, 270), 30, 1e-3);
  // Without an entry at 180° it is interpolated.
  const IesProfile q = parse(with_rows("90 150 240 270", "3 4", "0 10 0  0 20 0  0 50 0  0 60 0")).profile;
  EXPECT_THAT(q.horizontal_deg, ElementsAre(0, 30, 90, 150, 180, 240, 270, 300, 360));
  EXPECT_NEAR(at(q, 45, 0), 30, 1e-3);
  EXPECT_NEAR(at(q, 45, 30), 20, 1e-3);
  EXPECT_NEAR(at(q, 45, 300), 50, 1e-3);
}

TEST(unit_io_ies, an_open_circle_is_closed_with_a_warning) {
  const Parsed p = parse(with_rows("0 120 240", "3 3", "0 10 0  0 20 0  0 30 0"));
  EXPECT_THAT(p.profile.horizontal_deg, ElementsAre(0, 120, 240, 360));
  EXPECT_NEAR(at(p.profile, 45, 300), 20, 1e-3);
  ASSERT_EQ(p.warnings.size(), 1u);
  EXPECT_THAT(p.warnings[0].text(), HasSubstr("lamp.ies: the horizontal angles end at 240"));
}

// ----- flux

TEST(unit_io_ies, flux_is_the_integral_of_the_intensity) {
  const std::string rows = "100 80 0  60 70 10  20 90 5  100 30 40";
  for (const IesText& t :
       {IesText(), with_rows("0 30 90 180", "3 4", rows), with_rows("90 100 200 270", "3 4", rows)}) {
    const IesProfile p = parse(t).profile;
    constexpr int kSteps = 720;  // a midpoint sum of half a degree
    double sum = 0.0;
    for (int i = 0; i < kSteps / 2; ++i) {
      const double v = (i + 0.5) * 360.0 / kSteps;
      for (int k = 0; k < kSteps; ++k) {
        sum += static_cast<double>(at(p, v, (k + 0.5) * 360.0 / kSteps)) * std::sin(v * M_PI / 180.0);
      }
    }
    sum *= std::pow(2.0 * M_PI / kSteps, 2.0);
    EXPECT_NEAR(ies_flux(p) / sum, 1.0, 1e-4);
    IesProfile wrong = p;
    wrong.candela[1] *= 1.01f;
    EXPECT_GT(std::abs(ies_flux(wrong) / sum - 1.0), 3e-4);
  }
}

TEST(unit_io_ies, equal_intensity_gives_four_pi) {
  IesText t;
  t.vertical = "0 90 180";
  t.candela = "7 7 7";
  EXPECT_NEAR(ies_flux(parse(t).profile), 7.0 * 4.0 * M_PI, 1e-6);
}

// ----- the number formats of forty years

TEST(unit_io_ies, multiplier_and_ballast_factor_multiply) {
  IesText t;
  t.lamp = "1 1000 2.5";
  t.ballast = "0.9 1 50";
  EXPECT_NEAR(ies_intensity(parse(t).profile, {0, 0, -1}), 225.0f, 1e-3f);
}

TEST(unit_io_ies, lamp_factor_counts_until_1991_alone) {
  IesText t;
  t.ballast = "1 0.5 50";
  for (const auto& [header, expected] : {std::pair{"IESNA91\n[TEST] x", 50.0f},
                                         {"anything of 1986", 50.0f},
                                         {"IESNA:LM-63-1995", 100.0f},
                                         {"IESNA:LM-63-2002", 100.0f},
                                         {"IES:LM-63-2019", 100.0f}}) {
    t.header = header;
    EXPECT_NEAR(ies_intensity(parse(t).profile, {0, 0, -1}), expected, 1e-3f) << header;
  }
}

TEST(unit_io_ies, tilt_table_is_skipped) {
  IesText t;
  t.tilt = "TILT=INCLUDE\n1\n3\n0 45 90\n1.0 0.95\n0.9";
  const Parsed p = parse(t);
  EXPECT_EQ(ies_intensity(p.profile, {0, 0, -1}), 100.0f);
  EXPECT_TRUE(p.warnings.empty());
  t.tilt = "TILT=lamp.tlt";
  const Parsed other = parse(t);
  EXPECT_EQ(ies_intensity(other.profile, {0, 0, -1}), 100.0f);
  ASSERT_EQ(other.warnings.size(), 1u);
  EXPECT_THAT(other.warnings[0].message, HasSubstr("tilt factors stand in another file"));
}

TEST(unit_io_ies, numbers_may_stand_on_any_lines) {
  std::string text = IesText().text();
  const std::size_t numbers = text.find("TILT=NONE") + 10;
  std::string one_each = text.substr(0, numbers), commas = one_each;
  for (const char c : text.substr(numbers)) {
    one_each += c == ' ' ? "\r\n" : std::string(1, c);
    commas += c == ' ' ? ", " : std::string(1, c);
  }
  std::string old_mac = text;
  std::replace(old_mac.begin(), old_mac.end(), '\n', '\r');
  for (const std::string& variant : {one_each, commas, old_mac, "\xEF\xBB\xBF" + text, text + "\x1A", text + "\n\n"}) {
    const Parsed p = parse(variant);
    EXPECT_EQ(p.profile.candela, parse(text).profile.candela);
    EXPECT_TRUE(p.warnings.empty());
  }
  EXPECT_THAT(parse(text + "5").warnings.at(0).message, HasSubstr("more follows"));
}

TEST(unit_io_ies, signs_and_exponents_are_numbers) {
  IesText t;
  t.lamp = "1 -1 +1.0E+0";
  t.candela = "+1e2 5.0e1 .0";
  EXPECT_EQ(parse(t).profile.candela, parse(IesText()).profile.candela);
}

// ----- types A and B: both angles are 0 where the lamp is aimed, -z; up is +x, and clockwise is towards -y

constexpr float kDegree = kPi / 180.0f;

std::string numbers(const std::vector<double>& values) {
  std::string text;
  for (const double v : values) text += std::to_string(v) + ' ';
  return text;
}

/// A table whose candela are 100 + vertical + 1000 (horizontal + 200), which bilinear lookup gives back exactly.
IesText plane_table(const char* type, const std::vector<double>& vertical, const std::vector<double>& horizontal) {
  IesText t;
  t.type = type;
  t.counts = std::to_string(vertical.size()) + ' ' + std::to_string(horizontal.size());
  t.vertical = numbers(vertical);
  t.horizontal = numbers(horizontal);
  t.candela.clear();
  for (const double h : horizontal) {
    for (const double v : vertical) t.candela += std::to_string(200 + v + 1000 * (h + 200)) + ' ';
  }
  return t;
}
float plane(float v, float h) { return 200 + v + 1000 * (h + 200); }

/// Type B: a plane through the y axis turned up by v, in it the latitude h. Type A: the same of the x axis.
vec3 direction_b(float v, float h) {
  return {std::sin(v * kDegree) * std::cos(h * kDegree), -std::sin(h * kDegree),
          -std::cos(v * kDegree) * std::cos(h * kDegree)};
}
vec3 direction_a(float v, float h) {
  return {std::sin(v * kDegree), -std::sin(h * kDegree) * std::cos(v * kDegree),
          -std::cos(h * kDegree) * std::cos(v * kDegree)};
}

TEST(unit_io_ies, types_a_and_b_are_globes_on_their_sides) {
  const std::vector<double> angles = {-90, -60, -25, 10, 40, 90};
  const IesProfile b = parse(plane_table("2", angles, angles)).profile;
  const IesProfile a = parse(plane_table("3", angles, angles)).profile;
  for (const float v : {-80.0f, -25.0f, 0.0f, 12.5f, 30.0f, 75.0f}) {
    for (const float h : {-85.0f, -60.0f, -7.0f, 0.0f, 30.0f, 80.0f}) {
      EXPECT_NEAR(ies_intensity(b, direction_b(v, h)), plane(v, h), 2.0f) << v << ' ' << h;
      EXPECT_NEAR(ies_intensity(a, direction_a(v, h)), plane(v, h), 2.0f) << v << ' ' << h;
    }
  }
  // Where one of the angles is 0 they agree: up is +x and clockwise, seen from the lamp with +x up, is -y.
  for (const IesProfile& p : {a, b}) {
    EXPECT_NEAR(ies_intensity(p, {0, 0, -1}), plane(0, 0), 2.0f);
    EXPECT_NEAR(ies_intensity(p, {std::sin(0.5f), 0, -std::cos(0.5f)}), plane(0.5f / kDegree, 0), 2.0f);
    EXPECT_NEAR(ies_intensity(p, {0, -std::sin(0.5f), -std::cos(0.5f)}), plane(0, 0.5f / kDegree), 2.0f);
  }
  // Nothing behind.
  EXPECT_EQ(ies_intensity(b, {0.1f, 0.2f, 0.9f}), 0.0f);
  EXPECT_EQ(ies_intensity(a, {0.1f, 0.2f, 0.9f}), 0.0f);
}

TEST(unit_io_ies, angles_of_types_a_and_b_that_begin_at_0_are_mirrored) {
  for (const char* type : {"2", "3"}) {
    const auto direction = type[0] == '2' ? direction_b : direction_a;
    const IesProfile quarter = parse(plane_table(type, {0, 30, 90}, {0, 45, 90})).profile;
    const IesProfile half = parse(plane_table(type, {-90, 0, 90}, {0, 45, 90})).profile;
    for (const float v : {-50.0f, 20.0f}) {
      for (const float h : {-70.0f, 33.0f}) {
        EXPECT_NEAR(ies_intensity(quarter, direction(v, h)), plane(std::fabs(v), std::fabs(h)), 2.0f) << type;
        EXPECT_NEAR(ies_intensity(half, direction(v, h)), plane(v, std::fabs(h)), 2.0f) << type;
      }
    }
  }
}

TEST(unit_io_ies, types_a_and_b_may_go_all_around_and_are_dark_outside_their_table) {
  // 1 everywhere: 4π lumens; a lune of 60°: a sixth of it; a belt of latitudes up to 30°: half of it.
  const auto flux = [](const char* type, const std::vector<double>& vertical, const std::vector<double>& horizontal) {
    IesText t = plane_table(type, vertical, horizontal);
    t.candela.clear();
    for (std::size_t i = 0; i < vertical.size() * horizontal.size(); ++i) t.candela += "1 ";
    return ies_flux(parse(t).profile);
  };
  const double whole = 4.0 * M_PI;
  EXPECT_NEAR(flux("2", {-180, 0, 180}, {-90, 0, 90}), whole, 1e-3);
  EXPECT_NEAR(flux("3", {-90, 0, 90}, {-180, 0, 180}), whole, 1e-3);
  EXPECT_NEAR(flux("2", {-180, 180}, {-90, 90}), whole, 1e-3);
  EXPECT_NEAR(flux("2", {-30, 30}, {-90, 90}), whole / 6, 1e-3);
  EXPECT_NEAR(flux("3", {-90, 90}, {-30, 30}), whole / 6, 1e-3);
  EXPECT_NEAR(flux("2", {10, 70}, {-90, 90}), whole / 6, 1e-3);
  EXPECT_NEAR(flux("2", {-180, 180}, {-30, 30}), whole / 2, 1e-3);
  EXPECT_NEAR(flux("3", {-30, 30}, {-180, 180}), whole / 2, 1e-3);
}

// ----- bad input: the line, and what is wrong with it

TEST(unit_io_ies, each_bad_number_names_its_line) {
  const auto changed = [](std::string IesText::*part, const char* to) {
    IesText t;
    t.*part = to;
    return error_of(t);
  };
  EXPECT_EQ(error_of(IesText()), "parsed");
  // Line 5 is TILT, 6 the lamp, 7 the ballast, 8 to 10 the table.
  EXPECT_EQ(changed(&IesText::type, "2"), "lamp.ies: line 6: types A and B need at least 2 horizontal angles");
  EXPECT_EQ(changed(&IesText::type, "3"), "lamp.ies: line 6: types A and B need at least 2 horizontal angles");
  EXPECT_THAT(changed(&IesText::type, "0"), HasSubstr("line 6: the photometric type must be"));
  EXPECT_THAT(changed(&IesText::type, "9"), HasSubstr("line 6: the photometric type is 9; must be a whole number"));
  EXPECT_THAT(changed(&IesText::lamp, "1 1000 0"), HasSubstr("line 6: the candela multiplier is 0; must be positive"));
  EXPECT_THAT(changed(&IesText::lamp, "1 many 1"),
              HasSubstr("line 6: the lumens per lamp is 'many', which is no finite number"));
  EXPECT_THAT(changed(&IesText::lamp, "nan 1000 1"), HasSubstr("line 6: the number of lamps is 'nan'"));
  EXPECT_THAT(changed(&IesText::opening, "2 inf 0 0"), HasSubstr("line 6: the width is 'inf'"));
  EXPECT_THAT(changed(&IesText::counts, "1 1"), HasSubstr("line 6: needs at least 2 vertical angles"));
  EXPECT_THAT(changed(&IesText::counts, "3 0"), HasSubstr("line 6: needs at least 1 horizontal angle"));
  EXPECT_THAT(changed(&IesText::counts, "2.5 1"), HasSubstr("line 6: the number of vertical angles is 2.5"));
  EXPECT_THAT(changed(&IesText::counts, "-3 1"), HasSubstr("line 6: the number of vertical angles is -3"));
  EXPECT_THAT(changed(&IesText::counts, "4000000000 1"), HasSubstr("line 6: the number of vertical angles is 4e+09"));
  EXPECT_THAT(changed(&IesText::counts, "20 20"), HasSubstr("line 6: the file is too short for 20 × 20"));
  EXPECT_THAT(changed(&IesText::ballast, "0 1 50"), HasSubstr("line 7: the ballast factor is 0"));
  EXPECT_THAT(changed(&IesText::ballast, "1 1 1e999"), HasSubstr("line 7: the input watts is '1e999'"));
  EXPECT_THAT(changed(&IesText::vertical, "0 90 45"),
              HasSubstr("line 8: vertical angle 3 of 3 is 45; must be greater than the one before, 90"));
  EXPECT_THAT(changed(&IesText::vertical, "0 45 45"), HasSubstr("line 8: vertical angle 3 of 3 is 45"));
  EXPECT_THAT(changed(&IesText::vertical, "0 45 200"), HasSubstr("line 8: vertical angle 3 of 3 is 200; must lie"));
  EXPECT_THAT(changed(&IesText::vertical, "-90 0 90"), HasSubstr("line 8: vertical angle 1 of 3 is -90"));
  EXPECT_THAT(changed(&IesText::candela, "100 x\x01y 0"), HasSubstr("line 10: the candela value 2 of 3 is 'x?y'"));
  EXPECT_THAT(changed(&IesText::candela, "100 -5 0"), HasSubstr("line 10: candela value 2 of 3 is -5 cd; must lie"));
  EXPECT_THAT(changed(&IesText::candela, "100 1e30 0"), HasSubstr("line 10: candela value 2 of 3 is 1e+30 cd"));
  EXPECT_THAT(changed(&IesText::candela, "100 50"),
              HasSubstr("line 11: the file ends before the candela value 3 of 3"));
  EXPECT_THAT(error_of(with_rows("0 30 100", "3 3", "0 1 0 0 1 0 0 1 0")),
              HasSubstr("line 10: the horizontal angles run from 0 to 100; must be"));
  EXPECT_THAT(error_of(with_rows("10 90", "3 2", "0 1 0 0 1 0")), HasSubstr("the horizontal angles run from 10 to 90"));
}

TEST(unit_io_ies, what_is_no_ies_file_says_so) {
  EXPECT_EQ(error_of(std::string()), "lamp.ies: line 1: the file is empty");
  EXPECT_THAT(error_of("hello\nworld\n"), HasSubstr("line 2: no line begins with TILT=; this is no IES file"));
  EXPECT_THAT(error_of("IESNA:LM-63-2002\nTILT=NONE\n"), HasSubstr("the file ends before the number of lamps"));
  IesText t;
  t.tilt = "TILT=INCLUDE\n1\n99999999\n0 45";
  EXPECT_THAT(error_of(t), HasSubstr("line 7: the number of tilt angles is 1e+08"));
  EXPECT_THAT(error_of(std::string((8 << 20) + 1, ' ')), HasSubstr("larger than 8 MiB"));
}

TEST(unit_io_ies, files_are_named_after_themselves) {
  const candela::test::TempFolder folder;
  write_file(folder / "downlight.ies", IesText().text());
  Diagnostics diagnostics;
  EXPECT_EQ(load_ies(folder / "downlight.ies", diagnostics).name, "downlight");
  EXPECT_THROW(load_ies(folder / "absent.ies", diagnostics), Error);
}

TEST(unit_io_ies, mutants_give_an_error_or_a_valid_profile) {
  std::mt19937 random(1);
  static constexpr char kAlphabet[] = "0123456789.-+e ,\n\r\tTIL=N\0\xFF";
  std::vector<std::string> seeds{IesText().text(), with_rows("0 30 90", "3 3", "9 8 7  6 5 4  3 2 1").text(),
                                 with_rows("90 150 240 270", "3 4", "1 2 3 4 5 6 7 8 9 10 11 12").text()};
  IesText tilted;
  tilted.tilt = "TILT=INCLUDE\n1\n2\n0 90\n1 1";
  seeds.push_back(tilted.text());
  int good = 0, bad = 0;
  for (const std::string& seed : seeds) {
    for (int i = 0; i < 5000; ++i) {
      std::string mutant = seed;
      for (unsigned k = 0; k < 1 + random() % 3; ++k) {
        const std::size_t place = random() % mutant.size();
        const char c = kAlphabet[random() % (sizeof kAlphabet - 1)];
        switch (random() % 8) {
          case 0:
            mutant.resize(place + 1);
            break;
          case 1:
          case 2:
            mutant.erase(place, 1);
            if (mutant.empty()) mutant = " ";
            break;
          case 3:
          case 4:
            mutant.insert(place, 1, c);
            break;
          default:
            mutant[place] = c;
        }
      }
      Diagnostics diagnostics;
      try {
        const IesProfile p = parse_ies(mutant, "mutant", diagnostics);
        ASSERT_TRUE(is_valid(p)) << mutant;
        ASSERT_TRUE(std::isfinite(ies_flux(p)));
        for (int step = 0; step < 16; ++step) ASSERT_GE(at(p, 12.0 * step, 24.0 * step), 0.0f);
        good += 1;
      } catch (const Error& error) {
        ASSERT_THAT(error.what(), HasSubstr("mutant: line "));
        bad += 1;
      }
    }
  }
  EXPECT_GT(good, 2000);
  EXPECT_GT(bad, 2000);
}

}  // namespace
}  // namespace candela::io::test
