#pragma once

#include "image/image.h"

// How far a picture is from a reference. Colour channels only (alpha is not compared); sums in double; a NaN in either
// picture makes the result NaN. All throw Error when the sizes differ or a picture is empty.
namespace candela {

/// Added to the squared reference in rel_mse, so that black pixels count with a finite weight (Rousselle et al. 2011,
/// "Adaptive Sampling and Reconstruction using Greedy Error Minimization", use 0.01).
inline constexpr double kRelMseEpsilon = 0.01;

/// Mean of (a - b)² over pixels and colour channels.
double mse(const Image& a, const Image& b);

/// Mean of (a - reference)² / (reference² + kRelMseEpsilon) over pixels and colour channels.
double rel_mse(const Image& a, const Image& reference);

/// rel_mse without the worst `fraction` of the pixels (rounded down to whole pixels), so that single fireflies do not
/// decide a comparison.
double rel_mse_trimmed(const Image& a, const Image& reference, double fraction = 0.001);

/// Largest |a - b| of any colour channel.
double max_abs_difference(const Image& a, const Image& b);

/// Mean colour. A single channel is repeated.
dvec3 image_mean(const Image& image);

}  // namespace candela
