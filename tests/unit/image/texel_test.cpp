#include "image/texel.h"

#include <gtest/gtest.h>
#include <half.h>

#include <cmath>
#include <functional>
#include <random>

#include "unit/image/image_util.h"

namespace candela {
namespace {

std::vector<float> many_values(float largest) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> stops(-30.0f, std::log2(largest));
  std::vector<float> values{0.0f, 0x1p-24f, 0x1p-25f, 0x1.8p-25f, 0x1p-14f, 1.0f, 1.0009765f, largest};
  for (int i = 0; i < 20000; ++i) values.push_back(std::exp2(stops(random)));
  return values;
}

TEST(unit_image_texel, halves_are_those_of_another_library) {
  for (const float sign : {1.0f, -1.0f}) {
    for (const float v : many_values(65504.0f)) EXPECT_EQ(half_from_float(sign * v), Imath::half(sign * v).bits()) << v;
  }
  for (unsigned code = 0; code < 65536; ++code) {
    Imath::half theirs;
    theirs.setBits(static_cast<std::uint16_t>(code));
    const float ours = float_from_half(static_cast<std::uint16_t>(code));
    if (theirs.isNan()) {
      EXPECT_TRUE(std::isnan(ours));
    } else {
      ASSERT_EQ(ours, static_cast<float>(theirs));
    }
  }
}

/// How much further than the nearest of the neighbouring codes `encode` lies from the values, at worst; 0 = nearest.
double excess_error(const std::function<std::uint32_t(float)>& encode,
                    const std::function<float(std::uint32_t)>& decode, float largest) {
  double worst = 0.0;
  for (const float v : many_values(largest)) {
    const std::uint32_t code = encode(v);
    const auto error = [&](std::uint32_t c) {
      return std::abs(static_cast<double>(decode(c)) - static_cast<double>(v));
    };
    double best = error(code);
    if (code > 0) best = std::min(best, error(code - 1));
    if (std::isfinite(decode(code + 1))) best = std::min(best, error(code + 1));
    worst = std::max(worst, (error(code) - best) / static_cast<double>(v > 0.0f ? v : 1.0f));
  }
  return worst;
}

TEST(unit_image_texel, unsigned_floats_are_the_nearest) {
  const auto red = [](float v) { return r11g11b10f_from_color({v, 0, 0}); };
  const auto blue = [](float v) { return r11g11b10f_from_color({0, 0, v}) >> 22; };
  const auto from_red = [](std::uint32_t c) { return color_from_r11g11b10f(c & 0x7ffu).x; };
  const auto from_blue = [](std::uint32_t c) { return color_from_r11g11b10f((c & 0x3ffu) << 22).z; };
  EXPECT_EQ(excess_error(red, from_red, 65024.0f), 0.0);
  EXPECT_EQ(excess_error(blue, from_blue, 64512.0f), 0.0);
  // The twin that cuts off: what many encoders do.
  const auto cut = [&](float v) { return red(v * (1.0f - 1.0f / 256.0f)); };
  EXPECT_GT(excess_error(cut, from_red, 65024.0f), 1e-3);
  // Green sits between the two.
  EXPECT_EQ(color_from_r11g11b10f(r11g11b10f_from_color({1.0f, 0.5f, 3.0f})), vec3(1.0f, 0.5f, 3.0f));
}

TEST(unit_image_texel, every_code_of_a_packed_format_is_its_own_nearest) {
  std::mt19937 random(2);
  for (int i = 0; i < 100000; ++i) {
    const auto code = static_cast<std::uint32_t>(random());
    const vec3 shared = color_from_rgb9e5(code);
    ASSERT_EQ(color_from_rgb9e5(rgb9e5_from_color(shared)), shared) << code;
    const vec3 separate = color_from_r11g11b10f(code);
    if (is_finite(separate)) {
      ASSERT_EQ(color_from_r11g11b10f(r11g11b10f_from_color(separate)), separate) << code;
    }
  }
}

TEST(unit_image_texel, shared_exponents_err_by_at_most_half_a_step_of_the_largest_channel) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> stops(-14.0f, 15.9f), part(0.0f, 1.0f);
  double worst = 0.0, worst_of_cut = 0.0;
  for (int i = 0; i < 100000; ++i) {
    const float largest = std::exp2(stops(random));
    const vec3 color(largest, largest * part(random), largest * part(random));
    const vec3 back = color_from_rgb9e5(rgb9e5_from_color(color));
    const vec3 cut = color_from_rgb9e5(rgb9e5_from_color(color * (1.0f - 1.0f / 512.0f)));
    worst = std::max(worst, static_cast<double>(max_component(glm::abs(back - color)) / largest));
    worst_of_cut = std::max(worst_of_cut, static_cast<double>(max_component(glm::abs(cut - color)) / largest));
  }
  constexpr double kHalfStep = 0.5 / 255.75;  // the largest channel is at least 255.75 steps: 511.5 halves round up
  EXPECT_LE(worst, kHalfStep);
  EXPECT_GT(worst_of_cut, kHalfStep);
  EXPECT_EQ(color_from_rgb9e5(rgb9e5_from_color(vec3(65408.0f))), vec3(65408.0f));
  EXPECT_EQ(rgb9e5_from_color(vec3(0.0f)), 0u);
  EXPECT_EQ(color_from_rgb9e5(rgb9e5_from_color(vec3(511.9f, 1.0f, 0.0f))).x, 512.0f);  // rounds into the next exponent
}

TEST(unit_image_texel, what_does_not_fit_is_clamped_and_counted_once_per_texel) {
  const float nan = std::nanf("");
  const std::vector<float> pixels{1e6f, 2e5f, 1.0f, -1.0f, 0.5f, -2.0f, nan, kInfinity, 1.0f, 0.25f, 0.5f, 1.0f};
  const auto encode = [&](TexelFormat format, std::vector<float>& back) {
    std::vector<std::byte> texels(4 * texel_layout(format).bytes);
    const EncodingLoss loss = encode_texels(format, pixels, 3, texels);
    back.resize(pixels.size());
    decode_texels(format, texels, 3, back);
    return loss;
  };
  std::vector<float> back;
  EncodingLoss loss = encode(TexelFormat::rgba16f, back);
  EXPECT_EQ(loss.clamped, 1u);
  EXPECT_EQ(loss.negative, 0u);
  EXPECT_EQ(loss.non_finite, 1u);
  EXPECT_EQ(loss.largest, 1e6f);
  EXPECT_EQ(back, (std::vector<float>{65504, 65504, 1, -1, 0.5f, -2, 0, 65504, 1, 0.25f, 0.5f, 1}));

  for (const TexelFormat format : {TexelFormat::rgb9e5, TexelFormat::r11g11b10f}) {
    loss = encode(format, back);
    EXPECT_EQ(loss.clamped, 1u);
    EXPECT_EQ(loss.negative, 1u);
    EXPECT_EQ(loss.non_finite, 1u);
    EXPECT_EQ(back[3], 0.0f);
    for (const float v : back) EXPECT_TRUE(std::isfinite(v));
  }
  EXPECT_EQ(back[0], 65024.0f);
  EXPECT_EQ(back[7], 65024.0f);
  loss = encode(TexelFormat::rgba32f, back);
  EXPECT_EQ(loss.clamped, 0u);
  EXPECT_EQ(loss.non_finite, 1u);
}

TEST(unit_image_texel, formats_come_back_in_all_channel_counts) {
  for (const TexelLayout& layout : texel_layouts()) {
    if (!layout.is_float) continue;
    EXPECT_EQ(parse_texel_format(layout.name), layout.format);
    EXPECT_EQ(&texel_layout(layout.format), &layout);
    const std::vector<float> pixels{0.25f, 0.5f, 1.0f, 0.75f, 2.0f, 4.0f, 0.125f, 1.0f};
    std::vector<std::byte> texels(2 * layout.bytes);
    EXPECT_FALSE(encode_texels(layout.format, pixels, 4, texels).any());
    std::vector<float> back(8);
    decode_texels(layout.format, texels, 4, back);
    for (std::size_t i = 0; i < 8; ++i) {
      const std::size_t c = i % 4;
      const float expected = layout.channels == 1 && c < 3                   ? pixels[i - c]
                             : c < static_cast<std::size_t>(layout.channels) ? pixels[i]
                             : c == 3                                        ? 1.0f
                                                                             : 0.0f;
      EXPECT_EQ(back[i], expected) << layout.name << ' ' << i;
    }
  }
  EXPECT_THROW(parse_texel_format("rgba8"), Error);  // is only read
}

TEST(unit_image_texel, eight_bits_are_decoded_by_their_curve) {
  const std::array<std::byte, 4> texel{std::byte{255}, std::byte{188}, std::byte{0}, std::byte{51}};
  std::vector<float> out(4);
  decode_texels(TexelFormat::rgba8, texel, 4, out);
  EXPECT_EQ(out, (std::vector<float>{1.0f, 188.0f / 255.0f, 0.0f, 0.2f}));
  decode_texels(TexelFormat::bgra8_srgb, texel, 4, out);
  EXPECT_EQ(out[0], 0.0f);
  EXPECT_NEAR(out[1], 0.5029f, 1e-4f);
  EXPECT_EQ(out[2], 1.0f);
  EXPECT_EQ(out[3], 0.2f);
}

}  // namespace
}  // namespace candela
