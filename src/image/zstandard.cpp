#include "image/zstandard.h"

#include <zstd.h>

#include <string>

#include "base/error.h"
#include "base/large_pages.h"

namespace candela {

std::vector<std::byte> zstandard_packed(std::span<const std::byte> bytes, int level) {
  std::vector<std::byte> packed(ZSTD_compressBound(bytes.size()));
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), level);
  if (ZSTD_isError(size) != 0) throw Error(std::string("cannot be packed: ") + ZSTD_getErrorName(size));
  packed.resize(size);
  return packed;
}

std::optional<std::uint64_t> zstandard_size(std::span<const std::byte> packed) {
  const unsigned long long size = ZSTD_getFrameContentSize(packed.data(), packed.size());
  if (size == ZSTD_CONTENTSIZE_UNKNOWN || size == ZSTD_CONTENTSIZE_ERROR) return std::nullopt;
  return size;
}

std::vector<std::byte> zstandard_unpacked(std::span<const std::byte> packed, std::size_t size) {
  std::vector<std::byte> bytes;
  resize_large(bytes, size);
  const std::size_t found = ZSTD_decompress(bytes.data(), bytes.size(), packed.data(), packed.size());
  if (ZSTD_isError(found) != 0 || found != size) throw Error("cannot be unpacked");
  return bytes;
}

}  // namespace candela
