#pragma once

#include "image/film.h"
#include "image/job.h"

namespace candela::denoise {

/// RGB of a film's picture by weighted linear regression on its features. In windows around every sixth pixel, light
/// over albedo is fitted as a linear function of place, normal and albedo, weighted by how likely pixels have the same
/// light; where windows overlap, their means count. After Bitterli et al. 2016, "Nonlinearly Weighted First-Order
/// Regression for Denoising Monte Carlo Renderings", with one pass in place of two and fewer windows. Film::features is
/// there. Throws Interrupted where the StopScope of the caller says so.
Image regress(const Film& film, const Job& job = {});

}  // namespace candela::denoise
