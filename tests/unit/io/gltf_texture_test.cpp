#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/file.h"
#include "image/image_file.h"
#include "io/gltf_survey.h"
#include "unit/base/temp_folder.h"
#include "unit/image/basis_files.h"
#include "unit/image/ktx2_builder.h"
#include "unit/io/gltf_builder.h"

// Images in KTX 2: KHR_texture_basisu and EXT_texture_astc.
namespace candela::io::test {
namespace {

using candela::test::basis_file;
using candela::test::Ktx2;
using ::testing::HasSubstr;

/// A textured triangle whose image is `extension`'s, beside a PNG of one texel where there is a fallback.
Builder textured(const char* extension, const json& image, bool has_fallback) {
  Builder b = with_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  if (has_fallback) add_texture(b);
  b.root["images"].push_back(image);
  const auto index = b.root["images"].size() - 1;
  if (!has_fallback) b.root["textures"].push_back(json::object());
  b.root["textures"][0]["extensions"][extension]["source"] = index;
  b.root["extensionsUsed"] = {extension};
  if (!has_fallback) b.root["extensionsRequired"] = {extension};
  return b;
}

std::vector<std::byte> astc_file() {
  // A void-extent block of a plain colour: the ASTC of one texel that needs no encoder.
  Ktx2 file{.vk_format = 157, .width = 8, .height = 4, .model = 162, .channels = {0}};
  std::vector<std::byte> block(16, std::byte{0xff});
  block[0] = std::byte{0xfc};
  block[1] = std::byte{0xfd};
  for (std::size_t c = 0; c < 4; ++c) block[8 + 2 * c] = block[9 + 2 * c] = static_cast<std::byte>(40 * (c + 1));
  file.levels = {block};
  file.levels[0].insert(file.levels[0].end(), block.begin(), block.end());
  return file.bytes();
}

TEST(unit_io_gltf_texture, ktx2_images_are_read_from_a_view_a_data_uri_and_a_file) {
  const candela::test::TempFolder folder;
  const std::vector<std::byte> file = basis_file("etc1s.ktx2");
  write_file(folder.path() / "wood.ktx2", file);
  const TextureImage expected = decode_texture(file, "t");
  for (const bool has_fallback : {true, false}) {
    Builder view = textured("KHR_texture_basisu", {}, has_fallback);
    view.root["images"].back() = {{"bufferView", view.view(file)}, {"mimeType", "image/ktx2"}};
    const Builder data =
        textured("KHR_texture_basisu", {{"uri", "data:image/ktx2;base64," + base64(file)}}, has_fallback);
    const Builder name = textured("KHR_texture_basisu", {{"uri", "wood.ktx2"}}, has_fallback);
    for (const Builder& b : {view, data, name}) {
      Diagnostics diagnostics;
      FileInfo info;
      const Scene scene = load_gltf(b.glb(), folder.path(), diagnostics, {}, &info);
      EXPECT_TRUE(diagnostics.warnings().empty());
      EXPECT_TRUE(info.extensions_missing.empty() && info.extensions_unseen.empty());
      ASSERT_EQ(scene.images.size(), 1u);  // never the fallback
      EXPECT_EQ(scene.images[0]->width, 37);
      EXPECT_EQ(scene.images[0]->height, 22);
      EXPECT_EQ(scene.images[0]->pixels, expected.pixels);
    }
  }
}

TEST(unit_io_gltf_texture, astc_images_are_read) {
  for (const bool has_fallback : {true, false}) {
    Builder b = textured("EXT_texture_astc", {}, has_fallback);
    b.root["images"].back() = {{"bufferView", b.view(astc_file())}, {"mimeType", "image/ktx2"}};
    const Loaded loaded = load(b);
    EXPECT_TRUE(loaded.warnings.empty());
    ASSERT_EQ(loaded.scene.images.size(), 1u);
    const TextureImage& image = *loaded.scene.images[0];
    EXPECT_EQ(image.width, 8);
    EXPECT_EQ(image.height, 4);
    EXPECT_EQ(std::vector<std::uint8_t>(image.pixels.begin(), image.pixels.begin() + 4),
              (std::vector<std::uint8_t>{40, 80, 120, 160}));
  }
}

TEST(unit_io_gltf_texture, a_survey_names_format_and_packing_without_decoding) {
  Builder b = textured("KHR_texture_basisu", {}, false);
  std::vector<std::byte> file = basis_file("uastc_alpha_zstd.ktx2");
  // What is packed is damaged: only decoding would see it.
  std::uint64_t level = 0;
  std::memcpy(&level, file.data() + 80, sizeof level);
  file.at(level) ^= std::byte{0x55};
  b.root["images"][0] = {{"bufferView", b.view(file)}};
  const FileSurvey survey = survey_gltf(b.glb(), {}, {});
  ASSERT_EQ(survey.images.size(), 1u);
  EXPECT_EQ(survey.images[0].error, "");
  EXPECT_EQ(survey.images[0].format, "KTX 2, uastc-4x4, zstd");
  EXPECT_TRUE(survey.images[0].has_alpha);
  EXPECT_NE(survey_gltf(b.glb(), {}, {.decode_images = true}).images[0].error, "");
}

TEST(unit_io_gltf_texture, what_is_not_read_is_told_in_one_line_and_left_out) {
  const std::vector<std::byte> level(16);
  struct Case {
    Ktx2 file;
    const char* told;
  };
  const std::vector<Case> cases = {
      {{.vk_format = 145, .model = 134, .levels = {level}}, "the format bc7 is one of a kind of graphics card"},
      {{.vk_format = 147, .model = 161, .levels = {level}}, "the format etc2"},
      {{.scheme = 4, .model = 168, .levels = {level}}, "supercompression scheme 4 (UASTC HDR 6x6 intermediate)"},
      {{.scheme = 5, .model = 169, .levels = {level}}, "supercompression scheme 5 (XUASTC)"},
      {{.scheme = 77, .levels = {level}}, "supercompression by scheme 77 is not read"},
      {{.model = 200, .levels = {level}}, "undefined (model 200)"},
      {{.vk_format = 999, .levels = {level}}, "VkFormat 999"},
      {{.scheme = 1, .levels = {level}}, "BasisLZ and ETC1S go together"},
      {{.model = 163, .levels = {level}}, "BasisLZ and ETC1S go together"},
      {{.scheme = 1, .model = 163, .levels = {level}}, "the BasisLZ books are missing"},
      {{.layers = 3, .levels = {level}}, "volumes and arrays of textures are not read"},
      {{.depth = 3, .levels = {level}}, "volumes and arrays of textures are not read"},
      {{.key_values = {{"KTXanimData", "1"}}, .levels = {level}}, "video is not read"},
      {{.faces = 6, .levels = {std::vector<std::byte>(96)}}, "a cube map is no picture"},
      {{.width = 20000, .levels = {level}}, "20000 x 4"},
      {{.height = 8, .levels = {level}}, "level 0 has 16 bytes, not 32"},
  };
  for (const Case& c : cases) {
    for (const bool decode : {true, false}) {
      Builder b = textured("KHR_texture_basisu", {}, false);
      b.root["images"][0] = {{"bufferView", b.view(c.file.bytes())}};
      Diagnostics diagnostics;
      load_gltf(b.glb(), {}, diagnostics, LoadOptions{.decode_images = decode});
      ASSERT_EQ(diagnostics.warnings().size(), 1u) << c.told;
      EXPECT_THAT(diagnostics.warnings()[0].text(), HasSubstr(c.told));
      EXPECT_THAT(diagnostics.warnings()[0].text(), HasSubstr("shown without it"));
    }
  }
}

TEST(unit_io_gltf_texture, plain_texels_in_ktx2_are_read_as_they_are) {
  const auto bytes_of = [](std::initializer_list<int> values) {
    std::vector<std::byte> bytes;
    for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
    return bytes;
  };
  const auto pixels_of = [](const Ktx2& file) { return decode_texture(file.bytes(), "t").pixels; };
  using Codes = std::vector<std::uint8_t>;
  Ktx2 file{.width = 2, .height = 1, .model = 1, .channels = {0, 1, 2}};
  file.levels = {bytes_of({1, 2, 3, 4, 5, 6})};
  for (const std::uint32_t format : {23u, 29u}) {  // R8G8B8, linear and sRGB: the slot decides
    file.vk_format = format;
    EXPECT_EQ(pixels_of(file), (Codes{1, 2, 3, 255, 4, 5, 6, 255}));
  }
  file.levels = {bytes_of({1, 2, 3, 4, 5, 6, 7, 8})};
  file.vk_format = 43;
  EXPECT_EQ(pixels_of(file), (Codes{1, 2, 3, 4, 5, 6, 7, 8}));
  file.vk_format = 44;  // BGRA
  EXPECT_EQ(pixels_of(file), (Codes{3, 2, 1, 4, 7, 6, 5, 8}));
  // Half floats -1, 0.5, 2 and 1.
  file.width = 1;
  file.vk_format = 97;
  file.levels = {bytes_of({0x00, 0xbc, 0x00, 0x38, 0x00, 0x40, 0x00, 0x3c})};
  const TextureImage image = decode_texture(file.bytes(), "t");
  EXPECT_EQ(image.bits, 16);
  EXPECT_EQ(image.pixels, (Codes{0, 0, 0x00, 0x80, 0xff, 0xff, 0xff, 0xff}));
}

}  // namespace
}  // namespace candela::io::test
