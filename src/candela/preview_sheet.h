#pragma once

#include <vector>

#include "candela/preview.h"

namespace candela {

/// Lays out views of equal size, their names and what `preview` says into `preview.sheet`, and their corners.
void lay_out_sheet(const std::vector<DisplayImage>& pictures, Preview& preview);

}  // namespace candela
