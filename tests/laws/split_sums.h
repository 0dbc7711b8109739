#pragma once

#include <array>

namespace candela::laws {

/// The split sum of GGX with height-correlated Smith masking, F90 = 1, by independent quadrature to 1e-4.
struct SplitSum {
  float roughness, mu, a, b;
};
inline constexpr std::array<SplitSum, 10> kSplitSums = {{{0.25f, 0.1f, 0.50514f, 0.39162f},
                                                         {0.25f, 0.5f, 0.95572f, 0.03264f},
                                                         {0.25f, 1.0f, 0.99570f, 0.0f},
                                                         {0.5f, 0.1f, 0.75193f, 0.13969f},
                                                         {0.5f, 0.5f, 0.83492f, 0.02235f},
                                                         {0.75f, 0.1f, 0.79577f, 0.05258f},
                                                         {0.75f, 1.0f, 0.62684f, 0.00005f},
                                                         {1.0f, 0.1f, 0.73634f, 0.02387f},
                                                         {1.0f, 0.5f, 0.44771f, 0.00299f},
                                                         {1.0f, 1.0f, 0.30682f, 0.00003f}}};

}  // namespace candela::laws
