#include "io/meshopt_groups.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "io/meshopt.h"
#include "unit/io/meshopt_files.h"

namespace candela::io {
namespace {

constexpr std::size_t kElements = 256;

using Unpack = void (*)(MeshoptStream&, std::size_t, MeshoptWidths, std::uint8_t*);

/// What a stream unpacks to and how many bytes are left, or the error.
std::string result(Unpack unpack, const std::vector<std::uint8_t>& bytes, std::size_t size, std::size_t count,
                   MeshoptWidths widths) {
  std::string out(kElements, '\0');
  MeshoptStream in(bytes.data(), bytes.data() + size);
  try {
    unpack(in, count, widths, reinterpret_cast<std::uint8_t*>(out.data()));
  } catch (const Error& error) {
    return error.what();
  }
  return out.substr(0, count) + std::to_string(in.left());
}

TEST(unit_io_meshopt_groups, both_ways_to_unpack_give_the_same_bytes_and_errors) {
  std::mt19937 random(7);
  std::size_t errors = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    std::vector<std::uint8_t> bytes(random() % 300);
    // Some have all bits set, so that deltas go on, some are 0.
    for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>(random() % 3 == 0 ? 0u - random() % 2 : random());
    const std::size_t size = bytes.size();
    bytes.resize(size + kMeshoptSlack);
    const std::size_t count = 1 + random() % kElements;
    for (const MeshoptWidths widths :
         {MeshoptWidths::v0_0_2_4_8, MeshoptWidths::v1_0_1_2_4, MeshoptWidths::v1_1_2_4_8}) {
      const std::string plain = result(unpack_groups_plainly, bytes, size, count, widths);
      ASSERT_EQ(result(unpack_groups, bytes, size, count, widths), plain) << trial;
      errors += plain.starts_with("damaged") ? 1 : 0;
    }
  }
  EXPECT_GT(errors, 500u);
  EXPECT_LT(errors, 8500u);
}

TEST(unit_io_meshopt_groups, elements_of_any_stride_come_back_and_nothing_behind_them_is_touched) {
  std::mt19937 random(11);
  for (std::size_t stride = 4; stride <= 256; stride += 4) {
    for (const std::size_t count : std::to_array<std::size_t>({1, 3, 16, 17, 255, 256, 257, 600})) {
      std::vector<std::byte> elements(count * stride);
      for (std::byte& b : elements) b = static_cast<std::byte>(random());
      constexpr std::byte kUntouched{0x5A};
      std::vector<std::byte> decoded(elements.size() + 64, kUntouched);
      decode_meshopt(test::packed_plainly(elements, stride),
                     {MeshoptLayout::Mode::attributes, MeshoptLayout::Filter::none, count, stride},
                     std::span(decoded).first(elements.size()));
      ASSERT_TRUE(std::equal(elements.begin(), elements.end(), decoded.begin())) << stride << ' ' << count;
      ASSERT_EQ(std::count(decoded.end() - 64, decoded.end(), kUntouched), 64) << stride << ' ' << count;
    }
  }
}

}  // namespace
}  // namespace candela::io
