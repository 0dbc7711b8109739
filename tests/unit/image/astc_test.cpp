#include "image/astc.h"

#include <astcenc.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <type_traits>

#include "base/file.h"
#include "image/basis_uastc.h"
#include "image/cube_file.h"
#include "image/texture_file.h"
#include "unit/base/temp_folder.h"
#include "unit/image/image_util.h"
#include "unit/image/ktx2_builder.h"
#include "unit/image/uastc_blocks.h"

namespace candela {
namespace {

namespace fs = std::filesystem;
using test::bits_at;
using test::Bytes;
using test::put_bits;

// ----- ASTC by the library's own encoder

template <class Allocate>
astcenc_error allocate(Allocate* function, const astcenc_config& config, astcenc_context** context) {
  if constexpr (std::is_invocable_v<Allocate*, const astcenc_config*, unsigned, astcenc_context**>)
    return function(&config, 1, context);
  else
    return function(&config, 1, context, nullptr);
}

Bytes astc_of(const std::vector<float>& rgba, int width, int height, std::array<int, 2> block,
              astcenc_profile profile) {
  astcenc_config config{};
  astcenc_context* context = nullptr;
  const auto x = static_cast<unsigned>(block[0]), y = static_cast<unsigned>(block[1]);
  EXPECT_EQ(astcenc_config_init(profile, x, y, 1, ASTCENC_PRE_MEDIUM, 0, &config), ASTCENC_SUCCESS);
  EXPECT_EQ(allocate(&astcenc_context_alloc, config, &context), ASTCENC_SUCCESS);
  std::vector<float> texels = rgba;
  void* slice = texels.data();
  astcenc_image image{};
  image.dim_x = static_cast<unsigned>(width);
  image.dim_y = static_cast<unsigned>(height);
  image.dim_z = 1;
  image.data_type = ASTCENC_TYPE_F32;
  image.data = &slice;
  const astcenc_swizzle swizzle{ASTCENC_SWZ_R, ASTCENC_SWZ_G, ASTCENC_SWZ_B, ASTCENC_SWZ_A};
  const auto count = [](int size, int side) { return static_cast<std::size_t>((size + side - 1) / side); };
  Bytes out(16 * count(width, block[0]) * count(height, block[1]));
  EXPECT_EQ(
      astcenc_compress_image(context, &image, &swizzle, reinterpret_cast<std::uint8_t*>(out.data()), out.size(), 0),
      ASTCENC_SUCCESS);
  astcenc_context_free(context);
  return out;
}

/// A smooth picture, up to `most`.
std::vector<float> slopes(int width, int height, float most) {
  std::vector<float> rgba;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (const float v : {static_cast<float>(x) / static_cast<float>(width),
                            static_cast<float>(y) / static_cast<float>(height), 0.25f, 1.0f / most})
        rgba.push_back(v * most);
  return rgba;
}

constexpr std::array<std::array<int, 2>, 14> kBlocks{{{4, 4},
                                                      {5, 4},
                                                      {5, 5},
                                                      {6, 5},
                                                      {6, 6},
                                                      {8, 5},
                                                      {8, 6},
                                                      {8, 8},
                                                      {10, 5},
                                                      {10, 6},
                                                      {10, 8},
                                                      {10, 10},
                                                      {12, 10},
                                                      {12, 12}}};

test::Ktx2 astc_file(std::uint32_t vk_format, int width, int height, std::uint32_t transfer) {
  return {.vk_format = vk_format,
          .width = static_cast<std::uint32_t>(width),
          .height = static_cast<std::uint32_t>(height),
          .model = 162,
          .transfer = transfer,
          .channels = {0}};
}

TEST(unit_image_astc, every_block_size_is_read_in_8_bits) {
  constexpr int kWidth = 29, kHeight = 23;  // a multiple of no block
  const std::vector<float> original = slopes(kWidth, kHeight, 1.0f);
  for (std::size_t i = 0; i < kBlocks.size(); ++i) {
    for (const bool is_srgb : {false, true}) {
      test::Ktx2 file =
          astc_file(static_cast<std::uint32_t>(157 + 2 * i + (is_srgb ? 1 : 0)), kWidth, kHeight, is_srgb ? 2 : 1);
      file.levels = {astc_of(original, kWidth, kHeight, kBlocks[i], is_srgb ? ASTCENC_PRF_LDR_SRGB : ASTCENC_PRF_LDR)};
      const Bytes bytes = file.bytes();
      const TextureInfo info = parse_texture_info(bytes, "t");
      EXPECT_EQ(info.format, "astc-" + std::to_string(kBlocks[i][0]) + "x" + std::to_string(kBlocks[i][1]) +
                                 (is_srgb ? "-srgb" : ""));
      const TextureImage image = decode_texture(bytes, "t");
      ASSERT_EQ(image.pixels.size(), original.size());
      double sum = 0.0;
      for (std::size_t k = 0; k < original.size(); ++k)
        sum += std::abs(static_cast<double>(image.pixels[k]) / 255.0 - static_cast<double>(original[k]));
      EXPECT_LT(sum / static_cast<double>(original.size()), 0.02) << info.format;
    }
  }
}

TEST(unit_image_astc, every_block_size_is_read_with_a_high_range) {
  constexpr int kWidth = 29, kHeight = 23;
  constexpr float kMost = 500.0f;
  const std::vector<float> original = slopes(kWidth, kHeight, kMost);
  for (std::size_t i = 0; i < kBlocks.size(); ++i) {
    test::Ktx2 file = astc_file(static_cast<std::uint32_t>(1000066000 + i), kWidth, kHeight, 1);
    file.levels = {astc_of(original, kWidth, kHeight, kBlocks[i], ASTCENC_PRF_HDR)};
    const TextureFile texture = decode_texture_file(file.bytes(), "t");
    const Image& image = texture.levels.at(0).at(0);
    ASSERT_EQ(image.pixels.size(), original.size());
    double sum = 0.0;
    for (std::size_t k = 0; k < original.size(); ++k)
      sum += std::abs(static_cast<double>(image.pixels[k]) - static_cast<double>(original[k]));
    EXPECT_LT(sum / static_cast<double>(original.size()), 0.05 * static_cast<double>(kMost)) << texture.info.format;
  }
}

// ----- environments

Image image_of(const std::vector<float>& rgba, int width, int height) {
  Image image(width, height, 3);
  for (std::size_t i = 0; i < rgba.size() / 4; ++i) std::copy_n(&rgba[4 * i], 3, &image.pixels[3 * i]);
  return image;
}

double difference(const Image& a, const Image& b) {
  EXPECT_EQ(a.pixels.size(), b.pixels.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < std::min(a.pixels.size(), b.pixels.size()); ++i)
    sum += std::abs(static_cast<double>(a.pixels[i] - b.pixels[i]));
  return sum / static_cast<double>(a.pixels.size());
}

TEST(unit_image_astc, a_panorama_is_read_in_every_form_of_ktx2) {
  const test::TempFolder folder;
  const auto read = [&](const Bytes& bytes) {
    write_file(folder.path() / "sky.ktx2", bytes);
    return read_clean_environment(folder.path() / "sky.ktx2");
  };
  constexpr int kWidth = 40, kHeight = 20;
  const std::vector<float> rgba = slopes(kWidth, kHeight, 50.0f);
  test::Ktx2 hdr = astc_file(1000066000, kWidth, kHeight, 1);
  hdr.levels = {astc_of(rgba, kWidth, kHeight, {4, 4}, ASTCENC_PRF_HDR)};
  EnvironmentFile sky = read(hdr.bytes());
  EXPECT_TRUE(sky.cube.empty());
  EXPECT_LT(difference(sky.panorama, image_of(rgba, kWidth, kHeight)), 0.5);

  // Named as what it is for: UASTC HDR 4x4 has the same blocks.
  hdr.vk_format = 0;
  hdr.model = 167;
  EXPECT_EQ(read(hdr.bytes()).panorama.pixels, sky.panorama.pixels);

  // Rows that go up are turned over.
  hdr.key_values = {{"KTXorientation", "ru"}};
  const Image up = read(hdr.bytes()).panorama;
  EXPECT_EQ(up.rgb(7, 0), sky.panorama.rgb(7, kHeight - 1));
  EXPECT_EQ(up.rgb(7, kHeight - 1), sky.panorama.rgb(7, 0));

  // Plain halves, with and without Zstandard; and the universal formats, linear and sRGB.
  const Image plain = image_of(slopes(kWidth, kHeight, 1.0f), kWidth, kHeight);
  for (const bool zstd : {false, true}) {
    EncodingLoss loss;
    const Bytes bytes = encode_texture(plain, {.format = TexelFormat::rgba16f, .zstd = zstd}, loss, "t");
    EXPECT_LT(difference(read(bytes).panorama, plain), 1e-3);
  }
  test::Ktx2 uastc{.width = kWidth, .height = kHeight, .channels = {0}};
  uastc.levels = {test::random_uastc(1, 50)};
  const Image linear = read(uastc.bytes()).panorama;
  uastc.transfer = 2;
  const Image srgb = read(uastc.bytes()).panorama;
  ASSERT_EQ(linear.channels, 3);
  for (const int x : {0, 9, 31}) EXPECT_NEAR(srgb.rgb(x, 3).x, std::pow(linear.rgb(x, 3).x, 2.2f), 0.02f);
}

TEST(unit_image_astc, texels_that_are_no_light_are_put_right_in_panoramas_and_cube_maps) {
  const test::TempFolder folder;
  for (const bool is_cube : {false, true}) {
    // Halves: 1, -1, 1, 1; 1, NaN, 1, 1; then 1 throughout.
    constexpr unsigned kOne = 0x3c00, kMinusOne = 0xbc00, kNan = 0x7e00;
    test::Ktx2 file{.vk_format = 97, .type_size = 2, .width = 2, .height = is_cube ? 2u : 1u, .model = 1};
    file.faces = is_cube ? 6 : 1;
    file.channels = {0, 1, 2, 15};
    Bytes level;
    for (unsigned i = 0; i < (is_cube ? 96u : 8u); ++i) {
      const unsigned half = i == 1 ? kMinusOne : i == 5 ? kNan : kOne;
      level.push_back(static_cast<std::byte>(half & 255u));
      level.push_back(static_cast<std::byte>(half >> 8));
    }
    file.levels = {level};
    write_file(folder.path() / "sky.ktx2", file.bytes());
    const EnvironmentFile sky = read_clean_environment(folder.path() / "sky.ktx2");
    ASSERT_EQ(sky.cube.empty(), !is_cube);
    EXPECT_EQ(sky.warnings.size(), 2u);
    const Image& image = is_cube ? sky.cube.levels[0][0] : sky.panorama;
    for (const float v : image.pixels) EXPECT_GE(v, 0.0f);
    EXPECT_EQ(std::count(image.pixels.begin(), image.pixels.end(), 0.0f), 2);
  }
}

TEST(unit_image_astc, a_cube_map_is_read_in_blocks) {
  const test::TempFolder folder;
  const fs::path path = folder.path() / "sky.ktx2";
  test::Ktx2 cube{.vk_format = 1000066000, .width = 8, .height = 8, .faces = 6, .model = 162, .channels = {0}};
  Bytes level;
  for (int face = 0; face < 6; ++face) {
    const std::vector<float> plain = [&] {
      std::vector<float> rgba;
      for (int i = 0; i < 64; ++i)
        for (int c = 0; c < 4; ++c) rgba.push_back(c == 3 ? 1.0f : std::exp2(static_cast<float>(face)));
      return rgba;
    }();
    const Bytes blocks = astc_of(plain, 8, 8, {4, 4}, ASTCENC_PRF_HDR);
    level.insert(level.end(), blocks.begin(), blocks.end());
  }
  cube.levels = {level};
  write_file(path, cube.bytes());
  EXPECT_EQ(find_cube_source(path), CubeSource::texture);
  const Cubemap read = read_cubemap(path);
  for (std::size_t face = 0; face < 6; ++face)
    EXPECT_NEAR(read.levels[0][face].rgb(5, 2).y, std::exp2(static_cast<float>(face)),
                0.02f * std::exp2(static_cast<float>(face)));
}

// ----- UASTC is ASTC in other words: the same block by both decoders

/// How a mode's fields lie, and what ASTC calls them (table "UASTC to ASTC configuration mapping").
struct Recoding {
  unsigned hints, endpoint_bits, digits, weight_bits, subsets, components;
  bool is_dual;
  unsigned astc_mode, endpoint_mode;
};
constexpr std::array<Recoding, test::kUastcModes> kRecodings{{{15, 6, 3, 4, 1, 3, false, 578, 8},
                                                              {15, 8, 0, 2, 1, 3, false, 66, 8},
                                                              {15, 4, 0, 3, 2, 3, false, 83, 8},
                                                              {15, 2, 3, 2, 3, 3, false, 66, 8},
                                                              {15, 3, 5, 2, 2, 3, false, 66, 8},
                                                              {15, 8, 0, 3, 1, 3, false, 83, 8},
                                                              {15, 5, 5, 2, 1, 3, true, 1090, 8},
                                                              {15, 3, 5, 2, 2, 3, false, 66, 8},
                                                              {0, 0, 0, 0, 0, 0, false, 0, 0},
                                                              {23, 4, 0, 2, 2, 4, false, 66, 12},
                                                              {17, 4, 3, 4, 1, 4, false, 578, 12},
                                                              {17, 4, 3, 2, 1, 4, true, 1090, 12},
                                                              {17, 6, 3, 3, 1, 4, false, 83, 12},
                                                              {23, 8, 0, 1, 1, 4, true, 1089, 12},
                                                              {23, 8, 0, 2, 1, 4, false, 66, 12},
                                                              {23, 8, 0, 4, 1, 2, false, 578, 4},
                                                              {23, 8, 0, 2, 2, 2, false, 66, 4},
                                                              {23, 8, 0, 2, 1, 2, true, 1090, 4},
                                                              {15, 5, 0, 5, 1, 3, false, 595, 8}}};

constexpr std::array<unsigned, 30> kSeedsOfTwo{28, 20,  16,  29, 91,  9,   107, 72,  149, 204, 50,  114, 496, 17,  78,
                                               39, 252, 828, 43, 156, 116, 210, 476, 273, 684, 359, 246, 195, 694, 524};
constexpr std::array<unsigned, 19> kSeedsOfSeven{36,  48,  61,  137, 161, 183, 226, 281, 302, 307,
                                                 479, 495, 593, 594, 605, 799, 812, 988, 993};
constexpr std::array<unsigned, 11> kSeedsOfThree{260, 74, 32, 156, 183, 15, 745, 0, 335, 902, 254};

/// ASTC, "Integer Sequence Encoding": the five trits of 8 bits, and the three quints of 7.
std::array<unsigned, 5> trits_of(unsigned t) {
  const auto bit = [&t](unsigned i) { return t >> i & 1u; };
  std::array<unsigned, 5> trits{};
  unsigned c = 0;
  if ((t >> 2 & 7u) == 7) {
    c = (t >> 5 & 7u) << 2 | (t & 3u);
    trits[4] = trits[3] = 2;
  } else {
    c = t & 31u;
    trits[4] = (t >> 5 & 3u) == 3 ? 2 : bit(7);
    trits[3] = (t >> 5 & 3u) == 3 ? bit(7) : t >> 5 & 3u;
  }
  if ((c & 3u) == 3) {
    trits[2] = 2;
    trits[1] = c >> 4 & 1u;
    trits[0] = (c >> 3 & 1u) << 1 | (c >> 2 & 1u & ~(c >> 3));
  } else if ((c >> 2 & 3u) == 3) {
    trits[2] = trits[1] = 2;
    trits[0] = c & 3u;
  } else {
    trits[2] = c >> 4 & 1u;
    trits[1] = c >> 2 & 3u;
    trits[0] = (c >> 1 & 1u) << 1 | (c & 1u & ~(c >> 1));
  }
  return trits;
}

std::array<unsigned, 3> quints_of(unsigned q) {
  const unsigned low = q & 1u;
  if ((q >> 1 & 3u) == 3 && (q >> 5 & 3u) == 0)
    return {4, 4, low << 2 | (q >> 4 & 1u & ~low) << 1 | (q >> 3 & 1u & ~low)};
  unsigned c = q & 31u, last = q >> 5 & 3u;
  if ((q >> 1 & 3u) == 3) {
    last = 4;
    c = (q >> 3 & 3u) << 3 | (~(q >> 5) & 3u) << 1 | low;
  }
  if ((c & 7u) == 5) return {c >> 3 & 3u, 4, last};
  return {c & 7u, c >> 3 & 3u, last};
}

/// Values of `bits` bits with a trit or quint above them, from bit `at` of the block up.
void put_sequence(std::span<std::byte> block, unsigned at, const std::vector<unsigned>& values, unsigned bits,
                  unsigned digits) {
  if (digits == 0) {
    for (const unsigned value : values) put_bits(block, at, bits, value), at += bits;
    return;
  }
  const std::size_t group = digits == 3 ? 5 : 3;
  const std::vector<unsigned> packed_bits =
      digits == 3 ? std::vector<unsigned>{2, 2, 1, 2, 1} : std::vector<unsigned>{3, 2, 2};
  for (std::size_t begin = 0; begin < values.size(); begin += group) {
    const std::size_t count = std::min(group, values.size() - begin);
    const auto digit = [&](std::size_t i) { return i < count ? values[begin + i] >> bits : 0u; };
    // The bits beyond the sequence's end are read as 0.
    unsigned known = 0;
    for (std::size_t i = 0; i < count; ++i) known += packed_bits[i];
    unsigned packed = 0;
    const auto fits = [&] {
      for (std::size_t i = 0; i < count; ++i)
        if ((digits == 3 ? trits_of(packed)[i] : quints_of(packed)[i]) != digit(i)) return false;
      return true;
    };
    while (!fits() && packed < 1u << known) ++packed;
    ASSERT_LT(packed, 1u << known);
    for (std::size_t i = 0; i < count; ++i) {
      put_bits(block, at, bits, values[begin + i] & ((1u << bits) - 1));
      at += bits;
      put_bits(block, at, packed_bits[i], packed);
      at += packed_bits[i];
      packed >>= packed_bits[i];
    }
  }
}

/// Which subset each texel is of: ASTC, "Partition Pattern Generation", for blocks of 4x4.
unsigned subset_of(unsigned seed, unsigned subsets, unsigned x, unsigned y) {
  if (subsets == 1) return 0;
  std::uint32_t p = seed + (subsets - 1) * 1024;
  const std::uint32_t number = p;
  p ^= p >> 15, p -= p << 17, p += p << 7, p += p << 4;
  p ^= p >> 5, p += p << 16, p ^= p >> 7, p ^= p >> 3;
  p ^= p << 6, p ^= p >> 17;
  const unsigned first = (number & 1u) != 0 ? ((number & 2u) != 0 ? 4 : 5) : subsets == 3 ? 6 : 5;
  const unsigned second = (number & 1u) != 0 ? (subsets == 3 ? 6 : 5) : (number & 2u) != 0 ? 4 : 5;
  std::array<unsigned, 6> steps{};
  for (unsigned i = 0; i < 6; ++i) {
    const unsigned digit = p >> 4 * i & 15u;
    steps[i] = digit * digit >> (i % 2 == 0 ? first : second);
  }
  const auto value = [&](std::size_t i, unsigned shift) {
    return (steps[2 * i] * 2 * x + steps[2 * i + 1] * 2 * y + (p >> shift)) & 63u;
  };
  const unsigned a = value(0, 14), b = value(1, 10), c = subsets == 3 ? value(2, 6) : 0;
  return a >= b && a >= c ? 0 : b >= c ? 1 : 2;
}

/// 8 bits of an endpoint, to compare brightness: the library's own decoder does the rest. ASTC, "Endpoint
/// Unquantization".
unsigned wide(const Recoding& r, unsigned code) {
  if (r.digits == 0)
    return r.endpoint_bits == 8 ? code : r.endpoint_bits == 5 ? code << 3 | code >> 2 : code << 4 | code;
  const unsigned digit = code >> r.endpoint_bits;
  const auto bit = [code](unsigned i) { return code >> i & 1u; };
  const unsigned a = bit(0) * 0x1ff;
  unsigned b = 0, c = 0;
  switch (r.endpoint_bits) {
    case 2:
      b = bit(1) * 0b100010110, c = 93;
      break;
    case 3:
      b = (bit(2) << 8) | (bit(1) << 7) | (bit(2) << 2) | (bit(1) << 1) | bit(2), c = 26;
      break;
    case 4:
      b = (bit(3) << 8) | (bit(2) << 7) | (bit(1) << 6) | (bit(3) << 2) | (bit(2) << 1) | bit(1), c = 22;
      break;
    case 5:
      b = (bit(4) << 8) | (bit(3) << 7) | (bit(2) << 6) | (bit(1) << 5) | bit(4), c = 6;
      break;
    default:
      b = (bit(5) << 8) | (bit(4) << 7) | (bit(3) << 6) | (bit(2) << 5) | (bit(1) << 4) | bit(5), c = 5;
      break;
  }
  return (a & 0x80) | ((digit * c + b) ^ a) >> 2;
}

Bytes astc_of_uastc(std::size_t mode, std::span<const std::byte> block) {
  const test::UastcShape& shape = test::kUastcShapes[mode];
  Bytes out(16);
  unsigned at = shape.length;
  if (mode == 8) {  // a void extent
    std::fill(out.begin(), out.begin() + 8, std::byte{0xff});
    out[0] = std::byte{0xfc};
    out[1] = std::byte{0xfd};
    for (unsigned c = 0; c < 4; ++c) put_bits(out, 64 + 16 * c, 16, bits_at(block, at + 8 * c, 8) * 257);
    return out;
  }
  const Recoding& r = kRecodings[mode];
  const auto take = [&](unsigned count) {
    const unsigned value = bits_at(block, at, count);
    at += count;
    return value;
  };
  take(r.hints);
  const unsigned channel = r.is_dual && r.components != 2 ? take(2) : 3;
  const unsigned pattern = shape.patterns > 0 ? take(shape.pattern_bits) : 0;
  const unsigned seed = r.subsets == 3 ? kSeedsOfThree[pattern]
                        : mode == 7    ? kSeedsOfSeven[pattern]
                                       : kSeedsOfTwo[pattern];

  const std::size_t count = std::size_t{2} * r.components * r.subsets;
  std::vector<unsigned> ends(count, 0);
  const std::size_t group = r.digits == 3 ? 5 : 3;
  for (std::size_t begin = 0; r.digits != 0 && begin < count; begin += group) {
    constexpr std::array<unsigned, 6> kTritBits{0, 2, 4, 5, 7, 8};
    const std::size_t size = std::min(group, count - begin);
    unsigned packed = take(r.digits == 3 ? kTritBits[size] : 7);
    for (std::size_t i = 0; i < size; ++i, packed /= r.digits) ends[begin + i] = (packed % r.digits) << r.endpoint_bits;
  }
  for (unsigned& end : ends) end |= take(r.endpoint_bits);

  std::vector<unsigned> weights, subsets;
  std::array<bool, 3> seen{};
  for (unsigned i = 0; i < 16; ++i) {
    const unsigned subset = subset_of(seed, r.subsets, i % 4, i / 4);
    subsets.push_back(subset);
    for (unsigned plane = 0; plane < (r.is_dual ? 2u : 1u); ++plane)
      weights.push_back(take(r.weight_bits - (seen[subset] ? 0 : 1)));
    seen[subset] = true;
  }
  // ASTC takes a darker second end as a sign of something else: turn such pairs round.
  for (unsigned subset = 0; subset < r.subsets && r.components != 2; ++subset) {
    unsigned* pair = &ends[std::size_t{2} * r.components * subset];
    const auto sum = [&](unsigned side) {
      return wide(r, pair[side]) + wide(r, pair[2 + side]) + wide(r, pair[4 + side]);
    };
    if (sum(1) >= sum(0)) continue;
    for (std::size_t c = 0; c < r.components; ++c) std::swap(pair[2 * c], pair[2 * c + 1]);
    for (std::size_t i = 0; i < weights.size(); ++i)
      if (subsets[i / (r.is_dual ? 2 : 1)] == subset) weights[i] = (1u << r.weight_bits) - 1 - weights[i];
  }

  put_bits(out, 0, 11, r.astc_mode);
  put_bits(out, 11, 2, r.subsets - 1);
  if (r.subsets > 1) {
    put_bits(out, 13, 10, seed);
    put_bits(out, 25, 4, r.endpoint_mode);
  } else {
    put_bits(out, 13, 4, r.endpoint_mode);
  }
  put_sequence(out, r.subsets > 1 ? 29 : 17, ends, r.endpoint_bits, r.digits);
  unsigned top = 128;
  for (const unsigned weight : weights)
    for (unsigned bit = 0; bit < r.weight_bits; ++bit) put_bits(out, --top, 1, weight >> bit);
  if (r.is_dual) put_bits(out, top - 2, 2, channel);
  return out;
}

TEST(unit_image_astc, uastc_decodes_as_the_astc_that_it_stands_for) {
  constexpr std::size_t kCount = 120;
  for (std::size_t mode = 0; mode < test::kUastcModes; ++mode) {
    const Bytes blocks = test::random_uastc(mode, kCount);
    Bytes astc;
    for (std::size_t i = 0; i < kCount; ++i) {
      const Bytes block = astc_of_uastc(mode, std::span(blocks).subspan(16 * i, 16));
      astc.insert(astc.end(), block.begin(), block.end());
    }
    std::vector<std::uint8_t> ours(kCount * 64), theirs(kCount * 64);
    codec::decode_uastc(blocks, 4 * kCount, 4, codec::UastcRounding::srgb, ours);
    codec::AstcDecoder(4, 4, codec::AstcProfile::srgb, "t").decode(astc, 4 * kCount, 4, std::span(theirs));
    EXPECT_EQ(ours, theirs) << "mode " << mode;
  }
}

}  // namespace
}  // namespace candela
