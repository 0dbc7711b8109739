#include "image/table_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "unit/base/temp_folder.h"
#include "unit/image/image_util.h"

namespace candela {
namespace {

std::string text_of(const std::filesystem::path& path) {
  const auto bytes = read_file(path);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

nlohmann::json json_of(const std::filesystem::path& path) { return nlohmann::json::parse(text_of(path)); }

const ShText kSh{"irradiance / pi", "real", "+x+y+z", "a \"sky\"\n*/ int x;"};
const std::vector<dvec3> kFour{{1.0, 0.5, 0.1}, {-1e-30, 3e7, 0.0}, {0.2, 0.3, 0.4}, {1.0 / 3.0, 2.0, -7.0}};

/// Every float literal behind the "=" of an array, in order.
std::vector<float> literals(const std::string& header) {
  std::vector<float> values;
  for (std::size_t i = header.find("] = {"); i < header.size(); ++i) {
    const char c = header[i];
    if ((c != '-' && std::isdigit(static_cast<unsigned char>(c)) == 0)) continue;
    char* end = nullptr;
    values.push_back(std::strtof(header.c_str() + i, &end));
    i = static_cast<std::size_t>(end - header.c_str());
    EXPECT_EQ(header[i], 'f');
  }
  return values;
}

TEST(unit_image_table_file, harmonics_come_back_from_json_to_the_last_bit) {
  const test::TempFolder folder;
  write_sh_json(folder / "a.json", kFour, kSh);
  const auto json = json_of(folder / "a.json");
  EXPECT_EQ(json["bands"], 2);
  EXPECT_EQ(json["unit"], kSh.unit);
  EXPECT_EQ(json["source"], kSh.source);
  ASSERT_EQ(json["coefficients"].size(), 4u);
  for (std::size_t i = 0; i < 4; ++i)
    for (int c = 0; c < 3; ++c)
      EXPECT_EQ(json["coefficients"][i][static_cast<std::size_t>(c)].get<float>(), static_cast<float>(kFour[i][c]));
}

TEST(unit_image_table_file, headers_are_c_whatever_the_texts_say) {
  const test::TempFolder folder;
  write_sh_header(folder / "a.h", kFour, kSh, "sky_sh");
  const std::string header = text_of(folder / "a.h");
  EXPECT_EQ(header.find("*/"), header.rfind("*/"));  // one comment, closed once
  EXPECT_NE(header.find("static const float sky_sh[4][3] = {"), std::string::npos);
  const std::vector<float> values = literals(header);
  ASSERT_EQ(values.size(), 12u);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(values[i], static_cast<float>(kFour[i / 3][static_cast<int>(i % 3)]));

  const Image table = test::random_image(4, 3, 3);
  write_table_header(folder / "t.h", table, {"t", "NoV", "roughness", {"scale", "bias"}}, "dfg");
  write_file(folder / "main.c",
             "#include \"a.h\"\n#include \"t.h\"\nint main(void) { return sky_sh_coefficients + "
             "dfg_width + dfg_height + dfg_channels == 13 && dfg[2][3][1] > -1.0f && sky_sh[1][1] "
             "== 3e7f ? 0 : 1; }\n");
  const std::string main = (folder / "main").string();
  ASSERT_EQ(std::system(("cc -std=c99 -Wall -Wextra -pedantic -Werror -o " + main + " " + main + ".c").c_str()), 0);
  EXPECT_EQ(std::system(main.c_str()), 0);
}

TEST(unit_image_table_file, tables_have_the_named_channels_by_row_and_column) {
  const test::TempFolder folder;
  const Image table = test::random_image(5, 3, 3);
  const TableText text{"split sum", "NoV", "roughness", {"scale", "bias"}};
  write_table_json(folder / "t.json", table, text);
  const auto json = json_of(folder / "t.json");
  EXPECT_EQ(json["width"], 5);
  EXPECT_EQ(json["height"], 3);
  EXPECT_EQ(json["channels"], (std::vector<std::string>{"scale", "bias"}));
  for (std::size_t y = 0; y < 3; ++y) {
    for (std::size_t x = 0; x < 5; ++x) {
      ASSERT_EQ(json["values"][y][x].size(), 2u);
      const auto texel = table.at(static_cast<int>(x), static_cast<int>(y));
      EXPECT_EQ(json["values"][y][x][0].get<float>(), texel[0]);
      EXPECT_EQ(json["values"][y][x][1].get<float>(), texel[1]);
    }
  }
}

TEST(unit_image_table_file, what_cannot_be_written_is_an_error_and_leaves_no_file) {
  const test::TempFolder folder;
  const Image table = test::random_image(2, 2, 3);
  std::vector<dvec3> infinite = kFour;
  infinite[2].y = HUGE_VAL;
  Image nan = table;
  nan.pixels[3] = std::nanf("");
  EXPECT_THROW(write_sh_json(folder / "a", infinite, kSh), Error);
  EXPECT_THROW(write_sh_json(folder / "a", std::span(kFour).first(3), kSh), Error);
  EXPECT_THROW(write_sh_header(folder / "a", kFour, kSh, "2sky"), Error);
  EXPECT_THROW(write_sh_header(folder / "a", kFour, kSh, "a b"), Error);
  EXPECT_THROW(write_table_json(folder / "a", nan, {"t", "c", "r", {"x", "y"}}), Error);
  EXPECT_THROW(write_table_json(folder / "a", table, {"t", "c", "r", {}}), Error);
  EXPECT_THROW(write_table_header(folder / "a", table, {"t", "c", "r", {"1", "2", "3", "4"}}, "t"), Error);
  EXPECT_THROW(write_table_header(folder / "a", Image(), {"t", "c", "r", {"x"}}, "t"), Error);
  EXPECT_EQ(folder.entries(), 0u);
}

}  // namespace
}  // namespace candela
