#include "image/texture_file.h"

#include <gtest/gtest.h>

#include <cstring>

#include "base/file.h"
#include "base/parallel.h"
#include "unit/base/temp_folder.h"
#include "unit/image/image_util.h"
#include "unit/image/texture_seeds.h"

namespace candela {
namespace {

using test::Bytes;

constexpr std::array<TextureContainer, 3> kContainers{TextureContainer::ktx2, TextureContainer::ktx1,
                                                      TextureContainer::dds};

Bytes encode(const Cubemap& cube, const TextureOptions& options) {
  EncodingLoss loss;
  return encode_texture(cube, options, loss, "t");
}

template <class T>
T number_at(const Bytes& bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}
std::uint32_t u32_at(const Bytes& bytes, std::size_t offset) { return number_at<std::uint32_t>(bytes, offset); }
std::uint64_t u64_at(const Bytes& bytes, std::size_t offset) { return number_at<std::uint64_t>(bytes, offset); }

template <class T>
void put(Bytes& bytes, std::size_t offset, T value) {
  std::memcpy(bytes.data() + offset, &value, sizeof value);
}

/// What a texel becomes in a format.
vec3 through(TexelFormat format, vec3 color) {
  std::vector<std::byte> texel(texel_layout(format).bytes);
  std::vector<float> out(3);
  encode_texels(format, std::span(&color.x, 3), 3, texel);
  decode_texels(format, texel, 3, out);
  return {out[0], out[1], out[2]};
}

TEST(unit_image_texture, cubes_come_back_from_every_container_and_format) {
  const Cubemap cube = test::numbered_cube(5, 3);  // an odd size: 5, 2, 1
  for (const TextureContainer container : kContainers) {
    for (const TexelLayout& layout : texel_layouts()) {
      if (!layout.is_float) continue;
      for (const bool zstd : {false, true}) {
        if (zstd && container != TextureContainer::ktx2) continue;
        const TextureOptions options{.container = container, .format = layout.format, .zstd = zstd};
        if (container == TextureContainer::dds && layout.dxgi_format == 0) {
          EXPECT_THROW(encode(cube, options), Error);
          continue;
        }
        const TextureFile file = decode_texture_file(encode(cube, options), "t");
        EXPECT_EQ(file.info.container, container);
        EXPECT_EQ(file.info.texel, layout.format) << layout.name;
        EXPECT_EQ(file.info.format, layout.name);
        EXPECT_EQ(file.info.faces, 6);
        ASSERT_EQ(file.levels.size(), 3u);
        for (std::size_t level = 0; level < 3; ++level) {
          for (std::size_t face = 0; face < 6; ++face) {
            const Image& before = cube.levels[level][face];
            const Image& after = file.levels[level][face];
            ASSERT_EQ(after.width, before.width);
            ASSERT_EQ(after.channels, 3);
            for (int y = 0; y < before.height; ++y)
              for (int x = 0; x < before.width; ++x)
                ASSERT_EQ(after.rgb(x, y), through(layout.format, before.rgb(x, y))) << layout.name;
          }
        }
      }
    }
  }
}

TEST(unit_image_texture, two_dimensional_tables_come_back) {
  Image table = test::random_image(7, 4, 4);
  for (const TextureContainer container : kContainers) {
    EncodingLoss loss;
    const TextureOptions options{.container = container, .format = TexelFormat::rgba32f};
    const TextureFile file = decode_texture_file(encode_texture(table, options, loss, "t"), "t");
    EXPECT_EQ(file.info.faces, 1);
    ASSERT_EQ(file.levels.size(), 1u);
    EXPECT_EQ(file.levels[0][0].channels, 4);
    EXPECT_EQ(file.levels[0][0].pixels, table.pixels);
  }
}

TEST(unit_image_texture, the_same_pixels_give_the_same_bytes_for_any_number_of_threads) {
  const Cubemap cube = test::numbered_cube(130, 2);
  const TextureOptions options{.format = TexelFormat::rgb9e5};
  const Bytes many = encode(cube, options);
  const ThreadLimit one(1);
  EXPECT_EQ(encode(cube, options), many);
}

// Khronos Group, "KTX File Format Specification" 2.0: what a reader may rely on, read by offsets.
TEST(unit_image_texture, ktx2_keeps_the_words_of_its_specification) {
  const Cubemap cube = test::numbered_cube(8, 4);
  for (const bool zstd : {false, true}) {
    // The key makes the levels start at no multiple of 12 by chance.
    const Bytes bytes = encode(cube, {.format = TexelFormat::rgb16f, .zstd = zstd, .key_values = {{"a", "b"}}});
    EXPECT_EQ(u32_at(bytes, 12), 90u);  // VK_FORMAT_R16G16B16_SFLOAT
    EXPECT_EQ(u32_at(bytes, 16), 2u);   // bytes of the type
    EXPECT_EQ(u32_at(bytes, 20), 8u);   // width
    EXPECT_EQ(u32_at(bytes, 24), 8u);   // height
    EXPECT_EQ(u32_at(bytes, 28), 0u);   // depth
    EXPECT_EQ(u32_at(bytes, 32), 0u);   // layers
    EXPECT_EQ(u32_at(bytes, 36), 6u);   // faces
    EXPECT_EQ(u32_at(bytes, 40), 4u);   // levels
    EXPECT_EQ(u32_at(bytes, 44), zstd ? 2u : 0u);
    const std::uint32_t descriptor = u32_at(bytes, 48);
    EXPECT_EQ(descriptor, 80u + 4u * 24u);  // right behind the index of levels
    EXPECT_EQ(u32_at(bytes, 52), u32_at(bytes, descriptor));
    EXPECT_EQ(u32_at(bytes, 52), 4u + 24u + 3u * 16u);
    EXPECT_EQ(u32_at(bytes, descriptor + 12), 0x00010101u);  // linear, BT.709, RGBSDA
    EXPECT_EQ(u32_at(bytes, descriptor + 20), 6u);           // bytes of a texel, also where it is packed
    EXPECT_EQ(u32_at(bytes, descriptor + 28 + 16), 16u | 15u << 16 | 0xc1u << 24);  // green: signed float at bit 16
    EXPECT_EQ(u32_at(bytes, 56), descriptor + u32_at(bytes, 52));
    EXPECT_EQ(u32_at(bytes, 60) % 4, 0u);
    EXPECT_EQ(u64_at(bytes, 64), 0u);
    EXPECT_EQ(u64_at(bytes, 72), 0u);
    std::uint64_t end = u32_at(bytes, 56) + u32_at(bytes, 60);
    for (std::size_t level = 4; level-- > 0;) {  // smallest first
      const std::size_t entry = 80 + 24 * level;
      const std::uint64_t alignment = zstd ? 1 : 12;  // of 6-byte texels and 4
      EXPECT_EQ(u64_at(bytes, entry), (end + alignment - 1) / alignment * alignment);
      EXPECT_EQ(u64_at(bytes, entry + 16), 6u * (64u >> (2 * level)) * 6u);
      if (!zstd) {
        EXPECT_EQ(u64_at(bytes, entry + 8), u64_at(bytes, entry + 16));
      }
      end = u64_at(bytes, entry) + u64_at(bytes, entry + 8);
    }
    EXPECT_EQ(end, bytes.size());
  }
}

TEST(unit_image_texture, ktx2_describes_shared_exponents_by_six_samples) {
  const Bytes bytes = encode(test::numbered_cube(2, 1), {.format = TexelFormat::rgb9e5, .zstd = false});
  const std::size_t samples = u32_at(bytes, 48) + 28;
  EXPECT_EQ(u32_at(bytes, 52), 4u + 24u + 6u * 16u);
  for (std::uint32_t c = 0; c < 3; ++c) {
    const std::size_t mantissa = samples + std::size_t{32} * c;
    EXPECT_EQ(u32_at(bytes, mantissa), 9 * c | 8u << 16 | c << 24);
    EXPECT_EQ(u32_at(bytes, mantissa + 12), 8448u);
    EXPECT_EQ(u32_at(bytes, mantissa + 16), 27u | 4u << 16 | (c | 0x20u) << 24);
  }
}

TEST(unit_image_texture, ktx1_and_dds_keep_the_words_of_their_specifications) {
  const Cubemap cube = test::numbered_cube(4, 3);
  const Bytes ktx = encode(cube, {.container = TextureContainer::ktx1, .format = TexelFormat::r11g11b10f});
  EXPECT_EQ(u32_at(ktx, 12), 0x04030201u);
  EXPECT_EQ(u32_at(ktx, 16), 0x8c3bu);  // GL_UNSIGNED_INT_10F_11F_11F_REV
  EXPECT_EQ(u32_at(ktx, 24), 0x1907u);  // GL_RGB
  EXPECT_EQ(u32_at(ktx, 28), 0x8c3au);  // GL_R11F_G11F_B10F
  EXPECT_EQ(u32_at(ktx, 52), 6u);
  EXPECT_EQ(u32_at(ktx, 56), 3u);
  EXPECT_EQ(u32_at(ktx, 64 + u32_at(ktx, 60)), 4u * 4u * 4u);  // one face of the first level

  const Bytes dds = encode(cube, {.container = TextureContainer::dds, .format = TexelFormat::rgba16f});
  EXPECT_EQ(u32_at(dds, 4), 124u);
  EXPECT_EQ(u32_at(dds, 28), 3u);        // levels
  EXPECT_EQ(u32_at(dds, 112), 0xfe00u);  // a cube with all faces
  EXPECT_EQ(u32_at(dds, 128), 10u);      // DXGI_FORMAT_R16G16B16A16_FLOAT
  EXPECT_EQ(u32_at(dds, 136), 4u);       // a cube
  EXPECT_EQ(dds.size(), 148u + 6u * (16u + 4u + 1u) * 8u);
  // The second face follows all levels of the first.
  const auto texel = float_from_half(number_at<std::uint16_t>(dds, 148 + (16 + 4 + 1) * 8));
  EXPECT_EQ(texel, through(TexelFormat::rgba16f, cube.levels[0][1].rgb(0, 0)).x);
}

TEST(unit_image_texture, ktx1_for_filament_has_its_type_and_is_read) {
  const Cubemap cube = test::numbered_cube(4, 3);
  TextureOptions options{.container = TextureContainer::ktx1, .format = TexelFormat::r11g11b10f};
  const Bytes plain = encode(cube, options);
  options.has_filament_type = true;
  const Bytes filament = encode(cube, options);
  EXPECT_EQ(u32_at(filament, 16), 0x8c3au);
  EXPECT_EQ(decode_texture_file(filament, "t").levels[1][2].pixels,
            decode_texture_file(plain, "t").levels[1][2].pixels);
  options.format = TexelFormat::rgba16f;  // the quirk is of one format
  EXPECT_EQ(u32_at(encode(cube, options), 16), 0x140bu);
}

TEST(unit_image_texture, key_values_are_kept_and_binary_ones_measured) {
  for (const TextureContainer container : {TextureContainer::ktx1, TextureContainer::ktx2}) {
    const Bytes bytes = encode(test::numbered_cube(2, 2),
                               {.container = container, .key_values = {{"sh", "1 2 3\n4 5 6"}, {"raw", "\x01\x02"}}});
    const TextureInfo info = parse_texture_info(bytes, "t");
    EXPECT_EQ(info.key_values.at("sh"), "1 2 3\n4 5 6");
    EXPECT_EQ(info.key_values.at("raw"), "3 bytes");
    EXPECT_EQ(info.key_values.at("KTXwriter"), "Candela");
    EXPECT_EQ(info.key_values.at("KTXorientation"), container == TextureContainer::ktx2 ? "rd" : "S=r,T=d");
  }
}

TEST(unit_image_texture, legacy_dds_formats_are_read) {
  Bytes dds = encode(test::numbered_cube(2, 1), {.container = TextureContainer::dds, .format = TexelFormat::rgba16f});
  put(dds, 84, std::uint32_t{113});  // D3DFMT_A16B16G16R16F in place of "DX10"
  dds.erase(dds.begin() + 128, dds.begin() + 148);
  EXPECT_EQ(decode_texture_file(dds, "t").info.texel, TexelFormat::rgba16f);
  EXPECT_EQ(decode_texture_file(dds, "t").info.faces, 6);
}

TEST(unit_image_texture, formats_without_a_decoder_are_described_and_not_read) {
  Bytes ktx = encode(test::numbered_cube(4, 2), {.zstd = false});
  put(ktx, 12, std::uint32_t{143});  // VK_FORMAT_BC6H_UFLOAT_BLOCK
  EXPECT_EQ(parse_texture_info(ktx, "t").format, "bc6h-ufloat");
  EXPECT_THROW(decode_texture_file(ktx, "t"), Error);
  ktx = encode(test::numbered_cube(4, 2), {.zstd = false});
  put(ktx, 44, std::uint32_t{1});
  EXPECT_EQ(parse_texture_info(ktx, "t").supercompression, "BasisLZ");
  EXPECT_THROW(decode_texture_file(ktx, "t"), Error);
}

TEST(unit_image_texture, what_cannot_be_written_is_an_error_and_leaves_no_file) {
  const test::TempFolder folder;
  Cubemap cube = test::numbered_cube(4, 2);
  EXPECT_THROW(write_texture(folder / "a.ktx2", Cubemap(), {}), Error);
  EXPECT_THROW(write_texture(folder / "a.ktx2", Image(), {}), Error);
  EXPECT_THROW(write_texture(folder / "a.ktx2", Image(16385, 1, 1), {}), Error);
  EXPECT_THROW(write_texture(folder / "a.ktx2", cube, {.format = TexelFormat::rgba8}), Error);
  EXPECT_THROW(write_texture(folder / "a.ktx2", cube, {.zstd_level = 0}), Error);
  EXPECT_THROW(
      write_texture(folder / "a.dds", cube, {.container = TextureContainer::dds, .format = TexelFormat::rgb16f}),
      Error);
  cube.levels[1] = make_cube_faces(3);
  EXPECT_THROW(write_texture(folder / "a.ktx2", cube, {}), Error);
  cube = test::numbered_cube(1, 1);
  cube.levels.push_back(cube.levels[0]);  // nothing is half of one
  EXPECT_THROW(write_texture(folder / "a.ktx2", cube, {}), Error);
  {
    const test::FullDisk full(100);
    EXPECT_THROW(write_texture(folder / "a.ktx2", test::numbered_cube(8, 4), {}), Error);
  }
  EXPECT_EQ(folder.entries(), 0u);
}

// ----- damage

TEST(unit_image_texture, a_level_of_the_wrong_length_is_refused) {
  for (const bool zstd : {false, true}) {
    const Bytes good = encode(test::numbered_cube(4, 2), {.zstd = zstd});
    for (const int wrong : {-8, -1, 1, 8}) {
      Bytes bad = good;
      const std::size_t field = zstd ? 96 : 88;  // the length when unpacked, or in the file
      put(bad, field, u64_at(bad, field) + static_cast<std::uint64_t>(wrong));
      EXPECT_THROW(decode_texture_file(bad, "t"), Error) << wrong;
    }
  }
}

TEST(unit_image_texture, damage_is_an_error_and_never_a_crash) {
  for (const Bytes& seed : test::texture_seeds())
    test::check_damage([](std::span<const std::byte> bytes) { decode_texture_file(bytes, "t"); }, seed);
}

TEST(unit_image_texture, hostile_words_are_an_error_or_a_texture) {
  static constexpr std::uint32_t words[] = {0,     1,     2,     3,          6,          255,       65535,
                                            65536, 16384, 16385, 0x7fffffff, 0x80000000, 0xffffffff};
  std::mt19937 random(1);
  int good = 0, bad = 0;
  for (const Bytes& seed : test::texture_seeds()) {
    for (int i = 0; i < 4000; ++i) {
      Bytes mutant = seed;
      for (unsigned k = 0; k < 1 + random() % 3; ++k)
        put(mutant, random() % (std::min<std::size_t>(mutant.size(), 256) / 4) * 4, words[random() % std::size(words)]);
      if (i % 5 == 0) mutant.resize(random() % mutant.size());
      const bool survived =
          test::survives([](std::span<const std::byte> bytes) { decode_texture_file(bytes, "t", 1u << 22); }, mutant);
      (survived ? good : bad) += 1;
    }
  }
  // Both outcomes are common, else the mutator would be idle or too blunt.
  EXPECT_GT(good, 1000);
  EXPECT_GT(bad, 5000);
}

TEST(unit_image_texture, sizes_that_cannot_be_are_refused_before_memory_is_taken) {
  // A small file that says to hold 6 faces of 16384² texels.
  Bytes bytes = encode(test::numbered_cube(4, 1), {.format = TexelFormat::rgb9e5, .zstd = true});
  put(bytes, 20, std::uint32_t{16384});
  put(bytes, 24, std::uint32_t{16384});
  put(bytes, 96, std::uint64_t{6} * 16384 * 16384 * 4);
  EXPECT_THROW(decode_texture_file(bytes, "t"), Error);
  // 2048² fit, but no Zstandard frame of this length unfolds to as much.
  put(bytes, 20, std::uint32_t{2048});
  put(bytes, 24, std::uint32_t{2048});
  put(bytes, 96, std::uint64_t{6} * 2048 * 2048 * 4);
  EXPECT_THROW(decode_texture_file(bytes, "t"), Error);
  // The content says another size than the index.
  bytes = encode(test::numbered_cube(4, 1), {.format = TexelFormat::rgb9e5, .zstd = true});
  const Bytes other = encode(test::numbered_cube(2, 1), {.format = TexelFormat::rgb9e5, .zstd = true});
  const std::uint64_t offset = u64_at(bytes, 80);
  bytes.resize(offset);
  const std::uint64_t from = u64_at(other, 80);
  bytes.insert(bytes.end(), other.begin() + static_cast<std::ptrdiff_t>(from), other.end());
  put(bytes, 88, u64_at(other, 88));
  EXPECT_THROW(decode_texture_file(bytes, "t"), Error);
}

}  // namespace
}  // namespace candela
