#pragma once

#include "image/image.h"

namespace candela {

/// What a lens makes of a picture: `share` of every pixel's light is scattered around it, over sizes from a few pixels
/// to the whole picture alike (a pyramid of means, each level weighing the same, as Jiménez 2014, "Next Generation Post
/// Processing in Call of Duty: Advanced Warfare", builds it). No threshold: what does not outshine its neighbours
/// hardly changes. Linear light in any number of channels; what is not finite scatters nothing.
Image bloomed(const Image& image, float share);

}  // namespace candela
