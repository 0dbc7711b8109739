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
