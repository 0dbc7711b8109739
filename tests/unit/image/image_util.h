#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "image/develop.h"
#include "image/image.h"
#include "image/image_file.h"

namespace candela::test {

using Bytes = std::vector<std::byte>;

inline Bytes bytes_of(const std::string& text) {
  const auto span = std::as_bytes(std::span(text));
  return {span.begin(), span.end()};
}

/// Positive values over twelve stops, some exactly 0.
inline Image random_image(int width, int height, int channels, unsigned seed = 1) {
  Image image(width, height, channels);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> stops(-6.0f, 6.0f);
  for (float& v : image.pixels) v = random() % 17 == 0 ? 0.0f : std::exp2(stops(random));
  if (channels == 4)
    for (std::size_t i = 3; i < image.pixels.size(); i += 4) image.pixels[i] = static_cast<float>(random() % 5) / 4.0f;
  return image;
}

inline DisplayImage random_display(int width, int height, bool opaque, unsigned seed = 1) {
  DisplayImage image{width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(width * height) * 4)};
  std::mt19937 random(seed);
  for (auto& v : image.rgba) v = static_cast<std::uint8_t>(random());
  if (opaque)
    for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
  return image;
}

/// Whatever decode does with `bytes`, it must return or throw Error; true when it returned.
template <class Decode>
bool survives(Decode decode, std::span<const std::byte> bytes) {
  try {
    decode(bytes);
    return true;
  } catch (const Error&) {
    return false;
  }
}

/// Decodes every proper prefix and every copy with one byte changed. Each must return or throw Error; prefixes must
/// throw.
template <class Decode>
void check_damage(Decode decode, const Bytes& good) {
  ASSERT_TRUE(survives(decode, good));
  for (std::size_t length = 0; length < good.size(); ++length)
    EXPECT_FALSE(survives(decode, std::span(good).first(length))) << "cut after " << length << " of " << good.size();
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (const unsigned flip : {0x01u, 0x80u, 0xffu}) {
      Bytes bad = good;
      bad[i] ^= static_cast<std::byte>(flip);
      survives(decode, bad);
    }
  }
}

}  // namespace candela::test
