#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/diagnostics.h"
#include "scene/ies_profile.h"

namespace candela::io {

/// Reads a photometric file: IES LM-63 of 1986, 1991, 1995, 2002 or 2019, type C. The candela values come multiplied by
/// the file's candela multiplier and ballast factors, their symmetry unfolded. Tilt factors, lumens, watts and the size
/// of the luminous opening are checked and left out. Every number is checked; on bad data throws Error that reads
/// `where: line N: message`, also for types A and B. What the standard forbids and can be survived goes to
/// `diagnostics`.
IesProfile parse_ies(std::string_view text, const std::string& where, Diagnostics& diagnostics);

/// The same from a file; the profile is named after it.
IesProfile load_ies(const std::filesystem::path& path, Diagnostics& diagnostics);

}  // namespace candela::io
