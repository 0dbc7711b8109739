#include "image/mattes.h"

#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStringAttribute.h>
#include <gtest/gtest.h>

#include <bit>
#include <nlohmann/json.hpp>

#include "image/cryptomatte.h"
#include "image/image_file.h"
#include "unit/base/temp_folder.h"
#include "unit/image/image_util.h"

namespace candela {
namespace {

TEST(unit_image_mattes, what_covers_most_comes_first) {
  MatteSums sums(2, 1);
  sums.add(0, 7, 1.0f);
  sums.add(0, 3, 2.0f);
  sums.add(0, 7, 2.0f);
  sums.add(1, 9, 1.0f);
  sums.add(1, 4, 1.0f);
  const Mattes mattes = sums.mattes([](std::size_t pixel) { return pixel == 0 ? 0.2f : 0.5f; });
  EXPECT_EQ(mattes.at(0)[0].number, 7u);
  EXPECT_FLOAT_EQ(mattes.at(0)[0].coverage, 0.6f);
  EXPECT_EQ(mattes.at(0)[1].number, 3u);
  EXPECT_FLOAT_EQ(mattes.at(0)[1].coverage, 0.4f);
  EXPECT_EQ(mattes.at(0)[2].coverage, 0.0f);
  EXPECT_EQ(mattes.at(1)[0].number, 4u) << "of equals the lower number";
}

TEST(unit_image_mattes, means_of_films_have_means_of_mattes) {
  const auto film_of = [](std::uint32_t number, float coverage) {
    MatteSums sums(1, 1);
    sums.add(0, number, coverage);
    Film film;
    film.beauty = Image(1, 1, 4);
    film.mattes[MatteKind::object] = sums.mattes([](std::size_t) { return 1.0f; });
    film.mattes[MatteKind::object].names = {{1, "a"}, {2, "b"}};
    return film;
  };
  Film mean;
  accumulate(film_of(1, 1.0f), 0.25f, mean);
  accumulate(film_of(2, 1.0f), 0.5f, mean);
  accumulate(film_of(1, 0.4f), 0.25f, mean);
  const Mattes& mattes = mean.mattes.at(MatteKind::object);
  EXPECT_EQ(mattes.at(0)[0].number, 2u);
  EXPECT_FLOAT_EQ(mattes.at(0)[0].coverage, 0.5f);
  EXPECT_FLOAT_EQ(mattes.at(0)[1].coverage, 0.35f);
  EXPECT_EQ(mattes.names.size(), 2u);
}

TEST(unit_image_mattes, masks_are_bits_of_the_box_around_their_pixels) {
  MaskBuilder builder;
  for (const ivec2 pixel : {ivec2(4, 7), ivec2(6, 7), ivec2(5, 9), ivec2(4, 7)}) builder.add(3, pixel);
  builder.add(1, {0, 0});
  const std::vector<InstanceMask> masks = builder.build();
  ASSERT_EQ(masks.size(), 2u);
  EXPECT_EQ(masks[0].node, 1);
  EXPECT_EQ(masks[1].corner, ivec2(4, 7));
  EXPECT_EQ(masks[1].size, ivec2(3, 3));
  EXPECT_TRUE(masks[1].covers({6, 7}));
  EXPECT_FALSE(masks[1].covers({5, 7}));
  EXPECT_FALSE(masks[1].covers({3, 7})) << "outside of the box";
}

TEST(unit_image_mattes, hashes_are_those_of_murmur_with_the_exponent_of_a_number) {
  EXPECT_EQ(codec::cryptomatte_hash("hello"), 0x248bfa47u);
  EXPECT_EQ(codec::cryptomatte_hash("hello, world"), 0x149bbb7fu);
  EXPECT_EQ(codec::cryptomatte_hash("The quick brown fox jumps over the lazy dog."), 0xd5c48bfcu);
  EXPECT_EQ(codec::cryptomatte_hash(""), 0x00800000u) << "0, whose exponent is all zeros";
  for (int i = 0; i < 5000; ++i) {
    const std::uint32_t exponent = codec::cryptomatte_hash("name " + std::to_string(i)) >> 23 & 255u;
    EXPECT_TRUE(exponent > 0 && exponent < 255) << i;
  }
}

/// By the rules of the specification alone, from the file: name -> coverage of each pixel.
std::map<std::string, std::vector<float>> read_cryptomatte(const std::filesystem::path& path,
                                                           const std::string& layer) {
  const Imf::InputFile file(path.c_str());
  std::string manifest;
  for (auto a = file.header().begin(); a != file.header().end(); ++a) {
    const std::string key = a.name();
    if (!key.starts_with("cryptomatte/") || !key.ends_with("/name")) continue;
    const auto text = [&](const std::string& name) {
      return file.header().typedAttribute<Imf::StringAttribute>((key.substr(0, 20) + name).c_str()).value();
    };
    if (text("name") != layer) continue;
    EXPECT_EQ(text("hash"), "MurmurHash3_32");
    EXPECT_EQ(text("conversion"), "uint32_to_float32");
    manifest = text("manifest");
  }
  const nlohmann::json names = nlohmann::json::parse(manifest);
  std::map<std::string, std::vector<float>> mattes;
  for (int level = 0; level < 3; ++level) {
    const Image ranks = read_image(path, layer + "0" + std::to_string(level));
    EXPECT_EQ(ranks.channels, 4);
    const std::size_t pixels = ranks.pixels.size() / 4;
    for (const auto& [name, hash] : names.items()) {
      const auto id = static_cast<std::uint32_t>(std::stoul(hash.get<std::string>(), nullptr, 16));
      std::vector<float>& matte = mattes.try_emplace(name, std::vector<float>(pixels)).first->second;
      for (std::size_t i = 0; i < 2 * pixels; ++i) {
        if (std::bit_cast<std::uint32_t>(ranks.pixels[2 * i]) == id) matte[i / 2] += ranks.pixels[2 * i + 1];
      }
    }
  }
  return mattes;
}

TEST(unit_image_mattes, a_file_gives_every_matte_back_by_the_published_rules) {
  const test::TempFolder folder;
  MatteSums sums(3, 1);
  for (std::uint32_t k = 0; k < 6; ++k) sums.add(0, k, 0.1f * static_cast<float>(k + 1));
  sums.add(1, 2, 1.0f);
  Film film;
  film.beauty = Image(3, 1, 4);
  Mattes& mattes = film.mattes[MatteKind::material];
  mattes = sums.mattes([](std::size_t) { return 1.0f; });
  for (std::uint32_t k = 0; k < 6; ++k) mattes.names[k] = "a \"quoted\" name " + std::to_string(k);
  write_exr(folder / "a.exr", film);
  const auto read = read_cryptomatte(folder / "a.exr", "CryptoMaterial");
  ASSERT_EQ(read.size(), 6u);
  for (std::uint32_t k = 0; k < 6; ++k) {
    const std::vector<float>& matte = read.at(mattes.names[k]);
    EXPECT_FLOAT_EQ(matte[0], 0.1f * static_cast<float>(k + 1));
    EXPECT_EQ(matte[1], k == 2 ? 1.0f : 0.0f);
    EXPECT_EQ(matte[2], 0.0f);
  }
}

TEST(unit_image_mattes, numbers_are_integers_of_the_file) {
  const test::TempFolder folder;
  Film film;
  film.beauty = Image(2, 1, 4);
  film.layers[Layer::face] = Image(2, 1, 1);
  film.layers[Layer::face].pixels = {16777216.0f, 16777215.0f};
  film.layers[Layer::motion] = Image(2, 1, 2);
  film.layers[Layer::motion].pixels = {1.5f, -2.5f, 3.0f, 4.0f};
  write_exr(folder / "a.exr", film);
  const Imf::InputFile file((folder / "a.exr").c_str());
  EXPECT_EQ(file.header().channels().findChannel("face.Y")->type, Imf::UINT);
  EXPECT_EQ(file.header().channels().findChannel("motion.X")->type, Imf::FLOAT);
  EXPECT_EQ(read_image(folder / "a.exr", "face").rgb(0, 0).x, 16777216.0f);
  EXPECT_EQ(read_image(folder / "a.exr", "motion").rgb(0, 0), vec3(1.5f, -2.5f, 0.0f)) << "two channels are read too";
}

}  // namespace
}  // namespace candela
