#pragma once

#include <cstddef>
#include <vector>

#include "image/develop.h"

namespace candela {

/// What write_png() writes.
std::vector<std::byte> encode_png(const DisplayImage& image);

}  // namespace candela
