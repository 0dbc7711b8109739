#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "io/meshopt_stream.h"

namespace candela::io {

/// Bytes are packed in groups of sixteen.
inline constexpr std::size_t kMeshoptGroup = 16;
/// So far beyond a stream's end memory is read, not used: no tail of attributes is shorter.
inline constexpr std::size_t kMeshoptSlack = 24;

/// Bits of a delta in a group, by the two bits that its header has; 0 = none, 8 = whole bytes.
enum class MeshoptWidths { v0_0_2_4_8, v1_0_1_2_4, v1_1_2_4_8 };

/// Unpacks the deltas of one byte of `count` elements to `out`, which has room for four groups at a time. Throws Error
/// where they end too early; kMeshoptSlack bytes follow the stream.
void unpack_groups(MeshoptStream& in, std::size_t count, MeshoptWidths widths, std::uint8_t* out);

/// The same without a processor that shuffles bytes.
void unpack_groups_plainly(MeshoptStream& in, std::size_t count, MeshoptWidths widths, std::uint8_t* out);

}  // namespace candela::io
