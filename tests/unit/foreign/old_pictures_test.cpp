#include "foreign/old_pictures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>

#include "base/error.h"
#include "unit/foreign/old_picture_files.h"

#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_BMP
#define STBI_ONLY_TGA
#define STB_IMAGE_STATIC
#include <stb_image.h>

namespace candela::foreign {
namespace {

using test::Bytes;
using Texel = std::array<std::uint8_t, 4>;

Texel texel(const TextureImage& image, int x, int y) {
  Texel result{};
  std::copy_n(image.pixels.begin() + std::ptrdiff_t{4} * (y * image.width + x), 4, result.begin());
  return result;
}

template <class F>
void expect_picture(const Bytes& bytes, F&& expected) {
  const auto image = decode_old_picture(bytes, "a picture");
  ASSERT_TRUE(image);
  ASSERT_EQ(ivec2(image->width, image->height), ivec2(test::kWidth, test::kHeight));
  for (int y = 0; y < test::kHeight; ++y) {
    for (int x = 0; x < test::kWidth; ++x) ASSERT_EQ(texel(*image, x, y), expected(x, y)) << x << ", " << y;
  }
}

/// Alpha where the file keeps it, else 255.
Texel with_alpha(Texel c, bool keeps) { return {c[0], c[1], c[2], keeps ? c[3] : std::uint8_t{255}}; }

TEST(unit_foreign_old_pictures, every_form_of_tga_shows_the_picture) {
  for (const test::Tga& t : test::tgas()) {
    SCOPED_TRACE(testing::Message() << "kind " << t.kind << ", " << t.bits << " bits, map " << t.map_bits);
    expect_picture(test::tga(t), [&](int x, int y) -> Texel {
      const Texel c = with_alpha(test::shown(x, y), t.alpha_bits > 0);
      return (t.kind & ~8) == 3 ? Texel{c[0], c[0], c[0], c[3]} : c;
    });
  }
}

TEST(unit_foreign_old_pictures, every_form_of_bmp_shows_the_picture) {
  for (const test::Bmp& b : test::bmps()) {
    SCOPED_TRACE(testing::Message() << b.bits << " bits, packing " << b.packing << ", header " << b.header);
    expect_picture(test::bmp(b), [&](int x, int y) {
      const Texel c = b.bits == 1 ? test::shown(0, test::index_of(x, y) / 2 * 2) : test::shown(x, y);
      return with_alpha(c, b.packing == 3 && b.header > 40);
    });
  }
}

/// Run-length coded BMP, mirrored TGA and colour maps that begin later are beyond it.
TEST(unit_foreign_old_pictures, stb_image_sees_the_same) {
  std::size_t compared = 0;
  for (const Bytes& bytes : test::old_picture_seeds()) {
    int width = 0, height = 0, channels = 0;
    stbi_uc* pixels = stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()),
                                            static_cast<int>(bytes.size()), &width, &height, &channels, 3);
    if (pixels == nullptr) continue;
    const bool is_beyond = is_tga(bytes) && ((bytes[17] & std::byte{16}) != std::byte{0} || bytes[1] != std::byte{0});
    const auto image = decode_old_picture(bytes, "a picture");
    ASSERT_TRUE(image);
    for (int i = 0; i < width * height && !is_beyond; ++i) {
      const Texel c = texel(*image, i % width, i / width);
      ASSERT_TRUE(std::equal(pixels + std::ptrdiff_t{3} * i, pixels + std::ptrdiff_t{3} * (i + 1), c.begin()))
          << compared << ": " << i;
    }
    compared += is_beyond ? 0 : 1;
    stbi_image_free(pixels);
  }
  EXPECT_GT(compared, 20u);
}

TEST(unit_foreign_old_pictures, a_file_that_is_cut_short_is_an_error_and_no_picture) {
  for (const Bytes& bytes : test::old_picture_seeds()) {
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      // Rows of a BMP end at four bytes; the last one need not.
      if (is_bmp(bytes) && bytes.size() - size < 4) continue;
      const auto cut = std::span(bytes).first(size);
      if (!is_bmp(cut) && !is_tga(cut)) continue;  // too short for its header
      EXPECT_THROW(decode_old_picture(cut, "cut"), Error) << size << " of " << bytes.size();
    }
  }
}

TEST(unit_foreign_old_pictures, claims_are_not_believed) {
  Bytes big = test::tga({10, 24});
  big[12] = big[14] = std::byte{0}, big[13] = big[15] = std::byte{0x40};  // 16384 x 16384
  EXPECT_THROW(decode_tga(big, "big"), Error);
  big[13] = std::byte{0xFF};
  big.resize(big.size() + (8 << 20));
  EXPECT_THROW(decode_tga(big, "wider than any texture"), Error);
  Bytes runs = test::bmp({8, 1});
  runs[19] = runs[23] = std::byte{0x40};
  EXPECT_THROW(decode_bmp(runs, "runs"), Error);
  Bytes outside = test::tga({1, 8, 24});
  outside.back() = std::byte{14};
  EXPECT_THROW(decode_tga(outside, "an index beyond the map"), Error);
}

TEST(unit_foreign_old_pictures, alpha_of_zeros_is_none) {
  Bytes bytes = test::tga({2, 32, 0, 8});
  for (std::size_t i = 21 + 3; i < bytes.size(); i += 4) bytes[i] = std::byte{0};
  EXPECT_EQ(texel(decode_tga(bytes, "a"), 0, 0)[3], 255);
}

TEST(unit_foreign_old_pictures, other_pictures_are_none_of_these) {
  for (const char* head :
       {"\x89PNG\r\n\x1a\n", "\xff\xd8\xff\xe0", "RIFF", "\xabKTX 20\xbb\r\n\x1a\n", "GIF89a", "II*", "#?RADIANCE\n"}) {
    Bytes bytes;
    for (const char* c = head; *c != '\0'; ++c) bytes.push_back(static_cast<std::byte>(*c));
    bytes.resize(64, std::byte{1});
    EXPECT_FALSE(decode_old_picture(bytes, "a")) << head;
  }
}

TEST(unit_foreign_old_pictures, hostile_bytes_are_an_error_or_a_picture) {
  std::uint32_t state = 1;
  const auto random = [&] { return state = state * 1664525u + 1013904223u, state >> 8; };
  for (const Bytes& seed : test::old_picture_seeds()) {
    for (int round = 0; round < 500; ++round) {
      Bytes bad = seed;
      for (std::uint32_t k = 0; k < 1 + random() % 3; ++k)
        bad[random() % bad.size()] = static_cast<std::byte>(random());
      try {
        const auto image = decode_old_picture(bad, "bad");
        if (image) {
          EXPECT_EQ(image->pixels.size(),
                    std::size_t{4} * static_cast<std::size_t>(image->width) * static_cast<std::size_t>(image->height));
        }
      } catch (const Error&) {
      }
    }
  }
}

}  // namespace
}  // namespace candela::foreign
