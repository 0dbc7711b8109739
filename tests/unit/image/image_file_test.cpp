#include "image/image_file.h"

#include <gtest/gtest.h>

#include "base/file.h"
#include "image/film.h"
#include "shade/color.glsl.h"
#include "unit/base/temp_folder.h"
#include "unit/image/image_util.h"

namespace candela {
namespace {

using test::TempFolder;

TEST(unit_image_file, the_format_is_known_from_the_first_bytes_alone) {
  const TempFolder folder;
  Film film;
  film.beauty = test::random_image(8, 8, 3);
  const std::pair<const char*, ImageFormat> formats[] = {
      {".png", ImageFormat::png}, {".jpg", ImageFormat::jpeg}, {".hdr", ImageFormat::hdr}, {".exr", ImageFormat::exr}};
  for (const auto& [extension, format] : formats) {
    const auto path = folder / (std::string("a") + extension);
    write_film(path, film, {});
    const test::Bytes bytes = read_file(path);
    EXPECT_EQ(sniff_image_format(bytes), format);
    EXPECT_EQ(sniff_image_format(std::span(bytes).first(2)), ImageFormat::unknown);
    write_file(folder / "misleading.gif", bytes);
    EXPECT_EQ(read_image(folder / "misleading.gif").width, 8);
  }
  EXPECT_EQ(sniff_image_format({}), ImageFormat::unknown);
}

TEST(unit_image_file, png_is_decoded_to_premultiplied_linear_light) {
  const TempFolder folder;
  DisplayImage image = test::random_display(16, 16, false);
  write_png(folder / "a.png", image);
  const Image linear = read_image(folder / "a.png");
  ASSERT_EQ(linear.channels, 4);
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    const float alpha = static_cast<float>(image.rgba[i + 3]) / 255.0f;
    EXPECT_FLOAT_EQ(linear.pixels[i + 3], alpha);
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(linear.pixels[i + c],
                  shade::srgb_decode_channel(static_cast<float>(image.rgba[i + c]) / 255.0f) * alpha, 1e-6f);
  }
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
  write_png(folder / "a.png", image);
  EXPECT_EQ(read_image(folder / "a.png").channels, 3);
}

TEST(unit_image_file, what_is_no_picture_is_an_error_that_names_it) {
  const TempFolder folder;
  write_file(folder / "a.png", std::string("not a picture"));
  try {
    read_image(folder / "a.png");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.where(), (folder / "a.png").string());
  }
  EXPECT_THROW(read_image(folder / "missing.png"), Error);
  EXPECT_THROW(read_exr_header(folder / "a.png"), Error);
}

TEST(unit_image_file, a_texture_is_png_or_jpeg) {
  const TempFolder folder;
  write_hdr(folder / "a.hdr", test::random_image(8, 8, 3));
  const test::Bytes bytes = read_file(folder / "a.hdr");
  EXPECT_THROW(decode_texture(bytes, "t"), Error);
  EXPECT_THROW(read_image_size(bytes, "t"), Error);
  EXPECT_THROW(decode_texture({}, "t"), Error);
}

TEST(unit_image_file, only_exr_has_layers) {
  const TempFolder folder;
  write_hdr(folder / "a.hdr", test::random_image(8, 8, 3));
  EXPECT_THROW(read_image(folder / "a.hdr", "albedo"), Error);
}

TEST(unit_image_file, every_writer_reports_a_missing_folder_and_a_full_disk) {
  const TempFolder folder;
  Film film;
  film.beauty = test::random_image(100, 100, 3);
  for (const char* name : {"a.png", "a.jpg", "a.hdr", "a.exr"}) {
    EXPECT_THROW(write_film(folder / "missing" / name, film, {}), Error) << name;
    const test::FullDisk full(1000);
    EXPECT_THROW(write_film(folder / name, film, {}), Error) << name;
  }
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(unit_image_film, layer_names_are_those_of_the_command_line) {
  std::string known;
  for (const LayerInfo& info : kLayers) {
    EXPECT_EQ(&layer_info(info.layer), &info) << info.name;
    EXPECT_EQ(layer_name(parse_layer(info.name)), info.name);
    known += (known.empty() ? "" : ", ") + std::string(info.name);
  }
  try {
    parse_layer("beauty");
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(e.message().find(known), std::string::npos);
  }
}

}  // namespace
}  // namespace candela
