#pragma once

#include "path/render.h"

namespace candela::path {

/// Adds the work of one picture to that of several: times and counts are sums, the scene is that of the last, the noise
/// is the worst. What `mean_samples_per_pixel` is of them all the caller says.
void add_work(const Statistics& picture, Statistics& all);

}  // namespace candela::path
