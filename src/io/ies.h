#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/diagnostics.h"
#include "scene/ies_profile.h"

namespace candela::io {

/// Reads a photometric file: IES LM-63 of 1986, 1991, 1995, 2002 or 2019. The candela values come multiplied by the
/// file's candela multiplier and ballast factors, their symmetry unfolded. Tilt factors, lumens, watts and the size
/// of the luminous opening are checked and left out. Every number is checked; on bad data throws Error that reads
/// `where: line N: message`. What the standard forbids and can be survived goes to `diagnostics`.
///
/// Of types A and B both angles are 0 where the lamp is aimed, -z; vertical ones rise towards +x, horizontal ones go
/// clockwise as seen from there, towards -y (EXT_lights_ies). Both are a globe on its side: in type B planes through
/// the y axis are turned by the vertical angle, and the horizontal angle is the latitude in them; in type A planes
/// through the x axis are turned by the horizontal angle. Angles that begin at 0 are mirrored; outside its table a lamp
/// is dark.
IesProfile parse_ies(std::string_view text, const std::string& where, Diagnostics& diagnostics);

/// The same from a file; the profile is named after it.
IesProfile load_ies(const std::filesystem::path& path, Diagnostics& diagnostics);

}  // namespace candela::io
