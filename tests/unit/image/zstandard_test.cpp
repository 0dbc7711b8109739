#include "image/zstandard.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace candela {
namespace {

TEST(unit_image_zstandard, what_is_packed_is_unpacked_and_what_is_damaged_refused) {
  std::vector<std::byte> bytes(100000);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i % 251);
  std::vector<std::byte> packed = zstandard_packed(bytes);
  EXPECT_LT(packed.size(), bytes.size() / 10);
  EXPECT_EQ(zstandard_size(packed), bytes.size());
  EXPECT_EQ(zstandard_unpacked(packed, bytes.size()), bytes);
  EXPECT_THROW(zstandard_unpacked(packed, bytes.size() - 1), Error);
  EXPECT_THROW(zstandard_unpacked(packed, bytes.size() + 1), Error);
  packed.resize(packed.size() / 2);
  EXPECT_THROW(zstandard_unpacked(packed, bytes.size()), Error);
  EXPECT_EQ(zstandard_size(std::vector<std::byte>(9, std::byte{7})), std::nullopt);
  EXPECT_EQ(zstandard_size({}), std::nullopt);
}

TEST(unit_image_zstandard, pieces_are_the_whole_and_no_more_and_no_less) {
  // More than two pieces, a whole one, and less than one.
  for (const std::size_t size : {std::size_t{2500001}, std::size_t{1} << 20, std::size_t{1000}}) {
    std::vector<std::byte> bytes(size);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i * i % 251);
    std::vector<std::byte> packed = zstandard_packed(bytes);
    const auto unpacked = [&packed](std::size_t claimed) {
      std::vector<std::byte> all;
      unpack_zstandard(packed, claimed,
                       [&all](std::span<const std::byte> piece) { all.insert(all.end(), piece.begin(), piece.end()); });
      return all;
    };
    EXPECT_EQ(unpacked(size), bytes) << size;
    EXPECT_THROW(unpacked(size - 1), Error) << size;
    EXPECT_THROW(unpacked(size + 1), Error) << size;
    packed.push_back(std::byte{0});
    EXPECT_THROW(unpacked(size), Error) << size << ", and something after it";
    packed.resize(packed.size() / 2);
    EXPECT_THROW(unpacked(size), Error) << size << ", cut short";
  }
}

}  // namespace
}  // namespace candela
