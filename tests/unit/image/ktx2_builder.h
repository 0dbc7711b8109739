#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace candela::test {

/// A KTX 2 written word by word, right or wrong.
struct Ktx2 {
  std::uint32_t vk_format = 0, type_size = 1, width = 4, height = 4, depth = 0, layers = 0, faces = 1, scheme = 0;
  std::uint32_t model = 166, primaries = 1, transfer = 1, flags = 0;
  std::vector<std::uint32_t> channels = {3};
  std::map<std::string, std::string> key_values = {};
  std::vector<std::vector<std::byte>> levels = {};  ///< largest first; the faces of each in a row
  std::vector<std::uint64_t> uncompressed = {};     ///< of each level, where it is packed

  std::vector<std::byte> bytes() const;
};

namespace ktx2_detail {
template <class T>
void add(std::vector<std::byte>& out, T value) {
  const auto bytes = std::as_bytes(std::span(&value, 1));
  out.insert(out.end(), bytes.begin(), bytes.end());
}
template <class T>
void put(std::vector<std::byte>& out, std::size_t at, T value) {
  std::memcpy(out.data() + at, &value, sizeof value);
}
}  // namespace ktx2_detail

inline std::vector<std::byte> Ktx2::bytes() const {
  using ktx2_detail::add;
  using ktx2_detail::put;
  std::vector<std::byte> out;
  for (const char c : std::string("\xabKTX 20\xbb\r\n\x1a\n")) out.push_back(static_cast<std::byte>(c));
  for (const std::uint32_t word : {vk_format, type_size, width, height, depth, layers, faces,
                                   static_cast<std::uint32_t>(levels.size()), scheme, 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u})
    add(out, word);
  const std::size_t index = out.size();
  out.resize(index + 24 * levels.size());

  const std::size_t descriptor = out.size();
  const auto block = static_cast<std::uint32_t>(24 + 16 * channels.size());
  for (const std::uint32_t word :
       {4 + block, 0u, 2u | block << 16, model | primaries << 8 | transfer << 16 | flags << 24, 3u | 3u << 8, 16u, 0u})
    add(out, word);
  for (const std::uint32_t channel : channels)
    for (const std::uint32_t word : {127u << 16 | channel << 24, 0u, 0u, 0xffffffffu}) add(out, word);
  put(out, 48, static_cast<std::uint32_t>(descriptor));
  put(out, 52, 4 + block);

  const std::size_t keys = out.size();
  for (const auto& [key, value] : key_values) {
    add(out, static_cast<std::uint32_t>(key.size() + value.size() + 2));
    for (const std::string& text : {key, value}) {
      for (const char c : text) out.push_back(static_cast<std::byte>(c));
      out.push_back(std::byte{0});
    }
    out.resize((out.size() + 3) / 4 * 4);
  }
  if (out.size() > keys) {
    put(out, 56, static_cast<std::uint32_t>(keys));
    put(out, 60, static_cast<std::uint32_t>(out.size() - keys));
  }
  for (std::size_t level = levels.size(); level-- > 0;) {
    out.resize((out.size() + 15) / 16 * 16);
    put(out, index + 24 * level, std::uint64_t{out.size()});
    put(out, index + 24 * level + 8, std::uint64_t{levels[level].size()});
    put(out, index + 24 * level + 16,
        uncompressed.empty() ? (scheme == 1 ? 0 : std::uint64_t{levels[level].size()}) : uncompressed[level]);
    out.insert(out.end(), levels[level].begin(), levels[level].end());
  }
  return out;
}

}  // namespace candela::test
