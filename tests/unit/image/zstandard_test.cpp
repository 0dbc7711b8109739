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

}  // namespace
}  // namespace candela
