#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "foreign/formats.h"

namespace candela::foreign {

/// Throws Error where a file claims to hold more than its bytes can: elements of a PLY, packed files of a 3MF beyond
/// `most_bytes`.
void check_claims(std::span<const std::byte> bytes, Format format, std::uint64_t most_bytes, const std::string& where);

/// Whether a file's normals are what its faces look like. Those of an STL are zeros or wrong as often as not; where a
/// 3DS has no smoothing groups its faces are flat, and Assimp makes them smooth.
bool has_trusted_normals(std::span<const std::byte> bytes, Format format);

}  // namespace candela::foreign
