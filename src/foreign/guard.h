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

}  // namespace candela::foreign
