#pragma once

namespace candela {

/// From which alpha on a mask is there: what equals the cutoff is not cut out, whatever became of it in a texture and
/// between vertices. A quarter of a step of 8 bits.
inline constexpr float kAlphaSlack = 0.25f / 255.0f;
inline float drawn_cutoff(float alpha_cutoff) { return alpha_cutoff - kAlphaSlack; }

/// From which opacity on a surface is the first of the layers: half, as in other renderers.
inline constexpr float kOpacityOfLayers = 0.5f - kAlphaSlack;

}  // namespace candela
