#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "foreign/draft.h"
#include "foreign/formats.h"
#include "foreign/measures.h"

namespace candela::foreign {

/// A file of one of the formats beside glTF, read by Assimp. Uses no threads. `stem` names what has no name. Throws
/// Error without a `where`.
Draft read_with_assimp(std::span<const std::byte> bytes, Format format, const Measures& measures,
                       const Surroundings& around, const std::string& stem);

}  // namespace candela::foreign
