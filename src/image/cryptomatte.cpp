#include "image/cryptomatte.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <map>

namespace candela::codec {

namespace {

/// Appleby 2010, "MurmurHash3", its 32-bit function.
std::uint32_t murmur3(std::string_view text) {
  constexpr std::uint32_t kFirst = 0xcc9e2d51, kSecond = 0x1b873593;
  const auto mixed = [](std::uint32_t k) { return std::rotl(k * kFirst, 15) * kSecond; };
  const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i])); };
  std::uint32_t h = 0;
  const std::size_t whole = text.size() / 4 * 4;
  for (std::size_t i = 0; i < whole; i += 4) {
    h ^= mixed(byte(i) | byte(i + 1) << 8 | byte(i + 2) << 16 | byte(i + 3) << 24);
    h = std::rotl(h, 13) * 5 + 0xe6546b64;
  }
  std::uint32_t rest = 0;
  for (std::size_t i = whole; i < text.size(); ++i) rest |= byte(i) << 8 * (i - whole);
  if (whole < text.size()) h ^= mixed(rest);
  h ^= static_cast<std::uint32_t>(text.size());
  h = (h ^ h >> 16) * 0x85ebca6b;
  h = (h ^ h >> 13) * 0xc2b2ae35;
  return h ^ h >> 16;
}

std::string escaped(std::string_view name) {
  std::string text;
  for (const char c : name) {
    if (c == '"' || c == '\\') {
      text += '\\';
      text += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      text += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      text += c;
    }
  }
  return text;
}

}  // namespace

std::uint32_t cryptomatte_hash(std::string_view name) {
  const std::uint32_t h = murmur3(name);
  const std::uint32_t exponent = h >> 23 & 255u;
  return exponent == 0 || exponent == 255 ? h ^ 1u << 23 : h;
}

Cryptomatte make_cryptomatte(std::string_view layer, const Mattes& mattes) {
  Cryptomatte result;
  result.prefix = "cryptomatte/" + fmt::format("{:08x}", cryptomatte_hash(layer)).substr(0, 7) + "/";
  std::map<std::uint32_t, float> hashes;  // by number, as the float of the same bits
  for (const auto& [number, name] : mattes.names) {
    const std::uint32_t hash = cryptomatte_hash(name);
    hashes[number] = std::bit_cast<float>(hash);
    result.manifest += fmt::format("{}\"{}\":\"{:08x}\"", result.manifest.empty() ? "{" : ",", escaped(name), hash);
  }
  result.manifest += result.manifest.empty() ? "{}" : "}";
  constexpr std::size_t kLevels = Mattes::kRanks / 2;
  result.levels.assign(kLevels, Image(mattes.width, mattes.height, 4));
  const std::size_t pixels = mattes.ranks.size() / Mattes::kRanks;
  for (std::size_t i = 0; i < pixels; ++i) {
    for (std::size_t r = 0; r < Mattes::kRanks && mattes.at(i)[r].coverage > 0.0f; ++r) {
      float* out = result.levels[r / 2].pixels.data() + 4 * i + 2 * (r % 2);
      out[0] = hashes[mattes.at(i)[r].number];
      out[1] = mattes.at(i)[r].coverage;
    }
  }
  return result;
}

}  // namespace candela::codec
