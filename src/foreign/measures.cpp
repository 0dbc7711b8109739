#include "foreign/measures.h"

#include <fmt/format.h>

#include "base/error.h"

namespace candela::foreign {

bool is_silent(Format format) { return format == Format::obj || format == Format::stl || format == Format::ply; }

void require_silence(Format format, const Measures& measures, const std::string& where) {
  if (measures.empty() || is_silent(format)) return;
  const std::string what = !measures.is_z_up           ? "a unit is"
                           : !measures.metres_per_unit ? "an upward axis is"
                                                       : "a unit and an upward axis are";
  throw Error(fmt::format("{} given, but {} says its own; OBJ, STL and PLY do not", what, format_name(format)), where);
}

}  // namespace candela::foreign
