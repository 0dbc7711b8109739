#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace candela::io {

/// How a buffer view of EXT_meshopt_compression or KHR_meshopt_compression is packed, as its JSON says.
struct MeshoptLayout {
  enum class Mode { attributes, triangles, indices };
  enum class Filter { none, octahedral, quaternion, exponential, color };

  Mode mode = Mode::attributes;
  Filter filter = Filter::none;
  std::size_t count = 0;   ///< elements
  std::size_t stride = 0;  ///< bytes of an element, decoded
};

/// What is wrong with a layout by the rules of the extensions; empty when nothing is.
std::string_view meshopt_fault(const MeshoptLayout& layout);

/// Least bytes that so many elements can be packed in: what claims more elements is refused before memory is asked for.
std::uint64_t meshopt_least_bytes(const MeshoptLayout& layout);

/// Decodes a packed buffer view, filter included, to `decoded` of count × stride bytes: bitstreams 0xa0 and 0xa1 of
/// attributes, 0xe1 of triangles, 0xd1 of indices (KHR_meshopt_compression, appendices A and B, January 2026). `layout`
/// has no fault. Throws Error (without a place) where the stream is damaged; reads nothing outside it.
void decode_meshopt(std::span<const std::byte> packed, const MeshoptLayout& layout, std::span<std::byte> decoded);

}  // namespace candela::io
