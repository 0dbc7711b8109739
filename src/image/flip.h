#pragma once

#include "image/image.h"

namespace candela {

/// Pixels per degree of a 3840 pixels wide monitor of 0.7 m at 0.7 m.
inline constexpr double kFlipPixelsPerDegree = 67.0;

/// How different two pictures look when one flips between them: one channel, 0 alike to 1 as different as can be, for
/// each pixel. Both are linear Rec.709 as a display shows them, in [0, 1] (what is beyond is clamped), 3 channels or
/// more. Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström & Fairchild 2020, "FLIP: A Difference Evaluator for
/// Alternating Images". Throws Error when the sizes differ or a picture is empty.
Image flip(const Image& reference, const Image& test, double pixels_per_degree = kFlipPixelsPerDegree);

/// The mean of flip().
double flip_mean(const Image& reference, const Image& test);

}  // namespace candela
