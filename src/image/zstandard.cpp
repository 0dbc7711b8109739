#include "image/zstandard.h"

#include <zstd.h>

#include <algorithm>
#include <memory>
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

void unpack_zstandard(std::span<const std::byte> packed, std::size_t size,
                      const std::function<void(std::span<const std::byte>)>& take) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), ZSTD_freeDCtx);
  if (context == nullptr) throw Error("cannot be unpacked: memory ends");
  std::vector<std::byte> piece(std::size_t{1} << 20);
  ZSTD_inBuffer in{packed.data(), packed.size(), 0};
  std::size_t left = size, hint = 1;
  while (left > 0) {
    ZSTD_outBuffer out{piece.data(), std::min(piece.size(), left), 0};
    while (out.pos < out.size) {
      const std::size_t before = in.pos + out.pos;
      hint = ZSTD_decompressStream(context.get(), &out, &in);
      if (ZSTD_isError(hint) != 0 || in.pos + out.pos == before) throw Error("cannot be unpacked");
    }
    take(std::span(piece).first(out.size));
    left -= out.size;
  }
  // What is left is the end of the frame.
  ZSTD_outBuffer none{piece.data(), 0, 0};
  if (hint != 0) hint = ZSTD_decompressStream(context.get(), &none, &in);
  if (hint != 0 || in.pos != in.size) throw Error("cannot be unpacked");
}

}  // namespace candela
