#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace candela {

/// One Zstandard frame (RFC 8878) that says how much it holds. Throws Error where memory ends.
std::vector<std::byte> zstandard_packed(std::span<const std::byte> bytes, int level = 1);
/// How much a frame says that it holds; nothing where it does not say, or is none.
std::optional<std::uint64_t> zstandard_size(std::span<const std::byte> packed);
/// Throws Error for what is damaged, or holds another number of bytes than `size`.
std::vector<std::byte> zstandard_unpacked(std::span<const std::byte> packed, std::size_t size);
/// The same for what is used piece by piece: `take` is given all of it, in pieces of 1 MiB and a last one.
void unpack_zstandard(std::span<const std::byte> packed, std::size_t size,
                      const std::function<void(std::span<const std::byte>)>& take);

}  // namespace candela
