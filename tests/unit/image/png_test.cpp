#include <gtest/gtest.h>
#include <png.h>

#include <cstring>
#include <set>

#include "base/file.h"
#include "base/parallel.h"
#include "image/develop.h"
#include "image/image_file.h"
#include "unit/base/temp_folder.h"
#include "unit/image/image_util.h"

namespace candela {
namespace {

using test::Bytes;

struct Kind {
  int color;
  int bits;
  bool transparency;  ///< a tRNS chunk
  bool interlaced;
};

int samples_per_pixel(int color) {
  return color == PNG_COLOR_TYPE_GRAY || color == PNG_COLOR_TYPE_PALETTE ? 1
         : color == PNG_COLOR_TYPE_GRAY_ALPHA                            ? 2
         : color == PNG_COLOR_TYPE_RGB                                   ? 3
                                                                         : 4;
}

constexpr int kWidth = 13, kHeight = 11;
constexpr std::uint16_t kKey = 1;  // the transparent grey or colour, in samples

png_color palette_color(int i) {
  const auto value = [&](int k) { return static_cast<png_byte>(i * k + k); };
  return {value(3), value(7), value(11)};
}
std::uint8_t palette_alpha(int i) { return static_cast<std::uint8_t>(255 - 50 * i); }

/// One sample per entry, whatever its depth.
std::vector<std::uint16_t> random_samples(const Kind& kind) {
  std::mt19937 random(7);
  std::vector<std::uint16_t> samples(static_cast<std::size_t>(kWidth * kHeight * samples_per_pixel(kind.color)));
  for (auto& s : samples) s = static_cast<std::uint16_t>(random() & ((1u << kind.bits) - 1));
  for (std::size_t i = 0; i < 12; ++i) samples[i] = kKey;  // some pixels of the transparent colour
  return samples;
}

Bytes encode(const Kind& kind, const std::vector<std::uint16_t>& samples) {
  Bytes out;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &out,
      [](png_structp p, png_bytep data, std::size_t count) {
        auto* bytes = static_cast<Bytes*>(png_get_io_ptr(p));
        const auto* from = reinterpret_cast<const std::byte*>(data);
        bytes->insert(bytes->end(), from, from + count);
      },
      [](png_structp) {});
  png_set_IHDR(png, info, kWidth, kHeight, kind.bits, kind.color,
               kind.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_color palette[256];
  for (int i = 0; i < 256; ++i) palette[i] = palette_color(i);
  if (kind.color == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(png, info, palette, 1 << kind.bits);
  png_color_16 key{0, kKey, kKey, kKey, kKey};
  png_byte alphas[2] = {palette_alpha(0), palette_alpha(1)};
  if (kind.transparency) png_set_tRNS(png, info, alphas, 2, &key);
  png_write_info(png, info);
  if (kind.bits < 8) png_set_packing(png);
  const std::size_t row_samples = samples.size() / kHeight;
  const std::size_t sample_bytes = kind.bits == 16 ? 2 : 1;
  std::vector<png_byte> rows(samples.size() * sample_bytes);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (kind.bits == 16) {
      rows[2 * i] = static_cast<png_byte>(samples[i] >> 8);
      rows[2 * i + 1] = static_cast<png_byte>(samples[i] & 255);
    } else {
      rows[i] = static_cast<png_byte>(samples[i]);
    }
  }
  std::vector<png_bytep> pointers;
  pointers.reserve(kHeight);
  for (std::size_t y = 0; y < kHeight; ++y) pointers.push_back(rows.data() + y * row_samples * sample_bytes);
  png_write_image(png, pointers.data());
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return out;
}

/// What the PNG specification says the texel is, as RGBA of 8 or 16 bits.
std::array<int, 4> expected_texel(const Kind& kind, const std::uint16_t* s) {
  const int white = kind.bits == 16 ? 65535 : 255;
  const int scale = kind.bits < 8 ? 255 / ((1 << kind.bits) - 1) : 1;
  switch (kind.color) {
    case PNG_COLOR_TYPE_GRAY: {
      const int grey = s[0] * scale;
      return {grey, grey, grey, kind.transparency && s[0] == kKey ? 0 : white};
    }
    case PNG_COLOR_TYPE_GRAY_ALPHA:
      return {s[0], s[0], s[0], s[1]};
    case PNG_COLOR_TYPE_RGB: {
      const bool clear = kind.transparency && s[0] == kKey && s[1] == kKey && s[2] == kKey;
      return {s[0], s[1], s[2], clear ? 0 : white};
    }
    case PNG_COLOR_TYPE_RGB_ALPHA:
      return {s[0], s[1], s[2], s[3]};
    default: {
      const png_color c = palette_color(s[0]);
      return {c.red, c.green, c.blue, kind.transparency && s[0] < 2 ? palette_alpha(s[0]) : 255};
    }
  }
}

std::vector<Kind> all_kinds() {
  std::vector<Kind> kinds;
  for (const bool interlaced : {false, true}) {
    for (const bool transparency : {false, true}) {
      for (const int bits : {1, 2, 4, 8, 16}) {
        kinds.push_back({PNG_COLOR_TYPE_GRAY, bits, transparency, interlaced});
        if (bits < 16) kinds.push_back({PNG_COLOR_TYPE_PALETTE, bits, transparency, interlaced});
        if (bits >= 8) kinds.push_back({PNG_COLOR_TYPE_RGB, bits, transparency, interlaced});
        if (bits >= 8 && !transparency) kinds.push_back({PNG_COLOR_TYPE_GRAY_ALPHA, bits, false, interlaced});
        if (bits >= 8 && !transparency) kinds.push_back({PNG_COLOR_TYPE_RGB_ALPHA, bits, false, interlaced});
      }
    }
  }
  return kinds;
}

TEST(unit_image_png, every_kind_decodes_to_what_the_specification_says) {
  for (const Kind& kind : all_kinds()) {
    SCOPED_TRACE(testing::Message() << "colour type " << kind.color << ", " << kind.bits << " bits, tRNS "
                                    << kind.transparency << ", interlaced " << kind.interlaced);
    const auto samples = random_samples(kind);
    const Bytes bytes = encode(kind, samples);
    EXPECT_EQ(read_image_size(bytes, "t"), ivec2(kWidth, kHeight));
    const TextureImage image = decode_texture(bytes, "t");
    ASSERT_EQ(image.width, kWidth);
    ASSERT_EQ(image.height, kHeight);
    ASSERT_EQ(image.bits, kind.bits == 16 ? 16 : 8);
    EXPECT_EQ(image.has_alpha, kind.transparency || (kind.color & PNG_COLOR_MASK_ALPHA) != 0);
    ASSERT_EQ(image.pixels.size(), static_cast<std::size_t>(kWidth * kHeight * 4 * image.bits / 8));
    const int per_pixel = samples_per_pixel(kind.color);
    for (int i = 0; i < kWidth * kHeight; ++i) {
      const auto expected = expected_texel(kind, &samples[static_cast<std::size_t>(i * per_pixel)]);
      for (int c = 0; c < 4; ++c) {
        std::uint16_t wide = 0;
        const auto at = static_cast<std::size_t>(i * 4 + c);
        if (image.bits == 16)
          std::memcpy(&wide, image.pixels.data() + at * 2, 2);
        else
          wide = image.pixels[at];
        ASSERT_EQ(wide, expected[static_cast<std::size_t>(c)]) << "texel " << i << " channel " << c;
      }
    }
  }
}

TEST(unit_image_png, damage_is_an_error_and_never_a_crash) {
  const auto decode = [](std::span<const std::byte> bytes) { decode_texture(bytes, "t"); };
  for (const Kind kind : {Kind{PNG_COLOR_TYPE_RGB, 8, true, false}, Kind{PNG_COLOR_TYPE_PALETTE, 4, true, true},
                          Kind{PNG_COLOR_TYPE_GRAY_ALPHA, 16, false, true}})
    test::check_damage(decode, encode(kind, random_samples(kind)));
}

TEST(unit_image_png, a_wrong_checksum_says_so_and_where) {
  const Kind kind{PNG_COLOR_TYPE_RGB, 8, false, false};
  Bytes bytes = encode(kind, random_samples(kind));
  bytes[bytes.size() - 12 - 3] ^= std::byte{1};  // in the checksum of the last IDAT, before IEND's 12 bytes
  try {
    decode_texture(bytes, "wall.png");
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(e.message().find("CRC"), std::string::npos) << e.what();
    EXPECT_EQ(e.where(), "wall.png");
  }
}

void put_u32(Bytes& bytes, std::size_t at, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) bytes[at + static_cast<std::size_t>(i)] = static_cast<std::byte>(value >> (24 - 8 * i));
}

/// A valid file whose IHDR claims another size (with the right checksum).
Bytes with_size(std::uint32_t width, std::uint32_t height) {
  const Kind kind{PNG_COLOR_TYPE_GRAY, 1, false, false};
  Bytes bytes = encode(kind, random_samples(kind));
  put_u32(bytes, 16, width);
  put_u32(bytes, 20, height);
  std::uint32_t crc = 0xffffffffu;
  for (std::size_t i = 12; i < 29; ++i) {
    crc ^= static_cast<std::uint32_t>(bytes[i]);
    for (int k = 0; k < 8; ++k) crc = (crc >> 1) ^ (crc & 1 ? 0xedb88320u : 0u);
  }
  put_u32(bytes, 29, ~crc);
  return bytes;
}

TEST(unit_image_png, sizes_that_cannot_be_are_refused_before_the_pixels_are_allocated) {
  EXPECT_TRUE(test::survives([](auto b) { read_image_size(b, "t"); }, with_size(16384, 16384)));
  EXPECT_FALSE(test::survives([](auto b) { read_image_size(b, "t"); }, with_size(16385, 1)));
  EXPECT_FALSE(test::survives([](auto b) { decode_texture(b, "t"); }, with_size(1, 16385)));
  EXPECT_FALSE(test::survives([](auto b) { decode_texture(b, "t"); }, with_size(0, 1)));
  try {
    decode_texture(with_size(16384, 16384), "t");  // 1 GiB of texels from a hundred bytes
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.message(), "damaged PNG: the file is truncated");
  }
}

TEST(unit_image_png, what_is_too_large_is_called_so_and_not_damaged) {
  // 32768 x 8 is a valid PNG, and so are all sizes below 2^31.
  for (const auto& [width, height] :
       {std::pair{16385u, 1u}, {1u, 16385u}, {32768u, 8u}, {8u, 1u << 24}, {2147483647u, 1u}}) {
    for (const bool decodes : {false, true}) {
      try {
        const auto bytes = with_size(width, height);
        if (decodes) decode_texture(bytes, "t");
        if (!decodes) read_image_size(bytes, "t");
        ADD_FAILURE() << width << " x " << height;
      } catch (const Error& e) {
        EXPECT_EQ(e.message(), "image of " + std::to_string(width) + " x " + std::to_string(height) +
                                   " is too large: a side has at most 16384 pixels");
      }
    }
  }
}

TEST(unit_image_png, decoding_in_parallel_gives_what_decoding_alone_gives) {
  const std::vector<Kind> kinds = all_kinds();
  std::vector<Bytes> files;
  std::vector<TextureImage> alone;
  for (const Kind& kind : kinds) {
    files.push_back(encode(kind, random_samples(kind)));
    alone.push_back(decode_texture(files.back(), "t"));
  }
  std::atomic<int> different = 0, accepted = 0;
  parallel_for(0, kinds.size() * 20, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Bytes& file = files[i % kinds.size()];
      if (decode_texture(file, "t").pixels != alone[i % kinds.size()].pixels) ++different;
      if (test::survives([](auto b) { decode_texture(b, "t"); }, std::span(file).first(file.size() / 2))) ++accepted;
    }
  });
  EXPECT_EQ(different, 0);
  EXPECT_EQ(accepted, 0);
}

TEST(unit_image_png, a_written_picture_reads_back_exactly) {
  const test::TempFolder folder;
  for (const bool opaque : {true, false}) {
    const DisplayImage image = test::random_display(37, 23, opaque);
    write_png(folder / "a.png", image);
    const TextureImage back = decode_texture(read_file(folder / "a.png"), "t");
    EXPECT_EQ(back.has_alpha, !opaque);
    EXPECT_EQ(back.bits, 8);
    EXPECT_EQ(back.pixels, image.rgba);
  }
}

TEST(unit_image_png, the_written_header_says_srgb_before_the_pixels) {
  const test::TempFolder folder;
  write_png(folder / "a.png", test::random_display(4, 4, true));
  const Bytes bytes = read_file(folder / "a.png");
  const auto u32 = [&](std::size_t at) {
    std::uint32_t v = 0;
    for (std::size_t i = 0; i < 4; ++i) v = v << 8 | static_cast<std::uint32_t>(bytes[at + i]);
    return v;
  };
  std::map<std::string, std::size_t> data_of;
  for (std::size_t at = 8; at + 8 <= bytes.size(); at += u32(at) + 12) {
    std::string name(4, ' ');
    std::memcpy(name.data(), &bytes[at + 4], 4);
    if (name == "IDAT") break;
    data_of[name] = at + 8;
  }
  ASSERT_TRUE(data_of.count("sRGB") && data_of.count("gAMA") && data_of.count("cHRM"));
  EXPECT_EQ(u32(data_of["gAMA"]), 45455u);      // 1/2.2, as PNG 1.2 §4.2.2.3 asks for beside sRGB
  EXPECT_EQ(u32(data_of["cHRM"]), 31270u);      // white x
  EXPECT_EQ(u32(data_of["cHRM"] + 8), 64000u);  // red x
}

}  // namespace
}  // namespace candela
