#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/meshopt.h"

namespace candela::io::test {

using Mode = MeshoptLayout::Mode;
using Filter = MeshoptLayout::Filter;

/// What npm's meshoptimizer 1.3.0 packs, and FNV-1a of what its own decoder makes of it.
struct Packed {
  std::string_view name;
  Mode mode;
  Filter filter;
  std::size_t count, stride;
  std::string_view hex;
  std::uint64_t hash;

  MeshoptLayout layout() const { return {mode, filter, count, stride}; }
  std::vector<std::byte> bytes() const {
    std::vector<std::byte> result;
    for (std::size_t i = 0; i < hex.size(); i += 2) {
      result.push_back(static_cast<std::byte>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16)));
    }
    return result;
  }
};

inline const std::vector<Packed> kPacked = {
    {"v0", Mode::attributes, Filter::none, 20, 16,
     "a007004a4a4a4a4a4a4a4a4a4a4a4a4a4a4aff0000004a4a4a4a0100020008070016426e9ac6f2e1b5895d310526527eff000000aad6"
     "fdd10500222aaaeb00000004040515555555550000000000000a0aaaaaaaaaaaaaaaaaaa0000000000000a0555555555555555555500"
     "000000000000000700ecf9e8d4da4a1466eef1f319b9a1ccff000000729daab50700ea0b41262c2abe8d373b87e822c92aff000000ed"
     "0de21b070067fe98605c362826221e1a14100c063f00000003070d01380800007a0000000000000000000000000000000000000000e8"
     "03000000c87f0000000000",
     0xbc0e57aa04e34323},
    {"v1", Mode::attributes, Filter::none, 20, 16,
     "a17ba9a53f004a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a0016426e9ac6f21e4a76a2cefa26527eaad6022e050001556aaf000000"
     "0303051555555555000000020aaaaaaaaaaaaaaa0f000a0a0a0a0205555555555555550f000505050500ecf917d4da4a149911f1f3e6"
     "46a1cc8d9daab500ea0a43262a2abe8d393a88e723ca2aef0ce01a0098fe98605c362826221e1a14100c060003070d0102007b000000"
     "0000000000e803000000c87f000000000001000001",
     0xbc0e57aa04e34323},
    {"two blocks", Mode::attributes, Filter::none, 300, 4,
     "a1a5555555552aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa"
     "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa0000000000010201010202010102020101020201010202010102020101020201010202010102"
     "0201010202010102020101020201010202010102020101020201010202a515aaaaaaaaaaaaaaaaaaaaaa000001010202010102020101"
     "0202000000000000000000000000000000000000000000000000",
     0x8cb4a0a6d13a08b9},
    {"rotated words", Mode::attributes, Filter::none, 64, 4,
     "a17f000e9b02dfcfa411012a817bd8c7fe7341120bbb0459997667f815aba68f4774b1791ea564f72312f9b132970f6a1762"
     "55ff32eb01205d0db8737c65cb582d7900b800a8ae89757c9bc04802143e76451260f2863b90b09cfa816aae351b941eaed8"
     "f1a59010eccca0a46c247b8050ae08dba3f9a297619dd802556fba85beb8006b459134381e2140e041a8af5b803a321e2b56"
     "f044abad5b9029351e2c6ac057233452a31c4e5f1678d054b4a052bf01435f188c235069785a43f2585e0089aa0f06610166"
     "0ff06685fbfb101660ff06610166fafa05506610166055066101110440661011000000000000000000000000000000000000"
     "000000000012",
     0x572fdc18e58fd8bc},
    {"triangles", Mode::triangles, Filter::none, 18, 2, "e1f010f010fffff50012f8b60163007687566778a9866589689801690000",
     0x6e9875f3926e2133},
    {"wide triangles", Mode::triangles, Filter::none, 18, 4,
     "e1f010f010fffff50012f8b60163007687566778a9866589689801690000", 0xabf141358888a76b},
    {"strip", Mode::indices, Filter::none, 18, 2, "d10004040002080404040002081a24169103bc01870300000000",
     0x6e9875f3926e2133},
    {"octahedral bytes", Mode::attributes, Filter::octahedral, 8, 4,
     "a1ef004d69972726420a00083c515f4b024c0003040304030403000000000000000000000000000000000000007f4d7f8100",
     0x466caf29097f3d94},
    {"octahedral words", Mode::attributes, Filter::octahedral, 8, 8,
     "a1ffba00ebad87896a2c8c00040609020204000068d8330db306d4000003050604000400030403040304030000000000000000000000"
     "000000ff07df04ff0701800101",
     0x9564330dbe2c77},
    {"quaternions", Mode::attributes, Filter::quaternion, 8, 8,
     "a1779700d686e1a2623e2c000e0002030200859b3d291b110d00040004000cfecf8b5b3f2d0004000100040002000000000000000000"
     "000000000000000cfe9600fc010001",
     0xb15a5f22e65dda19},
    {"exponential", Mode::attributes, Filter::exponential, 8, 16,
     "a19f9f9f9e002d44531b9bf3a000061d2911101c020008000100083754712ca63900221a05251d041800a0000102004991939149c7bd"
     "0010181a18100a000008000200807f807f807f800126660000000000004a1100f3000000f313e5fff300e0fff300000000",
     0xdfe9317752209c7},
    {"color bytes", Mode::attributes, Filter::color, 8, 4,
     "a1ff001111111111111100242624242424240035373535353535001a181a1a1a181a000000000000000000000000000000000000009f"
     "c05f8000",
     0x8c468a5a137cc9c9},
    {"color words", Mode::attributes, Filter::color, 8, 8,
     "a1bbbb0047494749474947009292929292929200d9dbd9dbd9dbd9006666666668666600000000000000000000000000007f0200ff7f"
     "0100020101",
     0x115fd04b1a4b1860},
};

/// Version 0, every delta a whole byte; blocks as the decoder has them.
inline std::vector<std::byte> packed_plainly(std::span<const std::byte> elements, std::size_t stride) {
  const std::size_t count = elements.size() / stride,
                    block = std::min<std::size_t>((8192 / stride) & ~std::size_t{15}, 256);
  std::vector<std::byte> out{std::byte{0xA0}};
  std::vector<std::uint8_t> last(stride);
  for (std::size_t first = 0; first < count; first += block) {
    const std::size_t here = std::min(count - first, block), groups = (here + 15) / 16;
    for (std::size_t k = 0; k < stride; ++k) {
      out.insert(out.end(), (groups + 3) / 4, std::byte{0xFF});
      for (std::size_t i = 0; i < groups * 16; ++i) {
        const std::size_t at = (first + std::min(i, here - 1)) * stride + k;
        const auto value = static_cast<std::uint8_t>(elements[at]);
        const auto delta = static_cast<std::int8_t>(value - std::exchange(last[k], value));
        out.push_back(static_cast<std::byte>(delta * 2 ^ delta >> 7));
      }
    }
  }
  // The tail: what the first element's deltas start from, here zeros.
  out.insert(out.end(), std::max<std::size_t>(stride, 32), std::byte{0});
  return out;
}

/// Each index from the last of its kind, of which there are two; `kind(i)` is that of the i-th.
template <class Kind>
std::vector<std::byte> packed_indices(std::span<const std::uint16_t> indices, const Kind& kind) {
  std::vector<std::byte> out{std::byte{0xD1}};
  std::array<int, 2> last{};
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const unsigned of = kind(i);
    const int delta = indices[i] - std::exchange(last[of], indices[i]);
    auto code = static_cast<std::uint32_t>(delta * 2 ^ delta >> 31) << 1 | of;
    for (; code > 127; code >>= 7) out.push_back(static_cast<std::byte>((code & 127) | 128));
    out.push_back(static_cast<std::byte>(code));
  }
  out.insert(out.end(), 4, std::byte{0});
  return out;
}

}  // namespace candela::io::test
