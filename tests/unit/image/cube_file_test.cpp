#include "image/cube_file.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/file.h"
#include "image/develop.h"
#include "image/image_file.h"
#include "image/texture_file.h"
#include "unit/base/temp_folder.h"
#include "unit/image/image_util.h"
#include "unit/image/labelled_cube.h"

namespace candela {
namespace {

Cubemap labelled_cube(int size, int levels = 1) {
  Cubemap cube;
  for (int level = 0; level < levels; ++level) cube.levels.push_back(test::labelled_faces(size >> level));
  return cube;
}

TEST(unit_image_cube_file, textures_come_back_in_the_axes_of_the_world) {
  const test::TempFolder folder;
  const Cubemap cube = labelled_cube(8, 3);
  const TextureOptions full{.format = TexelFormat::rgba32f};
  write_texture(folder / "plain.ktx2", cube, full);
  EXPECT_EQ(find_cube_source(folder / "plain.ktx2"), CubeSource::texture);
  const Cubemap plain = read_cubemap(folder / "plain.ktx2");
  ASSERT_EQ(plain.levels.size(), 3u);
  for (std::size_t level = 0; level < 3; ++level)
    EXPECT_TRUE(test::faces_are_equal(plain.levels[level], cube.levels[level]));

  // A file for an engine with other axes says so, and is read back all the same; without the key it has to be told.
  const CubeAxes axes = *parse_axes("+z-x+y");
  TextureOptions turned = full;
  turned.key_values = {{kAxesKey, axes_text(axes)}};
  write_texture(folder / "keyed.ktx2", file_from_world(cube, axes), turned);
  EXPECT_TRUE(test::faces_are_equal(read_cubemap(folder / "keyed.ktx2").levels[2], cube.levels[2]));
  write_texture(folder / "silent.ktx2", file_from_world(cube, axes), full);
  EXPECT_TRUE(test::faces_are_equal(read_cubemap(folder / "silent.ktx2", axes).levels[0], cube.levels[0]));
  EXPECT_FALSE(test::faces_are_equal(read_cubemap(folder / "silent.ktx2").levels[0], cube.levels[0]));
  turned.key_values = {{kAxesKey, "sideways"}};
  write_texture(folder / "bad.ktx2", cube, turned);
  EXPECT_THROW(read_cubemap(folder / "bad.ktx2"), Error);
}

TEST(unit_image_cube_file, pictures_are_what_someone_inside_sees) {
  const test::TempFolder folder;
  const CubeFaces world = test::labelled_faces(4);
  for (const CubeLayout layout :
       {CubeLayout::cross_4x3, CubeLayout::cross_3x4, CubeLayout::strip_6x1, CubeLayout::strip_1x6}) {
    write_linear_image(folder / "a.exr", layout_from_faces(file_from_world(world, kPictureAxes), layout));
    EXPECT_EQ(find_cube_source(folder / "a.exr"), CubeSource::layout);
    EXPECT_TRUE(test::faces_are_equal(read_cubemap(folder / "a.exr").levels[0], world));
    write_linear_image(folder / "a.exr", layout_from_faces(world, layout));
    EXPECT_TRUE(test::faces_are_equal(read_cubemap(folder / "a.exr", CubeAxes()).levels[0], world));
    EXPECT_FALSE(test::faces_are_equal(read_cubemap(folder / "a.exr").levels[0], world));
  }
}

TEST(unit_image_cube_file, six_files_are_found_by_any_of_their_names) {
  const CubeFaces world = test::labelled_faces(4);
  const CubeFaces pictures = file_from_world(world, kPictureAxes);
  const std::array<std::array<const char*, 6>, 4> sets{{{"px", "nx", "py", "ny", "pz", "nz"},
                                                        {"posx", "negx", "posy", "negy", "posz", "negz"},
                                                        {"right", "left", "top", "bottom", "front", "back"},
                                                        {"sky_px", "sky_nx", "sky_py", "sky_ny", "sky_pz", "sky_nz"}}};
  for (const auto& names : sets) {
    const test::TempFolder folder;
    EXPECT_EQ(find_cube_source(folder.path()), CubeSource::none);
    EXPECT_THROW(read_cubemap(folder.path()), Error);
    for (std::size_t face = 0; face < 6; ++face)
      write_linear_image(folder / (std::string(names[face]) + ".exr"), pictures[face]);
    EXPECT_EQ(find_cube_source(folder.path()), CubeSource::six_files);
    EXPECT_TRUE(test::faces_are_equal(read_cubemap(folder.path()).levels[0], world)) << names[0];
    const std::string prefix = std::string(names[0]).starts_with("sky_") ? "sky_" : "";
    EXPECT_TRUE(test::faces_are_equal(read_cubemap(folder / (prefix + "%s.exr")).levels[0], world));
    EXPECT_EQ(find_cube_source(folder / "other_%s.exr"), CubeSource::none);
    EXPECT_THROW(read_cubemap(folder / "other_%s.exr"), Error);
  }
}

TEST(unit_image_cube_file, faces_that_do_not_belong_together_are_refused) {
  const test::TempFolder folder;
  Cubemap cube = labelled_cube(4);
  const auto paths = write_cube_faces(folder / "sky.exr", cube);
  ASSERT_EQ(paths.size(), 6u);
  EXPECT_EQ(paths[3].filename(), "sky_ny.exr");
  EXPECT_TRUE(test::faces_are_equal(read_cubemap(folder.path(), CubeAxes()).levels[0], cube.levels[0]));
  write_linear_image(paths[3], Image(5, 5, 3));
  EXPECT_THROW(read_cubemap(folder.path()), Error);
  write_linear_image(paths[3], Image(4, 5, 3));
  EXPECT_THROW(read_cubemap(folder.path()), Error);
  write_linear_image(paths[3], Image(4, 4, 3));
  EXPECT_NO_THROW(read_cubemap(folder.path()));
  write_linear_image(folder / "night_ny.exr", Image(4, 4, 3));
  EXPECT_THROW(read_cubemap(folder.path()), Error);  // which of the two?
}

TEST(unit_image_cube_file, levels_of_faces_have_numbers) {
  const test::TempFolder folder;
  const auto paths = write_cube_faces(folder / "sky.hdr", labelled_cube(4, 2));
  ASSERT_EQ(paths.size(), 12u);
  EXPECT_EQ(paths[7].filename(), "sky_m1_nx.hdr");
  EXPECT_EQ(read_image(paths[7]).width, 2);
  EXPECT_THROW(write_cube_faces(folder / "sky.png", labelled_cube(4)), Error);
}

TEST(unit_image_cube_file, panoramas_and_other_things_are_no_cube_maps) {
  const test::TempFolder folder;
  write_linear_image(folder / "panorama.hdr", Image(8, 4, 3));
  EXPECT_FALSE(is_cubemap_file(folder / "panorama.hdr"));
  EXPECT_THROW(read_cubemap(folder / "panorama.hdr"), Error);
  EXPECT_EQ(read_environment_file(folder / "panorama.hdr").panorama.width, 8);
  EXPECT_TRUE(read_environment_file(folder / "panorama.hdr").cube.empty());
  EXPECT_FALSE(is_cubemap_file(folder / "absent.ktx2"));
  EXPECT_THROW(read_cubemap(folder / "absent.ktx2"), Error);
  write_file(folder / "text.ktx2", "hello");
  EXPECT_FALSE(is_cubemap_file(folder / "text.ktx2"));
  EXPECT_THROW(read_cubemap(folder / "text.ktx2"), Error);
  write_texture(folder / "table.ktx2", Image(4, 4, 3), {});
  EXPECT_FALSE(is_cubemap_file(folder / "table.ktx2"));
  EXPECT_THROW(read_cubemap(folder / "table.ktx2"), Error);
}

/// Largest error of what a reader makes of an RGBM file, over the largest channel of the texel.
double rgbm_error(const Image& image, const Rgbm& written, const Rgbm& read) {
  const test::TempFolder folder;
  write_rgbm_png(folder / "a.png", image, written);
  const TextureImage texture = decode_texture(read_file(folder / "a.png"), "t");
  double worst = 0.0;
  for (std::size_t i = 0; i < texture.pixels.size() / 4; ++i) {
    const std::uint8_t* p = texture.pixels.data() + 4 * i;
    const float scale = static_cast<float>(p[3]) / 255.0f * read.range;
    vec3 color = vec3(p[0], p[1], p[2]) / 255.0f * scale;
    if (read.is_squared) color *= color;
    const vec3 original(image.pixels[3 * i], image.pixels[3 * i + 1], image.pixels[3 * i + 2]);
    worst = std::max(worst, static_cast<double>(max_component(glm::abs(color - original)) / max_component(original)));
  }
  return worst;
}

TEST(unit_image_cube_file, rgbm_keeps_colours_to_its_steps) {
  Image image(32, 32, 3);
  std::mt19937 random(5);
  for (float& v : image.pixels) v = 1.0f + static_cast<float>(random() % 1000) / 100.0f;
  const Rgbm linear{.range = 16.0f}, squared{.range = 16.0f, .is_squared = true};
  EXPECT_LT(rgbm_error(image, linear, linear), 0.004);  // half a step of an 8-bit channel that is at least half used
  EXPECT_LT(rgbm_error(image, squared, squared), 0.008);
  EXPECT_GT(rgbm_error(image, linear, squared), 0.1);  // the twin: read by the other law
}

TEST(unit_image_cube_file, rgbm_counts_what_it_cannot_hold) {
  const test::TempFolder folder;
  Image image(4, 1, 3);
  image.set_rgb(0, 0, vec3(16.5f, 1.0f, 0.0f));
  image.set_rgb(1, 0, vec3(-1.0f, 1.0f, 0.0f));
  image.set_rgb(2, 0, vec3(std::nanf("")));
  const EncodingLoss loss = write_rgbm_png(folder / "a.png", image, {});
  EXPECT_EQ(loss.clamped, 1u);
  EXPECT_EQ(loss.negative, 1u);
  EXPECT_EQ(loss.non_finite, 1u);
  EXPECT_EQ(loss.largest, 16.5f);
  EXPECT_THROW(write_rgbm_png(folder / "b.png", image, {.range = 0.0f}), Error);
  EXPECT_FALSE(std::filesystem::exists(folder / "b.png"));
}

}  // namespace
}  // namespace candela
