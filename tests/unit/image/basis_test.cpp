#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

#include "base/file.h"
#include "image/basis_etc1s.h"
#include "image/basis_uastc.h"
#include "image/texture_codec.h"
#include "unit/image/basis_files.h"
#include "unit/image/image_util.h"
#include "unit/image/texture_seeds.h"
#include "unit/image/uastc_blocks.h"

namespace candela {
namespace {

using codec::BlockReader;
using codec::StoredTexture;
using codec::UastcRounding;
using test::Bytes;

/// FNV-1a of 64 bits, as tests/unit/image/basis/make_fixtures.mjs has it.
std::uint64_t hash_of(std::span<const std::uint8_t> bytes) {
  std::uint64_t h = 0xcbf29ce484222325u;
  for (const std::uint8_t byte : bytes) h = (h ^ byte) * 0x100000001b3u;
  return h;
}

/// A line of expected.txt: what three's transcoder made of an image.
struct Expected {
  std::string file;
  std::size_t level = 0, face = 0;
  int width = 0, height = 0;
  std::uint64_t hash = 0;
};

std::vector<Expected> expected_images() {
  std::ifstream in(test::basis_folder() / "expected.txt");
  std::vector<Expected> result;
  Expected e;
  while (in >> e.file >> e.level >> e.face >> e.width >> e.height >> std::hex >> e.hash >> std::dec)
    result.push_back(e);
  return result;
}

std::vector<std::uint8_t> image_of(const StoredTexture& stored, std::size_t level, std::size_t face) {
  std::vector<std::byte> storage;
  const auto faces = codec::unpacked_faces(stored, stored.levels.at(level), storage, "t");
  return BlockReader(stored, "t").codes(level, face, faces.at(face));
}

TEST(unit_image_basis, files_of_the_encoder_decode_as_three_decodes_them) {
  std::size_t images = 0;
  for (const Expected& e : expected_images()) {
    if (e.file.starts_with("mode_")) continue;
    SCOPED_TRACE(e.file + " level " + std::to_string(e.level) + " face " + std::to_string(e.face));
    const Bytes bytes = test::basis_file(e.file);
    const StoredTexture stored = codec::parse_texture(bytes, "t");
    ASSERT_TRUE(stored.info.is_read) << stored.info.format;
    EXPECT_EQ(stored.levels.at(e.level).width, e.width);
    EXPECT_EQ(stored.levels.at(e.level).height, e.height);
    EXPECT_EQ(hash_of(image_of(stored, e.level, e.face)), e.hash);
    ++images;
  }
  EXPECT_EQ(images, 54u);
}

// ----- all modes of UASTC, by blocks that are random but for what names the mode

constexpr std::size_t kModes = test::kUastcModes, kBlocks = 256;

TEST(unit_image_basis, every_mode_of_uastc_decodes_as_three_decodes_it) {
  std::set<std::string> modes;
  for (const Expected& e : expected_images()) {
    if (!e.file.starts_with("mode_")) continue;
    SCOPED_TRACE(e.file);
    const std::size_t mode = std::stoul(e.file.substr(5));
    const Bytes blocks = test::random_uastc(mode, kBlocks);
    std::vector<std::uint8_t> rgba(kBlocks * 16 * 4);
    codec::decode_uastc(blocks, e.width, e.height, UastcRounding::linear, rgba);
    EXPECT_EQ(hash_of(rgba), e.hash);
    std::array<std::uint32_t, 16> texels{};
    for (std::size_t i = 0; i < kBlocks; ++i) {
      const std::span<const std::byte, 16> block = std::span<const std::byte>(blocks).subspan(16 * i).first<16>();
      EXPECT_EQ(codec::decode_uastc_block(block, UastcRounding::linear, texels), static_cast<int>(mode));
    }
    modes.insert(e.file);
  }
  EXPECT_EQ(modes.size(), kModes);
}

TEST(unit_image_basis, blocks_of_no_meaning_are_magenta) {
  const auto mode_of = [](Bytes block) {
    std::array<std::uint32_t, 16> texels{};
    const int mode =
        codec::decode_uastc_block(std::span<const std::byte>(block).first<16>(), UastcRounding::linear, texels);
    for (const std::uint32_t texel : texels) EXPECT_EQ(texel == 0xffff00ffu, mode < 0);
    return mode;
  };
  Bytes block(16);
  test::put_bits(block, 0, 7, 0x45);  // reserved
  EXPECT_EQ(mode_of(block), -1);
  for (std::size_t mode = 0; mode < kModes; ++mode) {
    const test::UastcShape& shape = test::kUastcShapes[mode];
    Bytes good(16);
    test::put_bits(good, 0, shape.length, shape.bits);
    if (shape.etc2m_at > 0) {
      EXPECT_EQ(mode_of(good), -1) << mode;  // ETC2M is 0
      test::put_bits(good, shape.etc2m_at, 4, 1);
    }
    EXPECT_EQ(mode_of(good), static_cast<int>(mode));
    if (shape.patterns == 0) continue;
    test::put_bits(good, shape.pattern_at, shape.pattern_bits, shape.patterns);
    EXPECT_EQ(mode_of(good), -1) << mode;
  }
}

TEST(unit_image_basis, levels_and_sizes_that_cannot_be_are_one_error) {
  const auto error_of = [](const Bytes& bytes) -> std::string {
    try {
      decode_texture(bytes, "t");
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  const auto changed = [](const char* name, std::size_t at, auto value) {
    Bytes bytes = test::basis_file(name);
    std::memcpy(bytes.data() + at, &value, sizeof value);
    return bytes;
  };
  constexpr std::size_t kLevelCount = 40, kWidth = 20, kSchemeGlobal = 64;
  for (const char* name : test::kBasisFiles) {
    SCOPED_TRACE(name);
    for (const std::uint32_t levels : {0x80000000u, 0xffffffffu, 40u})
      EXPECT_NE(error_of(changed(name, kLevelCount, levels)).find("mip levels"), std::string::npos);
    for (const std::uint32_t width : {0u, 16385u, 0xffffffffu}) EXPECT_NE(error_of(changed(name, kWidth, width)), "");
    for (const std::uint64_t offset : {~std::uint64_t{0}, std::uint64_t{1} << 40})
      EXPECT_NE(error_of(changed(name, 80, offset)), "");
  }
  // More endpoints, patterns or bytes of them than the books hold.
  std::uint64_t global = 0;
  const Bytes good = test::basis_file("etc1s_alpha.ktx2");
  std::memcpy(&global, good.data() + kSchemeGlobal, sizeof global);
  for (const std::size_t field : {0u, 2u})
    EXPECT_NE(error_of(changed("etc1s_alpha.ktx2", global + field, std::uint16_t{0xffff})), "");
  for (const std::size_t field : {4u, 8u, 12u, 16u})
    EXPECT_NE(error_of(changed("etc1s_alpha.ktx2", global + field, 0xffffffffu)), "");
  // Slices that are empty, and slices outside of their level.
  for (const std::size_t field : {24u, 28u, 32u, 36u})
    EXPECT_NE(error_of(changed("etc1s_alpha.ktx2", global + field, 0xfffffff0u)), "");
  EXPECT_NE(error_of(changed("etc1s_alpha.ktx2", global + 28, 0u)), "");
  // A frame of a video.
  EXPECT_NE(error_of(changed("etc1s_alpha.ktx2", global + 20, 2u)).find("video is not read"), std::string::npos);
}

/// Whatever a file says: an Error or pixels, and never more of them than the caller allows.
void decode_both(std::span<const std::byte> bytes) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 22;
  test::survives([](std::span<const std::byte> b) { decode_texture_file(b, "t", kMost); }, bytes);
  test::survives([](std::span<const std::byte> b) { decode_texture_pixels(b, "t", kMost); }, bytes);
}

/// ASTC is decoded by a library that prepares for some milliseconds.
std::size_t rounds_of(const Bytes& seed, std::size_t rounds) {
  return parse_texture_info(seed, "t").block->codec == BlockCodec::astc ? rounds / 20 : rounds;
}

TEST(unit_image_basis, damage_is_an_error_or_a_texture) {
  test::XorShift random(1);
  for (const Bytes& seed : test::block_seeds()) {
    const auto decode = [](std::span<const std::byte> b) { decode_texture_file(b, "t"); };
    ASSERT_TRUE(test::survives(decode, seed));
    for (std::size_t i = 0; i < rounds_of(seed, 200); ++i)
      EXPECT_FALSE(test::survives(decode, std::span(seed).first(random() % seed.size())));
    for (std::size_t i = 0; i < rounds_of(seed, 2000); ++i) {
      Bytes bad = seed;
      for (std::uint32_t k = 0; k < 1 + random() % 3; ++k)
        bad[random() % bad.size()] ^= static_cast<std::byte>(1u << random() % 8);
      decode_both(bad);
    }
  }
}

TEST(unit_image_basis, hostile_words_are_an_error_or_a_texture) {
  static constexpr std::uint32_t words[] = {0,     1,     2,     3,          6,          163,       166,
                                            65536, 16384, 16385, 0x7fffffff, 0x80000000, 0xffffffff};
  test::XorShift random(1);
  for (const Bytes& seed : test::block_seeds()) {
    for (std::size_t i = 0; i < rounds_of(seed, 2000); ++i) {
      Bytes bad = seed;
      for (std::uint32_t k = 0; k < 1 + random() % 3; ++k) {
        const std::size_t at = random() % (std::min<std::size_t>(bad.size(), 512) / 4) * 4;
        std::memcpy(bad.data() + at, &words[random() % std::size(words)], 4);
      }
      decode_both(bad);
    }
  }
}

TEST(unit_image_basis, srgb_rounds_by_one_code_at_most) {
  std::uint64_t different = 0;
  for (std::size_t mode = 0; mode < kModes; ++mode) {
    const Bytes blocks = test::random_uastc(mode, kBlocks);
    std::vector<std::uint8_t> linear(kBlocks * 64), srgb(kBlocks * 64);
    codec::decode_uastc(blocks, kBlocks * 4, 4, UastcRounding::linear, linear);
    codec::decode_uastc(blocks, kBlocks * 4, 4, UastcRounding::srgb, srgb);
    for (std::size_t i = 0; i < linear.size(); ++i) {
      ASSERT_LE(std::abs(linear[i] - srgb[i]), 1);
      different += linear[i] != srgb[i] ? 1 : 0;
    }
  }
  EXPECT_GT(different, 0u);
}

}  // namespace
}  // namespace candela
