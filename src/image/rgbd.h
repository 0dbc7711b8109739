#pragma once

#include "image/image.h"
#include "image/texel.h"

// Light in 8 bits with a shared divisor in alpha, as EXT_lights_image_based has it.
namespace candela {

/// The brightest that RGBD holds: 1 over the smallest divisor.
inline constexpr float kBrightestRgbd = 255.0f;

/// Radiance of three channels: what sRGB's curve makes of the colour, over alpha. Without alpha that is a picture of a
/// display; an alpha of 0, which nobody writes, counts as the smallest there is.
Image image_from_rgbd(const TextureImage& texels);

/// The other way, in 8 bits: alpha is as large as leaves no channel above 1. Half a code of
/// sRGB is lost, so that a colour whose largest channel is m is off by at most 0.006 max(m, 1). What is brighter than
/// kBrightestRgbd is clamped, and counted.
TextureImage rgbd_from_image(const Image& radiance, EncodingLoss& loss);

/// Left and right exchanged.
Image mirrored(const Image& image);

}  // namespace candela
