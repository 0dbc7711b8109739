#pragma once

#include "image/image.h"
#include "math/types.h"

namespace candela::ibl {

/// The second factor of the split sum over (NoV, roughness): texel (x, y) is at NoV = (x + ½) / size and roughness
/// (y + ½) / size, row 0 the smoothest. 32-bit floats.
struct Tables {
  /// Channels: A and B of F0 · A + F90 · B for GGX with height-correlated Smith masking and Schlick's Fresnel; then the
  /// directional albedo of the sheen lobe (Charlie's D with Neubelt's V). A + B is the single-scattering albedo, so the
  /// multiple-scattering layout (B, A + B) is the same numbers.
  Image dfg;
  /// Channels: A, B with Schlick-GGX masking, k = roughness² / 2 (Karis 2013), and 0.
  Image dfg_k_ibl;
};
Tables make_tables(int size);

/// One entry. roughness in (0, 1], mu = NoV in (0, 1].
vec2 split_sum(float mu, float roughness);
vec2 split_sum_k_ibl(float mu, float roughness);
float sheen_albedo(float mu, float roughness);

}  // namespace candela::ibl
