#include "io/meshopt.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "unit/io/meshopt_files.h"

namespace candela::io {
namespace {

using test::Filter;
using test::kPacked;
using test::Mode;
using test::Packed;

std::vector<std::byte> decoded(std::span<const std::byte> packed, const MeshoptLayout& layout) {
  std::vector<std::byte> result(layout.count * layout.stride);
  decode_meshopt(packed, layout, result);
  return result;
}

std::uint64_t fnv1a(const std::vector<std::byte>& bytes) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const std::byte b : bytes) hash = (hash ^ static_cast<std::uint64_t>(b)) * 0x100000001b3;
  return hash;
}

TEST(unit_io_meshopt, every_codec_and_filter_decodes_as_its_reference_does) {
  for (const Packed& p : kPacked) {
    ASSERT_EQ(meshopt_fault(p.layout()), "") << p.name;
    EXPECT_LE(meshopt_least_bytes(p.layout()), p.bytes().size()) << p.name;
    EXPECT_EQ(fnv1a(decoded(p.bytes(), p.layout())), p.hash) << p.name;
  }
}

TEST(unit_io_meshopt, indices_of_two_kinds_come_back_whether_their_numbers_are_long_or_short) {
  std::mt19937 random(3);
  for (std::size_t count = 1; count < 200; ++count) {
    // Two strands; steps of up to 31 fit in a byte, and runs of them are read eight at a time.
    std::vector<std::uint16_t> indices(count);
    std::vector<unsigned> kinds(count);
    std::array<int, 2> strands{500, 60000};
    for (std::size_t i = 0; i < count; ++i) {
      kinds[i] = random() % 2;
      int& at = strands[kinds[i]];
      const int most = random() % 20 == 0 ? 5000 : 31;
      at = std::clamp(at + static_cast<int>(random() % 63) * most / 31 - most, 0, 65535);
      indices[i] = static_cast<std::uint16_t>(at);
    }
    const std::vector<std::byte> packed = test::packed_indices(indices, [&](std::size_t i) { return kinds[i]; });
    const std::vector<std::byte> narrow = decoded(packed, {Mode::indices, Filter::none, count, 2});
    const std::vector<std::byte> wide = decoded(packed, {Mode::indices, Filter::none, count, 4});
    for (std::size_t i = 0; i < count; ++i) {
      std::uint16_t as_narrow = 0;
      std::uint32_t as_wide = 0;
      std::memcpy(&as_narrow, &narrow[2 * i], 2);
      std::memcpy(&as_wide, &wide[4 * i], 4);
      ASSERT_EQ(as_narrow, indices[i]) << count << ' ' << i;
      ASSERT_EQ(as_wide, indices[i]) << count << ' ' << i;
    }
  }
}

TEST(unit_io_meshopt, what_is_cut_short_or_goes_on_is_an_error) {
  for (const Packed& p : kPacked) {
    std::vector<std::byte> bytes = p.bytes();
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      EXPECT_THROW(decoded(std::span(bytes).first(size), p.layout()), Error) << p.name << ' ' << size;
    }
    bytes.insert(bytes.begin() + 1, std::byte{0});
    EXPECT_THROW(decoded(bytes, p.layout()), Error) << p.name;
  }
}

TEST(unit_io_meshopt, flipped_bits_give_numbers_or_an_error) {
  std::size_t refused = 0;
  for (const Packed& p : kPacked) {
    for (std::size_t bit = 0; bit < 8 * p.bytes().size(); ++bit) {
      std::vector<std::byte> bytes = p.bytes();
      bytes[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
      try {
        decoded(bytes, p.layout());
      } catch (const Error&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 100u);
}

TEST(unit_io_meshopt, layouts_are_judged_by_the_extension) {
  EXPECT_NE(meshopt_fault({Mode::attributes, Filter::none, 4, 6}), "");
  EXPECT_NE(meshopt_fault({Mode::attributes, Filter::none, 4, 260}), "");
  EXPECT_NE(meshopt_fault({Mode::attributes, Filter::none, 0, 4}), "");
  EXPECT_NE(meshopt_fault({Mode::attributes, Filter::octahedral, 4, 12}), "");
  EXPECT_NE(meshopt_fault({Mode::attributes, Filter::quaternion, 4, 4}), "");
  EXPECT_NE(meshopt_fault({Mode::triangles, Filter::none, 4, 2}), "");
  EXPECT_NE(meshopt_fault({Mode::indices, Filter::color, 4, 4}), "");
  EXPECT_NE(meshopt_fault({Mode::indices, Filter::none, 4, 1}), "");
  // What claims more than it can hold is refused before memory is asked for.
  EXPECT_GT(meshopt_least_bytes({Mode::attributes, Filter::none, std::size_t{1} << 40, 16}), std::uint64_t{1} << 30);
}

}  // namespace
}  // namespace candela::io
