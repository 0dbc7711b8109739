#pragma once

#include <optional>
#include <string>

#include "foreign/formats.h"

namespace candela::foreign {

/// What the user says of a file's coordinates where its format says nothing: OBJ, STL and PLY. Of any other file, which
/// says it itself, it is an Error.
struct Measures {
  std::optional<float> metres_per_unit = {};  ///< positive; else a metre
  std::optional<bool> is_z_up = {};           ///< else +y is up

  bool empty() const { return !metres_per_unit && !is_z_up; }
};

/// Whether files of a format say neither unit nor upward axis.
bool is_silent(Format format);
/// Throws Error at `where` where measures are given for a file that says them itself.
void require_silence(Format format, const Measures& measures, const std::string& where);

}  // namespace candela::foreign
