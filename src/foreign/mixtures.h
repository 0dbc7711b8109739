#pragma once

#include "foreign/draft.h"

namespace candela::foreign {

/// Makes the images that a draft's materials are mixed from, which are then part of its buffer. One whose sources
/// cannot be read becomes an image that is not there, which the reader of the glTF tells.
void mix(Draft& draft, const Surroundings& around);

}  // namespace candela::foreign
