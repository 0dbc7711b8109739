#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace candela::codec {

/// Walks the headers of an OpenEXR file before the library sees it, which allocates what they ask for. Throws Error for
/// attributes longer than the file, windows above kMaxImageSize, and pixels or tiles above kMaxImageBytes.
void check_exr_header(std::span<const std::byte> bytes, const std::string& where);

}  // namespace candela::codec
